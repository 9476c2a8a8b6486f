"""``lab.toml``: which devices a laboratory has, where they are, and what they must never do."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, model_validator

from meso_robust.toml_files import checked

SCHEMA: Literal["meso-robust/lab/1"] = "meso-robust/lab/1"

Pair = tuple[FiniteFloat, FiniteFloat]
Positive = Annotated[FiniteFloat, Field(gt=0, le=1e6)]
NotNegative = Annotated[FiniteFloat, Field(ge=0, le=1e6)]
Pixels = Annotated[int, Field(ge=16, le=20_000)]
Name = Annotated[str, Field(min_length=1, max_length=64)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class CameraSection(_Section):
    """The camera, and where it looks."""

    label: str = "Camera"
    """Name of the device."""
    width_px: Pixels
    """Width of the image, px."""
    height_px: Pixels
    """Height of the image, px."""
    pixel_size_um: Positive
    """Size of a pixel in the plane of the part, um."""
    centre_um: Pair = (0.0, 0.0)
    """[x, y] of the world at the middle of the image, um."""
    rotation_deg: FiniteFloat = 0.0
    """By which the camera is turned counter-clockwise in the world, deg."""
    k1: Annotated[FiniteFloat, Field(ge=-0.1, le=0.1)] = 0.0
    """Radial distortion half a diagonal from the middle."""
    delay_ms: NotNegative = 50.0
    """Longest time from the end of an exposure until µManager hands the image over, ms: an image counts as
    that much older."""
    position_error_um: NotNegative = 0.0
    """Largest error of a seen x or y by the camera's own calibration, um."""
    orientation_error_deg: NotNegative = 0.0
    """Largest error of a seen orientation by it, deg."""


class TipSection(_Section):
    """A tip that a manipulator carries."""

    name: Name
    """As in the plan: dtp_top, dtp_bottom, stp; or probe1 of an experiment."""
    offset_um: Pair
    """[x, y] of the world at which the tip's centre is while the manipulator is at its zero, um."""
    direction_deg: FiniteFloat
    """In which its shaft runs away from the tip, world frame, deg: there it hides what lies below."""
    radius_um: NotNegative
    """Of the tip, um; 0: a point."""


class ManipulatorSection(_Section):
    """A manipulator: two axes in the plane, and a lift."""

    name: Name
    """By which results call it."""
    label: str = ""
    """Name of the device of its axes; left out: the name."""
    lift_label: str = ""
    """Name of the device of its lift."""
    tips: Annotated[tuple[TipSection, ...], Field(min_length=1)]
    """What it carries."""
    axes: tuple[Pair, Pair] = ((1.0, 0.0), (0.0, 1.0))
    """Rows of the matrix from its own axes to the world's; `calibrate` measures it."""
    tip_error_um: NotNegative = 0.0
    """Largest error of a tip's x or y by the matrix and the offsets, um; `calibrate` measures it."""
    direction_error_deg: NotNegative = 0.0
    """Largest error of a travel's direction by the matrix, deg; `calibrate` measures it."""
    scale_error_percent: NotNegative = 0.0
    """Largest error of a travel's length by the matrix, %; `calibrate` measures it."""
    low_um: Pair
    """Least place on its own axes, um: no command goes beyond."""
    high_um: Pair
    """Largest place on its own axes, um."""
    lifted_um: FiniteFloat
    """Height at which its tips clear everything, um."""
    lowered_um: FiniteFloat = 0.0
    """Height at which its tips push, um."""
    height_error_um: Positive = 5.0
    """Largest difference from a height at which it counts as there, um."""
    max_speed_um_s: Positive
    """Largest speed that it may be given, um/s."""
    place_speed_um_s: Positive
    """Speed at which it is placed, lifted, um/s."""
    speed_property: str = "Speed"
    """Property of its axes' device in µManager that holds their speed."""
    speed_unit_um_s: Positive = 1000.0
    """Unit of that property, um/s: 1000 where it is mm/s, as in most adapters."""
    arrival_um: Positive = 1.0
    """Largest distance from a target at which it counts as there, um."""

    @model_validator(mode="after")
    def _makes_sense(self) -> Self:
        for low, high in zip(self.low_um, self.high_um, strict=True):
            if not low < high:
                raise ValueError(f"low_um = {self.low_um}: must be below high_um = {self.high_um}")
        (a, b), (c, d) = self.axes
        if not 0.25 < abs(a * d - b * c) < 4.0:
            raise ValueError(
                f"axes = {self.axes}: must be a matrix that turns or mirrors, of determinant about "
                "1 or -1; give rows [xx, xy], [yx, yy]"
            )
        if abs(self.lifted_um - self.lowered_um) <= 2.0 * self.height_error_um:
            raise ValueError(
                f"lifted_um = {self.lifted_um}: must differ from lowered_um = {self.lowered_um} by "
                "more than twice height_error_um"
            )
        if self.place_speed_um_s > self.max_speed_um_s:
            raise ValueError(
                f"place_speed_um_s = {self.place_speed_um_s}: must not exceed max_speed_um_s = "
                f"{self.max_speed_um_s}"
            )
        return self


class WatchSection(_Section):
    """When the loop gives up, lifts all probes and ends."""

    max_age_ms: Positive = 400.0
    """Largest age of the newest frame while anything moves, ms."""
    max_latency_ms: Positive = 1000.0
    """Largest time from a frame to the command that follows from it, ms."""
    patience_s: Positive = 10.0
    """Longest wait for a part that is seen and at rest, or for a lift, s."""
    still_frames: Annotated[int, Field(ge=2, le=100)] = 3
    """Frames in a row that must show the part at one place."""
    stage_error_um: Positive = 1.0
    """By how much the stage may be from where it was at the start, um."""


class VirtualSection(_Section):
    """The built-in virtual laboratory."""

    seed: Annotated[int, Field(ge=0)] = 0
    """Of everything that is drawn."""
    effects: Mapping[str, Mapping[str, FiniteFloat]] = {}
    """Effects of the catalogue that are at work, with their parameters."""
    faults: Mapping[str, FiniteFloat] = {}
    """What goes wrong, and when, s; see `meso_robust/live/virtual.py`."""
    part: tuple[FiniteFloat, FiniteFloat, FiniteFloat] | None = None
    """x_um, y_um, theta_deg of the part; left out: drawn from the task's start."""
    hidden: bool = False
    """Whether axes and offsets truly differ from those that this file states, for `calibrate` to find."""
    frame_rate_hz: Positive = 30.0
    """Of the camera, Hz."""
    paced: bool = False
    """Whether the time of the laboratory goes as fast as that of this machine, and not faster."""


class Lab(_Section):
    """``lab.toml``."""

    schema_: Annotated[Literal["meso-robust/lab/1"], Field(alias="schema")] = SCHEMA
    """Name and version of the format."""
    backend: Literal["micromanager", "pipe", "virtual"]
    """What the devices are reached by."""
    config: str = ""
    """µManager's configuration file, beside this one."""
    pipes: tuple[str, str] = ("to_lab", "from_lab")
    """Of a pipe: the named pipes of questions and of answers, beside this file."""
    calibration: str = ""
    """What `calibrate` wrote, beside this file; in place of axes, offset_um and tip_error_um."""
    camera: CameraSection
    """The camera."""
    stage_label: str = ""
    """Name of the stage's device, if it has one."""
    watch: WatchSection = WatchSection()
    """The watchdog."""
    manipulators: Annotated[tuple[ManipulatorSection, ...], Field(min_length=1)]
    """The manipulators."""
    virtual: VirtualSection = VirtualSection()
    """Of the virtual laboratory."""

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        for what, names in (
            ("manipulators", [one.name for one in self.manipulators]),
            ("tips", [tip.name for one in self.manipulators for tip in one.tips]),
        ):
            if len(set(names)) < len(names):
                raise ValueError(f"{what}: {', '.join(names)}: give each name once")
        return self


def parse_lab(values: Mapping[str, Any], source: str) -> Lab:
    """A laboratory from plain values.

    Parameters
    ----------
    values
        As read from TOML.
    source
        Names the file in messages.

    Returns
    -------
    Lab
        Checked.

    Raises
    ------
    InputError
        A key is unknown or missing, or a value breaks its rule.
    """
    return checked(Lab, values, source, whole="the laboratory", keys="meso-robust schema lab")
