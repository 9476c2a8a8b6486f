"""Corners and samples against brute force over the whole box."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import product

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

from derivations import sampling, symmetries
from derivations._claim import Claim, Verdict
from derivations._statement import DerivationError
from derivations.mechanics import mu, wrench
from tests.derivations.test_symmetries import motion

F = npt.NDArray[np.float64]
RHO, LONG, SHORT = 376_900, Fraction(837, 2), Fraction(808)
ENDS = np.array([-1.0, 1.0])
VERDICTS = {
    "corners-one-point": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
    "corners-that-count": Verdict.NEW,
    "admissible-offsets": Verdict.NEW,
    "no-robust-motion": Verdict.REFUTED,
}


@pytest.fixture(scope="module")
def claims() -> dict[str, Claim]:
    return {claim.key: claim for claim in sampling.derive().claims}


def test_verdicts(claims: dict[str, Claim]) -> None:
    assert {key: claim.verdict for key, claim in claims.items()} == VERDICTS


def margins(c: Fraction, s: Fraction, d: Fraction, friction: Fraction) -> list[Fraction]:
    """mu N - |D| (both signs) and the lever on the long edge, written out by hand."""
    n = LONG * d * c + (RHO + LONG**2) * s
    t = (RHO + d**2) * c + LONG * d * s
    return [friction * n - t, friction * n + t, d * s - LONG * c]


def circle(half: Fraction) -> tuple[Fraction, Fraction]:
    return (1 - half**2) / (1 + half**2), 2 * half / (1 + half**2)


def test_corners_miss_a_slip_by_hand(claims: dict[str, Claim]) -> None:
    shown = claims["corners-one-point"].of_print[0].witness
    at = {name: Fraction(value) for name, value in shown.items()}
    turns = [(at[f"cos(theta_{k})"], at[f"sin(theta_{k})"]) for k in (1, 2)]
    assert all(c**2 + s**2 == 1 for c, s in turns)
    for (c, s), d, friction in product(
        turns, (at["d2_lo"], at["d2_hi"]), (at["mu_lo"], at["mu_hi"])
    ):
        assert min(margins(c, s, d, friction)) > 0
    assert at["d2_lo"] < at["d2"] < at["d2_hi"]
    assert margins(*turns[0], at["d2"], at["mu_lo"])[0] < 0


def test_the_solver_slips_where_corners_do_not(claims: dict[str, Claim]) -> None:
    """The same point put to a solver that knows nothing of margins."""
    shown = claims["corners-one-point"].of_print[0].witness
    at = {name: float(Fraction(value)) for name, value in shown.items()}
    angle = np.arctan2(at["sin(theta_1)"], at["cos(theta_1)"])
    modes = [
        motion(angle, at["d1"], at[d], at["rho"], at["mu_lo"], np.array([-1.0, 0.0]))[1]
        for d in ("d2_lo", "d2", "d2_hi")
    ]
    assert modes[0] == modes[2] == "stick"
    assert modes[1] != "stick"


@pytest.mark.parametrize(("depth", "half"), [(418.5, 808.0), (808.0, 418.5)])
def test_corners_suffice_on_the_paper_part(depth: float, half: float) -> None:
    """Random boxes within the edge: wherever all corners are admissible, so is a fine grid."""
    rng = np.random.default_rng(3)
    decided = 0
    for _ in range(4000):
        offsets = np.clip(rng.uniform(-half, half) + rng.uniform(0, 200) * ENDS, -half, half)
        angles = rng.uniform(1.0, np.pi - 1.0) + rng.uniform(0, 0.3) * ENDS
        frictions = np.array([0.30, 0.36])
        if least(depth, offsets, angles, frictions) <= 0:
            continue
        decided += 1
        grids = [np.linspace(ends[0], ends[1], 21) for ends in (offsets, angles, frictions)]
        inside = least(depth, *grids)
        assert inside > 0
    assert decided > 100


def least(depth: float, offsets: F, angles: F, frictions: F) -> float:
    """Smallest margin over a grid."""
    d, t, m = np.meshgrid(offsets, angles, frictions, indexing="ij")
    c, s = np.cos(t), np.sin(t)
    normal = depth * d * c + (RHO + depth**2) * s
    shear = (RHO + d**2) * c + depth * d * s
    return float(np.minimum(m * normal - np.abs(shear), d * s - depth * c).min())


@pytest.mark.parametrize(("friction", "sound"), [(0.05, False), (0.12, False), (0.30, True)])
def test_largest_reach_by_search(friction: float, sound: bool) -> None:
    """d2* is the least offset at which mu N - D has an interior minimum of 0, found on a grid."""
    angles = np.linspace(np.pi / 2 + 1e-3, 2.6, 20_001)
    u = -1 / np.tan(angles)
    vertex = 418.5 * (1 / u + friction) / 2
    c, s = np.cos(angles), np.sin(angles)
    value = friction * (418.5 * vertex * c + (RHO + 418.5**2) * s) - (
        (RHO + vertex**2) * c + 418.5 * vertex * s
    )
    found = float(vertex[value <= 0].min())
    limit = sampling._least_reach().subs({**sampling.PART, mu: friction})
    assert float(limit) == pytest.approx(found, rel=1e-3)
    assert (found > 808) == sound


def test_admissible_range_by_the_solver() -> None:
    """Ends of the interval of offsets at a tilt, found by pushing everywhere."""
    half = sp.Rational(2, 21)
    tilt = 2 * np.arctan(2 / 21)
    at = {**sampling.PART, mu: sp.Rational(3, 10)}
    first, last = sampling.admissible_range({**at, **sampling._tilted(half, sp.Integer(0))})
    good = []
    for offset in np.arange(-800.0, 800.0, 0.5):
        twist, mode = motion(np.pi / 2 - tilt, 418.5, offset, RHO, 0.3, np.array([-1.0, 0.0]))
        if mode == "stick" and twist[2] > 0:
            good.append(offset)
    assert good == list(np.arange(good[0], good[-1] + 0.25, 0.5))  # an interval
    assert good[0] == pytest.approx(first, abs=0.5)
    assert good[-1] == pytest.approx(last, abs=0.5)


def box(offset: Fraction, steps: int) -> Iterator[list[Fraction]]:
    """Margins over the neighbourhood of a push, on a grid of exact points."""
    for j, k in product(range(steps + 1), repeat=2):
        d = offset - 10 + Fraction(20 * j, steps)
        # tilt 2 atan(681/5000) turned by between -2 atan(1/382) and +2 atan(1/382)
        error = Fraction(2 * k - steps, steps * 382)
        (x, y), (u, v) = circle(Fraction(681, 5000)), circle(error)
        yield from (
            margins(y * u + x * v, x * u - y * v, d, friction)
            for friction in (Fraction(3, 10), Fraction(36, 100))
        )


def test_samples_miss_a_robust_push_by_hand(claims: dict[str, Claim]) -> None:
    """Every sample of every round against exact arithmetic."""
    spacing = Fraction(808)
    while spacing > 5:
        spacing /= 2
    assert spacing == Fraction(101, 32)
    samples = [k * spacing for k in range(-256, 257)]
    assert not any(all(min(m) > 0 for m in box(sample, 1)) for sample in samples)
    assert all(min(m) > 0 for m in box(Fraction(129), 12))
    text = claims["no-robust-motion"].derived
    near = [sample for sample in samples if abs(sample - 129) < spacing]
    assert all(f"{float(sample):.2f}" in text for sample in near)


def test_a_smaller_error_moves_the_witness(monkeypatch: pytest.MonkeyPatch) -> None:
    """With ±8 µm one of the two samples is robust: the refutation must not go through."""
    monkeypatch.setattr(sampling, "EITHER_WAY", sp.Integer(8))
    with pytest.raises(DerivationError, match="no counterexample"):
        sampling._none_found(sampling.margins())


def test_a_flipped_moment_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(symmetries, "wrench", lambda force, arm: wrench(force, -arm))
    with pytest.raises(DerivationError):
        sampling._ends_that_count(sampling.margins())


def test_a_wrong_margin_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    right = sampling.margins
    monkeypatch.setattr(sampling, "margins", lambda: right()._replace(from_lo=right().to_hi))
    with pytest.raises(DerivationError):
        sampling.derive()
