"""The inequality that every engine of bounds is timed on: eq. (5) on a box of +-2 %."""

from fractions import Fraction

import numpy as np
import numpy.typing as npt

from meso_robust.bounds import Interval

F = npt.NDArray[np.float64]

NAMES = ("d1", "d2", "rho", "theta")
NOMINAL = tuple(map(Fraction, ("0.4185", "0.50134131", "0.3769", "1.7")))
"""mm, mm, mm^2, rad: half width and film ratio of the paper; the ratio is 4.0939 there, and its least
value on the box is at d1+, d2+, rho-, theta-."""
THRESHOLD = Interval.exactly(Fraction("3.3581"))
LEAST = "3.358117"


def _around(value: Fraction) -> Interval:
    low, high = (Interval.exactly(value * Fraction(share)) for share in ("0.98", "1.02"))
    return Interval(low.lo, high.hi)


BOX = tuple(map(_around, NOMINAL))


def random_boxes(count: int) -> tuple[F, F]:
    """(count, 4) ends of random boxes inside the box, a tenth as wide."""
    rng = np.random.default_rng(0)
    lo = np.array([side.lo for side in BOX])
    width = np.array([side.hi - side.lo for side in BOX])
    low = lo + 0.9 * width * rng.random((count, 4))
    return low, low + 0.1 * width
