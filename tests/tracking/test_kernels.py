"""Compiled loops against areas by hand and against NumPy's own."""

from __future__ import annotations

import math

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from scipy.linalg import eigvalsh

from meso_robust.tracking.alpha_matting import HALO_COUNT, PAD, Window, sharp
from meso_robust.tracking.covariance_kernels import support
from meso_robust.tracking.edge_profile import behind
from meso_robust.tracking.fit_kernels import (
    alike,
    behind as scene_behind,
    carried,
    compare,
    face_step,
    reweighted,
    robust,
    shifted,
)
from meso_robust.tracking.needle import FINER, Needle, coverage
from meso_robust.tracking.needle_kernels import FINE_KNOTS, film_beside
from meso_robust.tracking.rim_kernels import misfit, slopes
from meso_robust.tracking.sampling import Patch, derivatives, sample
from tests.entry import entry

Floats = npt.NDArray[np.float64]


@pytest.mark.parametrize("direction", [0.0, 0.5 * math.pi, math.pi])
def test_a_needle_covers_its_area(direction: float) -> None:
    needle = Needle(tip=(40.3, 39.8), direction=direction, taper=0.0, radius=3.0, blur=1.1)

    share = coverage(needle, np.zeros(2), (80, 80))

    # half a disc, and a strip of twice the radius to the window's border
    border = {0.0: 79.5 - 40.3, 0.5 * math.pi: 79.5 - 39.8, math.pi: 40.3 + 0.5}[direction]
    assert share.sum() == pytest.approx(0.5 * math.pi * 9.0 + 6.0 * border, rel=2e-3)
    assert share[39, 40] > 0.9


def test_a_tapering_needle_covers_its_polygon() -> None:
    needle = Needle(tip=(30.2, 41.7), direction=-0.7, taper=0.12, radius=2.4, blur=0.9, rise=0.0)
    fine = np.zeros((800, 800), np.uint8)
    corners = (needle.polygon(0.0, 200.0) + 0.5) * 10.0 - 0.5
    cv2.fillPoly(fine, [np.rint(corners * 16.0).astype(np.int32)], 255, cv2.LINE_8, 4)
    drawn = fine.reshape(80, 10, 80, 10).mean(axis=(1, 3)) / 255.0

    share = coverage(needle, np.zeros(2), (80, 80))

    wide = cv2.GaussianBlur(drawn, (0, 0), 0.9)
    inner = np.s_[8:72, 8:72]  # a blur sees beyond the window
    assert np.abs(share - wide)[inner].max() < 0.04
    assert share[inner].sum() == pytest.approx(wide[inner].sum(), rel=0.01)


@pytest.mark.parametrize("s", [0.0, 8.0, 16.0])
def test_what_is_seen_on_a_shaft_is_blurred_as_its_flanks_are(s: float) -> None:
    """A line along a needle's middle, from the fine image of its knots and by summing over the shaft's width."""
    needle = Needle(tip=(0.0, 0.0), direction=0.0, taper=0.0, radius=3.0, rise=0.06)
    window = Window(low=(-8, -12), shape=(25, 33))
    bright = np.array([0.2, 0.1, 0.5, 1.3, 0.9, 0.3, 0.4])
    column = FINER * (int(s) + 8 + PAD) + FINER // 2
    n = (np.arange(FINER * (25 + 2 * PAD)) + 0.5) / FINER - 0.5 - PAD - 12.0

    drawn = sharp(needle, window)[1 + HALO_COUNT :][:FINE_KNOTS, :, column].T @ bright

    at = np.linspace(-3.0, 3.0, 3001)
    look = np.interp(at, np.linspace(-3.0, 3.0, 7), bright)
    sigma = max(0.06 * s, 0.1)
    blur = np.exp(-0.5 * ((n[:, None] - at) / sigma) ** 2) / (sigma * math.sqrt(2.0 * math.pi))
    assert drawn == pytest.approx(np.trapezoid(blur * look, at, axis=1), abs=2e-3)


def test_a_needle_near_an_edge_hides_what_a_sharp_one_does_that_is_blurred() -> None:
    """A needle up to u = 19, film, and a part that is twice as bright from 21 on: drawn finely, then blurred."""
    fine, sigma = (np.arange(4000) + 0.5) / 100.0 - 0.5, 1.0
    kernel = np.exp(-0.5 * (np.arange(-600, 601) / 100.0 / sigma) ** 2)

    def seen(sharp: Floats) -> Floats:
        wide = np.pad(sharp, 600, mode="edge")
        each = np.convolve(wide, kernel / kernel.sum(), "valid")
        return np.tile(each.reshape(40, 100).mean(axis=1), (21, 1))

    part, clear = np.where(fine < 21.0, 1.0, 2.0), np.where(fine < 19.0, 0.0, 1.0)
    images = np.zeros((6, 21, 40), np.float32)
    images[0] = seen(clear)
    given = np.stack([70.0 * seen(part * clear), seen(part), *np.zeros((2, 21, 40))])
    given[3] = 1.0
    scene, own, left, weight = np.empty((5, 21, 40)), np.empty((5, 840)), *np.empty((2, 840))
    film = np.array([70.0, 0.0, 0.0])
    scene_behind(
        given[1].astype(np.float32), np.array([0.0, 10.0]), np.array([1.0, 0.0]), film, scene
    )

    variance, reach = sigma**2 + 1.0 / 12.0, np.array([8.0, 40.0, 9.0])
    compare(images, scene, variance, given.astype(np.float32), 70.0, reach, own, left, weight)

    # of 70 grey values of contrast; the first two terms alone are 2.2 off
    assert np.abs(left.reshape(21, 40)[5:16, 5:35]).max() < 1.5


@pytest.mark.parametrize("count", [11, 12])
def test_robust_weights_stand_on_the_median(count: int) -> None:
    rng = np.random.default_rng(count)
    residual = rng.normal(size=2 * count).astype(np.float32)
    weight = np.ones(2 * count, np.float32)
    out = np.empty(2 * count, np.float32)

    entry(robust)(residual, weight, out)

    sigma = max(1.4826 * float(np.median(np.abs(residual[::2]))), 0.5)
    expected = np.maximum(1.0 - (residual / (4.7 * sigma)) ** 2, 0.0) ** 2
    assert out == pytest.approx(expected, abs=1e-6)


def test_outliers_do_not_count_and_hidden_ones_are_not_read() -> None:
    rng = np.random.default_rng(3)
    design, truth = rng.normal(size=(200, 4)), np.array([0.4, -0.3, 0.02, 0.1])
    offset = design @ truth + 0.01 * rng.normal(size=200)
    offset[:20] += 3.0
    offset[20:40] = np.nan
    weight, solution = np.ones(200), np.empty(4)
    weight[20:40] = 0.0

    reweighted(design, offset, np.flatnonzero(weight), 10.0, 0.05, solution, weight)

    good = np.linalg.lstsq(design[40:], offset[40:], rcond=None)[0]
    assert solution == pytest.approx(good, abs=2e-3)
    assert np.all(weight[:40] == 0.0)


def test_what_agrees_is_a_share_of_what_is_visible() -> None:
    """The least generalised eigenvalue, as LAPACK has it."""
    rng = np.random.default_rng(6)
    design, visible = rng.normal(size=(60, 3)) * [1.0, 1.0, 40.0], rng.random(60) < 0.8
    agrees = visible & (rng.random(60) < 0.6)
    whole, part = (design[rows].T @ design[rows] for rows in (visible, agrees))
    shares = np.linalg.eigvalsh(support(design, visible, agrees))
    assert shares == pytest.approx(eigvalsh(part, whole), rel=1e-6)


def test_a_face_that_explains_all_correlates_fully() -> None:
    rng = np.random.default_rng(7)
    design, weight = rng.normal(size=(500, 8)), rng.random(500)
    assert alike(design, 2.0, weight, np.zeros(500)) == pytest.approx(1.0)
    noise = 2.0 * rng.normal(size=500)  # as much as is explained
    assert alike(design, 2.0, np.ones(500), noise) == pytest.approx(math.sqrt(0.5), abs=0.03)


def test_a_face_is_solved_as_by_least_squares() -> None:
    rng = np.random.default_rng(4)
    design, truth = rng.normal(size=(300, 8)), np.arange(1.0, 9.0)
    grey = design @ truth + 0.1 * rng.normal(size=300)
    grey[::7] = np.nan
    weight, solution, residual = np.ones(300), np.empty(8), np.empty(300)

    face_step(design, grey, 0.3, weight, solution, residual)

    seen = np.isfinite(grey)
    expected = np.linalg.lstsq(design[seen], grey[seen], rcond=None)[0]
    assert solution == pytest.approx(expected, rel=1e-6)
    assert residual[seen] == pytest.approx((grey - design @ expected)[seen], abs=1e-6)
    assert np.all(weight[~seen] == 0.0)
    assert np.all(weight[seen] > 0.0)


def test_a_moved_piece_of_a_parabola_is_exact_and_told_from_what_lies_beyond() -> None:
    v, u = np.mgrid[:20, :30].astype(float)

    def height(x: Floats, y: Floats) -> Floats:
        return np.asarray(0.25 * (x - 12.0) ** 2 + 0.5 * x + 2.0 * y + 10.0)

    frame = (4.0 * height(u, v)).astype(np.uint8)
    grey, inside = np.empty((6, 8), np.float32), np.empty((6, 8), np.bool_)

    shifted(frame, np.array([7, 5]), np.array([0.25, 0.75]), grey, inside)
    assert inside.all()
    assert grey == pytest.approx(4.0 * height(u[5:11, 7:15] + 0.25, v[5:11, 7:15] + 0.75), abs=1e-3)

    shifted(frame, np.array([24, -2]), np.zeros(2), grey, inside)
    # a cubic needs a pixel before and two after
    assert np.array_equal(np.flatnonzero(inside.any(axis=0)), [0, 1, 2, 3])
    assert np.array_equal(np.flatnonzero(inside.any(axis=1)), [3, 4, 5])
    assert np.array_equal(grey[2:, :6], frame[:4, 24:])
    assert np.array_equal(grey[0, :6], frame[0, 24:])


def test_an_edge_behind_a_needle_is_read_beside_it() -> None:
    """A part below the line v = 60: a ramp of 5 px before it, and a rim of its own; the needle comes from above."""
    v, u = np.mgrid[:120, :160].astype(float)
    away = 60.0 - v
    drawn = 100.0 - np.clip(10.0 - 2.0 * np.abs(away), 0.0, None)
    needle = Needle(tip=(80.0, 50.0), direction=-0.5 * math.pi, taper=0.0, radius=4.0)
    drawn[(np.abs(u - 80.0) < 9.0) & (v < 54.0)] = 10.0
    outline = np.array([[20.0, 60.0], [140.0, 60.0], [140.0, 110.0], [20.0, 110.0]])
    places = np.array([[80.0, 47.0], [80.5, 48.75], [83.0, 58.5], [21.0, 61.0], [80.0, 75.0]])

    found = behind(drawn.astype(np.uint8), outline, places, needle)

    assert found is not None
    assert found.rows.tolist() == [1, 2, 3]  # others are farther than 11.5 px
    assert found.distance[:2] == pytest.approx([11.25, 1.5])
    assert found.normals[:2] == pytest.approx(np.array([[0.0, -1.0], [0.0, -1.0]]))
    change, variance = found.here()
    assert change[:2] == pytest.approx([0.0, -7.0], abs=0.6)  # grey values are whole
    assert variance[1] < 0.5
    assert found.edge[2] == -1  # beside a corner
    assert change[2] == 0.0
    assert variance[2] > 1e5
    assert behind(drawn.astype(np.uint8), outline, places[:1], needle) is None


def test_slopes_of_the_rim_are_differences_of_what_it_leaves() -> None:
    rng = np.random.default_rng(5)
    centres = np.arange(-10.0, 9.0, 0.25) + 0.125
    angles = np.array([0.3, 0.3 + 0.5 * math.pi, 0.3 + math.pi, 0.3 + 1.5 * math.pi])
    normals = np.stack([np.cos(angles), np.sin(angles), [1.0, 0.5, 1.0, 0.5]], axis=1)
    whitener = (
        np.eye(len(centres)) + np.tril(rng.normal(size=(4, len(centres), len(centres)))) / 20.0
    )
    target = np.append(np.tile(100.0 + 50.0 * np.tanh(centres), 4), np.zeros(4))
    target[:-4] += rng.normal(size=4 * len(centres))
    places = centres + rng.uniform(-0.1, 0.1, (4, len(centres)))
    given = (places, normals, whitener, target, 1.0)
    unknown = np.array([0.2, -0.3, 0.05, 0.1, 0.9, 0.8, 0.4, 0.1, 0.15])

    found = slopes(given, unknown)

    for k, step in enumerate(1e-4 * np.eye(9)):
        change = (misfit(given, unknown + step) - misfit(given, unknown - step)) / 2e-4
        assert found[:, k] == pytest.approx(change, abs=1e-4 * np.abs(change).max())


def test_an_edge_that_is_blurred_by_a_disc_is_met_by_a_flat_blur_only() -> None:
    centres, radius = np.arange(-10.0, 9.0, 0.25) + 0.125, 2.2
    normals = np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [-1.0, 0.0, 1.0], [0.0, -1.0, 1.0]])
    # a half plane seen through a disc: the share of the disc that lies beyond the edge
    reach = np.clip(centres / radius, -1.0, 1.0)
    share = 0.5 - (np.arcsin(reach) + reach * np.sqrt(1.0 - reach**2)) / math.pi
    target = np.append(np.tile(70.0 + 80.0 * share, 4), np.zeros(4))
    places = np.tile(centres, (4, 1))
    given = (places, normals, np.tile(np.eye(len(centres)), (4, 1, 1)), target, 1.0)

    def left(flat: float) -> float:
        each = [
            np.linalg.norm(
                misfit(given, np.array([0.0, 0.0, 0.0, math.log(blur), 0.9, 0.9, 0.5, flat, 0.0]))
            )
            for blur in np.linspace(0.3 * radius, 0.7 * radius, 41)
        ]
        return float(min(each))

    assert left(0.55) < 0.6 * left(0.0)


def test_profiles_are_differentiated_wherever_nothing_is_hidden() -> None:
    """A plane has the same derivative everywhere; the slow way is to ask for each value on its own."""
    v, u = np.mgrid[:60, :80].astype(np.float32)
    hidden = np.zeros((60, 80), np.uint8)
    hidden[20:32, 35:40] = 1
    piece = Patch(2.0 * u + 3.0 * v, hidden, (35, 20, 5, 12), np.zeros(2))
    rng = np.random.default_rng(6)
    points = rng.uniform((1.0, 1.0), (78.0, 58.0), (400, 2))
    angle = rng.uniform(0.0, 2.0 * math.pi, 400)
    normals = np.stack([np.cos(angle), np.sin(angle)], axis=1)

    found = derivatives(piece, points, normals, 4, 0.5)

    aside = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    values = np.zeros((400, 9))
    for k in range(9):
        for side in (-1.0, 0.0, 1.0):
            values[:, k] += sample(piece, points + 0.5 * (k - 4) * normals + side * aside) / 3.0
    expected = values[:, 2:] - values[:, :-2]
    assert 20 < np.isnan(expected).any(axis=1).sum() < 200
    assert np.array_equal(np.isnan(found), np.isnan(expected))
    slope = np.broadcast_to((normals @ [2.0, 3.0])[:, None], found.shape)
    assert found[np.isfinite(found)] == pytest.approx(slope[np.isfinite(found)], abs=1e-3)


def test_an_image_is_carried_by_the_map_of_its_outline() -> None:
    rng = np.random.default_rng(7)
    source, move = rng.uniform(0.0, 300.0, (6, 2)), np.array([[0.9, -0.2, 4.0], [0.25, 1.1, -30.0]])
    target = source @ move[:, :2].T + move[:, 2]

    assert carried(source, target, np.array([100.0, 40.0]), 100.0) == pytest.approx(move)


@pytest.mark.parametrize("film", [[100], [90, 101]])
def test_film_is_seen_beside_a_needle(film: list[int]) -> None:
    needle = Needle(tip=(30.0, 20.0), direction=0.5 * math.pi, taper=0.0, radius=3.0)
    v, u = np.mgrid[:60, :60].astype(float)
    distance = needle.distance(*needle.along_across(u, v))
    grey = np.full((60, 60), 7, np.uint8)  # the needle, and dirt elsewhere
    beside = (distance > 4.0) & (distance < 8.0)
    grey[beside] = np.resize(film, int(beside.sum()))

    assert film_beside(grey, needle.drawn(), 4.0, 8.0) == np.median(grey[beside])
