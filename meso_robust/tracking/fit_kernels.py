"""Compiled loops of the tracker's fits, apart so that a bad file is refused before they load.

They are in one file, since a kernel kept on disk is renewed when its own file changes.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numba import njit

from meso_robust.kernels import maker, sealed
from meso_robust.types import Flags, Floats, Image, Ints, Singles

Needle: TypeAlias = tuple[Ints, Singles, Singles, Floats, Flags, Ints]
"""Of N pixels of a learned needle: (N, 2) u, v; (N, K) what they are made of; transmission; its slopes
(N, 2); whether each was seen; and (N, 2) which are to the right and below, or −1."""
Edge: TypeAlias = tuple[Ints, Floats, Floats, Ints, Floats]
"""Rows, distance, normals, edge and profiles of `edge_profile.Behind`; no rows if there is no edge."""
Limits: TypeAlias = tuple[float, float, float]

_LINEAR = 2.0  # px, displacement beyond which the filters of a pattern say nothing
_EDGE_TUKEY = (
    4.0  # scales at which Tukey's weight vanishes (4.685 is 95 % efficient; shadows abound)
)
_NEEDLE_TUKEY = 4.7
_TIP_TUKEY = 5.0
_ROUNDS = 5  # of reweighting
_LEAST_SIGMA = 0.5  # grey values, of what a learned needle leaves
_NOISE = 4.0  # grey values²
_UNKNOWN = 1e6  # variance over the noise's where nothing is known
_NEEDLE_STEPS = 12
_GAIN = 0.05  # by which the needle's brightness over the film's may vary
_STEPS = 3  # towards a tip


@sealed
def _selected(values: Floats | Singles, k: int) -> float:
    """The k-th least of some values, which are reordered as by quicksort: no larger one is before it."""
    low, high = 0, len(values) - 1
    while low < high:
        pivot, i, j = values[(low + high) // 2], low, high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i, j = i + 1, j - 1
        low, high = (low, j) if k <= j else (i, high) if k >= i else (k, k)
    return values[k]


@maker
def _least(values: Floats | Singles, k: int) -> float:
    """The k-th least of values that are not negative, in single precision.

    They are counted by their leading bits first: comparisons that fall either way cost more.
    """
    single, counts = np.empty(len(values), np.float32), np.zeros(1 << 11, np.int32)
    for n in range(len(values)):
        single[n] = values[n]
    bits, drop = single.view(np.uint32), np.uint32(20)
    for n in range(np.uintp(len(bits))):
        counts[np.uintp(bits[n] >> drop)] += 1
    before, box = 0, 0
    while before + counts[box] <= k:
        before += counts[box]
        box += 1
    inside, found = np.empty(counts[box] + 1, np.float32), 0
    for n in range(np.uintp(len(bits))):
        inside[np.uintp(found)] = single[n]
        found += (bits[n] >> drop) == box and found < counts[box]
    return _selected(inside[: counts[box]], k - before)


@sealed
def _eliminated(matrix: Floats, right: Floats) -> None:
    """Solve linear equations by elimination with pivots; both are changed, ``right`` to the solution."""
    count = len(right)
    for k in range(count):
        pivot = k
        for i in range(k + 1, count):
            pivot = i if abs(matrix[i, k]) > abs(matrix[pivot, k]) else pivot
        for j in range(k, count):
            matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
        right[k], right[pivot] = right[pivot], right[k]
        for i in range(k + 1, count):
            factor = matrix[i, k] / matrix[k, k]
            for j in range(k, count):
                matrix[i, j] -= factor * matrix[k, j]
            right[i] -= factor * right[k]
    for k in range(count - 1, -1, -1):
        for j in range(k + 1, count):
            right[k] -= matrix[k, j] * right[j]
        right[k] /= matrix[k, k]


@sealed
def _biweight(square: float) -> float:
    """Tukey's biweight of the square of a residual over where it vanishes."""
    return max(1.0 - square, 0.0) ** 2


@maker
def _spread(sizes: Floats) -> float:
    """Robust standard deviation (median) of absolute values; 1 of nothing."""
    return 1.4826 * _least(sizes, len(sizes) // 2) if len(sizes) else 1.0


@sealed
def _scaled(rows: Floats | Singles, weight: Floats | Singles, out: Floats | Singles) -> None:
    """Rows (N, K) times their weights."""
    for n in range(len(weight)):
        for k in range(rows.shape[1]):
            out[n, k] = weight[n] * rows[n, k]


@sealed
def _correlated(profile: Floats, mean: Floats, agreement: Floats, energy: Floats) -> int:
    """Products with a pattern at each shift, energies there, and the best shift."""
    for s in range(len(agreement)):
        agreement[s] = 0.0
    for k in range(np.uintp(len(mean))):
        for s in range(np.uintp(len(agreement))):
            agreement[s] += mean[k] * profile[s + k]
    energy[0] = 0.0
    for k in range(len(mean)):
        energy[0] += profile[k] ** 2
    for s in range(1, len(energy)):
        energy[s] = energy[s - 1] + profile[s - 1 + len(mean)] ** 2 - profile[s - 1] ** 2
    # a weak but clean edge must not beat a strong one, nor clutter the outline
    best, most = 0, -1.0
    for s in range(len(agreement)):
        size = agreement[s] ** 2 / math.sqrt(max(energy[s], 1e-12))
        if size > most:
            best, most = s, size
    return best


@sealed
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
        total = 0.0
        for k in range(len(profile)):
            total += profile[k]
        if not math.isfinite(total):
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


@sealed
def _summed(design: Floats, weight: Floats, offset: Floats, normal: Floats, right: Floats) -> None:
    """Normal matrix and right side of weighted least squares."""
    normal[:], right[:] = 0.0, 0.0
    for n in range(len(design)):
        if weight[n] > 0.0:
            for i in range(len(right)):
                scaled = weight[n] * design[n, i]
                right[i] += scaled * offset[n]
                for j in range(len(right)):
                    normal[i, j] += scaled * design[n, j]


@sealed
def _left(row: Floats, solution: Floats, value: float) -> float:
    """What a solution leaves of a value."""
    for i in range(len(solution)):
        value -= row[i] * solution[i]
    return value


@njit(cache=True, nogil=True, error_model="numpy")
def reweighted(
    design: Floats,
    offset: Floats,
    rows: Ints,
    delta_sigma: float,
    least_scale: float,
    solution: Floats,
    weight: Floats,
) -> None:
    """Weighted least squares, reweighted by Tukey's biweight; see `edges.robust_fit`.

    Only ``rows`` are used; ``weight`` (N,) is at first what they count anyway, elsewhere 0, and is
    replaced; ``solution`` (k,) is filled; the fourth is known beforehand to be about zero.
    """
    base, residual, sizes = np.empty(len(rows)), np.empty(len(rows)), np.empty(len(rows))
    for k in range(len(rows)):
        base[k], residual[k] = weight[rows[k]], offset[rows[k]]
        sizes[k] = abs(residual[k])
    scale = max(_spread(sizes), least_scale)
    normal, right = np.empty((len(solution), len(solution))), np.empty(len(solution))
    for _ in range(_ROUNDS):
        _summed(design, weight, offset, normal, right)
        normal[3, 3] += (scale / delta_sigma) ** 2
        for i in range(len(right)):
            normal[i, i] += 1e-9 * normal[i, i] + 1e-9
        _eliminated(normal, right)
        for i in range(len(right)):
            solution[i] = right[i]
        for k in range(len(rows)):
            residual[k] = _left(design[rows[k]], solution, offset[rows[k]])
            sizes[k] = abs(residual[k])
        scale = max(_spread(sizes), least_scale)
        for k in range(len(rows)):
            weight[rows[k]] = base[k] * _biweight((residual[k] / (_EDGE_TUKEY * scale)) ** 2)


@njit(cache=True, nogil=True, error_model="numpy")
def face_step(
    design: Floats,
    grey: Floats,
    least_scale: float,
    weight: Floats,
    solution: Floats,
    residual: Floats,
) -> int:
    """One round of `ssd.registered`: solve with the weights (M,), then renew them; how many values are seen.

    ``grey`` (M,) is NaN where nothing is seen; ``solution`` (8,) and ``residual`` (M,) are filled.
    """
    seen, scaled = np.empty(len(grey)), np.empty(design.shape)
    for n in range(len(grey)):
        visible = not math.isnan(grey[n])
        seen[n] = grey[n] if visible else 0.0
        weight[n] = weight[n] if visible else 0.0
    _scaled(design, weight, scaled)
    normal = design.T @ scaled
    for i in range(len(normal)):
        normal[i, i] *= 1.0 + 1e-9
    np.dot(scaled.T, seen, solution)
    _eliminated(normal, solution)
    sizes, count = np.empty(len(grey)), 0
    for n in range(len(grey)):
        residual[n] = _left(design[n], solution, seen[n])
        sizes[count] = abs(residual[n])
        count += not math.isnan(grey[n])
    scale = max(_spread(sizes[:count]), least_scale)
    for n in range(len(grey)):
        visible = not math.isnan(grey[n])
        weight[n] = _biweight((residual[n] / (_EDGE_TUKEY * scale)) ** 2) if visible else 0.0
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def alike(design: Floats, gain: float, weight: Floats, residual: Floats) -> float:
    """Correlation of an image, first of the columns (M, K), with what is seen, from what the fit leaves (M,)."""
    mean, explained, rest = 0.0, 0.0, 0.0
    for n in range(len(design)):
        mean += design[n, 0] / len(design)
    for n in range(len(design)):
        explained += weight[n] * (gain * (design[n, 0] - mean)) ** 2
        rest += weight[n] * residual[n] ** 2
    return math.sqrt(explained / max(explained + rest, 1e-12))


@sealed
def _between(profile: Floats, at: float) -> float:
    """Value of a profile between its places, held beyond its ends."""
    at = min(max(at, 0.0), len(profile) - 1.0)
    k = min(int(at), len(profile) - 2)
    return profile[k] + (profile[k + 1] - profile[k]) * (at - k)


@sealed
def _edge_at(profiles: Floats, edge: int, distance: float) -> tuple[float, float]:
    """Change by an edge, −1: none is known, at a distance from it, and its variance over the noise's."""
    if edge < 0:
        return 0.0, _UNKNOWN
    at = distance + 0.5 * (profiles.shape[2] - 1)
    return _between(profiles[edge, 0], at), _between(profiles[edge, 1], at) / _NOISE


@njit(cache=True, nogil=True, error_model="numpy")
def across(distance: Floats, edge: Ints, profiles: Floats) -> tuple[Floats, Floats]:
    """Mean change (M,) at distances from edges, and its variance over the noise's.

    ``profiles`` (K, 2, D) over distances 1 px apart, as many to either side.
    """
    change, variance = np.empty(len(distance)), np.empty(len(distance))
    for n in range(len(distance)):
        change[n], variance[n] = _edge_at(profiles, edge[n], distance[n])
    return change, variance


@njit(cache=True, nogil=True, error_model="numpy")
def carried(source: Floats, target: Floats, about: Floats, local: float) -> Floats:
    """(2, 3) map of an image that carries one outline (V, 2) to another, best within ``local`` px of a place."""
    normal, right = np.zeros((3, 3)), np.zeros((2, 3))
    row, solved = np.ones(3), np.empty((3, 3))
    for n in range(len(source)):
        row[0], row[1] = source[n, 0] - about[0], source[n, 1] - about[1]
        weight = 1.0 / (1.0 + (row[0] ** 2 + row[1] ** 2) / local**2) ** 2
        for i in range(3):
            for j in range(3):
                normal[i, j] += weight * row[i] * row[j]
            for k in range(2):
                right[k, i] += weight * row[i] * target[n, k]
    for k in range(2):
        for i in range(3):
            for j in range(3):
                solved[i, j] = normal[i, j]
        _eliminated(solved, right[k])
        right[k, 2] -= right[k, 0] * about[0] + right[k, 1] * about[1]
    return right


@njit(cache=True, nogil=True, error_model="numpy")
def owned(
    own: tuple[Singles, Singles],
    at: Ints,
    distance: Floats,
    light: tuple[Floats, Floats],
    ends: tuple[float, float, float],
    out: tuple[Floats, Floats],
) -> None:
    """Replace the edge's change and its variance over the noise's, ``out`` (M,), by the part's own image.

    ``own`` (h, w) that image and how many it is the mean of; ``at`` (M, 2) pixels; ``light`` (M,) what
    differs from it beside the needle, and the variance of that; ``ends`` px from the part where film
    begins and where it is all there is, and the least count of a pixel that was seen.
    """
    mean, count = own
    film, many = np.empty(len(at), np.float32), 0
    for n in range(len(at)):
        u, v = at[n]
        if distance[n] > ends[1] - 3.0 and count[v, u] > ends[2]:
            film[many] = mean[v, u]
            many += 1
    if many < 6:
        return
    bright = _selected(film[:many], many // 2)
    if many % 2 == 0:
        bright = 0.5 * (bright + _selected(film[: many // 2], many // 2 - 1))
    for n in range(len(at)):
        u, v = at[n]
        if count[v, u] > ends[2]:
            share = min(max((ends[1] - distance[n]) / (ends[1] - ends[0]), 0.0), 1.0)
            out[0][n] = share * (mean[v, u] + light[0][n] - bright)
            out[1][n] = light[1][n] + 1.25 / max(count[v, u], 1.0)


@sealed
def _keys(part: float, out: Singles) -> None:
    """Weights (4,) of Keys' cubic convolution at a share of a pixel, doi:10.1109/TASSP.1981.1163711."""
    for k in range(4):
        t = abs(k - 1.0 - part)
        near = 1.5 * t**3 - 2.5 * t**2 + 1.0
        out[k] = near if t <= 1.0 else -0.5 * t**3 + 2.5 * t**2 - 4.0 * t + 2.0


@sealed
def _cubic(frame: Image, row: int, column: int, across: Singles, down: Singles) -> float:
    """Grey value right and down of a pixel, those beyond the border being as at it."""
    total = np.float32(0.0)
    if _inside(frame, row, column):
        top, left = np.uintp(row - 1), np.uintp(column - 1)  # a sign would be looked at at each use
        for i in range(np.uintp(4)):
            value = np.float32(0.0)
            for j in range(np.uintp(4)):
                value += across[j] * np.float32(frame[top + i, left + j])
            total += down[i] * value
        return float(total)
    height, width = frame.shape
    for i in range(4):
        above = min(max(row + i - 1, 0), height - 1)
        for j in range(4):
            beside = min(max(column + j - 1, 0), width - 1)
            total += down[i] * across[j] * frame[above, beside]
    return float(total)


@sealed
def _inside(frame: Image, row: int, column: int) -> bool:
    """Whether a cubic about a pixel needs none beyond the border."""
    return 1 <= row < frame.shape[0] - 2 and 1 <= column < frame.shape[1] - 2


@njit(cache=True, nogil=True, error_model="numpy")
def shifted(frame: Image, low: Ints, part: Floats, grey: Singles, inside: Flags) -> None:
    """Piece (h, w) of a frame from a pixel (u, v) and a part of one on, and whether it is within it."""
    across, down = np.empty(4, np.float32), np.empty(4, np.float32)
    _keys(part[0], across)
    _keys(part[1], down)
    for i in range(grey.shape[0]):
        for j in range(grey.shape[1]):
            row, column = low[1] + i, low[0] + j
            grey[i, j] = _cubic(frame, row, column, across, down)
            inside[i, j] = _inside(frame, row, column)


@maker
def _looked(
    frame: Image, pixels: Ints, seen: Flags, shift: Floats, target: Singles, weight: Singles
) -> None:
    """Grey values (N,) of a frame where some pixels (N, 2) came to lie, and whether each can be compared."""
    across, down = np.empty(4, np.float32), np.empty(4, np.float32)
    right, below = int(np.floor(shift[0])), int(np.floor(shift[1]))
    _keys(shift[0] - right, across)
    _keys(shift[1] - below, down)
    for n in range(len(pixels)):
        row, column = pixels[n, 1] + below, pixels[n, 0] + right
        target[n] = _cubic(frame, row, column, across, down)
        weight[n] = 1.0 if seen[n] and _inside(frame, row, column) else 0.0


@sealed
def _times(weight: Singles, trust: Singles, out: Singles) -> float:
    """Weights (N,) times what they are trusted; the sum of the weights."""
    total = 0.0
    for n in range(len(weight)):
        out[n] = weight[n] * trust[n]
        total += weight[n]
    return total


@sealed
def _rest(columns: Singles, solution: Floats, target: Singles, out: Singles) -> None:
    """What a solution leaves (N,)."""
    for n in range(len(target)):
        value = 0.0
        for k in range(np.uintp(len(solution))):
            value += columns[n, k] * solution[k]
        out[n] = target[n] - value


@sealed
def _before_edge(
    edge: Edge,
    shift: Floats,
    start: Floats,
    needle: Needle,
    target: Singles,
    weight: Singles,
    columns: Singles,
) -> None:
    """Take the part's edge behind a needle out of what is compared."""
    rows, distance, normals, edges, profiles = edge
    learned, clear, fading = needle[1], needle[2], needle[3]
    for k in range(len(rows)):
        n = rows[k]
        away = distance[k]
        for i in range(2):
            away += normals[k, i] * (shift[i] - start[i])
        change, variance = _edge_at(profiles, edges[k], away)
        target[n] -= clear[n] * change
        weight[n] /= 1.0 + clear[n] ** 2 * variance
        # the needle stands out against what is behind it there, not against film
        for i in range(2):
            columns[n, 1 + i] = learned[n, 1 + i] - fading[n, i] * change


@maker
def robust(residual: Singles, weight: Singles, out: Singles) -> None:
    """Tukey's weights (N,) of residuals."""
    every, count = np.empty(len(residual), np.float32), 0
    for n in range(len(residual)):
        out[n] = abs(residual[n]) * math.sqrt(weight[n])
        every[count // 2] = out[n] if count % 2 == 0 else every[count // 2]
        count += weight[n] > 0.0
    every = every[: (count + 1) // 2]
    half = len(every) // 2
    middle = _least(every, half)
    if len(every) % 2 == 0:
        middle = 0.5 * (middle + _least(every, half - 1))
    sigma = max(1.4826 * middle, _LEAST_SIGMA)
    for n in range(len(out)):
        out[n] = _biweight((out[n] / (_NEEDLE_TUKEY * sigma)) ** 2)


@sealed
def _alike(residual: Singles, weight: Singles, beside: Ints) -> float:
    """Factor by which noise common to neighbours (compression, resampling) widens a mean."""
    power, right, down = 1e-9, 0.0, 0.0
    for n in range(len(residual)):
        own = residual[n] * math.sqrt(weight[n])
        power += own**2
        if beside[n, 0] >= 0:
            right += own * residual[beside[n, 0]] * math.sqrt(weight[beside[n, 0]])
        if beside[n, 1] >= 0:
            down += own * residual[beside[n, 1]] * math.sqrt(weight[beside[n, 1]])
    return (1.0 + 2.0 * max(right / power, 0.0)) * (1.0 + 2.0 * max(down / power, 0.0))


@sealed
def _judged(
    target: Singles, residual: Singles, weight: Singles, count: int, beside: Ints
) -> tuple[float, float]:
    """Share of the variance that is explained, and the variance of a grey value's mean, widened."""
    total, mean, left, spread = 0.0, 0.0, 0.0, 0.0
    for n in range(len(target)):
        total += weight[n]
        mean += weight[n] * target[n]
        left += weight[n] * residual[n] ** 2
    for n in range(len(target)):
        spread += weight[n] * (target[n] - mean / total) ** 2
    variance = left / max(total - count, 1.0)
    return 1.0 - variance / max(spread / total, 1e-9), variance * _alike(residual, weight, beside)


@njit(cache=True, nogil=True, error_model="numpy")
def registered(
    frame: Image, needle: Needle, edge: Edge, limits: Limits, shift: Floats, covariance: Floats
) -> tuple[float, float, float]:
    """Shift of a needle by Gauss-Newton, reweighted; see `learned.Learned.register`.

    ``limits`` are the least sum of weights, the step in px that ends, and the least gain; ``shift`` (2,)
    is where to start, and is replaced; ``covariance`` (2, 2) is filled. Returns the sum of weights, the
    last step and the share of the variance that is explained.
    """
    pixels, learned, _, _, seen, beside = needle
    many, count = learned.shape
    target, weight = np.empty(many, np.float32), np.empty(many, np.float32)
    weights, residual = np.empty(many, np.float32), np.empty(many, np.float32)
    trust = np.ones(many, np.float32)
    columns, scaled = learned.copy(), np.empty((many, count), np.float32)
    gram, right, start = np.empty((count, count)), np.empty(count), shift.copy()
    for k in range(_NEEDLE_STEPS):
        _looked(frame, pixels, seen, shift, target, weight)
        _before_edge(edge, shift, start, needle, target, weight, columns)
        visible = _times(weight, trust, weights)
        if visible < limits[0]:
            return visible, 0.0, 0.0
        _scaled(columns, weights, scaled)
        products, pulls = np.dot(scaled.T, columns), np.dot(scaled.T, target)
        for i in range(count):
            for j in range(count):
                gram[i, j] = products[i, j]
            right[i] = pulls[i]
            gram[i, i] += 1e-2  # a segment that does not show stays at none
        inverse = np.linalg.inv(gram)
        solution = np.dot(inverse, right)
        _rest(columns, solution, target, residual)
        gain = solution[0] if abs(solution[0]) > limits[2] else 1.0
        step = 0.0
        for i in range(2):
            shift[i] += min(max(solution[1 + i] / gain, -3.0), 3.0)
            step = max(step, abs(solution[1 + i] / gain))
        if k and step < limits[1]:
            break
        if k < 3:  # afterwards the weights rest, so that the steps end
            robust(residual, weight, trust)
    _times(weight, trust, weights)
    score, variance = _judged(target, residual, weights, count, beside)
    for i in range(2):
        for j in range(2):
            covariance[i, j] = variance * inverse[1 + i, 1 + j] / gain**2
    return visible, step, score if abs(solution[0]) > limits[2] else 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def tukey_weights(left: Floats, weight: Floats, out: Floats) -> None:
    """Tukey's biweights (N,) of what is left."""
    for k in range(len(out)):
        out[k] = _biweight(left[k] ** 2 * weight[k] / _TIP_TUKEY**2)


@njit(cache=True, nogil=True, error_model="numpy")
def sample(fine: Singles, at: Floats, finer: int, out: Singles) -> None:
    """Every ``finer``-th value of fine images (K, H, W) from the place ``at`` (u, v) in them on."""
    column, row = int(np.floor(at[0])), int(np.floor(at[1]))
    fu, fv = np.float32(at[0] - column), np.float32(at[1] - row)
    for k in range(len(fine)):
        for i in range(out.shape[1]):
            above, below = fine[k, row + finer * i], fine[k, row + finer * i + 1]
            for j in range(out.shape[2]):
                first = column + finer * j
                left = (np.float32(1.0) - fv) * above[first] + fv * below[first]
                right = (np.float32(1.0) - fv) * above[first + 1] + fv * below[first + 1]
                out[k, i, j] = (np.float32(1.0) - fu) * left + fu * right


@sealed
def _slope(image: Floats | Singles, i: int, j: int) -> tuple[float, float]:
    """Central differences to the right and down, none across the border."""
    right, down = 0.0, 0.0
    if 0 < j < image.shape[1] - 1:
        right = 0.5 * (image[i, j + 1] - image[i, j - 1])
    if 0 < i < image.shape[0] - 1:
        down = 0.5 * (image[i + 1, j] - image[i - 1, j])
    return right, down


@sealed
def _bend(image: Floats | Singles, i: int, j: int) -> tuple[float, float, float]:
    """Second differences to the right, to the right and down, and down; none at the border."""
    if not (0 < i < image.shape[0] - 1 and 0 < j < image.shape[1] - 1):
        return 0.0, 0.0, 0.0
    middle = 2.0 * image[i, j]
    right = image[i, j + 1] - middle + image[i, j - 1]
    down = image[i + 1, j] - middle + image[i - 1, j]
    oblique = image[i + 1, j + 1] - image[i + 1, j - 1] - image[i - 1, j + 1] + image[i - 1, j - 1]
    return right, 0.25 * oblique, down


@sealed
def _through(scene: Floats, variance: float, clear: Singles, i: int, j: int) -> float:
    """What a needle of some transmission lets through at one pixel; see `through`."""
    right, down = _slope(clear, i, j)
    mixed = scene[4, i, j] * down + scene[3, i, j] * right
    return scene[2, i, j] * clear[i, j] + variance * mixed


@sealed
def _bent(scene: Floats, variance: float, clear: Singles, i: int, j: int) -> float:
    """The third term of what a needle lets through, which counts where a tip meets the part's edge."""
    behind, before = _bend(scene[2], i, j), _bend(clear, i, j)
    mixed = behind[0] * before[0] + 2.0 * behind[1] * before[1] + behind[2] * before[2]
    return 0.5 * variance * variance * mixed


@njit(cache=True, nogil=True, error_model="numpy")
def behind(relative: Singles, tip: Floats, axis: Floats, film: Floats, scene: Floats) -> None:
    """The scene behind a needle, and how it varies.

    ``relative`` (h, w) brightness over the film's; ``tip`` (2,) from the first pixel; ``axis`` (2,) of
    the needle; ``film`` (3,) grey value and its slopes along and across the needle a 10 px; ``scene``
    (5, h, w) places along and across, grey values, and their slopes to the right and down.
    """
    for i in range(scene.shape[1]):
        for j in range(scene.shape[2]):
            u, v = j - tip[0], i - tip[1]
            s, n = u * axis[0] + v * axis[1], v * axis[0] - u * axis[1]
            scene[0, i, j], scene[1, i, j] = s, n
            scene[2, i, j] = (film[0] + 0.1 * (film[1] * s + film[2] * n)) * relative[i, j]
    for i in range(scene.shape[1]):
        for j in range(scene.shape[2]):
            scene[3, i, j], scene[4, i, j] = _slope(scene[2], i, j)


@njit(cache=True, nogil=True, error_model="numpy")
def through(scene: Floats, variance: float, clear: Singles, out: Floats) -> None:
    """What needles of some transmissions (K, h, w) let through of what `behind` found; ``out`` alike.

    ``variance`` px² of the blur within which both vary.
    """
    for k in range(len(out)):
        for i in range(out.shape[1]):
            for j in range(out.shape[2]):
                out[k, i, j] = _through(scene, variance, clear[k], i, j)


@njit(cache=True, nogil=True, error_model="numpy")
def compare(
    images: Singles,
    scene: Floats,
    variance: float,
    seen: Singles,
    film: float,
    bounds: Floats,
    own: Floats,
    left: Floats,
    weight: Floats,
) -> None:
    """Slopes in tip and film, what is left, and weights; see `tip_fit`.

    ``images`` (6 or more, h, w) transmission and brightness, their slopes to the right, then down;
    ``seen`` (4, h, w) grey values, relative brightness behind, its variance, and whether it is used;
    ``bounds`` (3,) px ahead, along and aside; ``own`` (5, N), ``left`` and ``weight`` (N,) are filled.
    """
    height, width = scene.shape[1:]
    for i in range(height):
        for j in range(width):
            at, s, n = i * width + j, scene[0, i, j], scene[1, i, j]
            weight[at] = 0.0
            if not (-bounds[0] < s < bounds[1] and abs(n) < bounds[2] + 0.1 * max(s, 0.0)):
                left[at] = 0.0
                for k in range(5):
                    own[k, at] = 0.0
                continue
            clear = images[0, i, j]
            model = _through(scene, variance, images[0], i, j) + film * images[1, i, j]
            if seen[1, i, j] != 1.0:  # before nothing but film, slopes do not change
                model += _bent(scene, variance, images[0], i, j)
            lit = 0.1 * film * seen[1, i, j] * clear
            own[0, at] = -_through(scene, variance, images[2], i, j) - film * images[3, i, j]
            own[1, at] = -_through(scene, variance, images[4], i, j) - film * images[5, i, j]
            own[2, at], own[3, at], own[4, at] = model / film, lit * s, lit * n
            left[at] = seen[0, i, j] - model
            weight[at] = seen[3, i, j] / (_NOISE + seen[2, i, j] * (film * clear) ** 2)


@sealed
def _columns_scaled(columns: Floats, weight: Floats, out: Floats) -> None:
    """Columns (K, N) times their weights."""
    for k in range(len(columns)):
        for n in range(len(weight)):
            out[k, n] = weight[n] * columns[k, n]


@sealed
def _variance(left: Floats, weight: Floats) -> float:
    """Mean of weighted squares over what counts at all."""
    counted, total = 0, 0.0
    for n in range(len(left)):
        counted += weight[n] > 0.0
        total += weight[n] * left[n] ** 2
    return total / max(counted, 1)


@sealed
def _brighter(images: Singles, gain: float, film: float, slope: Floats) -> None:
    """Multiply a needle's brightness and its slopes by a gain; ``slope`` (N,) of the model in that."""
    for i in range(images.shape[1]):
        for j in range(images.shape[2]):
            slope[i * images.shape[2] + j] = film * images[1, i, j]
            for k in range(1, 6, 2):
                images[k, i, j] *= gain


@njit(cache=True, nogil=True, error_model="numpy")
def place(
    fine: Singles,
    seen: Singles,
    film: float,
    part: Floats,
    low: Floats,
    axis: Floats,
    variance: float,
    bounds: Floats,
    grid: Floats,
    normal: Floats,
) -> float:
    """Fit a tip, the film and the needle's gain to one frame by Gauss-Newton; see `tip_fit.place`.

    ``part`` (2,) px of the tip from the window's pixel, which is ``low`` from its first; replaced;
    ``grid`` (3,) fine samples a px, px around the window that the fine images have, and the most that a
    tip may be away from the window's pixel; ``normal`` (6, 6) is filled. Returns the residuals' variance
    in units of their weights.
    """
    finer = int(grid[0])
    images, scene = (
        np.empty((6, seen.shape[1], seen.shape[2]), np.float32),
        np.empty((5, seen.shape[1], seen.shape[2])),
    )
    height, width = seen.shape[1:]
    many = height * width
    own, scaled, left, weight = (
        np.empty((6, many)),
        np.empty((6, many)),
        np.empty(many),
        np.empty(many),
    )
    around, gain, solved = np.array([film, 0.0, 0.0]), 1.0, np.empty((6, 6))
    for count in range(_STEPS):
        sample(fine, finer * (grid[1] - part) + 0.5 * (finer - 1), finer, images)
        _brighter(images, gain, around[0], own[5])
        behind(seen[1], part - low, axis, around, scene)
        compare(images, scene, variance, seen, around[0], bounds, own[:5], left, weight)
        if count:
            for k in range(len(left)):
                weight[k] *= _biweight(left[k] ** 2 * weight[k] / _TIP_TUKEY**2)
        _columns_scaled(own, weight, scaled)
        np.dot(scaled, own.T, normal)
        right = scaled @ left
        normal[5, 5] += _GAIN**-2
        for k in range(6):
            normal[k, k] += 1e-9
        right[5] -= (gain - 1.0) * _GAIN**-2
        for i in range(6):
            for j in range(6):
                solved[i, j] = normal[i, j]
        _eliminated(solved, right)
        for k in range(2):
            moved = part[k] + min(max(right[k], -1.5), 1.5)
            part[k] = min(max(moved, -grid[2]), grid[2])
        for k in range(3):
            around[k] += right[2 + k]
        gain += min(max(right[5], -0.3), 0.3)
    return _variance(left, weight)
