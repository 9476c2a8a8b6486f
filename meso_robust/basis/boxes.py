"""Arrays of boxes (N, parameters): splitting them, and choosing one to report."""

from __future__ import annotations

import numpy as np

from meso_robust.types import Floats


def split(lo: Floats, hi: Floats, smear: Floats) -> tuple[Floats, Floats]:
    """Bisect every box across the divisible side that contributes most, by ``smear``."""
    middle = 0.5 * (lo + hi)
    worth = np.where((lo < middle) & (middle < hi), np.maximum(smear, 1e-300), -1.0)
    side, rows = np.argmax(worth, axis=1), np.arange(len(lo))
    left_hi, right_lo = hi.copy(), lo.copy()
    left_hi[rows, side] = right_lo[rows, side] = middle[rows, side]
    return np.concatenate([lo, right_lo]), np.concatenate([left_hi, hi])


def stuck(lo: Floats, hi: Floats) -> bool:
    """Whether a box cannot be split any further."""
    middle = 0.5 * (lo + hi)
    return not bool(((lo < middle) & (middle < hi)).any(axis=1).all())


def widest(lo: Floats, hi: Floats) -> int:
    """Number of the box with the largest sum of relative widths."""
    size = np.maximum(np.max(np.abs(lo), axis=0), np.max(np.abs(hi), axis=0)) + 1e-300
    return int(np.argmax(np.sum((hi - lo) / size, axis=1)))
