"""Bounds of many boxes at once, the reasons of what stays open, and named boxes near a limit."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from meso_robust.bounds import (
    Bounded,
    Box,
    Interval,
    Verdict,
    bounded,
    branch,
    decide_many,
    enclose_many,
    prove_positive,
)
from meso_robust.bounds.tape import BLOCK
from reports.benchmarks.bounds import ratio
from reports.benchmarks.ratio import BOX as RATIO_BOX, NAMES as RATIO_NAMES, random_boxes
from tests.bounds.formulas import NAMES, Formula, corner, formulas, together
from tests.nightly import often
from tests.strategies import REPEATABLE, intervals

sides = intervals(st.floats(-4.0, 4.0))
Build = Callable[[Any, Any], Any]
Boxes = list[tuple[Interval, Interval, Interval]]


def ends(boxes: Boxes) -> tuple[np.ndarray, np.ndarray]:
    both = np.array([[[s.lo, s.hi] for s in box] for box in boxes])
    return both[..., 0], both[..., 1]


def on_faces(box: tuple[Interval, ...], shares: list[Fraction]) -> Iterator[list[Fraction]]:
    """Exact points: inside, one on every face and edge, and all corners."""
    inside = [
        Fraction(s.lo) + t * (Fraction(s.hi) - Fraction(s.lo))
        for s, t in zip(box, shares, strict=True)
    ]
    choices = [(x, Fraction(s.lo), Fraction(s.hi)) for x, s in zip(inside, box, strict=True)]
    return map(list, itertools.product(*choices))


def prepared(*trees: Formula) -> Bounded | None:
    try:
        return together(*trees)
    except ValueError:  # folded to a constant that is not exact
        return None


@settings(REPEATABLE, max_examples=often(30, 80))
@given(
    tree=formulas,
    other=formulas,
    boxes=st.lists(st.tuples(sides, sides, sides), min_size=1, max_size=4),
    shares=st.lists(st.fractions(0, 1, max_denominator=16), min_size=3, max_size=3),
    natural=st.booleans(),
)
def test_bounds_in_bulk_hold_exact_values_inside_on_faces_and_at_corners(
    tree: Formula, other: Formula, boxes: Boxes, shares: list[Fraction], natural: bool
) -> None:
    of = prepared(tree, other)
    if of is None:
        return
    lower, upper = enclose_many(of, *ends(boxes), natural=natural)
    for k, box in enumerate(boxes):
        for point in on_faces(box, shares):
            for row, formula in enumerate((tree, other)):
                value = formula.exact(point)
                assert value is None or lower[k, row] <= value <= upper[k, row]


@settings(REPEATABLE, max_examples=often(15, 40))
@given(
    tree=formulas,
    boxes=st.lists(st.tuples(sides, sides, sides), min_size=1, max_size=4),
    shares=st.lists(st.fractions(0, 1, max_denominator=16), min_size=3, max_size=3),
)
def test_verdicts_in_bulk_hold_inside_on_faces_and_at_corners(
    tree: Formula, boxes: Boxes, shares: list[Fraction]
) -> None:
    of = prepared(tree)
    if of is None:
        return
    outcomes = decide_many(of, *ends(boxes))
    for box, outcome in zip(boxes, outcomes, strict=True):
        if outcome not in (branch.PROVED, branch.REFUTED):
            continue
        alone = prove_positive(of, dict(zip(NAMES, box, strict=True)))
        if outcome == branch.PROVED:
            assert alone.verdict is Verdict.PROVED
            for point in on_faces(box, shares):
                value = tree.exact(point)
                assert value is None or value > 0
        if outcome == branch.REFUTED:
            assert alone.verdict is Verdict.REFUTED
            at = [Fraction(alone.box[name].lo) for name in NAMES]
            value = tree.exact(at)
            assert value is None or value <= 0


@pytest.mark.parametrize("count", [1, 7, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK + 5])
def test_blocks_of_any_length_give_what_single_boxes_give(count: int) -> None:
    of = ratio()
    low, high = random_boxes(count)
    lo, hi = (np.column_stack([x, np.zeros(count)]) for x in (low, high))
    lower, upper = enclose_many(of, lo, hi, natural=True)
    for k in {0, count // 2, count - 1}:
        one = enclose_many(of, lo[k : k + 1], hi[k : k + 1], natural=True)
        assert (one[0][0, 0], one[1][0, 0]) == (lower[k, 0], upper[k, 0])
    best = enclose_many(of, lo, hi)
    assert (best[0] >= lower).all()
    assert (best[1] <= upper).all()
    assert (best[1] - best[0] < 0.9 * (upper - lower)).all()


def function_of(build: Build) -> Bounded:
    x = ca.SX.sym("x", 2)
    return bounded("sample", ("x", "y"), ca.Function("sample", [x], [build(*ca.vertsplit(x))]))


@pytest.mark.parametrize(
    ("build", "box", "reason"),
    [
        (lambda x, y: x * x + y * y, (-1.0, 1.5, -1.0, 1.5), "4096 boxes did not suffice"),
        (lambda x, y: ca.sqrt(x) + y, (-2.0, -1.0, 5.0, 6.0), "may be undefined"),
        (lambda x, y: x - y, (1.0, 1.0, 1.0, 1.0), "no side can be divided further"),
        (lambda x, y: 1 + x * x + y, (0.0, np.inf, 0.0, 1.0), "a side is infinite"),
    ],
)
def test_what_stays_open_says_why(build: Build, box: tuple[float, ...], reason: str) -> None:
    of = function_of(build)
    sides_ = {"x": Interval(*box[:2]), "y": Interval(*box[2:])}
    proof = prove_positive(of, sides_)
    if proof.verdict is Verdict.REFUTED:  # x - y at the point 1: equality is no REFUTED by bounds
        pytest.fail(f"refuted at {proof.box}")
    assert proof.verdict is Verdict.UNKNOWN
    assert reason in proof.reason
    assert all(proof.box[key].within(sides_[key]) for key in sides_)


def test_a_decided_inequality_needs_no_reason() -> None:
    of = function_of(lambda x, y: x + y)
    for end in (1.0, -1.0):
        box = {"x": Interval.point(end), "y": Interval.point(end)}
        assert prove_positive(of, box).reason == ""


def ratio_box(least: str, scale: float = 1.0) -> Box:
    """The box of the benchmark, widened about its middle, and the threshold."""
    wide = {
        name: Interval(
            s.mid - scale * (s.mid - s.lo) if scale > 1.0 else s.lo,
            s.mid + scale * (s.hi - s.mid) if scale > 1.0 else s.hi,
        )
        for name, s in zip(RATIO_NAMES, RATIO_BOX, strict=True)
    }
    return {**wide, "least": Interval.exactly(Fraction(least))}


@pytest.mark.parametrize("least", ["2.8", "3.35", "3.358", "3.3581", "3.358116"])
def test_the_ratio_of_eq_5_is_proved_on_its_box_with_few_boxes(least: str) -> None:
    proof = prove_positive(ratio(), ratio_box(least))
    assert proof.verdict is Verdict.PROVED
    assert proof.boxes <= 7


@pytest.mark.parametrize(("least", "scale"), [("3.3582", 1.0), ("3.36", 1.0), ("3.3581", 1.001)])
def test_the_ratio_is_not_proved_beyond_its_least_value(least: str, scale: float) -> None:
    box = ratio_box(least, scale)
    assert prove_positive(ratio(), box).verdict is not Verdict.PROVED
    # the least value is attained at the corner d1+, d2+, rho-, theta- (monotone in all four)
    d1, d2, rho, theta = (box[name] for name in RATIO_NAMES)
    c, s = np.cos(theta.lo), np.sin(theta.lo)
    product = d1.hi * d2.hi
    value = (product * c + (rho.lo + d1.hi**2) * s) / ((rho.lo + d2.hi**2) * c + product * s)
    assert value < float(Fraction(least))


def test_corners_of_a_box_are_all_of_them() -> None:
    box = [Interval(0.0, 1.0)] * 3
    assert len({tuple(corner(box, k)) for k in range(8)}) == 8


def test_too_many_outputs_are_refused() -> None:
    x = ca.SX.sym("x", 1)
    many = ca.Function("many", [x], [ca.repmat(x, BLOCK // 4 + 1, 1)])
    with pytest.raises(ValueError, match="many has 33 outputs, at most 32"):
        bounded("many", ("x",), many)
