"""Paths of probes: from samples of a controller or a camera to the straight legs of a push."""

from __future__ import annotations

import itertools
from functools import lru_cache

import numpy as np

from meso_robust.types import Floats, Ints

_FEWEST = 2  # samples from a corner to the next, at least
_SWEEPS = 3  # over all corners, which were put while others were still missing
_WORST = 4.0  # standard deviations of χ² that a leg may exceed its expectation by
_FAR = 6.0  # σ: a sample farther off is no noise


def thinned(times: Floats, path: Floats, tolerance: float) -> Ints:
    """Indices of the samples without which the path would differ by more than a tolerance.

    Douglas and Peucker's algorithm (doi:10.3138/FM57-6770-U75U-7727), in time: a sample is judged by
    where the straight motion between its neighbours is at the same instant.

    Parameters
    ----------
    times
        (S,) s, increasing.
    path
        (S, C) coordinates in m.
    tolerance
        m, in every coordinate.
    """
    kept, todo = {0, len(times) - 1}, [(0, len(times) - 1)]
    while todo:
        first, last = todo.pop()
        if last - first < 2:
            continue
        away = np.abs(_straight(times, path, first, last) - path[first + 1 : last]).max(axis=1)
        worst = int(np.argmax(away))
        if away[worst] > tolerance:
            middle = first + 1 + worst
            kept.add(middle)
            todo += [(first, middle), (middle, last)]
    return np.array(sorted(kept))


def _straight(times: Floats, path: Floats, first: int, last: int) -> Floats:
    """Samples between two others if the motion between these were even."""
    share = (times[first + 1 : last] - times[first]) / (times[last] - times[first])
    return np.asarray(path[first] + share[:, None] * (path[last] - path[first]))


def with_corners(times: Floats, path: Floats, tolerance: float) -> tuple[Floats, Floats]:
    """Samples of a commanded path with the corners that fell between them.

    A probe that goes evenly to a point and evenly on from there is at the point between two samples,
    and was farther out than any of them. Where the lines through the two samples before and the two
    after meet in between, in all coordinates at one instant, that is where it turned.

    Parameters
    ----------
    times
        (S,) s, increasing.
    path
        (S, C) coordinates in m.
    tolerance
        By how much the lines may miss each other, m; also the least corner that counts.

    Returns
    -------
    (S + K,), (S + K, C)
        Instants and positions of all samples and K corners, in their order.
    """
    if len(times) < 4:
        return times, path
    speed = np.diff(path, axis=0) / np.diff(times)[:, None]
    before, after = speed[:-2], speed[2:]
    gap = times[2:-1] - times[1:-2]
    turn = before - after
    miss = path[2:-1] - path[1:-2] - after * gap[:, None]
    squares = np.sum(turn**2, axis=1)
    at = np.sum(turn * miss, axis=1) / np.where(squares > 0.0, squares, 1.0)
    left = np.abs(miss - turn * at[:, None]).max(axis=1)
    way = np.abs(turn).max(axis=1)
    same = np.abs(np.diff(speed, axis=0)).max(axis=1) * np.diff(times)[1:] <= tolerance
    even = np.insert(same[:-2], 0, False) | np.append(same[2:], False)
    corner = even & (left <= tolerance) & (at * way > tolerance) & ((gap - at) * way > tolerance)
    found = np.flatnonzero(corner)
    where = path[1:-2][found] + before[found] * at[found, None]
    return (
        np.insert(times, found + 2, times[1:-2][found] + at[found]),
        np.insert(path, found + 2, where, axis=0),
    )


def smoothed(times: Floats, path: Floats, sigma: float) -> tuple[Floats, Floats]:
    """Even motion with as few corners as samples with white noise call for.

    A continuous, piecewise linear function of time is fitted by least squares; the leg whose squared
    residuals most exceed what σ explains is cut where two lines explain it best, until none does. A
    corner is where these lines meet, which is seldom at a sample: a probe that turns between two of them
    was farther out than any. Where legs have too few samples for that, as of a probe that comes back
    at once under a slow camera, the corners are samples.

    Parameters
    ----------
    times
        (S,) s, increasing.
    path
        (S, C) seen coordinates in m.
    sigma
        Standard deviation of each, m; positive.

    Returns
    -------
    (W,), (W, C)
        Instants and positions of the corners, the first and the last sample's instant among them.
        Read-only: kept for the next time, as the same paths are asked for with one step after another.
    """
    kept = (np.ascontiguousarray(one, dtype=np.float64).tobytes() for one in (times, path))
    return _smoothed(*kept, sigma)


@lru_cache(maxsize=256)
def _smoothed(clock: bytes, samples: bytes, sigma: float) -> tuple[Floats, Floats]:
    times = np.frombuffer(clock)
    path = np.frombuffer(samples).reshape(len(times), -1)
    knots = times[[0, -1]]
    for _ in times:
        leg = _worst_leg(knots, times, (path - _legs(times, path, knots)[1]) / sigma)
        if leg is None:
            break
        new = leg + 1
        knots = _put(np.insert(knots, new, np.nan), [new, leg, new + 1] * 2, times, path)
    knots = _put(knots, [*range(len(knots))] * _SWEEPS, times, path)
    for _ in times:
        corners, motion = _legs(times, path, knots)
        off = np.abs(path - motion).max(axis=1)
        followed = _through(knots, times, int(np.argmax(off)))
        if off.max() <= _FAR * sigma or len(followed) == len(knots):
            break
        knots = followed
    knots.flags.writeable = corners.flags.writeable = False
    return knots, corners


def _through(knots: Floats, times: Floats, worst: int) -> Floats:
    """Knots with one at a sample, and with samples for the ends of its leg, which too few others told."""
    leg = int(np.clip(np.searchsorted(knots, times[worst], side="right") - 1, 0, len(knots) - 2))
    ends = np.setdiff1d(knots[leg : leg + 2], times)
    after = np.searchsorted(times, ends)
    return np.unique([*np.setdiff1d(knots, ends), *times[after - 1], *times[after], times[worst]])


def _legs(times: Floats, path: Floats, knots: Floats) -> tuple[Floats, Floats]:
    """Least squares: (W, C) corners at the knots, and the (S, C) motion between them."""
    basis = _hats(times, knots)
    corners = np.linalg.lstsq(basis, path, rcond=None)[0]
    return np.asarray(corners, dtype=np.float64), np.asarray(basis @ corners)


def _put(knots: Floats, order: list[int], times: Floats, path: Floats) -> Floats:
    """Put inner knots, one after the other, where two lines between their neighbours meet."""
    for k in order:
        if 0 < k < len(knots) - 1:
            samples = _between(times, knots[k - 1], knots[k + 1])
            if samples.stop - samples.start > 2 * _FEWEST:
                knots[k] = _meeting(times[samples], path[samples])
    return knots


def _between(times: Floats, first: float, last: float) -> slice:
    """Samples from one instant to another."""
    return slice(
        int(np.searchsorted(times, first, side="left")),
        int(np.searchsorted(times, last, side="right")),
    )


def _hats(times: Floats, knots: Floats) -> Floats:
    """(S, W) linear interpolation from knots to samples."""
    leg = np.clip(np.searchsorted(knots, times, side="right") - 1, 0, len(knots) - 2)
    share = (times - knots[leg]) / (knots[leg + 1] - knots[leg])
    basis = np.zeros((len(times), len(knots)))
    rows = np.arange(len(times))
    basis[rows, leg], basis[rows, leg + 1] = 1.0 - share, share
    return basis


def _worst_leg(knots: Floats, times: Floats, residuals: Floats) -> int | None:
    """The leg that is explained worst, or None if all are explained."""
    worst, found = _WORST, None
    for leg, (first, last) in enumerate(itertools.pairwise(knots)):
        own = residuals[_between(times, first, last)]
        excess = float((np.sum(own**2) - own.size) / np.sqrt(2.0 * max(own.size, 1)))
        if len(own) > 2 * _FEWEST and excess > worst:
            worst, found = excess, leg
    return found


def _meeting(times: Floats, path: Floats) -> float:
    """Instant at which the two lines meet that explain (S, C) samples best, one before the other."""
    before = _misfit(times, path)
    after = _misfit(times[::-1], path[::-1])[::-1]
    whole = before[:-1] + after[1:]
    last = int(np.argmin(whole[_FEWEST - 1 : 1 - _FEWEST])) + _FEWEST - 1
    lines = [
        np.polynomial.polynomial.polyfit(times[part] - times[last], path[part], 1)
        for part in (slice(None, last + 1), slice(last + 1, None))
    ]
    apart, turn = lines[1] - lines[0]
    square = float(turn @ turn)
    ahead = -float(apart @ turn) / square if square > 0.0 else 0.0
    return float(times[last] + np.clip(ahead, 0.0, times[last + 1] - times[last]))


def _misfit(times: Floats, values: Floats) -> Floats:
    """(S,) squared residuals of a line through the samples up to each, by running sums."""
    t = (times - times[0])[:, None]
    count = np.arange(1, len(t) + 1)[:, None]
    st, stt, sy, sty, syy = (
        np.cumsum(part, axis=0) for part in (t, t * t, values, t * values, values * values)
    )
    spread = stt - st * st / count
    slope = np.where(spread > 0.0, sty - st * sy / count, 0.0)
    along = slope**2 / np.where(spread > 0.0, spread, 1.0)
    return np.asarray(np.sum(syy - sy * sy / count - along, axis=1))


def in_steps(times: Floats, path: Floats, steps: Floats) -> tuple[Floats, Floats]:
    """The same path with legs no longer than the steps wanted there.

    Parameters
    ----------
    times, path
        (W,) in s and (W, P, 2) in m.
    steps
        (W − 1,) longest displacement of a probe in a piece of each leg, m.
    """
    way = np.diff(path, axis=0)
    length = np.hypot(way[..., 0], way[..., 1]).max(axis=1)
    pieces = np.maximum(np.ceil(length / steps - 1e-9), 1.0).astype(int)
    leg = np.repeat(np.arange(len(pieces)), pieces)
    share = (np.arange(len(leg)) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[leg]
    clock = np.append(times[leg] + share * np.diff(times)[leg], times[-1])
    points = path[leg] + share[:, None, None] * way[leg]
    return clock, np.concatenate([points, path[-1:]])
