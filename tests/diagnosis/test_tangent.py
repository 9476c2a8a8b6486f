"""Whitening and projection, against Cholesky factors and least squares with all columns at once."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.diagnosis.tangent import Tangent, basis, tangent, whitened

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

R, T, N = 3, 12, 2
PHI = 0.6


def half_seen(rng: np.random.Generator) -> Bools:
    seen = rng.random((R, T, 3)) < 0.8
    seen[1, -4:] = False
    return np.asarray(seen)


def by_cholesky(columns: Floats, seen: Bools, phi: float) -> Floats:
    """(..., R, T, 3) white, by the covariance φ^|i − j| of every run of frames that were seen."""
    white = np.zeros_like(columns)
    for r, component in np.ndindex(R, 3):
        frames = np.flatnonzero(seen[r, :, component])
        for run in np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1):
            factor = np.linalg.cholesky(phi ** np.abs(run[:, None] - run))
            white[..., r, run, component] = np.linalg.solve(
                factor, columns[..., r, run, component][..., None]
            )[..., 0]
    return white


def left_by_least_squares(rows: Floats, design: Floats) -> Floats:
    """Rows (M,) less what columns (M, k) take."""
    return np.asarray(rows - design @ np.linalg.lstsq(design, rows, rcond=None)[0])


def arrow_design(columns: Floats, own: int) -> Floats:
    """(R M, n + R d) of columns (n + d, R, M), of which the last d are one a recording."""
    blocks = []
    for one in columns[len(columns) - own :]:
        for r in range(R):
            block = np.zeros_like(one)
            block[r] = one[r]
            blocks.append(block.ravel())
    shared = [one.ravel() for one in columns[: len(columns) - own]]
    return np.stack([*shared, *blocks], axis=1)


@pytest.mark.parametrize("phi", [0.0, PHI, 0.9])
def test_coloured_noise_is_made_white_as_by_its_covariance(phi: float) -> None:
    rng = np.random.default_rng(0)
    seen, residuals = half_seen(rng), rng.standard_normal((2, R, T, 3))
    expected = by_cholesky(residuals, seen, phi)
    np.testing.assert_allclose(whitened(residuals, seen, phi), expected, atol=1e-12)


def fit(own: int, rng: np.random.Generator) -> tuple[Tangent, Floats, Bools]:
    seen = half_seen(rng)
    jacobian = rng.standard_normal((R, 3 * T, N + own))
    columns = np.moveaxis(jacobian, -1, 0).reshape(N + own, R, T, 3)
    return tangent(jacobian, N, seen, PHI), columns, seen


def test_what_is_left_is_what_least_squares_leave() -> None:
    rng = np.random.default_rng(1)
    at, columns, seen = fit(3, rng)
    residuals = rng.standard_normal((R, T, 3))
    white = by_cholesky(columns, seen, PHI).reshape(N + 3, R, -1)
    rows = by_cholesky(residuals, seen, PHI).reshape(R, -1)
    expected = left_by_least_squares(rows.ravel(), arrow_design(white, 3))
    np.testing.assert_allclose(at.evidence(at.rows(residuals)), expected, atol=1e-10)
    starts = arrow_design(white[N:], 3)
    np.testing.assert_allclose(
        at.cleaned(at.rows(residuals)).ravel(),
        left_by_least_squares(rows.ravel(), starts),
        atol=1e-10,
    )


def test_offsets_of_the_tips_are_held_by_their_prior() -> None:
    rng = np.random.default_rng(2)
    at, columns, seen = fit(7, rng)
    residuals, offsets = rng.standard_normal((R, T, 3)), rng.standard_normal((R, 4))
    white = by_cholesky(columns, seen, PHI).reshape(N + 7, R, -1)
    prior = np.zeros((N + 7, R, 4))
    prior[np.arange(4) + N + 3, :, np.arange(4)] = 1.0
    design = arrow_design(np.concatenate([white, prior], axis=2), 7)
    # an offset of o stands in the fit as o itself: data nought, prediction o, residual −o
    rows = np.concatenate([by_cholesky(residuals, seen, PHI).reshape(R, -1), -offsets], axis=1)
    expected = left_by_least_squares(rows.ravel(), design)
    np.testing.assert_allclose(at.evidence(at.rows(residuals, offsets)), expected, atol=1e-10)


def test_a_start_that_nothing_follows_takes_nothing() -> None:
    rng = np.random.default_rng(4)
    seen = np.ones((R, T, 3), dtype=bool)
    jacobian = rng.standard_normal((R, 3 * T, N + 3))
    jacobian[1] = 0.0
    at = tangent(jacobian, N, seen, 0.0)
    rows = rng.standard_normal((R, 3 * T))
    np.testing.assert_array_equal(at.cleaned(rows)[1], rows[1])
    assert not np.allclose(at.cleaned(rows)[0], rows[0])


def test_a_basis_spans_the_columns_and_nothing_else() -> None:
    columns = np.random.default_rng(5).standard_normal((9, 3))
    columns = np.column_stack([columns, columns @ [1.0, -2.0, 0.5]])
    found = basis(columns)
    assert found.shape == (9, 3)
    np.testing.assert_allclose(found.T @ found, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(found @ found.T @ columns, columns, atol=1e-12)
    assert basis(np.zeros((9, 2))).shape == (9, 0)
