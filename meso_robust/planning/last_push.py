"""What the last push of every plan leaves open, before any plan is looked for.

A push keeps what is unknown of the part across it: the same push from a pose that is moved across ends as
much beside. Hence it ends in no narrower goal than it does from a part that stands exactly upright, known
across as well as a start or a tip ever is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from meso_robust import units
from meso_robust.bounds import Interval, Verdict
from meso_robust.planning.arrival import ROOM_UM
from meso_robust.planning.clearance import fine
from meso_robust.planning.x_translation import to_goal
from meso_robust.primitives.frame import Frame, Heading
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.task import Task

TOO_MUCH = 1.1  # of the goal: another height of the tips may leave a little less


def leaves_goal(setup: Setup, headings: Sequence[Heading]) -> bool:
    """Whether a plan that ends with a push in one of these headings would be looked for in vain.

    Parameters
    ----------
    setup
        The task.
    headings
        Of the pushes.
    """
    return all(share_taken(setup, heading) > TOO_MUCH for heading in headings)


def share_taken(setup: Setup, heading: Heading) -> float:
    """The largest share of one of the goal's widths that the best last push in a heading takes.

    Zero if no push is found that is proved, which says nothing of those from further away.
    """
    there = Frame(heading=heading).setup(replace(setup, blocks=()))
    goal, start = there.goal, there.start
    known = min(there.uncertainty.probe_position.hi, 0.5 * start.x.width, 0.5 * start.y.width)
    x, y = goal.x.mid + fine(there) * ROOM_UM * units.UM, goal.y.mid
    pre = PoseBox(
        x=Interval(x - known, x + known),
        y=Interval(y - known, y + known),
        theta=Interval(goal.theta.mid, goal.theta.mid),
    )
    last = to_goal(pre, there, slipping=there.may_slip)
    if last is None or last.post is None or last.verdict is not Verdict.PROVED:
        return 0.0
    pairs = ((last.post.x, goal.x), (last.post.y, goal.y), (last.post.theta, goal.theta))
    return max(own.width / whole.width for own, whole in pairs)


def narrowed_first(task: Task, scale: float, headings: Sequence[Heading]) -> list[str]:
    """The task's uncertainties in the order in which each alone is tried as what stands in the way.

    Where that is the last push, the one it hangs on most comes first.

    Parameters
    ----------
    task, headings
        What is wanted, and how a plan may end.
    scale
        Factor on the one that is narrowed.
    """
    setup = setup_of(task)
    stated = list(setup.uncertainty.stated)
    if not leaves_goal(setup, headings):
        return stated

    def taken(name: str) -> float:
        narrowed = setup_of(task, scale, name)
        return min(share_taken(narrowed, heading) for heading in headings)

    return sorted(stated, key=taken)
