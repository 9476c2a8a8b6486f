"""The loop on devices: read everything, let the conductor decide, write it down, do it."""

from __future__ import annotations

import signal
import threading
import time
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from types import FrameType

import numpy as np

from meso_robust.live.conductor import Conductor
from meso_robust.live.devices import DeviceError, Devices, Frame
from meso_robust.live.exchange import Command, Place, Reading, Seen, Word
from meso_robust.live.journal import Journal, turn_of
from meso_robust.live.lab_file import Lab
from meso_robust.live.placing import tip_places
from meso_robust.live.sight import Eye, Sight
from meso_robust.types import Floats

UM = 1e-6
WAIT = 0.1
"""s that are waited for a frame before the devices are asked again."""


@dataclass(slots=True, kw_only=True, eq=False)
class Words:
    """What the user says while the loop runs, from wherever: a key, a signal, the page."""

    _word: Word = ""
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def say(self, word: Word) -> None:
        """Say something; a stop is never overruled."""
        with self._lock:
            if self._word != "stop":
                self._word = word

    def take(self) -> Word:
        """What was said since this was last asked."""
        with self._lock:
            word, self._word = self._word, ""
            return word


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Glimpse:
    """What there is to be shown after a turn."""

    frame: Frame | None
    sight: Sight | None
    conductor: Conductor
    commands: tuple[Command, ...]
    latency: float
    places: Mapping[str, Place]


Show = Callable[[Glimpse], object]


def run_loop(
    devices: Devices,
    lab: Lab,
    eye: Eye,
    conductor: Conductor,
    journal: Journal,
    words: Words,
    show: Show = lambda _: None,
) -> Command:
    """Run until it ends.

    Parameters
    ----------
    devices, lab
        The laboratory.
    eye
        Looks at the frames.
    conductor
        Decides.
    journal
        Keeps every turn.
    words
        What the user says meanwhile.
    show
        Called after every turn.

    Returns
    -------
    Command
        How it ended.
    """
    fault, latency = "", 0.0
    places: Mapping[str, Place] = {}
    try:
        while conductor.outcome is None:
            frame, sight, received, problem = _seen(devices, lab, eye, conductor, places)
            try:
                places = _places(devices)
                stage = None if devices.stage is None else devices.stage.place()
            except DeviceError as error:
                places, stage, fault = {}, None, fault or str(error)
            reading = Reading(
                time=devices.clock.now(),
                seen=None if frame is None or sight is None else _noted(frame, sight),
                places=places,
                stage_um=None if stage is None else (stage[0] / UM, stage[1] / UM),
                word=words.take(),
                fault=fault or problem,
                latency_s=latency,
            )
            turn, commands = turn_of(conductor, reading)
            journal.add(turn)
            fault = _carried_out(devices, commands)
            if frame is not None:
                latency = time.perf_counter() - received
            show(
                Glimpse(
                    frame=frame,
                    sight=sight,
                    conductor=conductor,
                    commands=commands,
                    latency=latency,
                    places=places,
                )
            )
    except BaseException:
        make_safe(devices, lab)
        raise
    return conductor.outcome


def make_safe(devices: Devices, lab: Lab) -> None:
    """Stop and lift everything that still answers.

    Parameters
    ----------
    devices, lab
        The laboratory.
    """
    for one in lab.manipulators:
        device = devices.manipulators.get(one.name)
        if device is not None:
            with suppress(DeviceError):
                device.stop()
            with suppress(DeviceError):
                device.lift(one.lifted_um * UM)


def _seen(
    devices: Devices, lab: Lab, eye: Eye, conductor: Conductor, places: Mapping[str, Place]
) -> tuple[Frame | None, Sight | None, float, str]:
    """The new frame, what it shows, when it came in, and what went wrong."""
    try:
        frame = devices.camera.frame(WAIT)
    except DeviceError as error:
        return None, None, 0.0, str(error)
    received = time.perf_counter()
    if frame is None:
        return None, None, received, ""
    return frame, eye.look(frame.image, lowered_tips(lab, conductor, places)), received, ""


def lowered_tips(lab: Lab, conductor: Conductor, places: Mapping[str, Place]) -> dict[str, Floats]:
    """Tips that are in the plane or on their way to it.

    Parameters
    ----------
    lab, conductor
        The laboratory, and what is being done.
    places
        Where the manipulators say that they are.

    Returns
    -------
    dict
        (2,) centres, um, world frame, by name.
    """
    down: dict[str, Floats] = {}
    for one in lab.manipulators:
        if one.name in conductor.lowered and one.name in places:
            place = places[one.name]
            down |= tip_places(one, (place.x_um, place.y_um))
    return down


def _noted(frame: Frame, sight: Sight) -> Seen:
    digest = zlib.crc32(np.ascontiguousarray(frame.image).data)
    return Seen(number=frame.number, time=frame.time, digest=digest, sight=sight)


def _places(devices: Devices) -> dict[str, Place]:
    found = {}
    for name, device in devices.manipulators.items():
        status = device.status()
        found[name] = Place(
            x_um=status.x / UM,
            y_um=status.y / UM,
            height_um=status.height / UM,
            busy=status.busy,
        )
    return found


def _carried_out(devices: Devices, commands: tuple[Command, ...]) -> str:
    """What a device did instead of obeying, or nothing; each command is given in any case."""
    fault = ""
    for command in commands:
        try:
            _do(devices, command)
        except DeviceError as error:
            fault = fault or str(error)
    return fault


def _do(devices: Devices, command: Command) -> None:
    if command.do == "halt":
        stopping = [*devices.manipulators.values()]
        failed = []
        for one in stopping:
            try:
                one.stop()
            except DeviceError as error:
                failed.append(error)
        if devices.stage is not None:
            devices.stage.stop()
        if failed:
            raise failed[0]
    elif command.do == "go":
        device = devices.manipulators[command.name]
        device.go(command.x_um * UM, command.y_um * UM, command.speed_um_s * UM)
    elif command.do == "lift":
        devices.manipulators[command.name].lift(command.height_um * UM)


@contextmanager
def stopped_by_signals(words: Words) -> Iterator[None]:
    """Let Ctrl-C and ``kill`` stop the loop, which then lifts the probes, instead of ending the program."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(_: int, __: FrameType | None) -> None:
        words.say("stop")

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
