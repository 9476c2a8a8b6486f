"""The shipped example: what is copied, that it fits into a wheel, and that it shows what happened."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.example import EXAMPLE
from meso_robust.guide import FOR_USERS, TUTORIAL
from meso_robust.identification.document import read_model
from meso_robust.recordings import read_set
from meso_robust.task import load_task
from meso_robust.tasks import SMALL_MODEL
from reports.example.experiment import BURR, LENGTH, MU, PLANS, RHO_UM2, WIDTH, moved
from reports.example.make import log

HERE = Path(__file__).parent
RUNNER = CliRunner()
PUSHES = range(len(PLANS))
FILES = sorted(["grid.png", "task.toml", "tasks", "videos", *FOR_USERS])


def tree(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_the_example_is_copied_whole(tmp_path: Path) -> None:
    out = tmp_path / "new" / "ten minutes µ"

    result = RUNNER.invoke(app, ["example", str(out)])

    assert result.exit_code == 0, result.output
    assert "tutorial.md" in result.stdout
    assert sorted(path.name for path in out.iterdir()) == FILES
    assert [path.name for path in out.parent.iterdir()] == [out.name]
    copied = tree(out)
    assert copied["tutorial.md"] == TUTORIAL.read_bytes()
    videos = {f"videos/push_{k}.{end}" for k in PUSHES for end in ("mp4", "csv")}
    assert {name for name in copied if name.startswith("videos")} == videos
    assert {"tasks/paper.toml", "tasks/slot.toml"} <= set(copied)
    for page in FOR_USERS:
        links = re.findall(r"\]\(([^)#\s]+)", (out / page).read_text(encoding="utf-8"))
        assert all((out / link).exists() for link in links), page
    read_model(out / "tasks" / SMALL_MODEL.name)
    for task in {out / "task.toml", *(out / "tasks").iterdir()} - {
        out / "tasks" / SMALL_MODEL.name
    }:
        load_task(task)


def test_nothing_is_written_over(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine", encoding="utf-8")
    before = tree(tmp_path)

    for folder in (tmp_path, tmp_path / "mine.txt"):
        result = RUNNER.invoke(app, ["example", str(folder)])
        assert result.exit_code == 2
        assert "refusing to overwrite it; give a new folder" in result.stderr
    assert tree(tmp_path) == before


def test_an_empty_folder_is_filled_and_a_barred_one_told(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "file").write_text("", encoding="utf-8")

    assert RUNNER.invoke(app, ["example", str(tmp_path / "empty")]).exit_code == 0
    barred = RUNNER.invoke(app, ["example", str(tmp_path / "file" / "below")])

    assert sorted(path.name for path in (tmp_path / "empty").iterdir()) == FILES
    assert barred.exit_code == 2
    assert "is not a writable folder" in barred.stderr


def test_it_is_small_enough_for_a_wheel() -> None:
    assert sum(len(content) for content in tree(EXAMPLE).values()) < 3e6


@pytest.mark.parametrize("push", PUSHES)
def test_logs_are_of_the_motion_that_the_videos_show(push: int) -> None:
    motion = moved(PLANS[push])
    video = cv2.VideoCapture(str(EXAMPLE / "videos" / f"push_{push}.mp4"))

    shown = (EXAMPLE / "videos" / f"push_{push}.csv").read_text(encoding="utf-8")
    assert shown == log(motion)
    assert int(video.get(cv2.CAP_PROP_FRAME_COUNT)) == len(motion.times)
    assert video.get(cv2.CAP_PROP_FPS) == pytest.approx(20.0)


def test_the_set_of_the_tests_is_what_tracking_finds(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLE / "videos", tmp_path / "videos")
    words = [
        *("track", tmp_path / "videos/push_5.mp4", "--commands", tmp_path / "videos"),
        *("--task", EXAMPLE / "task.toml", "--tip-radius-um", 12.5, "--start", ",,0"),
        *("--grid", EXAMPLE / "grid.png", "--pitch-um", 200, "--no-overlay"),
        *("--out", tmp_path / "set"),
    ]
    result = RUNNER.invoke(app, [str(word) for word in words])

    assert result.exit_code == 0, result.output
    (again,) = read_set(tmp_path / "set").recordings
    (kept,) = [one for one in read_set(HERE / "set").recordings if one.file == again.file]
    # decoders of other builds may differ in the last bits
    assert again.poses == pytest.approx(kept.poses, abs=0.2e-6, nan_ok=True)
    assert again.probes == pytest.approx(kept.probes, abs=1e-9, nan_ok=True)


def test_what_was_tracked_is_what_happened() -> None:
    recordings = read_set(HERE / "set")

    assert recordings.position_source == "controller"
    for plan, one in zip(PLANS, recordings.recordings, strict=True):
        motion = moved(plan)
        frames = np.searchsorted(motion.times, one.times - 1e-6)
        off = one.poses - motion.poses[frames] * [1e-6, 1e-6, 1.0]
        assert np.nanmax(np.hypot(off[:, 0], off[:, 1])) < 2e-6
        assert np.degrees(np.nanmax(np.abs(off[:, 2]))) < 0.06


def test_the_task_is_too_optimistic_and_its_part_that_of_the_drawing() -> None:
    task = load_task(EXAMPLE / "task.toml")
    known = task.uncertainty

    part = task.rectangle("the example")

    assert (part.length_um, part.width_um) == (LENGTH, WIDTH)
    assert not known.friction[0] <= MU <= known.friction[1]
    assert abs(RHO_UM2 / known.film_ratio_um2 - 1) > 0.01 * known.film_ratio_percent


def test_the_model_of_the_diagnosis_is_near_the_truth() -> None:
    """`diagnose` makes it from the set (`tests.guide.test_tutorial` runs that); 90 % intervals."""
    found = read_model(HERE / "model.toml").parameters
    truth = {
        "rho_um2": RHO_UM2,
        "mu": MU,
        "part_geometry.x_um": BURR[0],
        "part_geometry.y_um": BURR[1],
    }

    for key, value in truth.items():
        half = 0.5 * (found[key].high - found[key].low)
        assert abs(found[key].value - value) < 3.0 * half, key
