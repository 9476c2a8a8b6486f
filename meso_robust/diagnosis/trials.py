"""What to try of each effect: one line an effect.

A trial names the numbers of an effect that are fitted, by how much each is changed to see what it
does (a change that would matter to a plan), and the values that the search starts from. Numbers are
for a part of 1.6 mm pushed at 75 µm/s and are scaled to the recordings at hand.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from meso_robust.diagnosis.periods import driven, periods
from meso_robust.identification.prepared import Prepared
from meso_robust.identification.touching import distances
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.simulator.stage import FORM, REFERENCE_SPEED
from meso_robust.types import Floats

REFERENCE_LENGTH = 910e-6
"""Characteristic length in m of the part that the numbers are for."""
_POST = 50.0  # µm, radius of a post that a search begins with
_CLOSE = 10.0  # µm within which a post may stand of what was seen of the part


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One way to try an effect, in the units of the catalogue.

    Attributes
    ----------
    effect
        Name.
    sizes
        ``{key: change}``, numbers that are zero without the effect; each is a direction to search in.
    shape
        ``{key: value}`` of numbers that give the effect its form, as the search starts.
    free
        ``{key: change}`` of those among them that are fitted; the others are held.
    """

    effect: str
    sizes: Mapping[str, float]
    shape: Mapping[str, float] = field(default_factory=dict)
    free: Mapping[str, float] = field(default_factory=dict)

    @property
    def scales(self) -> dict[str, float]:
        """Fitted numbers with their typical changes."""
        return {**self.sizes, **self.free}

    @property
    def law(self) -> float:
        """Number of the form of the effect's law."""
        return self.shape.get(FORM, 0.0)

    @property
    def held(self) -> dict[str, float]:
        """Numbers that stay as they are."""
        return {key: value for key, value in self.shape.items() if key not in self.free}


Forms = Callable[[str, Prepared], Iterable[Trial]]
"""Trials of the effect of a name in some recordings."""


@dataclass(frozen=True, slots=True)
class Try:
    """What to do about an effect.

    Attributes
    ----------
    shown_by
        The push that would show it.
    forms
        What to try of it.
    """

    shown_by: str
    forms: Forms


def sized(**sizes: float) -> Forms:
    """An effect that has sizes only."""
    return lambda effect, _: [Trial(effect=effect, sizes=sizes)]


def shaped(size: Mapping[str, float], free: Mapping[str, float], **grid: Iterable[float]) -> Forms:
    """An effect whose form is searched from every point of a grid."""
    keys, values = list(grid), [list(one) for one in grid.values()]
    shapes = [dict(zip(keys, point, strict=True)) for point in itertools.product(*values)]
    return lambda effect, _: [
        Trial(effect=effect, sizes=size, shape=shape, free=free) for shape in shapes
    ]


def formed(*laws: Forms) -> Forms:
    """An effect with a search of its own for each form of its law."""
    return lambda effect, prepared: [
        replace(one, shape={**one.shape, FORM: float(law)})
        for law, forms in enumerate(laws)
        for one in forms(effect, prepared)
    ]


def _edges(effect: str, prepared: Prepared) -> Iterable[Trial]:
    for edge in range(len(prepared.outline)):
        yield Trial(effect=effect, sizes={"change": 0.2}, shape={"edge": float(edge)})


def _tips(effect: str, prepared: Prepared) -> Iterable[Trial]:
    """The friction of every tip but the first is measured against that one's."""
    for tip in range(1, prepared.waypoints.shape[2]):
        yield Trial(effect=effect, sizes={"change": 0.2}, shape={"tip": float(tip)})


def _worn(effect: str, prepared: Prepared) -> Iterable[Trial]:
    """Every tip alike, and each tip by itself where some of the pushes are made with two."""
    for form in range(len(CATALOGUE[effect].forms) if prepared.waypoints.shape[2] > 1 else 1):
        yield Trial(effect=effect, sizes={"excess_um": 2.0}, shape={FORM: float(form)})


def _late_tips(effect: str, prepared: Prepared) -> Iterable[Trial]:
    """Each tip by itself, where some of the pushes are made with two: both alike are a late camera, or a late log."""
    for form in range(len(CATALOGUE[effect].forms) if prepared.waypoints.shape[2] > 1 else 0):
        yield Trial(effect=effect, sizes={"time_ms": 20.0}, shape={FORM: float(form)})


def _meniscus(effect: str, prepared: Prepared) -> Iterable[Trial]:
    """Walls in eight directions, as near as the part ever came; strength and place are one number."""
    scale = 1e6 * REFERENCE_LENGTH / prepared.length
    places = prepared.seen[..., :2]
    for direction in np.arange(0.0, 360.0, 45.0).tolist():
        normal = np.array([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
        nearest = scale * float(np.nanmax(places @ normal))
        for reach in (150.0, 500.0):
            shape = {"direction_deg": direction, "position_um": nearest, "range_um": reach}
            yield Trial(
                effect=effect,
                sizes={"pull_um_s": 1.0},
                shape=shape,
                free={"direction_deg": 20.0, "range_um": 50.0},
            )


def _slowing(**sizes: float) -> Forms:
    """A drift that slows down in the time of the shortest recording."""

    def forms(effect: str, prepared: Prepared) -> Iterable[Trial]:
        lasted = float(np.min(prepared.times[:, -1] - prepared.times[:, 0]))
        yield Trial(
            effect=effect, sizes=sizes, shape={"time_s": lasted}, free={"time_s": 0.5 * lasted}
        )

    return forms


def _creeping(effect: str, prepared: Prepared) -> Iterable[Trial]:
    """Times a factor apart: from one that is far off the misfit is flat."""
    for time in (0.2, 0.7, 2.5):
        yield Trial(
            effect=effect,
            sizes={"percent": 3.0},
            shape={"fade_s": time},
            free={"fade_s": 0.3 * time},
        )


def _posts(effect: str, prepared: Prepared) -> Iterable[Trial]:
    """Posts about the last poses that no part was ever seen to overlap."""
    scale = 1e6 * REFERENCE_LENGTH / prepared.length
    centres = _rim(prepared, _POST / scale)
    gaps = _least_gaps(prepared, centres)
    for centre in scale * centres[gaps > (_POST - _CLOSE) / scale]:
        yield Trial(
            effect=effect,
            sizes={},
            shape={"radius_um": _POST, "x_um": float(centre[0]), "y_um": float(centre[1])},
            free={"x_um": 5.0, "y_um": 5.0, "radius_um": 10.0},
        )


def _rim(prepared: Prepared, away: float) -> Floats:
    """(N, 2) places around the last pose of every recording, a distance in m off its outline."""
    outline = prepared.outline
    points = []
    for poses in prepared.seen:
        x, y, theta = poses[np.all(np.isfinite(poses), axis=1)][-1]
        turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
        for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
            side = end - start
            normal = np.array([side[1], -side[0]]) / np.hypot(*side)
            for share in (0.05, 0.3, 0.5, 0.7, 0.95):
                points.append(turn @ (start + share * side + away * normal) + [x, y])
    return np.array(points)


def _least_gaps(prepared: Prepared, points: Floats) -> Floats:
    """(N,) least distance in m of points from all poses of the part that were seen."""
    least = np.full(len(points), np.inf)
    for seen in prepared.seen[:, ::4]:
        x, y, theta = seen[np.all(np.isfinite(seen), axis=1)].T[..., None]
        dx, dy = points[:, 0] - x, points[:, 1] - y
        near = np.hypot(dx, dy) < 1.5 * prepared.length
        cos, sin = np.cos(theta), np.sin(theta)
        own = np.stack([cos * dx + sin * dy, cos * dy - sin * dx], axis=-1)
        gaps = np.full(near.shape, np.inf)
        gaps[near] = distances(prepared.outline[None], own[near])[0]
        least = np.minimum(least, gaps.min(axis=0, initial=np.inf))
    return least


def shown(prepared: Prepared) -> Floats:
    """(2, 2) least and largest x and y in m of what the images show of the part at least."""
    places = prepared.seen[..., :2].reshape(-1, 2)
    reach = np.linalg.norm(prepared.outline, axis=1).max()
    return np.array([np.nanmin(places, axis=0) - reach, np.nanmax(places, axis=0) + reach])


def _about_a_place(size: Mapping[str, float], **shape: float) -> Forms:
    """An error of the image about the origin of the stage, or about a place that the image shows; with numbers of its form."""

    def forms(effect: str, prepared: Prepared) -> Iterable[Trial]:
        yield Trial(effect=effect, sizes=size, shape=shape, free=shape)
        scale = 1e6 * REFERENCE_LENGTH / prepared.length
        ends = scale * shown(prepared)
        places = itertools.product(*np.quantile(ends, (0.25, 0.75), axis=0).T.tolist())
        for x, y in ((0.0, 0.0), *places):
            yield Trial(
                effect=effect,
                sizes=size,
                shape={"about_x_um": x, "about_y_um": y, **shape},
                free={"about_x_um": 100.0, "about_y_um": 100.0, **shape},
            )

    return forms


def _places(prepared: Prepared) -> list[tuple[float, float]]:
    """Five places in µm among those at which the part was seen, for a part of the reference length."""
    scale = 1e6 * REFERENCE_LENGTH / prepared.length
    seen = prepared.seen[..., :2].reshape(-1, 2)
    low, middle, high = (scale * np.nanquantile(seen, (0.15, 0.5, 0.85), axis=0)).tolist()
    return [(middle[0], middle[1]), *itertools.product((low[0], high[0]), (low[1], high[1]))]


def _somewhere(**size: float) -> Forms:
    """An effect of a place of the stage that reaches some way around it."""
    (reach,) = (key for key in ("radius_um", "range_um") if key in size)
    sizes = {key: value for key, value in size.items() if key != reach}

    def forms(effect: str, prepared: Prepared) -> Iterable[Trial]:
        for x, y in _places(prepared):
            yield Trial(
                effect=effect,
                sizes=sizes,
                shape={"x_um": x, "y_um": y, reach: size[reach]},
                free={"x_um": 50.0, "y_um": 50.0, reach: 50.0},
            )

    return forms


def _waves(key: str, place: Callable[[Prepared], Floats]) -> Forms:
    """A wave on each axis, of the periods that stand out in what is seen of the part."""

    def forms(effect: str, prepared: Prepared) -> Iterable[Trial]:
        scale = 1e6 * REFERENCE_LENGTH / prepared.length
        sizes = {f"{axis}_{wave}_um": 0.5 for axis in "xy" for wave in ("sine", "cosine")}
        # forms are of tips that move together
        many = len(CATALOGUE[effect].forms) if prepared.waypoints.shape[2] > 1 else 1
        for period, form in itertools.product(
            periods(prepared, place(prepared)), range(max(many, 1))
        ):
            yield Trial(
                effect=effect,
                sizes=sizes,
                shape={
                    key: scale * period,
                    **({FORM: float(form)} if CATALOGUE[effect].forms else {}),
                },
                free={key: 0.03 * scale * period},
            )

    return forms


_LAYS = (0.0, 22.5, 45.0, 67.5)
_QUARTERS = (0.0, 45.0, 90.0, 135.0)
_DRIFT = formed(sized(x_um_s=0.3, y_um_s=0.3), _slowing(x_um_s=0.3, y_um_s=0.3))

TRIALS: Mapping[str, Try] = {
    "dry_friction": Try(
        "one push off the centre at three speeds, a decade apart", sized(ratio=0.1)
    ),
    "stribeck_friction": Try(
        "one push off the centre at three slow speeds",
        shaped({"ratio": 0.1}, {"speed_um_s": 15.0}, speed_um_s=(10.0, 30.0, 100.0)),
    ),
    "shear_thinning": Try(
        "pushes off the centre and through it, on a film known to be without dry contact",
        formed(
            sized(exponent_drop=0.05),
            shaped({"exponent_drop": 0.1}, {"speed_um_s": 15.0}, speed_um_s=(15.0, 60.0)),
        ),
    ),
    "anisotropic_drag": Try(
        "one push repeated with part and push turned by 90° on the stage",
        shaped({"fraction": 0.05}, {"direction_deg": 20.0}, direction_deg=_LAYS),
    ),
    "part_anisotropic_drag": Try(
        "slanted pushes on a long and on a short edge",
        shaped({"fraction": 0.05}, {"direction_deg": 20.0}, direction_deg=_LAYS),
    ),
    "drag_centre_offset": Try(
        "a push through the centre from each of two opposite edges", sized(x_um=10.0, y_um=10.0)
    ),
    "drag_gradient": Try(
        "one push repeated 1 mm away along x and along y", sized(x_per_mm=0.05, y_per_mm=0.05)
    ),
    "drag_drift": Try(
        "a force sensor at the tip; motion alone does not depend on the drag of the film",
        sized(rate_percent_s=1.0),
    ),
    "breakaway_friction": Try(
        "one push after rests of 1 s, 10 s and 100 s",
        shaped({"ratio": 0.1}, {"distance_um": 2.0}, distance_um=(2.0, 20.0)),
    ),
    "uneven_support": Try(
        "one push repeated with the part turned by 180°, both senses of rotation",
        shaped(
            {"ratio": 0.1},
            {"x_um": 50.0, "y_um": 50.0},
            x_um=(-120.0, 120.0),
            y_um=(-60.0, 60.0),
        ),
    ),
    "body_force": Try(
        "five seconds of camera before the tip comes, at two headings of the stage",
        formed(
            sized(x_um_s=0.5, y_um_s=0.5),
            shaped(
                {"x_um_s": 0.5, "y_um_s": 0.5, "growth_um_s_per_mm": 0.5},
                {"direction_deg": 20.0},
                direction_deg=_QUARTERS,
            ),
        ),
    ),
    "film_flow": Try(
        "five seconds of camera before the tip comes, with the stage tilted and level",
        sized(x_um_s=0.5, y_um_s=0.5),
    ),
    "point_pull": Try(
        "camera without tip, the part put down around the place",
        _somewhere(pull_um_s=1.0, range_um=300.0),
    ),
    "sticky_spot": Try(
        "one push repeated over the place and beside it", _somewhere(ratio=0.1, radius_um=300.0)
    ),
    "wall_capillarity": Try("camera without tip near the wall and away from it", _meniscus),
    "unmodelled_wall": Try("a push across the place in doubt", _posts),
    "tip_adhesion": Try(
        "draw the tip back slowly after a push and keep the camera running",
        shaped({"pull_um_s": 2.0}, {"range_um": 1.0}, range_um=(1.0, 5.0)),
    ),
    "tip_attraction": Try(
        "approach slowly, stop 5 µm before contact and wait",
        shaped({"pull_um_s": 2.0}, {"range_um": 2.0}, range_um=(3.0, 10.0)),
    ),
    "edge_dependent_friction": Try("slanted pushes that slip, one on each edge", _edges),
    "friction_spread": Try("pushes that slip, with each tip by itself", _tips),
    "friction_speed": Try(
        "one push that slips, at three speeds",
        formed(
            *2 * [shaped({"change": 0.2}, {"speed_um_s": 10.0}, speed_um_s=(5.0, 30.0))],
        ),
    ),
    "friction_drift": Try(
        "long pushes that slip", formed(sized(rate_percent_s=3.0), _slowing(rate_percent_s=3.0))
    ),
    "inertia": Try(
        "stop suddenly at the highest speed and keep the camera running", sized(time_ms=2.0)
    ),
    "part_geometry": Try(
        "a push through the centre from each of four edges", sized(x_um=3.0, y_um=3.0)
    ),
    "part_skew": Try(
        "a push through the centre from each of four edges",
        formed(*5 * [sized(angle_deg=0.3)]),
    ),
    "tip_radius": Try(
        "approaches to all four edges with each tip, contact seen at high frame rate", _worn
    ),
    "reference_offset": Try("pushes that turn the part by 20° or more", sized(x_um=3.0, y_um=3.0)),
    "part_yaw": Try("pushes on four edges at several headings", sized(angle_deg=0.2)),
    "probe_compliance": Try(
        "stop suddenly at the highest speed and keep the camera running",
        formed(
            sized(time_ms=10.0),
            shaped({"time_ms": 10.0}, {"direction_deg": 20.0}, direction_deg=_QUARTERS),
            shaped(
                {"time_ms": 10.0},
                {"direction_deg": 20.0, "across": 0.3},
                direction_deg=_QUARTERS,
                across=(0.3,),
            ),
        ),
    ),
    "backlash": Try(
        "approach with and without a reversal just before contact", sized(width_um=2.0)
    ),
    "leadscrew_error": Try(
        "one long push along each axis, repeated a quarter of a turn of the screw further on",
        _waves("period_um", driven),
    ),
    "tip_latency": Try("a push with both tips, and one with each", _late_tips),
    "probe_creep": Try(
        "stop on the part after a long push and keep the camera running for ten seconds",
        _creeping,
    ),
    "probe_drift": Try("hold the tip on the part for ten seconds", _DRIFT),
    "camera_latency": Try("one push at three speeds, with sudden stops", sized(time_ms=20.0)),
    "log_latency": Try("one push at three speeds, with sudden stops", sized(time_ms=20.0)),
    "clock_rate": Try(
        "one long push, and the same one after a rest of ten seconds", sized(percent=1.0)
    ),
    "camera_scale": Try(
        "long pushes along x and along y; a calibration grid", _about_a_place({"percent": 0.3})
    ),
    "camera_rotation": Try(
        "long pushes along x and along y; a calibration grid", _about_a_place({"angle_deg": 0.2})
    ),
    "camera_drift": Try("ten seconds of camera without any motion", _DRIFT),
    "lens_distortion": Try(
        "pushes in the corners of the image; a calibration grid",
        _about_a_place({"k1_per_mm2": 0.003}, turned=0.5),
    ),
    "camera_anisotropy": Try(
        "long pushes along x, along y and along both diagonals; a calibration grid",
        # two forms: a tracker that fits an outline as a whole, and one that follows its long axis
        shaped({"x_percent": 0.3, "y_percent": 0.3, "shear_percent": 0.3}, {}, turned=(0.0, 1.0)),
    ),
    "angle_error": Try(
        "the part turned in steps by a goniometer", sized(sine_deg=0.2, cosine_deg=0.2)
    ),
    "pixel_locking": Try(
        "slow pushes along x and along y, at a higher magnification",
        _waves("pitch_um", lambda prepared: prepared.seen[..., :2]),
    ),
    "registration_shift": Try(
        "pushes on four edges at several headings", sized(x_um=3.0, y_um=3.0)
    ),
}
"""What to try of each effect, and the push that would show it; without a line, see `tried`."""


BESIDE = frozenset({"registration_shift"})
"""Effects that are tried beside others only where the part lies alike in all recordings. There a reference offset of the
part moves the tips as a shift between robot and camera does, and an answer would have to name both; but what a strong
effect leaves may be a shift."""
_ALIKE = 0.9  # mean of the parts' directions as unit vectors, from which on they lie alike
NOT_SEARCHED = frozenset({"residual"})
"""Effects that the search leaves out: a residual is no name for anything."""


def trials(prepared: Prepared, *, beside: bool = False) -> list[Trial]:
    """Trials of all effects that are tried by themselves, or only beside others, scaled to the recordings."""
    alike = bool(np.abs(np.mean(np.exp(1j * prepared.starts[:, 2]))) > _ALIKE)
    return [
        trial
        for name in CATALOGUE
        if name not in NOT_SEARCHED and (name in BESIDE and alike) == beside
        for trial in trials_of(name, prepared)
    ]


def trials_of(effect: str, prepared: Prepared) -> list[Trial]:
    """Trials of one effect, scaled to the recordings."""
    length = prepared.length / REFERENCE_LENGTH
    speed = typical_speed(prepared) / REFERENCE_SPEED
    return [
        law
        for one in tried(effect).forms(effect, prepared)
        for law in _laws(_scaled(one, length, speed))
    ]


def _laws(trial: Trial) -> list[Trial]:
    """The trial with every form of the effect's law, unless it is of one."""
    forms = CATALOGUE[trial.effect].forms
    if not forms or FORM in trial.shape:
        return [trial]
    return [replace(trial, shape={**trial.shape, FORM: float(k)}) for k in range(len(forms))]


def tried(effect: str) -> Try:
    """What to do about an effect; one without a line has each of its sizes tried by one unit."""
    if effect in TRIALS:
        return TRIALS[effect]
    sizes = {one.key: 1.0 for one in CATALOGUE[effect].parameters if one.size}
    return Try("pushes on all edges, at three speeds, places and headings", sized(**sizes))


def typical_speed(prepared: Prepared) -> float:
    """Median speed in m/s of the probes while they move."""
    way = np.linalg.norm(np.diff(prepared.waypoints, axis=1), axis=-1).max(axis=-1)
    time = np.diff(prepared.times, axis=1)
    moving = way > 0.0
    return float(np.median(way[moving] / time[moving])) if np.any(moving) else REFERENCE_SPEED


def _scaled(trial: Trial, length: float, speed: float) -> Trial:
    def turned(values: Mapping[str, float]) -> dict[str, float]:
        return {key: value * _factor(key, length, speed) for key, value in values.items()}

    return Trial(
        effect=trial.effect,
        sizes=turned(trial.sizes),
        shape=turned(trial.shape),
        free=turned(trial.free),
    )


def _factor(key: str, length: float, speed: float) -> float:
    """By what a number of this name grows with the lengths and speeds of an experiment."""
    factors = (
        ("_um_s_per_mm", speed / length),
        ("_per_mm2", length**-2),
        ("_per_mm", 1.0 / length),
        ("_um_s", speed),
        ("_um", length),
        ("_percent_s", speed / length),
        ("_ms", length / speed),
        ("ratio", speed),
    )
    return next((factor for end, factor in factors if key.endswith(end)), 1.0)
