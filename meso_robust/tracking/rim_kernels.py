"""Compiled loops of the rim's fit, apart so that a bad file is refused before they load."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numba import njit

from meso_robust.kernels import maker, sealed
from meso_robust.types import Floats, Image

_SHAPES = 6
_LEVELS, _SHARED = (0, 1, 3, 4), (1, 2, 5, 6, 7)  # of each side, and of all alike; see `_side`
_RIDGE = 1e-6
_FAR = 8.0  # beyond which the series of the scaled error function is exact enough
_STEP = 1.5e-8  # of differences
_FLATTEST = 0.9  # of the variance of the blur that lies between its two halves, at most

Given: TypeAlias = tuple[Floats, Floats, Floats, Floats, float]
"""Where the bins' pixels lie (S, B), normals and arms (S, 3), whiteners (S, B, B), what is compared (S B + S,), and
the weight of a side's slope of the film."""


@sealed
def _scaled_tail(t: float, exponent: float, less: float) -> float:
    """exp(exponent) erfc(t), where exponent is t² - less."""
    if t < _FAR:
        return math.exp(exponent) * math.erfc(t)
    w = 0.5 / (t * t)
    series = 1.0 - w * (1.0 - 3.0 * w * (1.0 - 5.0 * w * (1.0 - 7.0 * w)))
    return math.exp(-less) * series / (t * math.sqrt(math.pi))


@sealed
def _shapes(x: float, blur: float, unknown: Floats, out: Floats) -> None:
    """Add half of background, its slope, meniscus, face, its slope, chamfer (6,), each blurred, at a place outward, px."""
    chamfer, meniscus = math.exp(unknown[4]), math.exp(unknown[5])
    y = x + chamfer
    z, w = x / blur, y / blur
    above, upper = 0.5 * math.erfc(-z / math.sqrt(2.0)), 0.5 * math.erfc(-w / math.sqrt(2.0))
    bell = blur / math.sqrt(2.0 * math.pi) * math.exp(-0.5 * z * z)
    upper_bell = blur / math.sqrt(2.0 * math.pi) * math.exp(-0.5 * w * w)
    rising, inside = x * above + bell, y * upper + upper_bell
    bend = 0.5 * ((x * x + blur * blur) * above + x * bell)
    upper_bend = 0.5 * ((y * y + blur * blur) * upper + y * upper_bell)
    straight = (inside - rising) / chamfer - above
    rounded = 2.0 * inside / chamfer - 2.0 * (upper_bend - bend) / chamfer**2 - above
    out[0] += 0.5 * above
    out[1] += 0.05 * rising
    # exp(-x / meniscus) for x > 0, blurred
    ratio = blur / meniscus
    t = (ratio - z) / math.sqrt(2.0)
    out[2] += 0.25 * _scaled_tail(t, 0.5 * ratio * ratio - x / meniscus, 0.5 * z * z)
    out[3] += 0.5 * (1.0 - above)
    out[4] += 0.05 * (x - rising)
    out[5] += 0.5 * (straight + unknown[6] * (rounded - straight))


@sealed
def _side(given: Given, side: int, unknown: Floats, out: Floats) -> None:
    """Shapes across a side (B, 8): those of `_shapes`, and the chamfer's two cosines to the light.

    The blur is the mean of two normal distributions side by side, about as flat as that of a disc where half of its
    variance lies between them.
    """
    places, normals = given[0][side], given[1]
    away = unknown[2] + normals[side, 2] * unknown[8]
    away += normals[side, 0] * unknown[0] + normals[side, 1] * unknown[1]
    flat, blur = min(max(unknown[7], 0.0), _FLATTEST), math.exp(unknown[3])
    apart, sharp = blur * math.sqrt(flat), blur * math.sqrt(1.0 - flat)
    for b in range(len(places)):
        x = places[b] - away
        for i in range(_SHAPES):
            out[b, i] = 0.0
        _shapes(x - apart, sharp, unknown, out[b])
        _shapes(x + apart, sharp, unknown, out[b])
        for i in range(2):
            out[b, _SHAPES + i] = out[b, _SHAPES - 1] * normals[side, i]


@maker
def design(given: Given, unknown: Floats) -> Floats:
    """(S B + S, 4 S + 5): levels and slopes a side, then what is the same for all.

    That is the film's slope, meniscus, chamfer and its two cosines. The last rows hold each side's slope
    of the film to that of all: a rim that is taken for the edge leaves its own brightness to it.
    """
    count, bins = given[0].shape
    out = np.zeros((count * bins + count, 4 * count + 5))
    shapes = np.empty((bins, _SHAPES + 2))
    for side in range(count):
        _side(given, side, unknown, shapes)
        seen = np.dot(given[2][side], shapes)
        for b in range(bins):
            for k in range(4):
                out[side * bins + b, 4 * side + k] = seen[b, _LEVELS[k]]
            for k in range(5):
                out[side * bins + b, 4 * count + k] = seen[b, _SHARED[k]]
        out[count * bins + side, 4 * side + 1] = given[4]
    return out


@maker
def _solved(given: Given, unknown: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Columns of unit length, those lengths, the inverse of their products, the levels that fit best, and the rest.

    Of a shape that ran to infinity nothing is a number.
    """
    unit = design(given, unknown)
    size, finite = np.zeros(unit.shape[1]), True
    for n in range(len(unit)):
        for k in range(len(size)):
            size[k] += unit[n, k] ** 2
    for k in range(len(size)):
        size[k] = math.sqrt(size[k]) + 1e-9
        finite = finite and math.isfinite(size[k])
    for n in range(len(unit)):
        for k in range(len(size)):
            unit[n, k] = unit[n, k] / size[k] if finite else 0.0
    normal = np.dot(unit.T, unit)
    for k in range(len(size)):
        normal[k, k] += _RIDGE
    inverse = np.linalg.inv(normal)
    levels = np.dot(inverse, np.dot(unit.T, given[3]))
    rest = np.dot(unit, levels)
    for n in range(len(rest)):
        rest[n] = given[3][n] - rest[n] if finite else np.nan
    return unit, size, inverse, levels, rest


@sealed
def _brightness(levels: Floats, size: Floats, side: int, count: int, out: Floats) -> None:
    """Of each shape of one side (8,), its own and what is shared."""
    for k in range(len(out)):
        out[k] = 0.0
    for k in range(4):
        out[_LEVELS[k]] += levels[4 * side + k] / size[4 * side + k]
    for k in range(5):
        out[_SHARED[k]] += levels[4 * count + k] / size[4 * count + k]


@sealed
def _differences(here: Floats, bright: Floats, step: float, there: Floats, line: Floats) -> None:
    """Turn shapes (B, 8) after a step into slopes, and sum them up with their brightnesses (B,)."""
    for b in range(len(line)):
        line[b] = 0.0
        for k in range(len(bright)):
            there[b, k] = (there[b, k] - here[b, k]) / step
            line[b] += there[b, k] * bright[k]


@sealed
def _less(first: Floats, second: Floats, sign: float) -> None:
    """Take a matrix off another, which is changed, and give it a sign."""
    for n in range(len(first)):
        for j in range(first.shape[1]):
            first[n, j] = sign * (first[n, j] - second[n, j])


@njit(cache=True, nogil=True, error_model="numpy")
def misfit(given: Given, unknown: Floats) -> Floats:
    """What the best levels leave (S B + S,) at displacement (2,), δ, shape (5,), and size."""
    return _solved(given, unknown)[4]


@njit(cache=True, nogil=True, error_model="numpy")
def slopes(given: Given, unknown: Floats) -> Floats:
    """How `misfit` varies with each unknown, (S B + S, 9).

    Levels that fit best vary, too: Golub and Pereyra, doi:10.1137/0710036.
    """
    unit, size, inverse, levels, rest = _solved(given, unknown)
    count, bins = given[0].shape
    here, there = np.empty((bins, _SHAPES + 2)), np.empty((bins, _SHAPES + 2))
    model, pull = np.zeros((len(rest), len(unknown))), np.zeros((len(size), len(unknown)))
    bright, line, own = np.empty(_SHAPES + 2), np.empty(bins), np.empty(bins)
    for side in range(count):
        for b in range(bins):
            own[b] = rest[side * bins + b]
        weights = np.dot(given[2][side].T, own)
        _brightness(levels, size, side, count, bright)
        _side(given, side, unknown, here)
        for j in range(len(unknown)):
            moved = unknown.copy()
            moved[j] += _STEP * max(1.0, abs(unknown[j]))
            _side(given, side, moved, there)
            _differences(here, bright, moved[j] - unknown[j], there, line)
            seen = np.dot(given[2][side], line)
            drawn = np.dot(there.T, weights)
            for b in range(bins):
                model[side * bins + b, j] = seen[b]
            for k in range(4):
                pull[4 * side + k, j] += drawn[_LEVELS[k]] / size[4 * side + k]
            for k in range(5):
                pull[4 * count + k, j] += drawn[_SHARED[k]] / size[4 * count + k]
    _less(pull, np.dot(unit.T, model), -1.0)
    turned = np.dot(unit, np.dot(inverse, pull))
    _less(turned, model, 1.0)
    return turned


@njit(cache=True, nogil=True, error_model="numpy")
def binned(
    grey: Floats, hidden: Image, at: Floats, side: Floats, span: Floats, bins: Floats, out: Floats
) -> int:
    """Pixels (N,) by their distance from a side: how many (B,), the sums of grey values, of their squares, of distances.

    ``at`` (N, 2) where they are; ``side`` (6,) start, direction and outward normal; ``span`` (2,) the first
    and last place along it; ``bins`` (3,) the first distance, the width of a bin, and what to count from.
    Returns how many lie farther out than that.
    """
    count, last = 0, bins[0] + bins[1] * out.shape[1]
    for n in range(len(grey)):
        u, v = at[n, 0] - side[0], at[n, 1] - side[1]
        away = u * side[4] + v * side[5]
        along = u * side[2] + v * side[3]
        if not (bins[0] < away < last and span[0] < along < span[1]) or hidden[n]:
            continue
        k = int((away - bins[0]) / bins[1])
        out[0, k] += 1.0
        out[1, k] += grey[n]
        out[2, k] += float(grey[n]) ** 2
        out[3, k] += away
        count += away > bins[2]
    return count
