"""Whether a fitted size is beyond nought by more than the best of the whole catalogue is by chance."""

from __future__ import annotations

from scipy.stats import norm, t as student

from meso_robust.diagnosis.tangent import CONFIDENCE, Interval
from meso_robust.simulator.catalogue import CATALOGUE

# half widths by which a size is beyond nought, for the best of the catalogue to be so in a tenth of the sets
# that hold none
_BEYOND = float(
    norm.isf(0.5 * (1.0 - CONFIDENCE) / len(CATALOGUE)) / norm.isf(0.5 * (1.0 - CONFIDENCE))
)


def is_open(one: Interval) -> bool:
    """Whether an interval ends where the range of its number does."""
    return one.open_low or one.open_high


def beyond_by_folds(folds: int) -> float:
    """As `_BEYOND`, of intervals by leaving out one of some folds at a time: these have Student's law."""
    most = 0.5 * (1.0 - CONFIDENCE)
    return float(student.isf(most / len(CATALOGUE), folds - 1) / student.isf(most, folds - 1))


def clear(one: Interval | None, beyond: float = _BEYOND) -> bool:
    """Whether a size is beyond nought by more than the best of all effects is by chance."""
    if one is None:
        return False
    half = one.value - one.low if one.value > 0.0 else one.high - one.value
    return abs(one.value) > beyond * half
