"""Compiled loops along the part's border, apart so that a bad file is refused before they load."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numba import njit

from meso_robust.types import Flags, Floats, Image, Ints, Singles

_CORNER = 7.0  # px from a corner that count as neither of its edges
_STRAIGHT = 0.97  # cosine; edges that turn less are one

Sides: TypeAlias = tuple[Floats, Floats, Floats, Floats, Flags, Ints]
"""Of each side (V): start, direction, outward normal, length, whether it starts at a corner, its edge."""


@njit(cache=True, nogil=True, error_model="numpy")
def sides(outline: Floats) -> Sides:
    """The sides of an outline (V, 2); those that turn little are one edge."""
    count = len(outline)
    along, outward = np.empty((count, 2)), np.empty((count, 2))
    lengths, sharp, edges = np.empty(count), np.empty(count, np.bool_), np.empty(count, np.int64)
    area = 0.0
    for k in range(count):
        a, b = outline[k], outline[(k + 1) % count]
        u, v = b[0] - a[0], b[1] - a[1]
        lengths[k] = math.hypot(u, v)
        along[k, 0], along[k, 1] = u / lengths[k], v / lengths[k]
        area += a[0] * b[1] - a[1] * b[0]
    edge = 0
    for k in range(count):
        outward[k, 0] = np.sign(area) * along[k, 1]
        outward[k, 1] = -np.sign(area) * along[k, 0]
        before = along[(k - 1) % count]
        sharp[k] = along[k, 0] * before[0] + along[k, 1] * before[1] < _STRAIGHT
        edge += sharp[k]
        edges[k] = edge
    if not sharp[0]:  # the last edge goes on over the first corner of the list
        for k in range(count):
            edges[k] = edges[k] if edges[k] != edge else 0
    return outline, along, outward, lengths, sharp, edges


@njit(cache=True, nogil=True, error_model="numpy")
def extent(places: Floats) -> Floats:
    """(2, 2) least and largest coordinates of places (N, 2)."""
    found = np.array([[math.inf, math.inf], [-math.inf, -math.inf]])
    for n in range(len(places)):
        for k in range(2):
            found[0, k] = min(found[0, k], places[n, k])
            found[1, k] = max(found[1, k], places[n, k])
    return found


@njit(cache=True, nogil=True, error_model="numpy")
def within(band: Image, places: Floats, low: Floats) -> Ints:
    """Which places (N, 2) lie on a pixel of a band that is not zero; its first one is at ``low``."""
    found, count = np.empty(len(places), np.int64), 0
    for n in range(len(places)):
        u, v = int(np.rint(places[n, 0] - low[0])), int(np.rint(places[n, 1] - low[1]))
        if band[v, u]:
            found[count] = n
            count += 1
    return found[:count]


@njit(cache=True, nogil=True, error_model="numpy")
def nearest(border: Sides, about: Floats) -> tuple[Floats, Floats, Ints, Ints]:
    """The side nearest to each place (M, 2): distance outward, its normal, its edge, and that or −1.

    The last is −1 beside a corner.
    """
    starts, along, outward, lengths, sharp, edges = border
    distance, normals = np.empty(len(about)), np.empty((len(about), 2))
    nearby, edge = np.empty(len(about), np.int64), np.empty(len(about), np.int64)
    for n in range(len(about)):
        best, least, at = 0, math.inf, 0.0
        for k in range(len(starts)):
            u, v = about[n, 0] - starts[k, 0], about[n, 1] - starts[k, 1]
            place = min(max(u * along[k, 0] + v * along[k, 1], 0.0), lengths[k])
            square = (u - place * along[k, 0]) ** 2 + (v - place * along[k, 1]) ** 2
            if square < least:
                best, least, at = k, square, place
        after = sharp[(best + 1) % len(sharp)]
        cornered = sharp[best] and at < _CORNER
        cornered = cornered or (after and lengths[best] - at < _CORNER)
        nearby[n] = edges[best]
        edge[n] = -1 if cornered else edges[best]
        distance[n] = 0.0
        for i in range(2):
            normals[n, i] = outward[best, i]
            distance[n] += (about[n, i] - starts[best, i]) * outward[best, i]
    return distance, normals, nearby, edge


@njit(cache=True, nogil=True, error_model="numpy")
def rays(
    border: Sides, edge: int, middle: Floats, reach: float, apart: float, distances: Floats
) -> Floats:
    """Places (L, D, 2) across an edge, within ``reach`` of the foot of ``middle`` (2,), off its corners."""
    starts, along, outward, lengths, sharp, edges = border
    most = 0
    for k in range(len(starts)):
        most += int(min(lengths[k], 2.0 * reach) / apart) + 2
    found, count = np.empty((most, len(distances), 2)), 0
    for k in range(len(starts)):
        if edges[k] != edge:
            continue
        u, v = middle[0] - starts[k, 0], middle[1] - starts[k, 1]
        foot = u * along[k, 0] + v * along[k, 1]
        first = max(_CORNER if sharp[k] else 0.0, foot - reach)
        last = lengths[k] - (_CORNER if sharp[(k + 1) % len(sharp)] else 0.0)
        for j in range(math.ceil((min(last, foot + reach) - first) / apart)):
            for d in range(len(distances)):
                for i in range(2):
                    start = starts[k, i] + (first + j * apart) * along[k, i]
                    found[count, d, i] = start + distances[d] * outward[k, i]
            count += 1
    return found[:count]


@njit(cache=True, nogil=True, error_model="numpy")
def across(
    distance: Floats, edge: Ints, profiles: Floats, first: float, out: tuple[Singles, Singles]
) -> None:
    """Mean change and its variance (M,) at distances from edges, −1: none, there nothing is changed.

    ``profiles`` (K, 2, D) over distances from ``first`` on, 1 px apart.
    """
    last = profiles.shape[2] - 1
    for n in range(len(distance)):
        if edge[n] < 0:
            continue
        at = min(max(distance[n] - first, 0.0), float(last))
        k = min(int(at), last - 1)
        for i in range(2):
            left, right = profiles[edge[n], i, k], profiles[edge[n], i, k + 1]
            out[i][n] = left + (right - left) * (at - k)
