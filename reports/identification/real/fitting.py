"""Robust least squares of whole pushes, with what is needed to trust it: held-out pushes, bootstrap.

Real pushes are not the model plus white noise, so the likelihood's intervals would be far too narrow.
Here the unit is the push: each counts alike, and intervals are from pushes drawn with replacement.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from meso_robust.identification.forward import predicted
from meso_robust.identification.models import Model
from meso_robust.identification.prepared import Prepared

F = npt.NDArray[np.float64]
Rows = npt.NDArray[np.intp]

STEP = 0.01  # of a difference, in coordinates: across the kinks where a contact begins to slip
TOLERANCE = 1e-5  # relative, of the cost and of the coordinates: far below any interval here
FAR = 0.1  # m: residual of a vector that the model does not admit
BOOTSTRAP = (0.05, 0.95)
"""Quantiles of an interval over pushes drawn with replacement."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Problem:
    """A model to be fitted to R pushes.

    Attributes
    ----------
    prepared, model
        The pushes and the model.
    scale
        Residual in m from which a frame counts less than quadratically (soft L1).
    """

    prepared: Prepared
    model: Model
    scale: float

    @property
    def pushes(self) -> int:
        """R."""
        return len(self.prepared.files)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fit:
    """Values (n,) in SI and their cost in m²."""

    values: F
    cost: float


def residuals(problem: Problem, values: F) -> F:
    """(K, R, T·3) predicted less seen in m, θ times the characteristic length, over √frames.

    The squares of a push sum to its mean square error.
    """
    prepared, valid = problem.prepared, problem.model.valid(values)
    frames = np.sqrt(prepared.counts[:, 0])[:, None, None]
    result = np.full((len(values), *prepared.seen.shape), FAR)
    if np.any(valid):
        error = predicted(prepared, problem.model, values[valid]).poses - prepared.seen
        error[..., 2] *= prepared.length
        result[valid] = np.where(np.isfinite(error), error, 0.0) / frames
    return result.reshape(*result.shape[:2], -1)


def losses(problem: Problem, values: F) -> F:
    """(K, R) soft-L1 loss of each push in m²; they sum to twice the cost of a fit."""
    ratio = residuals(problem, values) / problem.scale
    return np.asarray(2.0 * problem.scale**2 * np.sum(np.sqrt(1.0 + ratio**2) - 1.0, axis=-1))


def fitted(
    problem: Problem,
    start: F,
    rows: Rows | None = None,
    *,
    free: npt.NDArray[np.bool_] | None = None,
    most: int = 40,
) -> Fit:
    """Fit a model, from a vector (n,) in SI, to some of the pushes; a row may stand twice.

    ``free`` (n,) tells which parameters move; all that motion can show, if none are given.
    """
    model = problem.model
    rows = np.arange(problem.pushes) if rows is None else rows
    moving = np.flatnonzero(model.fitted if free is None else free)
    first = model.coordinates(start[None])[0]
    low, high = _bounds(model)

    def residual(points: F) -> F:
        whole = np.tile(first, (len(points), 1))
        whole[:, moving] = points
        return residuals(problem, model.values(whole))[:, rows].reshape(len(points), -1)

    def slope(point: F) -> F:
        each = np.eye(len(moving)) * STEP
        up = np.clip(point + each, low[moving], high[moving])
        down = np.clip(point - each, low[moving], high[moving])
        both = residual(np.vstack([up, down]))
        return np.asarray(
            ((both[: len(up)] - both[len(up) :]) / np.diag(up - down)[:, None]).T,
        )

    found = least_squares(
        lambda point: residual(point[None])[0],
        np.clip(first[moving], low[moving], high[moving]),
        slope,
        bounds=(low[moving], high[moving]),
        loss="soft_l1",
        f_scale=problem.scale,
        ftol=TOLERANCE,
        xtol=TOLERANCE,
        max_nfev=most,
    )
    best = first.copy()
    best[moving] = found.x
    return Fit(values=model.values(best[None])[0], cost=float(found.cost))


def _bounds(model: Model) -> tuple[F, F]:
    """Ends of the ranges in coordinates, a hair inside."""
    low, high = np.array([[p.low, p.high] for p in model.parameters]).T
    return model.coordinates(low[None])[0] + 1e-9, model.coordinates(high[None])[0] - 1e-9


def errors(problem: Problem, values: F) -> F:
    """(R, 2) root mean square over the frames of each push: position in m, angle in rad."""
    error = predicted(problem.prepared, problem.model, values[None]).poses[0]
    error = (error - problem.prepared.seen) ** 2
    position = np.nanmean(error[..., 0] + error[..., 1], axis=1)
    return np.sqrt(np.stack([position, np.nanmean(error[..., 2], axis=1)], axis=-1))


def held_out(problem: Problem, start: F, folds: Sequence[Rows]) -> F:
    """(R, 2) errors of each push as predicted from a fit to the other folds, over all folds."""
    square, times = np.zeros((problem.pushes, 2)), np.zeros((problem.pushes, 1))
    for fold in folds:
        rest = np.setdiff1d(np.arange(problem.pushes), fold)
        square[fold] += errors(problem, fitted(problem, start, rest).values)[fold] ** 2
        times[fold] += 1.0
    return np.asarray(np.sqrt(square / times))


def folds_of(pushes: int, size: int, repeats: int, seed: int) -> list[Rows]:
    """Random sets of ``size`` pushes that leave every push out ``repeats`` times."""
    rng = np.random.default_rng(seed)
    return [
        fold
        for _ in range(repeats)
        for fold in np.array_split(rng.permutation(pushes), max(2, round(pushes / size)))
    ]


def bootstrapped(problem: Problem, best: F, draws: int, seed: int, most: int = 6) -> F:
    """(draws, n) refits from the best values to pushes drawn with replacement."""
    rng = np.random.default_rng(seed)
    sets = rng.integers(problem.pushes, size=(draws, problem.pushes))
    return np.array([fitted(problem, best, rows, most=most).values for rows in sets])


def root_mean_square(each: F) -> F:
    """(2,) over pushes of (R, 2) errors."""
    return np.asarray(np.sqrt(np.mean(each**2, axis=0)))


def interval(each: F, draws: int = 2000, seed: int = 0) -> F:
    """(2, 2) bootstrap interval, low and high, of the root mean square of (R, 2) errors."""
    rows = np.random.default_rng(seed).integers(len(each), size=(draws, len(each)))
    return np.asarray(np.quantile(np.sqrt(np.mean(each[rows] ** 2, axis=1)), BOOTSTRAP, axis=0))


def difference(first: F, second: F, draws: int = 2000, seed: int = 0) -> F:
    """(2,) bootstrap interval of the mean difference of the losses (R,) of two explanations."""
    rows = np.random.default_rng(seed).integers(len(first), size=(draws, len(first)))
    return np.asarray(np.quantile(np.mean((first - second)[rows], axis=1), BOOTSTRAP))
