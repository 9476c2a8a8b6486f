"""Outward-rounded operations on NumPy arrays of intervals, (..., 2)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from meso_robust.bounds import arithmetic as ia
from meso_robust.types import Floats


def _outward(lo: Floats, hi: Floats) -> Floats:
    """One double further out on both sides; the whole line for what is undefined."""
    lo = np.where(np.isnan(lo), -np.inf, np.nextafter(lo, -np.inf))
    hi = np.where(np.isnan(hi), np.inf, np.nextafter(hi, np.inf))
    return np.stack([lo, hi], axis=-1)


def plus(a: Floats, b: Floats) -> Floats:
    """Sum."""
    return _outward(a[..., 0] + b[..., 0], a[..., 1] + b[..., 1])


def minus(a: Floats, b: Floats) -> Floats:
    """Difference."""
    return _outward(a[..., 0] - b[..., 1], a[..., 1] - b[..., 0])


def times(a: Floats, b: Floats) -> Floats:
    """Product."""
    with np.errstate(invalid="ignore", over="ignore"):
        all_ = np.stack([a[..., i] * b[..., j] for i in range(2) for j in range(2)])
    undefined = np.isnan(all_).any(axis=0)
    lo = np.where(undefined, np.nan, all_.min(axis=0))
    return _outward(lo, np.where(undefined, np.nan, all_.max(axis=0)))


def point(value: Floats | float) -> Floats:
    """Intervals that hold one double each."""
    return np.stack([value, value], axis=-1)


def total(a: Floats) -> Floats:
    """Sum over the last axis before the ends."""
    result = np.zeros((*a.shape[:-2], 2))
    for k in range(a.shape[-2]):
        result = plus(result, a[..., k, :])
    return result


def meet(a: Floats, b: Floats) -> Floats:
    """What two enclosures of the same numbers leave."""
    return np.stack([np.maximum(a[..., 0], b[..., 0]), np.minimum(a[..., 1], b[..., 1])], axis=-1)


def inside(a: Floats, b: Floats) -> npt.NDArray[np.bool_]:
    """Whether a lies in b."""
    return np.asarray((b[..., 0] <= a[..., 0]) & (a[..., 1] <= b[..., 1]))


def sine_cosine(angle: Floats) -> tuple[Floats, Floats]:
    """Sine and cosine of angles (N, 2), rad."""
    ends = [tuple(map(float, row)) for row in angle]
    return np.array([ia.sin(*row) for row in ends]), np.array([ia.cos(*row) for row in ends])
