"""Intervals against generalised least squares with starts and parameters in one matrix."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.tangent import Interval, intervals, tangent
from meso_robust.identification.models import viscous
from tests.identification.sets import PART

Floats = npt.NDArray[np.float64]
MODEL = viscous(PART.outline)
RHO, MU = 0.3e-6, 0.4
R, T = 3, 8
BETWEEN = 1.6448536269514722  # standard deviations that hold nine tenths on both sides


def found(jacobian: Floats, phi: float) -> dict[str, Interval]:
    seen = np.ones((R, T, 3), dtype=bool)
    at = tangent(jacobian, 2, seen, phi)
    return {one.key: one for one in intervals(MODEL, np.array([RHO, MU]), jacobian, at)}


def deviations(jacobian: Floats, phi: float) -> Floats:
    """(2,) of the coordinates of the parameters, with a start of their own for all recordings."""
    frames = np.arange(T)
    covariance = np.kron(phi ** np.abs(frames[:, None] - frames), np.eye(3))
    weight = np.linalg.inv(covariance)
    whole = np.zeros((2 + 3 * R, 2 + 3 * R))
    for r in range(R):
        design = np.zeros((3 * T, 2 + 3 * R))
        design[:, :2] = jacobian[r, :, :2]
        design[:, 2 + 3 * r : 5 + 3 * r] = jacobian[r, :, 2:]
        whole += design.T @ weight @ design
    return np.asarray(np.sqrt(np.diag(np.linalg.inv(whole)))[:2])


@pytest.mark.parametrize("phi", [0.0, 0.7])
def test_intervals_are_those_of_generalised_least_squares(phi: float) -> None:
    jacobian = 20.0 * np.random.default_rng(0).standard_normal((R, 3 * T, 5))
    one, reach = found(jacobian, phi), BETWEEN * deviations(jacobian, phi)
    rho, mu = one["rho_um2"], one["mu"]
    assert rho.parameter.unit == "µm²"
    assert rho.value == RHO
    assert rho.shown["value"] == 1e12 * RHO
    # ρ counts by ratio, μ by difference
    assert rho.low == pytest.approx(RHO * np.exp(-reach[0]))
    assert rho.high == pytest.approx(RHO * np.exp(reach[0]))
    assert (mu.low, mu.high) == pytest.approx((MU - reach[1], MU + reach[1]))
    assert not any((rho.open_low, rho.open_high, mu.open_low, mu.open_high))


def fitted(jacobian: Floats, data: Floats, without: int | None = None) -> tuple[Floats, Floats]:
    """Least squares with parameters and a start for each recording: (2,) and what is left (R, 3 T)."""
    kept = [r for r in range(R) if r != without]
    design = np.zeros((len(kept), 3 * T, 2 + 3 * R))
    design[..., :2] = jacobian[kept, :, :2]
    for row, r in enumerate(kept):
        design[row, :, 2 + 3 * r : 5 + 3 * r] = jacobian[r, :, 2:]
    fit = np.linalg.lstsq(design.reshape(-1, 2 + 3 * R), data[kept].ravel(), rcond=None)[0]
    solved = np.asarray(fit, dtype=np.float64)
    return solved[:2], data[kept] - (design @ solved)


def test_recordings_that_disagree_widen_an_interval_to_what_leaving_each_out_does() -> None:
    generator = np.random.default_rng(3)
    jacobian = 20.0 * generator.standard_normal((R, 3 * T, 5))
    # each recording has parameters of its own, far apart for its noise
    apart = 0.02 * generator.standard_normal((R, 2))
    data = np.einsum("rmk,rk->rm", jacobian[..., :2], apart) + generator.standard_normal((R, 3 * T))
    left = fitted(jacobian, data)[1]
    without = np.stack([fitted(jacobian, data, r)[0] for r in range(R)])
    spread = np.sqrt((R - 1) / R * np.sum((without - without.mean(axis=0)) ** 2, axis=0))
    reach = 2.919985580355516 * spread  # of Student's t with 2 degrees of freedom
    at = tangent(jacobian, 2, np.ones((R, T, 3), dtype=bool), 0.0)
    values = np.array([RHO, MU])
    rho, mu = intervals(MODEL, values, jacobian, at, left)
    assert np.all(reach > 1.2 * BETWEEN * deviations(jacobian, 0.0))
    assert (rho.low, rho.high) == pytest.approx((RHO * np.exp(-reach[0]), RHO * np.exp(reach[0])))
    assert (mu.low, mu.high) == pytest.approx((MU - reach[1], MU + reach[1]))


def test_a_recording_that_alone_tells_a_number_is_left_out_by_a_fit() -> None:
    """To first order a number moves out of all bounds without it; where it comes to rest is told by a fit."""
    generator = np.random.default_rng(5)
    jacobian = 20.0 * generator.standard_normal((R, 3 * T, 5))
    jacobian[1:, :, 1] *= 0.01  # only the first recording tells μ
    apart = np.zeros((R, 2))
    apart[0, 1] = 0.03
    data = np.einsum("rmk,rk->rm", 20.0 * generator.standard_normal((R, 3 * T, 2)), apart)
    left = fitted(jacobian, data + generator.standard_normal((R, 3 * T)))[1] * 3.0
    at = tangent(jacobian, 2, np.ones((R, T, 3), dtype=bool), 0.0)
    values, asked = np.array([RHO, MU]), list[int]()

    def without(row: int) -> Floats | None:
        asked.append(row)
        return MODEL.coordinates(np.array([[RHO, MU - 0.05]]))[0] if row == 0 else None

    def width(again: Callable[[int], Floats | None] | None) -> float:
        mu = intervals(MODEL, values, jacobian, at, left, again)[1]
        return mu.high - mu.low

    linear, found = width(None), width(without)
    assert asked[0] == 0
    moved = np.array([0.05, 0.0, 0.0])
    spread = np.sqrt((R - 1) / R * np.sum((moved - moved.mean()) ** 2))
    assert found == pytest.approx(2.0 * 2.919985580355516 * spread, rel=0.1)
    assert linear > 2.0 * found


def test_recordings_that_agree_to_within_their_noise_do_not() -> None:
    generator = np.random.default_rng(4)
    jacobian = 20.0 * generator.standard_normal((R, 3 * T, 5))
    at = tangent(jacobian, 2, np.ones((R, T, 3), dtype=bool), 0.0)
    usual = 2.0 * BETWEEN * deviations(jacobian, 0.0)[1]
    wider = 0
    for _ in range(200):
        left = fitted(jacobian, generator.standard_normal((R, 3 * T)))[1]
        mu = intervals(MODEL, np.array([RHO, MU]), jacobian, at, left)[1]
        wider += mu.high - mu.low > 1.001 * usual
    assert wider <= 20  # one in twenty, and their spread


def test_an_interval_widens_evenly_as_recordings_disagree_more() -> None:
    """From what the curvature says to what leaving each out does, without a jump in between."""
    generator = np.random.default_rng(3)
    jacobian = 20.0 * generator.standard_normal((R, 3 * T, 5))
    apart = 0.02 * generator.standard_normal((R, 2))
    whole = fitted(jacobian, np.einsum("rmk,rk->rm", jacobian[..., :2], apart))[1]
    at = tangent(jacobian, 2, np.ones((R, T, 3), dtype=bool), 0.0)

    def width(share: float) -> float:
        mu = intervals(MODEL, np.array([RHO, MU]), jacobian, at, share * whole)[1]
        return mu.high - mu.low

    usual = 2.0 * BETWEEN * deviations(jacobian, 0.0)[1]
    widths = np.array([width(share) for share in np.linspace(0.0, 1.0, 201)])
    assert widths[0] == pytest.approx(usual)
    assert widths[-1] > 2.0 * usual
    assert np.all(np.diff(widths) > -1e-12)
    assert np.max(np.diff(widths)) < 0.05 * (widths[-1] - widths[0])


def test_a_number_that_nothing_depends_on_has_no_bound() -> None:
    jacobian = 20.0 * np.random.default_rng(1).standard_normal((R, 3 * T, 5))
    jacobian[..., 1] = 0.0
    mu = found(jacobian, 0.0)["mu"]
    assert mu.open_low
    assert mu.open_high
    assert (mu.low, mu.value, mu.high) == (0.0, MU, 1.0)


def test_a_weak_number_is_open_where_its_interval_leaves_the_range() -> None:
    jacobian = 20.0 * np.random.default_rng(2).standard_normal((R, 3 * T, 5))
    weak = deviations(jacobian, 0.0)[1]
    jacobian[..., 1] *= weak * BETWEEN / 0.5  # now 0.4 ± 0.5
    mu = found(jacobian, 0.0)["mu"]
    assert mu.open_low
    assert not mu.open_high
    assert (mu.low, mu.high) == pytest.approx((0.0, 0.9))


def test_parameters_of_a_null_set_are_covered(null: Diagnosis) -> None:
    base = null.baseline
    known = intervals(base.model, base.fits.values[0], base.jacobian, base.tangent, base.rows)
    rho, mu = known
    assert (rho.key, mu.key) == ("rho_um2", "mu")
    for one, truth in ((rho, 0.276e-6), (mu, 0.3)):
        width = one.high - one.low
        assert one.low <= one.value <= one.high
        assert one.low - width < truth < one.high + width
    assert rho.high - rho.low < 0.02 * rho.value
