"""What is asked of an answer beyond its evidence: recordings that no fit has seen, and invariances."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2 as chi2_law

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.candidates import Candidate, Naming, exchanged, other_forms
from meso_robust.diagnosis.controls import catch_all
from meso_robust.diagnosis.invariances import Pair
from meso_robust.diagnosis.localisation import Located, predicted_pairs
from meso_robust.diagnosis.rejection import Ground, Rejection
from meso_robust.diagnosis.validation import Errors, Split, Worth, worth
from meso_robust.recordings import RecordingSet

# by which held-out recordings must prefer a rival to refute an answer
_REFUTED_NATS = 5.0
# times what free hidden inputs leave, that an answer may leave of most recordings
_ABOVE_FLOOR = 1.2
_PARTIAL_SETS = 3  # sets that may explain a part of a mismatch that none explains
# chance, for all pairs together, of so large a difference from what an answer predicts
_INVARIANCE_ALPHA = 0.001


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Witnesses:
    """What speaks for or against sets of effects; the plain model is the empty set.

    Attributes
    ----------
    errors
        On the held-out recordings; on those of the fits where none are.
    unseen
        Whether no fit has seen these recordings.
    reach
        Error in σ that any law may leave: the noise floor, or more where free hidden inputs do.
    seen
        Invariances as the recordings have them.
    pairs
        The same as every answer has them.
    """

    errors: Mapping[tuple[str, ...], Errors]
    unseen: bool
    reach: float
    seen: Sequence[Pair] = ()
    pairs: Mapping[tuple[str, ...], Sequence[Pair]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Accepted:
    """The outcome of the competition after all witnesses were heard.

    Attributes
    ----------
    naming
        The answers that are left; without any, the part of the mismatch that is explained.
    catch_all
        Error in σ that free hidden inputs leave; None where no window has enough frames.
    worths
        Errors of the sets that were asked, by their effects.
    """

    naming: Naming
    catch_all: float | None
    worths: Mapping[tuple[str, ...], Worth]

    def worth_of(self, one: Candidate) -> Worth | None:
        """Errors of a set, if it was asked in this form."""
        asked = any(each.refit is one.refit for each in self.naming.candidates)
        return self.worths.get(one.effects) if asked else None


def accepted(
    naming: Naming, where: Located, baseline: Baseline, plain: Worth, recordings: Split
) -> Accepted:
    """Hear what speaks against the answers of a competition.

    Parameters
    ----------
    naming
        Outcome of the competition.
    where
        Where the mismatch is.
    baseline, plain
        The plain model, and its errors.
    recordings
        Of the fit, and held out.
    """
    held_out = recordings.held_out
    floor = _floor(baseline, plain, recordings)
    worths = {one.effects: worth(baseline, one.refit, held_out) for one in _asked(naming, held_out)}
    answers = [one.effects for one in naming.answers]

    def heard(worths: Mapping[tuple[str, ...], Worth]) -> Witnesses:
        return Witnesses(
            errors={(): plain.judged} | {names: one.judged for names, one in worths.items()},
            unseen=held_out is not None,
            reach=max(baseline.noise.floor, floor or 0.0),
            seen=where.pairs,
            pairs={
                names: predicted_pairs(baseline, where.pairs, worths[names].training.poses)
                for names in answers
            },
        )

    naming, worths = in_open_forms(
        naming, worths, heard, lambda one: worth(baseline, one.refit, held_out)
    )
    found = judged(naming, heard(worths))
    if not found.answers and held_out is not None:
        some = found.candidates[:_PARTIAL_SETS]
        worths |= {
            one.effects: worth(baseline, one.refit, held_out)
            for one in some
            if one.effects not in worths
        }
        found = partial(found, plain.judged, tuple(worths[one.effects].judged for one in some))
    best = found.best
    if best is not None and best.effects not in worths:
        worths[best.effects] = worth(baseline, best.refit, held_out)
    return Accepted(naming=found, catch_all=floor, worths=worths)


def _asked(naming: Naming, held_out: RecordingSet | None) -> tuple[Candidate, ...]:
    """The answers; and the sets they contain, where recordings that no fit has seen can tell them."""
    if held_out is None:
        return naming.answers
    return tuple(
        one
        for one in naming.candidates
        if any(set(one.effects) <= set(answer.effects) for answer in naming.answers)
    )


def _floor(baseline: Baseline, plain: Worth, recordings: Split) -> float | None:
    """What any law could reach on held-out recordings; on those of the fit where none are."""
    if recordings.held_out is None or plain.held_out is None:
        return catch_all(recordings.training, baseline.prepared, baseline)
    return catch_all(recordings.held_out, plain.held_out.prepared, baseline)


def in_open_forms(
    naming: Naming,
    worths: Mapping[tuple[str, ...], Worth],
    heard: Callable[[Mapping[tuple[str, ...], Worth]], Witnesses],
    ask: Callable[[Candidate], Worth],
) -> tuple[Naming, dict[tuple[str, ...], Worth]]:
    """The answers, those that a witness speaks against in another form of their law that none speaks against.

    The fits leave open which form it is: what other recordings refute is the one that was a little likelier.

    Parameters
    ----------
    naming
        Outcome of the competition.
    worths
        Errors of the sets that were asked, by their effects.
    heard
        Makes of them what speaks for and against sets.
    ask
        Makes the errors of a set in another form.
    """
    worths, asked = dict(worths), set[tuple[str, ...]]()
    while True:
        told = heard(worths)
        short = next(
            (
                one
                for one in naming.answers
                if one.effects not in asked and _against(one, naming.answers, told)
            ),
            None,
        )
        if short is None:
            return naming, worths
        asked.add(short.effects)
        for form in other_forms(short, naming):
            also = worths | {form.effects: ask(form)}
            if not _against(form, naming.answers, heard(also)):
                naming, worths = exchanged(naming, {form.effects: form}), also
                break


def judged(naming: Naming, told: Witnesses) -> Naming:
    """The answers against which no witness speaks.

    Parameters
    ----------
    naming
        Outcome of the competition.
    told
        Errors of the plain model, of every answer and of its parts; pairs of every answer.
    """
    against = {one.effects: _against(one, naming.answers, told) for one in naming.answers}
    return replace(
        naming,
        answers=tuple(one for one in naming.answers if not against[one.effects]),
        candidates=tuple(
            replace(one, rejected=against.get(one.effects) or one.rejected)
            for one in naming.candidates
        ),
    )


def _against(one: Candidate, answers: Sequence[Candidate], told: Witnesses) -> Rejection | None:
    """Why a set cannot be the answer; None if it may be."""
    reasons = (
        _refuted(one, answers, told) if told.unseen else None,
        _idle(one, told) if told.unseen else None,
        _far(one, told),
        _unlike(one, told),
    )
    return next(filter(None, reasons), None)


def _refuted(one: Candidate, answers: Sequence[Candidate], told: Witnesses) -> Rejection | None:
    rivals = [(), *(other.effects for other in answers)]
    behind = max(_likelihood(told.errors[names]) for names in rivals) - _likelihood(
        told.errors[one.effects]
    )
    if behind <= _REFUTED_NATS:
        return None
    return Rejection(ground=Ground.HELD_OUT_WORSE, amount=behind)


def _idle(one: Candidate, told: Witnesses) -> Rejection | None:
    """A part of a set that does as well as the whole where neither was fitted."""
    own = _likelihood(told.errors[one.effects])
    for names, errors in told.errors.items():
        if names and set(names) < set(one.effects) and _likelihood(errors) >= own:
            return Rejection(ground=Ground.IDLE_MEMBER, names=names)
    return None


def _far(one: Candidate, told: Witnesses) -> Rejection | None:
    """More left of most recordings than any law must leave.

    Of a few it may be the numbers, not the law: a tip at the edge of its friction cone makes much of
    a friction that was known well enough elsewhere.
    """
    left = float(np.median(told.errors[one.effects].sigma))
    if left <= _ABOVE_FLOOR * told.reach:
        return None
    return Rejection(ground=Ground.ABOVE_FLOOR, amount=left, limit=told.reach)


def _unlike(one: Candidate, told: Witnesses) -> Rejection | None:
    """An invariance that the set does not break as the recordings do."""
    predicted = told.pairs.get(one.effects, ())
    chances = [_chance(seen, own) for seen, own in zip(told.seen, predicted, strict=True)]
    if not chances or min(chances) * len(chances) >= _INVARIANCE_ALPHA:
        return None
    pair = predicted[int(np.argmin(chances))]
    return Rejection(
        ground=Ground.INVARIANCE,
        invariance=pair.invariance,
        names=tuple(dict.fromkeys((pair.first, pair.second))),
    )


def _chance(seen: Pair, own: Pair) -> float:
    """Of a difference as large as that between what is seen and what a model has."""
    used = seen.tolerance > 0.0
    apart = (seen.difference - own.difference)[used] / seen.tolerance[used]
    return float(chi2_law.sf(float(apart @ apart), int(used.sum())))


def _likelihood(errors: Errors) -> float:
    """Logarithm, in nats, but for a constant."""
    return -0.5 * float(np.sum(errors.rows**2))


def partial(naming: Naming, before: Errors, each: tuple[Errors, ...]) -> Naming:
    """Of a mismatch that nothing explains, the part that carries over to held-out recordings.

    Parameters
    ----------
    naming
        Outcome of the competition, without an answer.
    before, each
        Errors on held-out recordings of the plain model, and of the first candidates.
    """
    best = min(range(len(each)), key=lambda k: each[k].whole, default=None)
    if best is None or each[best].whole >= before.whole:
        return replace(naming, best=None)
    return replace(naming, best=naming.candidates[best])
