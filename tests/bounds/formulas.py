"""Random formulas in two arithmetics at once: CasADi for the tape, Fraction for the truth."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import casadi as ca
import numpy as np
from hypothesis import strategies as st

from meso_robust.bounds import Bounded, Interval, bounded

NAMES = ("p", "q", "r")
BINARY: dict[str, Callable[[Any, Any], Any]] = {
    "+": lambda x, y: x + y,
    "-": lambda x, y: x - y,
    "*": lambda x, y: x * y,
    "/": lambda x, y: x / y,
}


@dataclass(frozen=True)
class Formula:
    """A tree of operations on three variables and dyadic constants."""

    operation: str
    parts: tuple[Formula, ...] = ()
    value: Fraction = Fraction(0)

    def at(self, point: Sequence[Any], number: Callable[[Fraction], Any]) -> Any:
        """Its value; ``number`` converts constants."""
        if self.operation == "variable":
            return point[int(self.value)]
        if self.operation == "constant":
            return number(self.value)
        values = [part.at(point, number) for part in self.parts]
        if self.operation == "square":
            return values[0] * values[0]
        if self.operation == "inverse":
            return 1 / values[0]
        return BINARY[self.operation](*values)

    def exact(self, point: Sequence[Fraction]) -> Fraction | None:
        """The exact value, or None where it is not defined."""
        try:
            return Fraction(self.at(point, lambda value: value))
        except ZeroDivisionError:
            return None


def together(*formulas: Formula) -> Bounded:
    """One prepared function that returns every formula."""
    x = ca.SX.sym("x", len(NAMES))
    entries = ca.vertsplit(x)
    values = [ca.SX(formula.at(entries, lambda value: ca.SX(float(value)))) for formula in formulas]
    return bounded("random", NAMES, ca.Function("random", [x], [ca.densify(ca.vertcat(*values))]))


leaves = st.one_of(
    st.builds(lambda k: Formula("variable", value=Fraction(k)), st.integers(0, len(NAMES) - 1)),
    st.builds(lambda k: Formula("constant", value=Fraction(k, 4)), st.integers(-12, 12)),
)
formulas = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.builds(
            lambda operation, one, other: Formula(operation, (one, other)),
            st.sampled_from(sorted(BINARY)),
            inner,
            inner,
        ),
        st.builds(
            lambda operation, one: Formula(operation, (one,)),
            st.sampled_from(["square", "inverse"]),
            inner,
        ),
    ),
    max_leaves=8,
)


def corner(box: Sequence[Interval], which: int) -> list[Fraction]:
    """One of the corners, exactly."""
    return [Fraction(side.hi if which >> k & 1 else side.lo) for k, side in enumerate(box)]


def corners(box: Sequence[Interval]) -> list[list[float]]:
    """All corners."""
    return [list(ends) for ends in itertools.product(*((side.lo, side.hi) for side in box))]


def inside(box: Sequence[Interval], count: int) -> list[list[float]]:
    """Random points, half of them with one coordinate on a face."""
    rng = np.random.default_rng(7)
    lo, hi = np.array([[side.lo, side.hi] for side in box]).T
    points = lo + rng.random((count, len(box))) * (hi - lo)
    on_face = np.arange(0, count, 2)
    side = rng.integers(len(box), size=on_face.size)
    points[on_face, side] = np.where(rng.random(on_face.size) < 0.5, lo[side], hi[side])
    return [[float(x) for x in row] for row in np.clip(points, lo, hi)]
