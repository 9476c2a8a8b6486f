"""The frames of a run as a video: all of them, as they were, and readable after a kill."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import meso_robust as mr
from meso_robust.errors import InputError
from meso_robust.live.conductor import Conductor
from meso_robust.live.devices import Frame
from meso_robust.live.filming import DRAFT, KILLED, VIDEO, Film, frame_name
from meso_robust.live.journal import Header, Journal
from meso_robust.live.lab_file import VirtualSection, WatchSection
from meso_robust.live.loop import Words, run_loop
from meso_robust.live.preflight import trust_of
from meso_robust.live.session import eye_of
from meso_robust.live.sight import calibration_of
from meso_robust.live.virtual_bench import lab_of, laboratory_of
from meso_robust.task import load_task
from meso_robust.tasks import MICROSCOPE
from meso_robust.tracking.calibration_document import calibration_text
from meso_robust.tracking.frames import open_frames


def drawn(number: int, time: float) -> Frame:
    image = np.random.default_rng(number).integers(0, 256, (48, 64), dtype=np.uint8)
    return Frame(number=number, time=time, image=image)


def test_tracking_the_video_finds_the_poses_of_the_journal(tmp_path: Path) -> None:
    task = load_task(MICROSCOPE)
    lab = lab_of(task, "-x", VirtualSection(seed=3, frame_rate_hz=5.0)).model_copy(
        update={"watch": WatchSection(max_age_ms=500.0, max_latency_ms=1e6, patience_s=3.0)}
    )
    header = Header(
        task_hash=task.hash, plan_hash="", lab=lab, trust=trust_of(task), confirm=False, dry=False,
        version="", started="",
    )  # fmt: skip
    conductor = Conductor(lab, lambda *_: {"refused": "enough"}, header.trust)
    journal, film = Journal(None, header), Film(tmp_path)

    run_loop(
        laboratory_of(task, lab).devices(), lab, eye_of(task, header), conductor, journal, Words(), film=film
    )  # fmt: skip
    film.finish()
    (tmp_path / "camera.toml").write_text(calibration_text(calibration_of(lab.camera)))

    seen = [(k, t.reading.seen) for k, t in enumerate(journal.turns, 1) if t.reading.seen]
    assert sorted(path.name for path in (tmp_path / VIDEO).glob("*.pgm")) == [
        frame_name(turn) for turn, _ in seen
    ]
    assert [frame.time for frame in open_frames(tmp_path / VIDEO)] == [one.time for _, one in seen]
    start = next(one.sight.pose for _, one in seen if one.sight.pose is not None)
    tracked = mr.track(
        tmp_path / VIDEO,
        task=MICROSCOPE,
        tip_radius_um=lab.manipulators[0].tips[0].radius_um,
        calibration=tmp_path / "camera.toml",
        start=(None, None, start[2]),
    )
    poses = tracked.found.tracks[0].poses * [1e6, 1e6, 180.0 / np.pi]
    told = np.array([one.sight.pose or (np.nan,) * 3 for _, one in seen])
    known = np.isfinite(told[:, 0])
    assert known.sum() >= 3
    # the tracker of a video learns the part's look from all of its frames, the loop only from those so far
    assert np.abs(poses - told)[known].max(axis=0) == pytest.approx([0, 0, 0], abs=0.6)
    assert np.abs(poses - told)[known][:, 2].max() < 0.05


def test_images_are_kept_without_loss_and_a_frame_that_is_not_newer_is_left_out(
    tmp_path: Path,
) -> None:
    film = Film(tmp_path)
    for turn, time in ((1, 0.1), (3, 0.25), (4, 0.25), (5, 0.4)):
        film.add(turn, drawn(turn, time))
    film.finish()

    frames = list(open_frames(tmp_path / VIDEO))
    assert [frame.time for frame in frames] == [0.1, 0.25, 0.4]
    for turn, frame in zip((1, 3, 5), frames, strict=True):
        assert np.array_equal(frame.image, drawn(turn, 0.0).image)


def test_what_a_killed_run_left_is_a_video_and_is_kept_by_the_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def killed(*_: object) -> None:
        raise KeyboardInterrupt

    film = Film(tmp_path)
    for turn in (1, 2):
        film.add(turn, drawn(turn, 0.1 * turn))
    with monkeypatch.context() as patched:
        patched.setattr("meso_robust.live.filming.os.rename", killed)
        with pytest.raises(KeyboardInterrupt):
            film.add(3, drawn(3, 0.3))  # its instant is told, its name not yet given

    assert [frame.time for frame in open_frames(tmp_path / DRAFT)] == [0.1, 0.2]
    film.close()
    assert not Film(tmp_path).finish()
    assert not (tmp_path / VIDEO).exists()
    assert [frame.time for frame in open_frames(tmp_path / KILLED)] == [0.1, 0.2]


def test_a_file_that_is_no_frame_is_never_removed(tmp_path: Path) -> None:
    film = Film(tmp_path)
    film.add(1, drawn(1, 0.1))
    assert film.finish()
    (tmp_path / VIDEO / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match=r"notes\.txt: is no frame of a run"):
        Film(tmp_path)
    assert (tmp_path / VIDEO / "notes.txt").exists()


def test_a_run_without_a_frame_leaves_nothing(tmp_path: Path) -> None:
    """As one whose camera cannot be reached."""
    out = tmp_path / "out"
    Film(out).close()
    assert not out.exists()
