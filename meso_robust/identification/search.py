"""The paper's fit, Section VI: its objective, many searches from random starts, and the minima there.

The objective is that of eqs. (3) and (4); searches are Nelder and Mead's simplexes; searches that end
where the same motion is predicted have found the same minimum.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.identification.forward import Prediction, predicted
from meso_robust.identification.models.model import Model
from meso_robust.identification.nelder_mead import around, minimised
from meso_robust.identification.prepared import Prepared
from meso_robust.simulator import Outcome
from meso_robust.types import Flags, Floats

THRESHOLD = 10e-6
"""Size of a simplex at which a search ends, m, the paper's; for a part of `PART`."""
PART = 910e-6
"""Characteristic length of the paper's part, m."""
MOST = 400
"""Most iterations of a search."""
_EDGE = 0.15  # of a first simplex, in coordinates
ALIKE = 1e-6
"""Predictions closer than this (eq. 4 between them, m) count as the same; for a part of `PART`."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scores:
    """How well K vectors of parameters explain R recordings.

    Attributes
    ----------
    values
        (K,) F of eq. (4) in m; infinite where `valid` is false or a run did not complete.
    trials
        (K, R) f of eq. (3) in m.
    axes
        (K, R, 3) root mean squares along x, y and θ times the characteristic length, m.
    valid
        (K,) whether the vector keeps the ranges and the constraint of its model.
    outcomes
        (K, R) values of `Outcome`: a run that jammed is an outcome of its own, not a bad fit.
    """

    values: Floats
    trials: Floats
    axes: Floats
    valid: Flags
    outcomes: npt.NDArray[np.int8]


def errors(prepared: Prepared, poses: Floats) -> Floats:
    """Root mean squares (K, R, 3) of seen less predicted poses (K, R, T, 3), m.

    θ counts times the characteristic length. An axis that was never seen counts as zero.
    """
    scale = np.array([1.0, 1.0, prepared.length])
    squares = np.nan_to_num(((prepared.seen - poses) * scale) ** 2)
    return np.asarray(np.sqrt(squares.sum(axis=2) / np.maximum(prepared.counts, 1)))


def scores_of(prepared: Prepared, prediction: Prediction) -> Scores:
    """Scores of what valid vectors predict."""
    axes = errors(prepared, prediction.poses)
    trials = axes.max(axis=2)
    ended = prediction.outcomes == Outcome.COMPLETED
    trials = np.where(ended, trials, np.inf)
    return Scores(
        values=trials.mean(axis=1),
        trials=trials,
        axes=axes,
        valid=np.ones(len(trials), dtype=bool),
        outcomes=prediction.outcomes,
    )


def score(prepared: Prepared, model: Model, values: Floats, workers: int | None = None) -> Scores:
    """F, f and their axes for vectors (K, n) in SI, each recording from its first pose as seen.

    Vectors outside the constraints cost infinitely much and are not simulated, as in the paper.

    Parameters
    ----------
    prepared, model
        R recordings and a model of n parameters.
    values
        (K, n) in SI.
    workers
        Threads; all cores by default.

    Returns
    -------
    Scores
        F is infinite for vectors that were not simulated and for runs that did not complete.
    """
    valid = model.valid(values)
    shape = (len(values), len(prepared.files))
    found = Scores(
        values=np.full(len(values), np.inf),
        trials=np.full(shape, np.inf),
        axes=np.full((*shape, 3), np.inf),
        valid=valid,
        outcomes=np.full(shape, Outcome.OUT_OF_RANGE, dtype=np.int8),
    )
    if np.any(valid):
        some = scores_of(prepared, predicted(prepared, model, values[valid], workers=workers))
        for name in ("values", "trials", "axes", "outcomes"):
            getattr(found, name)[valid] = getattr(some, name)
    return found


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ends:
    """Where S searches ended.

    Attributes
    ----------
    values
        (S, n) best vector of each, SI.
    objective
        (S,) F in m.
    sizes
        (S,) sizes of the last simplexes in coordinates; times the characteristic length, m.
    spreads
        (S, n) half the extent of the last simplex along each parameter, SI.
    evaluations
        (S,) how often F was evaluated.
    """

    values: Floats
    objective: Floats
    sizes: Floats
    spreads: Floats
    evaluations: Floats


def searched(
    prepared: Prepared,
    model: Model,
    starts: Floats,
    *,
    threshold: float = THRESHOLD,
    told: Callable[[int], None] = lambda _: None,
) -> Ends:
    """Minimise F of eq. (4) from S vectors (S, n) in SI.

    Parameters that no motion shows stay as they are. Simplexes live in the model's coordinates, in
    which the characteristic length is one.

    Parameters
    ----------
    prepared, model, starts
        What is fitted to what, and from where.
    threshold
        Size of a simplex at which its search ends, m, scaled with the part.
    told
        Called with the number of searches that have ended.
    """
    fitted = model.fitted
    first = model.coordinates(starts)[:, fitted]
    rest = starts[0]

    def whole(points: Floats) -> Floats:
        coordinates = np.tile(model.coordinates(rest[None]), (len(points), 1))
        coordinates[:, fitted] = points
        return model.values(coordinates)

    def inside(points: Floats) -> Flags:
        return model.valid(whole(points))

    def cost(points: Floats) -> Floats:
        return score(prepared, model, whole(points)).values

    found = minimised(
        cost, around(first, _EDGE, inside), threshold=threshold / PART, most=MOST, told=told
    )
    corners = whole(found.points.reshape(-1, first.shape[1])).reshape(*found.points.shape[:2], -1)
    return Ends(
        values=corners[:, 0],
        objective=found.values[:, 0],
        sizes=found.sizes,
        spreads=0.5 * np.ptp(corners, axis=1),
        evaluations=found.evaluations.astype(float),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Minimum:
    """A local minimum.

    Attributes
    ----------
    values
        (n,) in SI, in the model's standard form.
    cost
        What was minimised: F in m, or χ².
    objective
        F of eq. (4) in m, each recording from its first pose as seen.
    axes
        (3,) root mean squares over all recordings along x, y (m) and θ (rad).
    found
        Number of searches that ended there.
    spread
        (n,) half the range of the vectors that ended there, SI: a wide one tells that different
        vectors predict the same.
    members
        Which of the ends these were, the best first.
    """

    values: Floats
    cost: float
    objective: float
    axes: Floats
    found: int
    spread: Floats
    members: tuple[int, ...]


def minima(
    prepared: Prepared,
    model: Model,
    values: Floats,
    costs: Floats,
    weights: Sequence[int] | None = None,
) -> tuple[Minimum, ...]:
    """Group the ends of searches by what they predict, the best group first.

    Two ends are the same minimum if their predictions differ by less than `ALIKE`, whatever their
    parameters: the same motion may follow from different support points.

    Parameters
    ----------
    prepared, model
        What was fitted to what.
    values, costs
        (S, n) in SI and (S,) what was minimised there.
    weights
        S numbers of searches that each stands for; one by default.
    """
    prediction = predicted(prepared, model, values)
    scores = scores_of(prepared, prediction)
    limit = ALIKE * prepared.length / PART
    groups: list[list[int]] = []
    for k in np.argsort(costs, kind="stable"):
        own = [g for g in groups if _away(prepared, prediction.poses[[k, g[0]]]) < limit]
        if own:
            own[0].append(int(k))
        else:
            groups.append([int(k)])
    scale = np.array([1.0, 1.0, prepared.length])
    standard, counts = model.alike(values), np.ones(len(values), dtype=int)
    counts = counts if weights is None else np.array(weights)
    return tuple(
        Minimum(
            values=standard[group[0]],
            cost=float(costs[group[0]]),
            objective=float(scores.values[group[0]]),
            axes=np.sqrt(np.mean(scores.axes[group[0]] ** 2, axis=0)) / scale,
            found=int(counts[group].sum()),
            spread=0.5 * np.ptp(standard[group], axis=0),
            members=tuple(group),
        )
        for group in groups
    )


def _away(prepared: Prepared, two: Floats) -> float:
    """Eq. (4) between two predictions (2, R, T, 3) where something was seen, m."""
    scale = np.array([1.0, 1.0, prepared.length])
    apart = np.where(np.isfinite(prepared.seen), (two[0] - two[1]) * scale, 0.0)
    rms = np.sqrt(np.sum(apart**2, axis=1) / np.maximum(prepared.counts, 1))
    return float(rms.max(axis=1).mean())
