"""The policy of a plan file as rules."""

from __future__ import annotations

from meso_robust.planning.plan_file import AimDocument, PlanDocument, RuleDocument
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.move import Aim, Anchor, MoveRule, Point


def rules_of(plan: PlanDocument) -> tuple[MoveRule, ...]:
    """The policy of a plan file as rules.

    Parameters
    ----------
    plan
        As read.

    Returns
    -------
    tuple
        Its moves; empty for an open-loop plan.
    """
    return tuple(_rule(rule) for rule in plan.policy)


def _rule(rule: RuleDocument) -> MoveRule:
    single = None
    if rule.single_x is not None and rule.single_y is not None:
        single = Point(x=_aim(rule.single_x), y=_aim(rule.single_y))
    return MoveRule(
        step=rule.step,
        primitive=rule.primitive,
        action=rule.action,
        side=rule.side,
        dual=Point(x=_aim(rule.dual_x), y=_aim(rule.dual_y)),
        dual_end=_aim(rule.dual_end_x),
        single=single,
        frame=Frame(heading=rule.heading, mirrored=rule.mirrored),
    )


def _aim(aim: AimDocument) -> Aim:
    return Aim(anchor=Anchor(aim.relative_to), offset_um=aim.offset_um)
