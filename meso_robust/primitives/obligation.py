"""Inequalities that a primitive must prove, and the result of one certified step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from meso_robust.admissibility import condition
from meso_robust.bounds import Box, Interval, Proof, Verdict, prove_positive
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import PoseBox


@dataclass(frozen=True, slots=True, kw_only=True)
class Obligation:
    """One inequality over one box, and what became of it."""

    claim: str
    """What it means for the motion."""
    inequality: str
    """The inequality, with the names of the box's sides."""
    derivation: str
    """File that derives it."""
    proof: Proof


@dataclass(frozen=True, slots=True, kw_only=True)
class Knot:
    """One slice of a tube: all poses that the part can have at one stage of a move."""

    stage: str
    box: PoseBox


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """A move with what was proved of it."""

    rule: MoveRule
    claim: str
    """The property, in words."""
    pre: PoseBox
    post: PoseBox | None
    """All poses the part can have afterwards; None when the motion could not be enclosed."""
    obligations: tuple[Obligation, ...]
    tube: tuple[Knot, ...]

    @property
    def verdict(self) -> Verdict:
        """PROVED only when the motion is enclosed and every obligation is proved."""
        verdicts = {obligation.proof.verdict for obligation in self.obligations}
        if self.post is not None and verdicts <= {Verdict.PROVED}:
            return Verdict.PROVED
        return Verdict.UNKNOWN


def require(
    claim: str, module: str, name: str, box: Mapping[str, Interval], *, any_output: bool = False
) -> Obligation:
    """Try to prove that the generated function ``module.name`` is positive over ``box``."""
    of = condition(module, name)
    sides = {key: box[key] for key in of.inputs}
    joined = "at least one of its values > 0" if any_output else "every value > 0"
    return Obligation(
        claim=claim,
        inequality=f"{module}.{name}({', '.join(of.inputs)}): {joined}",
        derivation=f"derivations/{module}.py",
        proof=prove_positive(of, sides, any_output=any_output),
    )


def require_order(claim: str, inequality: str, margin: Interval, box: Box) -> Obligation:
    """Record that ``margin``, an enclosure over ``box``, is positive (or that this is undecided)."""
    verdict = Verdict.PROVED if margin.lo > 0.0 else Verdict.UNKNOWN
    lower = margin.lo if margin.lo > 0.0 else -np.inf
    return Obligation(
        claim=claim,
        inequality=inequality,
        derivation="interval arithmetic on the enclosures above",
        proof=Proof(verdict=verdict, lower=lower, boxes=1, box=box),
    )
