"""Recordings in memory, in SI, frozen."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, NoReturn, TypeAlias, get_args

import numpy as np

from meso_robust.recordings.outline import Polygon, Rectangle
from meso_robust.recordings.rules import clock_fault, file_fault, probe_fault, twice_fault
from meso_robust.types import Floats

PositionSource: TypeAlias = Literal["controller", "camera"]
"""Where the positions of the probes are from: commanded, or seen in the images."""


_DEVIATIONS = (
    "position_sigma",
    "orientation_sigma",
    "tip_sigma",
    "tip_offset",
    "tip_offset_across",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorInfo:
    """What is known of the camera and the tracker that made a set.

    Attributes
    ----------
    frame_rate
        Frames a second, in Hz.
    position_sigma
        Standard deviation of x and of y in m; None where it is unknown.
    orientation_sigma
        Standard deviation of θ in rad; None where it is unknown.
    tip_sigma
        Standard deviation in m of x and of y of a tip in the controller's log; None where it is
        unknown, to be estimated from straight travel.
    tip_offset
        Standard deviation in m of x and of y of what a tip is away from where it is said to be throughout a
        recording, and otherwise in the next: how well a manipulator finds a place, or, of a seen tip, what
        every frame's has in common. None: a log is taken at its word, and a seen tip is off as the part is.
    tip_offset_across
        Likewise across `Recording.tip_directions`, along which `tip_offset` then is: the end of a needle is seen
        several times worse along it than across. None: as much in all directions.

    Raises
    ------
    ValueError
        If the rate is not positive, a deviation is negative, or a number is not finite.
    """

    frame_rate: float
    position_sigma: float | None = None
    orientation_sigma: float | None = None
    tip_sigma: float | None = None
    tip_offset: float | None = None
    tip_offset_across: float | None = None

    def __post_init__(self) -> None:
        """Check the fields."""
        if not 0.0 < self.frame_rate < math.inf:
            rule = "must be positive and finite"
            _refuse("frame_rate", f"{self.frame_rate} Hz", rule, "try 30 Hz")
        for name in _DEVIATIONS:
            value = getattr(self, name)
            if value is not None and not 0.0 <= value < math.inf:
                rule = "must be finite and not negative"
                _refuse(name, f"{value}", rule, "give None where it is unknown")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recording:
    """One recording: T instants of a part and P probes; NaN is "not seen".

    Arrays are copied to float64 and made read-only.

    Attributes
    ----------
    file
        Name of its file in the folder of the set.
    probe_names
        P names, in the order of the arrays.
    times
        (T,) instants in s, strictly increasing; lost frames may be missing.
    poses
        (T, 3) x, y of the reference point in m and θ in rad, world frame; θ may wrap.
    probes
        (T, P, 2) centres of the tips in m, world frame.
    forces
        (T, P, 2) forces at the probes in N, world frame; None if no force was recorded.
    alike_orientations
        Number of orientations in which the part looks the same and among which none was chosen: θ is
        right up to a whole turn over it. 1 where θ is sure.
    tip_directions
        P angles in rad, world frame: of each tip the direction in which its place is known least, along its
        needle; half a turn does not matter. None: no direction is told from another.

    Raises
    ------
    ValueError
        If a name, a shape or the clock breaks its rule, or a value is infinite.
    """

    file: str
    probe_names: tuple[str, ...]
    times: Floats
    poses: Floats
    probes: Floats
    forces: Floats | None = None
    alike_orientations: int = 1
    tip_directions: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        """Copy, freeze and check the fields."""
        if self.alike_orientations < 1:
            rule = "must be at least 1"
            _refuse(
                "alike_orientations", f"{self.alike_orientations}", rule, "give 1 where θ is sure"
            )
        _check_names(self.file, self.probe_names)
        for name in ("times", "poses", "probes", "forces"):
            if getattr(self, name) is not None:
                array = np.array(getattr(self, name), dtype=np.float64)
                array.flags.writeable = False
                object.__setattr__(self, name, array)
        self._check_shapes()
        if self.tip_directions is not None:
            self._check_directions(self.tip_directions)
        fault = clock_fault(self.times)
        if fault:
            raise ValueError(f"times[{fault[0]}]: {fault[1]}")
        for name in ("poses", "probes", "forces"):
            if getattr(self, name) is not None and np.any(np.isinf(getattr(self, name))):
                _refuse(name, "infinite", "must be finite or NaN", "give NaN where not seen")

    def _check_directions(self, angles: tuple[float, ...]) -> None:
        if len(angles) != len(self.probe_names) or not all(map(math.isfinite, angles)):
            rule = f"must be {len(self.probe_names)} finite angles, one of each probe"
            _refuse("tip_directions", f"{angles}", rule, "give None where they are unknown")

    def _check_shapes(self) -> None:
        rows, tips = self.times.size, len(self.probe_names)
        shapes = {"times": (rows,), "poses": (rows, 3), "probes": (rows, tips, 2)}
        if self.forces is not None:
            shapes["forces"] = (rows, tips, 2)
        for name, shape in shapes.items():
            found = getattr(self, name).shape
            if found != shape:
                rule = f"must be {shape}, as there are {rows} instants and {tips} probes"
                _refuse(name, f"shape {found}", rule, "reshape it")
        if not rows:
            _refuse(
                "times",
                f"no instants in {self.file}",
                "must be at least one",
                "leave the recording out",
            )
        if self.forces is not None and not tips:
            _refuse("forces", "no probes", "belong to probes", "give None")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RecordingSet:
    """Recordings of one part with one kind of tip and one sensor.

    Attributes
    ----------
    part
        The outline of the part; ``part.outline`` has its corners.
    tip_radius
        Radius of the tips in m.
    position_source
        Where the positions of the probes are from.
    sensor
        The camera and the tracker.
    recordings
        At least one, each with a file of its own.

    Raises
    ------
    ValueError
        If a field breaks its rule.
    """

    part: Rectangle | Polygon
    tip_radius: float
    position_source: PositionSource
    sensor: SensorInfo
    recordings: tuple[Recording, ...]

    def __post_init__(self) -> None:
        """Check the fields."""
        if not 0.0 <= self.tip_radius < math.inf:
            rule = "must be finite and not negative"
            _refuse("tip_radius", f"{self.tip_radius} m", rule, "give 0 for a point")
        if self.position_source not in get_args(PositionSource):
            rule = f"must be one of {', '.join(get_args(PositionSource))}"
            _refuse("position_source", repr(self.position_source), rule, "change it")
        if not self.recordings:
            _refuse("recordings", "none", "must be at least one", "add one")
        fault = twice_fault([recording.file for recording in self.recordings])
        if fault:
            raise ValueError(f"recordings: file {fault}")


def unwrapped(recording: Recording) -> Recording:
    """The recording with θ made continuous: no step from one seen θ to the next exceeds π.

    Instants where θ was not seen stay NaN and are passed over. A true turn of more than π between
    two seen angles cannot be distinguished from a wrap.
    """
    poses = recording.poses.copy()
    seen = np.isfinite(poses[:, 2])
    poses[seen, 2] = np.unwrap(poses[seen, 2])
    return replace(recording, poses=poses)


def _check_names(file: str, probe_names: tuple[str, ...]) -> None:
    fault = file_fault(file)
    if fault:
        raise ValueError(f"file: {fault}")
    faults = [*map(probe_fault, probe_names), twice_fault(probe_names)]
    for fault in filter(None, faults):
        raise ValueError(f"probe_names: {fault}")


def _refuse(argument: str, value: str, rule: str, advice: str) -> NoReturn:
    raise ValueError(f"{argument}: {value}; {rule}; {advice}")
