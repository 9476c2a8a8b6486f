"""What is in a frame."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.microscope import (
    Exposure,
    Fixture,
    Metal,
    Optics,
    Part,
    Probe,
    Scene,
    irradiance,
    project,
    rectangle,
    reflected,
    render,
    transmitted,
)
from tests.microscope.plain import FLAT, NO_TIPS, PIXEL, QUIET, small, still

Floats = npt.NDArray[np.float64]
ABSENT = np.full(3, np.nan)
OUTLINE = rectangle(200e-6, 120e-6)
ORIGIN = np.zeros(3)


def rng() -> np.random.Generator:
    return np.random.default_rng(7)


def pixel(scene: Scene, world: tuple[float, float]) -> tuple[int, int]:
    """Row and column of the pixel nearest to a world point."""
    u, v = project(scene.optics, np.array(world)).round().astype(int).tolist()
    return v, u


def plain(**exposure: Any) -> Scene:
    """An even background of brightness 0.5, nothing before it."""
    return Scene(
        part=None,
        oil=still(0.5),
        optics=Optics(width=200, height=160),
        exposure=dataclasses.replace(QUIET, level=200.0, **exposure),
    )


def mean(scene: Scene, time: float) -> float:
    return float(irradiance(scene, ABSENT, NO_TIPS, time).mean())


def test_the_same_seed_gives_the_same_frame_and_another_seed_another() -> None:
    scene = plain(read_noise=2.0)
    frames = [
        render(scene, ABSENT, NO_TIPS, np.random.default_rng(seed)).tobytes() for seed in (1, 1, 2)
    ]
    assert frames[0] == frames[1] != frames[2]


def test_noise_has_the_variance_of_shots_and_reading() -> None:
    scene = plain(shot_noise=0.05, read_noise=1.5)
    first, second = (
        render(scene, ABSENT, NO_TIPS, np.random.default_rng(seed)).astype(float) for seed in (1, 2)
    )
    # 100 grey levels of signal; rounding adds 1/12
    assert (first - second).var() / 2.0 == pytest.approx(0.05 * 100 + 1.5**2 + 1 / 12, rel=0.03)
    left, right = (first - first.mean())[:, :-1], (first - first.mean())[:, 1:]
    assert abs((left * right).mean() / first.var()) < 0.02  # and none of it is shared


def test_light_changes_in_time_as_stated() -> None:
    assert mean(plain(drift=0.1), 2.0) == pytest.approx(120.0)
    assert mean(plain(step=-0.4, step_time=1.0), 0.99) == pytest.approx(100.0)
    assert mean(plain(step=-0.4, step_time=1.0), 1.0) == pytest.approx(60.0)
    flicker = plain(flicker=0.2, flicker_frequency=10.0)
    assert [mean(flicker, t / 40.0) for t in range(4)] == pytest.approx([100, 120, 100, 80])


def test_light_falls_off_as_stated() -> None:
    corner = irradiance(plain(vignetting=0.2), ABSENT, NO_TIPS)[0, 0]
    assert corner == pytest.approx(80.0, rel=4e-3)  # half a pixel within the corner
    slope = irradiance(plain(gradient=(0.1, 0.3)), ABSENT, NO_TIPS)
    assert slope[80, -1] == pytest.approx(110.0, rel=5e-3)
    assert slope[0, 100] == pytest.approx(130.0, rel=5e-3)  # up


def edge_width(blur: float, focus_rate: float, time: float) -> float:
    """Standard deviation in px of the derivative of a blurred edge."""
    scene = Scene(
        part=Part(outline=OUTLINE, metal=FLAT),
        oil=still(0.0),
        optics=small(blur=blur),
        exposure=dataclasses.replace(QUIET, focus_rate=focus_rate),
    )
    line = np.diff(irradiance(scene, ORIGIN, NO_TIPS, time)[40, 48:].astype(float))
    at = np.arange(line.size)
    centre = (at * line).sum() / line.sum()
    return math.sqrt(((at - centre) ** 2 * line).sum() / line.sum())


def test_blur_and_drift_of_focus_add_in_quadrature() -> None:
    own = edge_width(0.0, 0.0, 0.0)  # of pixel and texel
    assert edge_width(2.0, 0.0, 0.0) == pytest.approx(math.hypot(2.0, own), rel=0.02)
    assert edge_width(2.0, 0.5, 3.0) == pytest.approx(math.hypot(2.0, 1.5, own), rel=0.02)


def test_the_texture_moves_with_the_part() -> None:
    part = Part(outline=OUTLINE, metal=dataclasses.replace(Metal(), bevel_relief=0.0))
    scene = Scene(part=part, oil=still(0.3), optics=small(), exposure=QUIET)
    here = irradiance(scene, ORIGIN, NO_TIPS)
    there = irradiance(scene, np.array([7 * PIXEL, -5 * PIXEL, 0.0]), NO_TIPS)
    assert np.std(here[32:48, 32:64]) > 0.01  # there is a texture
    assert np.abs(there[5:, 7:] - here[:-5, :-7]).max() < 1e-4
    turned = irradiance(scene, np.array([0.0, 0.0, math.pi]), NO_TIPS)
    assert np.abs(turned[::-1, ::-1] - here)[32:48, 32:64].max() < 5e-3


def test_rims_that_face_the_lamp_shine() -> None:
    metal = dataclasses.replace(FLAT, brightness=0.5, bevel=15e-6, bevel_relief=0.4)
    scene = Scene(
        part=Part(outline=OUTLINE, metal=metal),
        oil=still(0.0),
        optics=small(),
        exposure=dataclasses.replace(QUIET, lamp_azimuth=0.0),
    )
    for theta in (0.0, math.pi):  # the light stays where it is when the part turns
        row = irradiance(scene, np.array([0.0, 0.0, theta]), NO_TIPS)[40]
        assert row[66] > 0.6 > 0.5 > 0.4 > row[29]
        assert row[48] == pytest.approx(0.5)


def test_the_meniscus_shades_the_background_only() -> None:
    oil = dataclasses.replace(still(0.5), halo=0.4, halo_width=10e-6)
    scene = Scene(part=Part(outline=OUTLINE, metal=FLAT), oil=oil, optics=small(), exposure=QUIET)
    row = irradiance(scene, ORIGIN, NO_TIPS)[40]
    # The edge is 20 px right of the middle, at 67.5; the mean of the shade over each pixel:
    for u in (69, 72):
        near, far = (u - 68.0) * PIXEL / 10e-6, (u - 67.0) * PIXEL / 10e-6
        shade = 0.4 * (math.exp(-near) - math.exp(-far)) / (far - near)
        assert row[u] == pytest.approx(0.5 * (1.0 - shade), rel=5e-3)
    assert row[90] == 0.5
    assert row[60] == pytest.approx(1.0)


def test_a_probe_hides_the_part_and_what_is_absent_is_not_drawn() -> None:
    probe = Probe(direction=0.0, brightness=0.0, highlight=0.0)
    scene = Scene(
        part=Part(outline=OUTLINE, metal=FLAT),
        probes=(probe,),
        oil=still(0.3),
        optics=small(),
        exposure=QUIET,
    )
    away = np.full((1, 2), np.nan)
    both = irradiance(scene, ORIGIN, np.zeros((1, 2)))
    assert both[40, 50] == pytest.approx(0.0, abs=1e-6)
    assert both[40, 40] == pytest.approx(1.0)
    assert irradiance(scene, ORIGIN, away)[40, 50] == pytest.approx(1.0)
    assert (irradiance(scene, ABSENT, away) == np.float32(0.3)).all()


def test_a_part_may_leave_the_image() -> None:
    scene = Scene(
        part=Part(outline=OUTLINE, metal=FLAT), oil=still(0.0), optics=small(), exposure=QUIET
    )
    # the middle of the part on the left border of the image: half of its 40 x 24 px remain
    border = irradiance(scene, np.array([-48 * PIXEL, 0.0, 0.0]), NO_TIPS)
    assert border.sum() == pytest.approx(0.5 * 40 * 24, abs=0.3)
    assert irradiance(scene, np.array([0.0, 1e-3, 1.0]), NO_TIPS).max() == 0.0


def test_a_shaft_out_of_the_plane_is_out_of_focus() -> None:
    probe = Probe(half_angle=0.0, tip_radius=20e-6, defocus=0.1, brightness=0.0, highlight=0.0)
    scene = Scene(part=None, probes=(probe,), oil=still(1.0), optics=small(), exposure=QUIET)
    image = irradiance(scene, ABSENT, np.array([[-200e-6, 0.0]]))
    grey = [int(((column > 0.05) & (column < 0.95)).sum()) for column in image.T]
    assert grey[12] < grey[40] < grey[80]


def test_a_fixture_has_holes() -> None:
    plate, hole = rectangle(5e-3, 4e-3), rectangle(200e-6, 150e-6)
    scene = Scene(
        part=None,
        fixture=Fixture(rings=(plate, hole), metal=FLAT),
        oil=still(0.25),
        optics=small(),
        exposure=QUIET,
    )
    image = irradiance(scene, ABSENT, NO_TIPS)
    assert image[40, 48] == 0.25
    assert (image[[0, 0, -1, -1], [0, -1, 0, -1]] == 1.0).all()
    assert (image - 0.25).sum() / 0.75 == pytest.approx(96 * 80 - 40 * 30, abs=0.5)


@pytest.mark.parametrize(("make", "darker"), [(reflected, False), (transmitted, True)])
def test_the_presets_differ_in_which_is_darker(make: Callable[..., Scene], darker: bool) -> None:
    scene = make(probes=(Probe(),))
    image = render(scene, ORIGIN, np.array([[1.3e-3, 0.0]]), rng())
    assert image.shape == (480, 640)
    assert image.dtype == np.uint8
    part, background = image[220:260, 280:360].mean(), image[20:60, 280:360].mean()
    assert bool(part < background) is darker
    assert abs(part - background) > 40


def test_jpeg_loses_something_but_not_much() -> None:
    scene = plain(read_noise=2.0)
    exposure = dataclasses.replace(scene.exposure, jpeg_quality=50)
    lossy = render(dataclasses.replace(scene, exposure=exposure), ABSENT, NO_TIPS, rng())
    clean = render(scene, ABSENT, NO_TIPS, rng())
    assert 0.3 < np.abs(lossy.astype(float) - clean).mean() < 5.0


def test_shapes_and_looks_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="tips"):
        render(plain(), ORIGIN, np.zeros((1, 2)), rng())
    with pytest.raises(ValueError, match="no area"):
        Part(outline=np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]))
    with pytest.raises(ValueError, match="jpeg_quality"):
        Exposure(jpeg_quality=0)


@pytest.mark.parametrize("look", [{"dust": 40}, {"texture": 0.05}, {"grain": 0.05}])
def test_what_lies_on_the_slide_stays(look: dict[str, Any]) -> None:
    oil = dataclasses.replace(still(0.3), **look)
    scene = Scene(part=None, oil=oil, optics=Optics(width=320, height=240), exposure=QUIET)
    first = irradiance(scene, ABSENT, NO_TIPS)
    assert np.std(first) > 0.001
    assert (irradiance(scene, ABSENT, NO_TIPS, time=5.0) == first).all()
