"""The quick form of the accuracy campaign (the full one: ``python -m reports.tracking.accuracy``)."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.microscope import Scene, project, render
from meso_robust.microscope.frame import irradiance
from meso_robust.tracking.pose import PartTracker
from reports.tracking.accuracy import (
    BODY,
    CONDITIONS,
    PIXEL,
    Result,
    filmed,
    measured,
    motion,
    pushing,
    row,
    tip_errors,
    tip_row,
    together,
)
from reports.tracking.least import AROUND, least_alike, least_along
from tests.nightly import at_night


@pytest.fixture(scope="session")
def overall() -> Result:
    names = ("strong compression", "pushed by a probe", "lit through the slide")
    return together([measured(name, np.random.default_rng(7), 1, 36) for name in names])


def test_poses_are_right_to_a_tenth_of_a_px(overall: Result) -> None:
    assert overall.lost == 0
    assert overall.rms[:2].max() < 0.1
    assert overall.rms[2] < math.radians(0.05)
    assert overall.worst[:2].max() < 1.0


def test_stated_intervals_are_neither_too_narrow_nor_useless(overall: Result) -> None:
    assert overall.coverage[0].min() > 0.6  # three films: an error is much alike through a film
    assert np.all(np.median(overall.sigma, axis=0) < [0.2, 0.2, math.radians(0.05)])


def test_the_table_says_what_was_measured() -> None:
    error = np.array([[0.3, -0.4, 0.0], [0.3, 0.2, 0.001]])
    films, seconds = np.array([0, 1]), np.array([1e-3, 3e-3, 5e-3])
    line = row(Result("x", error, np.full((2, 3), 0.2), films, 1, seconds))
    assert line == (
        "| x | 3 | 1 | 0.300 | 0.316 | 0.0405 | 0.40 | 0.057 | 75 ± 25 / 100 ± 0 | 1.50 / 1.58 / 0.00 | 3.00 |"
    )


def test_what_is_not_covered_is_told_if_it_is_sure() -> None:
    """Of eight films of two frames u and v are held in all but one, the angle in a half of the frames."""
    error = np.zeros((16, 3))
    error[:2, :2], error[::2, 2] = 1.0, 1.0
    one = Result("x", error, np.full((16, 3), 0.2), np.arange(16) // 2, 0, np.zeros(1))
    assert one.outside == ["x: angle"]
    assert replace(one, film=np.arange(16) % 8).outside == []  # in a half of the films, ± 19 %
    # of 95 % eight films may all be held
    assert replace(one, error=np.zeros((16, 3))).outside == []
    many = Result("x", np.zeros((200, 3)), np.ones((200, 3)), np.arange(200), 0, np.zeros(1))
    assert many.outside == ["x: u and v", "x: angle"]


def test_the_table_of_tips_says_what_was_measured() -> None:
    here, there = np.array([[0.3, 0.0], [0.1, 0.0]]), np.array([[-0.2, 0.1], [np.nan, np.nan]])
    sigma = np.full((2, 2), 0.1)
    least = np.array([[0.03, 0.06, 0.09], [0.04, 0.08, 0.13]])
    line = tip_row([(here, sigma, least[0]), (there, sigma, least[1])])
    assert (
        line
        == "| pushing | 4 | 1 | 0.216 | 0.035 | 0.058 | 0.200 | 0.071 | 0.112 | 33 / 100 | 2.16 / 0.58 |"
    )


def test_a_fit_to_the_renderers_own_images_errs_by_the_least_possible() -> None:
    """Noise drawn 400 times, the place along the axis by the parabola of what five true images leave."""
    rng = np.random.default_rng(4)
    scene, _, (tip, *_) = pushing(rng)
    at = np.rint(project(scene.optics, tip)).astype(int)
    near = np.s_[at[1] - 23 : at[1] + 24, at[0] - 23 : at[0] + 24]
    v, u = np.mgrid[-23:24, -23:24]
    disc = np.hypot(u, v) < AROUND
    way = scene.probes[0].direction

    def image(along: float, across: float = 0.0, of: Scene = scene) -> npt.NDArray[np.float64]:
        c, s = math.cos(way), math.sin(way)
        moved = tip + PIXEL * np.array([c * along - s * across, s * along + c * across])
        seen = irradiance(of, np.full(3, np.nan), moved[None])
        return np.asarray(seen[near][disc], dtype=float)

    truth = image(0.0)
    sigma = np.sqrt(scene.exposure.shot_noise * truth + scene.exposure.read_noise**2 + 1.0 / 12.0)
    film = truth - image(0.0, of=replace(scene, oil=replace(scene.oil, brightness=0.2)))
    free = np.stack(
        [image(0.0, 0.1) - truth, film, film * u[disc], film * v[disc]], axis=1
    ) / sigma[:, None]  # fmt: skip
    kept = np.eye(len(truth)) - free @ np.linalg.pinv(free)
    places = np.linspace(-0.2, 0.2, 5)
    noise = rng.standard_normal((400, len(truth)))
    left = [(((truth - image(s)) / sigma + noise) @ kept) for s in places]
    curve = np.polynomial.polynomial.polyfit(places, [np.sum(k**2, axis=1) for k in left], 2)
    found = -0.5 * curve[1] / curve[2]
    assert found.std() == pytest.approx(least_along(scene, tip), rel=0.15)


def test_what_is_alike_in_a_film_tells_least_where_the_look_is_unknown() -> None:
    """A known needle's mean errs by the root of the frames less; the rest, the look's, falls with frames too."""
    scene, _, (tip, *_) = pushing(np.random.default_rng(4))
    known = least_along(scene, tip)
    few, many = (least_alike(scene, tip, frames) for frames in (10, 40))
    assert known / math.sqrt(10) < few
    assert 1.3 * few / 2.0 > many > known / math.sqrt(40)
    light = scene.exposure
    noisier = replace(light, shot_noise=4.0 * light.shot_noise, read_noise=2.0 * light.read_noise)
    assert least_alike(replace(scene, exposure=noisier), tip, 10) == pytest.approx(
        2.0 * few, rel=0.1
    )


def test_the_probe_meets_the_side_and_pushes() -> None:
    for seed in range(5):
        scene, poses, tips = pushing(np.random.default_rng(seed))
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        away = tips - poses[:, :2]
        local = np.column_stack((c * away[:, 0] + s * away[:, 1], c * away[:, 1] - s * away[:, 0]))
        gap = np.abs(local[:, 1]) - 418.5e-6 - scene.probes[0].tip_radius
        moves = np.hypot(*np.diff(poses[:, :2], axis=0).T) > 1e-9
        assert gap.min() > -1e-9
        assert gap[0] > 25e-6
        assert np.all(gap[1:][moves] < 1e-9)


def test_a_strongly_lit_rim_is_not_taken_for_the_edge() -> None:
    """A film in which another solution fits as well, but for a film uneven beside one side alone."""
    rng = np.random.default_rng(np.random.SeedSequence(5).spawn(5)[4])
    scene, (pose, *_) = CONDITIONS["light drifts and flickers"](rng), motion(rng, 16)
    rng.uniform()  # another draw of noise: the two solutions are that near to each other
    image = render(scene, pose, np.zeros((0, 2)), rng)
    truth = np.append(project(scene.optics, pose[:2]), scene.optics.rotation - pose[2])
    seen = PartTracker(BODY).first(image, truth * [np.nan, np.nan, 1.0])
    assert np.abs(seen.pose - truth)[:2].max() < 0.3


PUSHES = {
    "one flank alone looks like a needle": np.random.SeedSequence(3).spawn(12)[-1].spawn(9)[8],
    "a scratch of the part is darker than the shaft": np.random.SeedSequence(3)
    .spawn(12)[-1]
    .spawn(17)[16],
    "a blurred needle fits as well that ends sooner": np.random.SeedSequence([77, 66]),
}


@pytest.mark.parametrize(
    "why", [w if k % 2 else pytest.param(w, marks=at_night) for k, w in enumerate(PUSHES)]
)
def test_what_is_like_a_needle_is_not_taken_for_it(why: str) -> None:
    """Films in which another needle than the true one nearly fits: 1 to 5 px off, or none found."""
    error, sigma, _ = tip_errors(np.random.default_rng(PUSHES[why]))
    assert np.isfinite(error).all()
    assert np.sqrt(np.mean(error**2, axis=0)).max() < 0.6
    assert np.all(np.abs(error) < 4.0 * sigma)
    assert np.median(sigma, axis=0).max() < 0.4


def test_an_edge_that_is_not_the_outline_is_told() -> None:
    """A rim so bright that it is taken for the edge on all sides: the pose is a px off."""
    rng = np.random.default_rng([911, 6, 15])
    first = next(filmed(CONDITIONS["strongly oblique light"], rng, 1))
    sigma = np.sqrt(np.diag(first.sighting.covariance))
    assert np.all(np.abs(first.sighting.pose - first.truth) < 3.0 * sigma)
