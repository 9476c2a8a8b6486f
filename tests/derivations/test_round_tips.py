"""Round tips and drag tensors against the simulator and against balances solved in exact rationals."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad

from derivations import drag_tensor
from derivations._derivation import Derivation
from derivations.drag_tensor import D_aa, D_an, D_at, D_nn, D_nt, D_tt
from derivations.mechanics import d1, d2
from meso_robust.simulator import Outcome, Point, Push, Round, simulate
from tests.derivations.exact import Vector, force_column, solve, velocity_row
from tests.simulator.problems import UM, in_body, rectangle

DEEP, LONG, RHO = 418.5, 808.0, 376_900.0
"""Half of the paper's part across and along, µm, and its fitted ratio, µm²."""


X: Vector = (Fraction(1), Fraction(0))
Y: Vector = (Fraction(0), Fraction(1))


def tip(radius: float) -> Point | Round:
    return Round(radius * UM) if radius else Point()


@pytest.mark.parametrize("name", ["round_tips", "drag_tensor"])
def test_everything_is_new_and_proved(name: str, derived: tuple[Derivation, ...]) -> None:
    (claims,) = (one.claims for one in derived if one.name == name)
    assert {claim.verdict.words for claim in claims} == {"NEW"}
    assert all(claim.checks for claim in claims)


@pytest.mark.parametrize("radius", [0.0, 12.5, 60.0])
@pytest.mark.parametrize(("start", "offset"), [(60.0, 350.0), (75.0, 500.0), (105.0, -400.0)])
def test_a_sticking_tip_rolls_and_the_travel_is_the_quadrature(
    radius: float, start: float, offset: float
) -> None:
    begin = np.radians(start)
    a = np.array([np.cos(begin), np.sin(begin)])
    n = np.array([np.sin(begin), -np.cos(begin)])
    push = Push.straight(
        vertices=rectangle(LONG * UM, DEEP * UM),
        poses=np.array([[0.0, 0.0, begin]]),
        tips=(offset * a + (DEEP + radius) * n)[None, None] * UM,
        travel=np.array([[[-400.0, 0.0]]]) * UM,
        shapes=(tip(radius),),
        friction=np.array([2.0]),  # sticks at every one of these orientations
        film_ratio=np.array([RHO * UM**2]),
        step=0.05 * UM,
    )
    path = simulate(push, record=8000).path[0]
    place = push.waypoints[0, 0, 0] + np.linspace(0, 1, len(path))[:, None] * (
        push.waypoints[0, 1, 0] - push.waypoints[0, 0, 0]
    )
    seen = in_body(path, place)[:, 0] / UM
    turned = path[:, 2] - begin
    assert abs(turned[-1]) > np.radians(1)
    assert seen == pytest.approx(offset - radius * turned, abs=0.01)

    def per_turn(angle: float) -> float:
        along = offset - radius * (angle - begin)
        return (RHO + DEEP**2 + along**2) / (along * np.sin(angle) - DEEP * np.cos(angle))

    assert quad(per_turn, begin, path[-1, 2])[0] == pytest.approx(400.0, abs=0.02)


@pytest.mark.parametrize("friction", [0.33, 0.36])
@pytest.mark.parametrize(("active", "passive"), [(0, 0), (2.5, 2.5), (12.5, 12.5), (2.5, 12.5)])
def test_the_part_jams_just_below_the_bound_and_not_above(
    friction: float, active: float, passive: float
) -> None:
    """To 0.05 µm on either side."""
    root = np.hypot(1, friction)
    bound = 2 * DEEP * root + (active + passive) / root
    apart = bound + np.array([-0.05, 0.05])
    tips = np.stack(
        [
            np.column_stack([np.full(2, -DEEP - passive), -apart / 2]),
            np.column_stack([np.full(2, DEEP + active), apart / 2]),
        ],
        axis=1,
    )
    push = Push.straight(
        vertices=rectangle(LONG * UM, DEEP * UM),
        poses=np.tile([0.0, 0.0, np.pi / 2], (2, 1)),
        tips=tips * UM,
        travel=np.tile([[0.0, 0.0], [-1000.0, 0.0]], (2, 1, 1)) * UM,
        shapes=(tip(passive), tip(active)),
        friction=np.full(2, friction),
        film_ratio=np.full(2, RHO * UM**2),
        step=0.02 * UM,
    )
    assert list(simulate(push).outcomes) == [Outcome.JAM, Outcome.COMPLETED]


DRAGS = [
    {D_aa: 3, D_nn: 2, D_tt: 40, D_an: 1, D_at: 2, D_nt: -1},
    {D_aa: 1, D_nn: 5, D_tt: 9, D_an: -2, D_at: 1, D_nt: 0},
]


@pytest.mark.parametrize("drag", DRAGS)
@pytest.mark.parametrize("offset", [Fraction(3, 2), Fraction(-1)])
def test_turn_and_forces_on_a_drag_tensor_by_elimination(
    drag: dict[sp.Symbol, int], offset: Fraction
) -> None:
    """Five equations in world axes: drag against force and moment; the contact moves by -e_x."""
    depth, c, s = Fraction(2), Fraction(3, 5), Fraction(4, 5)
    frame = [[c, s, Fraction(0)], [s, -c, Fraction(0)], [Fraction(0), Fraction(0), Fraction(1)]]
    body = [[drag[D_aa], drag[D_an], drag[D_at]], [drag[D_an], drag[D_nn], drag[D_nt]]]
    body.append([drag[D_at], drag[D_nt], drag[D_tt]])
    axes = range(3)
    world = [
        [sum((frame[i][k] * body[k][m] * frame[m][j] for k in axes for m in axes), Fraction(0))
         for j in axes]
        for i in axes
    ]  # fmt: skip
    arm = (offset * c + depth * s, offset * s - depth * c)
    pushes = [force_column(arm, (-s, c)), force_column(arm, (c, s))]
    zero = [Fraction(0)] * 2
    rows = [[*world[i], *(-push[i] for push in pushes)] for i in axes]
    rows += [[*velocity_row(arm, axis), *zero] for axis in (X, Y)]
    *_, turn, pressing, along = solve(rows, [*[Fraction(0)] * 3, Fraction(-1), Fraction(0)])
    at = {**drag, d1: 2, d2: sp.Rational(offset.numerator, offset.denominator)}
    A, B, C, F, p, q = (
        getattr(drag_tensor, name).subs(at)
        for name in ("A_HAT", "B_HAT", "C_HAT", "F_HAT", "P_HAT", "Q_HAT")
    )
    cosine, sine = sp.Rational(3, 5), sp.Rational(4, 5)
    assert turn == (p * sine - q * cosine) / F
    assert pressing == (A * cosine + B * sine) / F
    assert along == -(C * cosine + A * sine) / F
