"""The margin: the policy reaches the goal with all uncertainties scaled by the stated factor."""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction

from meso_robust.checker.chain import verify_alone
from meso_robust.checker.document import Certificate, MarginDocument
from meso_robust.checker.ids import place
from meso_robust.checker.inputs import given
from meso_robust.checker.prover import PLAIN, Prover
from meso_robust.checker.refusal import Refused
from meso_robust.task import Task


def check_form(margin: MarginDocument, names: Collection[str], actions: Collection[str]) -> None:
    """What must hold of the margin's numbers among each other, and of what it names.

    Parameters
    ----------
    margin
        As stated.
    names
        What can be scaled.
    actions
        What the moves of the plan are.

    Raises
    ------
    Refused
        It does not.
    """
    alone = margin.each_alone
    if set(alone) != set(names):
        raise Refused(place("margin.each_alone"), sorted(alone), sorted(names))
    least = min(alone, key=lambda name: alone[name])
    if margin.binds_first is None or alone.get(margin.binds_first) != alone[least]:
        raise Refused(place("margin.binds_first"), margin.binds_first, least)
    if not 1.0 <= margin.factor <= alone[least]:
        raise Refused(place("margin.factor"), margin.factor, f"1 to {alone[least]}")
    if (margin.refused_at is None) != (margin.limit is None):
        raise Refused(place("margin.limit"), margin.limit, margin.refused_at)
    # a certificate of schema 1 names none
    if margin.limit is not None and margin.limit.action not in ("", *actions):
        raise Refused(place("margin.limit.action"), margin.limit.action, sorted(set(actions)))
    if margin.refused_at is not None and not margin.factor < margin.refused_at:
        raise Refused(place("margin.refused_at"), margin.refused_at, margin.factor)


def check_none(margin: MarginDocument) -> None:
    """A plan that is not proved bears nothing.

    Raises
    ------
    Refused
        A factor is stated.
    """
    if margin.factor != 0.0 or any(margin.each_alone.values()):
        raise Refused(place("margin.factor"), margin.factor, 0.0)


def check_factor(
    certificate: Certificate, task: Task, *, alone: bool, prover: Prover = PLAIN
) -> None:
    """Verify the whole chain again with scaled uncertainties.

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
            raise Refused(
                place(f"margin.{name}"), factor, f"not shown: {refused.claim}"
            ) from refused
