"""Devices behind µManager's core (pymmcore-plus, extra ``lab``): the calls that microscope laboratories use.

XY stages carry the probes and single-axis stages lift them; the camera runs a sequence, of which the newest
image is taken. Positions of µManager are in um.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from meso_robust.errors import InputError
from meso_robust.live.devices import Clock, DeviceError, Devices, Frame, Status, WallClock
from meso_robust.live.lab_file import Lab, ManipulatorSection
from meso_robust.types import Image

_Answer = TypeVar("_Answer")
UM = 1e-6
MM = 1e-3
POLL = 0.002  # s between two questions for a frame


def _asked(what: str, call: Callable[..., _Answer], *given: object) -> _Answer:
    """What the core answers; its errors name the device."""
    try:
        return call(*given)
    except Exception as error:  # adapters raise whatever they like
        raise DeviceError(f"{what}: {error}") from error


class CoreCamera:
    """The core's camera, in a running sequence."""

    def __init__(self, core: Any, label: str, delay: float, clock: Clock) -> None:
        self._core, self._label, self._delay, self._clock = core, label, delay, clock
        self._number = 0
        _asked(label, core.setCameraDevice, label)
        _asked(label, core.startContinuousSequenceAcquisition, 0.0)

    def frame(self, patience: float) -> Frame | None:
        """The next image of the sequence; those that wait already are dropped, as none knows how old they are."""
        end = time.monotonic() + patience
        core = self._core
        while _asked(self._label, core.getRemainingImageCount) > 0:
            _asked(self._label, core.popNextImage)
        while _asked(self._label, core.getRemainingImageCount) == 0:
            if not _asked(self._label, core.isSequenceRunning):
                raise DeviceError(f"{self._label}: the camera has stopped by itself")
            if time.monotonic() > end:
                return None
            time.sleep(POLL)
        image = None
        while _asked(self._label, core.getRemainingImageCount) > 0:
            image = _asked(self._label, core.popNextImage)
        # few adapters stamp the exposure: it began no earlier than this, as the image arrived just now
        exposed = self._clock.now() - self._exposure() - self._delay
        self._number += 1
        return Frame(number=self._number, time=exposed, image=grey(np.asarray(image)))

    def _exposure(self) -> float:
        """Seconds."""
        return 1e-3 * float(_asked(self._label, self._core.getExposure))


def grey(image: np.ndarray[Any, np.dtype[Any]]) -> Image:
    """An image in 8 bits of grey.

    Parameters
    ----------
    image
        (H, W) or (H, W, 3 or 4) of whole numbers; 16-bit ones are shown by their brightest.

    Returns
    -------
    Image
        (H, W) uint8.

    Raises
    ------
    DeviceError
        It is nothing of the kind.
    """
    if image.ndim == 3 and image.shape[2] in (3, 4):
        image = image[..., :3].mean(axis=2).astype(image.dtype)
    if image.ndim != 2 or image.dtype.kind not in "ui":
        raise DeviceError(
            f"camera: an image of {image.dtype} {image.shape}; must be grey or colour"
        )
    if image.dtype == np.uint8:
        return np.ascontiguousarray(image)
    bits = max(int(image.max()).bit_length(), 8)
    return np.ascontiguousarray((image >> (bits - 8)).astype(np.uint8))


class CoreManipulator:
    """An XY stage that carries a probe, and the stage that lifts it."""

    def __init__(self, core: Any, of: ManipulatorSection) -> None:
        self._core, self._label, self._lift = core, of.label or of.name, of.lift_label
        self._speed, self._unit = of.speed_property, of.speed_unit_um_s * UM

    def status(self) -> Status:
        """Where it says that it is."""
        core = self._core
        x, y = _asked(self._label, core.getXYPosition, self._label)
        height = _asked(self._lift, core.getPosition, self._lift)
        busy = [_asked(one, core.deviceBusy, one) for one in (self._label, self._lift)]
        return Status(x=x * UM, y=y * UM, height=height * UM, busy=any(busy))

    def go(self, x: float, y: float, speed: float) -> None:
        """Set the speed, and begin a motion."""
        core = self._core
        if not _asked(self._label, core.hasProperty, self._label, self._speed):
            raise DeviceError(
                f"{self._label}: has no property {self._speed}; name the one that holds its speed by "
                "speed_property: the loop does not move what it cannot slow"
            )
        _asked(self._label, core.setProperty, self._label, self._speed, speed / self._unit)
        _asked(self._label, core.setXYPosition, self._label, x / UM, y / UM)

    def lift(self, height: float) -> None:
        """Begin to lift or lower."""
        _asked(self._lift, self._core.setPosition, self._lift, height / UM)

    def stop(self) -> None:
        """Stop both."""
        failed = []
        for label in (self._label, self._lift):
            try:
                _asked(label, self._core.stop, label)
            except DeviceError as error:
                failed.append(error)
        if failed:
            raise failed[0]


class CoreStage:
    """The microscope's stage."""

    def __init__(self, core: Any, label: str) -> None:
        self._core, self._label = core, label

    def place(self) -> tuple[float, float]:
        """Of the stage, m."""
        x, y = _asked(self._label, self._core.getXYPosition, self._label)
        return x * UM, y * UM

    def stop(self) -> None:
        """Stop it."""
        _asked(self._label, self._core.stop, self._label)


def devices_on(core: Any, lab: Lab, clock: Clock | None = None) -> Devices:
    """The devices of a laboratory on a core.

    Parameters
    ----------
    core
        A ``CMMCorePlus`` or ``UniMMCore`` with its devices loaded.
    lab
        Their labels.
    clock
        The laboratory's time; None: this machine's.

    Returns
    -------
    Devices
        The camera's sequence runs.

    Raises
    ------
    InputError
        The core has no device of a label.
    """
    loaded = set(core.getLoadedDevices())
    labels = [lab.camera.label, *([lab.stage_label] if lab.stage_label else [])]
    labels += [
        label for one in lab.manipulators for label in (one.label or one.name, one.lift_label)
    ]
    for label in labels:
        if label not in loaded:
            known = ", ".join(sorted(loaded - {"Core"})) or "none"
            raise InputError(f"lab.toml: no device {label!r} in µManager; the labels are {known}")
    times = WallClock() if clock is None else clock
    return Devices(
        camera=CoreCamera(core, lab.camera.label, 1e-3 * lab.camera.delay_ms, times),
        manipulators={one.name: CoreManipulator(core, one) for one in lab.manipulators},
        stage=CoreStage(core, lab.stage_label) if lab.stage_label else None,
        clock=times,
    )


@contextmanager
def connected(lab: Lab, folder: Path) -> Iterator[Devices]:
    """The devices of µManager's configuration file, released at the end.

    Parameters
    ----------
    lab
        Names the file and the labels.
    folder
        Where the file is.

    Yields
    ------
    Devices
        Ready.

    Raises
    ------
    InputError
        The extra is not installed, or the file or a label is wrong.
    """
    try:
        from pymmcore_plus import CMMCorePlus
    except ImportError as error:
        raise InputError(
            "backend = 'micromanager': needs pymmcore-plus; install meso-robust[lab]"
        ) from error
    core = CMMCorePlus()
    try:
        core.loadSystemConfiguration(str(folder / lab.config))
    except Exception as error:  # whatever an adapter raises
        raise InputError(f"{folder / lab.config}: {error}; check it in Micro-Manager") from error
    try:
        yield devices_on(core, lab)
    finally:
        with suppress(Exception):
            core.stopSequenceAcquisition()
        core.unloadAllDevices()
