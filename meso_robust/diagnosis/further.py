"""Further effects beside a set that leaves what matters, however little of the whole that is."""

from __future__ import annotations

import numpy as np

from meso_robust.diagnosis.candidates import Candidate, Naming
from meso_robust.diagnosis.folds import intervals_by_fold
from meso_robust.diagnosis.judge import (
    FOLD_SHARE,
    PARTIAL,
    Judge,
    Names,
    judge_of,
    with_predictions,
)
from meso_robust.diagnosis.rivals import NEARLY_ALL, holds, physics
from meso_robust.diagnosis.sizes import beyond_by_folds, clear, is_open

_LARGEST = 3  # effects of a set that further ones were added to
# of what a set leaves, that a further member must take away
_FURTHER_SHARE = 0.2
_NOT_NOUGHT = 0.25  # half widths of its interval, that the size of a further member must be beyond nought at least
_ALIKE_SHARE = 0.8  # of what the best further member takes away, from which on another is as good


def with_more(
    judge: Judge,
    naming: Naming,
    chosen: Candidate,
    reach: float | None,
    matters: float,
    seed: int,
) -> tuple[Candidate, Names, tuple[Candidate, ...], Judge]:
    """The set with further members, as long as what is left matters and one earns its place in every fold.

    Beside one that is so strong that all else is a twentieth of the error, that may be many times what matters. One
    that explains little of the whole is told apart, and is the last. So is one that another law does nearly as much as:
    of the same physics, of another that surely leaves more, or of any where each takes away nearly all that is left.
    """
    bench, predicted = judge.bench, judge.seen
    alike: tuple[Candidate, ...] = ()
    while judge.is_left(chosen.effects, matters) and len(chosen.effects) < _LARGEST:
        offered = with_predictions(bench, predicted, tuple(naming.further(chosen)))
        judge = judge_of(bench, predicted, reach)
        able = [one for one in offered if _adds(judge, chosen, one, matters)]
        if not able:
            break
        best = min(able, key=lambda one: float(judge.sums(one.effects).sum()))
        same = [one for one in offered if one is not best and _adds_alike(judge, chosen, best, one)]
        others = [one for one in same if physics(one) != physics(best)]
        unsure = any(not judge.surely_worse(best.effects, one.effects, seed) for one in others)
        if unsure and not _takes_nearly_all(judge, chosen, best):
            break
        own = tuple(name for name in best.effects if name not in chosen.effects)
        slight = judge.share(best.effects) - judge.share(chosen.effects) < PARTIAL
        chosen, alike = best, tuple(one for one in same if unsure or one not in others)
        if slight or same:
            return chosen, own if slight or others else (), alike, judge
    return chosen, (), alike, judge


def with_one_more(
    judge: Judge, laws: tuple[Candidate, ...], longer: tuple[Candidate, ...], matters: float
) -> Candidate | None:
    """Of longer sets that explain as much as several laws of one physics, that which leaves least and adds to a law; None if none does."""
    able = (
        whole
        for whole in longer
        for law in laws
        if set(law.effects) < set(whole.effects)
        and len(whole.effects) == len(law.effects) + 1
        and _adds(judge, law, whole, matters)
    )
    return min(able, key=lambda one: float(judge.sums(one.effects).sum()), default=None)


def _adds(judge: Judge, part: Candidate, whole: Candidate, matters: float) -> bool:
    """Whether a further member takes away much of what is left, by a sure amount that matters, and replaces none."""
    before, after = (np.square(judge.left(one.effects)) for one in (part, whole))
    less = (before - after) * [
        1.0,
        judge.bench.prepared.length**2,
    ]  # of place, and of turn at the part's size
    if less.max() < matters**2 or not _takes(judge, part.effects, whole.effects):
        return False
    (own,) = (one for one in whole.refit.trials if one.effect not in part.effects)
    rolled = judge.seen[whole.effects]
    # what one push alone tells of was not predicted, but fitted
    if any(effect == own.effect for effect, _ in rolled.alone):
        return False
    of = {one.key: one for one in intervals_by_fold(rolled)}
    sizes = [of.get(f"{own.effect}.{key}") for key in own.sizes]
    # of so many effects one is beyond nought by chance, but none takes away nearly all by chance; a size that runs to
    # the end of its range is none, nor is one that is nought as far as the folds tell: the rest was fitted again
    if _takes_nearly_all(judge, part, whole):
        sure = any(
            one and one.parameter.low < one.value < one.parameter.high and clear(one, _NOT_NOUGHT)
            for one in sizes
        )
    else:
        beyond = beyond_by_folds(judge.bench.count)
        sure = any(one and not is_open(one) and clear(one, beyond) for one in sizes)
    if not sure:
        return False
    for member in part.effects:
        rest = tuple(name for name in whole.effects if name != member)
        judge.with_part(whole, rest)
        if not _takes(judge, rest, whole.effects):
            return False
    return True


def _takes_nearly_all(judge: Judge, part: Candidate, whole: Candidate) -> bool:
    """Whether a further member takes away nearly all that a set leaves."""
    left, less = (float(np.sum(judge.sums(one.effects) - judge.floor)) for one in (part, whole))
    return less <= (1.0 - NEARLY_ALL) * left


def _takes(judge: Judge, part: Names, whole: Names) -> bool:
    """Whether a set leaves much less than a part of it does, and not more in any fold."""
    folds = judge.by_fold(part, whole)
    bar = _FURTHER_SHARE * float(np.sum(judge.sums(part) - judge.floor))
    return bool(folds.sum() >= bar and folds.min() >= -FOLD_SHARE * judge.explainable)


def _adds_alike(judge: Judge, part: Candidate, best: Candidate, other: Candidate) -> bool:
    """Whether another further member takes away as much, of whatever size: then what is left has no name yet."""
    if holds(other, best) or holds(best, other) or not _takes(judge, part.effects, other.effects):
        return False
    before, least, own = (float(judge.sums(one.effects).sum()) for one in (part, best, other))
    return before - own >= _ALIKE_SHARE * (before - least)
