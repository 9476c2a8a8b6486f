"""Gain of the Y-translation against stepping a contact solver, and bounds against the whole box."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

from derivations import symmetries, y_translation
from derivations._claim import Claim, Verdict
from derivations._derivation import Derivation, Function
from derivations._statement import DerivationError
from derivations.mechanics import n, velocity_at, wrench
from tests.derivations.test_symmetries import motion

F = npt.NDArray[np.float64]
RHO, LEFT, UPRIGHT = 376_900.0, np.array([-1.0, 0.0]), math.pi / 2
VERDICTS = {
    "y-gain": Verdict.SHARPENED,
    "y-gain-ends": Verdict.NEW,
    "y-gain-error-bound": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
    "y-gain-upper-corner": Verdict.NEW,
    "step-1-conditions": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
    "step-3-short-edge": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
    "y-shift-of-straightening": Verdict.NEW,
    "y-gain-limit": Verdict.NEW,
}


@pytest.fixture(scope="module")
def derived() -> Derivation:
    return y_translation.derive()


@pytest.fixture(scope="module")
def claims(derived: Derivation) -> dict[str, Claim]:
    return {claim.key: claim for claim in derived.claims}


@pytest.fixture(scope="module")
def gain(derived: Derivation) -> Function:
    return derived.functions["gain"]


def test_verdicts(claims: dict[str, Claim]) -> None:
    assert {key: claim.verdict for key, claim in claims.items()} == VERDICTS


def rolled(angle: float, end: float, depth: float, offset: float, friction: float) -> float:
    """Rise of the centre while one tip turns the edge, stepped; fails if the contact slips."""
    rise, sense = 0.0, math.copysign(1.0, end - angle)
    while (end - angle) * sense > 1e-12:
        twist, mode = motion(angle, depth, offset, RHO, friction, LEFT)
        assert mode == "stick"
        assert twist[2] * sense > 0
        travel = min(1.0, (end - angle) / twist[2])
        middle, _ = motion(angle + travel * twist[2] / 2, depth, offset, RHO, friction, LEFT)
        travel = min(1.0, (end - angle) / middle[2])
        rise, angle = rise + travel * middle[1], angle + travel * middle[2]
    return rise


def value(gain: Function, *arguments: float) -> float:
    (result,) = gain.results
    return float(result.subs(dict(zip(gain.arguments, arguments, strict=True))))


def test_signature_is_kept(gain: Function) -> None:
    names = [str(symbol) for symbol in gain.arguments]
    assert names == ["theta_0", "theta_1", "theta_2", "d1", "d2", "d2_back"]
    assert gain.unit == "m"


@pytest.mark.parametrize(("start", "end"), [(0.0, 0.0), (0.01, -0.02), (0.02, 0.02)])
def test_gain_by_stepping_the_pushes(gain: Function, start: float, end: float) -> None:
    """Tilt about 250 µm to 10.9 degrees, back about -150 µm, with the modes of contact decided."""
    depth, top, bottom, turned = 418.5, 250.0, -150.0, math.radians(10.9)
    t0, t1, t2 = (UPRIGHT + tilt for tilt in (start, turned, end))
    stepped = rolled(t0, t1, depth, top, 0.33) + rolled(t1, t2, depth, bottom, 0.33)
    assert value(gain, t0, t1, t2, depth, top, bottom) == pytest.approx(stepped, abs=1e-4)
    law = (top - bottom) * (1 - math.cos(turned))
    assert (abs(stepped - law) < 1e-3) == (start == end == 0.0)


def test_gain_in_exact_fractions(gain: Function) -> None:
    """Upright, 5-12-13, upright: (d2 - back) (1 - 12/13)."""
    (result,) = gain.results
    t0, t1, t2, depth, top, bottom = gain.arguments
    at = {sp.cos(t0): 0, sp.sin(t0): 1, sp.cos(t2): 0, sp.sin(t2): 1}
    at |= {sp.cos(t1): sp.Rational(-5, 13), sp.sin(t1): sp.Rational(12, 13)}
    at |= {depth: 7, top: 39, bottom: -13}
    assert result.subs(at) == 4


def bounds(length: Fraction, tilt: tuple[Fraction, Fraction]) -> tuple[Fraction, Fraction]:
    """The printed d_1^e and d_2^e with the paper's errors, in exact arithmetic."""
    (c, s), (u, v) = tilt, circle(Fraction(1, 191))
    nominal = length * (1 - c)
    lower = (length - 20) * (1 - (c * u + s * v))
    upper = (length + 20) * (1 - (c * u - s * v))
    return nominal - lower, upper - nominal


def circle(half: Fraction) -> tuple[Fraction, Fraction]:
    return (1 - half**2) / (1 + half**2), 2 * half / (1 + half**2)


@pytest.mark.parametrize("number", [0, 1])
def test_witnesses_against_the_bound(claims: dict[str, Claim], number: int) -> None:
    shown = claims["y-gain-error-bound"].of_print[number].witness
    at = {name: Fraction(text) for name, text in shown.items()}
    length, tilt = at["d2"] - at["d2_back"], (at["cos(phi)"], at["sin(phi)"])
    # centre over the contact height: up about one offset, down about the other
    start, turned, end = ((at[f"cos({k})"], at[f"sin({k})"]) for k in ("alpha", "phi", "beta"))

    def height(offset: Fraction, lean: tuple[Fraction, Fraction]) -> Fraction:
        return offset * lean[0] + at["d1"] * lean[1]  # edge leaning back by lean from upright

    rise = height(at["d2"], start) - height(at["d2"], turned)
    rise += height(at["d2_back"], turned) - height(at["d2_back"], end)
    error = rise - length * (1 - tilt[0])
    assert abs(error) > max(bounds(length, tilt))
    leaning = max(abs(at["sin(alpha)"]), abs(at["sin(beta)"]))
    assert math.asin(leaning) <= math.radians(0.3)


def test_bound_over_the_whole_box(claims: dict[str, Claim]) -> None:
    """Upright ends: 200 x 200 points of the box stay within the bound, which one corner attains."""
    tilt = circle(Fraction(2, 21))
    lower, upper = map(float, bounds(Fraction(500), tilt))
    assert upper > lower
    angle, error = 2 * math.atan(2 / 21), 2 * math.atan(1 / 191)
    lengths, angles = np.meshgrid(
        np.linspace(480, 520, 200), np.linspace(angle - error, angle + error, 200)
    )
    off = lengths * (1 - np.cos(angles)) - 500 * (1 - math.cos(angle))
    assert off.max() == pytest.approx(upper)
    assert off.min() == pytest.approx(-lower)
    text = claims["y-gain-upper-corner"].derived
    assert f"d_1^e = {lower:.2f}$" in text
    assert f"d_2^e = {upper:.2f}$" in text


def test_step_1_witness_by_trying_all_numbers_of_motions(claims: dict[str, Claim]) -> None:
    shown = claims["step-1-conditions"].of_print[0].witness
    at = {name: Fraction(text) for name, text in shown.items()}
    tilt = at["cos(phi)"], at["sin(phi)"]
    gain, (_, error) = at["l_AB"] * (1 - tilt[0]), bounds(at["l_AB"], tilt)
    half = at["eps_p"] / 2
    assert at["s_p"] + error <= half  # the printed condition
    for number in range(-50, 51):
        rest = abs(at["Y_s"] - number * gain) + at["s_p"] + (error if number else 0)
        assert rest > half
    worst = at["s_p"] + (gain + error) / 2
    assert worst > half  # the derived one
    text = claims["step-1-conditions"].derived
    assert f"{float(worst):.1f} µm off without and {float(worst):.1f} µm off after" in text


def test_step_3_witness(claims: dict[str, Claim]) -> None:
    """A tilt of 0.71 degrees left by the rotation moves the part by 10 µm on the short edge."""
    shown = claims["step-3-short-edge"].of_print[0].witness
    at = {name: Fraction(text) for name, text in shown.items()}
    assert at["d1"] == 808
    assert float(at["d1"] * at["sin(alpha)"]) == pytest.approx(-10.04, abs=0.01)
    text = claims["step-3-short-edge"].derived
    assert "$-10.0$ µm" in text


def test_straightening_by_stepping_the_push(claims: dict[str, Claim]) -> None:
    text = claims["y-shift-of-straightening"].derived
    for tilt in (0.71, 3.92):
        stepped = rolled(UPRIGHT - math.radians(tilt), UPRIGHT, 808.0, 150.0, 0.33)
        assert f"{tilt:.2f}°: ${stepped:.1f}$ µm" in text


def test_limit_of_the_gain_by_search(claims: dict[str, Claim]) -> None:
    """Every tilt and pair of offsets for which the solver sticks throughout gains less."""
    friction, best, limit = 0.3, 0.0, 2 * 395.73 * (1 - 1 / math.sqrt(1.09))
    for tilt in np.radians(np.arange(1.0, 20.0, 0.5)):
        ups = [d for d in np.arange(5.0, 808.0, 5.0) if turns(UPRIGHT, d, friction, 1)]
        downs = [-d for d in np.arange(5.0, 808.0, 5.0) if turns(UPRIGHT + tilt, -d, friction, -1)]
        if not downs:
            assert math.tan(tilt) > friction - 0.02
            continue
        best = max(best, (max(ups) - min(downs)) * (1 - math.cos(tilt)))
    assert 15 < best < limit
    assert f"{limit:.0f} µm on the long edge" in claims["y-gain-limit"].derived


def turns(angle: float, offset: float, friction: float, sense: int) -> bool:
    twist, mode = motion(angle, 418.5, offset, RHO, friction, LEFT)
    return mode == "stick" and twist[2] * sense > 0


Again = Callable[[], object]


def between_tilted_ends() -> sp.Expr:
    """The gain as the claims on errors take it."""
    t0, t1, t2 = y_translation.t0, y_translation.t1, y_translation.t2
    tilts = (y_translation.alpha, y_translation.phi, y_translation.end_tilt)
    ends = {t: sp.pi / 2 + tilt for t, tilt in zip((t0, t1, t2), tilts, strict=True)}
    return y_translation.gain().subs(ends)


def bound_again() -> Claim:
    return y_translation._error_bound(between_tilted_ends())


def step_3_again() -> Claim:
    return y_translation._step_3(between_tilted_ends())


@pytest.mark.parametrize(
    ("where", "name", "wrong", "again"),
    [
        (y_translation, "n", -n, y_translation.derive),
        (y_translation, "velocity_at", lambda v, r: velocity_at(v, -r), y_translation.derive),
        (symmetries, "wrench", lambda f, r: wrench(f, -r), y_translation._limit),
        (y_translation, "MISALIGNED", sp.Rational(1, 2000), bound_again),
        (y_translation, "SENSED", sp.Rational(1, 2000), bound_again),
        (y_translation, "LEFT", sp.Rational(1, 2000), step_3_again),
    ],
)
def test_a_wrong_ingredient_is_noticed(
    monkeypatch: pytest.MonkeyPatch, where: object, name: str, wrong: object, again: Again
) -> None:
    monkeypatch.setattr(where, name, wrong)
    with pytest.raises(DerivationError):
        again()


def test_a_first_contact_below_turns_the_sign(monkeypatch: pytest.MonkeyPatch) -> None:
    """l_AB counts from the lower to the upper contact: the other way round nothing fits."""
    monkeypatch.setattr(y_translation, "APART", -y_translation.APART)
    with pytest.raises(DerivationError):
        bound_again()
