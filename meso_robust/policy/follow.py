"""Where one pose of a certified box goes: what a move measures from the part moves with the part."""

from __future__ import annotations

from meso_robust.bounds import Interval
from meso_robust.policy.cells import common
from meso_robust.primitives.move import Anchor, MoveRule
from meso_robust.primitives.setup import PoseBox


def follows(rule: MoveRule) -> tuple[bool, bool]:
    """Whether x and y after a move follow x and y before it (world axes).

    All aims along such an axis are measured from the sensed part, so that the move and its proof
    look the same wherever the part lies along it (``derivations/invariances.py``: translation).
    """
    aims_x = [rule.dual.x, rule.dual_end]
    aims_y = [rule.dual.y]
    if rule.single is not None:
        aims_x.append(rule.single.x)
        aims_y.append(rule.single.y)
    along, across = (all(aim.anchor is Anchor.PART for aim in aims) for aims in (aims_x, aims_y))
    return (across, along) if rule.frame.quarters % 2 else (along, across)


def expected(rule: MoveRule, now: PoseBox, pre: PoseBox, post: PoseBox) -> PoseBox:
    """All true poses after a move from the poses ``now``.

    Parameters
    ----------
    rule, pre, post
        A move that leads from all of ``pre`` into ``post``.
    now
        Poses before it; those outside of ``pre`` are left out.
    """
    now = common(now, pre)
    x, y = follows(rule)
    moved = PoseBox(
        x=_moved(now.x, pre.x, post.x) if x else post.x,
        y=_moved(now.y, pre.y, post.y) if y else post.y,
        theta=post.theta,
    )
    return common(moved, post)


def _moved(now: Interval, pre: Interval, post: Interval) -> Interval:
    """``now`` plus the shift that takes ``pre`` to ``post``, each of its ends."""
    least = Interval.point(post.lo) - Interval.point(pre.lo)
    most = Interval.point(post.hi) - Interval.point(pre.hi)
    return Interval((Interval.point(now.lo) + least).lo, (Interval.point(now.hi) + most).hi)
