"""Compiled loops of the fit of a tip, apart so that a bad file is refused before they load."""

from __future__ import annotations

import numpy as np
from numba import njit

from meso_robust.kernels import inner
from meso_robust.types import Floats, Singles

_NOISE = 4.0  # grey values²
_TUKEY = 5.0  # standard deviations beyond which a pixel does not count
_GAIN = 0.05  # by which the needle's brightness over the film's may vary
_STEPS = 3


@inner
def _tukey(left: float, weight: float) -> float:
    """Tukey's biweight of what is left of a grey value whose variance is one over the weight."""
    return max(1.0 - left**2 * weight / _TUKEY**2, 0.0) ** 2


@njit(cache=True, nogil=True, error_model="numpy")
def tukey_weights(left: Floats, weight: Floats, out: Floats) -> None:
    """Tukey's biweights (N,) of what is left."""
    for k in range(len(out)):
        out[k] = _tukey(left[k], weight[k])


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
                left[at], own[:, at] = 0.0, 0.0
                continue
            clear = images[0, i, j]
            model = _through(scene, variance, images[0], i, j) + film * images[1, i, j]
            lit = 0.1 * film * seen[1, i, j] * clear
            own[0, at] = -_through(scene, variance, images[2], i, j) - film * images[3, i, j]
            own[1, at] = -_through(scene, variance, images[4], i, j) - film * images[5, i, j]
            own[2, at], own[3, at], own[4, at] = model / film, lit * s, lit * n
            left[at] = seen[0, i, j] - model
            weight[at] = seen[3, i, j] / (_NOISE + seen[2, i, j] * (film * clear) ** 2)


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
    covariance: Floats,
) -> None:
    """Fit a tip, the film and the needle's gain to one frame by Gauss-Newton; see `tip_fit.place`.

    ``part`` (2,) px of the tip from the window's pixel, which is ``low`` from its first; replaced;
    ``grid`` (3,) fine samples a px, px around the window that the fine images have, and the most that a
    tip may be away from the window's pixel; ``covariance`` (2, 2) is filled.
    """
    finer = int(grid[0])
    images, scene = np.empty((6, *seen.shape[1:]), np.float32), np.empty((5, *seen.shape[1:]))
    own, left, weight = np.empty((6, seen[0].size)), np.empty(seen[0].size), np.empty(seen[0].size)
    around, gain, normal = np.array([film, 0.0, 0.0]), 1.0, np.empty((6, 6))
    for count in range(_STEPS):
        sample(fine, finer * (grid[1] - part) + 0.5 * (finer - 1), finer, images)
        images[1::2] *= np.float32(gain)
        behind(seen[1], part - low, axis, around, scene)
        compare(images, scene, variance, seen, around[0], bounds, own[:5], left, weight)
        own[5] = around[0] / gain * images[1].ravel()
        if count:
            for k in range(len(left)):
                weight[k] *= _tukey(left[k], weight[k])
        scaled = own * weight
        normal[:] = scaled @ own.T
        right = scaled @ left
        normal[5, 5] += _GAIN**-2
        for k in range(6):
            normal[k, k] += 1e-9
        right[5] -= (gain - 1.0) * _GAIN**-2
        step = np.linalg.solve(normal, right)
        for k in range(2):
            moved = part[k] + min(max(step[k], -1.5), 1.5)
            part[k] = min(max(moved, -grid[2]), grid[2])
        around += step[2:5]
        gain += min(max(step[5], -0.3), 0.3)
    many = max(np.count_nonzero(weight > 0.0), 1)
    covariance[:] = np.sum(weight * left**2) / many * np.linalg.inv(normal)[:2, :2]
