"""What all chunks of a part share: the plan, what is claimed of it, what is raised."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meso_robust.campaigns.falsify.section import FalsifySection, section_of
from meso_robust.campaigns.falsify.targets import Target, all_targets
from meso_robust.campaigns.falsify.threshold import attack
from meso_robust.campaigns.kind import Part, Values
from meso_robust.campaigns.planned import GivenPlan, given_plan, plan_of
from meso_robust.errors import InputError
from meso_robust.laboratory.ascent import Effort
from meso_robust.laboratory.claims import Claims
from meso_robust.laboratory.replay import Feedback
from meso_robust.types import Floats

SHORT = Effort(corners=500, reaches=(1.0,), elite=2, generations=0)
"""Of the attack whose summits adversarial draws start from."""
OWN_STREAM = 2**63  # of random numbers, not that of any chunk


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ready:
    """Everything that a chunk needs."""

    plan: GivenPlan
    player: Feedback
    claims: Claims
    targets: tuple[Target, ...]
    seeds: Floats
    """(S, D) hard rows that adversarial draws start from; none unless they are asked for."""

    @property
    def certified(self) -> bool:
        """Whether a certificate stands behind all of the claims, to the last move."""
        return all(box is not None for box in self.claims.posts)

    def target(self, name: str) -> Target:
        """The target of a name."""
        return next(target for target in self.targets if target.name == name)


def given(section: FalsifySection, folder: Path) -> Values:
    """Task and plan, and the names of everything that a search can raise.

    Raises
    ------
    InputError
        A file cannot be read or breaks a rule, or the plan states no policy.
    """
    found = given_plan(section, folder)
    if not found["plan"]["policy"]:
        raise InputError(
            f"part {section.name!r}: key plan = {section.plan!r}: must state a policy, because bare "
            "moves carry no claim; give a plan that `meso-robust plan` made"
        )
    asked = section.model_dump(mode="json")
    part = Part(
        name=section.name, kind="falsify", seed=0, confidence=0.95, asked=asked, given=found
    )
    targets = all_targets(plan_of(part).claims())
    return {**found, "targets": [target.name for target in targets]}


def ready_of(part: Part) -> Ready:
    """Read and certify."""
    plan = plan_of(part)
    claims = plan.claims()
    return Ready(
        plan=plan,
        player=replace(plan.feedback, engine=section_of(part).engine),
        claims=claims,
        targets=all_targets(claims),
        seeds=np.zeros((0, len(plan.feedback.columns))),
    )


def prepare(part: Part) -> Ready:
    """Read, certify, and look for hard rows if adversarial draws are asked for."""
    ready = ready_of(part)
    if "adversarial" not in section_of(part).methods:
        return ready
    return replace(ready, seeds=hard_rows(ready, part.seed))


def hard_rows(ready: Ready, seed: int) -> Floats:
    """(S, D) the summits of a short attack by the event-driven engine, which is the fast one."""
    rng = np.random.default_rng([seed, OWN_STREAM])
    player = replace(ready.player, engine="events")
    reached = attack(player, [t for t in ready.targets if not t.record], rng, SHORT)
    return np.array([one.summit.row for one in reached])
