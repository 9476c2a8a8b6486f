"""How far the certified starts of a policy reach, and where the part can be after each move."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from meso_robust.bounds import HALF_PI, Verdict
from meso_robust.policy.cells import Cell, Policy, common, reads, sensed_poses, true_poses
from meso_robust.policy.cover import covered, ends_of, meet
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.task import Task
from meso_robust.units import metres, radians

SAMPLES = 20000  # for the share of a hull that is certified: a figure to read, not a proof


@dataclass(frozen=True, slots=True, kw_only=True)
class Region:
    """The certified starts near one orientation of the part."""

    near: float
    """rad"""
    cells: tuple[Cell, ...]
    extent: PoseBox
    """Hull of the cells."""
    share: float
    """Of the hull that the cells fill, estimated."""

    @property
    def moves(self) -> int:
        """Bound of the moves from here."""
        return max(cell.moves for cell in self.cells)


def region_of(policy: Policy) -> tuple[Region, ...]:
    """The certified starts of a policy.

    Parameters
    ----------
    policy
        Its cells.

    Returns
    -------
    tuple
        One region for each quarter turn that the part stands near, by rising angle.
    """
    goal = setup_of(policy.task).goal.theta.mid
    groups: dict[int, list[Cell]] = {}
    for cell in policy.cells:
        groups.setdefault(round((cell.sensed.theta.mid - goal) / HALF_PI.mid), []).append(cell)
    return tuple(
        _region(goal + quarter * HALF_PI.mid, tuple(groups[quarter])) for quarter in sorted(groups)
    )


def _region(near: float, cells: tuple[Cell, ...]) -> Region:
    extent = _hull(cell.sensed for cell in cells)
    lows, highs = ends_of([cell.sensed for cell in cells])
    low, high = extent.ends
    poses = np.random.default_rng(0).uniform(low, high, (SAMPLES, 3))
    held = np.zeros(SAMPLES, dtype=bool)
    for one_low, one_high in zip(lows, highs, strict=True):
        held |= ((one_low <= poses) & (poses <= one_high)).all(axis=1)
    return Region(near=near, cells=cells, extent=extent, share=float(held.mean()))


def _hull(boxes: Iterable[PoseBox]) -> PoseBox:
    return functools.reduce(PoseBox.hull, boxes)


@dataclass(frozen=True, slots=True, kw_only=True)
class Slice:
    """Where the part can be after some moves of the policy."""

    moves: int
    """Made so far."""
    boxes: tuple[PoseBox, ...]
    """True poses; those of runs that have ended before are not repeated."""
    to_go: int
    """Bound of the moves that are still needed."""


def sensed_start(task: Task) -> PoseBox:
    """The start as a task states it.

    Parameters
    ----------
    task
        The task.

    Returns
    -------
    PoseBox
        One sensed pose, enclosed, m and rad.
    """
    x, y, theta = task.start.x_um, task.start.y_um, task.start.theta_deg
    return PoseBox(x=metres(x), y=metres(y), theta=radians(theta))


def tube(policy: Policy, start: PoseBox) -> tuple[Slice, ...]:
    """The certified tube of all runs that start with a sensed pose, move by move.

    Parameters
    ----------
    policy, start
        The policy, and the poses that are sensed at the start.

    Returns
    -------
    tuple
        Where the part can be after 0, 1, 2 ... moves.

    Raises
    ------
    ValueError
        Some pose that can be sensed at the start may lie outside of the policy.
    """
    setup = setup_of(policy.task)
    boxes: tuple[PoseBox, ...] = (true_poses(start, setup),)
    ended: tuple[PoseBox, ...] = ()
    slices = []
    for made in range(policy.moves + 1):
        found: list[PoseBox] = []
        done: list[PoseBox] = []
        to_go = 0
        # what is sensed in one cell is moved alike: one box of it, or their number would grow with every move
        parts: dict[int, tuple[Cell, PoseBox]] = {}
        for box in boxes:
            for cell in _chosen(policy, sensed_poses(box, setup) if made else start):
                before = common(box, true_poses(cell.sensed, setup))
                known = parts.get(id(cell))
                parts[id(cell)] = cell, before if known is None else known[1].hull(before)
        for cell, before in parts.values():
            to_go = max(to_go, cell.moves)
            step = certify_move(cell.rule, before, setup)
            if step.verdict is not Verdict.PROVED or step.post is None:
                raise ValueError(f"the move of a certified cell is not proved from {before}")
            (done if cell.ends else found).append(common(step.post, cell.post))
        slices.append(Slice(moves=made, boxes=_merged([*boxes, *ended]), to_go=to_go))
        if not found and not done:
            break
        boxes, ended = _merged(found), tuple(done)
    return tuple(slices)


def _chosen(policy: Policy, sensed: PoseBox) -> list[Cell]:
    """Cells that can be the first one that holds a sensed pose of the box."""
    known = [] if policy.rest is None else [policy.rest]
    if any(reads(box, sensed) for box in known):
        return []
    found = []
    for cell in policy.cells:
        if meet(cell.sensed, sensed):
            found.append(cell)
            known.append(cell.sensed)
            # no pose is left for the cells that need more moves
            if reads(cell.sensed, sensed) or covered(sensed, known):
                return found
    return found


def _merged(boxes: list[PoseBox]) -> tuple[PoseBox, ...]:
    """Boxes that are not held by another one of them."""
    kept: list[PoseBox] = []
    for box in boxes:
        if not any(box.within(other) for other in kept):
            kept = [other for other in kept if not other.within(box)] + [box]
    return tuple(kept)
