"""Maps between pixels and the world, the calibration from a grid, and its file."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.microscope import Optics, grid_image, project
from meso_robust.tracking.calibration import Calibration, Interval
from meso_robust.tracking.calibration_document import calibration_text, load_calibration
from meso_robust.tracking.grid_fit import GridFit, calibrate

BENT = Calibration(
    pixel_size=5.26e-6,
    size=(640, 480),
    centre=(1e-4, -2e-4),
    rotation=0.3,
    k1=-0.03,
    k1_centre=(300.0, 250.0),
)
OPTICS = Optics(
    pixel_size=5.26e-6,
    centre=(1e-4, -2e-4),
    rotation=0.3,
    k1=-0.03,
    distortion_centre=(300.0, 250.0),
)
POINTS = np.random.default_rng(0).uniform(-1.4e-3, 1.4e-3, (50, 2))


def test_pixels_are_those_of_the_rendering_camera() -> None:
    assert BENT.to_pixels(POINTS) == pytest.approx(project(OPTICS, POINTS), abs=1e-9)


def test_world_and_pixels_are_inverse() -> None:
    assert BENT.to_world(BENT.to_pixels(POINTS)) == pytest.approx(POINTS, abs=1e-15)


def test_unturned_camera_has_y_up_and_its_origin_in_the_middle() -> None:
    plain = Calibration(pixel_size=2e-6, size=(640, 480))

    assert plain.to_pixels(np.array([0.0, 0.0])) == pytest.approx([319.5, 239.5])
    assert plain.to_pixels(np.array([2e-6, 4e-6])) == pytest.approx([320.5, 237.5])


def test_pose_carries_the_parts_points_where_the_camera_sees_them() -> None:
    pose, corner = np.array([2e-4, 1e-4, 0.7]), np.array([8e-4, 4e-4])
    c, s = math.cos(0.7), math.sin(0.7)
    world = pose[:2] + np.array([c * corner[0] - s * corner[1], s * corner[0] + c * corner[1]])

    u, v, angle = BENT.pose_to_pixels(pose)
    local = BENT.outline_px(corner[None])[0]
    c, s = math.cos(angle), math.sin(angle)
    ideal = np.array([u + c * local[0] - s * local[1], v + s * local[0] + c * local[1]])

    assert BENT.to_image(ideal) == pytest.approx(project(OPTICS, world), abs=1e-9)
    assert BENT.pose_to_world(np.array([u, v, angle])) == pytest.approx(pose)


def test_covariances_are_those_of_scattered_points() -> None:
    rng = np.random.default_rng(1)
    spread = np.array([[0.04, 0.01, 0.001], [0.01, 0.09, -0.002], [0.001, -0.002, 1e-3]])
    at = np.array([600.0, 30.0, 0.2])
    drawn = rng.multivariate_normal(at, spread, 200_000)

    pose = BENT.pose_covariance(spread)
    point = BENT.point_covariance(at[:2], spread[:2, :2])

    unit = np.array([1e-6, 1e-6, 1.0])
    assert pose / np.outer(unit, unit) == pytest.approx(
        np.cov((BENT.pose_to_world(drawn) / unit).T), rel=0.05, abs=2e-3
    )
    assert point * 1e12 == pytest.approx(
        np.cov(1e6 * BENT.to_world(drawn[:, :2]).T), rel=0.02, abs=0.02
    )


def fitted(kind: str, seed: int, k1: float) -> tuple[Optics, GridFit]:
    rng = np.random.default_rng(seed)
    optics = Optics(
        pixel_size=rng.uniform(4e-6, 6e-6),
        rotation=rng.uniform(-0.3, 0.3),
        k1=k1,
        distortion_centre=tuple((np.array([319.5, 239.5]) + rng.uniform(-30, 30, 2)).tolist()),
        centre=tuple(rng.uniform(-1e-4, 1e-4, 2).tolist()),
    )
    pitch = 40.0 * optics.pixel_size
    image = grid_image(optics, pitch, "dots" if kind == "dots" else "chessboard", rng=rng)
    return optics, calibrate(image, pitch)


def test_corners_on_the_rim_of_a_chessboard_are_not_of_the_grid() -> None:
    fit = calibrate(grid_image(OPTICS, 100e-6, "chessboard", count=(20, 14)), 100e-6)

    assert len(fit.kept) == 19 * 13
    assert fit.kept.all()


@pytest.mark.parametrize(("kind", "k1"), [("chessboard", -0.02), ("dots", 0.025)])
def test_grid_gives_the_camera_back_within_its_intervals(kind: str, k1: float) -> None:
    optics, fit = fitted(kind, 4, k1)
    found, half = fit.calibration, fit.calibration.interval

    assert fit.points.kind == kind
    assert half is not None
    assert found.k1_centre is not None
    assert optics.distortion_centre is not None
    # 95 % intervals of one image of each kind: 1.5 times their half width leaves 0.3 %
    assert abs(found.pixel_size - optics.pixel_size) < 1.5 * half.pixel_size
    assert abs(found.rotation - optics.rotation) < 1.5 * half.rotation
    assert abs(found.k1 - optics.k1) < 1.5 * half.k1
    for seen, true, by in zip(
        found.k1_centre, optics.distortion_centre, half.k1_centre, strict=True
    ):
        assert abs(seen - true) < 1.5 * by
    assert half.pixel_size < 1e-4 * found.pixel_size
    assert half.k1 < 2e-4


def test_without_distortion_its_centre_is_not_identifiable() -> None:
    _, fit = fitted("chessboard", 5, 0.0)
    half = fit.calibration.interval

    assert half is not None
    assert fit.calibration.k1_centre is None
    assert half.k1_centre == (math.inf, math.inf)
    assert abs(fit.calibration.k1) < 2.0 * half.k1


def test_image_without_a_grid_is_refused() -> None:
    noise = np.random.default_rng(0).integers(60, 90, (120, 160), np.uint8)
    with pytest.raises(InputError, match="points of a chessboard or dot grid"):
        calibrate(noise, 1e-4)
    with pytest.raises(InputError, match="--pitch-um"):
        calibrate(noise, 0.0)


def test_file_gives_the_calibration_back(tmp_path: Path) -> None:
    half = Interval(pixel_size=1e-10, rotation=1e-5, k1=1e-4, k1_centre=(math.inf, math.inf))
    path = tmp_path / "calibration.toml"
    path.write_text(calibration_text(replace(BENT, interval=half)), encoding="utf-8")

    found = load_calibration(path)

    assert found.interval is not None
    assert found.interval.k1_centre == (math.inf, math.inf)
    assert found.to_pixels(POINTS) == pytest.approx(BENT.to_pixels(POINTS), abs=1e-7)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("pixel_um = 5.26\n", "schema is missing"),
        ("{base}extra = 1\n", "extra is unknown"),
        ("{base}k1 = 0.5\n", "k1 = 0.5"),
        ("{base}rotation_deg = nan\n", "rotation_deg"),
        ("= 1", "not a TOML file"),
    ],
)
def test_bad_file_is_refused(tmp_path: Path, text: str, words: str) -> None:
    base = (
        'schema = "meso-robust/calibration/1"\nwidth_px = 640\nheight_px = 480\npixel_um = 5.26\n'
    )
    path = tmp_path / "calibration.toml"
    path.write_text(text.replace("{base}", base), encoding="utf-8")
    with pytest.raises(InputError, match=words):
        load_calibration(path)


@pytest.mark.parametrize(
    "values", [{"pixel_size": 0.0}, {"k1": 0.2}, {"size": (0, 480)}, {"pixel_size": math.nan}]
)
def test_impossible_values_are_refused(values: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must be"):
        replace(BENT, **values)  # type: ignore[arg-type]
