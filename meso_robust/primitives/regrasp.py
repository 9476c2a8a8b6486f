"""Re-grasping: the pair of tips travels in the plane beside the part, and the part stays at rest."""

from __future__ import annotations

from meso_robust.bounds import HALF_PI, Interval, Verdict
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import SIDES, Inequality, ObligationId, Property, about
from meso_robust.primitives.obligation import Knot, Obligation, Step, require
from meso_robust.primitives.outline import Line
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tips import Tip, tip_of


def certify_regrasp(rule: MoveRule, pre: PoseBox, setup: Setup) -> Step:
    """Certify that the pair meets the part nowhere on its way, from every pose in ``pre``.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it, the task; all in the move's axes.

    Raises
    ------
    ValueError
        If the rule has a passive tip.
    """
    if rule.single is not None:
        raise ValueError(f"a regrasp moves the pair alone, got {rule}")
    tips = [tip_of(rule, side, pre, setup) for side in (1, -1)]
    return Step(
        rule=rule,
        claim=about(Property.PART_RESTS),
        pre=pre,
        post=pre,
        obligations=tuple(_passes_by(tip, pre, setup) for tip in tips),
        tube=(Knot(stage="at rest", box=pre),),
    )


def _passes_by(tip: Tip, pre: PoseBox, setup: Setup) -> Obligation:
    """One side of the convex hull has the whole way of the tip on its outer side."""
    tried = [_beyond(edge, tip, pre) for edge in _edges(pre, setup)]
    return next((o for o in tried if o.proof.verdict is Verdict.PROVED), tried[0])


def _edges(pre: PoseBox, setup: Setup) -> tuple[Line, ...]:
    """The sides of the convex hull, the one that faces the pair first."""
    edge = setup.edge(pre.theta.mid)
    if edge.beyond:
        return (edge, *edge.beyond)
    return tuple(setup.edge(pre.theta.mid + k * HALF_PI.mid) for k in (0, 1, 2, 3))


def _beyond(edge: Line, tip: Tip, pre: PoseBox) -> Obligation:
    way: Interval = tip.ahead.hull(tip.ahead_end)
    return require(
        about(ObligationId.TIP_CLEAR_OF_PART, tip=SIDES[tip.side]),
        Inequality.CLEARANCE,
        {"theta": edge.angle(pre.theta), "d1": edge.depth, "dx": way, "dy": tip.rise},
    )
