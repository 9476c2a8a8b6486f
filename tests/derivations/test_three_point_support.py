"""The three-point support against elimination in fractions and against minimal dissipation."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any

import pytest
import sympy as sp

from derivations import mechanics, three_point_support as tps
from derivations._claim import Claim, Verdict
from derivations._statement import DerivationError
from tests.derivations.exact import solve

Q = Fraction
Point = tuple[Fraction, Fraction]
PRINTED: dict[str, list[Point]] = {
    "p_1^*": [(Q("411.3"), Q("-563.3")), (Q("-409.1"), Q("605.9")), (Q("-273.2"), Q("-102.1"))],
    "p_2^*": [(Q("-412.4"), Q("794.0")), (Q("-217.8"), Q("774.5")), (Q("278.8"), Q("-538.8"))],
}
VERDICTS = {
    "equation-1": Verdict.SHARPENED,
    "friction-columns": Verdict.INCONSISTENT,
    "support-loads": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
    "support-hull": Verdict.SHARPENED,
    "centre-of-friction": Verdict.NEW,
    "support-maximum-dissipation": Verdict.NEW,
    "linearised-support-friction": Verdict.NEW,
    "three-point-conditions": Verdict.NEW,
    "mu-s-has-no-effect": Verdict.SHARPENED,
    "rate-three-points": Verdict.NEW,
    "support-points-not-unique": Verdict.CONFIRMED,
    "straight-push-is-unstable": Verdict.SHARPENED,
    "table-1": Verdict.SHARPENED,
    "table-1-uncertainty": Verdict.NEW,
}


@cache
def claims() -> dict[str, Claim]:
    return {claim.key: claim for claim in tps.derive().claims}


def loads(places: list[Point]) -> list[Fraction]:
    """Shares of the weight by elimination."""
    rows = [[Q(1)] * 3, [x for x, _ in places], [y for _, y in places]]
    return solve(rows, [Q(1), Q(0), Q(0)])


def dissipation(places: list[Point], twist: tuple[float, float, float]) -> float:
    """Per unit of mu_s W."""
    v_x, v_y, omega = twist
    return sum(
        float(N) * math.hypot(v_x - omega * float(y), v_y + omega * float(x))
        for N, (x, y) in zip(loads(places), places, strict=True)
    )


def turn_while_sticking(places: list[Point], tilt: float, offset: float) -> float:
    """Turn per travel of a sticking contact: the one that dissipates least (golden section)."""
    depth = 418.5
    c, s = math.cos(math.pi / 2 + tilt), math.sin(math.pi / 2 + tilt)
    arm = (offset * c + depth * s, offset * s - depth * c)

    def power(omega: float) -> float:
        return dissipation(places, (-1 + omega * arm[1], -omega * arm[0], omega))

    low, high, golden = -0.002, 0.002, (math.sqrt(5) - 1) / 2
    for _ in range(80):
        first, second = high - golden * (high - low), low + golden * (high - low)
        if power(first) < power(second):
            high = second
        else:
            low = first
    return (low + high) / 2


def test_verdicts() -> None:
    assert {key: claim.verdict for key, claim in claims().items()} == VERDICTS


@pytest.mark.parametrize("name", PRINTED)
def test_printed_sets_by_elimination(name: str) -> None:
    at = tps._table_point(name)
    assert [Q(str(at[one.load])) for one in tps.SUPPORTS] == loads(PRINTED[name])
    assert all(N > 0 for N in loads(PRINTED[name]))
    assert all(abs(x) <= Q("418.5") and abs(y) <= 808 for x, y in PRINTED[name])


@pytest.mark.parametrize(("name", "margin"), [("p_1^*", 13.1348), ("p_2^*", 0.55544)])
def test_distance_of_the_centre_from_the_nearest_edge(name: str, margin: float) -> None:
    p = [(float(x), float(y)) for x, y in PRINTED[name]]
    distances = []
    for j in range(3):
        (x, y), (u, v) = p[j], p[(j + 1) % 3]
        distances.append(abs(x * v - y * u) / math.hypot(u - x, v - y))
    assert min(distances) == pytest.approx(margin, abs=1e-4)
    assert float(tps._table_limits(name)[0]) == pytest.approx(min(distances), rel=1e-12)
    assert f"{margin:.3g}" in claims()["table-1"].derived


def test_two_micrometres_put_the_centre_of_p2_outside() -> None:
    places = [*PRINTED["p_2^*"][:2], (Q("280.8"), Q("-538.8"))]
    assert min(loads(places)) < 0
    assert min(loads([*PRINTED["p_2^*"][:2], (Q("279.8"), Q("-538.8"))])) > 0  # 1 µm does not


def test_no_force_of_the_disc_dissipates_more() -> None:
    rng = random.Random(3)
    for _ in range(300):
        v = (rng.uniform(-1, 1), rng.uniform(-1, 1))
        speed, turn, size = math.hypot(*v), rng.uniform(0, 2 * math.pi), rng.uniform(0, 1)
        power = -size * (math.cos(turn) * v[0] + math.sin(turn) * v[1])
        assert power <= speed + 1e-12  # what -v/|v| dissipates


def test_four_directions_keep_between_71_and_100_percent() -> None:
    best = [max(abs(math.cos(t / 1000)), abs(math.sin(t / 1000))) for t in range(6284)]
    assert min(best) == pytest.approx(math.sqrt(0.5), abs=1e-4)
    assert max(best) == pytest.approx(1.0)
    assert "0.71" in claims()["linearised-support-friction"].derived


@pytest.mark.parametrize("name", PRINTED)
@pytest.mark.parametrize(("tilt", "offset"), [(1e-4, 0.0), (0.0, 0.05), (1e-4, -0.02)])
def test_straight_push_by_minimal_dissipation(name: str, tilt: float, offset: float) -> None:
    places = PRINTED[name]
    moment = sum(float(N * x * x) for N, (x, _) in zip(loads(places), places, strict=True))
    at = {tps.q_xx: moment, mechanics.d1: 418.5, tps.epsilon: tilt, tps.delta: offset}
    derived = float(tps.near_the_straight_push()[0].subs(at))
    assert derived == pytest.approx(turn_while_sticking(places, tilt, offset), rel=2e-3, abs=1e-10)
    assert float(tps._second_moment(name)) == pytest.approx(moment, rel=1e-12)


def test_growth_of_a_deviation_over_a_test_push() -> None:
    text = claims()["straight-push-is-unstable"].derived
    for moment in (164_126.8286, 114_649.3699, 376_900.0, 0.0):
        growth = math.exp(418.5 * 700 / (moment + 418.5**2))
        shown = f"{growth:.2f}" if moment else f"{growth:.1f}"
        assert shown in text


def test_the_path_is_the_same_for_both_printed_mu_s() -> None:
    """Minimal dissipation scales with mu_s: its minimiser does not move."""
    small, large = (dict(c.witness) for c in _motions())
    same = ("v_x", "v_y", "omega")
    assert [small[key] for key in same] == [large[key] for key in same]
    assert Q(large["lambda_n"]) / Q(small["lambda_n"]) == Q("0.757") / Q("0.013")


def _motions() -> tuple[Any, Any]:
    (small,) = claims()["mu-s-has-no-effect"].of_print
    large = claims()["three-point-conditions"].checks[1]
    return small, large


def test_the_turn_about_a_support_balances_by_hand() -> None:
    """Moments about the resting support, where its own friction drops out."""
    _, large = _motions()
    at = {name: Q(value) for name, value in large.witness.items()}
    N = loads([(Q(0), Q(-600)), (Q(-240), Q(100)), (Q(280), Q(360))])
    friction = Q("0.757") * (N[1] * 740 + N[2] * 1000)  # distances from the first support
    arm = (Q(837, 2), Q(1100))
    push = (-at["lambda_n"], at["lambda_t"])
    assert arm[0] * push[1] - arm[1] * push[0] == friction
    rest = at["f_x1"] ** 2 + at["f_y1"] ** 2
    assert rest < (Q("0.757") * N[0]) ** 2


def test_height_of_the_push_moves_the_centre_of_friction() -> None:
    assert [float(tps._table_limits(name)[1]) for name in PRINTED] == pytest.approx([30.28, 0.52])


def _flipped_moment(force: sp.Matrix, arm: sp.Matrix) -> sp.Matrix:
    return sp.Matrix([force[0], force[1], -mechanics.cross(arm, force)])


ORIGINAL = tps.friction


def _adhering(force: sp.Matrix, velocity: sp.Matrix, limit: sp.Expr) -> Any:
    return ORIGINAL(force, velocity, limit + 1)


def _backwards(twist: sp.Matrix, arm: sp.Matrix) -> sp.Matrix:
    return mechanics.velocity_at(sp.diag(1, 1, -1) * twist, arm)


def _reversed(force: sp.Matrix, velocity: sp.Matrix, limit: sp.Expr) -> Any:
    return ORIGINAL(force, -velocity, limit)


@pytest.mark.parametrize(
    ("name", "broken", "claim"),
    [
        ("friction", _reversed, tps._complete_conditions),
        ("friction", _reversed, tps._maximum_dissipation),
        ("friction", _adhering, tps._rate),
        ("friction", _adhering, tps._mu_s),
        ("velocity_at", _backwards, tps._straight_push),
    ],
)
def test_a_broken_ingredient_is_noticed(
    monkeypatch: pytest.MonkeyPatch,
    name: str,
    broken: Callable[..., Any],
    claim: Callable[[], Claim],
) -> None:
    monkeypatch.setattr(tps, name, broken)
    with pytest.raises(DerivationError):
        claim()


def test_a_flipped_moment_changes_the_verdict_of_equation_1(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(tps, "wrench", _flipped_moment)
    assert tps._balance_of_equation_1().verdict is Verdict.REFUTED


def test_another_printed_support_changes_the_verdict_of_table_1(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    places, *coefficients = tps.TABLE_I["p_1^*"]
    moved = (("411.3", "-563.3"), ("-409.1", "605.9"), ("-200.0", "400.0"))
    assert moved[2] != places[2]
    monkeypatch.setitem(tps.TABLE_I, "p_1^*", (moved, *coefficients))
    assert tps._table_1().verdict is Verdict.REFUTED


def test_the_height_of_the_push_is_needed_in_the_moment_rows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    original = tps.loads_balance
    monkeypatch.setattr(tps, "loads_balance", lambda height: original(-height))
    with pytest.raises(DerivationError, match="centre-of-friction"):
        tps._centre_of_friction()
