"""A task and a plan for it, as parts of a campaign name them and as their chunks use them."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

from meso_robust.campaigns.kind import Part, PlanSection, Values
from meso_robust.certificates.chain import certify
from meso_robust.errors import InputError, NotApplicableError
from meso_robust.laboratory.claims import Claims, claims_of, only_motions
from meso_robust.laboratory.draws import nominal
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.open_loop import OpenLoop
from meso_robust.laboratory.replay import Feedback, Player
from meso_robust.laboratory.running import run
from meso_robust.laboratory.simulation import player_of
from meso_robust.planning.compose import compose
from meso_robust.planning.document import PlanDocument, plan_document
from meso_robust.planning.reading import read_plan
from meso_robust.planning.rules import rules_of
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.task import Task, load_task, parse_task
from meso_robust.tasks import PAPER
from meso_robust.wording import down_to


def given_plan(section: PlanSection, folder: Path) -> Values:
    """Task and plan as JSON values.

    Raises
    ------
    InputError
        A file cannot be read or breaks a rule, or no plan can be made for the task.
    """
    task = load_task(PAPER if section.task is None else folder / section.task)
    if section.factor > largest_factor(task):
        raise InputError(
            f"part {section.name!r}: key factor = {section.factor:g}: must not exceed "
            f"{down_to(largest_factor(task), 4)}, beyond which friction or film ratio would not be positive"
        )
    plan = _planned(task) if section.plan is None else read_plan(folder / section.plan, task)
    return {
        "task": task.model_dump(mode="json", by_alias=True),
        "plan": plan.model_dump(mode="json", by_alias=True),
    }


def largest_factor(task: Task) -> float:
    """By what all uncertainties can be scaled before friction or film ratio reaches zero."""
    u = setup_of(task).uncertainty
    halves = ((u.friction.mid, u.friction.hi), (u.film_ratio.mid, u.film_ratio.hi))
    bears = [middle / (high - middle) for middle, high in halves if high > middle]
    # a little less, as the ends are rounded outward
    return 0.999 * min(bears, default=float("inf"))


def _planned(task: Task) -> PlanDocument:
    """The plan that ``meso-robust plan`` finds, without its certificate."""
    try:
        rules = compose(task).rules
    except NotApplicableError as error:
        raise InputError(f"task {task.name!r}: no plan can be made for it ({error})") from error
    setup = setup_of(task)
    sensed = [move.sensed[0] for move in run(rules, setup, nominal(setup, len(rules))).moves]
    return plan_document(task, rules, sensed, (None,) * len(rules))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GivenPlan:
    """A task and a plan, ready to be run."""

    task: Task
    plan: PlanDocument
    setup: Setup
    """With the uncertainties scaled by ``factor``."""
    factor: float

    @property
    def feedback(self) -> Feedback:
        """The plan's policy.

        Raises
        ------
        InputError
            The plan states bare moves.
        """
        if not self.plan.policy:
            raise InputError("the plan states no policy: give a plan that `meso-robust plan` made")
        return Feedback(rules=rules_of(self.plan), setup=self.setup)

    def player(self, engine: Engine) -> Player:
        """The plan as something to be run by an engine; bare moves are run by the stepper only."""
        found = player_of(self.plan, self.setup)
        return found if isinstance(found, OpenLoop) else replace(found, engine=engine)

    def claims(self) -> Claims:
        """What is claimed of the runs: all that is proved, or at another factor the outcome alone."""
        rules = rules_of(self.plan)
        if self.factor != 1.0:
            return only_motions(rules, self.setup)
        return claims_of(certify(rules, self.setup), rules)


def plan_of(part: Part) -> GivenPlan:
    """Task and plan from what :func:`given_plan` read."""
    task = parse_task(dict(part.given["task"]), f"part {part.name!r}")
    factor = float(part.asked["factor"])
    return GivenPlan(
        task=task,
        plan=PlanDocument.model_validate_json(json.dumps(part.given["plan"]), strict=True),
        setup=setup_of(task, factor),
        factor=factor,
    )
