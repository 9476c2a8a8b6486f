"""The promise made again: a plan for the task as the fitted model says it is.

PROVED takes three things: every parameter and effect of the model is absorbed over the whole of its
interval; the plan is certified for the changed task, and for every size of the part; and the bounds
were computed for places, times and speeds that the plan keeps within. Otherwise the verdict is UNKNOWN and
names the premise.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from meso_robust import units
from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import Chain, certify
from meso_robust.certificates.document import (
    LimitDocument,
    MarginDocument,
    Undecided,
    UndecidedDocument,
    UndecidedReading,
    claim_document,
    named,
    reading_document,
    sealed,
    step_document,
    undecided_document,
)
from meso_robust.certificates.premise import Premise
from meso_robust.certificates.words import words
from meso_robust.errors import InputError, NotApplicableError
from meso_robust.identification.document import ModelDocument, read_model
from meso_robust.identification.models import MODELS
from meso_robust.laboratory.crosscheck import CLEAR, ROUNDING
from meso_robust.pipeline import Planned, SimulatorContradictsProofError, judge
from meso_robust.planning.compose import Found, compose
from meso_robust.planning.remedy import Remedy
from meso_robust.primitives.names import Named, Reason, about
from meso_robust.primitives.setup import setup_of
from meso_robust.stages import Doing
from meso_robust.task import POINT_TIPS, Part, PolygonPart, Task
from meso_robust.transfer.assumption_check import (
    BREAKS,
    FRICTION,
    RATIO,
    Standing,
    in_place,
    lent,
    remedy,
    standings,
)
from meso_robust.transfer.changing import Changed, by_speed, changed, check_part
from meso_robust.transfer.envelope import enough, needed, ratio_ends, reach_um, roomier
from meso_robust.transfer.inflation import Budget
from meso_robust.transfer.lines import LINES
from meso_robust.transfer.running import Evidence, evidence

MOST_RUNS = 200
"""Runs under the model's own physics; some of them are slow."""
_ROUNDS = 4  # of budgets that are tried
_FASTER = 1, 4, 16  # times the task's speed
_FAR_OFF = 0.06  # of the part's length


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Promise:
    """Result of re-certification with a fitted model."""

    planned: Planned
    """Of the changed task; its certificate has the verdict of the promise."""
    before: Task
    document: ModelDocument
    changed: Changed
    standings: tuple[Standing, ...]
    wide: Chain | None
    """The plan certified for every size of the part and clear of posts; None if nothing is wider."""
    evidence: Evidence | None
    no_evidence: str

    @property
    def broken(self) -> tuple[Standing, ...]:
        """What the promise does not survive."""
        return tuple(one for one in self.standings if not one.survives)

    @property
    def conditions(self) -> tuple[str, ...]:
        """What the laboratory must also observe, besides the certificate's premises."""
        found = [one.absorbed.condition for one in self.standings if one.absorbed is not None]
        task = self.changed.task
        silent = task.schema_ == POINT_TIPS and self.document.probe is None
        points = ["the tips are points: the model states no radius"] if silent else []
        return (*points, *(one for one in found if one))


@dataclass(frozen=True, slots=True, kw_only=True)
class Recertified:
    """A plan for the task as changed for a budget."""

    document: ModelDocument
    """The model, with what the task lends it."""
    changed: Changed
    standings: tuple[Standing, ...]
    plan: Found
    wide: Chain
    kept: bool
    """Whether the plan keeps the budget that the bounds were computed for."""

    @property
    def proved(self) -> bool:
        """Whether everything that the model says is kept and the plan certified."""
        survives = all(one.survives for one in self.standings)
        return survives and self.kept and self.wide.verdict is Verdict.PROVED


def read(path: Path, task: Task) -> ModelDocument:
    """Read a model that the promise can be made from.

    Parameters
    ----------
    path
        Of a ``model.toml``.
    task
        The task that it is for.

    Returns
    -------
    ModelDocument
        Checked against the task's part.

    Raises
    ------
    InputError
        The file is not a model, names a model that is not known, or is about another part.
    """
    document = read_model(path)
    base = document.model.partition("+")[0]
    if base not in MODELS:
        raise InputError(
            f"{path}: key model = {document.model!r}: must be, or begin with, one of "
            f"{', '.join(MODELS)}; fit one of these with `meso-robust identify`"
        )
    check_part(task, document, str(path))
    return document


def model_hash(document: ModelDocument) -> str:
    """SHA-256 of a model's values, independent of layout and comments."""
    values = document.model_dump(mode="json", by_alias=True, exclude_none=True)
    return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()


def promise(task: Task, document: ModelDocument, samples: int, seed: int, doing: Doing) -> Promise:
    """Plan for a task as a fitted model says it is, and judge the plan.

    Parameters
    ----------
    task
        As the user stated it.
    document
        The model, of the task's part; see `read`.
    samples, seed, doing
        As for `pipeline.make`.

    Returns
    -------
    Promise
        PROVED only if every premise survives, the plan is certified for every size of the part, and it
        keeps the budget of the bounds.

    Raises
    ------
    InputError
        The changed task breaks a rule of tasks.
    NotApplicableError
        No primitive can handle the changed task.
    SimulatorContradictsProofError
        The simulator and the proof disagree.
    """
    with doing("searching for a plan with the model's parameters"):
        found = recertified(task, document)
    planned = judge(found.changed.task, found.plan, samples, seed, doing)
    ran, why = None, "the model has no effects: the runs of the certificate are of its physics"
    if "+" in document.model or any(not one.survives for one in found.standings):
        with doing("simulating under the model's own physics"):
            ran, why = _ran(found, task, min(samples, MOST_RUNS), seed, planned)
    made = Promise(
        planned=_judged(planned, found, document, task),
        before=task,
        document=document,
        changed=found.changed,
        standings=found.standings,
        wide=found.wide if found.changed.wider else None,
        evidence=ran,
        no_evidence=why,
    )
    if made.planned.certificate.verdict == "PROVED" and ran is not None and ran.broken:
        raise SimulatorContradictsProofError(
            f"runs of seed {seed} under the model's own physics break a PROVED claim: "
            f"{ran.in_goal} of {ran.runs} in the goal, worst {ran.worst_um} um outside"
        )
    return made


def recertified(task: Task, document: ModelDocument) -> Recertified:
    """A plan, and bounds of effects for as far out and as long as it goes.

    A first plan with small bounds tells how far that is; each further one gets bounds for the one
    before, until a plan keeps within what its own bounds were computed for. Where some effect counts the
    less the faster the probes are, and nothing is proved, they are made faster; where that does not do,
    either, the effect breaks its premise.

    Parameters
    ----------
    task, document
        As for `promise`.

    Returns
    -------
    Recertified
        Neither simulated nor with a margin.

    Raises
    ------
    InputError
        The changed task breaks a rule of tasks.
    NotApplicableError
        No primitive can handle the changed task.
    """
    document, friction = lent(document, task)
    stated = _first_budget(task, document, 1.0)
    known = standings(document, stated)
    if not any(map(by_speed, known)):
        return _within(task, document, friction, stated)
    if all(one.survives for one in known):
        for faster in _FASTER:
            budget = _first_budget(task, document, faster)
            if _hopeless(task, document, budget):
                continue
            with suppress(InputError, NotApplicableError):  # too wide to be stated, or not planned
                found = _within(task, document, friction, budget)
                if found.proved:
                    return found
    return _within(task, document, friction, stated, refused=True)


def _hopeless(task: Task, document: ModelDocument, budget: Budget) -> bool:
    """Whether the centre of drag may be so far off that no plan is looked for: effort only."""
    absorbed = [one.absorbed for one in standings(document, budget) if one.absorbed is not None]
    length_um = 2.0 * units.to_um(setup_of(task).outline.reach)
    return max(one.drag_centre_um for one in absorbed) > _FAR_OFF * length_um


def _first_budget(task: Task, document: ModelDocument, faster: float) -> Budget:
    """What a first plan is made for, with probes so many times as fast as stated."""
    start, goal = task.start, task.goal
    low, high = _ratios(task, document)
    return Budget(
        radius_um=max((one.x_um**2 + one.y_um**2) ** 0.5 for one in (start, goal)),
        seconds=0.0,
        ratio_um2=high,
        least_ratio_um2=low,
        slender=_slender(task, document),
        rectangle=_rectangle(task, document),
        reach_um=reach_um(task),
        speed_um_s=faster * task.probe.speed_um_s,
        press=1.0,
        turn_per_um=math.inf,
        capped=task.probe.max_force_un is not None,
    )


def _within(
    task: Task, document: ModelDocument, friction: str, budget: Budget, *, refused: bool = False
) -> Recertified:
    """A plan within a budget that begins so; ``refused``: without what hangs on the speed."""
    for _ in range(_ROUNDS):
        found = tuple(
            replace(one, said=friction) if friction and one.name == FRICTION else one
            for one in standings(document, budget)
        )
        if refused:
            found = tuple(_too_slow(one) if by_speed(one) else one for one in found)
        after = changed(task, document, found, budget.speed_um_s)
        plan, wide = _plan(after)
        need = needed(wide, after.task, budget.slender)
        kept = not _bounded(found) or enough(budget, need)
        if kept or wide.verdict is not Verdict.PROVED:
            break
        budget = replace(roomier(need), rectangle=budget.rectangle)
    held = any(rule.single is not None for rule in plan.rules)
    return Recertified(
        document=document,
        changed=after,
        standings=tuple(in_place(one, after.task, held=held) for one in found),
        plan=plan,
        wide=wide,
        kept=kept,
    )


def _too_slow(known: Standing) -> Standing:
    """An effect with which nothing is proved at any speed that was tried."""
    said = (
        f"{LINES[known.name].why}; not proved with probes up to {_FASTER[-1]} times as fast, either"
    )
    return replace(known, word=BREAKS, absorbed=None, said=said)


def _ratios(task: Task, document: ModelDocument) -> tuple[float, float]:
    """Smallest and largest one of the drags of an even film, by the model and by the task, um^2."""
    fitted, (low, high) = document.parameters.get(RATIO), ratio_ends(task)
    return (low, high) if fitted is None else (min(low, fitted.low), max(high, fitted.high))


def _slender(task: Task, document: ModelDocument) -> float:
    """Length over width; 0 of a polygon, or if the task or more than one effect keeps its film from being even."""
    u, part = task.uncertainty, task.part
    stated = bool(u.drag_centre_um or u.drag_anisotropy_percent)
    if stated or _uneven(document) > 1 or isinstance(part, PolygonPart):
        return 0.0
    return part.length_um / part.width_um


def _rectangle(task: Task, document: ModelDocument) -> bool:
    """Whether the part is a rectangle, and still one where a bound of its film is for that."""
    skewed = "part_skew" in document.model.split("+")
    return isinstance(task.part, Part) and not (skewed and _uneven(document))


def _uneven(document: ModelDocument) -> int:
    """How many effects of a model keep the film from being even."""
    _, *effects = document.model.split("+")
    return sum(LINES[one].premise is Premise.FILM_DRAG for one in effects if one in LINES)


def _bounded(found: Sequence[Standing]) -> bool:
    """Whether some bound rests on the budget."""
    return any(one.absorbed is not None and one.absorbed.bounded_by for one in found)


def _plan(after: Changed) -> tuple[Found, Chain]:
    """A plan for the changed task, and its certification with posts."""
    try:
        first = compose(after.task)
    except NotApplicableError as error:
        said = ", ".join(f"{one.key} = {one.after}" for one in after.changes)
        raise NotApplicableError(f"{error} (with the model's {said or 'ranges'})") from error
    return first, certify(first.rules, after.setup())


def _ran(
    found: Recertified, task: Task, runs: int, seed: int, planned: Planned
) -> tuple[Evidence | None, str]:
    x, y, theta = (CLEAR * error + ROUNDING for error in planned.check.error)
    try:
        stated = as_fast(task, found.changed.task)
        return evidence(found.plan.rules, stated, found.document, runs, seed, (x, y, theta)), ""
    except ValueError as error:  # the simulator refuses, say, a tip of a negative radius
        return None, f"the simulator cannot run this model: {error}"


def as_fast(task: Task, planned: Task) -> Task:
    """A task as the user stated it, but with probes as fast as they are planned to be."""
    speed = {"speed_um_s": planned.probe.speed_um_s}
    return task.model_copy(update={"probe": task.probe.model_copy(update=speed)})


def _judged(planned: Planned, found: Recertified, document: ModelDocument, task: Task) -> Planned:
    """The plan with the certificate of the promise."""
    plain = planned.certificate
    made_with = {
        **plain.made_with,
        "model": model_hash(document),
        "task before the model": task.hash,
    }
    update: dict[str, object] = {"made_with": made_with}
    chain = planned.chain
    broken = next((one for one in found.standings if not one.survives), None)
    if broken is not None:
        update |= _unknown(planned, chain, _premise(planned, broken))
    elif plain.verdict == "PROVED" and found.wide.verdict is not Verdict.PROVED:
        chain = found.wide
        found_open = undecided_document(chain, about(Remedy.CLEAR_STAGE))
        update |= _unknown(planned, chain, found_open) | _steps(planned, chain)
    elif plain.verdict == "PROVED" and not found.kept:
        update |= _unknown(planned, chain, _budget(planned))
    elif plain.verdict == "REFUTED" and "+" in document.model:
        # the failing run has errors that the effects may well not make
        reading = plain.reading.model_copy(update={"outcome": None})
        update |= {"verdict": "UNKNOWN", "witness": None, "reading": reading}
    return replace(planned, chain=chain, certificate=sealed(plain.model_copy(update=update)))


def _unknown(planned: Planned, chain: Chain, undecided: Undecided | None) -> dict[str, object]:
    """A certificate that claims nothing, and says why."""
    each = dict.fromkeys(planned.margin.each, 0.0)
    limit = None
    if undecided is not None:
        open_ = undecided.document
        limit = LimitDocument(**open_.reason.model_dump(), step=open_.step, action=open_.action)
    nothing = MarginDocument(
        factor=0.0, refused_at=1.0, binds_first=None, each_alone=each, limit=limit
    )
    reading = reading_document(
        planned.task,
        chain,
        len(planned.found.rules),
        undecided=None if undecided is None else undecided.reading,
    )
    if undecided is not None:
        reading = reading.model_copy(update={"limit": undecided.reading.claim})
    return {
        "verdict": "UNKNOWN",
        "undecided": None if undecided is None else undecided.document,
        "witness": None,
        "margin": nothing,
        "reading": reading,
    }


def _steps(planned: Planned, chain: Chain) -> dict[str, object]:
    """What was proved and what not, with every size of the part."""
    return {
        "steps": tuple(step_document(step) for step in chain.steps),
        "claim": claim_document(planned.task, chain, len(planned.found.rules)),
    }


def _premise(planned: Planned, broken: Standing) -> Undecided:
    breaks = broken.word == BREAKS
    reason = (
        about(Reason.PREMISE_KEPT, premise=str(broken.premise), effect=broken.name)
        if breaks
        else about(Reason.EFFECT_BOUNDED, effect=broken.name)
    )
    return _open(
        planned,
        reason,
        remedy(broken),
        claim=f"premise: {broken.premise_words}" if breaks else words(reason),
        inequality=f"{broken.name}: {broken.said}{_place(broken)}",
    )


def _place(broken: Standing) -> str:
    return f" [{broken.claim}, {broken.derivation}]" if broken.claim else ""


def _budget(planned: Planned) -> Undecided:
    reason = about(Reason.WITHIN_BOUNDS)
    return _open(
        planned,
        reason,
        about(Remedy.CALIBRATE_CAMERA),
        claim=words(reason),
        inequality="farthest sensed pose, duration <= those of the bounds",
    )


def _open(
    planned: Planned, reason: Named, settled_by: Named, *, claim: str, inequality: str
) -> Undecided:
    """Something that no move's obligation is about."""
    rule = planned.found.rules[0]
    return Undecided(
        UndecidedDocument(
            move=1,
            step=rule.step,
            action=rule.action,
            reason=named(reason),
            inequality=None,
            fails=False,
            over={},
            settled_by=named(settled_by),
        ),
        UndecidedReading(claim=claim, inequality=inequality, settled_by=words(settled_by)),
    )
