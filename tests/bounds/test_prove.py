"""Proofs over boxes: what is proved is true, what is refuted fails at the witness."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from importlib import import_module
from typing import Any

import casadi as ca
import mpmath  # type: ignore[import-untyped]
import pytest
from hypothesis import given, settings, strategies as st

from meso_robust import units
from meso_robust.bounds import (
    HALF_PI,
    Bounded,
    Box,
    Interval,
    Verdict,
    bounded,
    prove_positive,
)
from meso_robust.bounds.prove import fails_somewhere
from meso_robust.conditions import condition
from tests.bounds.formulas import NAMES, Formula, corner, formulas, together
from tests.strategies import REPEATABLE, intervals

EXACT = mpmath.mp.clone()
EXACT.dps = 50
D1 = Fraction(4185, 10**7)
RHO = Fraction(3769, 10**10)
MU = Fraction(3, 10)
LIMIT = MU * (RHO + D1**2) / D1  # of |d2|, by hand: mu (rho + d1^2) > d1 |d2| at theta = 90 deg


def sticking(low: Fraction, high: Fraction) -> dict[str, Interval]:
    """An upright edge pushed between two offsets."""
    return {
        "theta": HALF_PI,
        "d1": units.metres(418.5),
        "d2": Interval(Interval.exactly(low).lo, Interval.exactly(high).hi),
        "rho": units.square_metres(376900.0),
        "mu": units.plain(0.3),
    }


def values(of: Bounded, box: Box) -> list[Any]:
    """Exact values of a generated function at a point box."""
    module, name = of.name.split(".")
    generated = getattr(import_module(f"meso_robust._generated.{module}"), name)
    point = [EXACT.mpf(box[key].lo) for key in of.inputs]
    assert all(box[key].lo == box[key].hi for key in of.inputs)
    return list(generated(EXACT, *point))


def function_of(build: Callable[[Any, Any], list[Any]]) -> Bounded:
    x = ca.SX.sym("x", 2)
    outputs = ca.vertcat(*build(*ca.vertsplit(x)))
    return bounded("sample", ("x", "y"), ca.Function("sample", [x], [ca.densify(outputs)]))


def test_the_limit_of_sticking_by_hand() -> None:
    assert 395.7e-6 < LIMIT < 395.8e-6


def test_sticking_is_proved_up_to_just_below_its_limit() -> None:
    near = LIMIT * (1 - Fraction(1, 10**9))
    proof = prove_positive(
        condition("one_point_sticking", "friction_margin"), sticking(-near, near)
    )
    assert proof.verdict is Verdict.PROVED
    least = MU * (RHO + D1**2) - D1 * near
    assert 0.0 < proof.lower <= float(least)


@pytest.mark.parametrize("side", [1, -1])
def test_sticking_just_beyond_its_limit_is_not_proved(side: int) -> None:
    of = condition("one_point_sticking", "friction_margin")
    beyond = side * LIMIT * (1 + Fraction(1, 10**9))
    low, high = sorted((Fraction(0), beyond))
    assert prove_positive(of, sticking(low, high)).verdict is not Verdict.PROVED
    at = prove_positive(of, sticking(beyond, beyond))
    assert at.verdict is Verdict.REFUTED
    assert min(values(of, at.box)) < 0


def test_sticking_well_beyond_its_limit_is_refuted_at_a_witness() -> None:
    of = condition("one_point_sticking", "friction_margin")
    box = sticking(Fraction(0), 2 * LIMIT)
    proof = prove_positive(of, box)
    assert proof.verdict is Verdict.REFUTED
    assert all(proof.box[key].within(box[key]) for key in of.inputs)
    assert min(values(of, proof.box)) <= 0


def test_no_jam_has_its_limit_at_the_hypotenuse() -> None:
    of = condition("two_sided_rotation", "no_jam")
    box = {"d1": units.metres(418.5), "mu": Interval(0.30, 0.36)}
    limit = 837e-6 * math.hypot(1.0, 0.36)
    above, below = Interval(limit * (1 + 1e-9), 1e-3), Interval(limit * (1 - 1e-9), 1e-3)
    assert prove_positive(of, {**box, "V": above}).verdict is Verdict.PROVED
    assert prove_positive(of, {**box, "V": below}).verdict is not Verdict.PROVED
    deep = prove_positive(of, {**box, "V": Interval(8e-4, 8.5e-4)})
    assert deep.verdict is Verdict.REFUTED
    assert values(of, deep.box)[0] <= 0


def test_bisection_proves_what_one_box_cannot() -> None:
    of = function_of(lambda x, y: [x * x - x * y + y * y + ca.sin(x) * ca.sin(x) + 0.125])
    wide = {"x": Interval(-2.0, 2.0), "y": Interval(-2.0, 2.0)}
    proof = prove_positive(of, wide)
    assert proof.verdict is Verdict.PROVED
    assert proof.boxes > 1
    assert 0.0 < proof.lower <= 0.125


def test_a_proof_in_vain_is_seen_at_a_corner_or_inside() -> None:
    box = {"x": Interval(-2.0, 2.0), "y": Interval(-1.0, 1.0)}
    fails_at = {
        "one corner": lambda x, y: [x + y + 2.75],
        "the middle": lambda x, y: [x * x - 0.0625],
    }
    for build in fails_at.values():
        assert fails_somewhere(function_of(build), box)
    assert not fails_somewhere(function_of(lambda x, y: [x + y + 3.25]), box)


def test_zero_is_not_positive() -> None:
    of = function_of(lambda x, y: [x * x + y * y])
    box = {"x": Interval(-1.0, 1.0), "y": Interval(-1.0, 1.0)}
    assert prove_positive(of, box).verdict is not Verdict.PROVED
    beside = {"x": Interval(-1.0, 1.5), "y": Interval(-1.0, 1.5)}
    assert prove_positive(of, beside).verdict is not Verdict.PROVED


def test_what_is_nowhere_defined_is_unknown() -> None:
    of = function_of(lambda x, y: [ca.sqrt(x) + y])
    box = {"x": Interval(-2.0, -1.0), "y": Interval(5.0, 6.0)}
    proof = prove_positive(of, box)
    assert proof.verdict is Verdict.UNKNOWN
    assert all(proof.box[key].within(box[key]) for key in box)
    partly = prove_positive(of, {**box, "x": Interval(-1e-3, 4.0)})
    assert partly.verdict is not Verdict.PROVED


@pytest.mark.parametrize(
    "side",
    [Interval(0.1, math.inf), Interval(-math.inf, 0.1), Interval(-math.inf, math.inf)],
    ids=str,
)
def test_infinite_boxes_are_undecided(side: Interval) -> None:
    of = function_of(lambda x, y: [1 + x * x + y * y])
    box = {"x": side, "y": Interval(0.0, 1.0)}
    assert prove_positive(of, box).verdict is Verdict.UNKNOWN
    assert prove_positive(of, box, any_output=True).verdict is Verdict.UNKNOWN


def test_any_output_needs_one_positive_value_at_every_point() -> None:
    either = function_of(lambda x, y: [x, 1 - x + 0 * y])
    box = {"x": Interval(-1.0, 2.0), "y": Interval.point(0.0)}
    assert prove_positive(either, box, any_output=True).verdict is Verdict.PROVED
    assert prove_positive(either, box).verdict is Verdict.REFUTED
    gap = function_of(lambda x, y: [x - 1, -x - y])
    missed = prove_positive(gap, {**box, "y": Interval(0.0, 1.0)}, any_output=True)
    assert missed.verdict is Verdict.REFUTED
    x, y = missed.box["x"].lo, missed.box["y"].lo
    assert x - 1 <= 0
    assert -x - y <= 0


def test_the_second_tip_may_be_beside_or_in_front() -> None:
    of = condition("sticking_motion", "beside")
    box = {
        "theta": Interval(1.56, 1.68),
        "d2": Interval(3.2e-4, 3.5e-4),
        "half": Interval.point(808e-6),
        "dx": Interval(-3e-6, 3e-6),
        "dy": Interval.point(580e-6),
        "side": Interval.point(1.0),
    }
    assert prove_positive(of, box, any_output=True).verdict is Verdict.PROVED
    assert prove_positive(of, box).verdict is Verdict.REFUTED
    inward = {**box, "d2": Interval(1.0e-4, 3.5e-4)}
    hit = prove_positive(of, inward, any_output=True)
    assert hit.verdict is Verdict.REFUTED
    assert max(values(of, hit.box)) <= 0


sides = intervals(st.floats(-4.0, 4.0))


@settings(REPEATABLE, max_examples=120)
@given(tree=formulas, other=formulas, box=st.tuples(sides, sides, sides), any_output=st.booleans())
def test_verdicts_on_random_formulas_agree_with_exact_values(
    tree: Formula, other: Formula, box: tuple[Interval, Interval, Interval], any_output: bool
) -> None:
    try:
        of = together(tree, other)
    except ValueError:  # CasADi folded it to a constant that is not exact
        return
    proof = prove_positive(of, dict(zip(NAMES, box, strict=True)), any_output=any_output)
    join = max if any_output else min

    def score(point: list[Fraction]) -> Fraction | None:
        found = [tree.exact(point), other.exact(point)]
        return None if None in found else join(value for value in found if value is not None)

    middle = [Fraction(side.lo) / 2 + Fraction(side.hi) / 2 for side in box]
    if proof.verdict is Verdict.PROVED:
        assert proof.lower > 0.0
        for point in (middle, *(corner(box, k) for k in range(8))):
            value = score(point)
            assert value is None or value >= proof.lower
    if proof.verdict is Verdict.REFUTED:
        value = score([Fraction(proof.box[name].lo) for name in NAMES])
        assert value is None or value <= 0
