"""Edges lie in the image where exact clipping puts them."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.microscope import Probe, irradiance, rectangle
from tests.microscope.clipping import coverage
from tests.microscope.plain import NO_TIPS, PIXEL, black_probe, turned, white_part

Floats = npt.NDArray[np.float64]
OUTLINE = rectangle(300e-6, 170e-6)
STRAIGHT = white_part(OUTLINE)
BARREL = white_part(OUTLINE, k1=-0.06, rotation=0.2)
TURNS = [0.0, 0.01, 0.3, math.pi / 4, math.atan(0.5), math.atan(1 / 3), 1.2, 2.0, 3.5, 5.0]


def edge_errors(image: Floats, exact: Floats, corners: Floats) -> list[float]:
    """By how many px each edge is misplaced outward: surplus of brightness over its length."""
    v, u = np.mgrid[: image.shape[0], : image.shape[1]]
    errors = []
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        length = float(np.linalg.norm(q - p))
        t = (q - p) / length
        along = (u - p[0]) * t[0] + (v - p[1]) * t[1]
        across = (v - p[1]) * t[0] - (u - p[0]) * t[1]
        near = (along > 4.0) & (along < length - 4.0) & (np.abs(across) < 3.0)
        errors.append(float((image - exact)[near].sum()) / (length - 8.0))
    return errors


@pytest.mark.parametrize("theta", TURNS)
def test_straight_edges_lie_right_to_5_thousandths_of_a_pixel(theta: float) -> None:
    rng = np.random.default_rng(round(1000 * theta))
    pose = np.array([*rng.uniform(-10e-6, 10e-6, 2), theta])
    world = turned(OUTLINE, pose)
    corners = np.stack([47.5 + world[:, 0] / PIXEL, 39.5 - world[:, 1] / PIXEL], axis=1)
    image = irradiance(STRAIGHT, pose, NO_TIPS).astype(float)
    errors = edge_errors(image, coverage(corners, 96, 80), corners)
    assert np.max(np.abs(errors)) < 0.005


def test_the_measure_of_an_edge_sees_a_shift_of_5_thousandths() -> None:
    pose = np.array([0.005 * PIXEL, 0.0, 0.3])
    world = turned(OUTLINE, pose)
    corners = np.stack([47.5 + world[:, 0] / PIXEL, 39.5 - world[:, 1] / PIXEL], axis=1)
    unmoved = irradiance(STRAIGHT, np.array([0.0, 0.0, 0.3]), NO_TIPS).astype(float)
    errors = edge_errors(unmoved, coverage(corners, 96, 80), corners)
    assert np.max(np.abs(errors)) > 0.004


def barrel_pixels(world: Floats) -> Floats:
    """The map of `BARREL`, written once more: camera turned 0.2 ccw, then pulled inward."""
    z = (world[:, 0] + 1j * world[:, 1]) * np.exp(-0.2j) / PIXEL
    z = z * (1.0 - 0.06 * np.abs(z) ** 2 / (48.0**2 + 40.0**2))
    return np.stack([47.5 + z.real, 39.5 - z.imag], axis=1)


def test_distortion_and_rotation_bend_edges_as_they_should() -> None:
    pose = np.array([6e-6, -3e-6, 0.5])
    t = np.linspace(0.0, 1.0, 30, endpoint=False)[:, None]
    ring = zip(OUTLINE, np.roll(OUTLINE, -1, axis=0), strict=True)
    dense = np.concatenate([p + t * (q - p) for p, q in ring])
    exact = coverage(barrel_pixels(turned(dense, pose)), 96, 80)
    image = irradiance(BARREL, pose, NO_TIPS).astype(float)
    assert image.sum() == pytest.approx(exact.sum(), rel=3e-4)
    v, u = np.mgrid[:80, :96]
    for axis in (u, v):  # the centre of area, to 0.002 px
        assert (axis * image).sum() / image.sum() == pytest.approx(
            (axis * exact).sum() / exact.sum(), abs=2e-3
        )
    # No pixel differs by more than a texel's ramp can blur; a shift by 0.1 px would.
    assert np.abs(image - exact).max() < 0.1


@pytest.mark.parametrize("shift", [0.0, 0.13, 0.5, 0.77])
def test_a_tip_is_a_disc_about_its_centre(shift: float) -> None:
    probe = Probe(tip_radius=4 * PIXEL, half_angle=0.0, defocus=0.0, brightness=0.0, highlight=0.0)
    tip = PIXEL * np.array([[0.3, shift]])
    dark = 1.0 - irradiance(black_probe(probe), np.full(3, np.nan), tip).astype(float)
    around = np.linspace(0.5 * math.pi, 1.5 * math.pi, 90)
    disc = 4.0 * np.stack([np.cos(around), np.sin(around)], axis=1)
    needle = np.concatenate([disc, [[80.0, -4.0], [80.0, 4.0]]])
    exact = coverage(np.array([47.8, 39.5 - shift]) + needle, 96, 80)
    v, u = np.mgrid[:80, :96]
    for moment in (np.ones_like(u), u - 47.8, v - 39.5 + shift):
        weight = moment * (u < 56)
        seen, true = (weight * dark).sum(), (weight * exact).sum()
        # px^2 times px over an area of 90 px^2: the tip is right to 0.003 px
        assert seen == pytest.approx(true, abs=0.25)
