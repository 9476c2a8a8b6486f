"""Centre and ratio of a film whose drag falls with the speed of the place, for every motion of the part.

derivations/uneven_film.py: at an instant at which the part turns about ``p`` a place ``x`` drags as
``|x - p|^-e``, and how fast it turns is of no effect. So ``p`` alone is to be gone through: all of the
plane, in boxes, and beyond them at once. The area is cut into cells; over each, and over a box of ``p``,
the drag has bounds, from which those of centre and ratio follow. Lengths are over the root of the ratio
of the film that does not thin.
"""

from __future__ import annotations

import itertools
import math
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

    def reach(self, middle: Floats, half: float) -> tuple[Floats, Floats]:
        """(B, n, m) least and largest distance of places of each cell from points of each box."""
        least, most = [], []
        for k in (0, 1):
            apart = np.abs(self.middle[k] - middle[:, k, None])
            room = self.half[k] + half
            least.append(np.maximum(apart - room, 0.0) ** 2)
            most.append((apart + room) ** 2)
        return (
            np.sqrt(least[0][:, :, None] + least[1][:, None, :]),
            np.sqrt(most[0][:, :, None] + most[1][:, None, :]),
        )

    def beyond(self) -> tuple[Floats, Floats]:
        """(1, n, m) the same over |p|, for every p outside of the boxes."""
        far = np.sqrt(self.squares) + float(np.hypot(*self.half))
        return (1.0 - far / _FAR)[None], (1.0 + far / _FAR)[None]


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
    cells = _Cells(slender)
    # no slice has exponents of either sign
    steps = np.union1d(np.linspace(*drop, _SLICES + 1), 0.0 if drop[0] < 0.0 < drop[1] else drop[0])
    found = [
        np.maximum(_bounds(cells, cells.beyond(), ends)[0], _near(cells, ends))
        for ends in itertools.pairwise(steps)
    ]
    centre, change = np.max(found, axis=0)
    return float(centre), float(change)


def _near(cells: _Cells, ends: Ends) -> Floats:
    """(2,) bounds for every p in the boxes; a quadrant shows all, as the area is its own mirror image."""
    side = np.arange(0.5 * _FIRST, _FAR, _FIRST)
    boxes = np.array(list(itertools.product(side, side)))
    width, seen, settled = _FIRST, np.zeros(2), np.zeros(2)
    for depth in range(_DEPTH + 1):
        # bounds for single points stand for what is found: they only decide where to look closer
        seen = np.maximum(seen, _bounds(cells, cells.reach(boxes, 0.0), ends).max(axis=0))
        upper = _bounds(cells, cells.reach(boxes, 0.5 * width), ends)
        cut = (upper > _NEAR * seen + _LITTLE).any(axis=1) & (depth < _DEPTH)
        settled = np.maximum(settled, upper[~cut].max(axis=0, initial=0.0))
        if not cut.any():
            break
        width *= 0.5
        corners = 0.5 * width * np.array(list(itertools.product((-1.0, 1.0), repeat=2)))
        boxes = (boxes[cut][:, None] + corners).reshape(-1, 2)
    return settled


def _bounds(cells: _Cells, distance: tuple[Floats, Floats], ends: Ends) -> Floats:
    """(B, 2) both bounds, for boxes of p."""
    least, most = distance
    with np.errstate(divide="ignore"):
        powers = [r**-e for r in (least, most) for e in ends]
    low, high = np.minimum.reduce(powers), np.maximum.reduce(powers)
    top = high
    if ends[0] >= 0.0:  # the mean over a cell is at most that over a disc of its area about p
        top = np.minimum(high, max(cells.disc**-e * 2.0 / (2.0 - e) for e in ends))
    # of drag times the place in its cell: even drag adds nothing, and uneven one no more than this
    skew = np.minimum(0.25 * (high - low), top)
    total = low.sum(axis=(1, 2))
    place = cells.middle[0][:, None], cells.middle[1][None, :]
    off = [
        np.maximum(_most(low, top, place[k]), _most(low, top, -place[k]))
        + (skew * cells.half[k]).sum(axis=(1, 2))
        for k in (0, 1)
    ]
    centre = np.hypot(*off) / total
    over = cells.squares - 1.0
    lean = sum(2.0 * np.abs(place[k]) * cells.half[k] for k in (0, 1))
    rest = (skew * lean).sum(axis=(1, 2))
    wide = (cells.half**2).sum() * top.sum(axis=(1, 2))
    larger = (_most(low, top, over) + rest + wide) / total
    smaller = (_most(low, top, -over) + rest) / total + centre**2
    return np.stack([centre, np.maximum(larger, smaller)], axis=1) * (1.0 + _ROUNDING) + _ROUNDING


def _most(low: Floats, top: Floats, of: Floats) -> Floats:
    """(B,) upper bound of the sum of drag times ``of``, or zero."""
    most = top * np.maximum(of, 0.0) - low * np.maximum(-of, 0.0)
    return np.maximum(most.sum(axis=(1, 2)), 0.0)
