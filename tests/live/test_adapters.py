"""The same loop through µManager's core, through a pipe, and in the shapes of ROS 2."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.live.devices import DeviceError, Devices, Frame, Status
from meso_robust.live.lab_file import Lab, VirtualSection
from meso_robust.live.pipe import Line, devices_at, piped as pipes_of, serve
from meso_robust.live.ros import (
    devices_by,
    image_message,
    image_of,
    pose_message,
    seconds_of,
    stamp_of,
)
from meso_robust.live.virtual import VirtualLaboratory
from meso_robust.live.virtual_bench import lab_of, laboratory_of
from meso_robust.task import load_task
from meso_robust.tasks import MICROSCOPE
from tests.live.rig import sight

UM = 1e-6


def bench(**virtual: Any) -> tuple[Lab, VirtualLaboratory]:
    task = load_task(MICROSCOPE)
    lab = lab_of(task, "-x", VirtualSection(**virtual))
    lab = lab.model_copy(
        update={
            "manipulators": tuple(
                one.model_copy(update={"label": f"XY-{one.name}", "lift_label": f"Z-{one.name}"})
                for one in lab.manipulators
            ),
            "stage_label": "",
        }
    )
    return lab, laboratory_of(task, lab)


@contextmanager
def piped(devices: Devices, lab: Lab) -> Iterator[Devices]:
    """The devices, through a pair of pipes."""
    (their_in, to), (answers, their_out) = os.pipe(), os.pipe()
    far_in, far_out = os.fdopen(their_in), os.fdopen(their_out, "w")
    near_out, near_in = os.fdopen(to, "w"), os.fdopen(answers)
    thread = threading.Thread(target=serve, args=(devices, far_in, far_out), daemon=True)
    thread.start()
    try:
        yield devices_at(Line(near_out, near_in), lab)
    finally:
        near_out.close()
        thread.join(5.0)
        for one in (near_in, far_in, far_out):
            one.close()


def test_a_pipe_says_what_the_devices_say() -> None:
    lab, laboratory = bench()
    laboratory.frame(1.0)  # draws what every image needs, which may take long
    with piped(laboratory.devices(), lab) as devices:
        frame = devices.camera.frame(1.0)
        assert frame is not None
        assert frame.image.shape == (lab.camera.height_px, lab.camera.width_px)
        assert frame.time == pytest.approx(2.0 / 30.0)
        one = devices.manipulators["dual"]
        before = one.status()
        one.go(before.x + 100.0 * UM, before.y, 1e-3)
        one.lift(0.0)
        assert one.status().busy
        laboratory.wait(0.5)
        after = one.status()
        assert after == Status(x=before.x + 100.0 * UM, y=before.y, height=0.0, busy=False)
        one.stop()
        assert devices.clock.now() == laboratory.now()


def test_a_pipe_that_ends_or_talks_nonsense_is_a_device_that_fails() -> None:
    lab, _ = bench()
    import io

    for said in (
        "",
        "nonsense\n",
        "[1]\n",
        '{"error": "unplugged"}\n',
        '{"answer": {"number": 1}}\n',
    ):
        devices = devices_at(Line(io.StringIO(), io.StringIO(said)), lab)
        with pytest.raises(DeviceError):
            devices.camera.frame(1.0)


def test_an_image_and_a_stamp_survive_the_shapes_of_ros() -> None:
    image = np.arange(12, dtype=np.uint8).reshape(3, 4)
    message = image_message(Frame(number=1, time=12.25, image=image))
    assert message["header"]["stamp"] == {"sec": 12, "nanosec": 250_000_000}
    assert seconds_of(stamp_of(12.25)) == 12.25
    assert image_of(message).tolist() == image.tolist()
    padded = {**message, "step": 6, "data": np.pad(image, ((0, 0), (0, 2))).tobytes()}
    assert image_of(padded).tolist() == image.tolist()
    with pytest.raises(DeviceError, match="must be mono8"):
        image_of({**message, "encoding": "rgb8"})
    with pytest.raises(DeviceError, match="bytes for"):
        image_of({**message, "data": b"123"})


def test_a_pose_has_its_covariance_in_metres_and_radians() -> None:
    shown = replace(sight(1000.0, 0.0, 90.0), covariance=(4.0, 0.0, 0.0, 1.0, 0.0, 0.25))
    message = pose_message(shown, 1.5)
    assert message is not None
    pose = message["pose"]["pose"]
    assert pose["position"] == pytest.approx({"x": 1e-3, "y": 0.0, "z": 0.0})
    assert pose["orientation"]["z"] == pytest.approx(np.sqrt(0.5))
    covariance = np.array(message["pose"]["covariance"]).reshape(6, 6)
    assert covariance[0, 0] == pytest.approx(4e-12)
    assert covariance[5, 5] == pytest.approx(np.radians(0.5) ** 2)
    assert pose_message(replace(shown, pose=None), 1.5) is None


class Topics:
    """A node by hand: manipulators that are where they were last sent."""

    def __init__(self) -> None:
        self.sent: list[tuple[str, Mapping[str, Any]]] = []
        self.said: dict[str, Mapping[str, Any]] = {}

    def publish(self, topic: str, message: Mapping[str, Any]) -> None:
        self.sent.append((topic, message))

    def latest(self, topic: str) -> Mapping[str, Any] | None:
        return self.said.get(topic)

    def now(self) -> float:
        return 1.0


def test_devices_of_topics() -> None:
    lab, _ = bench()
    topics, image = Topics(), np.zeros((4, 5), np.uint8)
    devices = devices_by(lab, topics.latest, topics.publish, topics, lambda _: None)
    assert devices.camera.frame(0.1) is None
    topics.said["image"] = image_message(Frame(number=9, time=2.0, image=image))
    frame = devices.camera.frame(0.1)
    assert frame is not None
    assert frame.time == 2.0
    assert devices.camera.frame(0.1) is None  # the same one again
    one = devices.manipulators["dual"]
    with pytest.raises(DeviceError, match="no joint_states"):
        one.status()
    joints = {
        "name": ["height", "x", "y"],
        "position": [3.0, 1.0, 2.0],
        "velocity": [0.0, 0.0, 0.1],
    }
    topics.said["dual/joint_states"] = joints
    assert one.status() == Status(x=1.0, y=2.0, height=3.0, busy=True)
    one.go(0.5, 0.25, 1e-4)
    one.stop()
    assert topics.sent == [
        ("dual/target", {"position": {"x": 0.5, "y": 0.25, "z": 0.0}, "speed": 1e-4}),
        ("dual/stop", {}),
    ]


def test_the_calls_of_micromanager_reach_the_virtual_devices() -> None:
    pytest.importorskip("pymmcore_plus")
    from meso_robust.live.micromanager import devices_on
    from meso_robust.live.unicore import virtual_core

    lab, laboratory = bench(paced=True)
    core = virtual_core(laboratory, lab)
    try:
        devices = devices_on(core, lab, laboratory)
        frames = [devices.camera.frame(20.0) for _ in range(3)]
        found = [frame for frame in frames if frame is not None]
        assert len(found) == 3
        assert found[0].time < found[1].time < found[2].time < devices.clock.now()
        one = devices.manipulators["dual"]
        before = one.status()
        one.go(before.x - 50.0 * UM, before.y, 1e-3)
        one.lift(100.0 * UM)
        assert one.status().busy
        while one.status().busy:
            pass
        after = one.status()
        assert (after.x, after.height) == pytest.approx((before.x - 50.0 * UM, 100.0 * UM))
        one.go(before.x + 5000.0 * UM, before.y, 1e-4)
        one.stop()
        assert not one.status().busy
        with pytest.raises(InputError, match="no device 'Lamp'"):
            devices_on(core, lab.model_copy(update={"stage_label": "Lamp"}), laboratory)
    finally:
        core.stopSequenceAcquisition()
        core.unloadAllDevices()


def test_images_of_more_bits_are_shown_by_their_brightest() -> None:
    from meso_robust.live.micromanager import grey

    deep = np.array([[0, 4095], [2048, 1]], np.uint16)
    assert grey(deep).tolist() == [[0, 255], [128, 0]]
    assert grey(np.full((2, 2, 3), 7, np.uint8)).tolist() == [[7, 7], [7, 7]]
    with pytest.raises(DeviceError, match="must be grey"):
        grey(np.zeros((2, 2)))


def test_a_program_that_does_not_answer_is_still_told_to_lift(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from meso_robust.live import pipe

    monkeypatch.setattr(pipe, "PATIENCE", 0.05)
    lab, _ = bench()
    (their_in, to), (answers, _their_out) = os.pipe(), os.pipe()
    with os.fdopen(to, "w") as out, os.fdopen(answers) as into, os.fdopen(their_in) as heard:
        devices = devices_at(Line(out, into), lab)
        for call in (devices.clock.now, lambda: devices.manipulators["dual"].lift(3e-4)):
            with pytest.raises(DeviceError, match="no answer within"):
                call()
        assert '"now"' in heard.readline()
        assert '"lift"' in heard.readline()
    os.close(_their_out)


def test_an_answer_that_is_too_late_and_too_long_for_a_pipe_does_not_keep_a_lift_from_being_heard(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A program that is kept from writing its answer reads no question."""
    from meso_robust.live import pipe

    monkeypatch.setattr(pipe, "PATIENCE", 0.05)
    lab, laboratory = bench()
    noise = np.random.default_rng(1).integers(0, 256, (512, 512)).astype(np.uint8)
    told, lifted = threading.Event(), threading.Event()

    class Late:
        def frame(self, patience: float) -> Frame:
            told.wait(5.0)
            return Frame(number=1, time=0.0, image=noise)

    class Lifts:
        def __getattr__(self, name: str) -> Any:
            return lambda *_: lifted.set()

    theirs = replace(laboratory.devices(), camera=Late(), manipulators={"dual": Lifts()})
    (their_in, to), (answers, their_out) = os.pipe(), os.pipe()
    heard, says = os.fdopen(their_in), os.fdopen(their_out, "w")
    program = threading.Thread(target=serve, args=(theirs, heard, says), daemon=True)
    program.start()
    with os.fdopen(to, "w") as out, os.fdopen(answers) as into:
        devices = devices_at(Line(out, into), lab)
        with pytest.raises(DeviceError, match="no answer within"):
            devices.camera.frame(0.0)
        told.set()
        for _ in range(100):
            with pytest.raises(DeviceError, match="no answer within"):
                devices.manipulators["dual"].lift(3e-4)
            if lifted.wait(0.01):
                break
        assert lifted.is_set()
    program.join(5.0)
    heard.close()
    with suppress(BrokenPipeError):  # of what nobody read
        says.close()


def test_pipes_that_nobody_made_are_not_made(tmp_path: Path) -> None:
    lab, _ = bench()
    with pytest.raises(InputError, match="to_lab cannot be opened"), pipes_of(lab, tmp_path):
        pass
    (tmp_path / "to_lab").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="is no named pipe"), pipes_of(lab, tmp_path):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["to_lab"]
