"""The certificate that is tampered with, and its task."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from meso_robust.campaigns.mutation.places import Document
from meso_robust.certificates.chain import Chain, certify
from meso_robust.certificates.document import CertificateDocument, WitnessDocument
from meso_robust.laboratory.claims import Accuracy, broken, only_motions
from meso_robust.laboratory.draws import Draws, draw
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.judging import EXACT_SLIP, INSTANTS, ROUNDING
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.running import PlanRun, run
from meso_robust.laboratory.simulation import in_goal
from meso_robust.laboratory.witness import witness_row
from meso_robust.planning.document import PlanDocument
from meso_robust.planning.rules import rules_of
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.outline import Rectangle
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.task import Task

ENGINES: tuple[Engine, ...] = ("stepper", "events")
RUNS, RECORD = 500, 200
"""Simulated runs of a policy, half of them at corners of the uncertainties; intervals of their paths."""


@dataclass(frozen=True, eq=False)
class Original:
    """A true certificate."""

    task: Task
    document: Document

    @cached_property
    def setup(self) -> Setup:
        """The task in SI intervals."""
        return setup_of(self.task)

    def rules(self, policy: Any) -> tuple[MoveRule, ...]:
        """The moves of a certificate's ``policy``."""
        certificate = CertificateDocument.model_validate({**self.document, "policy": policy})
        return rules_of(
            PlanDocument(
                task=self.task.name,
                task_hash=self.task.hash,
                policy=certificate.policy,
                moves=(),
            )
        )

    def certified(self, policy: Any, setup: Setup | None = None) -> Chain:
        """What the planner proves of a policy."""
        return certify(self.rules(policy), self.setup if setup is None else setup)

    def chain_of(self, task: Task) -> Chain:
        """What the planner proves of the certificate's own moves in another task."""
        if task.hash not in self._chains:
            self._chains[task.hash] = self.certified(self.document["policy"], setup_of(task))
        return self._chains[task.hash]

    @cached_property
    def _chains(self) -> dict[str, Chain]:
        return {}

    def paths(self, policy: Any) -> tuple[PlanRun, Draws]:
        """Simulated runs of a policy with their paths, always the same ones."""
        return self._own_paths if policy == self.document["policy"] else self._paths(policy)

    def ends(self, policy: Any) -> PlanRun:
        """The same by the event-driven engine: where moves end, to the rounding of doubles."""
        return self._own_ends if policy == self.document["policy"] else self._ends(policy)

    def keeps(self, policy: Any, setup: Setup) -> bool:
        """Whether all simulated runs under other uncertainties keep what is claimed of the motions."""
        if not isinstance(setup.outline, Rectangle):
            return False
        rules = self.rules(policy)
        runs = run(rules, setup, self._draws(len(rules), setup), record=INSTANTS, engine="events")
        exact = Accuracy(slip=EXACT_SLIP, pose=(np.full((1, 3), ROUNDING),) * len(rules))
        flags = broken(runs, only_motions(rules, setup), exact).values()
        return bool(runs.completed.all()) and not any(flag.any() for flag in flags)

    def fails(self, policy: Any, witness: Any) -> bool:
        """Whether the run of a witness fails by each engine of the simulator."""
        found = WitnessDocument.model_validate(witness)
        players = [
            Feedback(rules=self.rules(policy), setup=self.setup, engine=engine)
            for engine in ENGINES
        ]
        runs = [one.run(witness_row(found, one, "certificate")) for one in players]
        return not any(in_goal(one, self.setup).any() for one in runs)

    @cached_property
    def _own_paths(self) -> tuple[PlanRun, Draws]:
        return self._paths(self.document["policy"])

    @cached_property
    def _own_ends(self) -> PlanRun:
        return self._ends(self.document["policy"])

    def _paths(self, policy: Any) -> tuple[PlanRun, Draws]:
        rules = self.rules(policy)
        draws = self._draws(len(rules))
        return run(rules, self.setup, draws, record=RECORD), draws

    def _ends(self, policy: Any) -> PlanRun:
        rules = self.rules(policy)
        return run(rules, self.setup, self._draws(len(rules)), engine="events")

    def _draws(self, moves: int, setup: Setup | None = None) -> Draws:
        return draw(setup or self.setup, moves, RUNS, np.random.default_rng(0))
