"""Hidden inputs: what could act at each stage of the chain, and what windows of recordings say of it.

Inputs are the simulator's own effects, constant within a window, so that friction, sticking and
separation stay in force. Misfit, gains of the inputs and slacks are by least squares in white noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.diagnosis.document import Channel
from meso_robust.diagnosis.tangent import basis, whitened
from meso_robust.identification.models.model import Model, Parameter, with_effects
from meso_robust.identification.prepared import Prepared
from meso_robust.identification.problem import Fits, Settings
from meso_robust.simulator import Effects
from meso_robust.simulator.environment import FLOW_SLOTS
from meso_robust.simulator.support import FILM_SLOTS, THINNING
from meso_robust.types import Flags, Floats

CHANNELS: tuple[Channel, ...] = (
    "support",
    "contact",
    "actuation",
    "observation",
    "environment",
    "geometry",
)
_SCALES: dict[str, dict[str, float]] = {
    "drag_centre_offset": {"x_um": 10.0, "y_um": 10.0},
    "camera_drift": {"x_um_s": 0.3, "y_um_s": 0.3},
    "camera_latency": {"time_ms": 10.0},
    "camera_rotation": {"angle_deg": 0.2},
    "camera_scale": {"percent": 0.3},
    "camera_anisotropy": {"x_percent": 0.3, "y_percent": 0.3},
    "body_force": {"x_um_s": 0.5, "y_um_s": 0.5},
    "tip_radius": {"excess_um": 1.0},
    "part_geometry": {"x_um": 1.0, "y_um": 1.0},
}
"""Effects, and changes that show by about one standard deviation in a window."""
TIP_OFFSET = 1e-6
"""m: unit of the inputs that shift the tips; of their drift, in a second from the recording's start."""
_FREE: dict[Channel, tuple[str, ...]] = {
    "support": ("rho", "drag_centre_offset"),
    "contact": ("mu",),
    "actuation": ("offset",),
    "observation": ("camera_drift", "camera_latency"),
    "environment": ("body_force",),
    "geometry": ("tip_radius",),
}
"""What may differ from window to window."""
_SHARED: dict[Channel, tuple[str, ...]] = {
    "support": ("drag_centre_offset",),
    "contact": (),
    "actuation": ("drift",),
    "observation": ("camera_drift", "camera_latency", "camera_rotation", "camera_scale"),
    "environment": ("body_force",),
    "geometry": ("tip_radius", "part_geometry"),
}
"""What may be the same in all windows, beyond the parameters of the plain model."""
_STEP = 0.03  # of a coordinate of the model itself, for its difference
_SLIP = 0.15  # of friction at the tips: wide, so that it shows whether a sticking tip would slip
_TOLD = 0.1  # σ: least length of a direction, in typical changes, that a window can tell
_SHORTEST = 1e-3  # σ: least length of a ramp of one σ a second


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inputs:
    """A model with hidden inputs: n parameters, and offset and drift of the tips.

    Attributes
    ----------
    model
        The extended model.
    base
        Parameters of the plain model.
    free, shared
        (C + 1,) columns of the inputs of each channel that differ from window to window, and of those
        that do not, in the order of `CHANNELS`; last those of all.
    spans
        (1, n) steps of the differences, in coordinates.
    """

    model: Model
    base: int
    free: tuple[tuple[int, ...], ...]
    shared: tuple[tuple[int, ...], ...]
    spans: Floats

    @property
    def count(self) -> int:
        """Of the inputs: n, and the two coordinates of the tips' offset and of its drift."""
        return self.spans.shape[1] + 4


def with_inputs(model: Model, tip_radius: float = np.inf) -> Inputs:
    """Add the hidden inputs of every channel to a model; an effect that it has is its own input.

    Friction at the tips is the model's input to the contact, its other parameters to the support.
    What changes the drag of a film is left out of a model without one; ``tip_radius`` is as
    for `with_effects`.
    """
    own = {parameter.key.split(".")[0] for parameter in model.parameters if "." in parameter.key}
    added = {name: of for name, of in _applicable(model).items() if name not in own}
    extended = with_effects(model, added, tip_radius=tip_radius)
    base, parameters = len(model.parameters), extended.parameters
    kinds = [_kind(parameter) for parameter in parameters]
    tips = ["offset", "offset", "drift", "drift"]
    return Inputs(
        model=extended,
        base=base,
        free=_columns([*kinds, *tips], _FREE),
        shared=_columns([*kinds, *tips], _SHARED),
        spans=np.array([[_span(parameter) for parameter in parameters]]),
    )


def _applicable(model: Model) -> dict[str, dict[str, float]]:
    """The effects that have a meaning for the support of a model."""
    sample = model.physics(model.draw(np.random.default_rng(0), 1))
    if np.all(sample.support.tables().film[:, 0] > 0.0):
        return _SCALES
    drag = (*FILM_SLOTS, *FLOW_SLOTS, THINNING)
    return {name: of for name, of in _SCALES.items() if not Effects({name: of}).is_on(*drag)}


def _span(parameter: Parameter) -> float:
    """Step of a difference, in coordinates."""
    if "." in parameter.key:
        return 1.0
    return _SLIP if _kind(parameter) == "mu" else _STEP


def _kind(parameter: Parameter) -> str:
    """Name of an effect, or what a parameter of the plain model stands for."""
    if parameter.unseen:
        return ""
    effect, _, key = parameter.key.partition(".")
    if key:
        return effect
    return "mu" if effect in ("mu", "mu_t") else "rho"


def _columns(kinds: list[str], sets: dict[Channel, tuple[str, ...]]) -> tuple[tuple[int, ...], ...]:
    each = [
        tuple(k for k, kind in enumerate(kinds) if kind in sets[channel]) for channel in CHANNELS
    ]
    return (*each, tuple(sorted(k for of in each for k in of)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solved:
    """Least squares of one window: data (M,) by columns, with nuisances projected out.

    Attributes
    ----------
    gain, rank
        Fall of χ² and directions that the data can tell.
    estimate, error
        (k,) of the columns' factors and their standard errors; NaN where the data cannot tell.
    """

    gain: float
    rank: int
    estimate: Floats
    error: Floats


def solved(columns: Floats, data: Floats, least: float = _TOLD) -> Solved:
    """Explain data (M,) of unit white noise by columns (M, k), in directions longer than `least`."""
    squares, ways = np.linalg.eigh(columns.T @ columns)
    told = squares > least**2
    sizes, ways = np.sqrt(squares[told]), ways[:, told]
    along = ways.T @ (columns.T @ data) / sizes
    estimate = ways @ (along / sizes)
    error = np.sqrt(np.sum((ways / sizes) ** 2, axis=1))
    # a factor is told if hardly any of it lies in directions that are not
    known = np.sum(ways**2, axis=1) > 0.99
    return Solved(
        gain=float(along @ along),
        rank=int(told.sum()),
        estimate=np.where(known, estimate, np.nan),
        error=np.where(known, error, np.nan),
    )


@dataclass(frozen=True, slots=True, eq=False)
class Linear:
    """One window: what its inputs change, and its data, without what a start can take.

    Attributes
    ----------
    columns, data
        (M, I) and (M,), in standard deviations of white noise.
    chi2, freedom, components
        As in `Statistics`.
    parts
        Least squares of each channel's free inputs, and of all.
    slack
        Of a twist beyond the model.
    """

    columns: Floats
    data: Floats
    chi2: float
    freedom: float
    components: Floats
    parts: tuple[Solved, ...]
    slack: Solved


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Statistics:
    """What W windows say, with C channels and I inputs.

    Attributes
    ----------
    chi2, freedom
        (W,) of what is left with the start fitted, in white noise.
    components
        (W, 3) the same along x, y and θ, in standard deviations of chance.
    gains, ranks
        (W, C + 1) fall of χ² with a hidden input at each stage, and its degrees of freedom; the last
        column has all stages together.
    slack, slack_sigma
        (W, 3) twist beyond the model in m/s and rad/s, stage frame, and its standard errors.
    shared_gains, shared_ranks
        (C + 1,) the same as gains with one value of each input in all windows, the parameters of the
        plain model free.
    each
        The windows one by one.
    """

    chi2: Floats
    freedom: Floats
    components: Floats
    gains: Floats
    ranks: Floats
    slack: Floats
    slack_sigma: Floats
    shared_gains: Floats
    shared_ranks: Floats
    each: tuple[Linear, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelTotal:
    """How much hidden inputs at one stage explain, in all windows together.

    Attributes
    ----------
    channel
        The stage.
    evidence
        Fall of χ² with inputs that are free from window to window, or with those of one value in all,
        less what that many inputs cost (the logarithm of the number of data each), whichever is
        better; zero where neither pays.
    sigma
        The better of both in standard deviations of chance.
    share
        Evidence over that of all stages together, or of the best one if that is more.
    """

    channel: Channel
    evidence: float
    sigma: float
    share: float


def surprise(chi2: Floats | float, freedom: Floats | float) -> Floats:
    """χ² in standard deviations of chance (Fisher): ``√(2 χ²) − √(2 n − 1)``; zero for n = 0."""
    freedom = np.asarray(freedom, dtype=float)
    beyond = np.sqrt(2.0 * np.asarray(chi2)) - np.sqrt(2.0 * np.maximum(freedom, 1.0) - 1.0)
    return np.where(freedom > 0.0, beyond, 0.0)


def statistics_of(
    inputs: Inputs,
    prepared: Prepared,
    fits: Fits,
    jacobian: Floats,
    settings: Settings,
    correlation: float,
) -> Statistics:
    """Statistics of W fitted windows.

    Parameters
    ----------
    inputs
        The model with I inputs, those of the plain model included.
    prepared, fits
        The windows, their starts fitted (one fit).
    jacobian
        (W, 3 T, n + 7) derivatives of the predictions over σ along the n parameters, the start and
        offsets of the tips; zero for a window that is left out.
    settings, correlation
        σ, and φ of the noise.
    """
    data = _data(prepared, fits, jacobian, correlation)
    ran = np.any(jacobian != 0.0, axis=(1, 2))
    none = np.zeros_like(data[0])
    kept = np.isfinite(prepared.seen).reshape(len(data), -1)
    each = [
        _one(inputs, rows if there else none, of & there)
        for rows, of, there in zip(data, kept, ran, strict=True)
    ]
    shared = _shared(inputs, each)
    return Statistics(
        chi2=np.array([one.chi2 for one in each]),
        freedom=np.array([one.freedom for one in each]),
        components=np.stack([one.components for one in each]),
        gains=np.array([[part.gain for part in one.parts] for one in each]),
        ranks=np.array([[part.rank for part in one.parts] for one in each], dtype=float),
        slack=np.stack([one.slack.estimate for one in each]) * settings.sigma,
        slack_sigma=np.stack([one.slack.error for one in each]) * settings.sigma,
        shared_gains=np.array([part.gain for part in shared]),
        shared_ranks=np.array([part.rank for part in shared], dtype=float),
        each=tuple(each),
    )


def channel_totals(found: Statistics) -> tuple[ChannelTotal, ...]:
    """By channel, in the order of `CHANNELS`; the last of gains and ranks are those of all inputs."""
    paid = found.gains - np.log(np.maximum(found.freedom, np.e))[:, None] * found.ranks
    worth = np.max(paid, axis=1) > 0.0  # windows that any stage explains
    free = np.maximum(np.sum(paid[worth], axis=0), 0.0)
    cost = np.log(max(float(found.freedom.sum()), np.e))
    common = np.maximum(found.shared_gains - cost * found.shared_ranks, 0.0)
    evidence = np.maximum(free, common)
    most = max(float(evidence.max()), cost)  # less than one input costs is nothing
    gains, ranks = found.gains.sum(axis=0), found.ranks.sum(axis=0)
    sigma = np.maximum(surprise(gains, ranks), surprise(found.shared_gains, found.shared_ranks))
    return tuple(
        ChannelTotal(
            channel=channel,
            evidence=float(evidence[k]),
            sigma=float(max(sigma[k], 0.0)),
            share=float(evidence[k] / most),
        )
        for k, channel in enumerate(CHANNELS)
    )


def left(found: Statistics) -> float | None:
    """Root mean square in σ of what the inputs of all stages together leave; None of no datum."""
    freedom = float(np.sum(found.freedom - found.ranks[:, -1]))
    if freedom <= 0.0:
        return None
    chi2 = float(np.sum(found.chi2 - found.gains[:, -1]))
    return float(np.sqrt(max(chi2, 0.0) / freedom))


def _data(prepared: Prepared, fits: Fits, jacobian: Floats, correlation: float) -> Floats:
    """(W, M, n + 4 + 7 + 3 + 1) white: inputs, start and offsets, ramps, residuals.

    Inputs are the n parameters, and offset and drift of the tips; ramps are of x, y, θ in σ/s.
    """
    seen = np.isfinite(prepared.seen)
    first, last = jacobian[..., -4:-2], jacobian[..., -2:]
    begin, end = prepared.instants[:, 0, None, None], prepared.instants[:, -1, None, None]
    tips = [first + last, begin * first + end * last]
    table = np.concatenate([jacobian[..., :-7], *tips, jacobian[..., -7:]], axis=-1)
    columns = np.moveaxis(table, -1, 0).reshape(-1, *seen.shape)
    ramps = np.zeros((3, *seen.shape))
    for axis in range(3):
        ramps[axis, ..., axis] = prepared.instants - prepared.instants[:, :1]
    white = whitened(np.concatenate([columns, ramps, fits.residuals]), seen, correlation)
    rows = np.moveaxis(white.reshape(*white.shape[:2], -1), 0, -1)
    # where tips were seen, their offsets are known a priori: one datum each; else they are none
    prior = np.zeros((len(seen), 4, rows.shape[-1]))
    prior[:, range(4), range(-8, -4)] = 1.0
    scale = prepared.tip_offset
    if scale:
        prior[..., -1] = -fits.offsets[0] / scale
    else:
        rows[..., -8:-4] = 0.0
    return np.concatenate([rows, prior], axis=1)


def _one(inputs: Inputs, rows: Floats, kept: Flags) -> Linear:
    count = inputs.count
    own = basis(rows[:, count:-4])
    left = rows - own @ (own.T @ rows)
    columns, ramps, data = left[:, :count], left[:, -4:-1], left[:, -1]
    # by how much each datum counts: what the start does not take of it
    weight = (1.0 - np.sum(own**2, axis=1))[: len(kept)] * kept
    expected = weight.reshape(-1, 3).sum(axis=0)
    squares = (data[: len(kept)] ** 2).reshape(-1, 3).sum(axis=0)
    return Linear(
        columns=columns,
        data=data,
        chi2=float(data @ data),
        freedom=float(round(expected.sum())),
        components=surprise(squares, expected),
        parts=tuple(solved(columns[:, list(of)], data) for of in inputs.free),
        slack=solved(ramps, data, _SHORTEST),
    )


def _shared(inputs: Inputs, each: list[Linear]) -> list[Solved]:
    """Effects of each channel, and of all, with one value in all windows."""
    whole = np.concatenate([one.columns for one in each])
    data = np.concatenate([one.data for one in each])
    base = basis(whole[:, : inputs.base])
    whole = whole - base @ (base.T @ whole)
    data = data - base @ (base.T @ data)
    return [solved(whole[:, list(of)], data) for of in inputs.shared]
