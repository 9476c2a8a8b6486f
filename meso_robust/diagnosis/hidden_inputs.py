"""Hidden inputs: what could act at each stage of the chain, constant within a window.

They are the simulator's own effects, so that friction, sticking and separation stay in force.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.diagnosis.document import Channel
from meso_robust.identification.models.model import Model, Parameter, with_effects
from meso_robust.simulator import Effects
from meso_robust.simulator.environment import FLOW_SLOTS
from meso_robust.simulator.support import FILM_SLOTS, THINNING
from meso_robust.types import Floats

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
    "body_force": {"x_um_s": 0.5, "y_um_s": 0.5},
    "tip_radius": {"excess_um": 1.0},
    "part_geometry": {"x_um": 1.0, "y_um": 1.0},
}
"""Effects, and changes that show by about one standard deviation in a window."""
TIP_OFFSET = 1e-6
"""m: unit of the inputs that shift the tips; of their drift, in a second from the recording's start."""
TIPS = ("tip_offset.x_um", "tip_offset.y_um", "tip_drift.x_um_s", "tip_drift.y_um_s")
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inputs:
    """A model with hidden inputs: n parameters, and offset and drift of the tips.

    Attributes
    ----------
    model
        The extended model.
    base
        Parameters of the plain model.
    names
        (n + 4,) names, with their units.
    units
        (n + 4,) what one of an input is, in the unit of its name.
    free, shared
        (C + 1,) columns of the inputs of each channel that differ from window to window, and of those
        that do not, in the order of `CHANNELS`; last those of all.
    spans
        (1, n) steps of the differences, in coordinates.
    """

    model: Model
    base: int
    names: tuple[str, ...]
    units: Floats
    free: tuple[tuple[int, ...], ...]
    shared: tuple[tuple[int, ...], ...]
    spans: Floats


def with_inputs(model: Model) -> Inputs:
    """Add the hidden inputs of every channel to a model.

    Friction at the tips is the model's input to the contact, its other parameters to the support.
    What changes the drag of a film is left out of a model without one.
    """
    extended = with_effects(model, _applicable(model))
    base, parameters = len(model.parameters), extended.parameters
    kinds = [_kind(parameter, k < base) for k, parameter in enumerate(parameters)]
    tips = ["offset", "offset", "drift", "drift"]
    return Inputs(
        model=extended,
        base=base,
        names=(*extended.keys, *TIPS),
        units=np.array([*[1.0 if p.log else p.shown(p.scale) for p in parameters], *[1.0] * 4]),
        free=_columns([*kinds, *tips], _FREE),
        shared=_columns([*kinds, *tips], _SHARED),
        spans=np.array([_span(kind, k < base) for k, kind in enumerate(kinds)])[None],
    )


def _applicable(model: Model) -> dict[str, dict[str, float]]:
    """The effects that have a meaning for the support of a model."""
    sample = model.physics(model.draw(np.random.default_rng(0), 1))
    if np.all(sample.support.tables().film[:, 0] > 0.0):
        return _SCALES
    drag = (*FILM_SLOTS, *FLOW_SLOTS, THINNING)
    return {name: of for name, of in _SCALES.items() if not Effects({name: of}).is_on(*drag)}


def _span(kind: str, plain: bool) -> float:
    """Step of a difference, in coordinates."""
    if not plain:
        return 1.0
    return _SLIP if kind == "mu" else _STEP


def _kind(parameter: Parameter, plain: bool) -> str:
    """Name of an effect, or what a parameter of the plain model stands for."""
    if parameter.unseen:
        return ""
    effect = parameter.key.split(".")[0]
    if plain:
        return "mu" if effect in ("mu", "mu_t") else "rho"
    return effect


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


_TOLD = 0.1  # σ: least length of a direction, in typical changes, that a window can tell


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
