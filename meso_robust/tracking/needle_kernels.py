"""Compiled loops that draw a needle finely and look at the part's border behind it.

They are apart so that a bad file is refused before they load.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numba import njit

from meso_robust.kernels import maker, sealed
from meso_robust.tracking.meniscus import CLIMB, COUNT, HEIGHTS, RINGS
from meso_robust.types import Flags, Floats, Image, Ints, Singles

_HALO = 12.0
"""px; the film may darken or brighten towards the needle over an eighth of it and over a third."""
KNOTS = 5
"""Of the brightness across the needle, evenly from one flank to the other."""
FINE_KNOTS = 7
"""Likewise where many frames tell it."""
BASIS = 6 + KNOTS
"""Images of `basis`: film and its two slopes, two halos, the needle's brightness and its slope."""
_SHARPEST = 0.1  # px, standard deviation of an edge in focus
_CERTAIN = 8.0  # standard deviations beyond which a normal distribution is 0 or 1
_CORNER = 7.0  # px from a corner that count as neither of its edges
_STRAIGHT = 0.97  # cosine; edges that turn less are one
_LEAST = 8  # places along an edge that tell its profile

Sides: TypeAlias = tuple[Floats, Floats, Floats, Floats, Flags, Ints]
"""Of each side (V): start, direction, outward normal, length, whether it starts at a corner, its edge."""
Needle: TypeAlias = tuple[float, float, float, float, float, float, float]
"""Tip (u, v), axis, cosine and sine of the taper, radius; px."""
Near: TypeAlias = tuple[Ints, Floats, Floats, Ints]
"""Rows (M,) of places near a border, their distance outward, (M, 2) its normals, and its edge or −1."""


@sealed
def _distance(s: float, n: float, c: float, d: float, radius: float) -> float:
    """Signed distance to a needle of taper (cos, sin) = (c, d), negative inside, px."""
    if s * c + abs(n) * d >= 0.0:
        return abs(n) * c - s * d - radius
    return math.sqrt(s * s + n * n) - radius


def half_width(s: float, c: float, d: float, radius: float) -> float:
    """Half the width at a place along the axis, at least the radius, px."""
    return max(radius / c + s * d / c, radius)


_half_width = sealed(half_width)


@sealed
def _covered(distance: float, s: float, rise: float) -> float:
    """Share of a fine sample that a needle covers, which rises out of focus along its shaft."""
    z = distance / max(rise * s, _SHARPEST)
    if abs(z) > _CERTAIN:
        return 0.0 if z > 0.0 else 1.0
    return 0.5 * math.erfc(z / math.sqrt(2.0))


@sealed
def _halos(distance: float) -> tuple[float, float]:
    """Shares of the two halos at a distance from a needle."""
    part = math.exp(-max(distance, 0.0) / _HALO)  # a root of both, as an exponential takes long
    return part**8, part**3


@sealed
def _ring(away: float, ring: int) -> float:
    """Share of one of `RINGS` in a meniscus at a distance from a needle, from one to the next."""
    share = (RINGS[ring + 1] - away) / (RINGS[ring + 1] - RINGS[ring])
    if ring > 0:
        share = min((away - RINGS[ring - 1]) / (RINGS[ring] - RINGS[ring - 1]), share)
    return max(share, 0.0)


@sealed
def _hat(across: float, knot: int, knots: int) -> float:
    """Share of one of some knots of the brightness at a place across a needle, in half widths."""
    return max(0.0, 1.0 - abs(across - (2.0 * knot / (knots - 1) - 1.0)) * 0.5 * (knots - 1))


@sealed
def _ramp(z: float) -> tuple[float, float]:
    """A step and a ramp that begin at 0, convolved with a normal distribution of deviation 1."""
    if abs(z) > _CERTAIN:
        return (1.0, z) if z > 0.0 else (0.0, 0.0)
    step = 0.5 * math.erfc(-z / math.sqrt(2.0))
    return step, z * step + math.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi)


@sealed
def _defocused(n: float, half: float, sigma: float, out: Floats) -> None:
    """Shares (K,), of sum 1, of knots at a place n across a needle that is blurred by sigma.

    What is seen on a shaft is as much out of focus as its flanks: the knots' hats, which end at the
    flanks, are convolved with a normal distribution.
    """
    last = len(out) - 1
    apart = 2.0 * half / last
    first, before = _ramp((n + half) / sigma)
    out[0] = first
    for knot in range(1, last + 1):
        step, ramp = _ramp((n + half - knot * apart) / sigma)
        risen = sigma * (before - ramp) / apart  # of the hat of this knot, from the one before
        out[knot - 1] -= risen
        out[knot] = risen if knot < last else risen - step
        before = ramp
    total = max(out.sum(), 1e-9)  # before the flanks nothing but rounding is left
    for knot in range(last + 1):
        out[knot] /= total


@njit(cache=True, nogil=True, error_model="numpy")
def distances(s: Floats, n: Floats, taper: float, radius: float, out: Floats) -> None:
    """Signed distances (N,) of places along and across the axis."""
    c, d = math.cos(taper), math.sin(taper)
    for k in range(len(out)):
        out[k] = _distance(s[k], n[k], c, d, radius)


@njit(cache=True, nogil=True, error_model="numpy")
def film_beside(grey: Image, needle: Needle, near: float, far: float) -> float:
    """Median of the grey values (h, w) between two distances from a needle; NaN of none."""
    counts, total = np.zeros(256, np.int64), 0
    for i in range(grey.shape[0]):
        for j in range(grey.shape[1]):
            u, v = j - needle[0], i - needle[1]
            s, n = u * needle[2] + v * needle[3], v * needle[2] - u * needle[3]
            if near < _distance(s, n, needle[4], needle[5], needle[6]) < far:
                counts[grey[i, j]] += 1
                total += 1
    if total == 0:
        return np.nan
    low, high, before = -1, -1, 0
    for value in range(256):
        before += counts[value]
        low = value if low < 0 and before > (total - 1) // 2 else low
        high = value if high < 0 and before > total // 2 else high
    return 0.5 * (low + high)


@sealed
def _samples(
    u: float, v: float, axis: Floats, shape: Floats, finer: int, first: int, last: int, line: Floats
) -> None:
    """Images of `basis` at fine samples of one row, finer a px, from the tip at (u, v) before them."""
    radius, rise = shape[1], shape[2]
    c, d = math.cos(shape[0]), math.sin(shape[0])
    for j in range(first, last):
        x = u + (j + 0.5) / finer - 0.5
        s, n = x * axis[0] + v * axis[1], v * axis[0] - x * axis[1]
        distance = _distance(s, n, c, d, radius)
        inside = _covered(distance, s, rise)
        film = 1.0 - inside
        out = line[j - first]
        out[0], out[1], out[2] = film, 0.1 * film * s, 0.1 * film * n
        near, wide = _halos(distance) if film > 0.0 else (0.0, 0.0)
        out[3], out[4] = film * near, film * wide
        across = n / _half_width(s, c, d, radius) if inside > 0.0 else 0.0
        for knot in range(KNOTS):
            out[5 + knot] = inside * _hat(across, knot, KNOTS) if inside > 0.0 else 0.0
        out[5 + KNOTS] = 0.1 * inside * s


@sealed
def _span(columns: Ints) -> tuple[int, int]:
    """The first column of several rows, and the one after their last; (0, 0) if there is none."""
    first, last = 0, 0
    for row in range(len(columns)):
        if columns[row, 0] < columns[row, 1]:
            first = min(first, columns[row, 0]) if first < last else columns[row, 0]
            last = max(last, columns[row, 1])
    return first, last


@sealed
def _gathered(line: Floats, begin: int, weights: Floats, out: Floats) -> None:
    """Weighted sum of fine samples."""
    out[:] = 0.0
    for t in range(len(weights)):
        for k in range(BASIS):
            out[k] += weights[t] * line[begin + t, k]


@njit(cache=True, nogil=True, error_model="numpy")
def basis(
    tip: Floats, axis: Floats, shape: Floats, blur: Floats, finer: int, columns: Ints, out: Floats
) -> None:
    """Images of film and needle, drawn finely, blurred and summed over pixels.

    ``tip`` (2,) from the first pixel, ``axis`` (2,), ``shape`` (taper, radius, rise), ``blur`` the
    weights of fine samples in a pixel, ``finer`` of which lie in one, ``columns`` (h, 2) first and last-but-one pixel of each row that
    is drawn, ``out`` (h, w, BASIS), zeros.
    """
    rows, reach = len(columns), (len(blur) - finer) // 2
    longest = finer * out.shape[1] + 2 * reach
    line, across = np.empty((longest, BASIS)), np.empty((out.shape[1], BASIS))
    for i in range(-reach, finer * rows + reach):
        low = max(-((reach + finer - 1 - i) // finer), 0)
        high = min((i + reach) // finer + 1, rows)
        first, last = _span(columns[low:high])
        if first >= last:
            continue
        begin = finer * first - reach
        v = (i + 0.5) / finer - 0.5 - tip[1]
        _samples(-tip[0], v, axis, shape, finer, begin, finer * last + reach, line)
        for column in range(first, last):
            _gathered(line, finer * (column - first), blur, across[column])
        for row in range(low, high):
            weight = blur[i - finer * row + reach]
            for column in range(columns[row, 0], columns[row, 1]):
                for k in range(BASIS):
                    out[row, column, k] += weight * across[column, k]


@njit(cache=True, nogil=True, error_model="numpy")
def layers(first: Floats, axis: Floats, shape: Floats, finer: int, out: Singles) -> None:
    """Sharp images of a needle as `alpha_matting.layers` has them, at fine samples.

    ``first`` (2,) px from the tip to the first sample, ``axis`` (2,), ``shape`` (taper, radius, rise),
    ``out`` (1 + HALO_COUNT + OWN_COUNT, h, w).
    """
    radius, rise = shape[1], shape[2]
    c, d = math.cos(shape[0]), math.sin(shape[0])
    shares = np.empty(FINE_KNOTS)
    first_own = 1 + COUNT
    for i in range(out.shape[1]):
        for j in range(out.shape[2]):
            u, v = first[0] + j / finer, first[1] + i / finer
            s, n = u * axis[0] + v * axis[1], v * axis[0] - u * axis[1]
            distance = _distance(s, n, c, d, radius)
            inside = _covered(distance, s, rise)
            clear = 1.0 - inside
            out[0, i, j] = clear
            # how far the meniscus reaches up the needle is not known: three hats along the axis
            up = s / CLIMB
            hats = (
                min(max(1.0 - up, 0.0), 1.0),
                max(1.0 - abs(up - 1.0), 0.0),
                min(max(up - 1.0, 0.0), 1.0),
            )
            for ring in range(len(RINGS) - 1):
                share = clear * _ring(max(distance, 0.0), ring)
                for k in range(HEIGHTS):
                    out[1 + HEIGHTS * ring + k, i, j] = share * hats[k]
            if inside > 0.0:
                sigma = max(rise * s, _SHARPEST)
                _defocused(n, _half_width(s, c, d, radius), sigma, shares)
            for knot in range(FINE_KNOTS):
                out[first_own + knot, i, j] = inside * shares[knot] if inside > 0.0 else 0.0
            out[first_own + FINE_KNOTS, i, j] = 0.1 * inside * s


@maker
def _sides(outline: Floats) -> Sides:
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


@sealed
def _foot(sides: Sides, k: int, u: float, v: float) -> tuple[float, float]:
    """How far along a side the place nearest to (u, v) is, and the square of the distance, px²."""
    x, y = u - sides[0][k, 0], v - sides[0][k, 1]
    along = sides[1][k]
    at = min(max(x * along[0] + y * along[1], 0.0), sides[3][k])
    return at, (x - at * along[0]) ** 2 + (y - at * along[1]) ** 2


@sealed
def _touches(sides: Sides, k: int, low: Floats, high: Floats, reach: float) -> bool:
    """Whether the box around a side comes within reach of a box."""
    for i in range(2):
        a = sides[0][k, i]
        b = a + sides[3][k] * sides[1][k, i]
        if max(a, b) < low[i] - reach or min(a, b) > high[i] + reach:
            return False
    return True


@sealed
def _extent(places: Floats, low: Floats, high: Floats) -> None:
    """Least and largest coordinates (2,) of places (N, 2)."""
    for i in range(2):
        low[i], high[i] = math.inf, -math.inf
        for n in range(len(places)):
            low[i], high[i] = min(low[i], places[n, i]), max(high[i], places[n, i])


@sealed
def _nearest(sides: Sides, tried: Flags, u: float, v: float) -> tuple[int, float, float]:
    """The side nearest to a place among those that are tried, how far along it, and the square of how near."""
    best, foot, least = 0, 0.0, math.inf
    for k in range(len(tried)):
        if tried[k]:
            at, square = _foot(sides, k, u, v)
            if square < least:
                best, foot, least = k, at, square
    return best, foot, least


@sealed
def _cornered(sides: Sides, k: int, foot: float) -> bool:
    """Whether a place along a side is beside a corner."""
    sharp = sides[4]
    after = sharp[(k + 1) % len(sharp)]
    return (sharp[k] and foot < _CORNER) or (after and sides[3][k] - foot < _CORNER)


@maker
def _near(sides: Sides, places: Floats, reach: float) -> tuple[Near, Flags]:
    """Places (N, 2) within reach of the border, and which edges they are nearest to."""
    low, high = np.empty(2), np.empty(2)
    _extent(places, low, high)
    tried, edges, most, many = np.empty(len(sides[3]), np.bool_), sides[5], 0, 0
    for k in range(len(tried)):
        tried[k] = _touches(sides, k, low, high, reach)
        many = len(places) if tried[k] else many
        most = max(most, edges[k])
    rows, distance, normals = np.empty(many, np.int64), np.empty(many), np.empty((many, 2))
    edge, present, count = np.empty(many, np.int64), np.zeros(most + 1, np.bool_), 0
    for n in range(many):
        side, foot, square = _nearest(sides, tried, places[n, 0], places[n, 1])
        if square > reach**2:
            continue
        rows[count], distance[count] = n, 0.0
        present[edges[side]] = True
        edge[count] = -1 if _cornered(sides, side, foot) else edges[side]
        for i in range(2):
            normals[count, i] = sides[2][side, i]
            distance[count] += (places[n, i] - sides[0][side, i]) * sides[2][side, i]
        count += 1
    return (rows[:count], distance[:count], normals[:count], edge[:count]), present


@sealed
def _free(ray: Floats, needle: Needle, near: float, size: Floats) -> bool:
    """Whether places (D, 2) lie in the frame and farther than ``near`` from a needle."""
    for d in range(len(ray)):
        u, v = ray[d, 0] - needle[0], ray[d, 1] - needle[1]
        if not (1.0 <= ray[d, 0] <= size[0] - 2.0 and 1.0 <= ray[d, 1] <= size[1] - 2.0):
            return False
        s, n = u * needle[2] + v * needle[3], v * needle[2] - u * needle[3]
        if _distance(s, n, needle[4], needle[5], needle[6]) <= near:
            return False
    return True


@sealed
def _rays(
    sides: Sides,
    edge: int,
    middle: Floats,
    reach: Floats,
    needle: Needle,
    size: Floats,
    out: Floats,
) -> int:
    """Places (L, D, 2) across an edge about the foot of ``middle``, off its corners; how many are free."""
    starts, along, outward, lengths, sharp, edges = sides
    count, half = 0, 0.5 * (out.shape[1] - 1)
    for k in range(len(starts)):
        if edges[k] != edge:
            continue
        u, v = middle[0] - starts[k, 0], middle[1] - starts[k, 1]
        foot = u * along[k, 0] + v * along[k, 1]
        first = max(_CORNER if sharp[k] else 0.0, foot - reach[2])
        last = lengths[k] - (_CORNER if sharp[(k + 1) % len(sharp)] else 0.0)
        for j in range(math.ceil((min(last, foot + reach[2]) - first) / reach[3])):
            for d in range(out.shape[1]):
                for i in range(2):
                    start = starts[k, i] + (first + j * reach[3]) * along[k, i]
                    out[count, d, i] = start + (d - half) * outward[k, i]
            count += _free(out[count], needle, reach[1], size)
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def border(
    outline: Floats, places: Floats, needle: Needle, size: Floats, reach: Floats, many: int
) -> tuple[Near, Floats, Ints]:
    """The part's border near places (N, 2), and where it is read beside a needle; see `edge_profile`.

    ``size`` (2,) of the frame; ``reach``
    (4,) px from the border that count, from the needle, along the border, and between the places along it;
    ``many`` places across it. Returns what is near, with the edges counted among those that are read,
    (K, L, D, 2) where they are read, and (K,) how many of L.
    """
    sides = _sides(outline)
    near, present = _near(sides, places, reach[0])
    about, low, high = np.empty((len(near[0]), 2)), np.empty(2), np.empty(2)
    for n in range(len(about)):
        about[n, 0], about[n, 1] = places[near[0][n], 0], places[near[0][n], 1]
    _extent(about, low, high)
    middle = np.empty(2)
    middle[0], middle[1] = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])
    wide = reach.copy()
    wide[2] += 0.5 * max(high[0] - low[0], high[1] - low[1])
    most, kept = 1, 0
    for edge in range(len(present)):
        kept += present[edge]
    for k in range(len(sides[3]) if len(near[0]) else 0):
        most += int(min(sides[3][k], 2.0 * wide[2]) / reach[3]) + 2
    rays = np.empty((kept, most, many, 2))
    counts, index, used = np.empty(kept, np.int64), np.empty(len(present), np.int64), 0
    for edge in range(len(present)):
        index[edge] = -1
        if present[edge]:
            counts[used] = _rays(sides, edge, middle, wide, needle, size, rays[used])
            if counts[used] >= _LEAST:
                index[edge] = used
                used += 1
    for n in range(len(near[3])):
        near[3][n] = index[near[3][n]] if near[3][n] >= 0 else -1
    return near, rays[:used], counts[:used]


@sealed
def _read(frame: Image | Singles, u: float, v: float) -> float:
    """Grey value between the pixels, at a place within the frame."""
    column, row = min(int(u), frame.shape[1] - 2), min(int(v), frame.shape[0] - 2)
    a, b = u - column, v - row
    top = (1.0 - a) * frame[row, column] + a * frame[row, column + 1]
    bottom = (1.0 - a) * frame[row + 1, column] + a * frame[row + 1, column + 1]
    return (1.0 - b) * top + b * bottom


@sealed
def _middle(a: float, b: float, c: float) -> float:
    """The median of three."""
    return max(min(a, b), min(max(a, b), c))


@njit(cache=True, nogil=True, error_model="numpy")
def profiles(frame: Image | Singles, rays: Floats, counts: Ints) -> Floats:
    """(K, 2, D) mean change from film, which is where a ray (D, 2) ends, and the variance of that mean's places."""
    many = rays.shape[2]
    out, read = np.zeros((len(rays), 2, many)), np.empty(many)
    for k in range(len(rays)):
        for ray in range(counts[k]):
            for d in range(many):
                read[d] = _read(frame, rays[k, ray, d, 0], rays[k, ray, d, 1])
            film = _middle(read[-3], read[-2], read[-1])
            for d in range(many):
                out[k, 0, d] += read[d] - film
                out[k, 1, d] += (read[d] - film) ** 2
        for d in range(many):
            mean = out[k, 0, d] / counts[k]
            out[k, 0, d] = mean
            variance = max(out[k, 1, d] / counts[k] - mean**2, 0.0)
            out[k, 1, d] = variance * (1.0 + 1.0 / counts[k])
    return out
