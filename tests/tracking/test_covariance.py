"""Covariances against the scatter of many simulated fits."""

from __future__ import annotations

import numpy as np

from meso_robust.tracking.covariance import clustered, fused, systematic, turned
from meso_robust.tracking.edges import rotation, sampled_outline
from tests.tracking.drawing import CORNERS

OUTLINE = sampled_outline(CORNERS)


def test_clustered_errors_are_reported_as_large_as_they_are() -> None:
    """Errors shared by runs of points: the sandwich knows, the usual formula does not."""
    rng, design = np.random.default_rng(0), OUTLINE.design
    runs = np.searchsorted(OUTLINE.starts, np.arange(len(design)), side="right") - 1
    weight = np.ones(len(design))
    solutions, stated, usual = [], [], []
    for _ in range(400):
        error = rng.normal(0.0, 0.2, len(OUTLINE.starts))[runs]
        solution = np.linalg.lstsq(design, error, rcond=None)[0]
        residual = error - design @ solution
        solutions.append(solution)
        stated.append(np.diag(clustered(design, weight, residual, OUTLINE.starts)))
        usual.append(np.diag(np.linalg.inv(design.T @ design)) * residual.var())
    actual = np.var(solutions, axis=0)
    assert np.all(np.abs(np.mean(stated, axis=0) / actual - 1.0) < 0.25)
    assert np.all(np.mean(usual, axis=0) < 0.3 * actual)


def test_displaced_sides_are_reported() -> None:
    """Each side displaced and tilted at random by 0.05 px, as is assumed beforehand."""
    rng, design = np.random.default_rng(1), OUTLINE.design
    weight = np.ones(len(design))
    solutions, stated = [], []
    for _ in range(600):
        error = rng.normal(0.0, 0.05, len(OUTLINE.modes)) @ OUTLINE.modes
        solution = np.linalg.lstsq(design, error, rcond=None)[0]
        solutions.append(solution)
        stated.append(np.diag(systematic(design, weight, error - design @ solution, OUTLINE.modes)))
    ratio = np.mean(stated, axis=0) / np.var(solutions, axis=0)
    assert np.all((ratio > 0.75) & (ratio < 1.35))


def test_two_estimates_are_weighted_by_their_information() -> None:
    a, b = np.array([1.0, 0.0, 0.1]), np.array([0.0, 1.0, 0.2])
    cov_a, cov_b = np.diag([1.0, 4.0, 1e-4]), np.diag([1.0, 1.0, 3e-4])
    mean, covariance = fused(a, cov_a, b, cov_b)
    assert np.allclose(mean, [0.5, 0.8, 0.125])
    assert np.allclose(np.diag(covariance), [0.5, 0.8, 0.75e-4])


def test_a_covariance_turns_with_the_frame() -> None:
    rng = np.random.default_rng(2)
    draws = rng.normal(size=(20000, 3)) * [1.0, 3.0, 0.5]
    matrix = rotation(0.6)
    moved = np.column_stack((draws[:, :2] @ matrix.T, draws[:, 2]))
    expected = np.cov(moved.T)
    assert np.allclose(turned(np.diag([1.0, 9.0, 0.25]), matrix), expected, atol=0.2)
