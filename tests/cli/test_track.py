"""``meso-robust track`` as a user meets it: exit status, messages, files."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import tifffile
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.recordings import read_set
from meso_robust.recordings.problems import problems
from meso_robust.tracking.calibration_document import load_calibration
from meso_robust.tracking.frames import open_frames
from tests.tracking.pushes import Filmed, push

RUNNER = CliRunner()
PART = ("--length-um", 1616, "--width-um", 837, "--tip-radius-um", 12.5)
CAMERA = ("--pixel-um", 5.26)
FILES = [
    "calibration.toml",
    "overlay.avi",
    "push.csv",
    "push_covariance.csv",
    "report.html",
    "set.toml",
    "track.json",
]


def tracked(*words: object) -> Any:
    return RUNNER.invoke(app, ["track", *map(str, words)])


@pytest.fixture(scope="module")
def filmed(tmp_path_factory: pytest.TempPathFactory) -> Filmed:
    return push(tmp_path_factory.mktemp("cli") / "push.avi", 30)


@pytest.fixture(scope="module")
def done(filmed: Filmed, tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Path]:
    out = tmp_path_factory.mktemp("cli") / "out"
    return tracked(filmed.path, *PART, *CAMERA, "--start", "0,0,0", "--out", out, "--json"), out


def test_tracked_video_is_status_0_with_all_files(done: tuple[Any, Path]) -> None:
    result, out = done

    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in out.iterdir()) == FILES
    assert len(read_set(out).recordings[0].times) == 30
    assert load_calibration(out / "calibration.toml").pixel_size == pytest.approx(5.26e-6)


def test_json_is_the_document_and_nothing_else(done: tuple[Any, Path], filmed: Filmed) -> None:
    result, out = done
    answer = json.loads(result.stdout)

    assert answer == json.loads((out / "track.json").read_text(encoding="utf-8"))
    assert answer["schema"] == "meso-robust/track/1"
    assert answer["tracked"] is True
    video = answer["videos"][0]
    assert (video["frames"], video["promised"], video["found"], video["lost"]) == (30, 30, 30, [])
    assert video["probes"][0]["found"] == 30
    assert answer["provenance"]["asked"]["videos"] == [str(filmed.path)]


def test_report_tells_the_verdict_and_needs_nothing_else(done: tuple[Any, Path]) -> None:
    page = (done[1] / "report.html").read_text(encoding="utf-8")

    assert "<h1>TRACKED</h1>" in page
    assert page.count("<svg") == 2
    assert "http://" not in page.replace("http://www.w3.org", "")


def test_video_without_the_part_is_status_1_and_makes_no_set(tmp_path: Path) -> None:
    images = tmp_path / "images"
    images.mkdir()
    rng = np.random.default_rng(0)
    for k in range(3):
        noise = rng.normal(70.0, 2.0, (480, 640)).round().astype(np.uint8)
        cv2.imwrite(str(images / f"{k}.png"), noise)
    out = tmp_path / "out"

    result = tracked(images, *PART, *CAMERA, "--frame-rate-hz", 30, "--out", out)

    assert result.exit_code == 1
    assert "part not found in any of 3 frames" in result.stderr
    assert not (out / "set.toml").exists()
    assert json.loads((out / "track.json").read_text())["tracked"] is False
    assert "<h1>LOST</h1>" in (out / "report.html").read_text(encoding="utf-8")


def test_video_without_its_probe_is_status_1(filmed: Filmed, tmp_path: Path) -> None:
    words = ("--start", "0,0,0", "--probe", "left=-1200,-900", "--no-overlay")

    result = tracked(filmed.path, *PART, *CAMERA, *words, "--out", tmp_path)

    assert result.exit_code == 1
    assert "left not found in any of 30 frames" in result.stderr


def test_a_set_of_an_earlier_run_does_not_outlive_a_run_without_one(
    done: tuple[Any, Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    shutil.copytree(done[1], out)
    cv2.imwrite(str(tmp_path / "0.png"), np.full((480, 640), 70, np.uint8))
    images = tmp_path / "images"
    images.mkdir()
    (tmp_path / "0.png").rename(images / "0.png")

    result = tracked(images, *PART, *CAMERA, "--frame-rate-hz", 30, "--out", out)

    assert result.exit_code == 1
    assert not (out / "set.toml").exists()


def test_a_folder_has_the_commands_of_every_video(filmed: Filmed, tmp_path: Path) -> None:
    videos = [tmp_path / name for name in ("b.avi", "a.avi")]
    for k, video in enumerate(videos):
        shutil.copyfile(filmed.path, video)
        text = f"time_s,tip_x_um,tip_y_um\n0,{k},2\n1,{k},3\n"
        video.with_suffix(".csv").write_text(text, encoding="utf-8")
    words = ("--start", "0,0,0", "--commands", tmp_path, "--no-overlay", "--out", tmp_path / "out")

    result = tracked(*videos, *PART, *CAMERA, *words)

    assert result.exit_code == 0, result.output
    found = read_set(tmp_path / "out")
    assert found.position_source == "controller"
    first = {one.file: one.probes[0, 0, 0] for one in found.recordings}
    assert first == {"b.csv": pytest.approx(0.0), "a.csv": pytest.approx(1e-6)}


def test_a_video_is_never_written_over(filmed: Filmed) -> None:
    before = sorted(filmed.path.parent.iterdir())

    result = tracked(filmed.path, *PART, *CAMERA, "--out", filmed.path.parent)

    assert result.exit_code == 2
    assert "must not be overwritten" in result.stderr
    assert sorted(filmed.path.parent.iterdir()) == before


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("{v}", *CAMERA), "the part"),
        (("{v}", *PART), "the camera"),
        (("{v}", *PART[:4], *CAMERA), "--tip-radius-um"),
        (("{v}", *PART, *CAMERA, "--length-um", "300"), "--width-um"),
        (("{v}", *PART, "--pixel-um", "-1"), "--pixel-um"),
        (("{v}", *PART, *CAMERA, "--probe", "a" * 70 + "=1,1"), "--probe"),
        (("{v}", *PART, *CAMERA, "--pitch-um", "100"), "--pitch-um"),
        (("{v}", *PART, *CAMERA, "--start", "1,2"), "--start"),
        (("{v}", *PART, *CAMERA, "--probe", "p:1,2"), "--probe"),
        (("{v}", *PART, *CAMERA, "--probe", "p=9000,2"), "outside the image"),
        (("{v}", *PART, *CAMERA, "--commands", "{none}"), "--commands"),
        (("{v}", "{v}", *PART, *CAMERA, "--commands", "{text}"), "1 files for 2 videos"),
        (("{none}", *PART, *CAMERA), "no such file"),
        (("{torn}", *PART, *CAMERA), "--allow-truncated"),
        (("{text}", *PART, *CAMERA), "cannot be decoded as a video"),
        (("{v}", *PART, "--calibration", "{none}"), "cannot be read"),
        (("{v}", *PART, "--grid", "{text}", "--pitch-um", "100"), "cannot be decoded as an image"),
    ],
)
def test_bad_input_is_status_2_with_one_message_and_no_files(
    filmed: Filmed, tmp_path: Path, words: tuple[object, ...], message: str
) -> None:
    whole = filmed.path.read_bytes()
    (tmp_path / "torn.avi").write_bytes(whole[: len(whole) // 4])
    (tmp_path / "notes.txt").write_bytes(b"no video at all, but some text\n" * 40)
    names = {
        "{v}": filmed.path,
        "{none}": tmp_path / "none",
        "{torn}": tmp_path / "torn.avi",
        "{text}": tmp_path / "notes.txt",
    }
    out = tmp_path / "out"

    result = tracked(*(names.get(str(word), word) for word in words), "--out", out)

    assert result.exit_code == 2, result.output
    assert message in result.stderr
    assert "Traceback" not in result.output
    assert not out.exists()


def test_command_line_loads_nothing_heavy() -> None:
    heavy = "{'cv2', 'numba', 'numpy', 'scipy', 'matplotlib', 'sympy', 'casadi'}"
    code = f"import sys, meso_robust.cli.track; print(sorted({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert done.stdout.strip() == "[]"


def test_stack_is_tracked_page_by_page_with_the_clock_and_the_pixels_it_states(
    filmed: Filmed, tmp_path: Path
) -> None:
    pages = np.stack([frame.image for frame in open_frames(filmed.path)])
    stamps = [0.05 * k + 0.01 * (k % 2) for k in range(len(pages))]
    stated = {
        "PhysicalSizeX": 5.26,
        "PhysicalSizeY": 5.26,
        "Plane": {"DeltaT": stamps, "DeltaTUnit": ["s"] * len(stamps)},
    }
    stack = tmp_path / "push.ome.tif"
    tifffile.imwrite(stack, pages, ome=True, metadata={"axes": "TYX", **stated})

    result = tracked(
        stack, *PART, "--start", "0,0,0", "--out", tmp_path / "out", "--no-overlay", "--json"
    )

    assert result.exit_code == 0, result.output
    (video,) = json.loads(result.stdout)["videos"]
    assert (video["frames"], video["found"]) == (30, 30)
    assert any("5.26 um" in note for note in video["notes"])
    assert read_set(tmp_path / "out").recordings[0].times == pytest.approx(stamps)
    assert load_calibration(tmp_path / "out" / "calibration.toml").pixel_size == pytest.approx(
        5.26e-6
    )


def test_controllers_table_with_semicolons_gets_a_hint(filmed: Filmed, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("time_s;left_x_um;left_y_um\n0,0;1,5;2,5\n")

    result = tracked(
        filmed.path, *PART, *CAMERA, "--commands", tmp_path / "log.csv", "--out", tmp_path / "out"
    )

    assert result.exit_code == 2
    assert "parted by semicolons" in result.stderr


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_killed_run_leaves_no_half_file(tmp_path: Path, number: signal.Signals) -> None:
    video = push(tmp_path / "push.avi", 20).path
    out = tmp_path / "out"
    words = ["track", video, *PART, *CAMERA, "--start", "0,0,0", "--out", out]
    code = "from meso_robust.cli import main; main()"
    process = subprocess.Popen([sys.executable, "-c", code, *map(str, words)])
    while process.poll() is None and not _draws_without_a_name(process.pid):
        time.sleep(0.005)
    process.send_signal(number)
    process.wait(timeout=60)

    assert process.returncode in (-signal.SIGKILL, 130)
    assert list(out.iterdir()) == []


def _draws_without_a_name(pid: int) -> bool:
    """Whether a process writes an overlay that is in no folder."""
    try:
        links = [link.readlink().name for link in Path(f"/proc/{pid}/fd").iterdir()]
    except OSError:  # it closes files while we look
        return False
    return "overlay.avi (deleted)" in links


def test_same_video_twice_and_an_unsure_orientation_are_warnings_of_the_set(tmp_path: Path) -> None:
    video = push(tmp_path / "push.avi", 40, gap=40e-6).path
    out = tmp_path / "out"

    result = tracked(video, video, *PART, *CAMERA, "--out", out, "--no-overlay", "--json")

    first, second = json.loads(result.stdout)["videos"]
    assert not any("same push twice" in note for note in first["notes"])
    assert any("same push twice" in note and "push.csv" in note for note in second["notes"])
    kinds = [(p.kind, p.file) for p in problems(read_set(out)) if p.severity == "warning"]
    assert {("copy", second["file"]), ("alike", first["file"]), ("alike", second["file"])} <= set(
        kinds
    )
