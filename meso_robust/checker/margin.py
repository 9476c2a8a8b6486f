"""The margin: the policy reaches the goal with all uncertainties scaled by the stated factor."""

from __future__ import annotations

from fractions import Fraction

from meso_robust.checker.chain import verify_alone
from meso_robust.checker.document import Certificate, MarginDocument
from meso_robust.checker.given import SCALED, given
from meso_robust.checker.prover import PLAIN, Prover
from meso_robust.checker.refusal import Refused
from meso_robust.task import Task


def check_words(margin: MarginDocument) -> None:
    """What must hold of the margin's numbers among each other.

    Raises
    ------
    Refused
        It does not.
    """
    alone = margin.each_alone
    if set(alone) != set(SCALED):
        raise Refused("margin.each_alone: one factor an uncertainty", sorted(alone), sorted(SCALED))
    least = min(alone, key=lambda name: alone[name])
    if margin.binds_first is None or alone.get(margin.binds_first) != alone[least]:
        raise Refused("margin.binds_first: the least of each_alone", margin.binds_first, least)
    if not 1.0 <= margin.factor <= alone[least]:
        raise Refused("margin.factor: from 1 to each_alone", margin.factor, f"1 to {alone[least]}")
    if (margin.refused_at is None) != (margin.limit is None):
        raise Refused("margin.limit: given with refused_at", margin.limit, margin.refused_at)
    if margin.refused_at is not None and not margin.factor < margin.refused_at:
        raise Refused("margin.refused_at: above factor", margin.refused_at, margin.factor)


def check_none(margin: MarginDocument) -> None:
    """A plan that is not proved bears nothing.

    Raises
    ------
    Refused
        A factor is stated.
    """
    if margin.factor != 0.0 or any(margin.each_alone.values()):
        raise Refused("margin: 0 of a plan that is not proved", margin.factor, 0.0)


def check_factor(
    certificate: Certificate, task: Task, *, alone: bool, prover: Prover = PLAIN
) -> None:
    """Verify the whole chain anew with scaled uncertainties.

    Parameters
    ----------
    certificate, task
        What is checked.
    alone
        Whether the factors of single uncertainties are verified as well.
    prover
        Proves the moves.

    Raises
    ------
    Refused
        It does not reach the goal.
    """
    margin = certificate.margin
    wanted: list[tuple[str, float, str | None]] = [("factor", margin.factor, None)]
    if alone:
        wanted += [(f"each_alone.{name}", f, name) for name, f in margin.each_alone.items()]
    for name, factor, only in wanted:
        try:
            verify_alone(certificate.policy, given(task, Fraction(factor), only), prover)
        except Refused as refused:
            raise Refused(f"margin.{name}", factor, f"not shown: {refused.claim}") from refused
