"""The objective of the fit, recomputed from trajectories in plain numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import pytest
import sympy as sp

from derivations import fit_objective
from derivations._claim import Claim, Verdict
from derivations._statement import DerivationError

Pose = tuple[float, float, float]
VERDICTS = {
    "fit-units": Verdict.CONFIRMED,
    "fit-characteristic-length": Verdict.NEW,
    "fit-zero": Verdict.CONFIRMED,
    "fit-worst-axis": Verdict.NEW,
    "fit-not-convex-not-smooth": Verdict.CONFIRMED,
}


@cache
def claims() -> dict[str, Claim]:
    return {claim.key: claim for claim in fit_objective.derive().claims}


def f(measured: Sequence[Pose], simulated: Sequence[Pose], length: float) -> float:
    """Eq. (3) with theta multiplied by ``length``."""
    axes = zip(*measured, strict=True), zip(*simulated, strict=True)
    scale = (1.0, 1.0, length)
    return max(
        k * math.sqrt(sum((x - s) ** 2 for x, s in zip(xs, ss, strict=True)) / len(xs))
        for k, xs, ss in zip(scale, *axes, strict=True)
    )


def trial(x: float, y: float, theta: float) -> list[Pose]:
    """A trajectory that is off by constant errors."""
    return [(x + t, y, theta + t / 1000) for t in range(5)]


ZERO = trial(0, 0, 0)


def test_verdicts() -> None:
    assert {key: claim.verdict for key, claim in claims().items()} == VERDICTS


def _witness(key: str, number: int = 0) -> dict[str, float]:
    found = claims()[key].checks[number].witness
    return {name: float(sp.Rational(value)) for name, value in found.items()}


def _pair(at: dict[str, float], unit: float = 1.0) -> tuple[list[Pose], list[Pose]]:
    first, second = (
        trial(unit * at[f"r_x{j}"], unit * at[f"r_y{j}"], at[f"r_theta{j}"]) for j in "12"
    )
    return first, second


def test_without_a_length_the_ranking_depends_on_the_unit() -> None:
    at = _witness("fit-units")
    metres, micrometres = _pair(at), _pair(at, unit=at["k"])
    assert f(ZERO, metres[0], 1) < f(ZERO, metres[1], 1)
    assert f(ZERO, micrometres[0], 1) > f(ZERO, micrometres[1], 1)


def test_with_a_length_it_does_not() -> None:
    at = _witness("fit-units")
    for length in (837e-6, 1e-3, 1616e-6):
        metres, micrometres = _pair(at), _pair(at, unit=1e6)
        in_metres = f(ZERO, metres[0], length) < f(ZERO, metres[1], length)
        in_micrometres = f(ZERO, micrometres[0], 1e6 * length) < f(
            ZERO, micrometres[1], 1e6 * length
        )
        assert in_metres == in_micrometres


def test_the_characteristic_length_changes_the_ranking() -> None:
    first, second = _pair(_witness("fit-characteristic-length"))
    assert f(ZERO, first, 837) > f(ZERO, second, 837)
    assert f(ZERO, first, 1000) < f(ZERO, second, 1000)
    assert f(ZERO, first, 1616) < f(ZERO, second, 1616)
    switch = 30 / 0.035
    assert f(ZERO, first, switch) == pytest.approx(f(ZERO, second, switch))
    assert f"{switch:.0f} µm" in claims()["fit-characteristic-length"].derived


def test_zero_means_equal_samples() -> None:
    assert f(ZERO, ZERO, 1000) == 0
    for error in ((1e-6, 0, 0), (0, 1e-6, 0), (0, 0, 1e-9)):
        assert f(ZERO, trial(*error), 1000) > 0


def test_the_worst_axis_against_least_squares() -> None:
    at = _witness("fit-worst-axis")
    first, second = _pair(at)
    assert f(ZERO, first, 1000) == pytest.approx(30)
    assert f(ZERO, second, 1000) == pytest.approx(29)
    squares = [
        at[f"r_x{j}"] ** 2 + at[f"r_y{j}"] ** 2 + (1000 * at[f"r_theta{j}"]) ** 2 for j in "12"
    ]
    assert squares[0] < squares[1]
    assert f"{5 / math.radians(0.3):.0f} µm" in claims()["fit-worst-axis"].derived


def turn(
    mu: float, theta: float, d1: float = 418.5, d2: float = 350.0, rho: float = 376_900.0
) -> float:
    """Turn per travel of one contact, slipping towards smaller d2 or sticking."""
    c, s = math.cos(theta), math.sin(theta)
    ratio = ((rho + d2**2) * c + d1 * d2 * s) / (d1 * d2 * c + (rho + d1**2) * s)
    tau = -min(mu, ratio)
    return s * (d2 + d1 * tau) / (rho + d2**2 + d1 * d2 * tau)


def test_kink_where_slip_turns_into_stick() -> None:
    theta = 1.35
    c, s = math.cos(theta), math.sin(theta)
    d1, d2, rho = 418.5, 350.0, 376_900.0
    mu = ((rho + d2**2) * c + d1 * d2 * s) / (d1 * d2 * c + (rho + d1**2) * s)
    assert 0.3 < mu < 0.6
    h = 1e-6
    left, right = (
        (turn(mu, theta) - turn(mu - h, theta)) / h,
        (turn(mu + h, theta) - turn(mu, theta)) / h,
    )
    assert right == 0
    assert left == pytest.approx(-d1 * rho * s / (rho + d2**2 - mu * d1 * d2) ** 2, rel=1e-4)
    assert turn(1.0, theta) == pytest.approx((d2 * s - d1 * c) / (rho + d1**2 + d2**2))


def test_misfit_above_its_chord() -> None:
    at = claims()["fit-not-convex-not-smooth"].of_print[-2].witness
    r1, r2, R, lever, kappa = (
        float(sp.Rational(at[n])) for n in ("rho_1", "rho_2", "R", "ell", "kappa")
    )

    def misfit(rho: float) -> float:
        return abs(kappa - lever / (rho + R**2))

    assert misfit((r1 + r2) / 2) > (misfit(r1) + misfit(r2)) / 2


def _never_scaled(values: Sequence[sp.Expr], theta_is_length: bool) -> list[sp.Expr]:
    return ORIGINAL(values, False)


ORIGINAL: Callable[..., Any] = fit_objective.in_unit


def test_without_the_sentence_in_the_text_eq_3_is_refuted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fit_objective, "in_unit", _never_scaled)
    assert fit_objective._units().verdict is Verdict.REFUTED


def test_a_length_in_radians_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(fit_objective.UNIT_OF, "l", "1")
    assert fit_objective._units().verdict is Verdict.REFUTED


def test_a_flipped_ranking_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    original = fit_objective.better
    monkeypatch.setattr(fit_objective, "better", lambda p, q: original(q, p))
    for claim in (fit_objective._characteristic_length, fit_objective._worst_axis):
        with pytest.raises(DerivationError):
            claim()
