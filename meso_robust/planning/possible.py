"""Tasks that no plan can do, told before anything is searched."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator

import numpy as np

from meso_robust.errors import InputError
from meso_robust.even_film import RATIO, corners_of, even_film, remarks as film_remarks
from meso_robust.primitives.setup import setup_of
from meso_robust.primitives.walls import stands_clear
from meso_robust.task import Goal, Slot, Task
from meso_robust.types import Floats
from meso_robust.units import DEG

# of the goal that are looked at, before some pose of it is taken to be clear of the walls
_PIECES = 4000
Pose = tuple[float, float, float]
"""um, um, rad; or half of the widths of a box of them."""


def refuse_impossible(task: Task) -> None:
    """Refuse a task that no plan can do, whatever is searched.

    Parameters
    ----------
    task
        As stated.

    Raises
    ------
    InputError
        The part may lie in a wall at its start, it does in every pose of the goal, or no part has such a
        film under it.
    """
    _refuse_film(task)
    if task.slot is None:
        return
    if not stands_clear(setup_of(task)):
        start, errors = task.start, task.uncertainty
        raise InputError(
            f"task {task.name!r}: key start: at ({start.x_um:g} um, {start.y_um:g} um, {start.theta_deg:g} deg), "
            f"known to {errors.sensed_position_um:g} um and {errors.sensed_orientation_deg:g} deg, the part "
            "may touch a wall of the slot; it must be clear of all walls; start further outside"
        )
    if _blocked(task.slot, task.goal, _corners(task)):
        raise InputError(
            f"task {task.name!r}: key goal: the part overlaps a wall of the slot, {task.slot.width_um:g} um wide "
            f"and {task.slot.depth_um:g} um deep, in every pose of the goal; it must fit in one of them; widen or "
            "move the slot, or move the goal"
        )


def _refuse_film(task: Task) -> None:
    known, most = task.uncertainty, even_film(corners_of(task)).largest_um2
    least = known.film_ratio_um2 * (1.0 - known.film_ratio_percent / 100.0)
    if least > most:
        raise InputError(
            f"task {task.name!r}: key {RATIO}: {known.film_ratio_um2:g} um^2; must be no more than {most:.6g} um^2, "
            "what drag at the corner farthest from the origin alone would have; "
            "`meso-robust identify` measures it"
        )


def remarks(task: Task, fitted: Collection[str] = ()) -> tuple[str, ...]:
    """What is unusual about a task: what leaves few plans or none, and a film that is not even.

    Parameters
    ----------
    task
        As it is planned for.
    fitted
        Keys of the task whose values are a fitted model's, not the user's.

    Returns
    -------
    tuple of str
        A line each, with what to do about it.
    """
    said = []
    corners = _corners(task)
    longest = float(np.hypot(*(np.roll(corners, -1, axis=0) - corners).T).max())
    spacing = task.probe.tip_spacing_um
    if spacing > longest:
        said.append(
            f"probe.tip_spacing_um = {spacing:g}: wider than every edge of the part, the longest of which has "
            f"{longest:.6g} um: no two tips push on one edge; set them closer"
        )
    least, placed = task.goal.position_tolerance_um, task.uncertainty.probe_position_um
    if least < placed and task.slot is None:
        said.append(
            f"goal.position_tolerance_um = {least:g}: finer than the probes are placed, probe_position_um = "
            f"{placed:g}, which a part ends beside at best; widen the goal, or calibrate the probes"
        )
    if (
        task.goal.theta_deg
        and _is_quarter(task.start.theta_deg)
        and _is_quarter(task.goal.theta_deg)
    ):
        said.append(
            f"start.theta_deg = {task.start.theta_deg:g}, goal.theta_deg = {task.goal.theta_deg:g}: quarter "
            "turns in rad; angles are in degrees"
        )
    return (*said, *film_remarks(task, fitted))


def _is_quarter(angle: float) -> bool:
    """Whether an angle would be a whole number of quarter turns, to within a degree, if it were in rad."""
    quarters = 2.0 * angle / math.pi
    return abs(quarters - round(quarters)) < 1.0 / 90.0


def _corners(task: Task) -> Floats:
    """(V, 2) of the part, um."""
    return np.array([[float(x), float(y)] for x, y in corners_of(task)])


def _blocked(slot: Slot, goal: Goal, corners: Floats) -> bool:
    """Whether the part overlaps a wall in every pose of the goal; of one with notches that is left open."""
    edges = np.roll(corners, -1, axis=0) - corners
    if np.any(_cross(edges, np.roll(edges, -1, axis=0)) < 0.0):
        return False
    walls = [
        np.array([[float(x), float(y)] for x in wall[:2] for y in wall[2:]])
        for wall in slot.blocks_um
    ]
    middle = (goal.x_um, goal.y_um, goal.theta_deg * DEG)
    wide = (
        goal.position_tolerance_um,
        goal.position_tolerance_um,
        goal.orientation_tolerance_deg * DEG,
    )
    left, looked = [(middle, wide)], 0
    while left and looked < _PIECES:
        pose, half = left.pop()
        looked += 1
        depth = max(_overlap(corners, pose, wall) for wall in walls)
        if depth <= 0.0:
            return False
        far = np.hypot(*corners.T).max() + np.hypot(*(np.vstack(walls) - pose[:2]).T).max()
        moves = (half[0], half[1], 2.0 * far * half[2])  # by how much depths may change
        if depth <= math.hypot(*moves[:2]) + moves[2]:
            left += _halves(pose, half, int(np.argmax(moves)))
    return not left


def _halves(pose: Pose, half: Pose, axis: int) -> Iterator[tuple[Pose, Pose]]:
    less = [0.5 * wide if k == axis else wide for k, wide in enumerate(half)]
    for sign in (-1.0, 1.0):
        middle = [at + sign * less[k] if k == axis else at for k, at in enumerate(pose)]
        yield (middle[0], middle[1], middle[2]), (less[0], less[1], less[2])


def _overlap(corners: Floats, pose: Pose, wall: Floats) -> float:
    """By how much a convex part and a wall (4, 2) overlap along the axis on which they do least, um."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    part = corners @ np.array([[c, s], [-s, c]]) + pose[:2]
    edges = np.roll(part, -1, axis=0) - part
    normals = np.column_stack([edges[:, 1], -edges[:, 0]]) / np.hypot(*edges.T)[:, None]
    axes = np.vstack([np.eye(2), normals])
    own, other = part @ axes.T, wall @ axes.T
    both = np.minimum(own.max(axis=0) - other.min(axis=0), other.max(axis=0) - own.min(axis=0))
    return float(both.min())


def _cross(one: Floats, other: Floats) -> Floats:
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
