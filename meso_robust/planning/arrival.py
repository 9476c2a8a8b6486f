"""Pushes that bring an upright part to the goal, each in a heading of its own.

A t^2 push brings one coordinate to where it ends, and needs room to straighten the part on its way.
With probes on more than one side that room can be made: a push goes past the goal and another one
comes back, or a push across sets the other coordinate first.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from meso_robust import units
from meso_robust.bounds import HALF_PI, Verdict
from meso_robust.planning.clearance import fine
from meso_robust.planning.guided import cut_in_two
from meso_robust.planning.x_translation import to_goal, upright
from meso_robust.primitives.certify import certify_move, known_before
from meso_robust.primitives.frame import Frame, Heading
from meso_robust.primitives.grid import roomy
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.obligation import Leaves, Step
from meso_robust.primitives.setup import PoseBox, Setup

MOST_PUSHES = 3  # in a row; effort of the search, no proof rests on it
ROOM_UM = 100.0  # that a straight part needs to be brought back
SHORTER_UM = 50.0  # by which another push may straighten the part; effort of the search
LEAN = 0.35  # rad from upright to a push beyond which it is not tried


@dataclass(frozen=True, slots=True, kw_only=True)
class Arrival:
    """Robust pushes, and where the part is after them."""

    rules: tuple[MoveRule, ...]
    post: PoseBox
    """All poses after the last push."""


def arrive(
    state: PoseBox,
    setup: Setup,
    headings: Sequence[Heading],
    *,
    mirrored: bool = False,
    guide: bool = False,
) -> Arrival | None:
    """The shortest robust sequence of pushes to the goal, clear of all walls, that is found.

    Parameters
    ----------
    state, setup
        All poses before the pushes, and the task; world frame.
    headings
        Directions in which the part can be pushed.
    mirrored
        Whether the y axes of the pushes are mirrored, as in a plan for the mirrored task.
    guide
        Whether the slot's walls may guide the part at the end of the last push.
    """
    frames = [Frame(heading=heading, mirrored=mirrored) for heading in headings]
    state = _given(state, setup)
    for length in range(1, MOST_PUSHES + 1):
        for way in itertools.permutations(frames, length):
            found = _along(state, setup, way, guide=guide)
            if found is not None:
                return found
    return None


def across(state: PoseBox, setup: Setup, frame: Frame) -> Arrival | None:
    """One push on a short edge that ends with that coordinate at the goal, if it is robust."""
    there, own = frame.setup(setup), frame.from_world(state)
    if there.edge(own.theta.mid).name != "short":
        return None
    step = next(_steps(own, there, back=False), None)
    if step is None or step.post is None:
        return None
    rule = replace(step.rule, step=1, frame=frame)
    return Arrival(rules=(rule,), post=frame.box_to_world(step.post))


def _along(
    state: PoseBox,
    setup: Setup,
    way: tuple[Frame, ...],
    before: Step | None = None,
    *,
    guide: bool,
) -> Arrival | None:
    """Pushes in these frames, one after the other."""
    frame, rest = way[0], way[1:]
    there, own = frame.setup(setup), frame.from_world(state)
    edge = there.edge(own.theta.mid)
    if abs(edge.angle(own.theta).mid - HALF_PI.mid) > LEAN:
        return None
    known = None if before is None else known_before(before, own, frame, there)
    back = any(_opposite(frame, one) for one in rest)
    for step in _steps(own, there, known, back=back):
        if step.verdict is not Verdict.PROVED or step.post is None:
            continue
        rule, post = replace(step.rule, frame=frame), _given(step.post, setup)
        after = frame.box_to_world(post)
        if setup.blocks and not _clear_of_walls(rule, state, setup):
            cut = cut_in_two(rule, state, setup, before) if guide and not rest else None
            if cut is not None and cut[1].post is not None:
                return Arrival(rules=tuple(one.rule for one in cut), post=cut[1].post)
            continue
        if not rest and post.within(there.goal):
            return Arrival(rules=(rule,), post=after)
        found = _along(after, setup, rest, replace(step, rule=rule), guide=guide) if rest else None
        if found is not None:
            return replace(found, rules=(rule, *found.rules))
    return None


def _given(box: PoseBox, setup: Setup) -> PoseBox:
    """Poses that the next push must start from: where little is to spare, with room as certificates have."""
    return roomy(box) if setup.may_slip else box


@lru_cache(maxsize=256)  # several ways to the goal begin alike
def _clear_of_walls(rule: MoveRule, state: PoseBox, setup: Setup) -> bool:
    """Whether the push is proved with the slot's walls around it."""
    return certify_move(rule, state, setup).verdict is Verdict.PROVED


def _steps(
    own: PoseBox, there: Setup, known: Leaves | None = None, *, back: bool
) -> Iterator[Step]:
    """What one push can do: end at the goal, or past it if a later one comes ``back``."""
    straight = _straightened(own, there, known)
    if straight is None or straight.post is None:
        return  # what no push straightens none brings to the goal
    past_um = fine(there) * ROOM_UM if back else 0.0
    # the shortest push that straightens the part must not lead past where it shall end, wherever it began
    if straight.post.x.lo > there.goal.x.mid - units.UM * (past_um + fine(there) * SHORTER_UM):
        found = to_goal(own, there, past_um, before=known, slipping=there.may_slip)
        yield from () if found is None else (found,)
    if back:
        yield straight


@lru_cache(maxsize=256)
def _straightened(own: PoseBox, there: Setup, known: Leaves | None) -> Step | None:
    slips = there.may_slip
    return upright(own, there, step=3, primitive="x_translation", before=known, slipping=slips)


def _opposite(one: Frame, other: Frame) -> bool:
    return abs(one.quarters - other.quarters) == 2
