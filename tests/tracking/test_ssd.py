"""Registration of the face."""

from __future__ import annotations

import math

import numpy as np

from meso_robust.tracking.edges import Lens, placed
from meso_robust.tracking.sampling import patch
from meso_robust.tracking.ssd import Appearance, Template, added, blank, registered, template
from meso_robust.types import Floats, Image as Bytes
from tests.tracking.drawing import CORNERS, digitised, plain, textured

RNG = np.random.default_rng(0)
LEARNED = np.array([300.3, 230.6, 0.2])


def learned(image: Bytes, pose: Floats) -> Appearance:
    piece = patch(image, None, placed(CORNERS, pose), 10.0)
    return added(blank(CORNERS), piece, pose, Lens())


def of_texture() -> Template:
    made = template(learned(digitised(textured(LEARNED), np.random.default_rng(1)), LEARNED))
    assert made is not None
    return made


def test_motion_is_found_whatever_gain_offset_and_slope_of_the_light() -> None:
    """Light changed by a quarter, and unevenly: the face is found to a hundredth of a px."""
    rng, known = np.random.default_rng(2), of_texture()
    u = np.linspace(-1.0, 1.0, 640)[None, :]
    errors, sigmas = [], []
    for _ in range(8):
        pose = LEARNED + rng.uniform(-1.0, 1.0, 3) * [40.0, 30.0, 0.5]
        image = digitised(textured(pose) * (0.75 + 0.1 * u) + 15.0, rng)
        start = pose + rng.uniform(-1.0, 1.0, 3) * [1.0, 1.0, 0.005]
        fit = registered(patch(image, None, placed(CORNERS, pose), 10.0), known, start, Lens())
        assert fit is not None
        assert fit.correlation > 0.9
        errors.append(fit.pose - pose)
        sigmas.append(np.sqrt(np.diag(fit.covariance)))
    assert np.abs(errors)[:, :2].max() < 0.04
    assert np.abs(errors)[:, 2].max() < math.radians(0.02)
    assert np.all(np.median(sigmas, axis=0)[:2] < 0.02)
    assert np.all(np.median(sigmas, axis=0) > 0.0)


def test_a_covered_half_of_the_face_is_left_out() -> None:
    rng, known, pose = np.random.default_rng(3), of_texture(), LEARNED + np.array([5.0, -3.0, 0.1])
    image, mask = digitised(textured(pose), rng), np.zeros((480, 640), np.uint8)
    image[:, 320:], mask[:, 320:] = 20, 1
    piece = patch(image, mask, placed(CORNERS, pose), 10.0)
    fit = registered(piece, known, pose + np.array([0.5, -0.5, 0.0]), Lens())
    assert fit is not None
    assert np.abs(fit.pose - pose)[:2].max() < 0.04


def test_a_face_without_features_says_little_or_nothing() -> None:
    pose = LEARNED
    made = template(learned(digitised(plain(pose), np.random.default_rng(4)), pose))
    other = digitised(plain(pose), np.random.default_rng(5))
    fit = made and registered(patch(other, None, placed(CORNERS, pose), 10.0), made, pose, Lens())
    assert fit is None or fit.correlation < 0.5


def test_another_face_is_not_recognised() -> None:
    """Turned by half a turn the same part shows another texture."""
    other = LEARNED + np.array([0.0, 0.0, math.pi])
    image = digitised(textured(other), np.random.default_rng(6))
    piece = patch(image, None, placed(CORNERS, LEARNED), 10.0)
    fit = registered(piece, of_texture(), LEARNED, Lens())
    assert fit is None or fit.correlation < 0.5


def test_the_correlation_falls_with_what_is_not_the_face() -> None:
    found = []
    for noise in (1.0, 40.0):
        image = digitised(textured(LEARNED), np.random.default_rng(7), noise)
        piece = patch(image, None, placed(CORNERS, LEARNED), 10.0)
        fit = registered(piece, of_texture(), LEARNED, Lens())
        assert fit is not None
        found.append(fit.correlation)
    assert 0.95 < found[0] <= 1.0
    assert 0.3 < found[1] < 0.85
