"""Proofs over boxes: what a formula is at least, at every point of a box of its variables.

A box is cut until each piece decides. On a piece every variable along which the formula is proved
to be monotone is put to the end where the formula is least; what is left is bounded by the mean
value theorem. What may change at every instant on the way is never cut (``roll.py``).
"""

from __future__ import annotations

import functools
import heapq
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from flint import arb

from meso_robust.checker.dual import Dual, Point, Remembered, Slopes
from meso_robust.checker.roll import HISTORIES

Side: TypeAlias = tuple[arb, arb]
"""Lower and upper end, each a ball around the exact number."""
Box: TypeAlias = Mapping[str, Side]
Formula: TypeAlias = Callable[[Point], Dual]

NEVER, ZERO = arb("-inf"), arb(0)
CUTS = 400
"""Pieces that are looked at before a question stays open."""


def side_of(value: arb) -> Side:
    """A single number as a side."""
    return value, value


def whole(side: Side) -> arb:
    """The ball that holds a side."""
    return side[0].union(side[1]) if side[0] is not side[1] else side[0]


def shift(side: Side, by: arb) -> Side:
    """A range moved by a number."""
    if side[0] is side[1]:
        return side_of(side[0] + by)
    return side[0] + by, side[1] + by


def hull(one: Side, other: Side) -> Side:
    """The smallest range that holds both."""
    return one[0].min(other[0]), one[1].max(other[1])


def common(one: Side, other: Side) -> Side:
    """What lies in both ranges."""
    return one[0].max(other[0]), one[1].min(other[1])


def point_of(box: Box) -> Remembered:
    """The variables over a box, each with slope 1 along itself; a single number has none."""
    one = arb(1)
    return Remembered(
        {
            name: Dual(side[0]) if side[0] is side[1] else Dual(whole(side), {name: one})
            for name, side in box.items()
        }
    )


def least(
    of: Formula, box: Box, *, above: arb | None = None, within: float = 1e-12, cuts: int = CUTS
) -> arb:
    """A proved lower bound of ``of`` over ``box``.

    Parameters
    ----------
    of, box
        The formula and the box of its variables.
    above
        Stop as soon as the bound exceeds this number, or the formula does not at some point.
    within
        Stop as soon as the bound is this close to the least value.
    cuts
        How many pieces may be cut.

    Returns
    -------
    arb
        An exact number; minus infinity if nothing was proved.
    """
    order = itertools.count()
    start = _Piece(of, box)
    queue, attained = [(_key(start.low), next(order), start)], start.attained
    for _ in range(cuts):
        piece = queue[0][2]
        done = piece.low + within >= attained or not _cuttable([piece.slopes])
        if done or (above is not None and (piece.low > above or attained <= above)):
            break
        heapq.heappop(queue)
        for half in piece.halves():
            part = _Piece(of, half)
            attained = attained.min(part.attained)
            heapq.heappush(queue, (_key(part.low), next(order), part))
    return functools.reduce(arb.min, (piece.low for _, _, piece in queue))


def _key(bound: arb) -> float:
    return float(bound) if bound.is_finite() else -math.inf


class _Piece:
    """A part of the box, with the bound that was proved on it."""

    __slots__ = ("attained", "box", "low", "slopes")

    def __init__(self, of: Formula, box: Box) -> None:
        while True:
            found = of(point_of(box))
            ends = {
                name: box[name][0 if slope >= 0 else 1]
                for name, slope in found.slopes.items()
                if slope >= 0 or slope <= 0
            }
            if not ends:
                break
            box = {**box, **{name: side_of(end) for name, end in ends.items()}}
        self.box = box
        self.slopes = found.slopes
        self.low = _finite(found.value.lower(), NEVER)
        """Proved lower bound, an exact number."""
        self.attained = -_finite(-found.value.upper(), NEVER)
        """Upper bound of the value at one of the piece's points."""
        if self.slopes:
            self._look_at_middle(of)

    def _look_at_middle(self, of: Formula) -> None:
        """The value there, and what the mean value theorem makes of it."""
        point, reach = dict(self.box), arb(0)
        for name, slope in self.slopes.items():
            low, high = self.box[name]
            middle = ((low + high) / 2).mid()
            point[name] = side_of(middle)
            reach += abs(slope) * abs(whole(self.box[name]) - middle)
        at = of(point_of(point)).value
        self.low = self.low.max(_finite((at - reach).lower(), NEVER))
        self.attained = -_finite(-at.upper(), NEVER)

    def halves(self) -> Iterator[Box]:
        """The piece cut where it matters most."""
        yield from halved(self.box, _weightiest([self.slopes], self.box))


def halved(box: Box, name: str) -> Iterator[Box]:
    """A box cut in two along one variable."""
    low, high = box[name]
    cut = ((low + high) / 2).mid()
    yield {**box, name: (low, cut)}
    yield {**box, name: (cut, high)}


def _finite(value: arb, otherwise: arb) -> arb:
    return value if value.is_finite() else otherwise


def positive(of: Formula, box: Box, *, cuts: int = CUTS) -> bool:
    """Whether ``of`` is proved to be positive over ``box``."""
    return bool(least(of, box, above=ZERO, cuts=cuts) > 0)


@dataclass(frozen=True, slots=True)
class Around:
    """A box and its middle, as points at which several formulas are looked at."""

    whole: Remembered
    middle: Remembered
    reach: Mapping[str, arb]
    """By how much each variable differs from its middle at most."""

    @classmethod
    def of(cls, box: Box) -> Around:
        """Of a box."""
        middle = {name: side_of(((low + high) / 2).mid()) for name, (low, high) in box.items()}
        reach = {name: abs(whole(box[name]) - middle[name][0]) for name in box}
        return cls(point_of(box), point_of(middle), reach)


def lows(of: Callable[[Point], Sequence[Dual]], around: Around) -> list[arb]:
    """Proved lower bounds of several formulas over a box, which is not cut."""

    def low(wide: Dual, there: Dual) -> arb:
        off = sum((abs(slope) * around.reach[n] for n, slope in wide.slopes.items()), ZERO)
        found = _finite(wide.value.lower(), NEVER)
        return found.max(_finite((there.value - off).lower(), NEVER))

    return list(map(low, of(around.whole), of(around.middle)))


def span(of: Formula, box: Box, *, within: float = 1e-12) -> Side:
    """Proved lower and upper bound of ``of`` over ``box``."""
    return least(of, box, within=within), -least(lambda at: -of(at), box, within=within)


def component(of: Callable[[Point], tuple[Dual, ...]], k: int) -> Formula:
    """One of several results."""
    return lambda at: of(at)[k]


def either(formulas: tuple[Formula, ...], box: Box) -> bool:
    """Whether at every point of ``box`` at least one of ``formulas`` is proved to be positive."""
    left = [box]
    for _ in range(CUTS):
        if not left:
            return True
        piece = left.pop()
        if not any(positive(of, piece, cuts=2) for of in formulas):
            slopes = [of(point_of(piece)).slopes for of in formulas]
            if not _cuttable(slopes):
                return False
            left += halved(piece, _weightiest(slopes, piece))
    return not left


def _weightiest(slopes: Sequence[Slopes], box: Box) -> str:
    """The variable that contributes most to the width of one of some formulas."""

    def weight(name: str) -> float:
        steepest = max(_largest(one[name]) for one in slopes if name in one)
        return float(whole(box[name]).rad()) * steepest

    return max(_cuttable(slopes), key=weight)


def _cuttable(slopes: Sequence[Slopes]) -> set[str]:
    """The variables along which a box may be cut: a history passes from one half to the other."""
    return {name for one in slopes for name in one if name not in HISTORIES}


def _largest(slope: arb) -> float:
    """Largest absolute value; a large number where there is none."""
    most = abs(slope).upper()
    return float(most) if most.is_finite() else 1e30
