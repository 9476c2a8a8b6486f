"""One move of any kind: certified in its own axes, stated in the world's."""

from __future__ import annotations

from dataclasses import dataclass, replace

from meso_robust.primitives.force import force_below_cap
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.regrasp import certify_regrasp
from meso_robust.primitives.rotation import certify_rotation
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.straighten import certify_straighten
from meso_robust.primitives.tilt import Turn, certify_tilt
from meso_robust.primitives.walls import part_clear, tips_clear

SIDES = {"tilt": (1, -1), "rotate": (1,), "straighten": (0,), "regrasp": (0,)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Before:
    """What is known of the move just before, beyond the box of poses that it leaves."""

    turn: Turn
    """A tilt's start, in the axes of ``frame``."""
    frame: Frame


def certify_move(
    rule: MoveRule,
    pre: PoseBox,
    setup: Setup,
    before: Before | None = None,
    *,
    whole: bool = True,
) -> tuple[Step, Before | None]:
    """Certify one move from every pose in ``pre``.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it and the task, world frame.
    before
        What the move before left behind.
    whole
        False: nothing but the verdict and the box of poses after a proved move is wanted.

    Returns
    -------
    tuple[Step, Before | None]
        The step, its boxes in the world frame, and what the next move may use.

    Raises
    ------
    ValueError
        The rule's side or passive tip is not one that its action is certified for.
    """
    _check_shape(rule)
    frame = rule.frame
    own, there = frame.from_world(pre), frame.setup(setup)
    turn: Turn | None = None
    whole = whole or bool(setup.blocks)  # of a wall every pose on the way must be clear
    if rule.action == "tilt":
        step, turn = certify_tilt(rule, own, there, whole=whole)
    elif rule.action == "rotate":
        step = certify_rotation(rule, own, there)
    elif rule.action == "regrasp":
        step = certify_regrasp(rule, own, there)
    else:
        known = before.turn if before is not None and before.frame == frame else None
        step = certify_straighten(rule, own, there, known, whole=whole)
    seen = replace(
        step,
        obligations=(*step.obligations, *force_below_cap(rule, there)),
        pre=pre,
        post=None if step.post is None else frame.box_to_world(step.post),
        tube=tuple(replace(k, box=frame.box_to_world(k.box)) for k in step.tube),
    )
    if setup.blocks:
        walls = (part_clear(seen.tube, setup), tips_clear(rule, own, there))
        seen = replace(seen, obligations=(*seen.obligations, *walls))
    return seen, None if turn is None else Before(turn=turn, frame=frame)


def _check_shape(rule: MoveRule) -> None:
    """Refuse a rule of which the proof would not look at everything."""
    if rule.side not in SIDES[rule.action]:
        raise ValueError(f"a {rule.action} needs side in {SIDES[rule.action]}, got {rule.side}")
    if (rule.single is not None) != (rule.action == "rotate"):
        raise ValueError(f"a passive tip belongs to a rotation and to nothing else, got {rule}")
