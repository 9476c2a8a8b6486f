"""What must hold of a laboratory before a plan is carried out in it: refused before anything moves."""

from __future__ import annotations

import math

import numpy as np

from meso_robust.errors import InputError
from meso_robust.live.lab_file import Lab, ManipulatorSection, TipSection
from meso_robust.live.sight import Trust
from meso_robust.planning.document import NAMES
from meso_robust.task import Task


def trust_of(task: Task) -> Trust:
    """How accurate a pose must be for a task.

    Parameters
    ----------
    task
        The task.

    Returns
    -------
    Trust
        Its stated errors of sensing.
    """
    u = task.uncertainty
    return Trust(position_um=u.sensed_position_um, orientation_deg=u.sensed_orientation_deg)


def check_lab(task: Task, lab: Lab, source: str) -> None:
    """Refuse a laboratory that does not keep what the task states of it.

    Parameters
    ----------
    task, lab
        Both as read.
    source
        Names the laboratory in messages.

    Raises
    ------
    InputError
        A tip's radius, place, spacing or misalignment is outside of what the task states, so that
        nothing is proved of this laboratory.
    """
    stated = task.uncertainty.probe_position_um
    for one in lab.manipulators:
        reached = one.tip_error_um + one.arrival_um
        if reached > stated * (1.0 + 1e-9):
            raise InputError(
                f"{source}: manipulator {one.name}: tips are known to tip_error_um + arrival_um = "
                f"{reached:.3g} um; the task states probe_position_um = {stated:g}; state at least "
                f"{reached:.3g} in the task and plan again, or calibrate better"
            )
        _check_travel(task, one, source)
        for tip in one.tips:
            _check_radius(task, tip, source)
        _check_pair(task, one, source)


def _check_travel(task: Task, of: ManipulatorSection, source: str) -> None:
    low, high = task.uncertainty.travel_direction_deg or (0.0, 0.0)
    turn, most = of.direction_error_deg, task.uncertainty.travel_scale_percent or 0.0
    if not low <= -turn <= turn <= high:
        raise InputError(
            f"{source}: manipulator {of.name}: direction_error_deg = {turn:.3g}; the task states "
            f"travel_direction_deg = [{low:g}, {high:g}]; state at least [{-turn:.3g}, {turn:.3g}] in the "
            "task and plan again, or calibrate better"
        )
    if not of.scale_error_percent <= most:
        raise InputError(
            f"{source}: manipulator {of.name}: scale_error_percent = {of.scale_error_percent:.3g}; the task "
            f"states travel_scale_percent = {most:g}; state at least {of.scale_error_percent:.3g} in the "
            "task and plan again, or calibrate better"
        )


def _check_radius(task: Task, tip: TipSection, source: str) -> None:
    active = task.probe.tip_radius_um or (0.0, 0.0)
    passive = task.probe.passive_tip_radius_um or active
    low, high = passive if tip.name == NAMES[2] else active
    if not low <= tip.radius_um <= high:
        rule = (
            "0, as the task is about point tips" if high == 0.0 else f"within [{low:g}, {high:g}]"
        )
        raise InputError(
            f"{source}: tip {tip.name}: radius_um = {tip.radius_um:g}: must be {rule}; state the radius of "
            "the tips in the task (probe.tip_radius_um, schema meso-robust/task/2) and plan again"
        )


def _check_pair(task: Task, of: ManipulatorSection, source: str) -> None:
    places = {tip.name: np.array(tip.offset_um) for tip in of.tips}
    if not {NAMES[0], NAMES[1]} <= set(places):
        return
    along = places[NAMES[0]] - places[NAMES[1]]
    spacing, stated = float(np.hypot(*along)), task.probe.tip_spacing_um
    off = abs(spacing - stated)
    most = task.probe.tip_spacing_tolerance_um or 0.0
    # one of two tips may be off its place by half of the difference, which the probe's error holds
    if off > most + of.arrival_um:
        raise InputError(
            f"{source}: manipulator {of.name}: its tips are {spacing:.2f} um apart; the task states "
            f"tip_spacing_um = {stated:g} +- {most:g}; state what was measured and plan again"
        )
    low, high = task.uncertainty.tip_misalignment_deg
    turn = math.degrees(math.atan2(float(along[1]), float(along[0])))
    skew = (turn + 45.0) % 90.0 - 45.0
    if not low <= skew <= high:
        raise InputError(
            f"{source}: manipulator {of.name}: the line through its tips is turned by {skew:.3f} deg; the "
            f"task states tip_misalignment_deg = [{low:g}, {high:g}]; turn the probe, or state it and plan"
        )
