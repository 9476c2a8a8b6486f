"""The moves one after the other: each from everywhere that the one before can lead."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from meso_robust.checker.document import RuleDocument
from meso_robust.checker.ids import Objection, named
from meso_robust.checker.inputs import Given, PoseBox
from meso_robust.checker.passage import Passage
from meso_robust.checker.prover import PLAIN, Prover
from meso_robust.checker.ranges import Side
from meso_robust.checker.refusal import Refused


def within(inner: PoseBox, outer: PoseBox) -> bool:
    """Whether every pose of one box is proved to lie in another."""
    pairs = ((inner.x, outer.x), (inner.y, outer.y), (inner.theta, outer.theta))
    return all(holds_side(large, small) for small, large in pairs)


def holds_side(large: Side, small: Side) -> bool:
    """Whether a range is proved to hold another."""
    return bool(large[0] <= small[0] and small[1] <= large[1])


def passages(
    policy: Sequence[RuleDocument],
    given: Given,
    start: PoseBox,
    widened: Callable[[int, PoseBox], PoseBox] = lambda _, post: post,
    prover: Prover = PLAIN,
) -> Iterator[tuple[Passage, PoseBox]]:
    """Verify move after move.

    Parameters
    ----------
    policy, given, start
        The moves, the task, all poses before the first move (world axes).
    widened
        From which box to go on after a move, given its number from 0 and what the checker found.
    prover
        Proves the moves.

    Yields
    ------
    tuple[Passage, PoseBox]
        The move, and all poses after it in world axes, as found.

    Raises
    ------
    Refused
        A requirement does not follow.
    """
    pre, memory = start, None
    for number, rule in enumerate(policy):
        scene, passage = prover.move(rule, pre, given, memory)
        post = scene.frame.world(passage.post)
        yield passage, post
        pre, memory = widened(number, post), passage.memory


def verify_alone(policy: Sequence[RuleDocument], given: Given, prover: Prover = PLAIN) -> None:
    """Prove that the policy reaches the goal, without any help.

    Raises
    ------
    Refused
        It does not follow.
    """
    moves = passages(policy, given, given.start, prover=prover)
    ends = [given.start, *(post for _, post in moves)]
    if not within(ends[-1], given.goal):
        raise Refused(named(Objection.GOAL_REACHED), "inside", "not shown")
