"""Where a manipulator's tips are in the world: it is sent to a grid of places, and the camera sees its tips.

The fit is linear: a tip at the manipulator's place u is at A u + b. What a place lies off the fit (steps
of the manipulator, backlash, bent axes) is part of the stated error as it is, not averaged away.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from scipy.stats import t as student

from meso_robust.live.calibration_file import (
    CalibrationDocument,
    MeasuredManipulator,
    TipPlace,
)
from meso_robust.live.devices import DeviceError, Devices, Frame
from meso_robust.live.lab_file import Lab, ManipulatorSection
from meso_robust.live.placing import check_within, tip_places
from meso_robust.live.sight import calibration_of
from meso_robust.tracking.needle import fit_needle
from meso_robust.tracking.probe_search import needle_at
from meso_robust.types import Floats

UM, DEG = 1e-6, math.pi / 180.0
GRID = 4
"""Places along each axis."""
FILLED = 0.6
"""Of the image that the grid fills, so that every tip is seen at every place."""
FRAMES = 4  # that are looked at in each place
WAIT = 30.0  # s for a motion
LEAST_CONTRAST = 4.0  # of film and needle, in standard deviations of what the fit leaves
SURE, SHOWN = 0.999, 0.95  # of the error that a task takes, and of the intervals
UNEVEN = 0.1
"""px that a fitted tip may be off by what the model of a needle leaves out."""
Told = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Seen:
    """A place at which all tips of a manipulator were seen."""

    own: Floats
    """(2,) where the manipulator said that it was, um."""
    tips: Mapping[str, Floats]
    """(2,) um, world frame, by name."""


def calibrate(devices: Devices, lab: Lab, told: Told = lambda *_: None) -> CalibrationDocument:
    """Calibrate all manipulators of a laboratory, one after the other, the others lifted.

    Parameters
    ----------
    devices, lab
        The laboratory, its axes and offsets right to about five pixels.
    told
        Called with a manipulator, the places that were seen, and how many there are.

    Returns
    -------
    CalibrationDocument
        Measured, with its uncertainty.

    Raises
    ------
    DeviceError
        A tip was not seen, or a manipulator does not obey; everything is lifted.
    PlacingError
        A place of the grid is beyond a manipulator's limits.
    """
    measured = {}
    try:
        for one in lab.manipulators:
            _lift_all(devices, lab)
            seen = _visited(devices, lab, one, told)
            measured[one.name] = fitted(seen, [tip.name for tip in one.tips], lab)
    finally:
        _lift_all(devices, lab)
    camera = lab.camera.position_error_um
    arrival = {one.name: one.arrival_um for one in lab.manipulators}
    worst = max(found.tip_error_um + arrival[name] for name, found in measured.items())
    return CalibrationDocument(
        camera_um=camera, probe_position_um=round(worst + camera, 4), manipulators=measured
    )


def _lift_all(devices: Devices, lab: Lab) -> None:
    for one in lab.manipulators:
        devices.manipulators[one.name].stop()
        devices.manipulators[one.name].lift(one.lifted_um * UM)
    for one in lab.manipulators:
        _rested(devices, one.name)


def _rested(devices: Devices, name: str) -> None:
    """Wait for the end of a motion; frames make the time pass."""
    began, machine = devices.clock.now(), time.monotonic()
    while devices.manipulators[name].status().busy:
        devices.camera.frame(0.1)
        if min(devices.clock.now() - began, time.monotonic() - machine) > WAIT:
            raise DeviceError(f"{name}: still moves after {WAIT:g} s")


def _visited(devices: Devices, lab: Lab, of: ManipulatorSection, told: Told) -> list[Seen]:
    places = grid(lab, of)
    for place in places:
        check_within(of, place)
    seen = []
    device = devices.manipulators[of.name]
    for k, (x, y) in enumerate(places):
        device.go(x * UM, y * UM, of.place_speed_um_s * UM)
        _rested(devices, of.name)
        device.lift(of.lowered_um * UM)
        _rested(devices, of.name)
        status = device.status()
        own = np.array([status.x, status.y]) / UM
        if math.dist(own, (x, y)) > of.arrival_um:
            raise DeviceError(f"{of.name}: stopped {math.dist(own, (x, y)):.1f} um short")
        seen.append(Seen(own=own, tips=_tips(devices, lab, of, own)))
        device.lift(of.lifted_um * UM)
        _rested(devices, of.name)
        told(of.name, k + 1, len(places))
    return seen


def grid(lab: Lab, of: ManipulatorSection) -> list[tuple[float, float]]:
    """Places at which all tips of a manipulator are in the image.

    Parameters
    ----------
    lab, of
        The laboratory, and the manipulator.

    Returns
    -------
    list
        On its own axes, um; every other row backwards, so that backlash shows.
    """
    camera = lab.camera
    offsets = np.array([tip.offset_um for tip in of.tips])
    room = np.array([camera.width_px, camera.height_px]) * camera.pixel_size_um
    room = FILLED * room - np.ptp(offsets, axis=0)
    middle = np.array(camera.centre_um) - 0.5 * (offsets.min(axis=0) + offsets.max(axis=0))
    share = np.linspace(-0.5, 0.5, GRID)
    back = np.linalg.inv(np.array(of.axes))
    found = []
    for k, y in enumerate(share):
        for x in share if k % 2 == 0 else share[::-1]:
            own = back @ (middle + np.array([x, y]) * room)
            found.append((float(own[0]), float(own[1])))
    return found


def _tips(devices: Devices, lab: Lab, of: ManipulatorSection, own: Floats) -> dict[str, Floats]:
    """Where the tips are seen, the mean of some frames."""
    frames: list[Frame] = []
    since, tried = devices.clock.now(), 0
    while len(frames) < FRAMES and tried < 20 * FRAMES:
        frame, tried = devices.camera.frame(0.5), tried + 1
        if frame is not None and frame.time > since:
            frames.append(frame)
    if not frames:
        raise DeviceError("the camera delivers no frames")
    stack = np.mean([frame.image for frame in frames], axis=0)
    calibration = calibration_of(lab.camera)
    found = {}
    for tip in of.tips:
        about = tip_places(of, (float(own[0]), float(own[1])))[tip.name]
        near = calibration.to_pixels(about * UM)
        radius = max(tip.radius_um, 1.0) / lab.camera.pixel_size_um
        direction = calibration.rotation - tip.direction_deg * DEG
        try:
            start = needle_at(np.rint(stack).astype(np.uint8), near, radius, direction)
            fit = fit_needle(stack, np.zeros(2), start)
        except (ValueError, cv2.error) as error:
            raise DeviceError(f"tip {tip.name}: {error}") from error
        off = float(np.hypot(*(np.array(fit.needle.tip) - near)))
        if fit.contrast < LEAST_CONTRAST or off > 12.0:
            raise DeviceError(
                f"tip {tip.name} is not seen at ({about[0]:.0f}, {about[1]:.0f}) um; correct axes and "
                "offset_um in the laboratory's file to about five pixels, and clear the field of view"
            )
        found[tip.name] = calibration.to_world(np.array(fit.needle.tip)) / UM
    return found


def fitted(seen: Sequence[Seen], names: Sequence[str], lab: Lab) -> MeasuredManipulator:
    """The linear fit of a manipulator's tips, and how well it is known.

    Parameters
    ----------
    seen
        N places.
    names
        T tips, whose offsets differ.
    lab
        With the size of a pixel.

    Returns
    -------
    MeasuredManipulator
        Intervals by Student's t; the error holds the fit's at the worst place, the largest that a place
        lies off, and what a fitted tip may be off by itself.
    """
    rows, targets = [], []
    for place in seen:
        for k, name in enumerate(names):
            rows.append([*place.own, *np.eye(len(names))[k]])
            targets.append(place.tips[name])
    design, places = np.array(rows), np.array(targets)
    found, *_ = np.linalg.lstsq(design, places, rcond=None)
    off = places - design @ found
    freedom = 2 * (len(design) - design.shape[1])
    scatter = math.sqrt(float(np.sum(off**2)) / freedom)
    spread = np.linalg.inv(design.T @ design)
    leverage = math.sqrt(float(np.max(np.einsum("ij,jk,ik->i", design, spread, design))))
    sure, shown = (float(student.ppf(0.5 + 0.5 * share, freedom)) for share in (SURE, SHOWN))
    wide = shown * scatter * np.sqrt(np.diag(spread))
    unseen = UNEVEN * lab.camera.pixel_size_um
    a = found[:2].T
    # of a travel of unit length in the world, across it as well as along it
    steepest = math.sqrt(float(np.linalg.eigvalsh(spread[:2, :2])[-1]))
    slope = sure * scatter * steepest / float(np.linalg.svd(a, compute_uv=False)[-1])
    return MeasuredManipulator(
        axes=((float(a[0, 0]), float(a[0, 1])), (float(a[1, 0]), float(a[1, 1]))),
        axes_error=((float(wide[0]), float(wide[1])), (float(wide[0]), float(wide[1]))),
        tips={
            name: TipPlace(
                offset_um=(float(found[2 + k, 0]), float(found[2 + k, 1])),
                offset_error_um=(float(wide[2 + k]), float(wide[2 + k])),
            )
            for k, name in enumerate(names)
        },
        tip_error_um=float(np.abs(off).max()) + sure * scatter * leverage + unseen,
        direction_error_deg=math.degrees(math.atan(slope)),
        scale_error_percent=100.0 * slope,
        scatter_um=math.sqrt(float(np.mean(off**2))),
        places=len(seen),
    )
