"""The virtual laboratory behind µManager's core: pure-Python devices of pymmcore-plus's ``UniMMCore``.

The calls that reach them are the very ones that reach a microscope; see `meso_robust.live.micromanager`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from pymmcore_plus.experimental.unicore import (
    CameraDevice,
    StageDevice,
    UniMMCore,
    XYStageDevice,
    pymm_property,
)

from meso_robust.live.lab_file import Lab
from meso_robust.live.micromanager import MM, UM
from meso_robust.live.virtual import VirtualLaboratory, VirtualManipulator

WAIT = 1.0  # s of the laboratory's time in which a frame comes, if any does


class VirtualCamera(CameraDevice):
    """The camera of the virtual laboratory."""

    def __init__(self, laboratory: VirtualLaboratory, lab: Lab) -> None:
        super().__init__()
        self._laboratory, self._lab = laboratory, lab
        self._exposure = 10.0

    def get_exposure(self) -> float:
        """Milliseconds."""
        return self._exposure

    def set_exposure(self, exposure: float) -> None:
        """Milliseconds."""
        self._exposure = exposure

    def shape(self) -> tuple[int, int]:
        """Height and width, px."""
        return self._lab.camera.height_px, self._lab.camera.width_px

    def dtype(self) -> Any:
        """8 bits."""
        return np.uint8

    def start_sequence(
        self, n: int | None, get_buffer: Callable[[Sequence[int], Any], Any]
    ) -> Iterator[Mapping[str, Any]]:
        """Frame after frame."""
        taken = 0
        while n is None or taken < n:
            frame = self._laboratory.frame(WAIT)
            if frame is not None:
                get_buffer(self.shape(), np.uint8)[:] = frame.image
                taken += 1
                yield {"exposed_s": frame.time}


class VirtualAxes(XYStageDevice):
    """The axes of a virtual manipulator, or of the stage."""

    def __init__(self, device: VirtualManipulator) -> None:
        super().__init__()
        self._device, self._speed = device, 0.1

    @pymm_property(name="Speed", limits=(0.0, 10.0))
    def Speed(self) -> float:
        """Millimetres a second."""
        return self._speed

    @Speed.setter
    def _set_speed(self, value: float) -> None:
        self._speed = float(value)

    def set_position_um(self, x: float, y: float) -> None:
        """Begin to move."""
        self._device.go(x * UM, y * UM, self._speed * MM)

    def get_position_um(self) -> tuple[float, float]:
        """Where it is."""
        status = self._device.status()
        return status.x / UM, status.y / UM

    def busy(self) -> bool:
        """Whether it moves."""
        return self._device.status().busy

    def home(self) -> None:
        """Nothing: it knows where it is."""

    def stop(self) -> None:
        """Stop."""
        self._device.stop()

    def set_origin_x(self) -> None:
        """Nothing."""

    def set_origin_y(self) -> None:
        """Nothing."""


class VirtualLift(StageDevice):
    """The lift of a virtual manipulator."""

    def __init__(self, device: VirtualManipulator) -> None:
        super().__init__()
        self._device = device

    def set_position_um(self, val: float) -> None:
        """Begin to lift or lower."""
        self._device.lift(val * UM)

    def get_position_um(self) -> float:
        """Its height."""
        return self._device.status().height / UM

    def busy(self) -> bool:
        """Whether it moves."""
        return self._device.status().busy

    def home(self) -> None:
        """Nothing: it knows where it is."""

    def stop(self) -> None:
        """Stop."""
        self._device.stop()

    def set_origin(self) -> None:
        """Nothing."""


def virtual_core(laboratory: VirtualLaboratory, lab: Lab) -> UniMMCore:
    """A core with the devices of a virtual laboratory under the labels of its file.

    Parameters
    ----------
    laboratory, lab
        The laboratory, which must be paced: a core keeps the time of this machine.

    Returns
    -------
    UniMMCore
        Ready.
    """
    core = UniMMCore()
    core.loadPyDevice(lab.camera.label, VirtualCamera(laboratory, lab))
    for one in lab.manipulators:
        device = laboratory.manipulators[one.name]
        core.loadPyDevice(one.label or one.name, VirtualAxes(device))
        core.loadPyDevice(one.lift_label, VirtualLift(device))
    for label in core.getLoadedDevices():
        if label != "Core":
            core.initializeDevice(label)
    return core
