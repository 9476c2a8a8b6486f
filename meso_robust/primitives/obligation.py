"""Inequalities that a primitive must prove, and the result of one certified step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from meso_robust.bounds import Box, Interval, Proof, Verdict, prove_positive
from meso_robust.conditions import condition
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import Inequality, Named
from meso_robust.primitives.setup import PoseBox


@dataclass(frozen=True, slots=True, kw_only=True)
class Obligation:
    """One inequality over one box, and what became of it."""

    name: Named
    """What it means for the motion."""
    inequality: Inequality
    proof: Proof


@dataclass(frozen=True, slots=True, kw_only=True)
class Knot:
    """One slice of a tube: all poses that the part can have at one stage of a move."""

    stage: str
    box: PoseBox


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Leaves:
    """How coordinates after a move hang on the orientation that it leaves, in its own axes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """A move with what was proved of it."""

    rule: MoveRule
    claim: Named
    """The property that the move is proved to have."""
    pre: PoseBox
    post: PoseBox | None
    """All poses the part can have afterwards; None when the motion could not be enclosed."""
    obligations: tuple[Obligation, ...]
    tube: tuple[Knot, ...]
    leaves: Leaves | None = field(default=None, compare=False, repr=False)
    """What the move that follows may use, beyond the box of poses."""

    @property
    def verdict(self) -> Verdict:
        """PROVED only when the motion is enclosed and every obligation is proved."""
        verdicts = {obligation.proof.verdict for obligation in self.obligations}
        if self.post is not None and verdicts <= {Verdict.PROVED}:
            return Verdict.PROVED
        return Verdict.UNKNOWN


def require(name: Named, inequality: Inequality, box: Mapping[str, Interval]) -> Obligation:
    """Try to prove that the generated function that ``inequality`` names is positive over ``box``."""
    of = condition(*inequality.split("."))
    sides = {key: box[key] for key in of.inputs}
    proof = prove_positive(of, sides, any_output=inequality.any_value)
    return Obligation(name=name, inequality=inequality, proof=proof)


def require_order(name: Named, inequality: Inequality, margin: Interval, box: Box) -> Obligation:
    """Record that ``margin``, an enclosure over ``box``, is positive (or that this is undecided)."""
    verdict = Verdict.PROVED if margin.lo > 0.0 else Verdict.UNKNOWN
    lower = margin.lo if margin.lo > 0.0 else -np.inf
    return Obligation(
        name=name,
        inequality=inequality,
        proof=Proof(verdict=verdict, lower=lower, boxes=1, box=box),
    )
