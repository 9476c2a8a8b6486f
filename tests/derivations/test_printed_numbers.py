"""Printed numbers, recomputed in fractions and by sampling."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any

import pytest
import sympy as sp

from derivations import mechanics, printed_numbers as pn
from derivations._claim import Claim, Verdict
from derivations._statement import DerivationError
from tests.derivations.exact import balance_rows, force_column, plus, solve, velocity_row

Q = Fraction
VERDICTS = {
    "turn-limit": Verdict.NEW,
    "film-units": Verdict.INCONSISTENT,
    "film-force": Verdict.INCONSISTENT,
    "film-unit-repair": Verdict.NEW,
    "film-not-uniform": Verdict.NEW,
    "inertia": Verdict.SHARPENED,
    "dry-friction-force": Verdict.INCONSISTENT,
    "playpen": Verdict.INCONSISTENT,
    "playpen-room": Verdict.NEW,
    "thickness": Verdict.CONFIRMED,
    "field-of-view": Verdict.SHARPENED,
    "orientation-error": Verdict.INCONSISTENT,
    "probe-speeds": Verdict.SHARPENED,
    "slot-clearance": Verdict.INCONSISTENT,
    "goal-and-slot": Verdict.NEW,
    "corner-pushes": Verdict.NEW,
    "table-2": Verdict.CONFIRMED,
    "table-3": Verdict.CONFIRMED,
    "table-4": Verdict.INCONSISTENT,
    "table-5": Verdict.CONFIRMED,
    "table-3-gain": Verdict.CONFIRMED,
    "table-3-errors": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
    "table-5-margins": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
    "tests-1-and-2": Verdict.REFUTED,
}


@cache
def claims() -> dict[str, Claim]:
    return {claim.key: claim for claim in pn.derive().claims}


def text(key: str) -> str:
    return claims()[key].derived


def test_verdicts() -> None:
    assert {key: claim.verdict for key, claim in claims().items()} == VERDICTS


# the film


def test_ratio_against_a_film_by_summation() -> None:
    l, w, cells = 1.616, 0.837, 200  # mm  # noqa: E741
    xs = [(j + 0.5) / cells - 0.5 for j in range(cells)]
    uniform = l**2 * sum(x * x for x in xs) / cells + w**2 * sum(x * x for x in xs) / cells
    ratio = 60.64 / 160.89
    assert f"{uniform:.4f}" in text("film-not-uniform")
    assert f"{ratio / uniform:.2f} times" in text("film-not-uniform")
    most = (l / 2) ** 2 + (w / 2) ** 2  # a corner
    assert uniform < ratio < most
    assert f"{most:.3f}" in text("film-units")
    assert round(ratio / (most * 1e-6), -3) == 455_000
    assert "455 000 times" in text("film-units")


def test_forces_at_the_three_speeds() -> None:
    forces = [160.89 * v * 1e-6 for v in (140, 75, 7.4)]
    shown = ", ".join(f"{1000 * force:.3g}" for force in forces)
    assert f"{shown} mN" in text("film-force")
    assert f"{shown} µN" in text("film-unit-repair")
    assert min(forces) > 20 * 50e-6


def test_only_one_pair_of_units_fits() -> None:
    fitting = []
    for f in (1.0, 1e-3, 1e-6):
        for u in (1.0, 1e-3, 1e-6):
            forces = [160.89 * f / u * v * 1e-6 for v in (140, 75, 7.4)]
            rho = 60.64 / 160.89 * u**2
            uniform = (1616e-6**2 + 837e-6**2) / 12
            if all(1e-7 <= x <= 50e-6 for x in forces) and uniform / 10 <= rho <= 3 * uniform:
                fitting.append((f, u))
    assert fitting == [(1e-6, 1e-3)]


def slipping_or_sticking(rng: random.Random) -> Fraction:
    """Turn per travel of a random contact that fits, by elimination; rho in µm²."""
    t = Q(rng.randint(20, 300), 100)
    cos, sin = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
    along, out = (cos, sin), (sin, -cos)
    arm = plus((Q(rng.randint(-800, 800)), along), (Q(rng.randint(100, 800)), out))
    inward, mu = plus((Q(-1), out)), Q(rng.randint(0, 100), 100)
    rows = balance_rows(Q(1), Q(376_900), [force_column(arm, f) for f in (inward, along)])
    closed, sticks = ([*velocity_row(arm, axis), Q(0), Q(0)] for axis in (out, along))
    right = [Q(0)] * 3 + [-sin]
    for row, value in (
        (sticks, -cos),
        *(([Q(0)] * 3 + [mu, sign], Q(0)) for sign in (Q(1), Q(-1))),
    ):
        *twist, normal, shear = solve([*rows, closed, row], [*right, value])
        slip = sum((p * q for p, q in zip(sticks, twist, strict=False)), Q(0)) + cos
        if normal >= 0 and abs(shear) <= mu * normal and slip * shear <= 0:
            return twist[2]
    raise AssertionError("no mode fits")


def test_turn_limit_by_sampling() -> None:
    rng = random.Random(11)
    turns = [slipping_or_sticking(rng) for _ in range(150)]
    limit = 1 / (2 * math.sqrt(376_900))
    assert max(abs(float(turn)) for turn in turns) <= limit
    assert max(abs(float(turn)) for turn in turns) > 0.8 * limit  # and it is near
    assert f"{math.degrees(600 * limit):.1f}° in 600 µm" in text("turn-limit")
    assert f"at least {math.pi / 4 / limit:.0f} µm" in text("turn-limit")


# forces


def test_inertia_in_numbers() -> None:
    mass = 8250 * 1616e-6 * 837e-6 * 40e-6
    assert f"{1e6 * mass:.3f} mg" in text("inertia")
    assert f"{1e9 * mass * 140e-6**2 / 2e-7:.0f} nN" in text("inertia")
    rho, v = 0.3769e-6, 140e-6
    highest = 0.0
    for R in (k * 1e-6 for k in range(50, 3000, 5)):
        highest = max(highest, R * (R / (rho + R * R)) ** 2 * v * v)
    assert f"{1e12 * mass * highest:.1f} pN" in text("inertia")


def test_dry_friction_in_numbers() -> None:
    weight = 8250 * 1616e-6 * 837e-6 * 40e-6 * 9.81
    for value in (0.757, 0.013):
        assert f"{value * weight * 1e6:.2g} µN" in text("dry-friction-force")


# sizes


def test_playpen_by_hand() -> None:
    assert Q("0.641") * Q("25.4") == Q("16.2814")
    assert Q("0.454") * Q("25.4") == Q("11.5316")
    assert "16.28 mm" in text("playpen")
    most = 0.0
    for k in range(9001):  # every 0.01 degree of a quarter turn
        c, s = math.cos(math.radians(k / 100)), math.sin(math.radians(k / 100))
        if 1616 * c + 837 * s <= 1635 and 1616 * s + 837 * c <= 1155:
            most = max(most, k / 100)
    assert most == pytest.approx(1.33, abs=0.02)
    assert "1.4°" in text("playpen-room")


def test_pixels_by_hand() -> None:
    assert round(640 * 5.26 / 1000, 2) == 3.37
    assert round(480 * 5.26 / 1000, 2) == 2.52
    low, high = max(3365 / 640, 2515 / 480), min(3375 / 640, 2525 / 480)
    assert f"{low:.4f} and {high:.4f}" in text("field-of-view")


def test_orientation_error_by_hand() -> None:
    assert round(math.degrees(0.005), 1) == 0.3
    assert f"{math.degrees(2 * 5.26 / 1616):.2f}°" in text("orientation-error")
    assert f"{math.radians(0.005) * 1616:.2f} µm" in text("orientation-error")


def test_speeds_per_frame() -> None:
    assert 140 / 27 < 5.26 < 140 / 26
    assert "4.7, 2.5, 0.25" in text("probe-speeds")


def test_goal_and_slot_by_hand() -> None:
    def fits(offset: float, degrees: float, slot: float) -> bool:
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        corners = [s * x + c * y for x in (-808, 808) for y in (-418.5, 418.5)]
        return all(abs(y + offset) <= slot / 2 for y in corners)

    assert fits(69.4, 0, 976)
    assert not fits(69.6, 0, 976)
    assert fits(0, 5, 976)
    assert not fits(0, 5, 974)
    assert fits(38, 2.2, 976)
    assert not fits(38, 2.3, 976)


def test_scripted_plan_by_hand() -> None:
    x = [3050, 3050, 1550, 1550, 1550, 3100, 3100, 550]
    y = [1240, 640, 640, 690, 640, 640, 1415, 1415]
    found = [finding.witness for finding in claims()["table-2"].of_print[:8]]
    assert [(int(p["x"]), int(p["y"])) for p in found] == list(zip(x, y, strict=True))


# tables


def test_averages_in_fractions() -> None:
    assert Q(1996 + 1975 + 1559, 3) == Q(5530, 3)
    assert Q(381 + 434 + 370, 3) == 395
    assert Q(954 + 944 + 965 + 959 + 954, 5) == Q(4776, 5)
    assert "X 395 (printed 382)" in text("table-4")
    wrong = [f.what for f in claims()["table-4"].consistent if not f.holds]
    assert len(wrong) == 1
    assert wrong[0].startswith("column X")


@pytest.mark.parametrize(
    ("row", "stands"),
    [("434", False), ("391", False), ("392", True), ("398", True), ("399", False)],
)
def test_another_row_would_mend_table_4(
    monkeypatch: pytest.MonkeyPatch, row: str, stands: bool
) -> None:
    columns = {**pn.TABLES["IV"], "X": (("381", row, "370"), "382")}
    monkeypatch.setitem(pn.TABLES, "IV", columns)
    claim = pn._table("IV")
    assert claim.consistent[0].holds is stands


def test_rounding_is_that_of_the_last_digit() -> None:
    x = sp.Symbol("x", real=True)
    for printed, low, high in (("382", "381.5", "382.5"), ("0.30", "0.295", "0.305")):
        relation = pn.rounded(x, printed)
        assert relation.subs(x, sp.Rational(low))
        assert relation.subs(x, sp.Rational(high))
        assert not relation.subs(x, sp.Rational(low) - sp.Rational(1, 10**6))
        assert not relation.subs(x, sp.Rational(high) + sp.Rational(1, 10**6))


# breaks


def _pushing_friction(n: Any, t: Any, slip: Any, opening: Any) -> Any:
    return mechanics.coulomb(n, t, -slip, opening)


def _heavy_turn(twist: sp.Matrix) -> sp.Matrix:
    return sp.diag(1, 1, 2) * mechanics.film(twist)


@pytest.mark.parametrize(
    ("name", "broken"), [("coulomb", _pushing_friction), ("film", _heavy_turn)]
)
def test_the_turn_limit_needs_its_ingredients(
    monkeypatch: pytest.MonkeyPatch, name: str, broken: Callable[..., Any]
) -> None:
    monkeypatch.setattr(pn, name, broken)
    with pytest.raises(DerivationError, match="turn-limit"):
        pn._turn_limit()


def test_a_turning_drag_in_square_millimetres_would_be_consistent(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(pn, "TURNING_DRAG", "0.00006064")
    with pytest.raises(DerivationError, match="nothing was found of the printed statement"):
        pn._film_units()


def test_wrong_bounds_of_pi_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pn, "PI", (sp.Rational(315, 100), sp.Rational(316, 100)))
    with pytest.raises(DerivationError, match="pi"):
        pn._turn_limit()


def test_a_heavier_part_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pn, "MASS", 100 * pn.MASS)
    with pytest.raises(DerivationError):
        pn._inertia()
