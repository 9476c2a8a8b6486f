"""What is proved of a policy: cell by cell, and again of a policy that someone else wrote."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from meso_robust.bounds import Verdict
from meso_robust.policy.cells import (
    Cell,
    Policy,
    ends_in_goal,
    resting,
    sensed_poses,
    true_poses,
)
from meso_robust.policy.cover import covered
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.wording import counted


def certified(
    rule: MoveRule, sensed: PoseBox, moves: int, below: Sequence[PoseBox], setup: Setup
) -> Cell | None:
    """A cell, if the move is proved from all its true poses and leads to the goal or to ``below``.

    Parameters
    ----------
    rule, sensed
        The move and the sensed poses before it.
    moves
        Bound of the moves to the goal, this one included.
    below
        Boxes of sensed poses from which fewer moves lead to the goal, or that prove to be in it.
    setup
        The task.
    """
    step = certify_move(rule, true_poses(sensed, setup), setup)
    if step.verdict is not Verdict.PROVED or step.post is None:
        return None
    ends = ends_in_goal(sensed, step.post, setup)
    if not ends and not covered(sensed_poses(step.post, setup), below):
        return None
    return Cell(sensed=sensed, rule=rule, moves=moves, post=step.post, ends=ends)


class NotProvedError(ValueError):
    """A cell of a policy does not hold; the message says which and why."""


def recertified(policy: Policy) -> Policy:
    """The same policy, every cell proved again and its numbers replaced by those proved now.

    Raises
    ------
    NotProvedError
        A cell cannot be proved, or the moves to go do not fall.
    """
    setup = setup_of(policy.task)
    rest = resting(setup)
    known: dict[int, list[PoseBox]] = {0: [] if rest is None else [rest]}
    cells = []
    for number, cell in enumerate(policy.cells):
        below = [box for moves, boxes in known.items() if moves < cell.moves for box in boxes]
        proved = certified(cell.rule, cell.sensed, cell.moves, below, setup)
        if proved is None or cell.moves < 1:
            raise NotProvedError(
                f"cell {number} ({cell.rule.action}, {counted(cell.moves, 'move')} to go) is not proved"
            )
        known.setdefault(cell.moves, []).append(cell.sensed)
        cells.append(proved)
    if any(one.moves > other.moves for one, other in pairwise(cells)):
        raise NotProvedError("the cells are not in the order of their moves to go")
    return Policy(task=policy.task, cells=tuple(cells), rest=rest)
