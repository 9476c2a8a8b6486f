"""The re-certification result, as a document and in words."""

from __future__ import annotations

from meso_robust.bounds import Verdict
from meso_robust.certificates.words import words
from meso_robust.transfer.assumption_check import BREAKS, FRICTION, Standing, remedy
from meso_robust.transfer.document import (
    BeyondMade,
    ChangeMade,
    EvidenceMade,
    ModelMade,
    PremisesDocument,
    StandingMade,
)
from meso_robust.transfer.lines import Ground
from meso_robust.transfer.promise import Promise, model_hash
from meso_robust.wording import counted, do, down, worded

CLEAR_OF_POST = "part and tips stay clear of the post"


def document(made: Promise) -> PremisesDocument:
    """The document, file premises.json.

    Parameters
    ----------
    made
        The promise.

    Returns
    -------
    PremisesDocument
        In the units of the task file.
    """
    model = made.document
    return PremisesDocument(
        verdict=made.planned.certificate.verdict,
        why=why(made),
        model=ModelMade(
            name=model.model,
            sha256=model_hash(model),
            recordings_sha256=model.provenance.recordings_sha256,
            confidence=model.confidence,
        ),
        task_hash_before=made.before.hash,
        task_hash=made.changed.task.hash,
        changes=tuple(
            ChangeMade(key=one.key, before=one.before, after=one.after, because=one.because)
            for one in made.changed.changes
        ),
        standings=tuple(
            StandingMade(
                name=one.name,
                standing=one.word,
                premise=one.premise,
                premise_words=one.premise_words,
                claim=one.claim,
                derivation=one.derivation,
                said=one.said,
            )
            for one in made.standings
        ),
        conditions=made.conditions,
        beyond=_beyond(made),
        evidence=_evidence(made),
        no_evidence=made.no_evidence,
        caution=cautions(made),
    )


def why(made: Promise) -> str:
    """Why the promise is not PROVED; empty if it is."""
    certificate = made.planned.certificate
    if certificate.verdict == "PROVED":
        return ""
    if made.broken:
        return "; ".join(
            f"{one.name} ({one.word}): {one.premise_words} [{_place(one)}]"
            if one.word == BREAKS
            else f"{one.name} ({one.word}): {one.said}"
            for one in made.broken
        )
    open_, said = certificate.undecided, certificate.reading.undecided
    if open_ is None or said is None:
        return ""
    return f"{said.claim} (move {open_.move}, {open_.action})"


def settled_by(made: Promise) -> tuple[str, ...]:
    """What would make a promise PROVED.

    Parameters
    ----------
    made
        The promise.

    Returns
    -------
    tuple
        In words, one for each thing that is missing; none if it is PROVED.
    """
    if made.broken:
        return tuple(words(remedy(one)) for one in made.broken)
    said = made.planned.certificate.reading.undecided
    return () if said is None else (said.settled_by,)


def _place(one: Standing) -> str:
    """Claim and derivation that rest on a premise, or what else there is to say."""
    return f"{one.claim}, {one.derivation}" if one.claim else _alone(one)


def _alone(one: Standing) -> str:
    return f"{one.name} has no line of its own" if one.premise is Ground.A_LINE else one.said


def cautions(made: Promise) -> tuple[str, ...]:
    """What else to keep in mind of the model."""
    model, found = made.document, []
    if model.confidence is not None:
        found.append(
            f"the ranges are the model's intervals, {model.confidence:.0%} for each one alone: what is "
            "proved is proved for every value in them"
        )
    friction = model.parameters.get(FRICTION)
    if friction is not None and (friction.open_low or friction.open_high):
        found += [f"{FRICTION}: {one.said}" for one in made.standings if one.name == FRICTION]
    if any(one.absorbed is not None and one.absorbed.sensed_um > 0.0 for one in made.standings):
        found.append(
            "start and goal are in the probes' axes; what is bounded is how the camera errs"
        )
    return tuple(found)


def summary(made: Promise) -> str:
    """The answer in a few lines.

    Parameters
    ----------
    made
        The promise.

    Returns
    -------
    str
        Verdict, what changed, what breaks, and the evidence, a line each.
    """
    certificate = made.planned.certificate
    lines = [
        f"{certificate.verdict} ({made.changed.task.tips}): {made.before.name}, with the model {made.document.model}"
    ]
    lines += [
        f"  {one.key}: {one.before} -> {one.after} ({one.because})" for one in made.changed.changes
    ]
    lines += [
        f"  {one.name}: {one.word}: {one.said}"
        for one in made.standings
        if one.absorbed or not one.survives
    ]
    lines += [f"  only if {one}" for one in made.conditions]
    if made.wide is not None:
        lines.append(f"  {CLEAR_OF_POST}: {made.wide.verdict.word}")
    said = [*lines, *_judged_words(made), *_evidence_words(made), *cautions(made)]
    return worded("\n".join(said))


def _judged_words(made: Promise) -> list[str]:
    """The margin, or what is not kept and what would settle it."""
    certificate = made.planned.certificate
    if certificate.verdict == "PROVED":
        of = "" if made.wide is None else " (of the task without the post)"
        factor = certificate.margin.factor
        return [f"margin: still proved with all uncertainties x {down(factor, 2)}{of}"]
    if made.broken:
        return [
            f"premise not kept: {one.premise_words} [{_place(one)}]"
            if one.word == BREAKS
            else f"no bounds of {one.name}: {one.said}"
            for one in made.broken
        ] + [f"what would settle it: {one}" for one in settled_by(made)]
    said = certificate.reading.undecided
    if said is None:
        return []
    return [
        f"not proved: {said.claim}",
        *(f"what would settle it: {one}" for one in settled_by(made)),
    ]


def _evidence_words(made: Promise) -> list[str]:
    found = _evidence(made)
    if found is None:
        return (
            [f"no runs under the model's own physics: {made.no_evidence}"]
            if made.no_evidence
            else []
        )
    return [
        f"simulated under the model's own physics (evidence, not proof): {found.in_goal} of "
        f"{counted(found.runs, 'run')} {do(found.runs, 'end')} in the goal; {worst_words(found)}",
        *(f"  {counted(count, 'run')}: {how}" for how, count in found.endings.items()),
    ]


def worst_words(found: EvidenceMade) -> str:
    """How far the runs that carried out all moves end from the goal.

    Parameters
    ----------
    found
        Runs under the model's own physics.

    Returns
    -------
    str
        A clause; µm and degrees rounded up.
    """
    worst = found.worst_miss_um, found.worst_miss_deg
    if not found.completed:
        return "no run carried out all moves"
    if not any(worst):
        return "every run that carried out all moves ends in it"
    return f"the worst that carried out all moves misses it by {worst[0]:g} um, {worst[1]:g} deg"


def _beyond(made: Promise) -> BeyondMade | None:
    if made.wide is None:
        return None
    proved = made.wide.verdict is Verdict.PROVED
    return BeyondMade(
        claim=CLEAR_OF_POST,
        verdict=made.wide.verdict.word,
        open="" if proved else words(made.wide.first_open[1]),
    )


def _evidence(made: Promise) -> EvidenceMade | None:
    found = made.evidence
    if found is None:
        return None
    return EvidenceMade(
        runs=found.runs,
        seed=found.seed,
        completed=found.completed,
        in_goal=found.in_goal,
        worst_miss_um=found.worst_um,
        worst_miss_deg=found.worst_deg,
        endings=dict(found.endings),
    )
