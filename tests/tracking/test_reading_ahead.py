"""Frames decoded by another thread: the same, in the same order, with the same errors."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.tracking import track as tracking
from meso_robust.tracking.calibration import Calibration
from meso_robust.tracking.frames import Frame, open_frames
from meso_robust.tracking.reading_ahead import read_ahead
from meso_robust.tracking.track import Scene, Start, track
from tests.tracking.pushes import PART, PIXEL, RADIUS, push


def frames(count: int, asked: list[int], broken: int = -1) -> Iterator[Frame]:
    for k in range(count):
        asked.append(k)
        if k == broken:
            raise InputError(f"frame {k}: torn; copy it again")
        yield Frame(index=k, time=0.1 * k, image=np.full((2, 3), k, np.uint8))


def test_order_and_number_stay() -> None:
    for count in (0, 1, 3, 20):
        read = [frame.index for frame in read_ahead(frames(count, []))]

        assert read == list(range(count))


def test_frames_are_read_before_they_are_asked_for_but_not_all() -> None:
    asked: list[int] = []
    third = threading.Event()

    def told() -> Iterator[Frame]:
        for frame in frames(100, asked):
            if frame.index == 2:
                third.set()
            yield frame

    ahead = read_ahead(told())
    next(ahead)

    assert third.wait(30.0)
    ahead.close()
    assert len(asked) < 10


def test_an_error_comes_after_the_frames_before_it() -> None:
    seen: list[int] = []

    with pytest.raises(InputError, match="frame 5: torn"):
        seen.extend(frame.index for frame in read_ahead(frames(9, [], broken=5)))

    assert seen == [0, 1, 2, 3, 4]


def test_the_thread_ends_when_the_reader_does() -> None:
    before = threading.active_count()
    ahead = read_ahead(frames(100, []))
    next(ahead)
    assert threading.active_count() == before + 1

    ahead.close()

    assert threading.active_count() == before


def test_poses_and_tips_do_not_depend_on_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    filmed = push(tmp_path / "push.avi", 16, gap=40e-6, speed=4.7e-6)
    x, y = filmed.tips[0, 0].tolist()
    scene = Scene(
        outline=PART,
        tip_radius=RADIUS,
        calibration=Calibration(pixel_size=PIXEL, size=(640, 480)),
        pose=np.array([np.nan, np.nan, 0.0]),
        probes=(Start(name="p", tip=(x, y)),),
    )
    ahead = track(open_frames(filmed.path), scene)
    monkeypatch.setattr(tracking, "read_ahead", lambda frames: frames)
    serial = track(open_frames(filmed.path), scene)

    assert np.isfinite(serial.tips).all()
    for name in ("times", "poses", "covariances", "tips", "tip_covariances", "scores"):
        assert np.array_equal(getattr(ahead, name), getattr(serial, name))
