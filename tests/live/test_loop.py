"""What surrounds the conductor: words, signals, and devices of a program that fails."""

from __future__ import annotations

import os
import signal
from typing import Any

import pytest

from meso_robust.live.devices import DeviceError, Devices, Status
from meso_robust.live.loop import Words, make_safe, stopped_by_signals
from tests.live.rig import lab


def test_the_last_word_counts_and_a_stop_for_ever() -> None:
    words = Words()
    assert words.take() == ""
    words.say("yes")
    words.say("no")
    assert [words.take(), words.take()] == ["no", ""]
    words.say("stop")
    words.say("yes")
    assert [words.take(), words.take()] == ["stop", "stop"]


def test_the_first_ctrl_c_stops_and_the_second_interrupts() -> None:
    words = Words()
    with stopped_by_signals(words):
        os.kill(os.getpid(), signal.SIGINT)
        assert words.take() == "stop"
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)


class Manipulator:
    """One whose axes fail in a way that no adapter should."""

    def __init__(self, fails: bool) -> None:
        self.fails, self.done = fails, list[str]()

    def stop(self) -> None:
        self.done.append("stop")
        if self.fails:
            raise RuntimeError("driver")

    def lift(self, height: float) -> None:
        self.done.append(f"lift to {height:g}")

    def go(self, x: float, y: float, speed: float) -> None:
        raise AssertionError("nothing is to be moved")

    def status(self) -> Status:
        if self.fails:
            raise DeviceError("driver")
        return Status(x=0.0, y=0.0, height=0.0, busy=False)


def test_a_program_that_fails_lifts_whatever_still_answers() -> None:
    made = {"dual": Manipulator(True), "single": Manipulator(False)}
    camera: Any = None
    make_safe(Devices(camera=camera, manipulators=made), lab())
    assert [one.done for one in made.values()] == [["stop", "lift to 0.0003"]] * 2
