"""The paper's objective of the fit, eqs. (3) and (4) of Section VI."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.identification.forward import Prediction, predicted
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared
from meso_robust.simulator import Outcome
from meso_robust.types import Floats


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
    valid: npt.NDArray[np.bool_]
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
