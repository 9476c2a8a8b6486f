"""``certificate.json``: what is claimed, what was proved of it, and how far it reaches.

Numbers that the claim rests on are doubles in hexadecimal (``float.hex``), SI units; those in um
and deg beside them are for reading.
"""

from __future__ import annotations

import hashlib
import json
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from meso_robust import units
from meso_robust.bounds import Box, Verdict, VerdictWord
from meso_robust.certificates.chain import Chain
from meso_robust.certificates.margin import Margin
from meso_robust.planning.document import BoxDocument, RuleDocument, box_document
from meso_robust.primitives.obligation import Obligation, Step
from meso_robust.primitives.setup import PoseBox
from meso_robust.reading import Count, Distance, Factor, MoveNumber, PaperStep, Seed
from meso_robust.task import Part, Task
from meso_robust.telling import up

HexPair = tuple[str, str]

ASSUMPTIONS = (
    "quasi-static motion: inertia is neglected",
    "the film's drag is diag(e_x, e_x, e_theta) about the part's centre; only rho = e_theta/e_x enters",
    "Coulomb friction at point contacts; at every instant mu is the same at all tips",
    "the part is the stated rectangle, rigid and exactly known; nothing but the probes touches it",
    "each error keeps within its bound; a probe's position error is constant during a move (and may "
    "differ in the next), and the two tips of the active probe share it",
    "the active probe travels exactly along an axis of the task's frame, as each move states; tips are "
    "points",
    "the part rests between moves, and probes are lifted without disturbing it",
)

TIPS = "point tips"
"""What every verdict is about, whatever the tips of the laboratory."""


def assumptions(task: Task) -> tuple[str, ...]:
    """What a certificate of a task assumes."""
    if isinstance(task.part, Part):
        return ASSUMPTIONS
    polygon = "stated polygon, its reference point the centre of drag"
    return tuple(one.replace("stated rectangle", polygon) for one in ASSUMPTIONS)


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class ObligationDocument(_Model):
    """One inequality over one box."""

    claim: str
    """What is to hold, in words."""
    inequality: str
    """The same as an inequality in the field's symbols."""
    derivation: str
    """File in which it is derived, or what it follows from."""
    verdict: VerdictWord
    """Of this inequality."""
    lower_bound: str | None
    """Smallest proved value of the left side in its SI unit, hexadecimal; null if not proved."""
    boxes: Count
    """Boxes that branch and bound looked at."""
    over: dict[str, HexPair]
    """PROVED: the box it holds on; else the witness, or the widest undecided box."""


class ExactBox(_Model):
    """A box of poses, exactly."""

    x_m: HexPair
    """[low, high] of the reference point's x, m."""
    y_m: HexPair
    """[low, high] of the reference point's y, m."""
    theta_rad: HexPair
    """[low, high] of the orientation, rad."""


class StepDocument(_Model):
    """One certified move."""

    step: PaperStep
    """Step of the paper's algorithm, 1 to 4, that the move belongs to."""
    primitive: str
    """The primitive: y_translation, rotation or x_translation."""
    action: str
    """Which certified motion the move is: tilt, straighten, rotate or regrasp."""
    property: str
    """What the move is claimed to do, in words."""
    verdict: VerdictWord
    """Of the move: the worst of its inequalities."""
    pre: BoxDocument
    """True poses before the move, for reading, rounded outward."""
    pre_exact: ExactBox
    """True poses before the move, exactly."""
    post: BoxDocument | None
    """True poses after the move, rounded outward; null if not proved."""
    post_exact: ExactBox | None
    """The same box, exactly; null if not proved."""
    obligations: tuple[ObligationDocument, ...]
    """The inequalities that the move was reduced to."""


class ClaimDocument(_Model):
    """What the certificate is about."""

    words: str
    """The claim in words."""
    assumptions: tuple[str, ...]
    """What the proof assumes, a sentence each."""
    inequalities: tuple[str, ...]
    """All inequalities of all moves, each once, with its derivation."""


class UndecidedDocument(_Model):
    """Why the verdict is UNKNOWN."""

    move: MoveNumber
    """Which move of the plan, from 1."""
    step: PaperStep
    """Step of the paper's algorithm, 1 to 4, that it belongs to."""
    action: str
    """Which motion the move is: tilt, straighten, rotate or regrasp."""
    claim: str
    """What is not proved, in words."""
    inequality: str
    """The same as an inequality."""
    fails: bool
    """True: it is proved to fail at the point ``over``; false: it is undecided on that box."""
    over: dict[str, HexPair]
    """The point or box by variable, [low, high], SI, hexadecimal."""
    settled_by: str
    """What would settle it, in words."""


class WitnessDocument(_Model):
    """A run that breaks the claim, as the simulator replays it; SI units, hexadecimal."""

    outcome: str
    """How the run ends."""
    start: tuple[str, str, str]
    """True pose at the start: x and y, m; theta, rad."""
    friction: str
    """Friction coefficient between tips and part."""
    film_ratio_m2: str
    """rho = e_theta / e_x of the film, m^2."""
    misalignment_rad: str
    """Angle of the line through the two active tips, rad; its sign is that of the task's
    `tip_misalignment_deg`."""
    sensing: tuple[tuple[str, str, str], ...]
    """Sensing error before each move: x and y, m; theta, rad."""
    dual_probe: tuple[HexPair, ...]
    """Position error of the dual-tip probe in each move, [x, y], m."""
    single_probe: tuple[HexPair, ...]
    """Position error of the single tip in each move, [x, y], m."""


class MarginDocument(_Model):
    """How much more uncertainty the plan could bear; see ``meso_robust.certificates.margin``."""

    factor: Factor
    """Largest factor of all uncertainties at once that was certified; 0 if the plan is not
    proved."""
    refused_at: Factor | None
    """Smallest factor tried that was not certified; null if the largest tried was certified."""
    binds_first: str | None
    """Uncertainty that bears the least when it is scaled alone."""
    each_alone: dict[str, Factor]
    """Largest certified factor of each uncertainty, scaled alone."""
    limit: str | None
    """First inequality that fails at `refused_at`."""


class SimulationDocument(_Model):
    """The cross-check by the simulator: evidence beside the proof, not part of it."""

    samples: Count
    """Random runs."""
    seed: Seed
    """From which all draws follow."""
    step_um: Annotated[float, Field(gt=0, le=1e6)]
    """Longest travel of a probe in a step of the simulator, um."""
    completed: Count
    """Runs that carried out all moves."""
    in_goal: Count
    """Runs that ended in the goal."""
    in_certified_box: Count | None
    """Runs that kept to every certified box; null if a move has none."""
    largest_excess_um_um_deg: tuple[tuple[Distance, Distance, Distance], ...]
    """Largest distance outside the certified box after each move."""
    simulator_error_um_um_deg: tuple[Distance, Distance, Distance]
    """Largest change of a pose when the simulation step is halved."""


class CertificateDocument(_Model):
    """A certificate."""

    schema_: Annotated[Literal["meso-robust/certificate/1"], Field(alias="schema")] = (
        "meso-robust/certificate/1"
    )
    """Name and version of the format."""
    verdict: VerdictWord
    """Of the whole claim."""
    task: str
    """Name of the task."""
    task_hash: str
    """SHA-256 of the task's values, independent of the layout of its file."""
    claim: ClaimDocument
    """What is claimed, and what it rests on."""
    goal: BoxDocument
    """The goal, for reading."""
    goal_exact: ExactBox
    """The goal, exactly."""
    policy: tuple[RuleDocument, ...]
    """The plan: its moves as functions of the sensed pose."""
    steps: tuple[StepDocument, ...]
    """What was proved of each move."""
    undecided: UndecidedDocument | None
    """The first open inequality; null if PROVED."""
    witness: WitnessDocument | None
    """A run that fails; null unless one was found."""
    margin: MarginDocument
    """How much more uncertainty the plan would bear."""
    simulation: SimulationDocument
    """The cross-check by the simulator."""
    made_with: dict[str, str]
    """Versions of what the certificate was made with."""
    digest: str = ""
    """SHA-256 of everything else; see :func:`sealed`."""


def sealed(document: CertificateDocument) -> CertificateDocument:
    """The document with its digest: an accident to any value is found out.

    The digest is that of the JSON without ``digest``, keys sorted, no white space, ASCII.
    """
    values = json.loads(document.model_dump_json(by_alias=True))
    del values["digest"]
    text = json.dumps(values, sort_keys=True, separators=(",", ":"))
    return document.model_copy(update={"digest": hashlib.sha256(text.encode()).hexdigest()})


def step_document(step: Step) -> StepDocument:
    """Write out one certified move."""
    return StepDocument(
        step=step.rule.step,
        primitive=step.rule.primitive,
        action=step.rule.action,
        property=step.claim,
        verdict=step.verdict.word,
        pre=box_document(step.pre),
        pre_exact=exact_box(step.pre),
        post=None if step.post is None else box_document(step.post),
        post_exact=None if step.post is None else exact_box(step.post),
        obligations=tuple(_obligation(obligation) for obligation in step.obligations),
    )


def _obligation(obligation: Obligation) -> ObligationDocument:
    proof = obligation.proof
    finite = proof.verdict is Verdict.PROVED and proof.lower < float("inf")
    return ObligationDocument(
        claim=obligation.claim,
        inequality=obligation.inequality,
        derivation=obligation.derivation,
        verdict=proof.verdict.word,
        lower_bound=proof.lower.hex() if finite else None,
        boxes=proof.boxes,
        over=_hex_box(proof.box),
    )


def _hex_box(box: Box) -> dict[str, HexPair]:
    return {name: (float(side.lo).hex(), float(side.hi).hex()) for name, side in box.items()}


def exact_box(box: PoseBox) -> ExactBox:
    """The ends of a box as hexadecimal doubles."""
    ends = _hex_box({"x": box.x, "y": box.y, "theta": box.theta})
    return ExactBox(x_m=ends["x"], y_m=ends["y"], theta_rad=ends["theta"])


def claim_document(task: Task, chain: Chain, moves: int) -> ClaimDocument:
    """The claim in words and as the inequalities that it was reduced to."""
    goal, u = task.goal, task.uncertainty
    walls = "" if task.slot is None else " and neither the part nor a tip touches the slot's walls"
    words = (
        f"From every start within {u.sensed_position_um} um and {u.sensed_orientation_deg} deg of "
        f"({task.start.x_um} um, {task.start.y_um} um, {task.start.theta_deg} deg), whatever the "
        f"sensing errors (same bounds, before each move), the probe errors (within "
        f"{u.probe_position_um} um), mu in {list(u.friction)}, film ratio within "
        f"{u.film_ratio_percent} % of {u.film_ratio_um2} um^2 and tip misalignment in "
        f"{list(u.tip_misalignment_deg)} deg, the plan's policy of {moves} moves can be "
        f"carried out, and every motion of the quasi-static model ends with the part within "
        f"{goal.position_tolerance_um} um and {goal.orientation_tolerance_deg} deg of "
        f"({goal.x_um} um, {goal.y_um} um, {goal.theta_deg} deg){walls}."
    )
    inequalities = {
        f"{obligation.inequality} [{obligation.derivation}]": None
        for step in chain.steps
        for obligation in step.obligations
    }
    return ClaimDocument(
        words=words, assumptions=assumptions(task), inequalities=tuple(inequalities)
    )


def undecided_document(chain: Chain, settled_by: str) -> UndecidedDocument | None:
    """The first inequality that is not proved; None if the chain is PROVED."""
    if chain.verdict is Verdict.PROVED:
        return None
    found = chain.open_obligation
    if found is None:
        last = chain.steps[-1]
        return UndecidedDocument(
            move=len(chain.steps),
            step=last.rule.step,
            action=last.rule.action,
            claim="every final pose lies in the goal",
            inequality="final box within goal",
            fails=False,
            over=_hex_box({} if last.post is None else _sides(last.post)),
            settled_by=settled_by,
        )
    step, obligation = found
    return UndecidedDocument(
        move=1 + next(k for k, one in enumerate(chain.steps) if one is step),
        step=step.rule.step,
        action=step.rule.action,
        claim=obligation.claim,
        inequality=obligation.inequality,
        fails=obligation.proof.verdict is Verdict.REFUTED,
        over=_hex_box(obligation.proof.box),
        settled_by=settled_by,
    )


def _sides(box: PoseBox) -> Box:
    return {"x": box.x, "y": box.y, "theta": box.theta}


def margin_document(margin: Margin) -> MarginDocument:
    """Write out a margin."""
    return MarginDocument(
        factor=margin.factor,
        refused_at=margin.refused,
        binds_first=margin.binding,
        each_alone=margin.each,
        limit=margin.limit,
    )


def in_um_deg(values: tuple[float, float, float]) -> tuple[float, float, float]:
    """(m, m, rad) to (um, um, deg), six digits, rounded up."""
    x, y, theta = values
    shown = (units.to_um(x), units.to_um(y), units.to_deg(theta))
    x, y, theta = (float(up(value, 6)) for value in shown)
    return x, y, theta
