"""The main job in stages: compose, certify, search the margin, simulate, judge."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from meso_robust import units
from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import Chain, certify
from meso_robust.certificates.design import design
from meso_robust.certificates.document import (
    CertificateDocument,
    SimulationDocument,
    WitnessDocument,
    claim_document,
    exact_box,
    in_um_deg,
    margin_document,
    reading_document,
    sealed,
    step_document,
    undecided_document,
)
from meso_robust.certificates.margin import Margin, margin
from meso_robust.laboratory.crosscheck import CrossCheck, confirmed, crosscheck
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.running import STARTS_INSIDE, STEP, WOULD_START_INSIDE
from meso_robust.laboratory.witness import more_of
from meso_robust.planning.compose import Found, compose
from meso_robust.planning.document import PlanDocument, goal_document, plan_document
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.provenance import made_with
from meso_robust.simulator import Outcome, ahead
from meso_robust.stages import Doing, quietly
from meso_robust.task import Task
from meso_robust.wording import counted, do, down, up, worded

_THETA = 2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Planned:
    """Everything that ``plan`` found out about a task."""

    task: Task
    setup: Setup
    found: Found
    chain: Chain
    check: CrossCheck
    margin: Margin
    plan: PlanDocument
    certificate: CertificateDocument
    search_s: float | None = None
    """Computing time that the search for the plan was limited to, s; None: to none."""

    @property
    def summary(self) -> str:
        """The answer in a few lines."""
        check, runs = self.check, len(self.check.in_goal)
        lines = [
            f"{self.certificate.verdict} ({self.task.tips}): {self.task.name}, "
            f"{counted(len(self.found.rules), 'move')}",
            f"simulated: {int(check.in_goal.sum())} of {counted(runs, 'run')} {do(runs, 'end')} in the goal"
            + _failures(check),
        ]
        if self.certificate.verdict == "PROVED":
            lines.append(
                f"margin: still proved with all uncertainties x {down(self.margin.factor, 2)}; "
                f"{(self.margin.binding or '').replace('_', ' ')} binds first"
            )
        open_, said = self.certificate.undecided, self.certificate.reading.undecided
        if open_ is not None and said is not None:
            lines.append(f"not proved in step {open_.step} ({open_.action}): {said.claim}")
            lines.append(f"what would settle it: {said.settled_by}")
        return worded("\n".join(lines))


def _failures(check: CrossCheck) -> str:
    """How those runs end that do not end in the goal."""
    early, missed = ~check.sampled.completed, check.sampled.completed & ~check.in_goal
    said = ""
    if missed.any():
        away, count = check.missed[missed], int(missed.sum())
        axis = int(np.argmax((away > 0.0).sum(axis=0)))
        far = float(away[:, axis].max())
        size = (
            f"{up(units.to_deg(far), 2)} deg" if axis == _THETA else f"{up(units.to_um(far), 2)} um"
        )
        said += (
            f"; {count} {do(count, 'end')} outside it, {['x', 'y', 'theta'][axis]} by up to {size}"
        )
    if early.any():
        ends, counts = np.unique(check.sampled.outcomes[early], return_counts=True)
        ways = [
            "a tip starts inside the part" if end == STARTS_INSIDE else Outcome(end).word
            for end in ends[np.argsort(-counts)]
        ]
        said += f"; {int(early.sum())} cannot be carried out: {', '.join(ways)}"
    return said


class SimulatorContradictsProofError(RuntimeError):
    """A PROVED plan fails in the simulator: one of the two is wrong, and nothing is reported."""


def make(
    task: Task,
    samples: int,
    seed: int,
    doing: Doing = quietly,
    search_s: float | None = None,
) -> Planned:
    """Find a plan and judge it.

    Parameters
    ----------
    task
        What to plan for.
    samples, seed
        Random runs in the simulator, and the seed of their draws.
    doing
        Shows what is being done while a stage runs.
    search_s
        Computing time after which the search for a plan gives up, s, about; None: as long as it takes.

    Returns
    -------
    Planned
        Whatever the verdict.

    Raises
    ------
    NotApplicableError
        No primitive can handle the task.
    SimulatorContradictsProofError
        The simulator and the proof disagree.
    """
    ahead.begin()
    within = "" if search_s is None else f"for at most about {search_s:g} s of computing; "
    with doing(f"searching for a plan ({within}the first run compiles kernels: about a minute)"):
        found = compose(task, search_s)
    return replace(judge(task, found, samples, seed, doing), search_s=search_s)


def make_best(task: Task, samples: int, seed: int, doing: Doing = quietly) -> Planned:
    """Search the design with the widest margin, and judge its plan.

    The result's task may have another ``tip_spacing_um``; everything else is as for :func:`make`.

    Parameters
    ----------
    task
        What to plan for.
    samples, seed, doing
        As for :func:`make`.

    Returns
    -------
    Planned
        Whatever the verdict.
    """
    with doing("optimising spacing, offsets and travels (one to three minutes)"):
        best = design(task)
    return judge(best.task, Found(rules=best.rules, scale=best.factor), samples, seed, doing)


def judge(task: Task, found: Found, samples: int, seed: int, doing: Doing = quietly) -> Planned:
    """Certify a plan, search its margin, simulate it.

    Parameters
    ----------
    task, found
        The task and the plan for it, whoever made it.
    samples, seed, doing
        As for :func:`make`.

    Returns
    -------
    Planned
        Whatever the verdict.

    Raises
    ------
    SimulatorContradictsProofError
        The simulator and the proof disagree.
    """
    ahead.begin()
    setup = setup_of(task)
    with doing("certifying"):
        chain = certify(found.rules, setup)

    with doing("searching for the margin"):
        bears = margin(found.rules, task)
    with doing(f"simulating {counted(samples, 'run')}"):
        ahead.wait()
        posts = [step.post for step in chain.steps]
        check = crosscheck(found.rules, setup, posts, samples, seed)
    if chain.verdict is Verdict.PROVED and check.failure is not None:
        raise SimulatorContradictsProofError(
            f"run {check.failure} of seed {seed} breaks a PROVED claim: "
            f"{_ending(check, check.failure).words}, final pose {check.sampled.final[check.failure]}"
        )
    sensed = [move.sensed[0] for move in check.nominal.moves]
    plan = plan_document(task, found.rules, sensed, _certified(chain, len(found.rules)))
    return Planned(
        task=task,
        setup=setup,
        found=found,
        chain=chain,
        check=check,
        margin=bears,
        plan=plan,
        certificate=_certificate(task, setup, found, chain, check, bears, plan),
    )


def _certified(chain: Chain, moves: int) -> list[PoseBox | None]:
    """Box after each move, None from the first move on that is not proved."""
    boxes: list[PoseBox | None] = []
    for step in chain.steps:
        if step.verdict is not Verdict.PROVED:
            break
        boxes.append(step.post)
    return [*boxes, *[None] * (moves - len(boxes))]


def _certificate(
    task: Task,
    setup: Setup,
    found: Found,
    chain: Chain,
    check: CrossCheck,
    bears: Margin,
    plan: PlanDocument,
) -> CertificateDocument:
    verdict, witness, outcome = chain.verdict, None, None
    if verdict is Verdict.UNKNOWN and confirmed(found.rules, setup, check):
        verdict, witness, outcome = (
            Verdict.REFUTED,
            *_witness(check, Feedback(rules=found.rules, setup=setup)),
        )
    moves, undecided = len(found.rules), undecided_document(chain, found.settled_by)
    document = CertificateDocument(
        verdict=verdict.word,
        task=task.name,
        task_hash=task.hash,
        claim=claim_document(task, chain, moves),
        goal=goal_document(setup.goal),
        goal_exact=exact_box(setup.goal),
        policy=plan.policy,
        steps=tuple(step_document(step) for step in chain.steps),
        undecided=None if undecided is None else undecided.document,
        witness=witness,
        margin=margin_document(bears),
        simulation=_simulation(check),
        made_with=_made_with(check.seed),
        reading=reading_document(
            task,
            chain,
            moves,
            undecided=None if undecided is None else undecided.reading,
            limit=bears.limit,
            outcome=outcome,
        ),
    )
    return sealed(document)


def _simulation(check: CrossCheck) -> SimulationDocument:
    return SimulationDocument(
        samples=len(check.in_goal),
        seed=check.seed,
        step_um=units.to_um(STEP),
        completed=int(check.sampled.completed.sum()),
        in_goal=int(check.in_goal.sum()),
        in_certified_box=None if check.in_box is None else int(check.in_box.sum()),
        largest_excess_um_um_deg=tuple(in_um_deg(value) for value in check.step_excess),
        simulator_error_um_um_deg=in_um_deg(check.error),
    )


@dataclass(frozen=True, slots=True)
class _Ending:
    """How a run ends that breaks the claim."""

    id: str
    words: str
    move: int | None = None
    """The move that was not completed, from 1."""


def _ending(check: CrossCheck, row: int) -> _Ending:
    code, move = int(check.sampled.outcomes[row]), int(check.sampled.failed_in[row]) + 1
    if code == Outcome.COMPLETED:
        return _Ending("misses_goal", "the last pose misses the goal")
    if code == STARTS_INSIDE:
        return _Ending("starts_inside", WOULD_START_INSIDE, move)
    outcome = Outcome(code)
    return _Ending(outcome.name.lower(), f"move {move}: {outcome.message}", move)


def _witness(check: CrossCheck, player: Feedback) -> tuple[WitnessDocument, str]:
    """The run that fails, and how it ends in words."""
    row = check.failure
    if row is None:
        raise ValueError("no run failed, so there is no witness")
    all_ = {field.name: getattr(check.draws, field.name) for field in fields(check.draws)}
    draws = {name: values[row] for name, values in all_.items() if values is not None}

    def pairs(name: str) -> tuple[tuple[str, str], ...]:
        return tuple((float(x).hex(), float(y).hex()) for x, y in draws[name])

    x, y, theta = (float(value).hex() for value in draws["start"])
    ending = _ending(check, row)
    document = WitnessDocument(
        outcome=ending.id,
        move=ending.move,
        start=(x, y, theta),
        friction=float(draws["friction"]).hex(),
        film_ratio_m2=float(draws["film_ratio"]).hex(),
        misalignment_rad=float(draws["misalignment"]).hex(),
        sensing=tuple(
            (float(a).hex(), float(b).hex(), float(c).hex()) for a, b, c in draws["sensing"]
        ),
        dual_probe=pairs("dual"),
        single_probe=pairs("single"),
        more=more_of(player, player.rows_of(check.draws)[row]),
    )
    return document, ending.words


def _made_with(seed: int) -> dict[str, str]:
    return {**made_with(("casadi", "numba", "numpy", "sympy")), "seed": str(seed)}
