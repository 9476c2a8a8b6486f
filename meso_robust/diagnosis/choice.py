"""Which set of effects is the answer: of the likeliest, one that predicts recordings left out of its fit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from meso_robust.diagnosis.candidates import SCORE_SHARE, Candidate, Naming, exchanged, other_forms
from meso_robust.diagnosis.folds import RollOut, intervals_by_fold
from meso_robust.diagnosis.judge import (
    FOLD_SHARE,
    MEMBER_SHARE,
    NAMED,
    SURE,
    Judge,
    Names,
    judge_of,
    with_predictions,
)
from meso_robust.diagnosis.rejection import Ground
from meso_robust.diagnosis.rivals import EQUAL_NATS, another_law, behind, equal, holds, law_open
from meso_robust.diagnosis.sizes import clear

_JUDGED = {True: 4, False: 8}  # sets that are predicted fold by fold, if quick and if not
_FEW = 6  # recordings, of fewer of which a set that is not the likeliest may be the best by luck
_MOST_OF_ALL = 0.5  # of the explainable error, that one effect explains which fails to carry over


def pools(
    naming: Naming | None, quick: bool
) -> Iterator[tuple[Naming | None, tuple[Candidate, ...]]]:
    """Sets that may be the answer: those that the competition leaves; if they fail, the likeliest, and then the next ones.

    One that two held-out recordings spoke against, and that is as likely, is asked in every fold, and so are other laws of
    the same physics. A set is likelier than others by recordings that it was fitted to: it may fail on the rest where they hold.
    """
    if naming is None:
        yield None, ()
        return
    if naming.answers:
        least = naming.answers[0].score - EQUAL_NATS
        given = {one.effects for one in naming.answers}
        near = tuple(
            one
            for one in naming.candidates
            if one.effects not in given
            and ((_refuted(one) and one.score >= least) or another_law(naming.answers[0], one))
        )
        yield naming, (*naming.answers, *near[: max(_JUDGED[quick] - len(naming.answers), 0)])
    able = [one for one in naming.candidates if not one.duplicate and one.score > 0.0]
    likely = able[: _JUDGED[quick]]
    singles = [one for one in able if len(one.effects) == 1]
    # one that explains all but as much as the first, as well as scores are known, may be what it is
    close = [one for one in singles[:2] if one.score >= (1.0 - SCORE_SHARE) * singles[0].score]
    laws = [one for one in able if any(another_law(of, one) for of in (*able[:1], *close))]
    more = [one for one in able if one in (*close, *laws) and one not in likely]
    yield replace(naming, answers=()), (*likely, *more)
    yield (
        replace(naming, answers=()),
        tuple(one for one in able if one not in (*likely, *more))[: len(likely)],
    )


def _refuted(one: Candidate) -> bool:
    return one.rejected is not None and one.rejected.ground is Ground.HELD_OUT_WORSE


_Answer = tuple[Candidate | None, tuple[Candidate, ...], bool]


def in_open_forms(
    naming: Naming, pool: tuple[Candidate, ...], judge: Judge, reach: float | None, seed: int
) -> tuple[_Answer, dict[Names, Candidate]]:
    """The answer of a pool, with no law put aside before each of its forms that the fits leave open was asked.

    Returns the chosen set, if any, its rivals and whether it helps in every fold; and the sets that predict better in another form.
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
                done = with_predictions(judge.bench, tried, (form,))
                if done and float(tried[form.effects].squares.sum()) < least:
                    judge.seen[form.effects] = tried[form.effects]
                    better[form.effects] = form
        if not better:
            return found, turned
        turned |= better
        judge = judge_of(judge.bench, judge.seen, reach)


def _answer(
    judge: Judge, naming: Naming, pool: tuple[Candidate, ...], seed: int
) -> tuple[Candidate | None, tuple[Candidate, ...], bool]:
    """The set that explains the recordings, those that do so equally, and whether it helps every fold."""
    left = {one.effects for one in naming.answers}  # by the competition
    if left:
        chosen = earning(judge, naming, pool[0], 0.0)
        others = [
            one for one in pool[1:] if one.effects in left and not holds(one, chosen or pool[0])
        ]
        if chosen is None:
            return None, tuple(others), True
        rivals = [
            one
            for one in others
            if law_open(judge, chosen, one) or not behind(judge, chosen, one, seed)
        ]
        rivals += [
            one for one in pool if one.effects not in left and equal(judge, chosen, one, seed)
        ]
        return chosen, tuple(rivals), True
    chosen, everywhere = _holding(judge, naming, pool, seed)
    if chosen is None:
        return None, (), True
    if len(judge.bench.fold) < _FEW and pool[0].score - chosen.score > EQUAL_NATS:
        everywhere = False
    rivals = [one for one in pool if equal(judge, chosen, one, seed)]
    return chosen, tuple(rivals), everywhere


def _holding(
    judge: Judge, naming: Naming, pool: tuple[Candidate, ...], seed: int
) -> tuple[Candidate | None, bool]:
    """A set that explains something out of fold, of the likeliest, and whether it helps in every fold.

    A law that is not quite the true one may be the best where it was fitted, and fail on the one recording
    that told a number of it, while another holds. Where none helps in every fold, the simplest that helps on
    the whole explains a part.
    """
    enough = (1.0 - MEMBER_SHARE) * pool[0].refit.gain
    simple = min(
        (one for one in pool if one.refit.gain >= enough), key=lambda one: len(one.effects)
    )
    near = [one for one in pool if one.refit.gain >= NAMED * pool[0].refit.gain]
    first = None
    for one in (simple, *near):
        earned = earning(judge, naming, one, MEMBER_SHARE)
        first = first or earned
        if earned is not None and judge.explained(earned.effects, seed).tells:
            return earned, True
    for one in sorted(near, key=lambda one: len(one.effects)):
        earned = earning(judge, naming, one, MEMBER_SHARE, fold_share=np.inf)
        if earned is not None and judge.explained(earned.effects, seed).tells:
            return earned, False
    for one in sorted(near, key=lambda one: len(one.effects)):
        # one effect that explains most of the whole tells much, though of a push or two it gets the turn wrong; and so
        # does a set that explains as much as one that is named, though a push that needs no effect is predicted worse,
        # or one that surely explains most of the whole, in no fold the wrong way and not in a single one
        explained = judge.explained(one.effects, seed)
        single = len(one.effects) == 1 and judge.lessens(one.effects)
        most = single and explained.share >= _MOST_OF_ALL and explained.tells
        folds, least = judge.by_fold((), one.effects), -FOLD_SHARE * judge.explainable
        even = folds.min() >= least and folds.max() <= _MOST_OF_ALL * folds.sum()
        throughout = explained.low >= _MOST_OF_ALL and even
        if most or throughout or (explained.share >= NAMED and explained.low >= SURE):
            return one, False
    return first, True


def _listed(naming: Naming, names: Names) -> Candidate | None:
    return next((one for one in naming.candidates if names and one.effects == names), None)


def earning(
    judge: Judge,
    naming: Naming,
    whole: Candidate,
    least: float,
    *,
    fold_share: float = FOLD_SHARE,
) -> Candidate | None:
    """The set without members that do not earn their place in every fold; None if none does, or carries over.

    One that explains little must have a size that the folds agree on: a little is what any law takes away.
    """
    for member in whole.effects:
        rest = tuple(name for name in whole.effects if name != member)
        judge.with_part(whole, rest)
        folds, bar = judge.by_fold(rest, whole.effects), judge.explainable
        helps = folds.sum() > least * bar and folds.min() >= -fold_share * bar
        if helps and (folds.sum() > MEMBER_SHARE * bar or _sized(judge, whole, member)):
            continue
        smaller = _listed(naming, rest)
        if smaller is not None:
            return earning(judge, naming, smaller, least, fold_share=fold_share)
        if not rest:
            return None
    return whole if judge.carries(whole.effects) else None


def _sized(judge: Judge, whole: Candidate, member: str) -> bool:
    """Whether the folds agree that a member of a set has a size, or it is told by a place and has none."""
    if judge.bench.count == 1:
        return True
    (own,) = (one for one in whole.refit.trials if one.effect == member)
    keys = {f"{member}.{key}" for key in own.sizes}
    sizes = [one for one in intervals_by_fold(judge.seen[whole.effects]) if one.key in keys]
    return not keys or any(clear(one) for one in sizes)


def slight(judge: Judge, whole: Candidate) -> Names:
    """Members that explain little of the whole error beside the others of a set."""
    found = []
    for member in whole.effects if len(whole.effects) > 1 else ():
        rest = tuple(name for name in whole.effects if name != member)
        judge.with_part(whole, rest)
        if judge.share(whole.effects) - judge.share(rest) < MEMBER_SHARE:
            found.append(member)
    return tuple(found)
