"""The check of a certificate from its first line to its last."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from flint import arb, ctx

from meso_robust.checker import margin as margins, words
from meso_robust.checker.chain import holds_side, passages, within
from meso_robust.checker.document import Certificate, HexPair, StepDocument
from meso_robust.checker.evidence import check_evidence
from meso_robust.checker.ids import Claim, Named, Objection, named, of_move, place, premises
from meso_robust.checker.inputs import Given, PoseBox, given, uncertainties
from meso_robust.checker.moves import check_rule
from meso_robust.checker.numbers import box, check_reading, side
from meso_robust.checker.prover import PLAIN, Prover
from meso_robust.checker.ranges import Side
from meso_robust.checker.refusal import Refused
from meso_robust.checker.replay import replay
from meso_robust.checker.statement import STATEMENTS
from meso_robust.checker.witness import check_witness
from meso_robust.task import Task

BITS = 80
"""Precision of the balls; doubles have 53, so 27 bits are left for what a chain of operations loses."""
NEAR = 1e-14
"""m and rad: by how much a box that the task gives may be told too large or too small. A few last
digits of doubles up to a metre; that it holds what it must is checked without any room."""
Elsewhere = Callable[[], bool]
Word = Literal[
    "VERIFIED",
    "MARGIN UNDECIDED",
    "REJECTED",
    "WITNESS CONFIRMED",
    "WITNESS UNDECIDED",
    "NOTHING CLAIMED",
]
SECTIONS = {
    "schema_",
    "name",
    "part",
    "start",
    "goal",
    "probe",
    "uncertainty",
    "plan",
    "slot",
    "film",
}
"""What the checker's proof takes from a task (``plan`` is for the planner, ``film`` for forces)."""
EVIDENCE = (
    "simulation: runs of the simulator",
    "margin.refused_at, margin.limit: where the search of the margin gave up",
    "boxes of the obligations: how the search cut its boxes",
    "made_with: versions and machine",
    "reading: the file's own sentences; those above are the checker's",
)
"""What no check can confirm: evidence, not proof."""
ALONE = "margin.each_alone, margin.binds_first: confirmed only with --thorough"
OPEN = "steps, undecided: what was proved of single moves, and which inequality is open"
MORE = "witness.more: drag, ways and edges that no tip touches, of which the task's ranges are followed"
SIMULATED = "witness.outcome: how the run fails is what the simulator found"
REPLAY = "meso-robust simulate TASK.toml PLAN.json --witness CERTIFICATE.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What came out."""

    verdict: Word
    """VERIFIED: a proof; MARGIN UNDECIDED: a proof of all but how much more uncertainty the plan bears;
    WITNESS CONFIRMED: a plan that is proved to fail; WITNESS UNDECIDED: one that
    is said to fail; NOTHING CLAIMED: neither; REJECTED: something that is stated is not so."""
    claims: str
    """What the certificate is now known, or said, to claim, in the checker's own words."""
    refused: Refused | None = None
    not_checked: tuple[str, ...] = EVIDENCE
    premises: Mapping[str, str] = field(default_factory=dict)
    """What the proof takes for granted, by name and in words; nothing if nothing is proved."""

    @property
    def positive(self) -> bool:
        """Whether the certificate proves that its plan reaches the goal."""
        return self.verdict == "VERIFIED"


def check(
    certificate: Certificate,
    digest: str,
    task: Task,
    *,
    thorough: bool = False,
    prover: Prover = PLAIN,
    elsewhere: Elsewhere = bool,
) -> Answer:
    """Verify everything that a certificate claims.

    Parameters
    ----------
    certificate, digest, task
        As read (``reading.py``).
    thorough
        Whether the factor of each uncertainty alone is verified as well.
    prover
        Proves the moves.
    elsewhere
        Asked when all moves are verified, whether the margin was verified by someone who is believed; `bool()`
        says no.

    Returns
    -------
    Answer
        The verdict; of a rejection, what is stated and what is so.
    """
    with ctx.workprec(BITS):
        try:
            return _check(certificate, digest, task, thorough, prover, elsewhere)
        except Refused as refused:
            return Answer(verdict="REJECTED", claims=certificate.verdict, refused=refused)


def _check(
    certificate: Certificate,
    digest: str,
    task: Task,
    thorough: bool,
    prover: Prover,
    elsewhere: Elsewhere,
) -> Answer:
    if certificate.digest != digest:
        raise Refused(named(Objection.DIGEST), certificate.digest, digest)
    check_evidence(certificate)
    known = given(task)
    _check_claim(certificate, task, known)
    _check_goal(certificate, known)
    if certificate.verdict == "UNKNOWN":
        _expect(place("undecided"), certificate.undecided is not None)
        says = "nothing is claimed: the verdict is UNKNOWN"
        return Answer(verdict="NOTHING CLAIMED", claims=says, not_checked=(OPEN,))
    _check_known(task)
    _check_headings(certificate, task)
    if certificate.verdict == "REFUTED":
        return _refuted(certificate, known)
    _check_shape(certificate)
    actions = [rule.action for rule in certificate.policy]
    margins.check_form(certificate.margin, uncertainties(known), actions)
    boxes = _boxes(certificate, known)
    _check_steps(certificate, known, boxes, prover)
    open_: Refused | None = None
    if not elsewhere():
        try:
            margins.check_factor(certificate, task, alone=thorough, prover=prover)
        except Refused as refused:
            open_ = refused
    not_checked = EVIDENCE if thorough else (*EVIDENCE, ALONE)
    claims = words.claim(task, len(certificate.policy), guided=_guided(certificate))
    granted = {one.value: words.PREMISES[one] for one in premises(task)}
    if open_ is None:
        return Answer(verdict="VERIFIED", claims=claims, not_checked=not_checked, premises=granted)
    return Answer(
        verdict="MARGIN UNDECIDED",
        claims=f"{claims} That it bears more uncertainty is open: {open_.claim} is stated as {open_.stated}, {open_.found}.",
        not_checked=not_checked,
        premises=granted,
    )


def _refuted(certificate: Certificate, known: Given) -> Answer:
    """Follow the witness: it is believed only as far as it is proved to fail."""
    steps = certificate.steps
    proved = len(steps) == len(certificate.policy) and all(s.verdict == "PROVED" for s in steps)
    ends = steps[-1].post_exact if proved and steps else None
    if ends is not None and within(box(ends, of_move(len(steps) - 1, "post_exact")), known.goal):
        raise Refused(place("verdict"), "REFUTED", "every move stated as PROVED, into the goal")
    _expect(place("undecided"), certificate.undecided is not None)
    _expect(place("policy"), len(certificate.policy) > 0)
    for rule in certificate.policy:
        check_rule(rule)
    margins.check_none(certificate.margin)
    witness = check_witness(certificate, known)
    more = (MORE,) if witness.more else ()
    fate = replay(witness, certificate.policy, known)
    move = "" if fate.move is None else f"move {fate.move}: "
    why = f"{move}{words.sentence(fate.why)}"
    if fate.fails:
        if fate.outcome is not None:
            _same(place("witness.outcome"), witness.outcome, fate.outcome)
        return Answer(
            verdict="WITNESS CONFIRMED",
            claims="the plan fails: of the witness, a run within the bounds of the task, it is proved "
            f"that it fails ({why})",
            not_checked=(*EVIDENCE, *more, OPEN),
        )
    return Answer(
        verdict="WITNESS UNDECIDED",
        claims=f"the witness keeps within the bounds of the task; that it fails was not shown here, "
        f"as the checker cannot follow it ({why}), and rests on the simulator alone: `{REPLAY}`",
        not_checked=(*EVIDENCE, *more, OPEN, SIMULATED),
    )


def _expect(what: Named, holds: bool, stated: object = "otherwise", found: object = "must") -> None:
    if not holds:
        raise Refused(what, stated, found)


def _same(what: Named, stated: object, own: object) -> None:
    _expect(what, stated == own, stated, own)


def _check_claim(certificate: Certificate, task: Task, known: Given) -> None:
    """The certificate claims neither more nor less than what is verified here, on the same ground."""
    claim = certificate.claim
    own = Claim.ENDS_IN_GOAL if task.slot is None else Claim.ENDS_IN_GOAL_CLEAR_OF_WALLS
    if _guided(certificate):
        own = Claim.ENDS_IN_GOAL_GUIDED
    _same(place("task"), certificate.task, task.name)
    _same(place("claim.id"), claim.id, own)
    _same(place("claim.moves"), claim.moves, len(certificate.policy))
    _same(place("claim.premises"), list(claim.premises), [one.value for one in premises(task)])
    _check_uncertainties(claim.uncertainties, uncertainties(known))
    listed = {one.inequality for step in certificate.steps for one in step.obligations}
    _same(place("claim.inequalities"), sorted(claim.inequalities), sorted(listed))
    for id_, derivation in claim.inequalities.items():
        where = place(f"claim.inequalities.{id_}")
        _expect(where, id_ in STATEMENTS, id_, "an inequality that the checker knows")
        _same(where, derivation, STATEMENTS[id_].derivation)


def _guided(certificate: Certificate) -> bool:
    """Whether the part may touch walls in one of the moves."""
    return any(rule.action == "guide" for rule in certificate.policy)


def _check_uncertainties(stated: Mapping[str, HexPair], own: Mapping[str, Side]) -> None:
    """Each range is the task's, rounded outward; one that the checker does not know is refused."""
    _same(place("claim.uncertainties"), sorted(stated), sorted(own))
    for key, pair in stated.items():
        where = place(f"claim.uncertainties.{key}")
        told, known = side(pair, where), own[key]
        reach = max(abs(float(end)) for end in known) * NEAR
        close = all(abs(p - q) <= arb(reach) for p, q in zip(told, known, strict=True))
        ends = [[float(end) for end in one] for one in (told, known)]
        _expect(where, close and holds_side(told, known), *ends)


def _check_goal(certificate: Certificate, known: Given) -> None:
    stated = box(certificate.goal_exact, place("goal_exact"))
    check_reading(certificate.goal, stated, place("goal"), outward=False)
    _expect(place("goal_exact"), within(stated, known.goal))
    _expect(place("goal_exact"), _near(stated, known.goal))


def _near(one: PoseBox, other: PoseBox) -> bool:
    pairs = ((one.x, other.x), (one.y, other.y), (one.theta, other.theta))
    return all(abs(p - q) <= arb(NEAR) for a, b in pairs for p, q in zip(a, b, strict=True))


def _check_known(task: Task) -> None:
    """Nothing of the task may be left out: a section that the checker does not know is refused."""
    for name in type(task).model_fields:
        if name not in SECTIONS and getattr(task, name) is not None:
            raise Refused(named(Objection.TASK_SECTIONS), name, sorted(SECTIONS))


def _check_shape(certificate: Certificate) -> None:
    """A PROVED certificate has one proved step a move and nothing that is open."""
    _expect(place("undecided"), certificate.undecided is None)
    _expect(place("witness"), certificate.witness is None)
    _expect(place("policy"), len(certificate.policy) > 0)
    _same(place("steps"), len(certificate.steps), len(certificate.policy))
    for number, (step, rule) in enumerate(zip(certificate.steps, certificate.policy, strict=True)):
        for name in ("step", "primitive", "action"):
            _same(of_move(number, name), getattr(step, name), getattr(rule, name))
        _same(of_move(number, "verdict"), step.verdict, "PROVED")


def _check_headings(certificate: Certificate, task: Task) -> None:
    """Every push is one that the task has a probe for."""
    stated = task.probe.headings
    for number, rule in enumerate(certificate.policy):
        if stated is not None and rule.heading not in stated:
            raise Refused(of_move(number, "heading"), rule.heading, list(stated))


def _boxes(certificate: Certificate, known: Given) -> list[PoseBox]:
    """The boxes before the first move and after each one, as far as they can be judged alone."""
    boxes = [_told(certificate.steps[0], 0, "pre")]
    _expect(of_move(0, "pre_exact"), within(known.start, boxes[0]))
    _expect(of_move(0, "pre_exact"), _near(known.start, boxes[0]))
    for number, step in enumerate(certificate.steps):
        if number > 0:
            before = certificate.steps[number - 1]
            _same(of_move(number, "pre"), (step.pre, step.pre_exact), (before.post, before.post_exact))  # fmt: skip
        boxes.append(_told(step, number, "post"))
    _expect(named(Objection.GOAL_REACHED), within(boxes[-1], known.goal))
    return boxes


def _told(step: StepDocument, number: int, which: str) -> PoseBox:
    exact, reading = getattr(step, f"{which}_exact"), getattr(step, which)
    if exact is None or reading is None:
        raise Refused(of_move(number, which), "null", "a box")
    found = box(exact, of_move(number, f"{which}_exact"))
    check_reading(reading, found, of_move(number, which))
    return found


def _check_steps(
    certificate: Certificate, known: Given, boxes: list[PoseBox], prover: Prover
) -> None:
    """Verify every move from the stated box before it, and compare all that is stated of it."""
    moves = passages(
        certificate.policy, known, boxes[0], lambda number, _: boxes[number + 1], prover
    )
    for number, (passage, post) in enumerate(moves):
        step, does = certificate.steps[number], passage.does
        stated_property = (step.property.id, step.property.about)
        _same(of_move(number, "property"), stated_property, (str(does.id), dict(does.about)))
        for name in ("x", "y", "theta"):
            stated, own = getattr(boxes[number + 1], name), getattr(post, name)
            ends = [[float(end) for end in side] for side in (stated, own)]
            what = named(Objection.POST_HOLDS, move=str(number + 1)).value(f"post_exact.{name}")
            _expect(what, holds_side(stated, own), *ends)
        prover.compare(step.obligations, passage.requirements)
