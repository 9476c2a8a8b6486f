"""Sizes that the recordings bound to one side only: twice as large an effect would do as well.

Friction of an edge that is enough for a tip to stick is as good as any larger one. At the best fit predictions still
depend on it a little, and an interval by their slopes closes; so does one by leaving out recordings, as no
fit moves along what is flat. So predictions are made with twice the size, all other numbers as they are: a fit of
the others could only leave less.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.candidates import SCORE_SHARE
from meso_robust.diagnosis.refit import Refit
from meso_robust.diagnosis.tangent import Interval
from meso_robust.identification.forward import predicted
from meso_robust.types import Floats

_TELLS = 25.0
"""Fall of χ² by a size, over the mean of χ², below which it tells nothing."""


def opened(baseline: Baseline, refit: Refit, known: tuple[Interval, ...]) -> tuple[Interval, ...]:
    """Intervals, open to the far side of sizes that may as well be twice as large.

    Parameters
    ----------
    baseline
        The plain fit.
    refit
        The extended one.
    known
        Intervals of its numbers.

    Returns
    -------
    tuple of Interval
        An end that is opened is twice the best value, which is as good.
    """
    model, best = refit.model, refit.fits.values[0]
    sizes = {f"{trial.effect}.{key}" for trial in refit.trials for key in trial.sizes}
    at = {
        k: model.keys.index(one.key)
        for k, one in enumerate(known)
        if one.key in sizes and not (one.open_high if one.value > 0.0 else one.open_low)
    }
    at = {k: column for k, column in at.items() if _doubled(best[column], known[k])}
    values = np.tile(best, (1 + 2 * len(at), 1))
    for row, column in enumerate(at.values()):
        values[1 + 2 * row, column] = 0.0
        values[2 + 2 * row, column] *= 2.0
    least, *others = _chi2(baseline, refit, values)
    bar = _TELLS * max(least / max(int(np.isfinite(baseline.prepared.seen).sum()), 1), 1.0)
    found = list(known)
    for row, k in enumerate(at):
        without, twice = others[2 * row] - least, others[2 * row + 1] - least
        if without > bar and twice <= SCORE_SHARE * without:
            found[k] = _open(found[k])
    return tuple(found)


def _doubled(value: float, one: Interval) -> bool:
    """Whether twice the size, and none, are within the range of a number."""
    parameter = one.parameter
    within = parameter.low <= min(2.0 * value, 0.0) and max(2.0 * value, 0.0) <= parameter.high
    return within and value * one.value > 0.0


def _open(one: Interval) -> Interval:
    twice = 2.0 * one.value
    if one.value > 0.0:
        return replace(one, high=max(one.high, twice), open_high=True)
    return replace(one, low=min(one.low, twice), open_low=True)


def _chi2(baseline: Baseline, refit: Refit, values: Floats) -> list[float]:
    """Squared errors in the camera's noise of predictions by values (K, n)."""
    noise, prepared, fits = baseline.noise, baseline.prepared, refit.fits
    found = predicted(prepared, refit.model, values, starts=fits.starts[0], offsets=fits.offsets[0])
    away = (prepared.seen - found.poses) / (noise.sigma * noise.floor)
    return [float(one) for one in np.nansum(away**2, axis=(1, 2, 3))]
