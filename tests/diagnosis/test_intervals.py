"""Intervals against generalised least squares with starts and parameters in one matrix."""

from __future__ import annotations

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
    known = intervals(base.model, base.fits.values[0], base.jacobian, base.tangent)
    rho, mu = known
    assert (rho.key, mu.key) == ("rho_um2", "mu")
    for one, truth in ((rho, 0.276e-6), (mu, 0.3)):
        width = one.high - one.low
        assert one.low <= one.value <= one.high
        assert one.low - width < truth < one.high + width
    assert rho.high - rho.low < 0.02 * rho.value
