"""The task as the model says it is: ranges replaced, errors enlarged, each with what it was before."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.errors import InputError
from meso_robust.identification.document import ModelDocument, PartSection
from meso_robust.primitives.outline import Rectangle
from meso_robust.primitives.setup import Block, Setup, setup_of
from meso_robust.task import Task, parse_task
from meso_robust.transfer.assumption_check import FRICTION, RATIO, Standing, by_name
from meso_robust.transfer.inflation import NOTHING, Absorbed, Ends, Post, rounded_up, spelled

_SAME = 1e-6  # of a length: two statements of it that differ by less are the same
_FINE = 10**6  # steps of a friction coefficient, a ratio in um^2 or a percentage


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """A value of the task before and after."""

    key: str
    before: str
    after: str
    because: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Changed:
    """The changed task, and what it cannot say: that sides of the part have intervals, and a post."""

    task: Task
    changes: tuple[Change, ...]
    half_um: Ends
    """By how much half the length and half the width may differ from the changed task's, um."""
    posts: tuple[Post, ...]

    @property
    def keys(self) -> frozenset[str]:
        """Of the task's values that are the model's now, such as ``uncertainty.friction``."""
        return frozenset(one.key for one in self.changes)

    @property
    def wider(self) -> bool:
        """Whether the promise is about more than the changed task says."""
        return self.half_um != NOTHING or bool(self.posts)

    def setup(self) -> Setup:
        """The changed task with every size of the part, and with the posts as walls."""
        known = setup_of(self.task)
        length, width = (units.metres(value) for value in self.half_um)
        return replace(
            known,
            outline=Rectangle(
                half_length=known.half_length + Interval(-length.hi, length.hi),
                half_width=known.half_width + Interval(-width.hi, width.hi),
            ),
            blocks=(*known.blocks, *(_block(post) for post in self.posts)),
        )


def check_part(task: Task, document: ModelDocument, source: str) -> None:
    """Refuse a model of another part.

    Raises
    ------
    InputError
        The model's part is not the task's, or the task's is no rectangle.
    """
    sides, part = _sides(document.part), task.rectangle("planning with a fitted model")
    stated = (part.length_um, part.width_um)
    if sides is None or any(abs(a - b) > _SAME * b for a, b in zip(sides, stated, strict=True)):
        was = "a polygon" if sides is None else f"{sides[0]:g} x {sides[1]:g} um"
        raise InputError(
            f"{source}: key part: {was}; must be the part of the task, {stated[0]:g} x "
            f"{stated[1]:g} um, because ρ and μ hold for the part that was pushed; identify with "
            "recordings of this part, or correct the task"
        )


def changed(task: Task, document: ModelDocument, found: Iterable[Standing]) -> Changed:
    """Write what the model says into the task; what is not absorbed leaves it as it is.

    Raises
    ------
    InputError
        The changed task breaks a rule of tasks, for example an error out of its range.
    """
    standings = by_name(tuple(found))
    absorbed = [one.absorbed for one in standings.values() if one.absorbed is not None]
    values = task.model_dump(mode="json", by_alias=True, exclude_none=True)
    part, half = _part(values["part"], absorbed)
    uncertainty = {
        **values["uncertainty"],
        **_ranges(document, standings),
        **_errors(values["uncertainty"], absorbed),
    }
    after = {**values, "part": part, "uncertainty": uncertainty}
    because = _reasons(standings)
    return Changed(
        task=parse_task(after, "the task with the model's ranges"),
        changes=tuple(
            Change(
                key=f"{section}.{key}", before=_told(old), after=_told(new), because=because[key]
            )
            for section in ("part", "uncertainty")
            for key, new in after[section].items()
            if (old := values[section][key]) != new
        ),
        half_um=half,
        posts=tuple(one.post for one in absorbed if one.post is not None),
    )


def _sides(part: PartSection) -> Ends | None:
    """Length and width of a rectangle, also of one that is given by its corners."""
    if part.polygon_um is None:
        return part.length_um or 0.0, part.width_um or 0.0
    x, y = (sorted({corner[k] for corner in part.polygon_um}) for k in (0, 1))
    centred = [len(side) == 2 and side[0] == -side[1] for side in (x, y)]
    return (x[1] - x[0], y[1] - y[0]) if all(centred) and len(part.polygon_um) == 4 else None


def _part(part: Mapping[str, float], absorbed: Iterable[Absorbed]) -> tuple[dict[str, float], Ends]:
    """The part's sides at the middle of what they can be, and how far half of each may be off."""
    sides, off = dict(part), []
    for key in ("length_um", "width_um"):
        by = [getattr(one, key) for one in absorbed]
        low, high = (spelled(part[key]) + sum(spelled(one[k]) for one in by) for k in (0, 1))
        sides[key] = round(float((low + high) / 2), 2)
        middle = spelled(sides[key])
        off.append(rounded_up(max(high - middle, middle - low) / 2))
    return sides, (off[0], off[1])


def _ranges(document: ModelDocument, standings: Mapping[str, Standing]) -> dict[str, object]:
    """ρ and μ, rounded outward; those that are not identified stay as the task has them."""
    found: dict[str, object] = {}
    if RATIO in standings and standings[RATIO].survives:
        low, high = document.parameters[RATIO].low, document.parameters[RATIO].high
        found["film_ratio_um2"], found["film_ratio_percent"] = about_middle(low, high)
    if FRICTION in standings and standings[FRICTION].survives:
        low, high = document.parameters[FRICTION].low, document.parameters[FRICTION].high
        found["friction"] = [
            math.floor(spelled(low) * _FINE) / _FINE,
            math.ceil(spelled(high) * _FINE) / _FINE,
        ]
    return found


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


def _reasons(standings: Mapping[str, Standing]) -> dict[str, str]:
    """For every key that can change, who changed it."""
    fields = {
        "length_um": "length_um",
        "width_um": "width_um",
        "sensed_position_um": "sensed_um",
        "sensed_orientation_deg": "turned_deg",
        "probe_position_um": "probe_um",
    }
    effects = [one for one in standings.values() if one.absorbed is not None]
    return {
        "film_ratio_um2": RATIO,
        "film_ratio_percent": RATIO,
        "friction": FRICTION,
        **{
            key: ", ".join(
                one.name for one in effects if getattr(one.absorbed, field) not in (0.0, NOTHING)
            )
            for key, field in fields.items()
        },
    }


def _told(value: object) -> str:
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
