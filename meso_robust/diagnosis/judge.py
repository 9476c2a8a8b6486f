"""What sets of effects are worth, in roll-outs of recordings that a fit has not seen.

What counts is the share of the *explainable* error: the plain model's, less what hidden inputs, free from
window to window, would leave. Shares are those of means of squares, so they add up.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from meso_robust.copies import shared
from meso_robust.diagnosis.candidates import Candidate
from meso_robust.diagnosis.folds import Bench, RollOut, rolled_out
from meso_robust.diagnosis.signatures import extended
from meso_robust.types import Floats

NAMED, PARTIAL = 0.8, 0.2
"""Shares of the explainable error from which on a set is named, and partly named."""
SURE = 0.7
"""Share from which on the lower end of the interval of a named set is: with another draw of recordings a
law that makes half of the motion alike explains as much."""
# of the explainable error, that a member must explain: less is what any law mops up of another's form
MEMBER_SHARE = 0.05
# of it, by which a member may raise the error of one fold: a few pushes tell no more
FOLD_SHARE = 0.02
CHANCE = 3.0  # standard deviations of noise, that the explainable error must be beyond
_BELOW = 1.0 - 1e-12  # of what a set leaves, so that rounding does not put a floor above it
_DOWN_TO = 1.2  # mean square over that of noise and starts, up to which a set is down to the noise
_RESAMPLED = 2000
INTERVAL = 0.9

Names = tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Explained:
    """Share of the explainable error that a set explains, with an interval over recordings."""

    share: float
    low: float
    high: float
    folds: int

    @property
    def tells(self) -> bool:
        """Whether it is enough to speak of, and not by the luck of a few recordings."""
        return self.share >= PARTIAL and self.low > 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Judge:
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
        return CHANCE * float(np.sqrt(2.0 * self.bench.seen.sum()))

    def share(self, names: Names) -> float:
        """Of the explainable error, that a set explains."""
        share = float(np.sum(self.sums(()) - self.sums(names))) / self.explainable
        return min(share, 1.0)  # more than all is rounding: the floor lies below every set

    def by_fold(self, part: Names, whole: Names) -> Floats:
        """(K,) by how much less a set leaves of each fold than another one, such as a part of it."""
        fall = self.sums(part) - self.sums(whole)
        return np.asarray(np.bincount(self.bench.fold, weights=fall), dtype=np.float64)

    def surely_worse(self, chosen: Names, rival: Names, seed: int) -> bool:
        """Whether another set predicts worse, of whatever recordings there might have been."""
        behind = self.sums(rival) - self.sums(chosen)
        drawn = resampled(len(behind), seed) @ behind
        return bool(np.quantile(drawn, 0.5 * (1.0 - INTERVAL)) > 0.0)

    def explained(self, names: Names, seed: int) -> Explained:
        """Share of a set, with its interval by resampling recordings."""
        fall, whole = self.sums(()) - self.sums(names), self.sums(()) - self.floor
        return explained(fall, whole, self.share(names), self.bench.count, seed)

    def left(self, names: Names) -> tuple[float, float]:
        """Root mean squares in m and rad of what a set leaves beyond the floor."""
        noise, squares = self.bench.baseline.noise, self.seen[names].squares
        counts = np.maximum(self.bench.seen.sum(axis=(0, 1)), 1)
        beyond = squares.sum(axis=(0, 1)) - float(self.floor.sum()) * counts / counts.sum()
        means = np.maximum([beyond[:2].sum() / counts[0], beyond[2] / counts[2]], 0.0)
        place, turn = np.sqrt(means) * noise.sigma[[0, 2]] * noise.floor
        return float(place), float(turn)

    def size_left(self, names: Names) -> float:
        """m: what a set leaves beyond the floor, of place or of turn at the part's size."""
        place, turn = self.left(names)
        return max(place, turn * self.bench.prepared.length)

    def is_left(self, names: Names, matters: float) -> bool:
        """Whether a set leaves what matters, and more than noise makes."""
        left = max(float(np.sum(self.sums(names) - self.floor)), 1e-12)
        return self.size_left(names) >= matters and left > self.chance

    def carries(self, names: Names) -> bool:
        """Whether a set predicts recordings that it was not chosen by no worse, in place and in turn.

        By no more than noise makes, or a law that is not quite the true one.
        """
        rows = self.bench.held_out
        count = float(self.bench.seen[rows].sum())
        plain, own = (self.seen[one].squares[rows].sum(axis=(0, 1)) for one in ((), names))
        loss = own - plain
        least = max(CHANCE * float(np.sqrt(2.0 * count)), MEMBER_SHARE * float(plain.sum()))
        return max(float(loss[0] + loss[1]), float(loss[2])) <= least

    def spoilt(self, names: Names) -> tuple[str, ...]:
        """Files of recordings that a set predicts worse than the plain model, by more than a law's form or noise does.

        A law that is not the true one may take most of an error away where it is large, and pay for it elsewhere.
        """
        counts = self.bench.seen.sum(axis=(1, 2))
        loss = self.sums(names) - self.sums(())
        least = MEMBER_SHARE * self.explainable * counts / counts.sum()
        worse = loss > np.maximum(least, CHANCE * np.sqrt(2.0 * counts))
        return tuple(self.bench.prepared.files[row] for row in np.flatnonzero(worse))

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


def judge_of(bench: Bench, seen: dict[Names, RollOut], reach: float | None) -> Judge:
    """A judge whose floor is no higher than what any of the predicted sets leaves.

    Parameters
    ----------
    bench
        All recordings.
    seen
        What was predicted, at least the plain model.
    reach
        σ that free hidden inputs leave; None where that is not known.
    """
    return Judge(bench, seen, _floor(bench, seen, reach))


def with_predictions(
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


def explained(fall: Floats, whole: Floats, share: float, folds: int, seed: int) -> Explained:
    """A share with its interval, by resampling recordings.

    Parameters
    ----------
    fall, whole
        (R,) sums of squares that are explained, and that could be.
    share
        Of all recordings together.
    folds
        Parts that each recording was predicted in one of.
    seed
        Of the draws.

    Returns
    -------
    Explained
        Its ends hold the share.
    """
    drawn = resampled(len(fall), seed)
    shares = (drawn @ fall) / np.maximum(drawn @ whole, 1e-12)
    tail = 0.5 * (1.0 - INTERVAL)
    low, high = np.quantile(shares, [tail, 1.0 - tail])
    return Explained(
        share=share, low=min(float(low), share), high=max(float(min(high, 1.0)), share), folds=folds
    )


def resampled(count: int, seed: int) -> Floats:
    """(B, R) weights of recordings, of Rubin's Bayesian bootstrap.

    Recordings drawn with replacement would leave out, in a tenth of the draws, the two of eight that push
    on the edge that is wrong, and a share of nothing is no number.
    """
    return np.random.default_rng([seed, 5]).dirichlet(np.ones(count), _RESAMPLED)
