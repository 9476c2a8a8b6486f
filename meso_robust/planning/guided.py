"""A last push into the slot that is cut in two: clear of all walls first, and then guided by them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from meso_robust import units
from meso_robust.bounds import Interval, Verdict
from meso_robust.planning.clearance import errors_across, fine, rise_of, start_ahead_um
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.grid import roomy
from meso_robust.primitives.move import MoveRule, Point, from_part, in_world
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.slot import Channel, channel

DEEPER_UM, MOST = 20.0, 12
"""How much deeper the part is pushed clear of the walls with each trial, and how many there are. Effort only."""


def guided(rules: Sequence[MoveRule], setup: Setup) -> tuple[MoveRule, ...] | None:
    """A plan whose last push touches a wall, with that push cut in two.

    Parameters
    ----------
    rules, setup
        The plan, proved away from the slot, and the task.

    Returns
    -------
    tuple or None
        None if a move before the last one is not proved clear of the walls, or the last one cannot be guided.
    """
    state, step = setup.start, None
    for rule in rules[:-1]:
        step = certify_move(rule, state, setup, step)
        if step.verdict is not Verdict.PROVED or step.post is None:
            return None
        state = step.post
    cut = cut_in_two(rules[-1], state, setup, step)
    return None if cut is None else (*rules[:-1], *(one.rule for one in cut))


def cut_in_two(
    rule: MoveRule, state: PoseBox, setup: Setup, before: Step | None = None
) -> tuple[Step, Step] | None:
    """A push into the slot as one clear of its walls and one that they guide into the goal.

    Parameters
    ----------
    rule, state, setup, before
        The push as it would be without walls, all poses before it, the task, and the move just before it.

    Returns
    -------
    tuple or None
        Both certified; None if no depth is found from which on the walls can guide the part.
    """
    there = rule.frame.setup(setup)
    into = channel(rule.frame, there)
    if into is None or rule.action != "straighten":
        return None
    tip = (
        there.edge(rule.frame.from_world(state).theta.mid).depth.mid
        + there.uncertainty.tip_radius.mid
    )
    shallow = _least_depth(there, into, rule.frame.from_world(state).theta.mid)
    found: tuple[Step, Step] | None = None
    for trial in range(MOST):
        deep = shallow + units.UM * DEEPER_UM * fine(there) * trial
        end = in_world(units.to_um(into.mouth_x.mid - deep + tip))
        first = certify_move(replace(rule, step=3, dual_end=end), state, setup, before)
        if first.verdict is not Verdict.PROVED or first.post is None:
            break  # a deeper one meets the walls as well
        post = roomy(first.post)
        second = certify_move(_guide(rule, post, there, into, tip), post, setup, first)
        if second.verdict is not Verdict.PROVED or second.post is None:
            continue
        if not roomy(second.post).within(setup.goal):
            break
        if found is not None:
            return first, second  # the least depth that is enough has nothing in hand
        found = first, second
    return found


def _least_depth(there: Setup, into: Channel, theta: float) -> float:
    """How deep the centre is, m, negative outside, where the slot's edge turns the part back; no errors counted."""
    edge, (far, _) = there.edge(theta), there.opposite(there.edge(theta))
    half = edge.last.mid
    offset = 0.5 * there.spacing.mid + into.half.mid - half
    ahead = offset / there.uncertainty.friction.hi - edge.depth.mid + into.friction.mid * half
    return max(-ahead, -far.depth.mid + there.spacing.mid * 0.1)


def _guide(rule: MoveRule, post: PoseBox, there: Setup, into: Channel, tip: float) -> MoveRule:
    """The pair on the slot's axis, pushed to where the goal is."""
    own = rule.frame.from_world(post)
    off = Interval.point(into.mouth_y.mid) - own.y + errors_across(there)
    rises = tuple((side, rise_of(off, side, there)) for side in (1, -1))
    return replace(
        rule,
        step=4,
        action="guide",
        dual=Point(
            x=from_part(start_ahead_um(rises, own, there)),
            y=in_world(units.to_um(into.mouth_y.mid)),
        ),
        dual_end=in_world(units.to_um(there.goal.x.mid + tip)),
    )
