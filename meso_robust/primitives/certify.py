"""One move of any kind: certified in its own axes, stated in the world's."""

from __future__ import annotations

from dataclasses import replace

from meso_robust.bounds import HALF_PI, Interval
from meso_robust.primitives.force import force_below_cap
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.guide import certify_guide
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.obligation import Leaves, Step
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.regrasp import certify_regrasp
from meso_robust.primitives.rotation import certify_rotation, rotation_begins
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.straighten import Across, Pushed, certify_straighten
from meso_robust.primitives.tilt import Turn, certify_tilt
from meso_robust.primitives.walls import part_clear, tips_clear

SIDES = {"tilt": (1, -1), "rotate": (1,), "straighten": (0,), "regrasp": (0,), "guide": (0,)}


def certify_move(
    rule: MoveRule,
    pre: PoseBox,
    setup: Setup,
    before: Step | None = None,
    *,
    whole: bool = True,
) -> Step:
    """Certify one move from every pose in ``pre``.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it and the task, world frame.
    before
        The move just before, of which more may be known than the box of poses that it leaves.
    whole
        False: nothing but the verdict and a box of poses after a proved move is wanted, and rough bounds do.

    Returns
    -------
    Step
        Its boxes in the world frame.

    Raises
    ------
    ValueError
        The rule's side or passive tip is not one that its action is certified for.
    """
    _check_shape(rule)
    frame = rule.frame
    own, there = frame.from_world(pre), frame.setup(setup)
    rough = not whole
    whole = whole or bool(setup.blocks)  # of a wall every pose on the way must be clear
    if rule.action == "tilt":
        step = certify_tilt(rule, own, there, whole=whole)
    elif rule.action == "rotate":
        step = certify_rotation(rule, own, there, rough=rough)
    elif rule.action == "regrasp":
        step = certify_regrasp(rule, own, there)
    elif rule.action == "guide":
        step = certify_guide(rule, own, there)
    else:
        known = None if before is None else known_before(before, own, frame, there)
        step = certify_straighten(rule, own, there, known, whole=whole)
    seen = replace(
        step,
        obligations=(*step.obligations, *force_below_cap(rule, there)),
        pre=pre,
        post=None if step.post is None else frame.box_to_world(step.post),
        tube=tuple(replace(k, box=frame.box_to_world(k.box)) for k in step.tube),
    )
    if setup.blocks:
        part = () if rule.action == "guide" else (part_clear(seen.tube, setup),)
        walls = (*part, tips_clear(rule, own, there))
        seen = replace(seen, obligations=(*seen.obligations, *walls))
    return seen


def may_rotate(rule: MoveRule, pre: PoseBox, setup: Setup) -> bool:
    """Whether what must hold of a rotation before it turns the part is proved, which takes little time.

    Parameters
    ----------
    rule, pre, setup
        The rotation, all poses before it and the task, world frame.

    Returns
    -------
    bool
        False: `certify_move` does not prove it either.
    """
    return rotation_begins(rule, rule.frame.from_world(pre), rule.frame.setup(setup))


def known_before(before: Step, own: PoseBox, frame: Frame, there: Setup) -> Leaves | None:
    """How y before a straightening hangs on the orientation; None: nothing is known of it.

    Parameters
    ----------
    before
        The move just before it, its rule in the world frame.
    own, frame, there
        All poses before the straightening, its axes, and the task seen from them.

    Returns
    -------
    Leaves or None
        In the axes of the straightening.
    """
    if isinstance(before.leaves, Turn):
        return before.leaves if before.rule.frame == frame else None
    if isinstance(before.leaves, Pushed):
        return _across(before.leaves, before.rule.frame, frame, there.edge(own.theta.mid))
    return None


def _across(pushed: Pushed, earlier: Frame, frame: Frame, edge: Edge) -> Across | None:
    """What a push tells of y in the axes of another one across it.

    Turned about a contact on an edge the part keeps ``y + depth theta`` but for terms of second order.
    """
    if (frame.quarters - earlier.quarters) % 2 == 0:
        return None
    x_to_y = float((frame.matrix.T @ earlier.matrix)[1, 0])
    turned = -1.0 if frame.mirrored != earlier.mirrored else 1.0
    lever = Interval.point(-edge.depth.mid)
    ahead = pushed.ahead(Interval.point(x_to_y * turned) * lever)
    if ahead is None:
        return None
    quarters = earlier.quarters - frame.quarters
    constant = HALF_PI * Interval.point(-quarters if frame.mirrored else quarters)
    return Across(lever=lever, range=Interval.point(x_to_y) * ahead - lever * constant)


def _check_shape(rule: MoveRule) -> None:
    """Refuse a rule of which the proof would not look at everything."""
    if rule.side not in SIDES[rule.action]:
        raise ValueError(f"a {rule.action} needs side in {SIDES[rule.action]}, got {rule.side}")
    if (rule.single is not None) != (rule.action == "rotate"):
        raise ValueError(f"a passive tip belongs to a rotation and to nothing else, got {rule}")
