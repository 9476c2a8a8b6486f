"""Uncertainties in the words and units of the task's file."""

from __future__ import annotations

import math
from fractions import Fraction

from meso_robust.task import Task
from meso_robust.wording import down, down_to, up


def widened(task: Task, name: str, times: float) -> str:
    """The range of one uncertainty widened about its middle, in the words of the task's file.

    Parameters
    ----------
    task, name
        The task, and the name of the uncertainty.
    times
        By how much; less than 1 narrows it.

    Returns
    -------
    str
        Rounded inward, with its unit.
    """
    ranges = ranges_of(task)
    if name in ranges:
        least, ends = ranges[name]
        low, high = map(_spelled, ends)
        middle, half = (low + high) / 2, (high - low) / 2 * Fraction(times)
        shown = max(float(up(middle - half, 3)), least), float(down(middle + half, 3))
        return f"{shown[0]:g} … {shown[1]:g}{unit_of(name)}"
    stated = errors_of(task)[name]
    return f"± {down_to(float(down(_spelled(stated) * Fraction(times), 3)), 15)}{unit_of(name)}"


_UNITS = {
    **dict.fromkeys(
        ("sensed_orientation", "misalignment", "squareness", "travel_direction"), " deg"
    ),
    **dict.fromkeys(("film_ratio", "travel_scale", "drag_anisotropy"), " %"),
    "friction": "",
}


def unit_of(name: str) -> str:
    """The unit of an uncertainty in the task's file, with a space before it.

    Parameters
    ----------
    name
        Of the uncertainty.

    Returns
    -------
    str
        Empty if it has none.
    """
    return _UNITS.get(name, " µm")


def ranges_of(task: Task) -> dict[str, tuple[float, tuple[float, float]]]:
    """Uncertainties that the file states as a range, with the least value that it can have.

    Parameters
    ----------
    task
        As stated.

    Returns
    -------
    dict
        By name, in the file's units.
    """
    u, probe, exact = task.uncertainty, task.probe, (0.0, 0.0)
    radius = probe.tip_radius_um or exact
    return {
        "friction": (-math.inf, u.friction),
        "misalignment": (-math.inf, u.tip_misalignment_deg),
        "tip_radius": (0.0, radius),
        "passive_tip_radius": (0.0, probe.passive_tip_radius_um or radius),
        "travel_direction": (-math.inf, u.travel_direction_deg or exact),
    }


def errors_of(task: Task) -> dict[str, float]:
    """Uncertainties that the file states by the largest error.

    Parameters
    ----------
    task
        As stated.

    Returns
    -------
    dict
        By name, in the file's units.
    """
    u, part = task.uncertainty, task.part
    return {
        "sensed_position": u.sensed_position_um,
        "sensed_orientation": u.sensed_orientation_deg,
        "probe_position": u.probe_position_um,
        "film_ratio": u.film_ratio_percent,
        "tip_spacing": task.probe.tip_spacing_tolerance_um or 0.0,
        "size": part.size_tolerance_um or 0.0,
        "squareness": part.squareness_deg or 0.0,
        "travel_scale": u.travel_scale_percent or 0.0,
        "drag_centre": u.drag_centre_um or 0.0,
        "drag_anisotropy": u.drag_anisotropy_percent or 0.0,
        "probe_wander": u.probe_wander_um or 0.0,
    }


def _spelled(value: float) -> Fraction:
    """The decimal that a number of the task stands for."""
    return Fraction(repr(float(value)))
