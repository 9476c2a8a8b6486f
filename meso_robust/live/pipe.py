"""Devices behind a pair of pipes: JSON lines, a question out and an answer in.

The laboratory's own program reads one pipe and writes the other; both are files that it made (``mkfifo``), so
nothing is started here. `serve` is that program for devices that are at hand.
"""

from __future__ import annotations

import base64
import json
import os
import select
import stat
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import IO, Any

import cv2
import numpy as np

from meso_robust.errors import InputError
from meso_robust.live.devices import DeviceError, Devices, Frame, Status
from meso_robust.live.lab_file import Lab

PATIENCE = 10.0
"""s within which the program at the other end must answer."""
GAP, CHUNK = 0.05, 1 << 16
"""s between two pieces of an answer, and bytes of one, as a pipe holds them."""


class Line:
    """Asks and is answered."""

    def __init__(self, to: IO[str], answers: IO[str], patience: float | None = None) -> None:
        self._to, self._answers = to, answers
        self._patience = PATIENCE if patience is None else patience
        self._broken = ""

    def ask(self, **question: Any) -> Any:
        """The answer to a question; an error that it tells is raised.

        Once an answer has not come in time, questions are still written, so that a stop or a lift may be
        obeyed, but no answer is heeded: it could be another question's. They are taken from the pipe, as a program
        that cannot write its answer reads no question.
        """
        try:
            if self._broken:
                self._emptied()
            self._to.write(json.dumps(question, allow_nan=False) + "\n")
            self._to.flush()
            if not self._broken and not self._answered(question.get("patience_s", 0.0)):
                self._broken = f"{question['do']}: no answer within {self._patience:g} s"
            if self._broken:
                raise DeviceError(f"pipe: {self._broken}")
            line = self._answers.readline()
            values = json.loads(line) if line else {"error": "the pipe is closed"}
        except (OSError, ValueError) as error:
            raise DeviceError(f"pipe: {error}") from error
        if not isinstance(values, dict) or "error" in values:
            raise DeviceError(f"pipe: {question['do']}: {values}")
        return values.get("answer")

    def _answered(self, asked: float) -> bool:
        """Whether an answer begins to arrive in time; one that is at hand has."""
        try:
            source = self._answers.fileno()
        except OSError:  # a text in memory
            return True
        return bool(select.select([source], [], [], self._patience + asked)[0])

    def _emptied(self) -> None:
        """Take whatever has been answered, or is being, out of the pipe."""
        source = self._answers.fileno()
        while select.select([source], [], [], GAP)[0] and os.read(source, CHUNK):
            pass


class PipedCamera:
    """The camera at the other end."""

    def __init__(self, line: Line) -> None:
        self._line = line

    def frame(self, patience: float) -> Frame | None:
        """The newest frame."""
        values = self._line.ask(do="frame", patience_s=patience)
        if values is None:
            return None
        try:
            png = np.frombuffer(base64.b64decode(values["png"], validate=True), np.uint8)
            image = cv2.imdecode(png, cv2.IMREAD_GRAYSCALE)
            return Frame(
                number=int(values["number"]), time=float(values["time_s"]), image=_known(image)
            )
        except (KeyError, TypeError, ValueError, cv2.error) as error:
            raise DeviceError(f"pipe: a frame that cannot be read: {error}") from error


def _known(image: Any) -> Any:
    if image is None:
        raise ValueError("png: is no image")
    return image


class PipedManipulator:
    """A manipulator at the other end."""

    def __init__(self, line: Line, name: str) -> None:
        self._line, self._name = line, name

    def status(self) -> Status:
        """Where it says that it is."""
        values = self._line.ask(do="status", name=self._name)
        try:
            return Status(**values)
        except TypeError as error:
            raise DeviceError(f"pipe: {self._name}: {values}: {error}") from error

    def go(self, x: float, y: float, speed: float) -> None:
        """Begin a motion."""
        self._line.ask(do="go", name=self._name, x=x, y=y, speed=speed)

    def lift(self, height: float) -> None:
        """Begin to lift or lower."""
        self._line.ask(do="lift", name=self._name, height=height)

    def stop(self) -> None:
        """Stop."""
        self._line.ask(do="stop", name=self._name)


class PipedStage:
    """The stage at the other end."""

    def __init__(self, line: Line) -> None:
        self._line = line

    def place(self) -> tuple[float, float]:
        """Of the stage, m."""
        values = self._line.ask(do="place")
        try:
            x, y = values
            return float(x), float(y)
        except (TypeError, ValueError) as error:
            raise DeviceError(f"pipe: place: {values}: {error}") from error

    def stop(self) -> None:
        """Stop it."""
        self._line.ask(do="stop_stage")


class PipedClock:
    """The time at the other end."""

    def __init__(self, line: Line) -> None:
        self._line = line

    def now(self) -> float:
        """Seconds."""
        value = self._line.ask(do="now")
        try:
            return float(value)
        except (TypeError, ValueError) as error:
            raise DeviceError(f"pipe: now: {value}: {error}") from error


def devices_at(line: Line, lab: Lab) -> Devices:
    """The devices at the other end of a line.

    Parameters
    ----------
    line, lab
        The line, and the laboratory with the names of its manipulators.

    Returns
    -------
    Devices
        Nothing is asked yet.
    """
    return Devices(
        camera=PipedCamera(line),
        manipulators={one.name: PipedManipulator(line, one.name) for one in lab.manipulators},
        stage=PipedStage(line) if lab.stage_label else None,
        clock=PipedClock(line),
    )


@contextmanager
def piped(lab: Lab, folder: Path) -> Iterator[Devices]:
    """The devices at the other end of a laboratory's pipes.

    Parameters
    ----------
    lab, folder
        The laboratory, and where its pipes are.

    Yields
    ------
    Devices
        Ready.

    Raises
    ------
    InputError
        A pipe cannot be opened.
    """
    to, answers = (folder / name for name in lab.pipes)
    with ExitStack() as open_files:
        try:
            for path in (to, answers):
                if not stat.S_ISFIFO(path.stat().st_mode):
                    raise OSError(0, "is no named pipe", str(path))
            out = open_files.enter_context(to.open("w", encoding="utf-8"))
            into = open_files.enter_context(answers.open(encoding="utf-8"))
        except OSError as error:
            raise InputError(
                f"pipes = {list(lab.pipes)}: {error.filename} cannot be opened ({error.strerror}); start "
                "the program that answers, which makes them with mkfifo"
            ) from error
        yield devices_at(Line(out, into), lab)


def serve(devices: Devices, questions: Iterable[str], answers: IO[str]) -> None:
    """Answer questions about devices until there are no more.

    Parameters
    ----------
    devices
        What is asked about.
    questions, answers
        The other ends of the pipes.
    """
    for line in questions:
        try:
            told: dict[str, Any] = {"answer": _answer(devices, json.loads(line))}
        except (DeviceError, KeyError, TypeError, ValueError) as error:
            told = {"error": f"{type(error).__name__}: {error}"}
        try:
            answers.write(json.dumps(told, allow_nan=False) + "\n")
            answers.flush()
        except BrokenPipeError:  # who asked was killed meanwhile
            return


def _answer(devices: Devices, asked: dict[str, Any]) -> Any:
    what = asked["do"]
    if what == "now":
        return devices.clock.now()
    if what == "frame":
        return _told(devices.camera.frame(asked["patience_s"]))
    if what in ("place", "stop_stage"):
        if devices.stage is None:
            raise DeviceError("there is no stage")
        return devices.stage.place() if what == "place" else devices.stage.stop()
    one = devices.manipulators[asked["name"]]
    if what == "status":
        return asdict(one.status())
    if what == "go":
        return one.go(asked["x"], asked["y"], asked["speed"])
    if what == "lift":
        return one.lift(asked["height"])
    if what == "stop":
        return one.stop()
    raise DeviceError(
        f"do = {what!r}: must be now, frame, status, go, lift, stop, place or stop_stage"
    )


def _told(frame: Frame | None) -> dict[str, Any] | None:
    if frame is None:
        return None
    _, png = cv2.imencode(".png", frame.image, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    text = base64.b64encode(png.tobytes()).decode()
    return {"number": frame.number, "time_s": frame.time, "png": text}
