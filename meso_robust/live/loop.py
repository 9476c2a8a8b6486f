"""The loop on devices: read everything, let the conductor decide, write it down, do it."""

from __future__ import annotations

import signal
import threading
import time
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from types import FrameType

import numpy as np

from meso_robust.live.conductor import Conductor
from meso_robust.live.devices import DeviceError, Devices, Frame
from meso_robust.live.exchange import Command, Place, Reading, Seen, Word
from meso_robust.live.filming import Film
from meso_robust.live.journal import Journal, turn_of
from meso_robust.live.lab_file import Lab
from meso_robust.live.placing import tip_places
from meso_robust.live.sight import Eye, Sight
from meso_robust.types import Floats

UM = 1e-6
WAIT = 0.1
"""s that are waited for a frame before the devices are asked again."""
LIFT_WAIT = 5.0
"""s that a program which fails waits for the lifts before it lets the devices go."""


@dataclass(slots=True, kw_only=True, eq=False)
class Words:
    """What the user says while the loop runs, from wherever: a key, a signal, the page."""

    _stopped: bool = False
    _answers: SimpleQueue[Word] = field(default_factory=SimpleQueue)

    def say(self, word: Word) -> None:
        """Say something; a stop is never overruled."""
        # no lock: a signal may come while this very thread is within `take`
        if word == "stop":
            self._stopped = True
        else:
            self._answers.put(word)

    def take(self) -> Word:
        """The last that was said since this was asked; from a stop on always that."""
        word: Word = ""
        with suppress(Empty):
            while True:
                word = self._answers.get_nowait()
        return "stop" if self._stopped else word


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
    film: Film | None = None,
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
    film
        Keeps every frame; None: they are not kept.

    Returns
    -------
    Command
        How it ended.
    """
    fault, latency = "", 0.0
    places: Mapping[str, Place] = {}
    clock = _Time(devices)
    try:
        while conductor.outcome is None:
            frame, sight, received, problem = _seen(devices, lab, eye, conductor, places)
            try:
                places = _places(devices)
                stage = None if devices.stage is None else devices.stage.place()
            except DeviceError as error:
                places, stage, fault = {}, None, fault or str(error)
            now, silent = clock.now()
            reading = Reading(
                time=now,
                seen=None if frame is None or sight is None else _noted(frame, sight),
                places=places,
                stage_um=None if stage is None else (stage[0] / UM, stage[1] / UM),
                word=words.take(),
                fault=fault or problem or silent,
                latency_s=latency,
            )
            turn, commands = turn_of(conductor, reading)
            if film is not None and frame is not None:
                film.add(len(journal.turns) + 1, frame)
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
        if not conductor.dry:
            make_safe(devices, lab)
        raise
    return conductor.outcome


class _Time:
    """The laboratory's time, which goes on by this machine's clock where it is not told."""

    def __init__(self, devices: Devices) -> None:
        self._clock = devices.clock
        self._last, self._machine = 0.0, time.monotonic()

    def now(self) -> tuple[float, str]:
        """The time, s, and why it is not the laboratory's."""
        machine, problem = time.monotonic(), ""
        try:
            told = self._clock.now()
        except DeviceError as error:
            told, problem = self._last + machine - self._machine, str(error)
        self._last, self._machine = told, machine
        return told, problem


def make_safe(devices: Devices, lab: Lab) -> None:
    """Stop and lift everything that still answers, and wait until it is lifted, but not for ever.

    Parameters
    ----------
    devices, lab
        The laboratory.
    """
    lifted = []
    for one in lab.manipulators:
        device = devices.manipulators[one.name]
        # whatever a device does instead of obeying, the others are still to be lifted
        with suppress(Exception):
            device.stop()
        with suppress(Exception):
            device.lift(one.lifted_um * UM)
            lifted.append(device)
    end = time.monotonic() + LIFT_WAIT
    with suppress(Exception):
        while time.monotonic() < end and any(device.status().busy for device in lifted):
            time.sleep(0.01)


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
    """Let Ctrl-C and ``kill`` stop the loop, which then lifts the probes, instead of ending the program.

    A second one interrupts whatever the loop waits for, such as a device that does not answer; then the
    probes are lifted without it.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    asked = False

    def stop(_: int, __: FrameType | None) -> None:
        nonlocal asked
        if asked:
            raise KeyboardInterrupt
        asked = True
        words.say("stop")

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
