"""Where manipulators must go so that their tips are where a move wants them, and where tips then are."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from meso_robust.live.lab_file import Lab, ManipulatorSection
from meso_robust.types import Floats

Place = tuple[float, float]


class PlacingError(Exception):
    """A move that the manipulators cannot make; the message says which rule it breaks."""


def tip_places(of: ManipulatorSection, own: Place) -> dict[str, Floats]:
    """Centres of the tips while the manipulator is at a place.

    Parameters
    ----------
    of
        The manipulator.
    own
        Its place on its own axes, um.

    Returns
    -------
    dict
        (2,) um, world frame, by name.
    """
    moved = np.array(of.axes) @ np.array(own)
    return {tip.name: moved + np.array(tip.offset_um) for tip in of.tips}


def target(of: ManipulatorSection, wanted: Mapping[str, Place]) -> tuple[Place, float]:
    """Where a manipulator must go.

    Parameters
    ----------
    of
        The manipulator.
    wanted
        Centres of some of its tips, um, world frame.

    Returns
    -------
    tuple
        Its place on its own axes, um, at which the tips lie best; and the largest distance of a tip
        from where it is wanted then, um.
    """
    at_zero = {tip.name: np.array(tip.offset_um) for tip in of.tips}
    shifts = [np.array(place) - at_zero[name] for name, place in wanted.items()]
    shift = np.mean(shifts, axis=0)
    own = np.linalg.solve(np.array(of.axes), shift)
    off = max(float(np.hypot(*(one - shift))) for one in shifts)
    return (float(own[0]), float(own[1])), off


def check_within(of: ManipulatorSection, own: Place) -> None:
    """Refuse a place beyond a manipulator's limits.

    Parameters
    ----------
    of, own
        The manipulator, and the place on its own axes, um.

    Raises
    ------
    PlacingError
        It is beyond them.
    """
    for axis, value, low, high in zip("xy", own, of.low_um, of.high_um, strict=True):
        if not low <= value <= high:
            raise PlacingError(
                f"{of.name}: {axis} = {value:.1f} um is outside its limits [{low:g}, {high:g}] um"
            )


def carriers(lab: Lab, names: Sequence[str]) -> dict[str, ManipulatorSection]:
    """Which manipulator carries each of some tips.

    Parameters
    ----------
    lab, names
        The laboratory, and the tips.

    Returns
    -------
    dict
        By the tip's name.

    Raises
    ------
    PlacingError
        None does.
    """
    by_tip = {tip.name: one for one in lab.manipulators for tip in one.tips}
    for name in names:
        if name not in by_tip:
            raise PlacingError(f"no manipulator carries {name}; the tips are {', '.join(by_tip)}")
    return {name: by_tip[name] for name in names}


def distance_from_line(point: Place, start: Place, end: Place) -> float:
    """Distance of a point from a segment, in its unit.

    Parameters
    ----------
    point, start, end
        In one frame.

    Returns
    -------
    float
        Not negative.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    square = dx * dx + dy * dy
    along = (point[0] - start[0]) * dx + (point[1] - start[1]) * dy
    share = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    return math.hypot(point[0] - start[0] - share * dx, point[1] - start[1] - share * dy)
