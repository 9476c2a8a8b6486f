"""The answer that the page leads with: verdict, key figures, and what is open if it is not proved."""

from __future__ import annotations

from dataclasses import dataclass

from meso_robust.bounds import Verdict, VerdictWord
from meso_robust.checker.verdict import Answer as Verified
from meso_robust.pipeline import Planned
from meso_robust.reporting.words import Side, Witness, factor, number, sides, witness_words
from meso_robust.transfer.promise import Promise

MEANING = {
    "PROVED": "The plan is certified for {tips}: it reaches the goal for every error within the stated "
    "bounds.",
    "REFUTED": (
        "The plan fails: a simulated run, with {tips} and within every stated bound, does not end in the goal, "
        "even at half the simulation step."
    ),
    "UNKNOWN": "Not proved and not refuted: one inequality is open, and no simulated failure is confirmed.",
}


Figures = tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Open:
    """The first inequality that is not proved."""

    where: str
    claim: str
    inequality: str
    how: str
    """How the sides below are to be read."""
    over: tuple[Side, ...]
    settled_by: str
    premise: bool = False
    """Whether it is a premise of the proof, not one of its inequalities."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What the banner says."""

    verdict: VerdictWord
    colour: VerdictWord
    """Of the verdict, or of what is not known where the checker rejected it."""
    meaning: str
    figures: Figures
    """Name and value."""
    open: Open | None
    witness: Witness | None


def answer(
    result: Planned, promise: Promise | None = None, checker: Verified | None = None
) -> Answer:
    """Put the answer together.

    Parameters
    ----------
    result
        Everything that ``plan`` found out.
    promise
        What a fitted model made of the task, if there is one.
    checker
        What the checker says of the certificate, if it was asked.

    Returns
    -------
    Answer
        What the page leads with.
    """
    certificate = result.certificate
    witness, meaning = (
        certificate.witness,
        _meaning(certificate.verdict, promise).format(tips=result.task.tips),
    )
    if checker is not None:
        told = verified_words(checker, certificate.verdict)
        meaning = f"{meaning} {told[0].upper()}{told[1:].removesuffix('.')}."
    return Answer(
        verdict=certificate.verdict,
        colour=certificate.verdict if checker is None or checker.refused is None else "UNKNOWN",
        meaning=meaning,
        figures=_figures(result) if promise is None else _promised(result, promise),
        open=_open(result),
        witness=None
        if witness is None
        else witness_words(witness, certificate.reading.outcome or ""),
    )


def verified_words(checker: Verified, stated: VerdictWord) -> str:
    """What the checker says of a certificate.

    Parameters
    ----------
    checker
        Its answer.
    stated
        The certificate's own verdict.

    Returns
    -------
    str
        A sentence, without its full stop.
    """
    refused = checker.refused
    if checker.positive:
        return f"checked: {checker.verdict}, by formulas and arithmetic of the checker's own"
    if refused is None:
        return f"checked: {checker.verdict}: {checker.claims.removesuffix('.')}"
    what = (
        "the proof is not confirmed, so do not rely on this plan; state narrower uncertainties or another start"
        if stated == "PROVED"
        else "what the certificate says of this plan is not confirmed"
    )
    return (
        f"checked: {checker.verdict} at {refused.claim}, where {refused.stated} is stated and "
        f"{refused.found} was found: {what}"
    )


def _meaning(verdict: str, promise: Promise | None) -> str:
    if promise is None or verdict == "REFUTED":
        return MEANING[verdict]
    if verdict == "PROVED":
        so = ", on the conditions below" if promise.conditions else ""
        return (
            "The plan is certified for {tips}: it reaches the goal in every laboratory within the fitted "
            f"model's intervals, for every error within the bounds below{so}."
        )
    if promise.broken:
        return (
            "Nothing is proved for this laboratory: the fitted model breaks a premise of the proof, or "
            "leaves a bound open. Boxes and inequalities below are those of the plain model."
        )
    return MEANING[verdict]


def _promised(result: Planned, promise: Promise) -> Figures:
    """Key figures where a fitted model was given: of its own physics, if a premise is broken."""
    if not promise.broken:
        return _figures(result)
    ran = promise.evidence
    runs = "none" if ran is None else f"{ran.in_goal} of {ran.runs}"
    return (
        ("moves", str(len(result.certificate.policy))),
        ("parts of the model not absorbed", str(len(promise.broken))),
        ("runs under the model's own physics end in the goal (evidence, not proof)", runs),
    )


def _figures(result: Planned) -> Figures:
    certificate = result.certificate
    simulation, margin = certificate.simulation, certificate.margin
    figures = [
        ("moves", str(len(certificate.policy))),
        ("simulated runs end in the goal", f"{simulation.in_goal} of {simulation.samples}"),
    ]
    if margin.binds_first is not None:
        binding = margin.binds_first
        alone = factor(margin.each_alone[binding])
        return (
            *figures,
            ("margin: still proved with all uncertainties scaled", f"× {factor(margin.factor)}"),
            (f"binds first (alone × {alone})", binding.replace("_", " ")),
        )
    obligations = [item for step in certificate.steps for item in step.obligations]
    proved = sum(item.verdict == "PROVED" for item in obligations)
    reached = (
        f"inequalities proved, {len(certificate.steps)} of {len(certificate.policy)} moves reached"
    )
    return (*figures, (reached, f"{proved} of {len(obligations)}"))


def _open(result: Planned) -> Open | None:
    undecided, said = result.certificate.undecided, result.certificate.reading.undecided
    if undecided is None or said is None:
        return None
    if result.chain.verdict is Verdict.PROVED:  # of the plain model: what is open is a premise
        return Open(
            where="what the proof rests on",
            claim=said.claim,
            inequality=said.inequality,
            how="",
            over=(),
            settled_by=said.settled_by,
            premise=True,
        )
    found = result.chain.open_obligation
    number_ = len(result.chain.steps) if found is None else result.chain.steps.index(found[0]) + 1
    if found is None:
        how = _overhang(result)
    elif found[1].proof.verdict.name == "REFUTED":
        how = "It fails at this point of its box:"
    elif undecided.over:
        how = "It is undecided over this box:"
    else:
        how = ""
    return Open(
        where=f"move {number_} (step {undecided.step}, {undecided.action})",
        claim=said.claim,
        inequality=said.inequality,
        how=how,
        over=sides(undecided.over),
        settled_by=said.settled_by,
    )


def _overhang(result: Planned) -> str:
    """By how much the final box leaves the goal."""
    end, goal = result.chain.end, result.setup.goal
    if end is None:
        return "The final box:"
    over = {
        "x": (max(goal.x.lo - end.x.lo, end.x.hi - goal.x.hi) * 1e6, "µm"),
        "y": (max(goal.y.lo - end.y.lo, end.y.hi - goal.y.hi) * 1e6, "µm"),
    }
    said = [f"{number(far)} {unit} in {name}" for name, (far, unit) in over.items() if far > 0.0]
    if not (goal.theta.lo <= end.theta.lo and end.theta.hi <= goal.theta.hi):
        said.append("in θ")
    return f"The final box leaves the goal by {' and '.join(said)}; it is:"
