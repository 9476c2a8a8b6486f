"""Bounds by second derivatives: tight over boxes that are wide in many variables at once.

Bisecting one of twenty sides after the other hardly narrows a mean-value form. What is left of it is mostly
how the slopes change over the box, counted from both ends; told by second derivatives it is half of that.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from meso_robust.bounds.bulk import Bounded, enclose_many
from meso_robust.bounds.interval import Interval
from meso_robust.bounds.prove import Box
from meso_robust.bounds.tape import compile_tape
from meso_robust.types import Floats

HALF, ZERO = Interval.point(0.5), Interval.point(0.0)
ANYWHERE = Interval(-np.inf, np.inf)
SLIGHT = 1e-6
"""Share of the steepest slope of what is nought below which a variable is not tried as what makes it so."""


@dataclass(frozen=True, slots=True, eq=False)
class Curved:
    """A function prepared for bounds of second order; its last output is nought wherever it is asked for."""

    variables: tuple[str, ...]
    """Inputs that may have a range."""
    outputs: int
    first: Bounded
    """Outputs, and their slopes along the variables, row by row."""
    second: Bounded
    """Second derivatives of every output: the upper triangle of each, row by row."""


def curved(of: Bounded, exact: Collection[str]) -> Curved:
    """Prepare a function for bounds of second order.

    Parameters
    ----------
    of
        The function.
    exact
        Inputs that are single numbers in all boxes.

    Returns
    -------
    Curved
        With the tapes of its first and second derivatives.

    Raises
    ------
    ValueError
        A tape cannot be bounded (:func:`meso_robust.bounds.tape.compile_tape`).
    """
    places = [k for k, name in enumerate(of.inputs) if name not in exact]
    x = ca.SX.sym("x", len(of.inputs))
    y = ca.densify(of.function(x))
    slopes = ca.densify(ca.jacobian(y, x)[:, places])
    pairs = list(itertools.combinations_with_replacement(range(len(places)), 2))
    bends = []
    for k in range(y.numel()):
        hessian = ca.densify(ca.jacobian(slopes[k, :].T, x)[:, places])
        bends += [hessian[i, j] for i, j in pairs]

    def prepared(name: str, results: ca.SX) -> Bounded:
        function = ca.Function(name, [x], [ca.cse(ca.densify(results))])
        tape = compile_tape(function)
        return Bounded(f"{of.name}.{name}", of.inputs, function, tape, tape)

    return Curved(
        variables=tuple(of.inputs[k] for k in places),
        outputs=y.numel(),
        first=prepared("first", ca.vertcat(y, ca.vec(slopes.T))),
        second=prepared("second", ca.vertcat(*bends)),
    )


def enclose_where(of: Curved, box: Box) -> tuple[Interval, ...]:
    """Enclose all outputs but the last one over those points of ``box`` where the last one is nought.

    Parameters
    ----------
    of, box
        The function, and an interval for each input.

    Returns
    -------
    tuple[Interval, ...]
        One an output; the whole line where something is not bounded.

    Raises
    ------
    ValueError
        An input that is no variable has a range.

    Notes
    -----
    Taylor's formula about the middle m of the box: f(x) = f(m) + f'(m)(x - m) + (x - m)' f''(z)(x - m)/2 with z
    in the box, of f plus any multiple of the last output, which adds nothing where that is nought. The multiple
    is the one with which the first-order part is narrowest.
    """
    sides = [box[name] for name in of.first.inputs]
    lo, hi = (np.array([[getattr(side, end) for side in sides]]) for end in ("lo", "hi"))
    wide = set(of.first.inputs) - set(of.variables)
    if any(box[name].lo < box[name].hi for name in wide):
        raise ValueError(f"{of.first.name} was prepared for single numbers of {sorted(wide)}")
    middle = 0.5 * (lo + hi)
    told = np.array(enclose_many(of.first, middle, middle, natural=True))[:, 0]
    bends = np.array(enclose_many(of.second, lo, hi, natural=True))[:, 0]
    if not (np.isfinite(told).all() and np.isfinite(bends).all()):
        return (ANYWHERE,) * (of.outputs - 1)
    values = _intervals(told[:, : of.outputs])
    slopes = told[:, of.outputs :].reshape(2, of.outputs, -1)
    bends = bends.reshape(2, of.outputs, -1)
    places = [of.first.inputs.index(name) for name in of.variables]
    off = [
        Interval(float(lo[0, k]), float(hi[0, k])) - Interval.point(float(middle[0, k]))
        for k in places
    ]
    found = []
    for k in range(of.outputs - 1):
        weight = Interval.point(_weight(slopes[:, k], slopes[:, -1], off))

        def both(
            of_it: Sequence[Interval], of_nought: Sequence[Interval], weight: Interval = weight
        ) -> list[Interval]:
            return [one + weight * other for one, other in zip(of_it, of_nought, strict=True)]

        (value,) = both(values[k : k + 1], values[-1:])
        slope = both(_intervals(slopes[:, k]), _intervals(slopes[:, -1]))
        bend = both(_intervals(bends[:, k]), _intervals(bends[:, -1]))
        found.append(value + _linear(slope, off) + _quadratic(bend, off))
    return tuple(found)


def _intervals(ends: Floats) -> list[Interval]:
    return [Interval(low, high) for low, high in ends.T.tolist()]


def _weight(slopes: Floats, nought: Floats, off: Sequence[Interval]) -> float:
    """The multiple of what is nought; any is sound."""
    reach = np.array([side.width for side in off])
    one, other = slopes.mean(axis=0), nought.mean(axis=0)
    steep = np.abs(other) > SLIGHT * np.abs(other).max(initial=0.0)
    tried = np.array([0.0, *(-one[steep] / other[steep])])
    widths = np.abs(one + tried[:, None] * other) @ reach
    return float(tried[np.argmin(widths)])


def _linear(slopes: Sequence[Interval], off: Sequence[Interval]) -> Interval:
    total = ZERO
    for slope, side in zip(slopes, off, strict=True):
        total = total + slope * side
    return total


def _quadratic(bends: Sequence[Interval], off: Sequence[Interval]) -> Interval:
    total = ZERO
    pairs = itertools.combinations_with_replacement(range(len(off)), 2)
    for bend, (i, j) in zip(bends, pairs, strict=True):
        if i == j:
            total = total + HALF * bend * _square(off[i])
        else:
            total = total + bend * (off[i] * off[j])
    return total


def _square(side: Interval) -> Interval:
    most = max(-side.lo, side.hi)
    return Interval(0.0, (Interval.point(most) * Interval.point(most)).hi)
