"""The task as the model says it is: ranges replaced, errors enlarged, each with what it was before."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.errors import InputError
from meso_robust.identification.document import ModelDocument, PartSection
from meso_robust.primitives.setup import Block, Setup, setup_of
from meso_robust.task import POINT_TIPS, ROUND_TIPS as REAL, Part, PolygonPart, Task, parse_task
from meso_robust.transfer.assumption_check import FRICTION, RATIO, ROUND_TIPS, Standing, by_name
from meso_robust.transfer.inflation import NOTHING, Absorbed, Ends, Post, rounded_up, spelled

_SAME = 1e-6  # of a length: two statements of it that differ by less are the same
_LOST = 1e-9  # um and deg: far more than doubles of a few thousand lose
_FINE = 10**6  # steps of a friction coefficient, a ratio in um^2 or a percentage


Corners = tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A value of the task before and after."""

    key: str
    before: str
    after: str
    because: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Changed:
    """The changed task, and what it cannot say: a post."""

    task: Task
    changes: tuple[Change, ...]
    posts: tuple[Post, ...]

    @property
    def keys(self) -> frozenset[str]:
        """Of the task's values that are the model's now, such as ``uncertainty.friction``."""
        return frozenset(one.key for one in self.changes)

    @property
    def wider(self) -> bool:
        """Whether the promise is about more than the changed task says."""
        return bool(self.posts)

    def setup(self) -> Setup:
        """The changed task with the posts as walls."""
        known = setup_of(self.task)
        return replace(known, blocks=(*known.blocks, *(_block(post) for post in self.posts)))


def check_part(task: Task, document: ModelDocument, source: str) -> None:
    """Refuse a model of another part.

    Raises
    ------
    InputError
        The model's part is not the task's.
    """
    was, stated = _corners(document.part), _corners(task.part)
    if len(was) != len(stated) or not _is_same(was, stated):
        raise InputError(
            f"{source}: key part: {_shape(document.part)}; must be the part of the task, {_shape(task.part)}, "
            "because ρ and μ hold for the part that was pushed; identify with recordings of this part, "
            "or correct the task"
        )


def _corners(part: PartSection | Part | PolygonPart) -> Corners:
    """Counter-clockwise, um."""
    if not isinstance(part, Part) and part.polygon_um is not None:
        return tuple((x, y) for x, y in part.polygon_um)
    a, b = (0.5 * side for side in _sides(part))
    return (-a, -b), (a, -b), (a, b), (-a, b)


def _sides(part: PartSection | Part | PolygonPart) -> Ends:
    """Length and width of a rectangle, um."""
    if isinstance(part, PolygonPart):
        return NOTHING
    return part.length_um or 0.0, part.width_um or 0.0


def _is_same(one: Corners, other: Corners) -> bool:
    """Whether corners are the same, whichever is the first."""
    within = _SAME * max(math.hypot(x, y) for x, y in other)
    return any(
        all(math.dist(a, b) <= within for a, b in zip(one[k:] + one[:k], other, strict=True))
        for k in range(len(one))
    )


def _shape(part: PartSection | Part | PolygonPart) -> str:
    sides, corners = _sides(part), _corners(part)
    if sides != NOTHING:
        return f"{sides[0]:g} x {sides[1]:g} um"
    return f"a polygon of {len(corners)} corners, the first at ({corners[0][0]:g}, {corners[0][1]:g}) um"


def changed(
    task: Task, document: ModelDocument, found: Iterable[Standing], speed_um_s: float | None = None
) -> Changed:
    """Write what the model says into the task; what is not absorbed leaves it as it is.

    Parameters
    ----------
    task, document, found
        As the user stated it; the model; how it stands to the premises.
    speed_um_s
        Of the probes, if it is to be another than the task's.

    Raises
    ------
    InputError
        The changed task breaks a rule of tasks, for example an error out of its range.
    """
    standings = by_name(tuple(found))
    absorbed = [one.absorbed for one in standings.values() if one.absorbed is not None]
    before = task.model_dump(mode="json", by_alias=True, exclude_none=True)
    after = {
        **before,
        "part": {**before["part"], **_part(before["part"], absorbed)},
        "probe": {**before["probe"], "speed_um_s": speed_um_s or task.probe.speed_um_s},
        "uncertainty": {
            **before["uncertainty"],
            **_ranges(document, standings),
            **_errors(before["uncertainty"], absorbed),
        },
    }
    if task.schema_ != POINT_TIPS or _is_real(absorbed, after["part"], document):
        _make_real(after, task, document, absorbed)
    because = _reasons(standings)
    return Changed(
        task=parse_task(after, "the task with the model's ranges"),
        changes=tuple(
            Change(
                key=f"{section}.{key}",
                before="exact" if old is None else _told(old),
                after=_told(new),
                because=because[key],
            )
            for section in ("part", "probe", "uncertainty")
            for key, new in after[section].items()
            if (old := before[section].get(key)) != new and key != "friction_common"
        ),
        posts=tuple(one.post for one in absorbed if one.post is not None),
    )


def _is_real(
    absorbed: Sequence[Absorbed], part: Mapping[str, float], document: ModelDocument
) -> bool:
    """Whether the model says what only a task of schema 2 can."""
    plain = Absorbed(said="")
    fields = ("radius_um", "drag_centre_um", "anisotropy", "friction", "wander_um", "drift_um_s")
    return (
        "size_tolerance_um" in part
        or bool(document.probe and document.probe.tip_radius_um)
        or any(getattr(one, field) != getattr(plain, field) for one in absorbed for field in fields)
    )


def _make_real(
    values: dict[str, Any], task: Task, document: ModelDocument, absorbed: Sequence[Absorbed]
) -> None:
    """Write radii, the film's unevenness and the travel's errors; what was exact before stays so."""
    u = values["uncertainty"]
    if task.schema_ == POINT_TIPS:
        values["schema"] = REAL
        u["friction_common"] = True
    values["probe"] = {**values["probe"], **_radii(task, document, absorbed)}
    low, high = 1.0, 1.0
    for one in absorbed:
        low, high = low * one.friction[0], high * one.friction[1]
    if (low, high) != (1.0, 1.0):
        u["friction_common"] = False
        u["friction"] = _outward(u["friction"][0] * low, u["friction"][1] * high)
    for key, field in (("drag_centre_um", "drag_centre_um"), ("probe_wander_um", "wander_um")):
        more = sum(spelled(getattr(one, field)) for one in absorbed)
        if more:
            u[key] = rounded_up(spelled(u.get(key, 0.0)) + more)
    if any(one.centre_moves for one in absorbed):
        u["drag_centre_moves"] = True
    for share in (one.ratio_share for one in absorbed if one.ratio_share):
        percent = u["film_ratio_percent"]
        u["film_ratio_percent"] = rounded_up(percent + share * (100.0 + percent))
    for share in (one.anisotropy for one in absorbed if one.anisotropy):
        known = u.get("drag_anisotropy_percent", 0.0)
        u["drag_anisotropy_percent"] = rounded_up(known + share * (200.0 + known))
    _drift(u, sum(one.drift_um_s for one in absorbed) / values["probe"]["speed_um_s"])


def _drift(u: dict[str, Any], share: float) -> None:
    """A drift of a share of the speed turns a travel by no more than its arcsine, and stretches it."""
    if not share:
        return
    low, high = u.get("travel_direction_deg", NOTHING)
    turn = rounded_up(math.degrees(math.asin(share)))
    u["travel_direction_deg"] = [low - turn, high + turn]
    known = u.get("travel_scale_percent", 0.0)
    u["travel_scale_percent"] = rounded_up(known + share * (100.0 + known))


def _radii(
    task: Task, document: ModelDocument, absorbed: Sequence[Absorbed]
) -> dict[str, list[float]]:
    """Radii of the tips: of the task or, where they do not hold it, the recordings'; and as the model corrects them."""
    stated = 0.0 if document.probe is None else document.probe.tip_radius_um
    by = [sum(spelled(one.radius_um[k]) for one in absorbed) for k in (0, 1)]
    active, passive = task.probe.tip_radius_um, task.probe.passive_tip_radius_um
    found = {}
    # recordings state a radius and do not measure it: within what the task states it says nothing more
    if active is None or (stated and not active[0] <= stated <= active[1]):
        active = (stated, stated)
    for key, ends in (("tip_radius_um", active), ("passive_tip_radius_um", passive)):
        if ends is not None:
            low = math.floor((spelled(ends[0]) + by[0]) * 100) / 100
            found[key] = [max(low, 0.0), rounded_up(spelled(ends[1]) + by[1])]
    return found


def _part(part: Mapping[str, Any], absorbed: Sequence[Absorbed]) -> dict[str, Any]:
    """The part at the middle of what it can be, and how far its edges may be off it."""
    if "polygon_um" in part:
        return _polygon(part, absorbed)
    found, off = {}, 2 * [Fraction(0)]
    for k, key in enumerate(("length_um", "width_um")):
        low, high = (spelled(part[key]) + by for by in _total(absorbed, key))
        found[key] = round(float((low + high) / 2), 2)
        middle = spelled(found[key])
        off[k] = max(high - middle, middle - low)
    lean = sum(spelled(one.leans_deg) for one in absorbed)
    if lean:
        # what is turned lies nearer to the centre
        shorter = [spelled(found[key]) * _versine(float(lean)) for key in found]
        off = [by + less for by, less in zip(off, shorter, strict=True)]
        found["squareness_deg"] = rounded_up(spelled(part.get("squareness_deg", 0.0)) + lean)
    if any(off):
        found["size_tolerance_um"] = rounded_up(
            spelled(part.get("size_tolerance_um", 0.0)) + max(off)
        )
    return found


def _versine(angle_deg: float) -> Fraction:
    """1 - cos of an angle, rounded up."""
    return Fraction(2.0 * math.sin(0.5 * math.radians(angle_deg)) ** 2 + _LOST)


def _polygon(part: Mapping[str, Any], absorbed: Sequence[Absorbed]) -> dict[str, Any]:
    """The same of a polygon, which is stretched by factors f, g along its axes.

    With a = (p, q) its side as stated and c = a corner of it x a, an edge then has the direction (f p, g q)
    and the distance f g c / |(f p, g q)|: the one depends on f / g only, the other grows with f and
    with g, so that both are farthest off where f and g are at their ends.
    """
    longer = [_total(absorbed, key) for key in ("length_um", "width_um")]
    if not any(map(any, longer)):
        return {}
    corners = part["polygon_um"]
    extents = [max(of) - min(of) for of in zip(*corners, strict=True)]
    ends = [
        [1.0 + float(by) / extent for by in bys]
        for bys, extent in zip(longer, extents, strict=True)
    ]
    if min(map(min, ends)) <= 0.0:
        raise InputError(
            "part_geometry: an edge may stand in by half the part or more, within the interval that the "
            "model gives; identify it better, or leave the effect out of the model"
        )
    f, g = (0.5 * sum(of) for of in ends)
    middle = [[round(f * x, 2), round(g * y, 2)] for x, y in corners]
    stated = _edges(middle)
    out = turn = 0.0
    for one, other in itertools.product(*ends):
        edges = _edges([[one * x, other * y] for x, y in corners])
        for (far, angle), (far_stated, angle_stated) in zip(edges, stated, strict=True):
            out = max(out, abs(far - far_stated))
            turn = max(turn, abs(math.remainder(angle - angle_stated, 2.0 * math.pi)))
    size, square = part.get("size_tolerance_um", 0.0), part.get("squareness_deg", 0.0)
    return {
        "polygon_um": middle,
        "size_tolerance_um": rounded_up(size + 2.0 * out + _LOST),
        "squareness_deg": rounded_up(square + math.degrees(turn) + _LOST),
    }


def _edges(corners: Sequence[Sequence[float]]) -> list[tuple[float, float]]:
    """Distance from the reference point and direction of each edge."""
    found = []
    for (x, y), (u, v) in zip(corners, [*corners[1:], corners[0]], strict=True):
        p, q = u - x, v - y
        found.append(((x * q - y * p) / math.hypot(p, q), math.atan2(q, p)))
    return found


def _total(absorbed: Sequence[Absorbed], key: str) -> tuple[Fraction, Fraction]:
    """Ends of by how much the part is longer."""
    ends = [getattr(one, key) for one in absorbed]
    return sum((spelled(a) for a, _ in ends), Fraction(0)), sum(
        (spelled(b) for _, b in ends), Fraction(0)
    )


def _ranges(document: ModelDocument, standings: Mapping[str, Standing]) -> dict[str, object]:
    """ρ and μ, rounded outward; those that are not identified stay as the task has them."""
    found: dict[str, object] = {}
    if RATIO in standings and standings[RATIO].survives:
        low, high = document.parameters[RATIO].low, document.parameters[RATIO].high
        found["film_ratio_um2"], found["film_ratio_percent"] = about_middle(low, high)
    if FRICTION in standings and standings[FRICTION].survives:
        low, high = document.parameters[FRICTION].low, document.parameters[FRICTION].high
        found["friction"] = _outward(low, high)
    return found


def _outward(low: float, high: float) -> list[float]:
    """Ends of a friction coefficient's range, rounded away from it."""
    return [
        math.floor(spelled(low) * _FINE) / _FINE,
        math.ceil(spelled(high) * _FINE) / _FINE,
    ]


def about_middle(low: float, high: float) -> Ends:
    """A middle and a percentage of it that hold both ends, as the decimals that they spell."""
    middle = round(0.5 * (low + high), 1)
    exact = spelled(middle)
    reach = max(exact - spelled(low), spelled(high) - exact)
    percent = math.ceil(100 * reach / exact * _FINE) / _FINE
    return middle, percent


def _errors(before: Mapping[str, float], absorbed: Iterable[Absorbed]) -> dict[str, float]:
    added = {
        "sensed_position_um": sum(spelled(one.sensed_um) for one in absorbed),
        "sensed_orientation_deg": sum(spelled(one.turned_deg) for one in absorbed),
        "probe_position_um": sum(spelled(one.probe_um) for one in absorbed),
    }
    return {key: rounded_up(spelled(before[key]) + more) for key, more in added.items() if more > 0}


_FIELDS = {
    "length_um": "length_um",
    "width_um": "width_um",
    "squareness_deg": "leans_deg",
    "sensed_position_um": "sensed_um",
    "sensed_orientation_deg": "turned_deg",
    "probe_position_um": "probe_um",
    "tip_radius_um": "radius_um",
    "passive_tip_radius_um": "radius_um",
    "drag_centre_um": "drag_centre_um",
    "drag_centre_moves": "centre_moves",
    "probe_wander_um": "wander_um",
    "drag_anisotropy_percent": "anisotropy",
    "travel_direction_deg": "drift_um_s",
    "travel_scale_percent": "drift_um_s",
}
"""The field of an absorbed effect that a key follows from."""


def _reasons(standings: Mapping[str, Standing]) -> dict[str, str]:
    """For every key that can change, who changed it."""
    effects = [one for one in standings.values() if one.absorbed is not None]

    def by(field: str, *first: str) -> str:
        plain = getattr(Absorbed(said=""), field)
        names = [one.name for one in effects if getattr(one.absorbed, field) != plain]
        return ", ".join([*(name for name in first if name in standings), *names])

    found = {key: by(field) for key, field in _FIELDS.items()}
    by_part = (found[key] for key in ("length_um", "width_um", "squareness_deg"))
    of_the_part = ", ".join(dict.fromkeys(filter(None, by_part)))
    for key in ("tip_radius_um", "passive_tip_radius_um"):
        found[key] = by("radius_um", ROUND_TIPS) or "the task's tips are points"
    return {
        **found,
        **dict.fromkeys(("polygon_um", "size_tolerance_um", "squareness_deg"), of_the_part),
        "film_ratio_um2": RATIO,
        "speed_um_s": ", ".join(one.name for one in effects if by_speed(one)),
        "film_ratio_percent": by("ratio_share", RATIO),
        "friction": by("friction", FRICTION),
    }


def by_speed(one: Standing) -> bool:
    """Whether an effect counts the less the faster the probes are."""
    return one.absorbed is not None and one.absorbed.bounded_by == "speed"


def _told(value: object) -> str:
    if isinstance(value, (list, tuple)) and isinstance(value[0], (list, tuple)):
        return f"{len(value)} corners"
    if isinstance(value, (list, tuple)):
        return " … ".join(f"{one:.6g}" for one in value)
    return f"{value:.8g}" if isinstance(value, float) else str(value)


def _block(post: Post) -> Block:
    """The square around a post, wherever it is."""
    reach = units.metres(post.radius_um[1]).hi

    def side(ends: Ends) -> Interval:
        low, high = units.metres(ends[0]).lo, units.metres(ends[1]).hi
        return Interval(low, high) + Interval(-reach, reach)

    return Block(x=side(post.x_um), y=side(post.y_um))
