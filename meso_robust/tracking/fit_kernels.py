"""Compiled loops of the tracker's robust fits, apart so that a bad file is refused before they load."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from meso_robust.kernels import inner, maker
from meso_robust.types import Flags, Floats

_LINEAR = 2.0  # px, displacement beyond which the filters of a pattern say nothing
_TUKEY = 4.0  # scales at which Tukey's weight vanishes (4.685 is 95 % efficient; shadows abound)


@maker
def _spread(residual: Floats, used: Flags) -> float:
    """Robust standard deviation (median absolute value) of what is used; 1 of nothing."""
    size = np.abs(residual[used])
    if not len(size):
        return 1.0
    return 1.4826 * float(np.partition(size, len(size) // 2)[len(size) // 2])


@inner
def _tukey(residual: float, scale: float) -> float:
    """Tukey's biweight of a residual, ``scale`` in its unit."""
    return max(1.0 - (residual / (_TUKEY * scale)) ** 2, 0.0) ** 2


@inner
def _correlated(profile: Floats, mean: Floats, agreement: Floats, energy: Floats) -> int:
    """Products with a pattern at each shift, energies there, and the best shift."""
    agreement[:], energy[:] = 0.0, 0.0
    for k in range(len(mean)):
        for s in range(len(agreement)):
            agreement[s] += mean[k] * profile[s + k]
            energy[s] += profile[s + k] ** 2
    # a weak but clean edge must not beat a strong one, nor clutter the outline
    best, most = 0, -1.0
    for s in range(len(agreement)):
        size = agreement[s] ** 2 / math.sqrt(max(energy[s], 1e-12))
        if size > most:
            best, most = s, size
    return best


@inner
def _refined(profile: Floats, filters: Floats, nearest: int) -> float:
    """Displacement in px from the sample ``nearest`` by the filters; NaN where they do not hold."""
    gain, moment = 0.0, 0.0
    for k in range(filters.shape[1]):
        gain += filters[0, k] * profile[nearest + k]
        moment += filters[1, k] * profile[nearest + k]
    # without a gain there is no edge, and far from the sample the filters are not linear
    return moment / gain if abs(moment) < _LINEAR * abs(gain) else np.nan


@njit(cache=True, nogil=True, error_model="numpy")
def match(
    derivative: Floats,
    mean: Floats,
    filters: Floats,
    step: float,
    offset: Floats,
    quality: Floats,
    polarity: Floats,
) -> None:
    """Where each profile (N, K) agrees best with a pattern (L,), either way round; see edges.Matched.

    ``filters`` (2, L) refine it, or (0, L).
    """
    shifts = derivative.shape[1] - len(mean) + 1
    middle = 0.5 * (shifts - 1)
    size = math.sqrt(np.sum(mean**2))
    agreement, energy = np.empty(shifts), np.empty(shifts)
    for n in range(len(derivative)):
        profile = derivative[n]
        offset[n], quality[n], polarity[n] = np.nan, 0.0, 0.0
        if not np.isfinite(profile).all():
            continue
        best = _correlated(profile, mean, agreement, energy)
        polarity[n] = np.sign(agreement[best])
        at = min(max(best, 1), shifts - 2)
        left, right = abs(agreement[at - 1]), abs(agreement[at + 1])
        bend = left - 2.0 * abs(agreement[at]) + right
        peak = best == at and bend < 0.0
        offset[n] = step * (at + (0.5 * (left - right) / bend if peak else 0.0) - middle)
        if peak:
            quality[n] = abs(agreement[best]) / (size * math.sqrt(max(energy[best], 1e-12)))
        if len(filters):
            nearest = min(max(int(np.rint(offset[n] / step + middle)), 0), shifts - 1)
            further = _refined(profile, filters, nearest)
            offset[n] = step * (nearest - middle) + (0.0 if np.isnan(further) else further)
            quality[n] = 0.0 if np.isnan(further) else quality[n]


@inner
def _summed(design: Floats, weight: Floats, offset: Floats, normal: Floats, right: Floats) -> None:
    """Normal matrix and right side of weighted least squares with four unknowns."""
    normal[:], right[:] = 0.0, 0.0
    for n in range(len(design)):
        if weight[n] > 0.0:
            for i in range(4):
                scaled = weight[n] * design[n, i]
                right[i] += scaled * offset[n]
                for j in range(4):
                    normal[i, j] += scaled * design[n, j]


@inner
def _left(row: Floats, solution: Floats, value: float) -> float:
    """What a solution leaves of a value."""
    for i in range(len(solution)):
        value -= row[i] * solution[i]
    return value


@njit(cache=True, nogil=True, error_model="numpy")
def reweighted(
    design: Floats,
    offset: Floats,
    base: Floats,
    delta_sigma: float,
    least_scale: float,
    rounds: int,
    solution: Floats,
    weight: Floats,
) -> None:
    """Weighted least squares, reweighted by Tukey's biweight; see `edges.robust_fit`.

    What has no weight in ``base`` (N,) is not used; ``solution`` (4,) and ``weight`` (N,) are filled.
    """
    used = base > 0.0
    residual = np.where(used, offset, 0.0)
    weight[:] = base
    scale = max(_spread(residual, used), least_scale)
    normal, right = np.empty((4, 4)), np.empty(4)
    for _ in range(rounds):
        _summed(design, weight, offset, normal, right)
        normal[3, 3] += (scale / delta_sigma) ** 2
        for i in range(4):
            normal[i, i] += 1e-9 * normal[i, i] + 1e-9
        solution[:] = np.linalg.solve(normal, right)
        for n in np.flatnonzero(used):
            residual[n] = _left(design[n], solution, offset[n])
        scale = max(_spread(residual, used), least_scale)
        for n in np.flatnonzero(used):
            weight[n] = base[n] * _tukey(residual[n], scale)


@njit(cache=True, nogil=True, error_model="numpy")
def face_step(
    design: Floats,
    grey: Floats,
    least_scale: float,
    weight: Floats,
    solution: Floats,
    residual: Floats,
) -> None:
    """One round of `ssd.registered`: solve with the weights (M,), then renew them.

    ``grey`` (M,) is NaN where nothing is seen; ``solution`` (8,) and ``residual`` (M,) are filled.
    """
    visible = np.isfinite(grey)
    seen, scaled = np.empty(len(grey)), np.empty(design.shape)
    for n in range(len(grey)):
        if not visible[n]:
            weight[n] = 0.0
        seen[n] = grey[n] if visible[n] else 0.0
        for i in range(design.shape[1]):
            scaled[n, i] = weight[n] * design[n, i]
    normal = design.T @ scaled
    for i in range(len(normal)):
        normal[i, i] *= 1.0 + 1e-9
    solution[:] = np.linalg.solve(normal, scaled.T @ seen)
    residual[:] = seen - design @ solution
    scale = max(_spread(residual, visible), least_scale)
    for n in range(len(grey)):
        weight[n] = _tukey(residual[n], scale) if visible[n] else 0.0
