"""``certificate.json``: what is claimed, what was proved of it, and how far it reaches.

Numbers that the claim rests on are doubles in hexadecimal (``float.hex``), SI units; those in um
and deg beside them are for reading. What is claimed is stated by stable names and their data; the
sentences under ``reading`` are rendered from them for people, and nothing compares them.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from meso_robust import units
from meso_robust.bounds import Box, Verdict, VerdictWord
from meso_robust.certificates.chain import Chain
from meso_robust.certificates.margin import Limit, Margin
from meso_robust.certificates.premise import Premise, premises
from meso_robust.certificates.words import (
    PREMISES,
    claim_words,
    derivation_words,
    id_of,
    inequality_words,
    words,
)
from meso_robust.planning.document import box_document
from meso_robust.planning.plan_file import BoxDocument, Document, ExactBox, HexPair, RuleDocument
from meso_robust.primitives.names import Inequality, Named, ObligationId, Which
from meso_robust.primitives.obligation import Obligation, Step
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.reading import Count, Distance, Factor, MoveNumber, PaperStep, Seed
from meso_robust.task import Task
from meso_robust.wording import up

STATED = 0.9
"""Share of a proved bound that is stated: a checker that encloses in its own way finds another one."""
STATED_PASSING, STATED_BESIDE = 0.75, 0.5
"""The same of how far an idle tip passes, which is what a whole turn leaves of a few um: a line, or a
rectangle's edge in one of two ways."""
STATED_WITHDRAWN = 0.5
"""The same of how far from touching again both tips of a turn withdraw: it hangs on all poses that a turn can leave."""


class NamedDocument(Document):
    """A stable id and its data."""

    id: str
    """The id; it never changes its meaning."""
    about: dict[str, str]
    """What tells apart names of the same id."""


class ObligationDocument(NamedDocument):
    """One inequality over one box."""

    id: ObligationId
    """What is to hold; `reading.obligations` has it in words."""
    inequality: Inequality
    """The inequality that it was reduced to; `reading.inequalities` has it in symbols."""
    verdict: VerdictWord
    """Verdict on this inequality."""
    lower_bound: str | None
    """Smallest proved value of the left side in its SI unit, hexadecimal; null if not proved."""
    boxes: Count
    """Boxes that branch and bound looked at."""
    over: dict[str, HexPair]
    """PROVED: the box it holds on; else the witness, or the widest undecided box."""


class StepDocument(Document):
    """One certified move."""

    step: PaperStep
    """Step of the paper's algorithm, 1 to 4, that the move belongs to."""
    primitive: str
    """The primitive: y_translation, rotation or x_translation."""
    action: str
    """Which certified motion the move is: tilt, straighten, rotate, regrasp or guide."""
    property: NamedDocument
    """What the move is claimed to do; `reading.properties` has it in words."""
    verdict: VerdictWord
    """Verdict on the move: the worst of those on its inequalities."""
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


class ClaimDocument(Document):
    """What the certificate is about: for all uncertainties and starts every motion ends in the goal."""

    id: str
    """ends_in_goal; of a task with a slot ends_in_goal_clear_of_walls, or ends_in_goal_guided."""
    moves: MoveNumber
    """Number of moves of the plan."""
    premises: tuple[Premise, ...]
    """What the proof takes for granted; `reading.premises` has each in words."""
    uncertainties: dict[str, HexPair]
    """What the claim holds for all of: each uncertainty with its ends, m, rad or m^2, rounded outward."""
    inequalities: dict[Inequality, str | None]
    """All inequalities of all moves, each with its derivation; null: interval arithmetic."""


class UndecidedDocument(Document):
    """Why the verdict is UNKNOWN."""

    move: MoveNumber
    """Which move of the plan, from 1."""
    step: PaperStep
    """Step of the paper's algorithm, 1 to 4, that it belongs to."""
    action: str
    """Which motion the move is: tilt, straighten, rotate, regrasp or guide."""
    reason: NamedDocument
    """What is not proved: an obligation, or ends_in_goal, premise_kept, effect_bounded, within_bounds."""
    inequality: Inequality | None
    """The same as an inequality, if it is one."""
    fails: bool
    """True: it is proved to fail at the point ``over``; false: it is undecided on that box."""
    over: dict[str, HexPair]
    """The point or box by variable, [low, high], SI, hexadecimal."""
    settled_by: NamedDocument
    """What would settle it."""


class LimitDocument(NamedDocument):
    """What is not proved at a larger factor, and of which move."""

    step: PaperStep
    """Step of the paper's algorithm, 1 to 4, that the move belongs to."""
    action: str
    """Which motion the move is."""


class UndecidedReading(Document):
    """Why the verdict is UNKNOWN, in words."""

    claim: str
    """What is not proved."""
    inequality: str
    """The same as an inequality, or how a premise is broken."""
    settled_by: str
    """What would settle it."""


class ReadingDocument(Document):
    """The certificate in words, for people: rendered from the ids, and never compared."""

    claim: str
    """What is claimed."""
    premises: dict[str, str]
    """Each premise by its id."""
    properties: dict[str, str]
    """What moves are claimed to do, by id and data."""
    obligations: dict[str, str]
    """What is to hold, by id and data."""
    inequalities: dict[str, str]
    """Each inequality in the field's symbols, with its derivation."""
    undecided: UndecidedReading | None
    """What is open; null if PROVED."""
    limit: str | None
    """`margin.limit` in words."""
    outcome: str | None
    """How the run of the witness ends."""


class WitnessDocument(Document):
    """A run that breaks the claim, as the simulator replays it; SI units, hexadecimal."""

    outcome: str
    """How the run ends: jam, starts_inside, misses_goal or another outcome of the simulator."""
    move: MoveNumber | None = None
    """The move that was not completed, from 1; null if all were."""
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
    more: dict[str, str] = Field(default_factory=dict)
    """What else the task leaves open (the tips' radii and friction, the part's edges, drag, travel), by the names of
    `witness.json`; SI units, hexadecimal."""


class MarginDocument(Document):
    """How much more uncertainty the plan would tolerate; see ``meso_robust.certificates.margin``."""

    factor: Factor
    """Largest factor of all uncertainties at once that was certified; 0 if the plan is not
    proved."""
    refused_at: Factor | None
    """Smallest factor tried that was not certified; null if the largest tried was certified."""
    binds_first: str | None
    """Uncertainty with the smallest factor when scaled alone."""
    each_alone: dict[str, Factor]
    """Largest certified factor of each uncertainty, scaled alone."""
    limit: LimitDocument | None
    """What fails first at `refused_at`."""


class SimulationDocument(Document):
    """The cross-check by the simulator: evidence in addition to the proof, not part of it."""

    samples: Count
    """Random runs."""
    seed: Seed
    """Seed of all draws."""
    step_um: Annotated[float, Field(gt=0, le=1e6)]
    """Longest travel of a probe in a step of the simulator, um."""
    completed: Count
    """Runs that carried out all moves."""
    in_goal: Count
    """Runs that ended in the goal."""
    in_certified_box: Count | None
    """Runs that stayed in every certified box; null if a move has none."""
    largest_excess_um_um_deg: tuple[tuple[Distance, Distance, Distance], ...]
    """Largest distance outside the certified box after each move."""
    simulator_error_um_um_deg: tuple[Distance, Distance, Distance]
    """Largest change of a pose when the simulation step is halved."""


class CertificateDocument(Document):
    """A certificate."""

    schema_: Annotated[Literal["meso-robust/certificate/2"], Field(alias="schema")] = (
        "meso-robust/certificate/2"
    )
    """Name and version of the format."""
    verdict: VerdictWord
    """Verdict on the whole claim."""
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
    """How much more uncertainty the plan would tolerate."""
    simulation: SimulationDocument
    """The cross-check by the simulator."""
    made_with: dict[str, str]
    """Versions of what the certificate was made with."""
    reading: ReadingDocument
    """All of it in words."""
    digest: str = ""
    """SHA-256 of everything else; see :func:`sealed`."""


def sealed(document: CertificateDocument) -> CertificateDocument:
    """Seal a certificate, so that an accident to any value is found out.

    Parameters
    ----------
    document
        The certificate.

    Returns
    -------
    CertificateDocument
        With its digest: SHA-256 of the JSON without ``digest``, keys sorted, no white space, ASCII.
    """
    values = json.loads(document.model_dump_json(by_alias=True))
    del values["digest"]
    text = json.dumps(values, sort_keys=True, separators=(",", ":"))
    return document.model_copy(update={"digest": hashlib.sha256(text.encode()).hexdigest()})


def step_document(step: Step) -> StepDocument:
    """Write out one certified move.

    Parameters
    ----------
    step
        The move, and what was proved of it.

    Returns
    -------
    StepDocument
        Boxes exactly and for reading, and its obligations by their stable names.
    """
    return StepDocument(
        step=step.rule.step,
        primitive=step.rule.primitive,
        action=step.rule.action,
        property=named(step.claim),
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
    share = _stated(obligation)
    return ObligationDocument(
        id=ObligationId(obligation.name.id),
        about=dict(obligation.name.about),
        inequality=obligation.inequality,
        verdict=proof.verdict.word,
        lower_bound=(share * proof.lower).hex() if finite else None,
        boxes=proof.boxes,
        over=_hex_box(proof.box),
    )


def _stated(obligation: Obligation) -> float:
    """Share of a proved bound that is stated."""
    name = obligation.name
    if name.id == ObligationId.IDLE_TIP_PASSES:
        return STATED_BESIDE if obligation.inequality is Inequality.BESIDE else STATED_PASSING
    turned = name.id == ObligationId.WITHDRAWS_FREE and name.about.get("tips") == Which.BOTH
    return STATED_WITHDRAWN if turned else STATED


def _hex_box(box: Box) -> dict[str, HexPair]:
    return {name: (float(side.lo).hex(), float(side.hi).hex()) for name, side in box.items()}


def exact_box(box: PoseBox) -> ExactBox:
    """Write out a box of poses.

    Parameters
    ----------
    box
        World frame.

    Returns
    -------
    ExactBox
        Its ends as hexadecimal doubles, m and rad: to the last bit.
    """
    ends = _hex_box({"x": box.x, "y": box.y, "theta": box.theta})
    return ExactBox(x_m=ends["x"], y_m=ends["y"], theta_rad=ends["theta"])


def named(name: Named) -> NamedDocument:
    """Write out a stable name.

    Parameters
    ----------
    name
        An id and its data.

    Returns
    -------
    NamedDocument
        Both as text.
    """
    return NamedDocument(id=name.id, about=dict(name.about))


def name_of(document: NamedDocument) -> Named:
    """Read a stable name back.

    Parameters
    ----------
    document
        As `named` has written it.

    Returns
    -------
    Named
        The id and its data.

    Raises
    ------
    KeyError
        There is no id of that spelling.
    """
    return Named(id_of(document.id), document.about)


def claim_document(task: Task, chain: Chain, moves: int) -> ClaimDocument:
    """What is claimed, what it rests on, and the inequalities that it was reduced to.

    Parameters
    ----------
    task, chain
        The task, and the certified steps.
    moves
        Of the whole plan, which may be more than the chain reached.

    Returns
    -------
    ClaimDocument
        By stable names, the ranges of everything uncertain exactly.
    """
    u = setup_of(task).uncertainty
    walls = "ends_in_goal_guided" if chain.guided else "ends_in_goal_clear_of_walls"
    return ClaimDocument(
        id="ends_in_goal" if task.slot is None else walls,
        moves=moves,
        premises=premises(task),
        uncertainties=_hex_box(u.stated),
        inequalities={one.inequality: one.inequality.derivation for one in _obligations(chain)},
    )


def _obligations(chain: Chain) -> Iterator[Obligation]:
    return (obligation for step in chain.steps for obligation in step.obligations)


def reading_document(
    task: Task,
    chain: Chain,
    moves: int,
    *,
    undecided: UndecidedReading | None = None,
    limit: Limit | None = None,
    outcome: str | None = None,
) -> ReadingDocument:
    """A certificate in words, beside what is compared.

    Parameters
    ----------
    task, chain, moves
        As for `claim_document`.
    undecided
        What is open, in words.
    limit
        What fails first at a larger factor.
    outcome
        How the witness of a REFUTED plan fails.

    Returns
    -------
    ReadingDocument
        A sentence for every stable name that the certificate uses.
    """
    listed = tuple(_obligations(chain))
    return ReadingDocument(
        claim=claim_words(task, moves, guided=chain.guided),
        premises={one.value: PREMISES[one] for one in premises(task)},
        properties={step.claim.key: words(step.claim) for step in chain.steps},
        obligations={one.name.key: words(one.name) for one in listed},
        inequalities={
            one.inequality.value: f"{inequality_words(one.inequality)} "
            f"[{derivation_words(one.inequality.derivation)}]"
            for one in listed
        },
        undecided=undecided,
        limit=None if limit is None else limit_words(limit),
        outcome=outcome,
    )


def limit_words(limit: Limit) -> str:
    """What fails first at a larger factor."""
    return f"{words(limit.name)} (step {limit.step}, {limit.action})"


@dataclass(frozen=True, slots=True)
class Undecided:
    """What is open: as it is compared, and in words."""

    document: UndecidedDocument
    reading: UndecidedReading


def undecided_document(chain: Chain, settled_by: Named) -> Undecided | None:
    """What is not proved first.

    Parameters
    ----------
    chain
        The certified steps.
    settled_by
        What a user can do about it.

    Returns
    -------
    Undecided or None
        As it is compared, and in words; None if the chain is PROVED.
    """
    if chain.verdict is Verdict.PROVED:
        return None
    step, name, found = chain.first_open
    over = found.proof.box if found is not None else _sides(step.post)
    document = UndecidedDocument(
        move=1 + next(k for k, one in enumerate(chain.steps) if one is step),
        step=step.rule.step,
        action=step.rule.action,
        reason=named(name),
        inequality=None if found is None else found.inequality,
        fails=found is not None and found.proof.verdict is Verdict.REFUTED,
        over=_hex_box(over),
        settled_by=named(settled_by),
    )
    inequality = "final box within goal" if found is None else inequality_words(found.inequality)
    return Undecided(
        document,
        UndecidedReading(claim=words(name), inequality=inequality, settled_by=words(settled_by)),
    )


def _sides(box: PoseBox | None) -> Box:
    return {} if box is None else {"x": box.x, "y": box.y, "theta": box.theta}


def margin_document(margin: Margin) -> MarginDocument:
    """Write out a margin.

    Parameters
    ----------
    margin
        What `meso_robust.certificates.margin.margin` found.

    Returns
    -------
    MarginDocument
        The same values.
    """
    return MarginDocument(
        factor=margin.factor,
        refused_at=margin.refused,
        binds_first=margin.binding,
        each_alone=margin.each,
        limit=None
        if margin.limit is None
        else LimitDocument(
            **named(margin.limit.name).model_dump(),
            step=margin.limit.step,
            action=margin.limit.action,
        ),
    )


def in_um_deg(values: tuple[float, float, float]) -> tuple[float, float, float]:
    """Distances for reading.

    Parameters
    ----------
    values
        (m, m, rad), not negative.

    Returns
    -------
    tuple
        (um, um, deg), six digits, rounded up: a distance is never told smaller than it is.
    """
    x, y, theta = values
    shown = (units.to_um(x), units.to_um(y), units.to_deg(theta))
    x, y, theta = (float(up(value, 6)) for value in shown)
    return x, y, theta
