"""Final pose and admissible tilt against geometry and a contact solver written anew."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

from derivations import final_pose, symmetries
from derivations._claim import Claim, Verdict
from derivations._statement import DerivationError
from derivations.mechanics import a, d1, d2, mu, n, rho, wrench
from tests.derivations.test_symmetries import motion

F = npt.NDArray[np.float64]
RHO, LEFT = 376_900.0, np.array([-1.0, 0.0])
VERDICTS = {
    "step-4-centre": Verdict.REFUTED,
    "step-4-gamma": Verdict.INCONSISTENT,
    "step-4-orientation": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
    "step-4-tolerance": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
    "step-4-errors": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
    "t2-largest-tilt": Verdict.NEW,
    "tilt-after-push": Verdict.NEW,
    "step-2-tilt": Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS,
}


@pytest.fixture(scope="module")
def claims() -> dict[str, Claim]:
    return {claim.key: claim for claim in final_pose.derive().claims}


def test_verdicts(claims: dict[str, Claim]) -> None:
    assert {key: claim.verdict for key, claim in claims.items()} == VERDICTS


def placed(part_angle: float, depth: float, offset: float, tip: F) -> F:
    """Centre of a part at this orientation whose short edge at the tail touches the tip.

    Seen from the part: the edge is at x = -depth; its upper end (part turned to about pi) is at
    negative y.
    """
    c, s = math.cos(part_angle), math.sin(part_angle)
    seen = np.array([-depth, -offset])
    return tip - np.array([[c, -s], [s, c]]) @ seen


@pytest.mark.parametrize("misaligned", [0.03, -0.05, 0.0])
def test_centre_by_placing_a_rectangle(misaligned: float) -> None:
    """Both tips on the tail edge of a part at pi + beta; the upper one ahead for beta > 0."""
    depth, offset, apart, tip = 808.0, 170.0, 300.0, np.array([900.0, 40.0])
    centre = placed(math.pi + misaligned, depth, offset, tip)
    lower = tip - apart * np.array([-math.tan(misaligned), 1.0])  # behind for beta > 0
    c, s = math.cos(math.pi + misaligned), math.sin(math.pi + misaligned)
    for point in (tip, lower):
        assert (point - centre) @ [c, s] == pytest.approx(-depth)
    at = {d1: depth, d2: offset, final_pose.p_x: tip[0], final_pose.p_y: tip[1]}
    at |= dict(zip(symmetries.BETA, (math.cos(misaligned), math.sin(misaligned)), strict=True))
    assert [float(entry.subs(at)) for entry in final_pose.centre()] == pytest.approx(centre)
    r, gamma = math.hypot(depth, offset), math.atan2(offset, depth)
    assert centre == pytest.approx(
        [tip[0] - r * math.cos(gamma + misaligned), tip[1] - r * math.sin(gamma + misaligned)]
    )


def test_the_right_reading_is_shown(claims: dict[str, Claim]) -> None:
    text = claims["step-4-centre"].derived
    assert r"$X = p^x − r\cos(\gamma + \beta)$, $Y = p^y − r\sin(\gamma + \beta)$" in text
    assert r"\tan^{-1}(d_2/d_1)" in text
    assert "the only one of 16 readings" in text


def test_tolerance_by_hand(claims: dict[str, Claim]) -> None:
    """Three degrees either way pass the print and need 95 µm of 76."""
    shown = claims["step-4-tolerance"].of_print[0].witness
    at = {name: Fraction(value) for name, value in shown.items()}
    c, s = at["cos(beta_max)"], at["sin(beta_max)"]
    assert c**2 + s**2 == 1
    assert at["r_max"] ** 2 >= at["d1"] ** 2 + at["d3"] ** 2
    r, gamma = math.hypot(at["d1"], at["d3"]), math.atan2(at["d1"], at["d3"])
    largest = math.atan2(s, c)
    slack = 2 * at["c_p"]
    assert r * (math.cos(gamma - largest) - math.cos(gamma)) + slack < at["eps_p"]
    assert r * math.sin(largest) + slack < at["eps_p"]
    assert largest < math.radians(5)
    heights = [placed(math.pi + k * largest, 808.0, 170.0, np.zeros(2))[1] for k in (-1, 1)]
    assert heights[0] - heights[1] + slack == pytest.approx(2 * 808 * float(s) + 10)
    assert heights[0] - heights[1] + slack > at["eps_p"]
    text = claims["step-4-tolerance"].derived
    assert f"{math.degrees(math.asin(66 / 1616)):.2f}°" in text
    assert f"{math.degrees(math.asin(66 / math.hypot(808, 418.5))):.2f}°" in text


@pytest.mark.parametrize("signs", [(0, 1), (-1, 1)])
def test_size_of_the_box_by_sampling(signs: tuple[int, int]) -> None:
    """Widths over a fine grid of beta: exact formulas, and the bound for one sign."""
    for offset in (20.0, 170.0, 418.0):
        largest = 0.06
        angles = np.linspace(signs[0] * largest, signs[1] * largest, 4001)
        centres = np.array([placed(math.pi + k, 808.0, offset, np.zeros(2)) for k in angles])
        wide, high = np.ptp(centres, axis=0)
        r = math.hypot(808.0, offset)
        if signs == (0, 1):
            assert max(wide, high) <= r * math.sin(largest)
            continue
        assert high == pytest.approx(2 * 808 * math.sin(largest))
        if offset >= 808 * math.tan(largest):
            assert wide == pytest.approx(2 * offset * math.sin(largest))
        else:
            beyond = r + offset * math.sin(largest) - 808 * math.cos(largest)
            assert wide == pytest.approx(beyond, rel=1e-6)


def test_error_in_y_by_rolling_the_part(claims: dict[str, Claim]) -> None:
    """Small steps of the sticking motion from the tilt to upright, from the witness."""
    shown = claims["step-4-errors"].of_print[0].witness
    at = {name: float(Fraction(value)) for name, value in shown.items()}
    tilt = math.atan2(at["sin(psi)"], at["cos(psi)"])
    height, angle = at["Y_s"] + at["e_y"], math.pi / 2 - tilt
    while angle < math.pi / 2:
        twist, mode = motion(angle, 808.0, at["d2"], RHO, 0.33, LEFT)
        assert mode == "stick"
        travel = min(0.5, (math.pi / 2 - angle) / twist[2])
        height, angle = height + travel * twist[1], angle + travel * twist[2]
    expected = at["Y_s"]  # sensed upright: the push should leave Y as it is
    assert height - expected == pytest.approx(-9.23, abs=0.01)
    assert abs(height - expected) > at["c_p"]


@pytest.mark.parametrize("offset", [100, 200, 240, 300, 360])
def test_largest_tilt_by_the_solver(claims: dict[str, Claim], offset: int) -> None:
    tilts = np.arange(0.005, 20, 0.01)
    good = []
    for tilt in tilts:
        twist, mode = motion(math.radians(90 - tilt), 808.0, float(offset), RHO, 0.3, LEFT)
        good.append(mode == "stick" and twist[2] > 0)
    last = good.index(False)
    assert not any(good[last:])
    lo, _ = symmetries.limits()
    found = final_pose._tilt_limit(lo, offset)
    assert found == pytest.approx(tilts[last], abs=0.011)
    assert f"{offset} µm: {found:.2f}°" in claims["t2-largest-tilt"].derived


def test_no_offset_turns_back_more_than_the_angle_of_friction() -> None:
    for tilt in np.radians([16.0, 16.6, 16.8, 20.0]):
        turned = [
            motion(np.pi / 2 - tilt, 808.0, offset, RHO, 0.3, LEFT)
            for offset in np.arange(0.0, 418.0, 0.25)
        ]
        possible = any(mode == "stick" and twist[2] > 0 for twist, mode in turned)
        assert possible == (math.tan(tilt) < 0.3)


def tilt_after(travel: float, apart: float) -> float:
    """Degrees off the horizontal: both tips on the long edges, found by marching and bisection."""
    angle = np.pi / 2
    for ahead in np.linspace(837.0, 837.0 - travel, 200)[1:]:

        def gap(at: float, ahead: float = ahead) -> float:
            return ahead * math.sin(at) - apart * math.cos(at) - 837.0

        low, high = angle, min(angle + 0.2, np.pi)
        assert gap(low) * gap(high) <= 0
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (low, middle) if gap(low) * gap(middle) <= 0 else (middle, high)
        angle = low
    return 180 - math.degrees(angle)


@pytest.mark.parametrize("travel", [1100, 1300, 1900])
def test_tilt_after_a_push(claims: dict[str, Claim], travel: int) -> None:
    found = tilt_after(float(travel), 857.0)
    assert final_pose._tilt_after(travel) == pytest.approx(found, abs=1e-6)
    assert f"{found:.2f}° after {travel} µm" in claims["tilt-after-push"].derived


def test_least_tilt(claims: dict[str, Claim]) -> None:
    """Tips at opposite corners of the part: 0.71 degrees, after some 2.44 mm."""
    travel = final_pose._travel_to_corners()
    tilt = math.radians(tilt_after(travel, 857.0))
    between = np.array([1616.0, 837.0])  # from corner to corner, in the part
    height = between[0] * math.sin(tilt) + between[1] * math.cos(tilt)
    assert height == pytest.approx(857.0)
    assert f"{math.degrees(tilt):.2f}°" == "0.71°"
    assert f"0.71°$ after {travel:.0f} µm" in claims["tilt-after-push"].derived


def test_step_2_witness_by_the_solver(claims: dict[str, Claim]) -> None:
    """Rotation of the witness by bisection, then the t2 push by all modes of contact."""
    shown = claims["step-2-tilt"].of_print[0].witness
    at = {name: float(Fraction(value)) for name, value in shown.items()}
    travel = at["w"] - at["h"]
    assert travel == pytest.approx(1100, abs=0.1)
    left = tilt_after(travel, at["V"])
    assert left == pytest.approx(math.degrees(math.atan2(at["sin(psi)"], at["cos(psi)"])), abs=1e-5)
    _, mode = motion(math.radians(90 - left), 808.0, at["d2"], RHO, at["mu"], LEFT)
    assert mode != "stick"
    least = math.degrees(math.atan2(at["sin(theta_t)"], at["cos(theta_t)"]))
    twist, mode = motion(math.radians(90 - least), 808.0, at["d2"], RHO, at["mu"], LEFT)
    assert mode == "stick"
    assert twist[2] > 0


@pytest.mark.parametrize(
    ("where", "name", "wrong", "claim", "message"),
    [
        (symmetries, "wrench", lambda f, arm: wrench(f, -arm), "_largest_tilt", "example"),
        (symmetries, "n", -n, "_box", "no counterexample"),
        (symmetries, "n", a, "_box", "readings"),
        (final_pose, "LEAST_MU", sp.Rational(34, 100), "_step_2", "no counterexample"),
    ],
)
def test_a_wrong_ingredient_is_noticed(
    monkeypatch: pytest.MonkeyPatch,
    where: object,
    name: str,
    wrong: object,
    claim: str,
    message: str,
) -> None:
    monkeypatch.setattr(where, name, wrong)
    arguments = {"_box": 0, "_step_2": 1, "_largest_tilt": 2}[claim]
    needed = symmetries.limits()[:arguments]
    with pytest.raises(DerivationError, match=message):
        getattr(final_pose, claim)(*needed)


def test_the_side_of_the_tip_decides_the_sign(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the part on the far side of the tip the printed sign of X would be right."""
    right = final_pose.centre
    monkeypatch.setattr(
        final_pose,
        "centre",
        lambda offset=d2: 2 * final_pose.TIP - right(offset),
    )
    with pytest.raises(DerivationError, match="no counterexample"):
        final_pose._box()


def test_limit_formula_in_exact_fractions() -> None:
    """(mu B - A)/(C - mu A) at d2 = 360 µm, mu = 0.30 by hand."""
    b, c, product = 376_900 + 808**2, 376_900 + 360**2, 808 * 360
    tangent = (Fraction(3, 10) * b - product) / (c - Fraction(3, 10) * product)
    lo, _ = symmetries.limits()
    at = {d1: 808, d2: 360, rho: 376_900, mu: sp.Rational(3, 10)}
    assert (lo[0] / lo[1]).subs(at) == sp.Rational(tangent.numerator, tangent.denominator)
    assert final_pose._tilt_limit(lo, 360) == pytest.approx(math.degrees(math.atan(tangent)))
