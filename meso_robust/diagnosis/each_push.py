"""Friction of its own in every push: what no other push tells, and the push itself does.

Where the friction of the tips differs from push to push no recording predicts another one. But if it keeps
through a push, the first part of the push tells it for the rest. So each push has its friction fitted to its first part
alone, and is judged by the rest, against the prediction of the plain model by the other recordings.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import spearmanr

from meso_robust.diagnosis.folds import Bench, RollOut
from meso_robust.diagnosis.judge import INTERVAL, Explained, explained, resampled
from meso_robust.identification.forward import predicted
from meso_robust.simulator import Outcome
from meso_robust.types import Flags, Floats, Ints

KEYS = ("mu", "mu_t")
"""The friction of the tips in plain models."""
_TRIED = np.geomspace(1.0 / 3.0, 3.0, 41)  # of the friction that all recordings have
_FIRST = 0.5  # of the frames after rest, that tell a push's friction
_TELLS = 25.0  # fall of squares over the noise, from one friction to another, of a push that tells its own
_WORST = 1e12  # sum of squares of a push that a friction does not carry out
_FEWEST = 5  # pushes that tell theirs


@dataclass(frozen=True, slots=True, kw_only=True)
class EachPush:
    """Friction of each push.

    Attributes
    ----------
    spread
        Standard deviation over mean of the friction, with the ends of its interval by bootstrap over pushes.
    least, most
        Of the friction coefficients.
    pushes
        How many tell theirs.
    explained
        Share of the explainable error of the last parts of all pushes.
    order, order_p
        Rank correlation with the order of the files' names, in which a laboratory records, and the chance of
        one as large.
    """

    spread: tuple[float, float, float]
    least: float
    most: float
    pushes: int
    explained: Explained
    order: float = 0.0
    order_p: float = 1.0


def each_push(bench: Bench, plain: RollOut, floor: float, seed: int) -> EachPush | None:
    """What friction of its own in every push explains.

    Parameters
    ----------
    bench
        R recordings.
    plain
        Their roll-outs with the plain model.
    floor
        Mean square over the noise that free hidden inputs leave.
    seed
        Of the intervals.

    Returns
    -------
    EachPush or None
        None where too few pushes tell theirs, or it explains nothing.
    """
    model = plain.model
    column = next((k for k, one in enumerate(model.parameters) if one.key in KEYS), None)
    if column is None or plain.values[column] <= 0.0:
        return None
    ends = model.parameters[column].low, model.parameters[column].high
    of = np.unique(np.clip(plain.values[column] * _TRIED, *ends))
    of = of[of > 0.0]
    first, last = _parts(bench)
    told, rest = np.empty((2, len(of), len(first)))
    for row, mu in enumerate(of):
        values = np.where(np.arange(len(plain.values)) == column, mu, plain.values)
        squares = _squares(bench, plain, values)
        told[row], rest[row] = (
            np.sum(np.where(part, squares, 0.0), axis=1) for part in (first, last)
        )
    best = _nearest(told, np.abs(np.log(of / plain.values[column])))
    rows = np.arange(len(best))
    before = np.sum(np.where(last[..., None], plain.squares, 0.0), axis=(1, 2))
    noise = floor * np.sum(last[..., None] & bench.seen, axis=(1, 2))
    telling = np.max(np.minimum(told, _WORST), axis=0) - told[best, rows] > _TELLS
    if not np.all(np.isfinite(rest[best, rows])):
        return None
    # of a push that does not tell its own friction the plain model's prediction stands
    after = np.where(telling, rest[best, rows], before)
    whole = before - noise
    # one in which the tip sticks tells a bound of its friction, no number
    tells = _rise(told, best) & _rise(told[::-1], len(of) - 1 - best)
    own = of[best[tells]]
    if whole.sum() <= 0.0 or len(own) < _FEWEST:
        return None
    share = float(np.sum(before - after) / whole.sum())
    order, chance = _order(own, [bench.prepared.files[row] for row in np.flatnonzero(tells)])
    return EachPush(
        spread=_spread(own, seed),
        least=float(own.min()),
        most=float(own.max()),
        pushes=len(own),
        explained=explained(before - after, whole, share, len(rows), seed),
        order=order,
        order_p=chance,
    )


def _order(own: Floats, files: Sequence[str]) -> tuple[float, float]:
    """Rank correlation of numbers with the order of names, and the chance of one as large; none of numbers that are all one."""
    if np.ptp(own) == 0.0:
        return 0.0, 1.0
    inorder = sorted(files, key=_by_number)
    found = spearmanr(own, [inorder.index(file) for file in files])
    return float(found.statistic), float(found.pvalue)


def _by_number(file: str) -> list[tuple[bool, int, str]]:
    """A key by which ``push_10`` comes after ``push_2``."""
    parts = re.split(r"([0-9]{1,9})", file)
    return [(part.isdigit(), int(part) if part.isdigit() else 0, part) for part in parts]


def _rise(told: Floats, best: Ints) -> Flags:
    """(R,) whether some friction below the best of those that tell a push (P, R) is clearly worse."""
    below = np.arange(len(told))[:, None] < best
    worst = np.max(np.where(below, np.minimum(told, _WORST), 0.0), axis=0)
    return np.asarray(worst - told[best, np.arange(len(best))] > _TELLS)


def _nearest(told: Floats, far: Floats) -> Ints:
    """(R,) of the frictions that tell a push alike (P, R) the nearest to that of all: a tip that sticks has many."""
    alike = told <= told.min(axis=0) + 1.0
    return np.asarray(np.argmin(np.where(alike, far[:, None], np.inf), axis=0))


def _squares(bench: Bench, plain: RollOut, values: Floats) -> Floats:
    """(R, T) squared errors over the noise, of predictions that start where the part was seen; infinite of failed ones."""
    found = predicted(bench.prepared, plain.model, values[None])
    sigma = bench.baseline.noise.sigma * bench.baseline.noise.floor
    away = (bench.prepared.seen - found.poses[0]) / sigma
    quiet = bench.still[..., None] & np.isfinite(away)
    away -= np.sum(np.where(quiet, away, 0.0), axis=1, keepdims=True) / np.maximum(
        quiet.sum(axis=1, keepdims=True), 1
    )
    ran = found.outcomes[0] == Outcome.COMPLETED
    return np.where(ran[:, None], np.nansum(away**2, axis=2), np.inf)


def _parts(bench: Bench) -> tuple[Flags, Flags]:
    """(R, T) frames of the first part after rest, and of the rest."""
    seen = np.any(bench.seen, axis=2)
    after = seen & ~bench.still & (np.cumsum(bench.still[:, ::-1], axis=1)[:, ::-1] == 0)
    order = np.cumsum(after, axis=1)
    first = after & (order <= _FIRST * order[:, -1:])
    return first, after & ~first


def _spread(own: Floats, seed: int) -> tuple[float, float, float]:
    weights = resampled(len(own), seed)
    mean = weights @ own
    drawn = np.sqrt(np.maximum(weights @ own**2 - mean**2, 0.0)) / mean
    value = float(own.std(ddof=1) / own.mean())
    tail = 0.5 * (1.0 - INTERVAL)
    low, high = np.quantile(drawn, [tail, 1.0 - tail])
    return value, min(float(low), value), max(float(high), value)
