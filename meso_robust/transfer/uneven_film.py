"""Centre and ratio of a film whose drag at a place depends on its speed, for every motion of the part.

derivations/uneven_film.py: at an instant at which the part turns about ``p`` a place ``x`` of a film that
thins drags as ``|x - p|^-e``, and how fast the part turns is of no effect. Dry contact adds a drag of any
size up to one that falls as ``1/|x - p|``. So ``p`` alone is to be gone through: all of the plane, in
boxes, and beyond them at once. The area is cut into cells; over each, and over a box of ``p``, the drag has
bounds, from which those of centre and ratio follow. Lengths are over the root of the ratio of the film
that is even.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from meso_robust.types import Floats

MOST = 0.5
"""Largest exponent that bounds are made for."""
_CELLS = 80, 40
_FAR = 4.0  # boxes of p lie in a square of twice this; the area reaches to the root of 3
_FIRST = 0.5  # width of a box
_DEPTH = 5  # halvings of boxes, and of the exponent's interval
_SLICES = 3  # of that interval
_NEAR, _LITTLE = (
    1.05,
    1e-3,
)  # of the largest value found, and more: a box bounded so closely is not cut
_ROUNDING = 1e-9  # far more than sums of some thousand doubles of either sign lose

Ends = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Places:
    """The places of each cell, seen from the points p of each box; far out, lengths are over |p|."""

    least: Floats
    """(B, n, m) distance at least."""
    most: Floats
    """(B, n, m) distance at most."""
    unit: float
    """1 in these lengths, at most."""
    out: Floats
    """(B, 1, 1) largest |p|."""
    disc: float
    """Radius of a disc of the area of a cell; 0 where no p is in the area."""


Law = Callable[[_Places], tuple[Floats, Floats, Floats]]
"""(B, n, m) bounds of the drag of a place in each cell from below and above, and of its mean from above."""


class _Cells:
    """A rectangle with the ratio 1 about its middle, cut into cells."""

    def __init__(self, slender: float) -> None:
        unit = math.sqrt(3.0 / (1.0 + slender**2))
        self.half = np.array([slender * unit, unit]) / _CELLS
        self.middle = [
            half * (2.0 * np.arange(count) + 1.0 - count)
            for half, count in zip(self.half, _CELLS, strict=True)
        ]
        self.squares = self.middle[0][:, None] ** 2 + self.middle[1] ** 2
        self.disc = math.sqrt(4.0 * self.half[0] * self.half[1] / math.pi)

    def places(self, middle: Floats, half: float) -> _Places:
        """Of boxes of p about these middles."""
        least, most = [], []
        for k in (0, 1):
            apart = np.abs(self.middle[k] - middle[:, k, None])
            room = self.half[k] + half
            least.append(np.maximum(apart - room, 0.0) ** 2)
            most.append((apart + room) ** 2)
        return _Places(
            least=np.sqrt(least[0][:, :, None] + least[1][:, None, :]),
            most=np.sqrt(most[0][:, :, None] + most[1][:, None, :]),
            unit=1.0,
            out=np.hypot(*(np.abs(middle) + half).T)[:, None, None],
            disc=self.disc,
        )

    def beyond(self) -> _Places:
        """Of every p outside of the boxes."""
        far = np.sqrt(self.squares) + float(np.hypot(*self.half))
        return _Places(
            least=(1.0 - far / _FAR)[None],
            most=(1.0 + far / _FAR)[None],
            unit=1.0 / _FAR,
            out=np.ones((1, 1, 1)),
            disc=0.0,
        )


@cache
def thinned(drop: Ends, slender: float) -> tuple[float, float]:
    """How far the centre moves, and by what share the ratio changes.

    Parameters
    ----------
    drop
        Ends of the exponent ``e``, both within +-`MOST`.
    slender
        Length of the film's rectangle over its width.

    Returns
    -------
    tuple of float
        Upper bounds, over every exponent and every motion of the part: the distance of the centre of drag
        from the middle of the rectangle, over the root of the ratio of an even film, and the largest
        change of the ratio over that of an even film.
    """
    # no slice has exponents of either sign
    steps = np.union1d(np.linspace(*drop, _SLICES + 1), 0.0 if drop[0] < 0.0 < drop[1] else drop[0])
    found = [_whatever(_thins(ends), slender) for ends in itertools.pairwise(steps)]
    centre, change = np.max(found, axis=0)
    return float(centre), float(change)


@cache
def rubbed(still: float, growing: float, slender: float) -> tuple[float, float]:
    """The same of an even film with dry contact under it, wherever and however much there is of it.

    Parameters
    ----------
    still, growing
        While the part turns about p a place x drags by no more than ``(still + growing |p|) / |x - p|``
        beyond the film, and by no less than the film.
    slender
        As of `thinned`.

    Returns
    -------
    tuple of float
        As of `thinned`.
    """
    if still == growing == 0.0:
        return 0.0, 0.0
    centre, change = _whatever(_rubs(still, growing), slender)
    return float(centre), float(change)


def _thins(ends: Ends) -> Law:
    """A drag that is a power of the distance from p."""

    def law(at: _Places) -> tuple[Floats, Floats, Floats]:
        with np.errstate(divide="ignore"):
            powers = [r**-e for r in (at.least, at.most) for e in ends]
        low, high = np.minimum.reduce(powers), np.maximum.reduce(powers)
        if ends[0] < 0.0 or not at.disc:
            return low, high, high
        # the mean over a cell is at most that over a disc of its area about p
        return low, high, np.minimum(high, max(at.disc**-e * 2.0 / (2.0 - e) for e in ends))

    return law


def _rubs(still: float, growing: float) -> Law:
    """A drag of the film and of dry contact."""

    def law(at: _Places) -> tuple[Floats, Floats, Floats]:
        with np.errstate(divide="ignore"):
            near = 1.0 / at.least
        mean = np.minimum(near, 2.0 / at.disc) if at.disc else near
        most = still * at.unit + growing * at.out
        return np.ones_like(near), 1.0 + most * near, 1.0 + most * mean

    return law


def _whatever(law: Law, slender: float) -> Floats:
    """(2,) bounds for every p."""
    cells = _Cells(slender)
    return np.maximum(_bounds(cells, law, cells.beyond())[0], _near(cells, law))


def _near(cells: _Cells, law: Law) -> Floats:
    """(2,) bounds for every p in the boxes; a quadrant shows all, as the area is its own mirror image."""
    side = np.arange(0.5 * _FIRST, _FAR, _FIRST)
    boxes = np.array(list(itertools.product(side, side)))
    width, seen, settled = _FIRST, np.zeros(2), np.zeros(2)
    for depth in range(_DEPTH + 1):
        # bounds for single points stand for what is found: they only decide where to look closer
        seen = np.maximum(seen, _bounds(cells, law, cells.places(boxes, 0.0)).max(axis=0))
        upper = _bounds(cells, law, cells.places(boxes, 0.5 * width))
        cut = (upper > _NEAR * seen + _LITTLE).any(axis=1) & (depth < _DEPTH)
        settled = np.maximum(settled, upper[~cut].max(axis=0, initial=0.0))
        if not cut.any():
            break
        width *= 0.5
        corners = 0.5 * width * np.array(list(itertools.product((-1.0, 1.0), repeat=2)))
        boxes = (boxes[cut][:, None] + corners).reshape(-1, 2)
    return settled


def _bounds(cells: _Cells, law: Law, at: _Places) -> Floats:
    """(B, 2) both bounds, for boxes of p."""
    low, high, top = law(at)
    # of drag times the place in its cell: even drag adds nothing, and uneven one no more than this
    skew = np.minimum(0.25 * (high - low), top)
    place = cells.middle[0][:, None], cells.middle[1][None, :]
    off = []
    for k in (0, 1):
        rest = (skew * cells.half[k]).sum(axis=(1, 2))
        off.append(np.maximum(*(_mean(low, top, side * place[k], rest) for side in (1.0, -1.0))))
    centre = np.hypot(*off)
    over = cells.squares - 1.0
    lean = sum(2.0 * np.abs(place[k]) * cells.half[k] for k in (0, 1))
    rest = (skew * lean).sum(axis=(1, 2))
    wide = (cells.half**2).sum() * top.sum(axis=(1, 2))
    larger = _mean(low, top, over, rest + wide)
    smaller = _mean(low, top, -over, rest) + centre**2
    return np.stack([centre, np.maximum(larger, smaller)], axis=1) * (1.0 + _ROUNDING) + _ROUNDING


def _mean(low: Floats, top: Floats, of: Floats, rest: Floats) -> Floats:
    """(B,) upper bound of the mean of ``of``, weighted by drag; ``rest``: more of the sum at most.

    No mean is above m by more than the largest sum of drag times ``of - m``, over the least sum of drag; nor,
    where that is negative, by more than it over the largest sum of drag.
    """
    first = np.maximum(_most(low, top, of) + rest, 0.0) / low.sum(axis=(1, 2))
    again = _most(low, top, of - first[:, None, None]) + rest
    return first + np.minimum(again, 0.0) / top.sum(axis=(1, 2))


def _most(low: Floats, top: Floats, of: Floats) -> Floats:
    """(B,) upper bound of the sum of drag times ``of``."""
    found: Floats = (top * np.maximum(of, 0.0) - low * np.maximum(-of, 0.0)).sum(axis=(1, 2))
    return found
