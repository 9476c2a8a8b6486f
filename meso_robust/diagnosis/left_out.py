"""Errors of recordings that are predicted from the pose at rest by fits to the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.diagnosis.folds import Bench, RollOut
from meso_robust.diagnosis.judge import INTERVAL, resampled
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LeftOut:
    """Errors of R recordings, each predicted without it.

    Attributes
    ----------
    sigma
        (R,) root mean squares over the noise of the camera.
    metres
        (R,) of the place, m.
    counts, places
        (R,) numbers, and places, that were seen of it.
    """

    sigma: Floats
    metres: Floats
    counts: Floats
    places: Floats

    @property
    def whole(self) -> float:
        """Root mean square over all, in σ."""
        return float(np.sqrt(np.average(self.sigma**2, weights=self.counts)))

    @property
    def whole_metres(self) -> float:
        """Likewise of the place, m."""
        return float(np.sqrt(np.sum(self.metres**2 * self.places) / max(self.places.sum(), 1)))


def left_out(bench: Bench, rolled: RollOut) -> LeftOut:
    """Errors of roll-outs from the pose at rest: a start that is fitted takes up what is wrong.

    Parameters
    ----------
    bench, rolled
        All recordings, and what a model predicts of them.
    """
    counts = np.maximum(bench.seen.sum(axis=(1, 2)), 1)
    away = (bench.prepared.seen - rolled.poses)[..., :2]
    placed = np.isfinite(away).all(axis=2)
    places = placed.sum(axis=1)
    return LeftOut(
        sigma=bench.baseline.noise.floor * np.sqrt(rolled.squares.sum(axis=(1, 2)) / counts),
        metres=np.sqrt(
            np.where(placed, np.sum(away**2, axis=2), 0.0).sum(axis=1) / np.maximum(places, 1)
        ),
        counts=counts,
        places=places,
    )


def fall_of_error(before: LeftOut, after: LeftOut, seed: int) -> tuple[float, float]:
    """Interval of the relative fall of the error in σ, by resampling recordings.

    Parameters
    ----------
    before, after
        Of the plain and of the extended model.
    seed
        Of the draws.
    """
    drawn = resampled(len(before.sigma), seed)
    squares = [drawn @ (one.sigma**2 * one.counts) for one in (before, after)]
    fall = 1.0 - np.sqrt(squares[1] / np.maximum(squares[0], 1e-300))
    low, high = np.quantile(fall, [0.5 * (1.0 - INTERVAL), 0.5 * (1.0 + INTERVAL)])
    return float(low), float(high)
