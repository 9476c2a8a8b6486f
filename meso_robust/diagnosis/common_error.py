"""What errors that no scatter shows leave open of the numbers of a fit: those of all frames alike, and small ones.

An outline that is a little too large, or light from one side, displaces what is seen in the same way throughout a set
of recordings. Frames that are compared with one another do not show it, and no recording disagrees with another:
intervals from the curvature of a fit, and from leaving out recordings, pass it over, however many frames there are.
Its size is what a stated σ has beyond the scatter of still frames (`Noise.stays`), and it looks like effects of the
catalogue: one that is fixed in the part, and one that is fixed in the image.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.stats import norm

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.refit import Refit
from meso_robust.diagnosis.signatures import SEEN, signatures, start_of
from meso_robust.diagnosis.tangent import CONFIDENCE, Interval, beyond_starts
from meso_robust.diagnosis.trials import trials_of
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.types import Floats

LOOKS_LIKE: Mapping[str, int] = {"reference_offset": 0, "registration_shift": 0, "part_yaw": 2}
"""Effects that such an error looks like, and the coordinate of the pose whose σ has its size: one a line."""
_HALF = float(norm.isf(0.5 * (1.0 - CONFIDENCE)))  # standard deviations of an interval's half width
_RANK = 1e-6  # of the largest change by a number, below which a direction is none


def widened(baseline: Baseline, refit: Refit, known: tuple[Interval, ...]) -> tuple[Interval, ...]:
    """Intervals with what an error that all frames have in common adds to them.

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
    tuple
        As wide as they were where no error of σ is known to stay.
    """
    reach = _reach(baseline, refit)
    return _wider(refit, known, reach) if np.any(reach) and known else known


def roomier(refit: Refit, known: tuple[Interval, ...]) -> tuple[Interval, ...]:
    """Intervals with room for an error that is just too small to be seen.

    Every set is a little wrong in many ways at once. What stays undetected changes all frames together by up to
    `SEEN` standard deviations; of as many directions as there are effects, that of a number has its share.

    Parameters
    ----------
    refit
        The extended fit, which leaves no more than noise.
    known
        Intervals of its numbers.
    """
    _, left = beyond_starts(refit.model, refit.fitted.jacobian[0], refit.tangent)
    free = np.flatnonzero(refit.model.fitted & (np.linalg.norm(left, axis=1) > 0.0))
    told = np.diag(np.linalg.pinv(left[free] @ left[free].T, rcond=_RANK**2, hermitian=True))
    reach = np.zeros(len(refit.model.parameters))
    reach[free] = _HALF * SEEN * np.sqrt(np.maximum(told, 0.0) / len(CATALOGUE))
    return _wider(refit, known, reach)


def _wider(refit: Refit, known: tuple[Interval, ...], reach: Floats) -> tuple[Interval, ...]:
    """Intervals to which half widths (n,), in coordinates, were added by their squares."""
    columns = [refit.model.keys.index(one.key) for one in known]
    ends = np.tile(refit.fits.values[0], (3, 1))
    ends[:, columns] = np.array([[one.value, one.low, one.high] for one in known]).T
    middle, low, high = refit.model.coordinates(ends)
    ends = np.stack(
        [middle - np.hypot(middle - low, reach), middle + np.hypot(high - middle, reach)]
    )
    lows, highs = refit.model.values(ends)[:, columns]
    return tuple(map(_between, known, lows.tolist(), highs.tolist()))


def _between(one: Interval, low: float, high: float) -> Interval:
    """The interval with other ends, none beyond the range of its number."""
    parameter = one.parameter
    return replace(
        one,
        # of a place in the image the range is computed: files take no numbers of NumPy
        low=float(max(low, parameter.low)),
        high=float(min(high, parameter.high)),
        open_low=bool(low <= parameter.low),
        open_high=bool(high >= parameter.high),
    )


def _reach(baseline: Baseline, refit: Refit) -> Floats:
    """(n,) half widths, in coordinates, that the error alone makes."""
    n, stays = len(refit.model.parameters), baseline.noise.stays
    reach = np.zeros(n)
    # of an effect that the model has one of its numbers takes it up
    asked = [
        trial
        for effect, component in LOOKS_LIKE.items()
        if stays[component] > 0.0 and effect not in refit.effects
        for trial in trials_of(effect, baseline.prepared)
    ]
    if not asked:
        return reach
    about = replace(baseline, model=refit.model, fits=refit.fits, tangent=refit.tangent)
    errors = [
        column * stays[LOOKS_LIKE[one.trial.effect]] / size
        for one in signatures(about, asked)
        for column, size in zip(
            one.columns, start_of(one.trial, np.ones(len(one.trial.sizes))), strict=True
        )
    ]
    starts, left = beyond_starts(refit.model, refit.fitted.jacobian[0], refit.tangent)
    moved = np.linalg.lstsq(left.T, starts.evidence(np.array(errors)).T, rcond=_RANK)[0]
    return np.asarray(_HALF * np.linalg.norm(moved, axis=1))
