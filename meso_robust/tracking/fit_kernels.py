"""Compiled loops of the tracker's robust fits, apart so that a bad file is refused before they load."""

from __future__ import annotations

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
    length = len(mean)
    shifts = derivative.shape[1] - length + 1
    power = np.sum(mean**2)
    agreement, energy = np.empty(shifts), np.empty(shifts)
    for n in range(len(derivative)):
        profile = derivative[n]
        offset[n], quality[n], polarity[n] = np.nan, 0.0, 0.0
        if not np.isfinite(profile).all():
            continue
        agreement[:], energy[:] = 0.0, 0.0
        for k in range(length):
            for s in range(shifts):
                agreement[s] += mean[k] * profile[s + k]
                energy[s] += power * profile[s + k] ** 2
        # a weak but clean edge must not beat a strong one, nor clutter the outline
        best, most = 0, -1.0
        for s in range(shifts):
            size = agreement[s] ** 2 / np.sqrt(max(energy[s], 1e-12))
            if size > most:
                best, most = s, size
        polarity[n] = np.sign(agreement[best])
        middle = min(max(best, 1), shifts - 2)
        left, right = abs(agreement[middle - 1]), abs(agreement[middle + 1])
        bend = left - 2.0 * abs(agreement[middle]) + right
        shift = 0.0
        if best == middle and bend < 0.0:
            shift = 0.5 * (left - right) / bend
            quality[n] = most / max(abs(agreement[best]), 1e-300)
        offset[n] = step * (middle + shift - 0.5 * (shifts - 1))
        if len(filters):
            nearest = int(np.rint(offset[n] / step + 0.5 * (shifts - 1)))
            nearest = min(max(nearest, 0), shifts - 1)
            gain, moment = 0.0, 0.0
            for k in range(length):
                gain += filters[0, k] * profile[nearest + k]
                moment += filters[1, k] * profile[nearest + k]
            offset[n] = step * (nearest - 0.5 * (shifts - 1))
            # without a gain there is no edge, and far from the sample the filters are not linear
            if abs(moment) < _LINEAR * abs(gain):
                offset[n] += moment / gain
            else:
                quality[n] = 0.0


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
        normal[:], right[:] = 0.0, 0.0
        for n in range(len(design)):
            if weight[n] > 0.0:
                for i in range(4):
                    scaled = weight[n] * design[n, i]
                    right[i] += scaled * offset[n]
                    for j in range(4):
                        normal[i, j] += scaled * design[n, j]
        normal[3, 3] += (scale / delta_sigma) ** 2
        for i in range(4):
            normal[i, i] += 1e-9 * normal[i, i] + 1e-9
        solution[:] = np.linalg.solve(normal, right)
        for n in range(len(design)):
            if used[n]:
                residual[n] = offset[n]
                for i in range(4):
                    residual[n] -= design[n, i] * solution[i]
        scale = max(_spread(residual, used), least_scale)
        for n in range(len(design)):
            if used[n]:
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
