"""Choosing the t^2 push that brings the part to the goal (Step 4), or just straightens it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from typing import TypeVar

import numpy as np

from meso_robust import units
from meso_robust.bounds import Verdict
from meso_robust.planning import nominal
from meso_robust.planning.clearance import errors_across, rise_of, start_ahead_um
from meso_robust.planning.sampling import REFINED, best_robust
from meso_robust.primitives.move import Aim, MoveRule, Point, from_part, in_world
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.obligation import Leaves, Step
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.straighten import certify_straighten, refuted

T = TypeVar("T")

FAR_UM = -1e5  # an end far beyond any travel that a turn can need
COARSE = 0.01  # of the edge: how closely a push is looked for whose first tip may slip
SPARE_UM = 2.0  # travel on top of what the bounds demand


@lru_cache(maxsize=256)  # several ways to the goal begin alike
def to_goal(
    pre: PoseBox,
    setup: Setup,
    past_um: float = 0.0,
    *,
    before: Leaves | None = None,
    slipping: bool = False,
) -> Step | None:
    """The robust t^2 push from ``pre`` that ends with the part's x at the goal, or ``past_um`` past it.

    ``before`` is as for `upright`. Of the samples of one level the one is taken that leaves most of the
    travel in reserve. If there is none, the first tip may slip where ``slipping``; that leaves the other
    coordinate less well known.
    """
    depth = setup.edge(pre.theta.mid).depth.mid + setup.uncertainty.tip_radius.mid
    end = in_world(units.to_um(setup.goal.x.mid + depth) - past_um)
    number = 3 if past_um else 4

    def rule_of(middle: float) -> MoveRule:
        return rule_at(middle, pre, setup, end, step=number, primitive="x_translation")

    def attempt(rule: MoveRule, slipping: bool) -> tuple[float, Step] | None:
        return _worth(certify_straighten(rule, pre, setup, before, whole=False, slipping=slipping))

    return _sample(pre, setup, rule_of, attempt, slipping=slipping)


def upright(
    pre: PoseBox,
    setup: Setup,
    *,
    step: int,
    primitive: str,
    before: Leaves | None = None,
    refined: int = REFINED,
    slipping: bool = False,
) -> Step | None:
    """The robust t^2 push that travels no further than both tips need to touch.

    Parameters
    ----------
    pre, setup
        All poses before the push, and the task, in its axes.
    step, primitive
        What the move is called.
    before
        How y hangs on the orientation after the move just before it, if that is known.
    refined
        How far the search goes on beyond the first robust push; see `best_robust`.
    slipping
        Whether the first tip may slip if no push is found in which it sticks.

    Returns
    -------
    Step or None
        The move, certified; None if none is found.
    """

    def rule_of(middle: float) -> MoveRule:
        return rule_at(middle, pre, setup, from_part(FAR_UM), step=step, primitive=primitive)

    def attempt(far: MoveRule, slipping: bool) -> tuple[float, MoveRule] | None:
        found = _worth(certify_straighten(far, pre, setup, before, whole=False, slipping=slipping))
        if found is None:
            return None
        left, trial = found
        end = from_part(FAR_UM + units.to_um(left) - SPARE_UM)
        return left, replace(trial.rule, dual_end=end)

    rule = _sample(pre, setup, rule_of, attempt, refined, slipping=slipping)
    return None if rule is None else certify_straighten(rule, pre, setup, before, whole=False)


def _sample(
    pre: PoseBox,
    setup: Setup,
    rule_of: Callable[[float], MoveRule],
    attempt: Callable[[MoveRule, bool], tuple[float, T] | None],
    refined: int = REFINED,
    *,
    slipping: bool,
) -> T | None:
    """The best height of the pair for a push whose tips stick, or else for one that may slip."""
    edge = setup.edge(pre.theta.mid)
    low, high = edge.first.mid, edge.last.mid
    smallest = max(setup.uncertainty.probe_position.hi, 1e-6)

    def if_nominal(slips: bool, middle: float) -> tuple[float, T] | None:
        nominally = nominal.straightens(middle, pre, setup, slipping=slips)
        return attempt(rule_of(middle), slips) if nominally else None

    def may_stick(middles: list[float]) -> list[float]:
        of = [one for one in middles if nominal.straightens(one, pre, setup)]
        gone = refuted(rule_of(0.0), pre, setup, np.array(of)) if of else ()
        return [one for one, bad in zip(of, gone, strict=True) if not bad]

    coarse = max(smallest, COARSE * (high - low))
    tried = (
        best_robust(low, high, finest, partial(if_nominal, slips), refined, sift)
        for slips, finest, sift in ((False, smallest, may_stick), (True, coarse, None))[
            : 1 + slipping
        ]
    )
    return next((found for found in tried if found is not None), None)


def _worth(candidate: Step) -> tuple[float, Step] | None:
    if candidate.verdict is not Verdict.PROVED:
        return None
    return reserve(candidate), candidate


def rule_at(
    middle: float, pre: PoseBox, setup: Setup, end: Aim, *, step: int, primitive: str
) -> MoveRule:
    """The rule of a t^2 push with the pair's middle ``middle`` (m) above the sensed centre."""
    y = from_part(units.to_um(middle))
    around = y.offset + errors_across(setup)
    rises = tuple((side, rise_of(around, side, setup)) for side in (1, -1))
    ahead = start_ahead_um(rises, pre, setup)
    return MoveRule(
        step=step,
        primitive=primitive,
        action="straighten",
        side=0,
        dual=Point(x=from_part(ahead), y=y),
        dual_end=end,
    )


def reserve(candidate: Step) -> float:
    """Travel that is left after the longest turn, m."""
    return min(
        obligation.proof.lower
        for obligation in candidate.obligations
        if obligation.name.id is ObligationId.SECOND_TIP_TOUCHES
    )
