"""Edges along the outline, and the pose from them."""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.optimize import OptimizeResult

from meso_robust.tracking import rim
from meso_robust.tracking.edge_pattern import single_step
from meso_robust.tracking.edges import (
    CORNER,
    SPACING,
    Lens,
    edge_fit,
    learned_pattern,
    placed,
    robust_fit,
    sampled_outline,
    seen_size,
    thinned,
)
from meso_robust.tracking.memory import untaught
from meso_robust.tracking.rim import LampFit, block_step, lamp_displacement
from meso_robust.tracking.sampling import patch
from meso_robust.types import Floats, Image as Bytes
from tests.tracking.drawing import (
    CORNERS,
    HALF,
    body_coordinates,
    covered,
    digitised,
    obliquely_lit,
    plain,
)

ELL = np.array([[-90.0, -60], [110, -60], [110, 10], [0, 10], [0, 80], [-90, 80]])
POSE = np.array([317.37, 241.81, 0.41])
NEARBY = np.array([0.5, 0.4, 0.003])


def fitted(image: Bytes, start: Floats, lens: Lens | None = None) -> Floats:
    """The pose from the edges alone, its pattern learned in the same image."""
    outline, lens = sampled_outline(CORNERS), lens or Lens()
    piece = patch(image, None, lens.seen(placed(CORNERS, start)), 20.0)
    pose, pattern = start, single_step()
    for reach in (6.0, 3.0, 3.0):
        pose = edge_fit(piece, outline, pose, lens, pattern, reach, 3.0).pose
        pattern = learned_pattern(piece, outline, pose, lens)
    return pose


@pytest.mark.parametrize("dark_on_bright", [False, True])
@pytest.mark.parametrize("blur", [0.6, 1.5])
def test_pose_of_an_exactly_blurred_rectangle(dark_on_bright: bool, blur: float) -> None:
    rng = np.random.default_rng(0)
    for _ in range(4):
        pose = np.array([*rng.uniform(200.0, 420.0, 1), *rng.uniform(190.0, 290.0, 1), 0.0])
        pose[2] = rng.uniform(-0.4, 0.4)
        levels = (170.0, 60.0) if dark_on_bright else (60.0, 170.0)
        image = digitised(plain(pose, blur, *levels), rng)
        error = fitted(image, pose + np.array([2.0, -2.5, 0.012])) - pose
        assert np.abs(error[:2]).max() < 0.03
        assert abs(error[2]) < math.radians(0.01)


@pytest.mark.parametrize("hidden", [0, 1, 2, 3])
def test_where_no_two_opposite_sides_are_both_seen_the_size_is_not_told(hidden: int) -> None:
    """A side that lies far from where it is stated is not seen, and then place and size are one."""
    pose = np.array([320.0, 240.0, 0.0])
    x, y = body_coordinates(pose)
    frame = digitised(plain(pose), np.random.default_rng(0))
    outline, side = sampled_outline(CORNERS), (x, -x, y, -y)[hidden]
    covered_up = (side > 0.8 * HALF[hidden // 2]).astype(np.uint8)
    told = [
        seen_size(patch(frame, mask, placed(CORNERS, pose), 20.0), outline, pose, Lens(), single_step(), 6.0, 3.0)
        for mask in (None, covered_up)
    ]  # fmt: skip
    assert math.isfinite(told[0][1])
    assert told[1] == (0.0, math.inf)


def test_a_common_displacement_moves_no_pose_of_a_closed_outline() -> None:
    outline = sampled_outline(ELL)
    offset = np.full(len(outline.points), 0.7)
    solution, _ = robust_fit(outline.design, offset, np.ones(len(offset)), 10.0)
    assert np.allclose(solution, [0.0, 0.0, 0.0, 0.7], atol=1e-3)


def test_outward_normals_and_the_design_agree_with_a_moved_outline() -> None:
    """Shrunk about a point of its kernel the outline moves inward; moved rigidly, as designed."""
    for corners in (ELL, ELL[::-1]):
        outline = sampled_outline(corners)
        grown = 1.01 * (outline.points - [-45.0, -25.0]) + [-45.0, -25.0]
        assert np.all(np.sum((grown - outline.points) * outline.normals, axis=1) > 0.0)
        for k, motion in enumerate(1e-6 * np.eye(3)):
            shift = np.sum((placed(outline.points, motion) - outline.points) * outline.normals, 1)
            assert np.allclose(shift / 1e-6, outline.design[:, k], atol=1e-3)


def test_an_outline_with_fewer_points_keeps_every_side() -> None:
    short = sampled_outline(
        np.array([[0.0, 0.0], [63.5, 0.0], [63.5, 2.0 * CORNER + 1.5 * SPACING], [0.0, 40.0]])
    )
    fewer = thinned(short)
    assert np.count_nonzero(short.side == 1) == 1
    assert set(fewer.side) == set(short.side)
    assert len(fewer.points) < 0.6 * len(short.points)
    assert len(fewer.modes) == len(short.modes)


def test_outliers_along_a_part_of_one_side_do_not_move_the_fit() -> None:
    outline, rng = sampled_outline(CORNERS), np.random.default_rng(1)
    truth = np.array([0.4, -0.3, 0.004, 0.1])
    offset = outline.design @ truth + rng.normal(0.0, 0.05, len(outline.points))
    offset[20:60] += rng.uniform(2.0, 5.0, 40)
    solution, weight = robust_fit(outline.design, offset, np.ones(len(offset)), 3.0)
    assert np.abs(solution - truth)[:2].max() < 0.05
    assert weight[20:60].sum() < 1.0


def test_a_lens_is_undone_before_the_fit() -> None:
    """The image is drawn in ideal px and bent by the lens; the pose is the ideal one."""
    middle, strength = np.array([319.5, 239.5]), 2e-7

    def to_ideal(seen: Floats) -> Floats:
        d = seen - middle
        return middle + d * (1.0 + strength * np.sum(d**2, axis=1, keepdims=True))

    def to_image(ideal: Floats) -> Floats:
        seen = ideal.copy()
        for _ in range(20):
            seen = seen - (to_ideal(seen) - ideal)
        return seen

    pose = np.array([360.2, 200.7, 0.3])
    v, u = np.mgrid[:480, :640].astype(float)
    at = to_ideal(np.column_stack((u.ravel(), v.ravel()))).reshape(480, 640, 2).astype(np.float32)
    bent = cv2.remap(plain(pose).astype(np.float32), at[..., 0], at[..., 1], cv2.INTER_CUBIC)
    image = digitised(np.asarray(bent, dtype=float), np.random.default_rng(2))
    error = fitted(image, pose + NEARBY, Lens(to_ideal, to_image)) - pose
    assert np.abs(error[:2]).max() < 0.05
    assert abs(error[2]) < math.radians(0.02)
    assert np.abs(fitted(image, pose + NEARBY) - pose)[:2].max() > 0.3  # without it: elsewhere


@pytest.mark.parametrize("azimuth", [0.3, 2.5])
def test_oblique_light_displaces_the_edges_and_is_recognised(azimuth: float) -> None:
    lamp = 40.0 * np.array([math.cos(azimuth), math.sin(azimuth)])
    image = digitised(obliquely_lit(POSE, lamp), np.random.default_rng(3), 1.0)
    edges = fitted(image, POSE + NEARBY)
    displaced = (edges - POSE)[:2]
    assert np.hypot(*displaced) > 0.3
    fit = lamp_displacement(image, None, sampled_outline(CORNERS), edges, Lens())
    assert fit is not None
    assert np.abs(displaced - fit.displacement).max() < 0.1


def test_a_round_chamfer_is_told_from_a_straight_one() -> None:
    lamp = np.array([30.0, 25.0])
    drawn = obliquely_lit(POSE, lamp, width=4.0, rounded=True)
    image = digitised(drawn, np.random.default_rng(5), 1.0)
    edges = fitted(image, POSE + NEARBY)
    fit = lamp_displacement(image, None, sampled_outline(CORNERS), edges, Lens())
    assert fit is not None
    assert np.abs((edges - POSE)[:2] - fit.displacement).max() < 0.06


@pytest.mark.parametrize("azimuth", [0.4, 2.0, -1.0])
def test_a_rim_narrower_than_the_blur_is_not_taken_for_one_of_foil(azimuth: float) -> None:
    """It looks like a displaced edge: by how much is told less well, and said to be."""
    lamp = 60.0 * np.array([math.cos(azimuth), math.sin(azimuth)])
    drawn = obliquely_lit(POSE, lamp, blur=1.2, width=0.8)
    image = digitised(drawn, np.random.default_rng(3), 1.0)
    fit = lamp_displacement(image, None, sampled_outline(CORNERS), POSE, Lens())
    assert fit is not None
    assert np.abs(fit.displacement).max() < 0.12
    assert np.abs(fit.displacement / np.sqrt(np.diag(fit.covariance))).max() < 2.0


def test_lines_along_a_side_displace_the_light_no_more_than_is_stated() -> None:
    """As rolling leaves them: alike along a side, different from line to line."""
    rng = np.random.default_rng(6)
    x, y = body_coordinates(POSE)
    inside = covered(x, HALF[0], 0.8) * covered(y, HALF[1], 0.8)
    outline, off = sampled_outline(CORNERS), []
    for _ in range(6):
        lines = np.convolve(rng.normal(0.0, 9.0, 700), np.full(6, 1.0 / 6.0), "same")
        across = np.interp(y, np.linspace(-100.0, 100.0, 700), lines)
        drawn = obliquely_lit(POSE, np.zeros(2)) + inside * across
        fit = lamp_displacement(digitised(drawn, rng, 1.0), None, outline, POSE, Lens())
        assert fit is not None
        off.append(fit.displacement / np.sqrt(np.diag(fit.covariance)))
    assert np.sqrt(np.mean(np.square(off))) < 2.0  # of what is stated in the end


def test_even_light_is_not_taken_for_oblique() -> None:
    image = digitised(obliquely_lit(POSE, np.zeros(2)), np.random.default_rng(3), 1.0)
    fit = lamp_displacement(image, None, sampled_outline(CORNERS), POSE, Lens())
    assert fit is not None
    assert np.abs(fit.displacement).max() < 0.06


@pytest.mark.parametrize("angle", [0.0, 0.002, 1.5708 - 0.004])
def test_light_is_told_of_a_part_along_the_pixels_before_a_film_that_is_not_even(
    angle: float,
) -> None:
    """Each distance from a side is seen along another stretch of it, or at one only."""
    pose = np.array([317.37, 241.81, angle])
    lamp = np.array([30.0, 25.0])
    v, u = np.mgrid[:480, :640]
    uneven = 1.0 + 2e-4 * (u - 320) - 3e-4 * (v - 240) + 1e-6 * (u - 320.0) ** 2
    image = digitised(uneven * obliquely_lit(pose, lamp), np.random.default_rng(3), 1.0)
    edges = fitted(image, pose + NEARBY)
    displaced = (edges - pose)[:2]
    assert np.hypot(*displaced) > 0.3
    fit = lamp_displacement(image, None, sampled_outline(CORNERS), edges, Lens())
    assert fit is not None
    assert np.abs(displaced - fit.displacement).max() < 0.08


@pytest.mark.parametrize("share", [0.004, -0.004])
def test_light_is_told_of_a_part_that_is_not_as_large_as_stated(share: float) -> None:
    """All of its sides lie elsewhere, not alike: taken for the rim's, that would be light."""
    image = digitised(obliquely_lit(POSE, np.array([30.0, 25.0])), np.random.default_rng(3), 1.0)
    outline = sampled_outline((1.0 - share) * CORNERS)
    fit = lamp_displacement(image, None, outline, POSE, Lens(), sized=True)
    assert fit is not None
    assert np.abs(fit.displacement).max() < 0.06


def packed(image: Bytes, quality: int) -> Bytes:
    code = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return np.asarray(cv2.imdecode(code, cv2.IMREAD_GRAYSCALE), dtype=np.uint8)


def test_compression_shows_at_the_borders_of_its_blocks() -> None:
    image = digitised(plain(POSE), np.random.default_rng(8), 2.0)
    assert 0.9 < block_step(image) < 1.1
    for quality in (25, 60, 80):
        step = block_step(packed(image, quality))
        assert step > 1.6
        assert block_step(packed(image, quality)[3:, 5:]) == pytest.approx(
            step, rel=0.05
        )  # cut out


def test_what_light_displaces_is_less_certain_if_compressed() -> None:
    image = digitised(obliquely_lit(POSE, np.zeros(2)), np.random.default_rng(3), 2.0)
    sigma = []
    for seen in (image, packed(image, 60)):
        fit = lamp_displacement(seen, None, sampled_outline(CORNERS), POSE, Lens(), np.zeros(2))
        assert fit is not None
        sigma.append(math.sqrt(np.trace(fit.covariance)))
    assert sigma[1] > 1.2 * sigma[0]


def test_of_what_light_displaces_no_larger_share_is_known_than_of_the_rims_width() -> None:
    """Of 0.5 px a tenth and three tenths; and of what displaces all sides alike, no more than there is."""
    met = np.array([0.3, 0.4, 0.0, 0.0, 1.0, 1.0, 0.5, 0.25])
    assert math.sqrt(rim._wrong(met, 0.1**2)) == pytest.approx(0.05)
    assert math.sqrt(rim._wrong(met, 0.3**2)) == pytest.approx(0.15)
    pressed = met + 0.2 * np.eye(8)[2]
    assert rim._wrong(pressed, 0.0) == pytest.approx(0.2 * 0.2**2)
    assert rim._wrong(pressed * [0.1, 0.1, 1, 1, 1, 1, 1, 1], 0.0) == pytest.approx(0.2 * 0.05**2)


def test_another_solution_that_fits_nearly_as_well_is_a_doubt(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    image = digitised(obliquely_lit(POSE, np.zeros(2)), np.random.default_rng(3), 1.0)

    def fit_at(_: object, start: Floats, sized: bool) -> OptimizeResult:
        """Two valleys, half a px apart along u: the second is reached by one start of five."""
        second = start[0] > 0.0
        x = np.array([0.6 if second else 0.1, 0.0, *np.zeros(5)])
        return OptimizeResult(x=x, cost=10.5 if second else 10.0, jac=100.0 * np.eye(7))

    monkeypatch.setattr(rim, "_fitted", fit_at)
    fit = lamp_displacement(image, None, sampled_outline(CORNERS), POSE, Lens())
    assert fit is not None
    assert fit.displacement == pytest.approx([-0.1, 0.0])
    assert fit.doubt == pytest.approx(np.diag([0.5**2 * math.exp(-1.0) / 5.0, 0.0]))
    sure = LampFit(fit.displacement, fit.covariance, np.zeros((2, 2)))
    known = (replace(untaught(CORNERS), lamps=(one, sure)) for one in (fit, sure))
    with_doubt, without = (memory.lamp_covariance[:2, :2] for memory in known)
    assert with_doubt - without == pytest.approx(fit.doubt)
