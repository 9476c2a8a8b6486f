"""Compiled loops against areas by hand and against NumPy's own."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from meso_robust.tracking.fit_kernels import face_step, reweighted, robust
from meso_robust.tracking.needle import Needle, coverage


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


@pytest.mark.parametrize("count", [11, 12])
def test_robust_weights_stand_on_the_median(count: int) -> None:
    rng = np.random.default_rng(count)
    residual = rng.normal(size=2 * count).astype(np.float32)
    weight = np.ones(2 * count, np.float32)
    out = np.empty(2 * count, np.float32)

    robust(residual, weight, out)

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
