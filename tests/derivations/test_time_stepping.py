"""The scheme of eq. (2) against the closed form and against itself in numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import pytest
import sympy as sp

from derivations import mechanics, one_point_sticking, time_stepping
from derivations._claim import Claim, Verdict
from derivations._statement import DerivationError

DEPTH, OFFSET, RHO = 418.5, 350.0, 376_900.0
RADIUS = math.hypot(DEPTH, OFFSET)
RATE = RADIUS / (RHO + RADIUS**2)
DELTA = math.atan2(DEPTH, OFFSET)
VERDICTS = {
    "equation-2": Verdict.SHARPENED,
    "time-step-error": Verdict.NEW,
    "time-stepping-error": Verdict.NEW,
    "time-stepping-drift": Verdict.NEW,
}


@cache
def claims() -> dict[str, Claim]:
    return {claim.key: claim for claim in time_stepping.derive().claims}


def slope(theta: float) -> float:
    """Turn per travel while sticking (eq. 5)."""
    return (OFFSET * math.sin(theta) - DEPTH * math.cos(theta)) / (RHO + RADIUS**2)


def exact(theta: float, travel: float) -> float:
    """Closed form."""
    tangent = math.tan((theta - DELTA) / 2) * math.exp(RATE * travel)
    return DELTA + 2 * math.atan(tangent)


def stepped(theta: float, travel: float, steps: int) -> float:
    """Explicit steps."""
    for _ in range(steps):
        theta += travel / steps * slope(theta)
    return theta


def test_verdicts() -> None:
    assert {key: claim.verdict for key, claim in claims().items()} == VERDICTS


@pytest.mark.parametrize("start", [0.9, 1.3, math.pi / 2, 2.0])
def test_error_of_one_step(start: float) -> None:
    h, phi = 0.5, start - DELTA
    error = exact(start, h) - stepped(start, h, 1)
    assert error == pytest.approx(h**2 * RATE**2 * math.sin(phi) * math.cos(phi) / 2, rel=2e-3)
    assert abs(error) <= RATE**2 * h**2 / 4


def test_derived_coefficients_are_those_of_the_closed_form() -> None:
    at = {time_stepping.k0: math.tan((1.3 - DELTA) / 2), time_stepping.L: RATE}
    first, second = (float(value.subs(at)) for value in time_stepping.taylor())
    h = 1e-2
    moves = exact(1.3, h) - 1.3, exact(1.3, -h) - 1.3
    assert first == pytest.approx((moves[0] - moves[1]) / (2 * h), rel=1e-9)
    assert second == pytest.approx((moves[0] + moves[1]) / (2 * h**2), rel=1e-3)


def test_a_step_with_the_rate_at_its_end_errs_the_other_way() -> None:
    h, start = 0.5, 1.3
    late = start
    for _ in range(60):
        late = start + h * slope(late)
    early = stepped(start, h, 1)
    assert late - exact(start, h) == pytest.approx(exact(start, h) - early, rel=1e-3)


def test_first_order_and_the_bound_of_a_push() -> None:
    start, travel = 0.5, 600.0  # the error has one sign along the whole push
    errors = {m: abs(stepped(start, travel, m) - exact(start, travel)) for m in (64, 128, 256)}
    assert errors[64] / errors[128] == pytest.approx(2, rel=0.02)
    assert errors[128] / errors[256] == pytest.approx(2, rel=0.02)
    for m, error in errors.items():
        assert error <= travel / m * RATE / 4 * (math.exp(RATE * travel) - 1)


def test_number_in_the_text() -> None:
    bound = math.degrees(140 / 30 * RATE / 4 * (math.exp(RATE * 600) - 1))
    assert f"{bound:.3f}°" in claims()["time-stepping-error"].derived
    coarse = math.radians(1) * 4 / (RATE * (math.exp(RATE * 600) - 1))
    assert f"{coarse:.0f} µm" in claims()["time-stepping-error"].derived


@pytest.mark.parametrize("turn", [0.01, -0.02, 0.1])
def test_drift_and_gap_in_numbers(turn: float) -> None:
    """Edge along x below the centre: a = (1, 0), n = (0, -1)."""
    touched = (OFFSET, -DEPTH)
    c, s = math.cos(turn), math.sin(turn)
    moved = (c * touched[0] - s * touched[1], s * touched[0] + c * touched[1])
    tip = (touched[0] - turn * touched[1], touched[1] + turn * touched[0])
    size = math.hypot(moved[0] - tip[0], moved[1] - tip[1]) / RADIUS
    along, across = (float(part) for part in time_stepping.drift(sp.Float(turn)).doit())
    assert math.hypot(along, across) == pytest.approx(size, rel=1e-6)
    gap = s * tip[0] - c * tip[1] - DEPTH  # tip along the turned normal (s, -c)
    at = {mechanics.d1: DEPTH, mechanics.d2: OFFSET}
    assert float(time_stepping._gap(sp.Float(turn)).subs(at)) == pytest.approx(gap, abs=1e-9)
    assert gap == pytest.approx(DEPTH * turn**2 / 2, rel=abs(turn))
    assert gap > 0


def _backwards() -> Any:
    solved = one_point_sticking.solve_sticking()
    return solved._replace(twist=sp.diag(1, 1, -1) * solved.twist)


def _clockwise(twist: sp.Matrix, arm: sp.Matrix) -> sp.Matrix:
    return mechanics.velocity_at(sp.diag(1, 1, -1) * twist, arm)


def _doubled() -> tuple[sp.Expr, sp.Expr]:
    first, second = ORIGINAL()
    return first, 2 * second


ORIGINAL = time_stepping.taylor


@pytest.mark.parametrize(("name", "broken"), [("solve_sticking", _backwards), ("taylor", _doubled)])
def test_a_broken_ingredient_is_noticed(
    monkeypatch: pytest.MonkeyPatch, name: str, broken: Callable[..., Any]
) -> None:
    monkeypatch.setattr(time_stepping, name, broken)
    with pytest.raises(DerivationError, match="time-step-error"):
        time_stepping._error_of_a_step()


def test_a_flipped_turn_changes_the_verdict_of_equation_2(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(time_stepping, "velocity_at", _clockwise)
    assert time_stepping._kinematic_matrix().verdict is Verdict.REFUTED
