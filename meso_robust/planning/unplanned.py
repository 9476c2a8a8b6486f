"""Where every plan for a task ends too soon, however small its uncertainties, and what gives one.

What is said to give one was tried: for the task with that change alone, and with uncertainties as small, a plan was
found in the open.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from enum import Enum
from itertools import combinations

from meso_robust.planning.effort import EffortSpentError, limited
from meso_robust.planning.rotation import turn
from meso_robust.planning.x_translation import upright
from meso_robust.primitives.frame import HEADINGS, Frame, Heading
from meso_robust.primitives.setup import Setup
from meso_robust.task import Part, Task

TRYING_S = 20.0
"""s of computing, about, for all changes together."""
ENOUGH = 2
"""Changes that are told at most, each of another thing."""
NEAR = 0.03
"""Share by which friction is taken to be known."""
MORE = (0.1, 0.2, 0.4, 0.8)
"""Frictions of tips that hold better."""
THIN_UM = 1.0
"""Radius of a thin tip, um."""
SLENDER = (0.8, 0.65, 0.5)
"""Widths of parts that are easier to turn, over that of the task's."""


class Stuck(Enum):
    """The first thing that no plan gets past."""

    STRAIGHTENING = "no push straightens the part: the tip that touches first does not hold it until the other one touches"
    TURNING = "no turn of the part between two tips is proved from where it starts"
    ARRIVING = "the pushes that must follow do not end in the goal"


class What(Enum):
    """What a laboratory could change, in words."""

    SIDES = "the probes' sides"
    CAP = "the cap on forces"
    FRICTION = "friction"
    TIPS = "the tips"
    WIDTH = "the part's width"
    START = "the start"
    GOAL = "the goal's tolerance"


Change = tuple[What, str, Task]
"""What is changed, how far it is, in words, and the task with it."""


def where(setup: Setup, turning: Sequence[Frame], headings: Sequence[Heading]) -> Stuck:
    """What no plan for a task gets past.

    Parameters
    ----------
    setup
        The task, its uncertainties as small as they are tried.
    turning
        Axes in which a plan would turn the part by a quarter; none if it need not be turned.
    headings
        In which it can be pushed.
    """
    if turning:
        there = [frame.setup(setup) for frame in turning]
        turned = any(turn(one.start, one) is not None for one in there)
        return Stuck.ARRIVING if turned else Stuck.TURNING
    frames = (Frame(heading=heading) for heading in headings)
    straightened = any(_straightens(frame.setup(setup)) for frame in frames)
    return Stuck.ARRIVING if straightened else Stuck.STRAIGHTENING


def _straightens(there: Setup) -> bool:
    slips = there.may_slip
    push = upright(there.start, there, step=3, primitive="x_translation", slipping=slips)
    return push is not None


def settling(task: Task, stuck: Stuck, planned: Callable[[Task], bool]) -> str:
    """What gives a plan, as the end of a sentence.

    Parameters
    ----------
    task
        What was asked for.
    stuck
        What no plan for it gets past.
    planned
        Whether a plan is found for a task with uncertainties as small as they are tried.
    """
    tried: dict[What, None] = {}
    helps: dict[What, str] = {}
    ended = "no change"
    try:
        with limited(TRYING_S):
            for kind, words, changed in _changes(task, stuck):
                if kind in helps:
                    continue
                if planned(changed):
                    helps[kind] = words
                if len(helps) == ENOUGH:
                    break
                tried[kind] = None
    except EffortSpentError:
        ended = f"in {TRYING_S:g} s no change"
    if helps:
        slot = ", and without the slot" if task.slot else ""
        return f"with uncertainties as small{slot}, one was found with {' or with '.join(helps.values())}"
    if not tried:
        return "there was no time to try what would give one"
    return f"{ended} of {', '.join(one.value for one in tried)} that was tried gives one by itself"


def _changes(task: Task, stuck: Stuck) -> Iterator[Change]:
    """What a laboratory could change, the likeliest first."""
    if task.probe.headings is not None and len(task.probe.headings) < len(HEADINGS):
        probe = task.probe.model_copy(update={"headings": None})
        yield What.SIDES, "probes on all sides", task.model_copy(update={"probe": probe})
    if task.probe.max_force_un is not None:
        probe = task.probe.model_copy(update={"max_force_un": None})
        yield What.CAP, "no cap on forces", task.model_copy(update={"probe": probe})
    middle = 0.5 * sum(task.uncertainty.friction)
    if stuck is Stuck.STRAIGHTENING:
        yield from _friction(task, [mu for mu in MORE if mu > 1.5 * middle][:2])
    if stuck is Stuck.TURNING:
        yield from _thin(task)
        yield from _friction(task, [mu for mu in (0.5 * middle, 0.25 * middle) if mu > 0.0])
        yield from _slender(task)
        return  # neither start nor goal changes how the tips hold it
    yield from _start(task, (1.0, 3.0))
    yield from _goal(task, (2.0, 4.0))
    if stuck is Stuck.ARRIVING:
        yield from _thin(task)
        yield from _friction(
            task, [mu for mu in (*MORE, 0.5 * middle) if mu > 1.5 * middle or 0.0 < mu < middle][:2]
        )


def _friction(task: Task, frictions: Sequence[float]) -> Iterator[Change]:
    for mu in frictions:
        ends = (1.0 - NEAR) * mu, (1.0 + NEAR) * mu
        of = task.uncertainty.model_copy(update={"friction": ends})
        words = f"friction of {mu:.2g} (+- {100 * NEAR:g} %) at the tips"
        yield What.FRICTION, words, task.model_copy(update={"uncertainty": of})


def _thin(task: Task) -> Iterator[Change]:
    if task.probe.tip_radius_um is None or task.probe.tip_radius_um[1] <= THIN_UM:
        return
    thin = (THIN_UM, THIN_UM)
    probe = task.probe.model_copy(update={"tip_radius_um": thin, "passive_tip_radius_um": thin})
    yield What.TIPS, f"tips of {THIN_UM:g} um", task.model_copy(update={"probe": probe})


def _slender(task: Task) -> Iterator[Change]:
    """Parts that are not as wide: no laboratory makes one, but it learns why its own is not turned."""
    part, length = task.part, _length_um(task)
    if not isinstance(part, Part):
        return
    for share in SLENDER:
        width = share * part.width_um
        if width > 0.4 * length:
            of = task.uncertainty
            ratio = of.film_ratio_um2 * (length**2 + width**2) / (length**2 + part.width_um**2)
            yield (
                What.WIDTH,
                f"a part {width:.0f} um wide",
                task.model_copy(
                    update={
                        "part": part.model_copy(update={"width_um": width}),
                        "uncertainty": of.model_copy(update={"film_ratio_um2": ratio}),
                    }
                ),
            )


def _start(task: Task, lengths: Sequence[float]) -> Iterator[Change]:
    start, goal = task.start, task.goal
    ahead, aside = start.x_um - goal.x_um, start.y_um - goal.y_um
    far = (ahead * ahead + aside * aside) ** 0.5
    if far == 0.0:
        return
    for length in lengths:
        more = length * _length_um(task) / far
        x, y = start.x_um + more * ahead, start.y_um + more * aside
        moved = start.model_copy(update={"x_um": x, "y_um": y})
        yield (
            What.START,
            f"a start {more * far:.0f} um further from the goal",
            task.model_copy(update={"start": moved}),
        )


def _length_um(task: Task) -> float:
    if isinstance(task.part, Part):
        return task.part.length_um
    return max(math.dist(one, other) for one, other in combinations(task.part.polygon_um, 2))


def _goal(task: Task, factors: Sequence[float]) -> Iterator[Change]:
    keys = (("position_tolerance_um", "um", 1e5), ("orientation_tolerance_deg", "deg", 45.0))
    for key, unit, most in keys:
        for factor in factors:
            wide = min(factor * getattr(task.goal, key), most)
            goal = task.goal.model_copy(update={key: wide})
            yield (
                What.GOAL,
                f"a goal of +- {wide:g} {unit}",
                task.model_copy(update={"goal": goal}),
            )
