"""Forged certificates of real parts and tips: what is true of one task, told of another that asks for more.

Everything that a reader compares fits the task that it is told of. Each quantity has three kinds:

- *of less*: the task's own moves, with the boxes or bounds that hold if the quantity is uncertain by less;
- *copied*: a task in which it is uncertain by more, with this certificate, ranges and claim put to fit;
- *invented*: such a task with what can be proved of it, and invented bounds where nothing can.
"""

from __future__ import annotations

import copy
import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from meso_robust.bounds import Verdict
from meso_robust.campaigns.mutation.by_planner import FIELDS
from meso_robust.campaigns.mutation.forging import ends_of, plain, put_post, restated
from meso_robust.campaigns.mutation.original import Original
from meso_robust.campaigns.mutation.places import Document
from meso_robust.certificates.document import claim_document
from meso_robust.errors import InputError
from meso_robust.primitives.base import BENDING
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.task import Task

LESS, MORE = (0.8, 0.4, 0.1, 0.0), (1.1, 3.0, 10.0, 30.0)
"""Factors on what is uncertain; few, so that what is proved of each task is proved once."""
ONE = 0.3
"""Share of the forgeries in which one box or bound alone is changed."""


@dataclass(frozen=True, slots=True)
class Forged:
    """A forged certificate; its digest does not fit yet."""

    name: str
    document: Document
    task: Task
    """That it is about."""


def _range(value: Any, factor: float) -> Any:
    low, high = value
    middle, half = 0.5 * (low + high), 0.5 * factor * (high - low)
    return [middle - half, middle + half]


def _radii(value: Any, factor: float) -> Any:
    low, high = _range(value, factor)
    return [max(low, 0.0), high]


def _bound(value: Any, factor: float) -> Any:
    return value * factor


def _cap(value: Any, factor: float) -> Any:
    """A lower cap asks for more."""
    return value / factor if factor else 1e6 * value


def _own(value: Any, factor: float) -> Any:
    """Each tip its own friction, rather than one for all."""
    return factor < 1.0


def _any_instant(value: Any, factor: float) -> Any:
    """A centre of drag that moves asks for more than one that is fixed in the part."""
    return factor > 1.0


KEYS: Mapping[str, tuple[str, Callable[[Any, float], Any]]] = {
    "tip_radius_um": ("probe", _radii),
    "passive_tip_radius_um": ("probe", _radii),
    "tip_spacing_tolerance_um": ("probe", _bound),
    "max_force_un": ("probe", _cap),
    "drag_un_s_per_um": ("film", _bound),
    "size_tolerance_um": ("part", _bound),
    "squareness_deg": ("part", _bound),
    "corner_radius_um": ("part", _bound),
    "friction": ("uncertainty", _range),
    "friction_common": ("uncertainty", _own),
    "travel_direction_deg": ("uncertainty", _range),
    "travel_scale_percent": ("uncertainty", _bound),
    "drag_centre_um": ("uncertainty", _bound),
    "drag_centre_moves": ("uncertainty", _any_instant),
    "drag_anisotropy_percent": ("uncertainty", _bound),
    "probe_wander_um": ("uncertainty", _bound),
}
"""What a real part and real tips add to a task: section, and the value at a factor on what is uncertain."""


def other_task(task: Task, key: str, factor: float) -> Task | None:
    """The task with one quantity uncertain by more or less.

    Parameters
    ----------
    task, key, factor
        The task, which of ``KEYS``, and the factor.

    Returns
    -------
    Task or None
        None where the task does not state the quantity, or none of that size can be.
    """
    (section, of), values = KEYS[key], task.to_dict()
    value = (values.get(section) or {}).get(key, False if of is _any_instant else None)
    if value is None:
        return None
    values[section][key] = of(value, factor)
    try:
        found = Task.from_dict(values)
    except InputError:
        return None
    return None if found == task else found


def told_of(document: Document, original: Original, task: Task) -> None:
    """Make all that a certificate takes from its task fit another one, boxes and bounds left aside."""
    old, new = original.setup, setup_of(task)
    chain = original.chain_of(task)
    document["task_hash"] = task.hash
    document["claim"] = plain(claim_document(task, chain, len(document["policy"])))
    changed = {
        name: _change(field, name, old, new) for field, own in FIELDS.items() for name in own
    }
    for step in document["steps"]:
        for one in step["obligations"]:
            for name, ends in one["over"].items():
                low, high = changed.get(name, (0.0, 0.0))
                if low or high:
                    one["over"][name] = [
                        (float.fromhex(end) + by).hex()
                        for end, by in zip(ends, (low, high), strict=True)
                    ]


def _change(field: str, name: str, old: Setup, new: Setup) -> tuple[float, float]:
    """By how much the ends of a variable of a move are moved."""
    before, after = (getattr(one.uncertainty, field) for one in (old, new))
    over = BENDING.mid if name.startswith("bend") else 1.0
    return (after.lo - before.lo) / over, (after.hi - before.hi) / over


def true_of(original: Original, task: Task) -> Original | None:
    """A certificate of the same moves that is true of another task, if the planner proves it.

    Its margin says no more than that.
    """
    chain = original.chain_of(task)
    if chain.verdict is not Verdict.PROVED:
        return None
    document = copy.deepcopy(original.document)
    told_of(document, original, task)
    restated(document, chain)
    document["margin"]["factor"] = 1.0
    return Original(task, document)


def _of_less(key: str, original: Original, rng: random.Random) -> Forged | None:
    task = other_task(original.task, key, rng.choice(LESS))
    if task is None:
        return None
    chain = original.chain_of(task)
    if chain.verdict is not Verdict.PROVED:
        return None
    document = copy.deepcopy(original.document)
    easier = copy.deepcopy(original.document)
    restated(easier, chain)
    what = rng.choice(("boxes", "bounds", "both"))
    moves = range(len(document["steps"]))
    if rng.random() < ONE:
        moves = range(move := rng.choice(moves), move + 1)
    for move in moves:
        step, other = document["steps"][move], easier["steps"][move]
        if what != "boxes":
            _bounds_of(step, other)
        if what != "bounds":
            put_post(document, move, ends_of(other["post_exact"]))
    return Forged(f"{key}: of less", document, original.task)


def _bounds_of(step: Document, other: Document) -> None:
    """Larger bounds, of the same inequalities over the same ranges."""
    for one, more in zip(step["obligations"], other["obligations"], strict=False):
        same = all(one[name] == more[name] for name in ("id", "about", "inequality"))
        if same and float.fromhex(more["lower_bound"]) > float.fromhex(one["lower_bound"]):
            one["lower_bound"] = more["lower_bound"]


def _copied(key: str, original: Original, rng: random.Random) -> Forged | None:
    task = other_task(original.task, key, rng.choice(MORE))
    if task is None:
        return None
    document = copy.deepcopy(original.document)
    told_of(document, original, task)
    if rng.random() < ONE:  # modest: what else is claimed is less than what was proved
        document["margin"]["factor"] = 1.0
        for one in (one for step in document["steps"] for one in step["obligations"]):
            one["lower_bound"] = (float.fromhex(one["lower_bound"]) * rng.uniform(0.3, 1.0)).hex()
    return Forged(f"{key}: copied", document, task)


def _invented(key: str, original: Original, rng: random.Random) -> Forged | None:
    task = other_task(original.task, key, rng.choice(MORE))
    if task is None:
        return None
    chain = original.chain_of(task)
    if chain.verdict is Verdict.PROVED:
        return None
    document = copy.deepcopy(original.document)
    told_of(document, original, task)
    restated(document, chain)
    document["margin"]["factor"] = 1.0
    return Forged(f"{key}: invented", document, task)


KINDS: Mapping[str, Callable[[str, Original, random.Random], Forged | None]] = {
    "of less": _of_less,
    "copied": _copied,
    "invented": _invented,
}
FORGED_TASKS: Mapping[str, Callable[[Original, random.Random], Forged | None]] = {
    f"{key}: {kind}": partial(of, key) for key in KEYS for kind, of in KINDS.items()
}
