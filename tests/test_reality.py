"""The second main job, end to end: pushes are filmed, tracked and identified by the command line.

The motion comes from the event-driven engine and the video from the synthetic microscope; neither
shares code with the tracker or with the simulator that is fitted.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.microscope import Exposure, Oil, Part, Probe, Scene, film
from meso_robust.simulator import Film, Push, Round, exact

HALF_LONG, HALF_SHORT, RADIUS = 808e-6, 418.5e-6, 12.5e-6
PART = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [HALF_LONG, HALF_SHORT]
FILM_RATIO_UM2, FRICTION = 360_000.0, 0.31
FRAMES, RATE = 60, 30.0
PUSHES = ((-500e-6, 0.0), (600e-6, -0.3), (-250e-6, 0.45), (-550e-6, -0.35))
"""Places along the upper side in m, and directions from its inward normal in rad."""


def filmed(folder: Path) -> list[Path]:
    """One video for each push, of a part seen from nearly straight above."""
    scene = Scene(
        part=Part(outline=PART),
        probes=(Probe(tip_radius=RADIUS, direction=1.45, half_angle=0.09),),
        oil=Oil(seed=3),
        exposure=Exposure(jpeg_quality=92, vignetting=0.1),
    )
    videos = []
    for k, (place, angle) in enumerate(PUSHES):
        way = 400e-6 * np.array([np.sin(angle), -np.cos(angle)])
        start = np.array([place + 2e-5 * k, HALF_SHORT + RADIUS + 40e-6])
        push = Push.straight(
            vertices=PART,
            poses=np.array([[2e-5 * k, 0.0, 0.0]]),
            tips=start[None, None],
            travel=way[None, None],
            support=Film.ratio(1e-12 * FILM_RATIO_UM2),
            friction=np.array([FRICTION]),
            shapes=(Round(RADIUS),),
            step=1e-6,
        )
        poses = exact(push, samples=FRAMES).path[0]
        tips = start + np.linspace(0.0, 1.0, FRAMES + 1)[:, None] * way
        times = np.arange(FRAMES + 1) / RATE
        videos.append(folder / f"push {k} µ.avi")
        rng = np.random.default_rng(k)
        film(videos[-1], scene, times, poses, tips[:, None], rng)
    return videos


def run(*words: object) -> None:
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exit_code == 0, result.output


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, float]]:
    folder = tmp_path_factory.mktemp("reality")
    recordings, model = folder / "set", folder / "model"
    part = ("--length-um", 1616, "--width-um", 837, "--tip-radius-um", 12.5, "--pixel-um", 5.26)
    run("track", *filmed(folder), *part, "--start", ",,0", "--no-overlay", "--out", recordings)
    run("recordings", recordings, "--out", folder / "checked")
    run("identify", recordings, "--starts", 6, "--out", model)
    answer = json.loads((model / "identification.json").read_text(encoding="utf-8"))
    return answer["parameters"]


@pytest.mark.parametrize(("key", "truth"), [("rho_um2", FILM_RATIO_UM2), ("mu", FRICTION)])
def test_video_gives_back_the_parameters_that_moved_the_part(
    found: dict[str, dict[str, float]], key: str, truth: float
) -> None:
    fitted = found[key]
    half = 0.5 * (fitted["high"] - fitted["low"])

    # 90 % intervals, hence four times as wide: six standard deviations
    assert abs(fitted["value"] - truth) < 4.0 * half
    assert half < 0.02 * truth
