"""Grids for calibration lie where the optics put them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from meso_robust.microscope import Optics, grid_image, grid_points, project, rectangle
from tests.microscope.clipping import coverage
from tests.microscope.plain import turned

OPTICS = Optics(width=320, height=240, k1=-0.03, rotation=0.03, centre=(20e-6, 10e-6), blur=0.7)
POSE = (50e-6, -30e-6, 0.05)


def test_corners_of_a_chessboard_are_found_where_they_are() -> None:
    image = grid_image(OPTICS, 110e-6, count=(10, 7), pose=POSE)
    found, corners = cv2.findChessboardCornersSB(image, (9, 6))
    assert found
    # which is off by up to 0.2 px on small images (it enlarges them), so the corners are refined
    until = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 100, 1e-5)
    seen = cv2.cornerSubPix(image, corners, (5, 5), (-1, -1), until).reshape(-1, 2)
    true = project(OPTICS, grid_points(110e-6, (10, 7), pose=POSE)).reshape(-1, 2)
    match = np.linalg.norm(seen[:, None] - true[None], axis=2).argmin(axis=1)
    assert sorted(match) == list(range(54))
    # OpenCV itself scatters by 0.03 px
    assert np.abs(seen - true[match]).max() < 0.08
    assert np.abs((seen - true[match]).mean(axis=0)).max() < 0.01


def test_a_square_covers_what_clipping_says() -> None:
    optics = Optics(width=96, height=80, pixel_size=5e-6, blur=0.0)
    image = grid_image(optics, 200e-6, count=(1, 1), pose=(3e-6, 4e-6, 0.3)).astype(float)
    world = turned(rectangle(200e-6, 200e-6), np.array([3e-6, 4e-6, 0.3]))
    exact = coverage(project(optics, world), 96, 80)
    black = (image.max() - image) / (image.max() - image.min())
    assert np.abs(black - exact).max() < 0.06
    assert black.sum() == pytest.approx(1600.0, abs=0.5)  # edges right to 0.003 px


def test_dots_have_their_centres_of_area_where_they_are() -> None:
    image = grid_image(OPTICS, 180e-6, "dots", count=(7, 5), pose=POSE)
    weight = image.max() - image.astype(float)
    count, labels = cv2.connectedComponents((weight > 4.0).astype(np.uint8))
    assert count == 7 * 5 + 1
    v, u = np.mgrid[:240, :320]
    mass = np.bincount(labels.ravel(), weight.ravel())[1:]
    seen = np.stack(
        [np.bincount(labels.ravel(), (weight * axis).ravel())[1:] / mass for axis in (u, v)],
        axis=1,
    )
    true = project(OPTICS, grid_points(180e-6, (7, 5), "dots", POSE)).reshape(-1, 2)
    away = np.linalg.norm(seen[:, None] - true[None], axis=2).min(axis=0)
    assert away.max() < 0.05  # distortion moves the centre of area by a little itself
    area = mass[len(mass) // 2] / (0.73 * 230.0)
    assert area == pytest.approx(np.pi * (45e-6 / OPTICS.pixel_size) ** 2, rel=0.02)


def test_an_endless_grid_has_a_corner_at_its_pose() -> None:
    optics = Optics(width=160, height=120, blur=0.0)
    image = grid_image(optics, 100e-6).astype(int)
    # the middle is where pixels 79 and 80, 59 and 60 meet
    assert image[59, 79] == image[60, 80]
    assert abs(image[59, 79] - image[59, 80]) > 150
    dots = grid_image(optics, 100e-6, "dots")
    assert dots[59:61, 79:81].max() < 40
    assert dots[:20].min() < 40  # and others to the border


def test_a_grid_without_a_pitch_is_refused() -> None:
    with pytest.raises(ValueError, match="pitch"):
        grid_image(OPTICS, 0.0)
