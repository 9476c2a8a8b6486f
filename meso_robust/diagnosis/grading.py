"""How much of what could be explained a set of effects explains, where it was not fitted.

Every real recording is a little wrong everywhere, and with thousands of frames any law is refuted.
What counts is the share of the *explainable* error: the plain model's error in roll-outs of
recordings that a fit has not seen, less what hidden inputs, free from window to window, would leave.
A set of effects is named for four fifths of it, and partly for a fifth; an error too small to matter
is consistent, and its size is told. Shares are those of means of squares, so they add up.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from math import factorial
from typing import Any

import numpy as np
from scipy.stats import norm, t as student

from meso_robust.copies import shared
from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.candidates import (
    SCORE_SHARE,
    SPECIAL_CASE,
    Candidate,
    Naming,
    exchanged,
    other_forms,
)
from meso_robust.diagnosis.document import Channel, Verdict
from meso_robust.diagnosis.folds import Bench, RollOut, intervals_by_fold, rolled_out
from meso_robust.diagnosis.hidden_inputs import CHANNELS
from meso_robust.diagnosis.localisation import Located
from meso_robust.diagnosis.rejection import Ground
from meso_robust.diagnosis.signatures import extended
from meso_robust.diagnosis.stages import stages
from meso_robust.diagnosis.tangent import CONFIDENCE, Interval
from meso_robust.diagnosis.windows import cuts_of
from meso_robust.identification.prepared import some_of
from meso_robust.recordings import RecordingSet
from meso_robust.simulator.catalogue import CATALOGUE, family_of, stage_of
from meso_robust.types import Floats, Ints

NAMED, PARTIAL = 0.8, 0.2
"""Shares of the explainable error from which on a set is named, and partly named."""
SURE = 0.7
"""Share from which on the lower end of the interval of a named set is: with another draw of recordings a
law that makes half of the motion alike explains as much."""
RELEVANT = 1e-7
"""m: size of an error that matters, where no noise is known to compare it with."""
RELEVANT_SHARE = 0.2
"""Of the noise, likewise."""
_JUDGED = {True: 4, False: 8}  # sets that are predicted fold by fold, if quick and if not
# of the explainable error, that a member must explain: less is what any law mops up of another's form
_MEMBER_SHARE = 0.05
# of it, by which a member may raise the error of one fold: a few pushes tell no more
_FOLD_SHARE = 0.02
_CHANCE = 3.0  # standard deviations of noise, that the explainable error must be beyond
_BELOW = 1.0 - 1e-12  # of what a set leaves, so that rounding does not put a floor above it
_DOWN_TO = 1.2  # mean square over that of noise and starts, up to which a set is down to the noise
_EQUAL_SHARE = 0.9  # of the best set's share, from which on a rival may explain as much
_EQUAL_NATS = 5.0  # tempered, up to which recordings do not tell two sets apart
_TEMPERED = 1.5  # squared error over the floor, from which on a likelihood is overconfident
_MOST_OF_ALL = 0.5  # of the explainable error, that one effect explains which fails to carry over
_MOSTLY = 0.5  # of what is left, from which on a sway is where it is
_LOOKED = 8  # recordings in which it is looked for where the rest is, those that have most of it
_RESAMPLED = 2000
_INTERVAL = 0.9
# half widths by which a size is beyond nought, for the best of the catalogue to be so in a tenth of the sets
# that hold none
_BEYOND = float(
    norm.isf(0.5 * (1.0 - CONFIDENCE) / len(CATALOGUE)) / norm.isf(0.5 * (1.0 - CONFIDENCE))
)
_PHASES = ("approach", "one_point", "two_point", "retract", "rest")
_COMPONENTS = ("x", "y", "theta")

_LARGEST = 3  # effects of a set that further ones were added to
# of what a set leaves, that a further member must take away
_FURTHER_SHARE = 0.2
_NEARLY_ALL = 0.8  # likewise, of one whose size need not be as sure
_ALIKE_SHARE = 0.8  # of what the best further member takes away, from which on another is as good

Names = tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """Part of the explainable error, as a share of it; the shares of all cells add up to one.

    Attributes
    ----------
    effect
        That explains it; empty for what nothing explains.
    stage
        Of the effect, or the one whose hidden input helps most.
    phase, component
        Of the motion.
    share
        May be slightly negative, where an effect makes it worse.
    """

    effect: str
    stage: str
    phase: str
    component: str
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Explained:
    """Share of the explainable error that a set explains, with an interval over recordings."""

    share: float
    low: float
    high: float
    folds: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Remainder:
    """What is left to explain in roll-outs, beyond the floor.

    Attributes
    ----------
    metres, radians, sigma
        Root mean squares of place and turn, and of all over the noise of the camera.
    stage, component, phase, grows_with
        Where most of it is.
    spread
        Standard deviation over mean of what is left of one recording: about nought if all pushes are
        wrong alike, more if the rest varies between them.
    """

    metres: float
    radians: float
    sigma: float
    stage: Channel | None
    component: str | None
    phase: str | None
    grows_with: str
    spread: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grade:
    """Verdict on the competition, and what it rests on.

    Attributes
    ----------
    verdict
        As in `diagnosis.json`.
    bench
        All recordings, and their folds.
    plain, extended
        Roll-outs of the plain model, and of the chosen set; None where no set was chosen.
    chosen
        Candidate of that set.
    rivals
        Sets that explain as much.
    alike
        Likewise, but only with other laws of the same physics, with more effects than the chosen one, or with others in
        place of what was found in what the rest leaves: what it is stays known, so that it is partial.
    explained
        None where nothing is to be explained.
    shares
        Of the explainable error, by effect; their sum is that of ``explained``.
    cells
        The whole of it.
    remainder
        What is left.
    size, relevant
        Of the explainable error of the plain model, and from which on it matters, m.
    floor
        Mean square that free hidden inputs leave, over the noise.
    unsure
        Effects of the set whose size the recordings do not agree on: what else would be named is partial.
    beside
        Effects that explain little of the whole beside the others, or were found in what these leave: likewise, as the
        form of a law that is not quite the true one leaves something that an effect may look like.
    """

    verdict: Verdict
    bench: Bench
    plain: RollOut
    extended: RollOut | None
    chosen: Candidate | None
    rivals: tuple[Candidate, ...]
    explained: Explained | None
    shares: Mapping[str, float]
    cells: tuple[Cell, ...]
    remainder: Remainder
    size: float
    relevant: float
    floor: float
    unsure: Names = ()
    beside: Names = ()
    alike: tuple[Candidate, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class _Judge:
    """The recordings, and every set of effects that was predicted fold by fold."""

    bench: Bench
    seen: dict[Names, RollOut]
    floor: Floats
    """(R,) sums of squares that nothing needs to explain."""

    def sums(self, names: Names) -> Floats:
        """(R,) sums of squares of a set that was predicted."""
        return np.asarray(self.seen[names].squares.sum(axis=(1, 2)))

    @property
    def explainable(self) -> float:
        """Sum of squares of the plain model beyond the floor; positive."""
        return max(float(np.sum(self.sums(()) - self.floor)), 1e-12)

    @property
    def chance(self) -> float:
        """Sum of squares beyond the floor that noise makes: it varies by √(2 N) of N data."""
        return _CHANCE * float(np.sqrt(2.0 * self.bench.seen.sum()))

    def share(self, names: Names) -> float:
        """Of the explainable error, that a set explains."""
        share = float(np.sum(self.sums(()) - self.sums(names))) / self.explainable
        return min(share, 1.0)  # more than all is rounding: the floor lies below every set

    def carries(self, names: Names) -> bool:
        """Whether a set predicts recordings that it was not chosen by no worse, in place and in turn.

        By no more than noise makes, or a law that is not quite the true one.
        """
        rows = self.bench.held_out
        count = float(self.bench.seen[rows].sum())
        plain, own = (self.seen[one].squares[rows].sum(axis=(0, 1)) for one in ((), names))
        loss = own - plain
        least = max(_CHANCE * float(np.sqrt(2.0 * count)), _MEMBER_SHARE * float(plain.sum()))
        return max(float(loss[0] + loss[1]), float(loss[2])) <= least

    def lessens(self, names: Names) -> bool:
        """Whether a set leaves less of those recordings than the plain model, place and turn together."""
        rows = self.bench.held_out
        return bool(np.sum(self.sums(names)[rows]) < np.sum(self.sums(())[rows]))

    def with_part(self, whole: Candidate, names: Names) -> None:
        """Predict a part of a set, whose fits begin where the whole ended; what cannot be simulated explains nothing."""
        if names in self.seen:
            return
        base = self.bench.baseline
        trials = tuple(one for one in whole.refit.trials if one.effect in names)
        model = extended(base.model, trials, base.prepared)
        values = dict(zip(whole.refit.model.keys, whole.refit.fits.values[0], strict=True))
        start = np.array([values[key] for key in model.keys])
        self.seen[names] = self.seen[()]
        with suppress(ValueError, np.linalg.LinAlgError):
            self.seen[names] = rolled_out(self.bench, model, start, self.seen[()].values)


def graded(
    recordings: RecordingSet,
    bench: Bench,
    naming: Naming | None,
    where: Located | None,
    reach: float | None,
    *,
    quick: bool,
    seed: int,
    relevant: float | None,
) -> Grade:
    """Judge the sets of a competition by what they explain of recordings left out of the fit.

    Parameters
    ----------
    recordings, bench
        All recordings.
    naming
        Outcome of the competition; None where no mismatch was detected.
    where
        Where the mismatch is; None likewise.
    reach
        σ that free hidden inputs leave; None where that is not known.
    quick
        Fewer sets are judged.
    seed
        Of the intervals.
    relevant
        m: errors below do not matter; None for a fifth of the noise, or what an error of the tracker that
        stays from frame to frame makes, if that is more.
    """
    baseline = bench.baseline
    plain = rolled_out(bench, baseline.model, baseline.fits.values[0])
    # inputs that are constant in a window follow no sway: what they leave of it is no floor
    if _mostly_sway(bench, float(np.sum(plain.squares) - bench.seen.sum())):
        reach = None
    matters = _relevant(baseline) if relevant is None else relevant
    predicted: dict[Names, RollOut] = {(): plain}
    chosen: Candidate | None = None
    rivals: tuple[Candidate, ...] = ()
    everywhere = True
    turned: dict[Names, Candidate] = {}
    for asked, pool in _pools(naming, quick):
        pool = _predicted(bench, predicted, tuple(turned.get(one.effects, one) for one in pool))
        judge = _Judge(bench, predicted, _floor(bench, predicted, reach))
        size = _size_left(judge, ())
        missing = asked is not None and _is_left(judge, (), matters)
        # of a single recording none can be left out: what its own fit explains proves nothing
        if asked and pool and missing and bench.count > 1:
            known = exchanged(asked, turned)
            found, other = _in_open_forms(known, pool, judge, reach, seed)
            chosen, rivals, everywhere = found
            turned |= other
            judge = _Judge(bench, predicted, _floor(bench, predicted, reach))
        if chosen is not None or not missing or bench.count == 1:
            break
    beside: Names = ()
    alike: tuple[Candidate, ...] = ()
    if chosen is not None:
        alike = tuple(one for one in rivals if _only_law(judge, chosen, one, seed))
        rivals = tuple(one for one in rivals if one not in alike)
    if naming is not None and chosen is not None and not rivals and not alike:
        beside = _slight(judge, chosen)
        chosen, more, alike, judge = _with_more(judge, naming, chosen, reach, matters, seed)
        beside += more
    explained = _explained(judge, chosen.effects, seed) if chosen else None
    effects = chosen.effects if chosen else ()
    by_effect, tables = _shapley(judge, chosen, _phases(recordings, bench))
    # of a set that explains too little for a name the stage is as open as any
    named = effects if explained and _tells(explained) else ()
    stage = _stage_left(judge, recordings, named, by_effect, where, matters)
    cells = _cells(tables, effects, stage) if missing else ()
    return Grade(
        verdict=_verdict(missing, explained, rivals, everywhere and not (beside or alike)),
        bench=bench,
        plain=plain,
        extended=predicted[effects] if effects else None,
        chosen=chosen,
        rivals=rivals,
        explained=explained,
        shares=by_effect,
        cells=cells,
        remainder=_remainder(judge, effects, cells, stage, where),
        size=size,
        relevant=matters,
        floor=float(judge.floor.sum() / bench.seen.sum()),
        beside=beside,
        alike=alike,
    )


def sized(grade: Grade, known: Sequence[Interval]) -> Grade:
    """The grade, partial at most where the recordings do not agree on how large an effect of the set is.

    A law that is not the true one may predict well with numbers that every recording wants different; and
    of so many laws one always has an interval that just leaves nought out.

    Parameters
    ----------
    grade
        Of a set.
    known
        Intervals of its numbers.
    """
    if grade.verdict != "named" or grade.chosen is None:
        return grade
    of = {one.key: one for one in known}
    unsure = tuple(
        trial.effect
        for trial in grade.chosen.refit.trials
        if trial.sizes and not any(_clear(of.get(f"{trial.effect}.{key}")) for key in trial.sizes)
    )
    return replace(grade, verdict="partial", unsure=unsure) if unsure else grade


def _open(one: Interval) -> bool:
    """Whether an interval ends where the range of its number does."""
    return one.open_low or one.open_high


def _beyond(folds: int) -> float:
    """As `_BEYOND`, of intervals by leaving out one of some folds at a time: these have Student's law."""
    most = 0.5 * (1.0 - CONFIDENCE)
    return float(student.isf(most / len(CATALOGUE), folds - 1) / student.isf(most, folds - 1))


def _clear(one: Interval | None, beyond: float = _BEYOND) -> bool:
    """Whether a size is beyond nought by more than the best of all effects is by chance."""
    if one is None:
        return False
    half = one.value - one.low if one.value > 0.0 else one.high - one.value
    return abs(one.value) > beyond * half


def _verdict(
    matters: bool,
    explained: Explained | None,
    rivals: tuple[Candidate, ...],
    everywhere: bool = True,
) -> Verdict:
    if not matters:
        return "consistent"
    if explained is None or not _tells(explained):
        return "unknown"
    if rivals:
        return "ambiguous"
    sure = explained.share >= NAMED and explained.low >= SURE
    return "named" if everywhere and sure else "partial"


def _tells(explained: Explained) -> bool:
    """Whether a share is enough to speak of, and not by the luck of a few recordings."""
    return explained.share >= PARTIAL and explained.low > 0.0


def _relevant(baseline: Baseline) -> float:
    """m: a fifth of the noise, and no less than what an error that stays makes of a prediction.

    It begins at a pose seen with one such error, and is compared with poses that are seen with others.
    """
    noise = baseline.noise
    if not noise.known:
        return RELEVANT
    place, turn = float(np.hypot(*noise.stays[:2])), float(noise.stays[2])
    stays = float(np.sqrt(2.0)) * max(place, turn * baseline.prepared.length)
    return max(RELEVANT_SHARE * float(noise.sigma[0]) * noise.floor, stays)


def _pools(
    naming: Naming | None, quick: bool
) -> Iterator[tuple[Naming | None, tuple[Candidate, ...]]]:
    """Sets that may be the answer: those that the competition leaves; if they fail, the likeliest.

    One that two held-out recordings spoke against, and that is as likely, is asked in every fold, and so are other laws of
    the same physics. A set is likelier than others by recordings that it was fitted to: it may fail on the rest where they hold.
    """
    if naming is None:
        yield None, ()
        return
    if naming.answers:
        least = naming.answers[0].score - _EQUAL_NATS
        near = tuple(
            one
            for one in naming.candidates
            if one not in naming.answers
            and ((_refuted(one) and one.score >= least) or _another_law(naming.answers[0], one))
        )
        yield naming, (*naming.answers, *near)[: _JUDGED[quick]]
    able = [one for one in naming.candidates if not one.duplicate and one.score > 0.0]
    likely = able[: _JUDGED[quick]]
    singles = [one for one in able if len(one.effects) == 1]
    # one that explains all but as much as the first, as well as scores are known, may be what it is
    close = [one for one in singles[:2] if one.score >= (1.0 - SCORE_SHARE) * singles[0].score]
    laws = [one for one in able if any(_another_law(of, one) for of in (*able[:1], *close))]
    more = (one for one in able if one in (*close, *laws) and one not in likely)
    yield replace(naming, answers=()), (*likely, *more)


def _predicted(
    bench: Bench, predicted: dict[Names, RollOut], pool: tuple[Candidate, ...]
) -> tuple[Candidate, ...]:
    """Those of a pool that can be simulated, predicted fold by fold."""
    plain = predicted[()].values

    def rolled(one: Candidate) -> dict[str, Any] | None:
        # where its search leaves what can be simulated: no answer, and no fault
        with suppress(ValueError, np.linalg.LinAlgError):
            found = rolled_out(bench, one.refit.model, one.refit.fits.values[0], plain)
            # a model cannot be sent from a copy, and is known here
            return {of.name: getattr(found, of.name) for of in fields(found) if of.name != "model"}
        return None

    new = {one.effects: one for one in pool if one.effects not in predicted}
    found = zip(new, shared(rolled, new.values()), strict=True)
    predicted.update(
        {names: RollOut(model=new[names].refit.model, **of) for names, of in found if of}
    )
    return tuple(one for one in pool if one.effects in predicted)


def _slight(judge: _Judge, whole: Candidate) -> Names:
    """Members that explain little of the whole error beside the others of a set."""
    found = []
    for member in whole.effects if len(whole.effects) > 1 else ():
        rest = tuple(name for name in whole.effects if name != member)
        judge.with_part(whole, rest)
        if judge.share(whole.effects) - judge.share(rest) < _MEMBER_SHARE:
            found.append(member)
    return tuple(found)


def _with_more(
    judge: _Judge,
    naming: Naming,
    chosen: Candidate,
    reach: float | None,
    matters: float,
    seed: int,
) -> tuple[Candidate, Names, tuple[Candidate, ...], _Judge]:
    """The set with further members, as long as what is left matters and one earns its place in every fold.

    Beside one that is so strong that all else is a twentieth of the error, that may be many times what matters. One
    that explains little of the whole is told apart, and is the last. So is one that another law does nearly as much as:
    of the same physics, of another that surely leaves more, or of any where each takes away nearly all that is left.
    """
    bench, predicted = judge.bench, judge.seen
    alike: tuple[Candidate, ...] = ()
    while _is_left(judge, chosen.effects, matters) and len(chosen.effects) < _LARGEST:
        offered = _predicted(bench, predicted, tuple(naming.further(chosen)))
        judge = _Judge(bench, predicted, _floor(bench, predicted, reach))
        able = [one for one in offered if _adds(judge, chosen, one, matters)]
        if not able:
            break
        best = min(able, key=lambda one: float(judge.sums(one.effects).sum()))
        same = [one for one in offered if one is not best and _adds_alike(judge, chosen, best, one)]
        others = [one for one in same if _physics(one) != _physics(best)]
        unsure = any(not _surely_worse(judge, best, one, seed) for one in others)
        if unsure and not _takes_nearly_all(judge, chosen, best):
            break
        own = tuple(name for name in best.effects if name not in chosen.effects)
        slight = judge.share(best.effects) - judge.share(chosen.effects) < PARTIAL
        chosen, alike = best, tuple(one for one in same if unsure or one not in others)
        if slight or same:
            return chosen, own if slight or others else (), alike, judge
    return chosen, (), alike, judge


def _adds(judge: _Judge, part: Candidate, whole: Candidate, matters: float) -> bool:
    """Whether a further member takes away much of what is left, by a sure amount that matters, and replaces none."""
    before, after = (_size_left(judge, one.effects) for one in (part, whole))
    if before**2 - after**2 < matters**2 or not _takes(judge, part.effects, whole.effects):
        return False
    (own,) = (one for one in whole.refit.trials if one.effect not in part.effects)
    of = {one.key: one for one in intervals_by_fold(judge.seen[whole.effects])}
    sizes = [of.get(f"{own.effect}.{key}") for key in own.sizes]
    # of so many effects one is beyond nought by chance, but none takes away nearly all by chance;
    # a size that runs to the end of its range is none
    if _takes_nearly_all(judge, part, whole):
        sure = any(one and one.parameter.low < one.value < one.parameter.high for one in sizes)
    else:
        beyond = _beyond(judge.bench.count)
        sure = any(one and not _open(one) and _clear(one, beyond) for one in sizes)
    if not sure:
        return False
    for member in part.effects:
        rest = tuple(name for name in whole.effects if name != member)
        judge.with_part(whole, rest)
        if not _takes(judge, rest, whole.effects):
            return False
    return True


def _takes_nearly_all(judge: _Judge, part: Candidate, whole: Candidate) -> bool:
    """Whether a further member takes away nearly all that a set leaves."""
    left, less = (float(np.sum(judge.sums(one.effects) - judge.floor)) for one in (part, whole))
    return less <= (1.0 - _NEARLY_ALL) * left


def _by_fold(judge: _Judge, part: Names, whole: Names) -> Floats:
    """(K,) by how much less a set leaves of each fold than another one, such as a part of it."""
    fall = judge.sums(part) - judge.sums(whole)
    return np.asarray(np.bincount(judge.bench.fold, weights=fall), dtype=np.float64)


def _takes(judge: _Judge, part: Names, whole: Names) -> bool:
    """Whether a set leaves much less than a part of it does, and not more in any fold."""
    folds = _by_fold(judge, part, whole)
    bar = _FURTHER_SHARE * float(np.sum(judge.sums(part) - judge.floor))
    return bool(folds.sum() >= bar and folds.min() >= -_FOLD_SHARE * judge.explainable)


def _adds_alike(judge: _Judge, part: Candidate, best: Candidate, other: Candidate) -> bool:
    """Whether another further member takes away as much, of whatever size: then what is left has no name yet."""
    if _holds(other, best) or _holds(best, other) or not _takes(judge, part.effects, other.effects):
        return False
    before, least, own = (float(judge.sums(one.effects).sum()) for one in (part, best, other))
    return before - own >= _ALIKE_SHARE * (before - least)


def _is_left(judge: _Judge, names: Names, matters: float) -> bool:
    """Whether a set leaves what matters, and more than noise makes."""
    left = max(float(np.sum(judge.sums(names) - judge.floor)), 1e-12)
    return _size_left(judge, names) >= matters and left > judge.chance


def _floor(bench: Bench, predicted: Mapping[Names, RollOut], reach: float | None) -> Floats:
    """(R,) sums of squares that free hidden inputs leave; never more than a judged set leaves."""
    counts = bench.seen.sum(axis=(1, 2))
    noise = counts * (1.0 + predicted[()].start_squares)
    left = 1.0 if reach is None else reach / bench.baseline.noise.floor
    floor = noise + counts * (left**2 - 1.0)
    least = min(float(one.squares.sum()) for one in predicted.values())
    if float(floor.sum()) <= least:
        return np.asarray(floor)
    # inputs that are constant in a window leave more than a set does: then they are no floor, and the
    # noise is; but a set that is down to the noise is not held to be above it
    floor = noise if least > _DOWN_TO * float(noise.sum()) else floor
    return np.asarray(floor * min(1.0, _BELOW * least / float(floor.sum())))


def _refuted(one: Candidate) -> bool:
    return one.rejected is not None and one.rejected.ground is Ground.HELD_OUT_WORSE


_Answer = tuple[Candidate | None, tuple[Candidate, ...], bool]


def _in_open_forms(
    naming: Naming, pool: tuple[Candidate, ...], judge: _Judge, reach: float | None, seed: int
) -> tuple[_Answer, dict[Names, Candidate]]:
    """As `_answer`, with no law put aside before each of its forms that the fits leave open was asked.

    Returns the sets as well that predict better in another form.
    """
    turned: dict[Names, Candidate] = {}
    asked: set[Names] = set()
    while True:
        pool = tuple(turned.get(one.effects, one) for one in pool)
        found = _answer(judge, exchanged(naming, turned), pool, seed)
        kept = [set(one.effects) for one in (found[0], *found[1]) if one is not None]
        aside = [
            one
            for one in pool
            if one.effects not in asked
            and not any(set(one.effects) <= own or own <= set(one.effects) for own in kept)
        ]
        better: dict[Names, Candidate] = {}
        for one in aside:
            asked.add(one.effects)
            for form in other_forms(one, naming):
                tried: dict[Names, RollOut] = {(): judge.seen[()]}
                least = float(judge.sums(one.effects).sum())
                done = _predicted(judge.bench, tried, (form,))
                if done and float(tried[form.effects].squares.sum()) < least:
                    judge.seen[form.effects] = tried[form.effects]
                    better[form.effects] = form
        if not better:
            return found, turned
        turned |= better
        judge = _Judge(judge.bench, judge.seen, _floor(judge.bench, judge.seen, reach))


def _answer(
    judge: _Judge, naming: Naming, pool: tuple[Candidate, ...], seed: int
) -> tuple[Candidate | None, tuple[Candidate, ...], bool]:
    """The set that explains the recordings, those that do so equally, and whether it helps every fold."""
    if naming.answers:
        chosen = _earning(judge, naming, pool[0], 0.0)
        if chosen is None:
            return None, tuple(one for one in naming.answers[1:] if not _holds(one, pool[0])), True
        others = [one for one in naming.answers[1:] if not _holds(one, chosen)]
        rivals = [
            one
            for one in others
            if _law_open(judge, chosen, one) or not _behind(judge, chosen, one, seed)
        ]
        rivals += [one for one in pool[len(naming.answers) :] if _equal(judge, chosen, one, seed)]
        return chosen, tuple(rivals), True
    chosen, everywhere = _holding(judge, naming, pool, seed)
    if chosen is None:
        return None, (), True
    rivals = [one for one in pool if _equal(judge, chosen, one, seed)]
    # what all of them share is sure; which of the rest is not, and stays a remainder
    others = [one for one in rivals if not _another_law(chosen, one)]
    core = set(chosen.effects).intersection(*(one.effects for one in others))
    common = _listed(naming, tuple(sorted(core))) if others else None
    if common is not None:
        judge.with_part(chosen, common.effects)
        if judge.share(common.effects) >= PARTIAL and judge.carries(common.effects):
            return common, (), False
    return chosen, tuple(rivals), everywhere


def _holding(
    judge: _Judge, naming: Naming, pool: tuple[Candidate, ...], seed: int
) -> tuple[Candidate | None, bool]:
    """A set that explains something out of fold, of the likeliest, and whether it helps in every fold.

    A law that is not quite the true one may be the best where it was fitted, and fail on the one recording
    that told a number of it, while another holds. Where none helps in every fold, the simplest that helps on
    the whole explains a part.
    """
    enough = (1.0 - _MEMBER_SHARE) * pool[0].refit.gain
    simple = min(
        (one for one in pool if one.refit.gain >= enough), key=lambda one: len(one.effects)
    )
    near = [one for one in pool if one.refit.gain >= NAMED * pool[0].refit.gain]
    first = None
    for one in (simple, *near):
        earned = _earning(judge, naming, one, _MEMBER_SHARE)
        first = first or earned
        if earned is not None and _tells(_explained(judge, earned.effects, seed)):
            return earned, True
    for one in sorted(near, key=lambda one: len(one.effects)):
        earned = _earning(judge, naming, one, _MEMBER_SHARE, fold_share=np.inf)
        if earned is not None and _tells(_explained(judge, earned.effects, seed)):
            return earned, False
    for one in sorted(near, key=lambda one: len(one.effects)):
        # one effect that explains most of the whole tells much, though of a push or two it gets the turn wrong; and so
        # does a set that explains as much as one that is named, though a push that needs no effect is predicted worse,
        # or one that surely explains most of the whole, in no fold the wrong way and not in a single one
        explained = _explained(judge, one.effects, seed)
        single = len(one.effects) == 1 and judge.lessens(one.effects)
        most = single and explained.share >= _MOST_OF_ALL and _tells(explained)
        folds, least = _by_fold(judge, (), one.effects), -_FOLD_SHARE * judge.explainable
        even = folds.min() >= least and folds.max() <= _MOST_OF_ALL * folds.sum()
        throughout = explained.low >= _MOST_OF_ALL and even
        if most or throughout or (explained.share >= NAMED and explained.low >= SURE):
            return one, False
    return first, True


def _listed(naming: Naming, names: Names) -> Candidate | None:
    return next((one for one in naming.candidates if names and one.effects == names), None)


def _earning(
    judge: _Judge,
    naming: Naming,
    whole: Candidate,
    least: float,
    *,
    fold_share: float = _FOLD_SHARE,
) -> Candidate | None:
    """The set without members that do not earn their place in every fold; None if none does, or carries over."""
    for member in whole.effects:
        rest = tuple(name for name in whole.effects if name != member)
        judge.with_part(whole, rest)
        folds, bar = _by_fold(judge, rest, whole.effects), judge.explainable
        if folds.sum() > least * bar and folds.min() >= -fold_share * bar:
            continue
        smaller = _listed(naming, rest)
        if smaller is not None:
            return _earning(judge, naming, smaller, least, fold_share=fold_share)
        if not rest:
            return None
    return whole if judge.carries(whole.effects) else None


def _only_law(judge: _Judge, chosen: Candidate, rival: Candidate, seed: int) -> bool:
    """Whether a set that explains as much leaves open what law it is, not what it is a law of.

    So do laws of the same physics, alone or beside others. And of several hundred sets of two effects some do by chance
    what one does: of what needs more effects and surely leaves no less, the one effect is told.
    """
    if _physics(chosen) <= _physics(rival):
        return True
    more = len(rival.effects) > len(chosen.effects)
    return more and not _surely_worse(judge, rival, chosen, seed)


def _another_law(chosen: Candidate, other: Candidate) -> bool:
    """Whether another set differs only in the laws that it takes for the same physics, and is nearly as likely.

    No law is quite the true one: which of two is nearer on these pushes does not tell which it is.
    """
    if other.effects == chosen.effects or len(other.effects) != len(chosen.effects):
        return False
    near = other.score >= (1.0 - _MEMBER_SHARE) * chosen.score
    return near and not other.duplicate and _physics(other) == _physics(chosen)


def _law_open(judge: _Judge, chosen: Candidate, other: Candidate) -> bool:
    """Whether a set with other laws of the same physics explains as much, up to what one law takes up of another's form."""
    least = judge.share(chosen.effects) - _MEMBER_SHARE
    return _another_law(chosen, other) and judge.share(other.effects) > least


def _physics(one: Candidate) -> set[str]:
    """Pieces of physics that a set holds laws of."""
    return {family_of(name) for name in one.effects}


def _holds(general: Candidate, special: Candidate) -> bool:
    """Whether a set holds all laws of another one, each by itself or as a special case of its own."""
    each = {SPECIAL_CASE.get(name, name) for name in general.effects}
    return set(special.effects) <= each.union(general.effects)


def _equal(judge: _Judge, chosen: Candidate, rival: Candidate, seed: int) -> bool:
    """Whether another set, neither part nor whole of the chosen one, explains as much, and carries over."""
    if _holds(rival, chosen) or set(rival.effects) <= set(chosen.effects):
        return False
    if not judge.carries(rival.effects):
        return False
    if _law_open(judge, chosen, rival):
        return True
    if _behind(judge, chosen, rival, seed):
        return False
    if judge.share(rival.effects) < _EQUAL_SHARE * judge.share(chosen.effects):
        return False
    excess = float(judge.sums(chosen.effects).sum() / judge.floor.sum())
    if chosen.score - rival.score <= _EQUAL_NATS * max(excess, 1.0):
        return True
    return excess > _TEMPERED and not _surely_worse(judge, chosen, rival, seed)


def _behind(judge: _Judge, chosen: Candidate, rival: Candidate, seed: int) -> bool:
    """Whether another set is no likelier where both were fitted, and surely leaves much more where neither was.

    Of two laws that are alike where a fit may bend them, other recordings tell; but they are no witness against a law
    that was the likelier one, as one recording may be far off for a number that no other tells. For the same reason
    the chosen one must leave next to nothing beside what the other leaves, and that more than noise makes; but of a
    law of other physics that is no likelier anywhere, what noise makes in both alike is no excuse.
    """
    if rival.score - chosen.score > SCORE_SHARE * chosen.score:
        return False
    own, other = (judge.sums(one.effects) for one in (chosen, rival))
    left, more = (max(float(np.sum(of - judge.floor)), 0.0) for of in (own, other))
    excess = max(float(own.sum() / judge.floor.sum()), 1.0)
    if 0.5 * float(np.sum(other - own)) <= _EQUAL_NATS * excess:
        return False
    within = more <= judge.chance and left <= judge.chance
    if within and chosen.score >= rival.score and _physics(chosen) != _physics(rival):
        return _surely_worse(judge, chosen, rival, seed)
    if more <= judge.chance or left > (1.0 - _NEARLY_ALL) * more:
        return False
    return _surely_worse(judge, chosen, rival, seed)


def _surely_worse(judge: _Judge, chosen: Candidate, rival: Candidate, seed: int) -> bool:
    """Whether another set predicts worse, of whatever recordings there might have been."""
    behind = judge.sums(rival.effects) - judge.sums(chosen.effects)
    drawn = _resampled(len(behind), seed) @ behind
    return bool(np.quantile(drawn, 0.5 * (1.0 - _INTERVAL)) > 0.0)


def _resampled(count: int, seed: int) -> Floats:
    """(B, R) weights of recordings, of Rubin's Bayesian bootstrap.

    Recordings drawn with replacement would leave out, in a tenth of the draws, the two of eight that push
    on the edge that is wrong, and a share of nothing is no number.
    """
    return np.random.default_rng([seed, 5]).dirichlet(np.ones(count), _RESAMPLED)


def _explained(judge: _Judge, names: Names, seed: int) -> Explained:
    """Share of a set, with its interval by resampling recordings."""
    fall, whole = judge.sums(()) - judge.sums(names), judge.sums(()) - judge.floor
    drawn = _resampled(len(fall), seed)
    shares = (drawn @ fall) / np.maximum(drawn @ whole, 1e-12)
    tail = 0.5 * (1.0 - _INTERVAL)
    low, high = np.quantile(shares, [tail, 1.0 - tail])
    share = judge.share(names)
    return Explained(
        share=share,
        low=min(float(low), share),
        high=max(float(min(high, 1.0)), share),
        folds=judge.bench.count,
    )


def _phases(recordings: RecordingSet, bench: Bench) -> Ints:
    """(R, T) index into the phases; a frame of no window belongs to the one before it."""
    codes = np.full(bench.still.shape, -1)
    for cut in cuts_of(recordings, bench.prepared):
        codes[cut.recording, cut.first : cut.last] = _PHASES.index(cut.phase)
    codes[:, 0] = np.maximum(codes[:, 0], 0)
    frames = np.arange(len(codes[0]))
    last = np.maximum.accumulate(np.where(codes >= 0, frames, 0), axis=1)
    return np.asarray(np.take_along_axis(codes, last, axis=1))


def _shapley(
    judge: _Judge, chosen: Candidate | None, phases: Ints
) -> tuple[dict[str, float], dict[str, Floats]]:
    """Shares of the effects, and shares (P, 3) by phase and component of them and of the rest ("").

    An effect's share is its mean fall of the error over all orders in which effects may be added, so
    that the shares add up, whatever they overlap.
    """
    effects = chosen.effects if chosen else ()
    whole, count = judge.explainable, len(effects)
    parts = [part for n in range(count) for part in itertools.combinations(effects, n)]
    for part in parts:
        if chosen is not None:
            judge.with_part(chosen, part)
    tables = {part: _table(judge.seen[part].squares, phases) for part in (*parts, effects)}
    each: dict[str, Floats] = {}
    for effect in effects:
        others = [part for part in parts if effect not in part]
        each[effect] = (
            sum(
                (
                    factorial(len(part))
                    * factorial(count - len(part) - 1)
                    / factorial(count)
                    * (tables[part] - tables[tuple(sorted((*part, effect)))])
                    for part in others
                ),
                np.zeros((len(_PHASES), 3)),
            )
            / whole
        )
    counts = judge.bench.seen.sum(axis=(1, 2))
    spread = np.broadcast_to((judge.floor / counts)[:, None, None], judge.bench.seen.shape)
    each[""] = (tables[effects] - _table(np.where(judge.bench.seen, spread, 0.0), phases)) / whole
    return {effect: float(each[effect].sum()) for effect in effects}, each


def _table(squares: Floats, phases: Ints) -> Floats:
    """(P, 3) sums of squares (R, T, 3) by phase and component."""
    return np.stack([squares[phases == code].sum(axis=0) for code in range(len(_PHASES))])


def _mostly_sway(bench: Bench, left: float) -> bool:
    """Whether most of a sum of squares beyond the noise is that of a sway."""
    swaying = bench.baseline.noise.swaying * float(bench.seen.sum())
    return swaying > max(_MOSTLY * left, 0.0)


def _cells(
    tables: Mapping[str, Floats], effects: Names, unnamed: Channel | None
) -> tuple[Cell, ...]:
    return tuple(
        Cell(
            effect=effect,
            stage=stage_of(effect).name if effect else (unnamed or ""),
            phase=phase,
            component=component,
            share=float(table[k, axis]),
        )
        for effect, table in tables.items()
        for k, phase in enumerate(_PHASES)
        for axis, component in enumerate(_COMPONENTS)
        if table[k, axis] != 0.0
    )


def _stage_left(
    judge: _Judge,
    recordings: RecordingSet,
    names: Names,
    shares: Mapping[str, float],
    where: Located | None,
    matters: float,
) -> Channel | None:
    """The stage whose hidden inputs explain what a set leaves, which may be one that an effect of it belongs to.

    A law of another form than the catalogue's leaves something at its own stage. Where inputs explain nothing more, that is
    the stage of the effect that explains most, or else the one that explains most of the plain model's error.

    That of the image where most of what is left is a sway that frames at rest show: no tip moves a part then,
    and no input that is constant in a window follows it.
    """
    if where is None:
        return None
    if _mostly_sway(judge.bench, float((judge.sums(names) - judge.floor).sum())):
        return "observation"
    bench, of = judge.bench, judge.seen[names]
    found: dict[Channel, float] = {}
    if _is_left(judge, names, matters):
        rows = np.sort(np.argsort(judge.floor - judge.sums(names))[:_LOOKED])
        some = replace(recordings, recordings=tuple(recordings.recordings[r] for r in rows))
        own = some_of(bench.prepared, rows)
        found = stages(some, own, of.model, of.values, bench.baseline.noise)
    largest = stage_of(max(names, key=lambda name: shares[name])).name if names else ""
    best = max(found.values(), default=0.0)
    if best > _EQUAL_NATS:
        near = [one for one, worth in found.items() if worth >= best - _EQUAL_NATS]
        # of those that explain as much the set's own
        return max(near, key=lambda one: (one == largest, found[one]))
    if largest:
        return next(channel for channel in CHANNELS if channel == largest)
    return where.channels[0].channel


def _size_left(judge: _Judge, names: Names) -> float:
    """m: what a set leaves beyond the floor, of place or of turn at the part's size."""
    place, turn = _left(judge, names)
    return max(place, turn * judge.bench.prepared.length)


def _left(judge: _Judge, names: Names) -> tuple[float, float]:
    """Root mean squares in m and rad of what a set leaves beyond the floor."""
    noise, squares = judge.bench.baseline.noise, judge.seen[names].squares
    counts = np.maximum(judge.bench.seen.sum(axis=(0, 1)), 1)
    beyond = squares.sum(axis=(0, 1)) - float(judge.floor.sum()) * counts / counts.sum()
    means = np.maximum([beyond[:2].sum() / counts[0], beyond[2] / counts[2]], 0.0)
    place, turn = np.sqrt(means) * noise.sigma[[0, 2]] * noise.floor
    return float(place), float(turn)


def _remainder(
    judge: _Judge,
    names: Names,
    cells: tuple[Cell, ...],
    stage: Channel | None,
    where: Located | None,
) -> Remainder:
    beyond = np.maximum(judge.sums(names) - judge.floor, 0.0)
    counts = judge.bench.seen.sum(axis=(1, 2))
    each = np.sqrt(beyond / counts)
    place, turn = _left(judge, names)
    rest = [cell for cell in cells if not cell.effect]
    worst = max(rest, key=lambda cell: cell.share, default=None)
    component = worst.component if worst else None
    follows = where.covariates if where else ()
    return Remainder(
        metres=place,
        radians=turn,
        sigma=float(
            np.sqrt(max(float(np.sum(judge.sums(names) - judge.floor)), 0.0) / counts.sum())
        ),
        stage=stage if worst else None,
        component=component,
        phase=worst.phase if worst else None,
        grows_with=next((one.covariate for one in follows if one.component == component), ""),
        spread=float(each.std() / each.mean()) if np.any(each) else 0.0,
    )
