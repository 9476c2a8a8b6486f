"""What proves a move and compares what is stated of it, as functions that can be handed over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from meso_robust.checker.document import ObligationDocument, RuleDocument
from meso_robust.checker.inputs import Given, PoseBox
from meso_robust.checker.moves import verify_move
from meso_robust.checker.obligations import compare
from meso_robust.checker.passage import Memory, Passage
from meso_robust.checker.requirement import Requirement
from meso_robust.checker.scene import Scene

Move = Callable[[RuleDocument, PoseBox, Given, Memory | None], tuple[Scene, Passage]]
Compare = Callable[[tuple[ObligationDocument, ...], tuple[Requirement, ...]], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Prover:
    """The two functions that take the checker's time; both are pure and say no by ``Refused``.

    Whoever checks many certificates that differ in little may hand over functions that remember
    their answers; what they return is believed.
    """

    move: Move = verify_move
    compare: Compare = compare


PLAIN = Prover()
"""Every proof is computed again."""
