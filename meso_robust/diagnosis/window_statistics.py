"""What windows say: misfit, gains of hidden inputs and slacks, by least squares in white noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.diagnosis.document import Channel
from meso_robust.diagnosis.hidden_inputs import CHANNELS, Inputs, Solved, solved
from meso_robust.diagnosis.tangent import basis, whitened
from meso_robust.identification.prepared import Prepared
from meso_robust.identification.problem import Fits, Settings
from meso_robust.types import Flags, Floats

_SHORTEST = 1e-3  # σ: least length of a ramp of one σ a second


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
    inputs, errors
        (W, I) values of the inputs (`Inputs.units`, typical changes), and their standard errors; NaN where a window cannot tell.
    slack, slack_sigma
        (W, 3) twist beyond the model in m/s and rad/s, stage frame, and its standard errors.
    shared_gains, shared_ranks
        (C + 1,) the same as gains with one value of each input in all windows, the parameters of the
        plain model free.
    """

    chi2: Floats
    freedom: Floats
    components: Floats
    gains: Floats
    ranks: Floats
    inputs: Floats
    errors: Floats
    slack: Floats
    slack_sigma: Floats
    shared_gains: Floats
    shared_ranks: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelTotal:
    """How much hidden inputs at one stage explain, in all windows together.

    Attributes
    ----------
    channel
        The stage.
    gain, rank
        Fall of χ² with inputs free from window to window, and their number.
    shared_gain, shared_rank
        With inputs of one value in all windows.
    evidence
        The better of both, less what that many inputs cost (the logarithm of the number of data each);
        zero where neither pays.
    sigma
        The better of both in standard deviations of chance.
    share
        Evidence over that of all stages together, or of the best one if that is more.
    """

    channel: Channel
    gain: float
    rank: int
    shared_gain: float
    shared_rank: int
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
        inputs=np.stack([_placed(inputs, one.parts)[0] for one in each]),
        errors=np.stack([_placed(inputs, one.parts)[1] for one in each]),
        slack=np.stack([one.slack.estimate for one in each]) * settings.sigma,
        slack_sigma=np.stack([one.slack.error for one in each]) * settings.sigma,
        shared_gains=np.array([part.gain for part in shared]),
        shared_ranks=np.array([part.rank for part in shared], dtype=float),
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
            gain=float(gains[k]),
            rank=int(ranks[k]),
            shared_gain=float(found.shared_gains[k]),
            shared_rank=int(found.shared_ranks[k]),
            evidence=float(evidence[k]),
            sigma=float(max(sigma[k], 0.0)),
            share=float(evidence[k] / most),
        )
        for k, channel in enumerate(CHANNELS)
    )


@dataclass(frozen=True, slots=True, eq=False)
class _One:
    """One window: columns (M, I) and data (M,), what the start can take projected out."""

    columns: Floats
    data: Floats
    chi2: float
    freedom: float
    components: Floats
    parts: tuple[Solved, ...]
    slack: Solved


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


def _one(inputs: Inputs, rows: Floats, kept: Flags) -> _One:
    count = len(inputs.names)
    own = basis(rows[:, count:-4])
    left = rows - own @ (own.T @ rows)
    columns, ramps, data = left[:, :count], left[:, -4:-1], left[:, -1]
    # by how much each datum counts: what the start does not take of it
    weight = (1.0 - np.sum(own**2, axis=1))[: len(kept)] * kept
    expected = weight.reshape(-1, 3).sum(axis=0)
    squares = (data[: len(kept)] ** 2).reshape(-1, 3).sum(axis=0)
    return _One(
        columns=columns,
        data=data,
        chi2=float(data @ data),
        freedom=float(round(expected.sum())),
        components=surprise(squares, expected),
        parts=tuple(solved(columns[:, list(of)], data) for of in inputs.free),
        slack=solved(ramps, data, _SHORTEST),
    )


def _placed(inputs: Inputs, parts: tuple[Solved, ...]) -> tuple[Floats, Floats]:
    """(I,) estimates and errors of the channels at their columns."""
    values, errors = (np.full(len(inputs.names), np.nan) for _ in range(2))
    for of, part in zip(inputs.free[:-1], parts[:-1], strict=True):
        values[list(of)], errors[list(of)] = part.estimate, part.error
    return values, errors


def _shared(inputs: Inputs, each: list[_One]) -> list[Solved]:
    """Effects of each channel, and of all, with one value in all windows."""
    whole = np.concatenate([one.columns for one in each])
    data = np.concatenate([one.data for one in each])
    base = basis(whole[:, : inputs.base])
    whole = whole - base @ (base.T @ whole)
    data = data - base @ (base.T @ data)
    return [solved(whole[:, list(of)], data) for of in inputs.shared]
