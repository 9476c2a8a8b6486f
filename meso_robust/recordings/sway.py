"""Whether a part at rest is seen to sway: a camera, a stage or a light that moves to and fro is no noise.

Frames at rest that scatter are noise, of whatever colour: an autoregression of first order explains each by the
one before and a shock that nothing foretells. A line in the spectrum of those shocks, common to all rests with a
phase of its own in each, is a motion. Chance is what drawn noise of the same colour makes in rests as short.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meso_robust.types import Floats

_DRAWN = (19, 180)  # sets of noise, in turn
_FINE = 64  # steps of a rate within two of the coarse ones
_LIKELY = 2.71  # fall of χ² within which a rate is, 90 %
_LONGEST = 64  # frames of a piece: one sway need not keep its phase for longer
_FEWEST = 8  # frames of a piece, of which four numbers are fitted
_PIECES = 64  # that are asked: more tell nothing new
_FASTEST = 0.4  # of the frame rate
_SLOWEST = 0.5  # cycles in a piece
_STEPS = 4.0  # rates for each cycle in a piece
_MOST = 0.95  # correlation that shocks are freed of
_SURE = 1.645  # standard errors from nought, of a size that more than one rest tells
_ROUNDING = 1e-12  # of a coordinate: less is no scatter


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sway:
    """A motion to and fro of a part at rest.

    Attributes
    ----------
    rate
        Hz.
    size
        (3,) root mean square of x and y in m and of θ in rad, less what noise alone would give.
    rate_error
        Hz: half of its 90 % interval.
    error
        (3,) standard errors of ``size``, by the jackknife over rests.
    p_value
        Of the largest line of all rates: it is beyond all noise that was drawn.
    """

    rate: float
    rate_error: float
    size: Floats
    error: Floats
    p_value: float

    @property
    def metres(self) -> float:
        """Root mean square of the place in m, of a coordinate as noise is."""
        return float(np.hypot(*self.size[:2]) / np.sqrt(2.0))


Rest = tuple[Floats, Floats]
"""Times (n,) in s and poses (n, 3) in m and rad of frames in which a part rests."""


def pieces(rests: Sequence[Rest]) -> list[Rest]:
    """Rests cut into parts of even length in which a sway keeps its phase.

    Parameters
    ----------
    rests
        Frames of each recording.

    Returns
    -------
    list of Rest
        Those that have frames enough.
    """
    cut = []
    for all_times, all_poses in rests:
        times, poses = all_times[:-1], all_poses[:-1]  # in the last one a push may have begun
        count = -(-len(times) // _LONGEST)
        parts = np.array_split(np.arange(len(times)), max(count, 1))
        cut += [(times[part], poses[part]) for part in parts if len(part) >= _FEWEST]
    return cut


def swing(times: Floats, rate: float | None) -> Floats:
    """Columns (n, 2) of a line in time, or (n, 4) with a sway beside it.

    Parameters
    ----------
    times
        (n,) s.
    rate
        Hz; None for the line alone.

    Returns
    -------
    Floats
        Not orthogonal.
    """
    clock = times - times[0]
    columns = [np.ones(len(clock)), clock]
    if rate is not None:
        columns += [np.cos(2.0 * np.pi * rate * clock), np.sin(2.0 * np.pi * rate * clock)]
    return np.column_stack(columns)


def sway_of(rests: Sequence[Rest], frame_rate: float) -> Sway | None:
    """The sway of a part at rest, if there is one beyond chance.

    Parameters
    ----------
    rests
        Frames of each recording, without those that are no measurement.
    frame_rate
        Hz.

    Returns
    -------
    Sway or None
        None where frames at rest are too few, or scatter as noise does.
    """
    cut = pieces(rests)[:_PIECES]
    if not cut:
        return None
    lasted = float(np.median([times[-1] - times[0] for times, _ in cut]))
    # of a clock in other units than the rate's: what is faster than frames come is not seen
    seen_rate = 1.0 / float(np.median(np.concatenate([np.diff(times) for times, _ in cut])))
    fastest = _FASTEST * min(frame_rate, seen_rate)
    rates = np.arange(_SLOWEST / lasted, fastest, 1.0 / (_STEPS * lasted))
    moves = np.ptp(np.concatenate([poses for _, poses in cut]), axis=0)
    told = moves > _ROUNDING * np.abs(np.concatenate([poses for _, poses in cut])).max(axis=0)
    if not rates.size or not np.any(told):
        return None
    clocks = [times for times, _ in cut]
    seen = [_left(swing(times, None), poses[None, :, told]) for times, poses in cut]
    own = _lines(clocks, seen, rates)[0]
    colour, rng = _colour(clocks, _lag(seen)[0]), np.random.default_rng(0)
    for count in _DRAWN:  # a few tell of most noise that it is noise
        chance = _lines(clocks, _noise(clocks, colour, count, rng), rates)
        if np.any(chance.max(axis=1) >= own.max()):
            return None
    step = 1.0 / (_STEPS * lasted)
    rate, rate_error = _sharp(cut, float(rates[np.argmax(own)]), step)
    size, error = _size(cut, rate)
    if np.all(size <= _SURE * error):
        return None  # one rest's own motion: that of others tells nothing of it
    p_value = 1.0 / (1 + sum(_DRAWN))
    return Sway(rate=rate, rate_error=rate_error, size=size, error=error, p_value=p_value)


def _lag(left: Sequence[Floats]) -> Floats:
    """(B, C) correlation of neighbours in what is left (B, n, C) of pieces."""
    products = sum(np.sum(of[:, 1:] * of[:, :-1], axis=1) for of in left)
    return np.asarray(products / sum(np.sum(of**2, axis=1) for of in left))


def _colour(clocks: Sequence[Floats], lag: Floats) -> Floats:
    """(C,) φ of the autoregression whose neighbours, a line taken out, have a correlation (C,)."""
    grid = np.linspace(0.0, _MOST, 20)
    found = []
    for colour in grid:
        products = squares = 0.0
        for times in clocks:
            apart = np.abs(np.subtract.outer(np.arange(len(times)), np.arange(len(times))))
            left = _left(swing(times, None), _left(swing(times, None), colour**apart).T)
            products += float(np.trace(left, offset=1))
            squares += float(np.trace(left))
        found.append(products / squares)
    return np.interp(lag, found, grid)


def _noise(
    clocks: Sequence[Floats], colour: Floats, count: int, rng: np.random.Generator
) -> list[Floats]:
    """Noise (B, n, C) of colours (C,) in every piece, a line taken out."""
    drawn = []
    for times in clocks:
        noise = rng.standard_normal((count, len(times), len(colour)))
        shock = np.sqrt(1.0 - colour**2)
        for k in range(1, len(times)):
            noise[:, k] = colour * noise[:, k - 1] + shock * noise[:, k]
        drawn.append(_left(swing(times, None), noise))
    return drawn


def _lines(clocks: Sequence[Floats], left: Sequence[Floats], rates: Floats) -> Floats:
    """(B, F) squares of a sway of each of F rates in the shocks of what is left (B, n, C), over their variance."""
    lag = np.clip(_lag(left), 0.0, _MOST)[:, None]
    shocks = [of[:, 1:] - lag * of[:, :-1] for of in left]
    variance = sum(np.sum(of**2, axis=1) for of in shocks)
    scale = 1.0 / np.sqrt(np.maximum(variance, np.finfo(float).tiny))[:, None]
    return np.asarray(
        sum(_power(times[1:], rates, of * scale) for times, of in zip(clocks, shocks, strict=True)),
        dtype=np.float64,
    )


def _left(columns: Floats, values: Floats) -> Floats:
    """Values (…, n, C) less what columns (n, k) explain."""
    own = np.linalg.qr(columns)[0]
    return np.asarray(values - own @ (own.T @ values))


def _power(times: Floats, rates: Floats, drawn: Floats) -> Floats:
    """(B, F) squares that a sway of each of F rates explains beyond a line, of values (B, n, C)."""
    line = np.linalg.qr(swing(times, None))[0]
    ways = np.stack([swing(times, rate)[:, 2:] for rate in rates.tolist()])
    ways = np.linalg.qr(ways - line @ (line.T @ ways))[0]  # (F, n, 2)
    flat = np.moveaxis(ways, 1, 2).reshape(-1, len(times))
    along = flat @ np.moveaxis(drawn, 1, 0).reshape(len(times), -1)
    return np.asarray(
        np.sum(along.reshape(len(rates), 2, len(drawn), -1) ** 2, axis=(1, 3)).T, dtype=np.float64
    )


def _sharp(cut: Sequence[Rest], rate: float, step: float) -> tuple[float, float]:
    """The rate near a coarse one that leaves least, and half of its 90 % interval."""
    near = np.maximum(rate + np.linspace(-step, step, 1 + _FINE), 0.1 * step)
    left = np.array(
        [
            sum(np.sum(_left(swing(times, one), poses) ** 2, axis=0) for times, poses in cut)
            for one in near.tolist()
        ]
    )
    freedom = sum(len(times) - 4 for times, _ in cut)
    squares = np.sum(left * freedom / np.maximum(left.min(axis=0), np.finfo(float).tiny), axis=1)
    likely = near[squares <= squares.min() + _LIKELY]
    return float(near[np.argmin(squares)]), max(0.5 * float(np.ptp(likely)), step / _FINE)


def _size(cut: Sequence[Rest], rate: float) -> tuple[Floats, Floats]:
    """(3,) root mean square of the sway of pieces, less the share of two in n that noise gives, and its error."""
    each = []
    for times, poses in cut:
        line = np.sum(_left(swing(times, None), poses) ** 2, axis=0)
        rest = np.sum(_left(swing(times, rate), poses) ** 2, axis=0)
        each.append(line - rest - 2.0 * rest / (len(times) - 4))
    squares, counts = np.array(each), np.array([len(times) for times, _ in cut])[:, None]

    def size(squares: Floats, counts: Floats) -> Floats:
        return np.asarray(np.sqrt(np.maximum(squares, 0.0) / np.maximum(counts, 1)))

    without = size(squares.sum(axis=0) - squares, counts.sum() - counts)
    spread = np.sum((without - without.mean(axis=0)) ** 2, axis=0)
    error = np.sqrt((1.0 - 1.0 / len(cut)) * spread)
    return size(squares.sum(axis=0), counts.sum()), np.asarray(error)
