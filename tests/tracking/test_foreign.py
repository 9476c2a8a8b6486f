"""The foreign renderer itself, against closed forms, and the line of its table."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.tracking.alpha_matting import window_of
from meso_robust.tracking.backdrop import glimpse
from meso_robust.tracking.needle import Needle
from meso_robust.tracking.probes import refined
from reports.tracking import foreign
from reports.tracking.foreign import LOOKS, RADIUS, SHAPES, Camera, Look, Waves, row
from tests.nightly import at_night, often

PLAIN = replace(LOOKS["bright rim"], rim=0.0, halo=0.0, texture=0.0, noise=0.0)
POSE = np.array([158.3, 121.7, 0.4])


@pytest.mark.parametrize("shape", SHAPES)
def test_a_part_has_its_area_and_lies_where_it_should(shape: str) -> None:
    camera = Camera(PLAIN, SHAPES[shape], np.random.default_rng(0))
    camera.tilt = np.zeros(2)
    cover = (camera.frame(POSE, None) - PLAIN.film) / (PLAIN.face - PLAIN.film)
    x, y = SHAPES[shape].T
    cross = x * np.roll(y, -1) - y * np.roll(x, -1)
    area = 0.5 * cross.sum()
    middle = np.array([((k + np.roll(k, -1)) * cross).sum() / (6.0 * area) for k in (x, y)])
    c, s = math.cos(POSE[2]), math.sin(POSE[2])
    v, u = np.mgrid[: cover.shape[0], : cover.shape[1]]
    assert cover.sum() == pytest.approx(area, rel=2e-3)
    seen = np.array([(cover * u).sum(), (cover * v).sum()]) / cover.sum()
    assert seen == pytest.approx(POSE[:2] + np.array([[c, -s], [s, c]]) @ middle, abs=0.02)


def test_a_surface_turns_with_its_part() -> None:
    """Against cosines taken place by place."""
    waves, turn = Waves(np.random.default_rng(1)), 0.7
    u, v = np.linspace(-9.0, 30.0, 5), np.linspace(2.0, 17.0, 4)
    c, s = math.cos(turn), math.sin(turn)
    for i, down in enumerate(v):
        for j, right in enumerate(u):
            place = np.array([c * right + s * down, c * down - s * right])
            height = np.cos(place @ waves._k + waves._phase).sum() * math.sqrt(2.0 / 24.0)
            assert waves.at(u, v, turn)[i, j] == pytest.approx(height, abs=1e-9)


def test_the_table_says_what_was_measured() -> None:
    error = np.array([[0.3, -0.4, 0.0], [0.3, 0.4, 0.001], [np.nan] * 3])
    sigma = np.array([[0.2, 0.3, 0.01], [0.05, 0.2, 0.01], [np.nan] * 3])
    assert row("x", error, sigma) == "| x | 3 | 1 | 0.300 | 0.400 | 0.0405 | 50 / 50 / 100 | 1 |"
    assert row("x", error[2:, :2], sigma[2:, :2]) == "| x | 1 | 1 | – | – | – | – |"


def test_the_page_grows_with_every_condition(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An error in the second condition leaves the first one's line."""
    done: list[str] = []

    def one(name: str, place: int, films: int, seed: int) -> str:
        if done:
            raise KeyboardInterrupt
        done.append(f"| {name} {place} {films} {seed} |")
        return done[0]

    page = tmp_path / "page.md"
    monkeypatch.setattr(foreign, "pose_row", one)
    monkeypatch.setattr("sys.argv", ["foreign", "--full", "--seed", "5", "--out", str(page)])
    with pytest.raises(KeyboardInterrupt):
        foreign.main()
    assert page.read_text(encoding="utf-8").endswith("| bright rim 0 12 5 |\n")


def needle_errors(look: Look, seed: int) -> tuple[foreign.Floats, foreign.Floats]:
    """Errors (8, 2) px along and across a needle that goes ahead before film alone, and what is stated."""
    rng = np.random.default_rng([9, seed])
    camera, way = Camera(look, SHAPES["rectangle"], rng), rng.uniform(-2.2, -0.9)
    axes = np.array([[math.cos(way), math.sin(way)], [-math.sin(way), math.cos(way)]])
    needle = Needle(tip=(160.0, 80.0), direction=way, taper=0.08, radius=RADIUS)
    tips = needle.tip + rng.uniform(-0.5, 0.5, (8, 2)) + 1.3 * np.arange(8)[:, None] * axes[0]
    away = np.array([160.0, 400.0, 0.0])
    pieces = [
        glimpse(camera.frame(away, np.array([*tip, way])), tip + 0.2, window_of(needle), None)
        for tip in tips
    ]
    found = refined(pieces, needle, window_of(needle))
    sigma = np.sqrt(np.einsum("ki,tij,kj->tk", axes, found.covariances, axes))
    return (found.tips - tips) @ axes.T, sigma


def test_an_image_blurred_by_a_disc_does_not_move_a_tip() -> None:
    """Seen as a normal distribution it would be a needle that ends sooner, in a bright meniscus."""
    error, _ = needle_errors(replace(PLAIN, noise=0.5, disc=2.6), 0)
    assert np.sqrt(np.mean(error**2, axis=0)) == pytest.approx([0.0, 0.0], abs=0.15)


@pytest.mark.parametrize("look", ["noisy", pytest.param("rough face", marks=at_night)])
def test_what_an_image_leaves_of_a_needle_tells_how_well_it_is_seen(look: str) -> None:
    """Noise of twenty times the usual variance; film that is alike in pixels near each other."""
    films = [needle_errors(LOOKS[look], seed) for seed in range(often(2, 4))]
    pulls = np.array([error / sigma for error, sigma in films])
    assert np.sqrt(np.mean(pulls**2, axis=(0, 1))).max() < 1.6
    assert np.abs(pulls).max() < 4.0
