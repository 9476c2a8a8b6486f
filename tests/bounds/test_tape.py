"""Tapes copy CasADi functions faithfully, and refuse what they cannot bound."""

from __future__ import annotations

from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from meso_robust.bounds import Bounded, Interval, bounded
from meso_robust.bounds.tape import compile_tape, run
from meso_robust.types import Floats
from tests.bounds.formulas import NAMES, Formula, corner, formulas, together
from tests.strategies import REPEATABLE, intervals

sides = intervals(st.floats(-4.0, 4.0))


def on_tape(function: ca.Function, lo: Floats, hi: Floats) -> Floats:
    tape = compile_tape(function)
    work, result = np.empty((tape.slots, 2)), np.empty((tape.outputs, 2))
    run(tape.code, tape.constant, lo, hi, work, result)
    return result


def function_of(build: object) -> ca.Function:
    assert callable(build)
    x = ca.SX.sym("x", 2)
    return ca.Function("sample", [x], [ca.densify(ca.vertcat(build(*ca.vertsplit(x))))])


@pytest.mark.parametrize("constant", [0.1, 1 / 3, 2.0**-11, 2.0**41, 1e300])
def test_a_constant_that_may_be_rounded_is_refused(constant: float) -> None:
    function = function_of(lambda x, _: constant * x)
    with pytest.raises(ValueError, match="exact small dyadic"):
        compile_tape(function)


@pytest.mark.parametrize("constant", [0.5, -0.25, 3.0, 2.0**-10, 1000.0])
def test_an_exact_constant_is_kept(constant: float) -> None:
    point = np.array([1.0, 0.0])
    low, high = on_tape(function_of(lambda x, _: constant * x), point, point)[0]
    assert low <= constant <= high <= low + 1e-15 * abs(constant)


@pytest.mark.parametrize(
    "build",
    [
        lambda x, _: ca.tan(x),
        lambda x, _: ca.atan(x),
        lambda x, y: ca.atan2(x, y),
        lambda x, _: ca.fabs(x),
        lambda x, _: ca.exp(x),
        lambda x, y: ca.fmin(x, y),
        lambda x, y: x**y,
    ],
    ids=["tan", "atan", "atan2", "fabs", "exp", "fmin", "pow"],
)
def test_an_operation_without_interval_form_is_refused(build: object) -> None:
    with pytest.raises(ValueError, match=r"sample: CasADi operation .* no interval form"):
        compile_tape(function_of(build))


def test_preparing_a_function_refuses_what_its_tape_refuses() -> None:
    with pytest.raises(ValueError, match="exact small dyadic"):
        bounded("sample", ("x", "y"), function_of(lambda x, y: 0.1 * x + y))


@REPEATABLE
@given(x=st.floats(-3.0, 3.0), y=st.floats(0.1, 3.0))
def test_on_a_point_the_tape_agrees_with_casadi(x: float, y: float) -> None:
    function = function_of(
        lambda x, y: ca.vertcat(
            ca.sin(x) - ca.cos(y),
            ca.sqrt(x * x + y) / y,
            ca.log(y) + 2 * x,
            -x / (1 + y),
            (x - y) ** 2,
            1 / y,
            y,
        )
    )
    point = np.array([x, y])
    found, number = on_tape(function, point, point), np.array(function(point)).ravel()
    assert (found[:, 1] - found[:, 0] <= 1e-13 * (1.0 + np.abs(number))).all()
    assert (np.abs(found.mean(axis=1) - number) <= 1e-13 * (1.0 + np.abs(number))).all()


@settings(REPEATABLE, max_examples=60)
@given(tree=formulas, other=formulas, box=st.tuples(sides, sides, sides), data=st.data())
def test_random_formulas_hold_their_exact_values(
    tree: Formula, other: Formula, box: tuple[Interval, Interval, Interval], data: st.DataObject
) -> None:
    of = _prepared(tree, other)
    if of is None:
        return
    lo, hi = np.array([[side.lo, side.hi] for side in box]).T.copy()
    found = on_tape(of.function, lo, hi)
    shares = data.draw(st.lists(st.fractions(0, 1, max_denominator=16), min_size=3, max_size=3))
    inside = [
        Fraction(a) + t * (Fraction(b) - Fraction(a))
        for a, b, t in zip(lo, hi, shares, strict=True)
    ]
    for point in (inside, *(corner(box, k) for k in range(8))):
        for row, formula in enumerate((tree, other)):
            value = formula.exact(point)
            # where it is undefined nothing is asked: CasADi may have folded x/x to 1 before
            assert value is None or found[row, 0] <= value <= found[row, 1]


def _prepared(*trees: Formula) -> Bounded | None:
    """None for a formula that CasADi folds to something that is no number or no exact constant."""
    try:
        return together(*trees)
    except ValueError:
        return None


def test_inputs_keep_their_order_and_outputs_theirs() -> None:
    p, q, r = (Formula("variable", value=Fraction(k)) for k in range(len(NAMES)))
    of = together(Formula("-", (p, q)), r)
    point = np.array([5.0, 3.0, 7.0])
    found = on_tape(of.function, point, point)
    assert found[0, 0] <= 2.0 <= found[0, 1]
    assert found[1].tolist() == [7.0, 7.0]
