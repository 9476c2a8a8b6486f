"""Covariances against the scatter of many simulated fits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.tracking.covariance import clustered, fused, systematic, turned
from meso_robust.tracking.edges import rotation, sampled_outline
from meso_robust.tracking.memory import untaught
from meso_robust.tracking.rim import _BINS, LampFit, _whitener
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


def test_weights_of_another_outline_are_refused() -> None:
    """Compiled sums would read on behind the last of them."""
    with pytest.raises(ValueError, match="one weight to each row"):
        clustered(np.ones((12, 4)), np.ones(6), np.ones(12), np.arange(0, 12, 2))


def test_displaced_sides_are_reported() -> None:
    """Each side displaced and tilted at random by 0.05 px, before noise of 0.1 px that no two points share."""
    rng, design = np.random.default_rng(1), OUTLINE.design
    weight, level = np.ones(len(design)), np.eye(2)
    solutions, stated = [], []
    for _ in range(600):
        error = rng.normal(0.0, 0.05, len(OUTLINE.modes)) @ OUTLINE.modes
        solution = np.linalg.lstsq(design, error, rcond=None)[0]
        residual = error - design @ solution
        scattered = residual + rng.normal(0.0, 0.1, len(residual))
        solutions.append(solution[:3])
        sides = systematic(design, weight, scattered, OUTLINE.modes)
        stated.append(np.diag(sides.covariance(level, None)))
    ratio = np.mean(stated, axis=0) / np.var(solutions, axis=0)
    assert np.all((ratio > 0.75) & (ratio < 1.35))


@pytest.mark.parametrize(("varied", "most"), [(0.0, 6.0), (0.05, 3.0)])
def test_noise_of_points_does_not_tilt_sides(varied: float, most: float) -> None:
    """Independent noise of 0.1 px, and what varies along a side over 40 px: the angle's variance, not far above it."""
    rng, design = np.random.default_rng(5), OUTLINE.design
    weight, place = np.ones(len(design)), np.arange(len(design))
    same = OUTLINE.side[:, None] == OUTLINE.side
    alike = same * np.exp(-0.5 * ((place[:, None] - place) / 13.0) ** 2)
    root = np.linalg.cholesky(alike + 1e-6 * np.eye(len(design)))
    angles, stated = [], []
    for _ in range(300):
        error = rng.normal(0.0, 0.1, len(design)) + varied * root @ rng.normal(size=len(design))
        solution = np.linalg.lstsq(design, error, rcond=None)[0]
        residual = error - design @ solution
        sides = systematic(design, weight, residual, OUTLINE.modes).covariance(np.eye(2), None)
        angles.append(solution[2])
        stated.append(sides[2, 2] + clustered(design, weight, residual, OUTLINE.starts)[2, 2])
    assert 0.8 < np.mean(stated) / np.var(angles) < most


def test_tilts_are_not_expected_from_sides_that_light_displaces() -> None:
    design, weight = OUTLINE.design, np.ones(len(OUTLINE.design))
    outward = np.array([1.0, -1.0, 1.0, -1.0]) @ OUTLINE.modes[::2]  # long sides out, short ones in
    sides = systematic(design, weight, 0.2 * outward, OUTLINE.modes)
    assert sides.sigma[::2].min() > 2.0 * sides.sigma[1::2].max()


def test_of_what_was_measured_only_the_change_is_left() -> None:
    """Sides keep their errors; the part turned by 0.7 rad since the displacement was measured."""
    rng, design = np.random.default_rng(3), OUTLINE.design
    weight = np.ones(len(design))
    sides = systematic(design, weight, rng.normal(0.0, 0.3, len(design)), OUTLINE.modes)
    before, now = rotation(0.2), rotation(0.9)
    errors = (rng.normal(0.0, 1.0, (20000, len(sides.sigma))) * sides.sigma) @ OUTLINE.modes
    own = errors @ np.linalg.pinv(design).T
    left = np.column_stack((own[:, :2] @ (now - before).T, own[:, 2]))
    stated = sides.covariance(now, sides.displacement(before))
    assert np.allclose(np.diag(stated) / left.var(axis=0), 1.0, atol=0.1)
    assert np.abs(sides.covariance(before, sides.displacement(before))[:2]).max() < 1e-12


def test_what_differs_from_frame_to_frame_averages_out() -> None:
    """A displacement measured in four frames, of which half of the variance is noise of the frame."""
    rng, each, none = np.random.default_rng(4), 0.2**2 * np.eye(2), np.zeros((2, 2))
    errors, stated = [], []
    for _ in range(2000):
        common = rng.normal(0.0, 0.2 * np.sqrt(0.5), 2)
        seen = common + rng.normal(0.0, 0.2 * np.sqrt(0.5), (4, 2))
        memory = replace(untaught(CORNERS), lamps=tuple(LampFit(d, each, none) for d in seen))
        errors.append(memory.lamp)
        stated.append(np.diag(memory.lamp_covariance)[:2])
    ratio = np.mean(stated, axis=0) / np.var(errors, axis=0)
    assert np.all((ratio > 0.9) & (ratio < 1.15))


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


def test_a_side_that_shows_nothing_within_tells_nothing_of_its_spread() -> None:
    """As one half hidden by a needle: that of the other sides counts."""
    rng = np.random.default_rng(2)
    mean, count = rng.uniform(80.0, 120.0, (3, len(_BINS))), np.full((3, len(_BINS)), 9.0)
    whole = _whitener(mean, count, np.ones(3))
    count[1, _BINS < 0.0] = 0.0
    found = _whitener(mean, count, np.ones(3))
    assert np.all(np.isfinite(found))
    # outside, where pixels are, it is whitened much as before
    assert found[1, -1, -1] == pytest.approx(whole[1, -1, -1], rel=0.05)
