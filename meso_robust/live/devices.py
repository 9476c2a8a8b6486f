"""What a laboratory must have: a camera, manipulators that lift, a clock; SI units.

Calls that move return at once; whether a motion has ended is asked. Nothing here knows of parts or plans.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from meso_robust.types import Image


class DeviceError(Exception):
    """A device does not answer, or not as it should; the message names it and what it said."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frame:
    """An image and when it was taken."""

    number: int
    """Counts the frames of the camera."""
    time: float
    """Of the exposure, s, on the laboratory's clock."""
    image: Image
    """(H, W) uint8, grey."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Status:
    """Where a manipulator says that it is; its own axes, m."""

    x: float
    y: float
    height: float
    busy: bool


class Camera(Protocol):
    """Delivers frames."""

    def frame(self, patience: float) -> Frame | None:
        """The newest frame that was not yet delivered; None if there is none within ``patience``, s."""


class Manipulator(Protocol):
    """Moves one or more tips in its own axes, and lifts them out of the plane."""

    def status(self) -> Status:
        """Where it is, and whether it moves."""

    def go(self, x: float, y: float, speed: float) -> None:
        """Begin a straight motion to a place, m and m/s."""

    def lift(self, height: float) -> None:
        """Begin to lift or lower to a height, m."""

    def stop(self) -> None:
        """Stop every motion at once."""


class Stage(Protocol):
    """The microscope's stage: it carries the slide, and must rest while a plan is carried out."""

    def place(self) -> tuple[float, float]:
        """Where it is, m."""

    def stop(self) -> None:
        """Stop it."""


class Clock(Protocol):
    """The laboratory's time."""

    def now(self) -> float:
        """S."""


class WallClock:
    """The time of this machine."""

    def now(self) -> float:
        """S since some instant."""
        return time.monotonic()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Devices:
    """The devices of a laboratory."""

    camera: Camera
    manipulators: Mapping[str, Manipulator]
    """By the names in the laboratory's file."""
    stage: Stage | None = None
    clock: Clock = field(default_factory=WallClock)
