"""Effects of the published catalogue, each as the plant's and its camera's own small law.

Names, parameters and units are those of the catalogue; the laws are the plant's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from meso_robust.plant.kernel import REFERENCE
from meso_robust.plant.laws import Laws

Pair = tuple[float, float]
_PLAIN = Laws()


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """What is true beyond the task: of the plant, the probes and the camera; um, s, rad."""

    laws: Laws = _PLAIN
    lay: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    """Deviation of the drag from its mean, along x and across, fixed in the part, then in the stage."""
    centre: Pair = (0.0, 0.0)
    """Of the drag, part's axes."""
    grown: Pair = (0.0, 0.0)
    """By how much the edges across x, and those across y, stand out."""
    tip_excess: float = 0.0
    """Of the tips' radius."""
    post: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Radius, x and y of a post that nobody knows of."""
    backlash: float = 0.0
    drift: Pair = (0.0, 0.0)
    """Of the probes, um/s."""
    latency: float = 0.0
    """By which frames are older than they say."""
    scale: float = 0.0
    """Relative excess of seen lengths."""
    rotation: float = 0.0
    """Of what is seen, counter-clockwise."""
    seen_drift: Pair = (0.0, 0.0)
    """Of what is seen, um/s."""
    k1: float = 0.0
    """Radial distortion, 1/um²."""
    offset: Pair = (0.0, 0.0)
    """Of the tracked point on the part."""


Values = Mapping[str, float]


def world_of(effects: Mapping[str, Values]) -> World:
    """The world with some effects of the catalogue.

    Parameters
    ----------
    effects
        ``{effect: {parameter: value}}``, values in the unit that the parameter's name ends in.

    Returns
    -------
    World
        With the laws of all.

    Raises
    ------
    ValueError
        An effect is not one of the plant's, or a parameter not one of the effect.
    """
    world = World()
    for name, values in effects.items():
        if name not in _EFFECTS:
            raise ValueError(f"effects.{name}: must be one of {', '.join(_EFFECTS)}")
        defaults, change = _EFFECTS[name]
        for key in values:
            if key not in defaults:
                raise ValueError(f"effects.{name}.{key}: must be one of {', '.join(defaults)}")
        world = change(world, {**defaults, **values})
    return world


def _laws(**of: Callable[[Values], float]) -> Callable[[World, Values], World]:
    """A change of the laws: each from the values."""

    def change(world: World, values: Values) -> World:
        given: dict[str, Any] = {name: law(values) for name, law in of.items()}
        return replace(world, laws=world.laws._replace(**given))

    return change


def _of(**of: Callable[[Values], Any]) -> Callable[[World, Values], World]:
    """A change of the rest."""
    return lambda world, values: replace(world, **{name: law(values) for name, law in of.items()})


def _lay(place: int) -> Callable[[World, Values], World]:
    def change(world: World, values: Values) -> World:
        lay, turn = list(world.lay), 2.0 * math.radians(values["direction_deg"])
        lay[place] += values["fraction"] * math.cos(turn)
        lay[place + 1] += values["fraction"] * math.sin(turn)
        return replace(world, lay=(lay[0], lay[1], lay[2], lay[3]))

    return change


def _take(key: str, factor: float = 1.0) -> Callable[[Values], float]:
    return lambda values: factor * values[key]


def _pair(x: str, y: str, factor: float = 1.0) -> Callable[[Values], Pair]:
    return lambda values: (factor * values[x], factor * values[y])


def _zero(*keys: str, **others: float) -> dict[str, float]:
    return dict.fromkeys(keys, 0.0) | others


_XY, _XY_S = ("x_um", "y_um"), ("x_um_s", "y_um_s")
_EFFECTS: Mapping[str, tuple[dict[str, float], Callable[[World, Values], World]]] = {
    "dry_friction": (_zero("ratio"), _laws(dry=_take("ratio", REFERENCE))),
    "stribeck_friction": (
        _zero("ratio", speed_um_s=30.0),
        _laws(stribeck=_take("ratio", REFERENCE), stribeck_speed=_take("speed_um_s")),
    ),
    "shear_thinning": (_zero("exponent_drop"), _laws(thinning=_take("exponent_drop"))),
    "anisotropic_drag": (_zero("fraction", "direction_deg"), _lay(2)),
    "part_anisotropic_drag": (_zero("fraction", "direction_deg"), _lay(0)),
    "drag_centre_offset": (_zero(*_XY), _of(centre=_pair(*_XY))),
    "drag_gradient": (
        _zero("x_per_mm", "y_per_mm"),
        _laws(gradient_x=_take("x_per_mm", 1e-3), gradient_y=_take("y_per_mm", 1e-3)),
    ),
    "drag_drift": (_zero("rate_percent_s"), _laws(growth=_take("rate_percent_s", 0.01))),
    "breakaway_friction": (
        _zero("ratio", distance_um=2.0),
        _laws(breakaway=_take("ratio", REFERENCE), breakaway_distance=_take("distance_um")),
    ),
    "uneven_support": (
        _zero("ratio", *_XY),
        _laws(uneven=_take("ratio", REFERENCE), uneven_x=_take("x_um"), uneven_y=_take("y_um")),
    ),
    "body_force": (_zero(*_XY_S), _laws(force_x=_take("x_um_s"), force_y=_take("y_um_s"))),
    "film_flow": (_zero(*_XY_S), _laws(flow_x=_take("x_um_s"), flow_y=_take("y_um_s"))),
    "wall_capillarity": (
        _zero("pull_um_s", "direction_deg", "position_um", range_um=300.0),
        _laws(
            wall=_take("pull_um_s"),
            wall_angle=_take("direction_deg", math.pi / 180.0),
            wall_place=_take("position_um"),
            wall_range=_take("range_um"),
        ),
    ),
    "unmodelled_wall": (
        _zero("radius_um", *_XY),
        _of(post=lambda values: (values["radius_um"], values["x_um"], values["y_um"])),
    ),
    "tip_adhesion": (
        _zero("pull_um_s", range_um=2.0),
        _laws(adhesion=_take("pull_um_s"), adhesion_range=_take("range_um")),
    ),
    "tip_attraction": (
        _zero("pull_um_s", range_um=5.0),
        _laws(attraction=_take("pull_um_s"), attraction_range=_take("range_um")),
    ),
    "edge_dependent_friction": (
        _zero("change", "edge"),
        _laws(edge_change=_take("change"), edge=lambda values: int(values["edge"])),
    ),
    "part_geometry": (_zero(*_XY), _of(grown=_pair(*_XY))),
    "tip_radius": (_zero("excess_um"), _of(tip_excess=_take("excess_um"))),
    "reference_offset": (_zero(*_XY), _of(offset=_pair(*_XY))),
    "probe_compliance": (_zero("time_ms"), _laws(compliance=_take("time_ms", 1e-3))),
    "backlash": (_zero("width_um"), _of(backlash=_take("width_um"))),
    "probe_drift": (_zero(*_XY_S), _of(drift=_pair(*_XY_S))),
    "camera_latency": (_zero("time_ms"), _of(latency=_take("time_ms", 1e-3))),
    "camera_scale": (_zero("percent"), _of(scale=_take("percent", 0.01))),
    "camera_rotation": (_zero("angle_deg"), _of(rotation=_take("angle_deg", math.pi / 180.0))),
    "camera_drift": (_zero(*_XY_S), _of(seen_drift=_pair(*_XY_S))),
    "lens_distortion": (_zero("k1_per_mm2"), _of(k1=_take("k1_per_mm2", 1e-6))),
}
"""Of every effect the parameters with their defaults, and what it changes."""
