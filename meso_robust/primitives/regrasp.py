"""Re-grasping: the pair of tips travels in the plane beside the part, and the part stays at rest."""

from __future__ import annotations

from meso_robust.bounds import Box, Verdict
from meso_robust.primitives.base import base_box, off_line
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import ObligationId, Property, about
from meso_robust.primitives.obligation import Knot, Obligation, Step
from meso_robust.primitives.setup import PoseBox, Setup


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
    box = base_box(rule, pre, setup, setup.edge(pre.theta.mid))
    return Step(
        rule=rule,
        claim=about(Property.PART_RESTS),
        pre=pre,
        post=pre,
        obligations=tuple(_passes_by(tip, box, pre, setup) for tip in (1, -1)),
        tube=(Knot(stage="at rest", box=pre),),
    )


def _passes_by(tip: int, box: Box, pre: PoseBox, setup: Setup) -> Obligation:
    """One side of the convex hull has the whole way of the tip on its outer side."""
    id_ = ObligationId.TIP_CLEAR_OF_PART
    tried = [off_line(id_, tip, line, box) for line in setup.sides(pre.theta.mid)]
    return next((o for o in tried if o.proof.verdict is Verdict.PROVED), tried[0])
