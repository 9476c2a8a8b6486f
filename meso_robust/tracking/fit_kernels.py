"""Compiled loops of the tracker's fits, apart so that a bad file is refused before they load.

They are in one file, since a kernel kept on disk is renewed when its own file changes.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from meso_robust.kernels import inner
from meso_robust.types import Flags, Floats, Ints, Singles

_LINEAR = 2.0  # px, displacement beyond which the filters of a pattern say nothing
_EDGE_TUKEY = (
    4.0  # scales at which Tukey's weight vanishes (4.685 is 95 % efficient; shadows abound)
)
_NEEDLE_TUKEY = 4.7
_TIP_TUKEY = 5.0
_ROUNDS = 5  # of reweighting
_LEAST_SIGMA = 0.5  # grey values, of what a learned needle leaves
_NOISE = 4.0  # grey values²
_GAIN = 0.05  # by which the needle's brightness over the film's may vary
_STEPS = 3  # towards a tip


@inner
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


@inner
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


@inner
def _biweight(square: float) -> float:
    """Tukey's biweight of the square of a residual over where it vanishes."""
    return max(1.0 - square, 0.0) ** 2


@inner
def _spread(sizes: Floats) -> float:
    """Robust standard deviation (median) of absolute values, which are reordered; 1 of nothing."""
    return 1.4826 * _selected(sizes, len(sizes) // 2) if len(sizes) else 1.0


@inner
def _scaled(rows: Floats | Singles, weight: Floats | Singles, out: Floats | Singles) -> None:
    """Rows (N, K) times their weights."""
    for n in range(len(weight)):
        for k in range(rows.shape[1]):
            out[n, k] = weight[n] * rows[n, k]


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
    """Normal matrix and right side of weighted least squares."""
    normal[:], right[:] = 0.0, 0.0
    for n in range(len(design)):
        if weight[n] > 0.0:
            for i in range(len(right)):
                scaled = weight[n] * design[n, i]
                right[i] += scaled * offset[n]
                for j in range(len(right)):
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
) -> None:
    """One round of `ssd.registered`: solve with the weights (M,), then renew them.

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


@njit(cache=True, nogil=True, error_model="numpy")
def gathered(
    grey: Singles, inside: Flags, seen: Flags, rows: Ints, target: Singles, weight: Singles
) -> None:
    """Grey values (N,) of some pixels of an image (h, w), and whether each can be compared."""
    width = grey.shape[1]
    for n in range(len(rows)):
        i, j = rows[n] // width, rows[n] % width
        target[n] = grey[i, j]
        weight[n] = 1.0 if inside[i, j] and seen[i, j] else 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def before_edge(
    rows: Ints,
    change: Singles,
    variance: Singles,
    clear: Singles,
    fading: Floats,
    learned: Singles,
    view: tuple[Singles, Singles, Singles],
) -> None:
    """Take the part's edge behind a needle out of a view: target, weight and columns are changed.

    ``clear`` (N,) and ``fading`` (N, 2) are the needle's transmission and its slopes, ``learned`` (N, K)
    the columns without an edge.
    """
    target, weight, columns = view
    for k in range(len(rows)):
        n = rows[k]
        target[n] -= clear[n] * change[k]
        weight[n] /= np.float32(1.0) + clear[n] ** 2 * variance[k]
        # the needle stands out against what is behind it there, not against film
        for i in range(2):
            columns[n, 1 + i] = learned[n, 1 + i] - fading[n, i] * change[k]


@njit(cache=True, nogil=True, error_model="numpy")
def weighed(weight: Singles, columns: Singles, out: Singles) -> None:
    """Rows (N, K) times their weights."""
    _scaled(columns, weight, out)


@njit(cache=True, nogil=True, error_model="numpy")
def robust(residual: Singles, weight: Singles, out: Singles) -> None:
    """Tukey's weights (N,) of residuals."""
    every, count = np.empty(len(residual), np.float32), 0
    for n in range(len(residual)):
        out[n] = abs(residual[n]) * math.sqrt(weight[n])
        every[count // 2] = out[n] if count % 2 == 0 else every[count // 2]
        count += weight[n] > 0.0
    every = every[: (count + 1) // 2]
    half = len(every) // 2
    middle = _selected(every, half)
    if len(every) % 2 == 0:
        middle = 0.5 * (middle + _selected(every[:half], half - 1))
    sigma = max(1.4826 * middle, _LEAST_SIGMA)
    for n in range(len(out)):
        out[n] = _biweight((out[n] / (_NEEDLE_TUKEY * sigma)) ** 2)


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


@inner
def _slope(image: Floats | Singles, i: int, j: int) -> tuple[float, float]:
    """Central differences to the right and down, none across the border."""
    right, down = 0.0, 0.0
    if 0 < j < image.shape[1] - 1:
        right = 0.5 * (image[i, j + 1] - image[i, j - 1])
    if 0 < i < image.shape[0] - 1:
        down = 0.5 * (image[i + 1, j] - image[i - 1, j])
    return right, down


@inner
def _through(scene: Floats, variance: float, clear: Singles, i: int, j: int) -> float:
    """What a needle of some transmission lets through at one pixel; see `through`."""
    right, down = _slope(clear, i, j)
    mixed = scene[4, i, j] * down + scene[3, i, j] * right
    return scene[2, i, j] * clear[i, j] + variance * mixed


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
            lit = 0.1 * film * seen[1, i, j] * clear
            own[0, at] = -_through(scene, variance, images[2], i, j) - film * images[3, i, j]
            own[1, at] = -_through(scene, variance, images[4], i, j) - film * images[5, i, j]
            own[2, at], own[3, at], own[4, at] = model / film, lit * s, lit * n
            left[at] = seen[0, i, j] - model
            weight[at] = seen[3, i, j] / (_NOISE + seen[2, i, j] * (film * clear) ** 2)


@inner
def _columns_scaled(columns: Floats, weight: Floats, out: Floats) -> None:
    """Columns (K, N) times their weights."""
    for k in range(len(columns)):
        for n in range(len(weight)):
            out[k, n] = weight[n] * columns[k, n]


@inner
def _variance(left: Floats, weight: Floats) -> float:
    """Mean of weighted squares over what counts at all."""
    counted, total = 0, 0.0
    for n in range(len(left)):
        counted += weight[n] > 0.0
        total += weight[n] * left[n] ** 2
    return total / max(counted, 1)


@inner
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
