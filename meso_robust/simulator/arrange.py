"""A push arranged for the kernels: what they read and what they fill."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from meso_robust.kernels import maker, sealed
from meso_robust.simulator.case import (
    AHEAD,
    FILM,
    IDLE,
    INERTIA,
    LAW,
    LAY,
    SURFACE,
    UNIQUE,
    Case,
)
from meso_robust.simulator.environment import POST_RADIUS
from meso_robust.simulator.geometry import EXCESS, outlines, radii, reference_of_tracked
from meso_robust.simulator.motion_model import DYNAMIC
from meso_robust.simulator.outline import edge_table, quadrature, refuse, thickness
from meso_robust.simulator.push import Push
from meso_robust.simulator.record import PER_PROBE, PROBES, TIME
from meso_robust.simulator.scene import Scene
from meso_robust.simulator.support import INERTIA_TIME, NODE_SLOTS
from meso_robust.simulator.support_models import Tables
from meso_robust.simulator.tables import OBSTACLE_COLUMNS, OBSTACLES
from meso_robust.simulator.tips import Flat, Point
from meso_robust.simulator.touch import SPREAD, TIP
from meso_robust.types import Floats, Ints

_DEPTH = 20.0  # steps: what lies deeper than this is another side of the part
_NODES = 6  # cells along the part for effects that act on its whole area


class Inputs(NamedTuple):
    """A push as the kernels take it: the fields of `Case` with a leading length of 1 or N runs."""

    part: Floats
    """(1|N, V, 9)"""
    edges: Floats
    """(E, 9)"""
    size: Floats
    """(1|N,)"""
    depth: float
    obstacles: Floats
    """(1|N, O, OBSTACLE_COLUMNS)"""
    waypoints: Floats
    """(1|N, T, P, 2), or with the friction of the leg that starts there as a third number."""
    legs: Floats
    """(1|N, T, 2)"""
    law: Floats
    """(1|N, LAW)"""
    points: Floats
    """(1|N, K, 4)"""
    effects: Floats
    """(1|N, S)"""


class Outputs(NamedTuple):
    """Arrays the kernels fill."""

    poses: Floats
    """(N, 3), the poses at the start on entry."""
    outcomes: npt.NDArray[np.int8]
    """(N,)"""
    max_penetration: Floats
    """(N,)"""
    record: Floats
    """(N, R, 5 + 5 P) table of `record`, its times on entry."""


@sealed
def _of(i: int, length: int) -> int:
    """Row of run i in an array of 1 or N rows."""
    return i if length > 1 else 0


@maker
def case_of(i: int, inputs: Inputs) -> Case:
    """Pick one run."""
    scene = Scene(
        inputs.part[_of(i, inputs.part.shape[0])],
        inputs.edges,
        inputs.size[_of(i, inputs.size.shape[0])],
        inputs.depth,
    )
    return Case(
        scene,
        inputs.obstacles[_of(i, inputs.obstacles.shape[0])],
        inputs.waypoints[_of(i, inputs.waypoints.shape[0])],
        inputs.legs[_of(i, inputs.legs.shape[0])],
        inputs.law[_of(i, inputs.law.shape[0])],
        inputs.points[_of(i, inputs.points.shape[0])],
        inputs.effects[_of(i, inputs.effects.shape[0])],
    )


def inputs_of(push: Push, steps: Ints, unique: bool) -> Inputs:
    """What the kernels read of a push that has runs.

    ``steps`` (1|N, T − 1) are those of its legs; ``unique``: look for a second motion too.
    """
    table, tables = _effects(push), push.support.tables()
    outline = outlines(push.vertices, table) if push.effects.values else push.outlines
    edges, obstacles = _obstacles(push)
    return Inputs(
        edge_table(outline),
        edges,
        np.hypot(outline[..., 0], outline[..., 1]).max(axis=1),
        _depth(push, push.thickness),
        obstacles,
        _ways(push),
        _legs(push, steps),
        _law(push, tables, unique),
        _points(push, tables),
        table,
    )


def outputs_of(push: Push, instants: Floats | None) -> Outputs:
    """What the kernels fill; ``instants`` (1|N, R) are the times of the record, s."""
    runs, probes = len(push.poses), push.waypoints.shape[2]
    times = np.zeros((1, 0)) if instants is None else instants
    record = np.zeros((runs, times.shape[1], PROBES + PER_PROBE * probes))
    record[:, :, TIME] = times
    poses, table = push.poses, push.effects.table
    return Outputs(
        (reference_of_tracked(poses, table) if push.effects.values else poses).copy(),
        np.zeros(runs, dtype=np.int8),
        np.zeros(runs),
        record,
    )


def _effects(push: Push) -> Floats:
    """The table of effects, without the friction of a tip that the push does not have."""
    table = push.effects.table
    missing = table[:, TIP] >= push.waypoints.shape[2]
    if not np.any(missing):
        return table
    table = table.copy()
    table[missing, SPREAD], table[missing, TIP] = 0.0, 0.0
    table.flags.writeable = False  # as the table is: for another type the kernel is made again
    return table


def _depth(push: Push, thick: float) -> float:
    """Deepest penetration of a solid that is taken for one, m; deeper is another side of it."""
    return min(_DEPTH * push.step, 0.5 * thick)


def _ways(push: Push) -> Floats:
    """The waypoints, with the friction of each leg if it changes."""
    if push.friction.ndim == 2:
        return push.waypoints
    # nothing starts at the last waypoint
    friction = np.concatenate([push.friction, push.friction[:, -1:]], axis=1)[..., None]
    runs = max(len(friction), len(push.waypoints))
    way, mu = (np.broadcast_to(a, (runs, *a.shape[1:])) for a in (push.waypoints, friction))
    both = np.concatenate([way, mu], axis=3)
    both.flags.writeable = False  # as the waypoints are: for another type the kernel is made again
    return both


def _obstacles(push: Push) -> tuple[Floats, Floats]:
    """Edges of the probes' tips, of the fixture and of the unmodelled post, and their table."""
    effects = push.effects.table
    rows: list[Floats] = []
    ends = [0]
    for shape in push.shapes:
        rows.append(shape.edges(ends[-1]))
        ends.append(ends[-1] + len(rows[-1]))
    for outline in push.fixture.outlines:
        rows.append(edge_table(outline, ends[-1]))
        ends.append(ends[-1] + len(rows[-1]))
    post = push.effects.is_on(POST_RADIUS)
    if post:
        rows.append(Point().edges(ends[-1]))
        ends.append(ends[-1] + 1)
    probes = len(push.shapes)
    friction, radius = push.friction_of_legs[:, 0], _radii(push)
    runs = max(len(effects), len(friction), len(radius)) if len(friction) else 0
    table = np.zeros((runs, len(ends) - 1, OBSTACLE_COLUMNS))
    table[:, :, OBSTACLES.first], table[:, :, OBSTACLES.last] = ends[:-1], ends[1:]
    table[:, :probes, OBSTACLES.radius] = radius
    table[:, :probes, OBSTACLES.friction] = friction
    table[:, probes:, OBSTACLES.friction] = push.fixture.friction
    for p, shape in enumerate(push.shapes):
        table[:, p, OBSTACLES.depth] = (
            _depth(push, thickness(shape.corners)) if isinstance(shape, Flat) else 0.0
        )
    for k, outline in enumerate(push.fixture.outlines):
        table[:, probes + k, OBSTACLES.depth] = _depth(push, thickness(outline))
    if post:
        size = effects[:, POST_RADIUS]
        table[:, -1, OBSTACLES.radius] = size
        table[:, -1, OBSTACLES.friction] = friction[:, 0]
        # A post of no size is no post: far away from everything.
        away = np.where(size[:, None] > 0.0, effects[:, POST_RADIUS + 1 : POST_RADIUS + 3], 1e3)
        table[:, -1, OBSTACLES.x : OBSTACLES.y + 1] = away
    return np.concatenate(rows), table


def _radii(push: Push) -> Floats:
    if not push.effects.values:
        return push.radii_of_tips
    if push.effects.is_on(EXCESS) and any(isinstance(shape, Flat) for shape in push.shapes):
        refuse("effects.tip_radius", "a flat tip", "has no radius", "use Point or Round tips")
    radius = radii(push.radii_of_tips, push.effects.table)
    for row, probe in np.argwhere(radius < 0.0):
        value = f"probe {probe} of run {row} has a radius of {radius[row, probe]:g} m"
        refuse("effects.tip_radius", value, "must not be negative", "give a smaller deficit")
    return radius


def _legs(push: Push, steps: Ints) -> Floats:
    runs = max(len(push.times), len(steps))
    legs = np.zeros((runs, push.times.shape[1], 2))
    legs[..., 0], legs[:, :-1, 1] = push.times, steps
    return legs


def _law(push: Push, tables: Tables, unique: bool) -> Floats:
    times = push.effects.table[:, INERTIA_TIME]
    law = np.zeros((max(map(len, (tables.film, tables.surface, tables.lay, times))), LAW))
    law[:, FILM : FILM + 6] = tables.film
    law[:, LAY : LAY + 4] = tables.lay
    law[:, SURFACE : SURFACE + 6] = tables.surface
    law[:, INERTIA : INERTIA + 3] = push.motion.row()
    if push.effects.is_on(INERTIA_TIME):
        nodes = quadrature(push.outlines[0], _NODES)
        spread = nodes[:, 2] @ np.column_stack([np.sum(nodes[:, :2] ** 2, axis=1), nodes[:, :2]])
        law[:, INERTIA] = np.where(times > 0.0, DYNAMIC, 0.0)
        law[:, INERTIA + 1] = times
        law[:, INERTIA + 2 : INERTIA + 5] = times[:, None] * spread
    law[:, IDLE] = push.step
    law[:, UNIQUE] = unique
    law[:, AHEAD] = 0.5 if push.frame == "middle" else 0.0
    return law


def _points(push: Push, tables: Tables) -> Floats:
    """Dry points of the support, and nodes for effects on the whole area where there are any."""
    dry = np.concatenate([tables.points, np.zeros((*tables.points.shape[:2], 1))], axis=2)
    if not push.effects.is_on(*NODE_SLOTS):
        return np.ascontiguousarray(dry)
    # of many outlines the first: the film's matrix says how wide the nodes stand
    nodes = quadrature(push.outlines[0], _NODES)
    film = tables.film
    runs = max(len(film), len(dry))
    rows = np.zeros((runs, len(nodes), 4))
    rows[..., 3] = nodes[:, 2]
    rows[..., :2] = nodes[:, :2]
    if np.all(film[:, 0] > 0.0):
        # About the centre of drag, and as wide as the film's ratio of drags says.
        centre = np.column_stack([film[:, 4], -film[:, 2]]) / film[:, :1]
        own = nodes[:, :2] - nodes[:, 2] @ nodes[:, :2]
        spread = float(nodes[:, 2] @ np.sum(own**2, axis=1))
        ratio = film[:, 5] / film[:, 0] - np.sum(centre**2, axis=1)
        scale = np.sqrt(ratio / spread)
        rows[..., :2] = centre[:, None] + own * scale[:, None, None]
    return np.concatenate([dry * np.ones((runs, 1, 1)), rows], axis=1)
