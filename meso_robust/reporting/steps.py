"""The proof of a plan move by move, every cell a text or a plain number."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from meso_robust.certificates.chain import certify
from meso_robust.certificates.document import STATED, ObligationDocument, StepDocument, name_of
from meso_robust.certificates.words import derivation_words, inequality_words, words
from meso_robust.pipeline import Planned
from meso_robust.primitives.setup import setup_of
from meso_robust.reporting.conditions import Condition, condition
from meso_robust.reporting.reading import Standing, standings
from meso_robust.reporting.words import Side, box_words, sides, significant

Three = tuple[str, str, str]


@dataclass(frozen=True, slots=True)
class ObligationRow:
    """One inequality."""

    claim: str
    inequality: str
    derivation: str
    verdict: str
    lower: str
    boxes: int
    over: tuple[Side, ...]
    condition: Condition | None
    """The generated function that it is about, if any."""
    left: int | None
    """What of its least value without errors is left with all of them, %, rounded down."""


@dataclass(frozen=True, slots=True)
class StepRow:
    """One move and what was proved of it."""

    number: int
    title: str
    standing: Standing
    claim: str
    pre: Three | None
    post: Three | None
    proved: int
    obligations: tuple[ObligationRow, ...]


def step_rows(result: Planned) -> tuple[StepRow, ...]:
    """A row for every move of the plan, also for those that the proof did not reach."""
    rules, documents = result.found.rules, result.certificate.steps
    padded = [*documents, *[None] * (len(rules) - len(documents))]
    known, ideal = standings(result.chain, len(rules)), _without_errors(result)
    return tuple(
        _step(index, title(result, index), standing, document, ideal)
        for index, (standing, document) in enumerate(zip(known, padded, strict=True))
    )


Ideal = Mapping[tuple[int, str], float]


def _without_errors(result: Planned) -> Ideal:
    """Lower bound of every inequality, by move and name, where no uncertainty is left.

    As it would be stated in a certificate: what is compared with it is stated in one.
    """
    steps = certify(result.found.rules, setup_of(result.task, 0.0)).steps
    found = [(index, item) for index, step in enumerate(steps) for item in step.obligations]
    times = Counter((index, item.name.key) for index, item in found)
    return {
        (index, item.name.key): STATED * item.proof.lower
        for index, item in found
        if times[index, item.name.key] == 1  # else it is not said which of them is meant
    }


def title(result: Planned, index: int) -> str:
    """What a move is: the step of the paper, the primitive and the action."""
    rule = result.found.rules[index]
    return f"Step {rule.step} · {rule.primitive} · {rule.action}"


def _step(
    index: int, name: str, standing: Standing, step: StepDocument | None, ideal: Ideal
) -> StepRow:
    if step is None:
        return StepRow(index + 1, name, standing, "", None, None, 0, ())
    return StepRow(
        number=index + 1,
        title=name,
        standing=standing,
        claim=words(name_of(step.property)),
        pre=box_words(step.pre_exact),
        post=None if step.post_exact is None else box_words(step.post_exact),
        proved=sum(obligation.verdict == "PROVED" for obligation in step.obligations),
        obligations=tuple(
            _obligation(obligation, ideal.get((index, name_of(obligation).key)))
            for obligation in step.obligations
        ),
    )


def _obligation(document: ObligationDocument, ideal: float | None) -> ObligationRow:
    bound = document.lower_bound
    inequality = document.inequality
    return ObligationRow(
        claim=words(name_of(document)),
        inequality=inequality_words(inequality),
        derivation=derivation_words(inequality.derivation),
        verdict=document.verdict,
        lower="—" if bound is None else significant(float.fromhex(bound), 3),
        boxes=document.boxes,
        over=sides(document.over),
        condition=condition(document.inequality),
        left=None if bound is None else _left(float.fromhex(bound), ideal),
    )


def _left(worst: float, ideal: float | None) -> int | None:
    """Share of a bound that errors leave, %; None where there is nothing to compare with."""
    if ideal is None or not 0.0 < ideal < math.inf:
        return None
    return min(math.floor(100.0 * worst / ideal), 100)
