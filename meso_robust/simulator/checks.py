"""Checks of the inputs of a push, each with the argument, its value, the rule and what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from meso_robust.simulator.environment import FLOW_SLOTS
from meso_robust.simulator.fixture import Fixture
from meso_robust.simulator.geometry import outlines, radii, reference_of_tracked
from meso_robust.simulator.motion_model import FirstOrder, MotionModel, QuasiStatic
from meso_robust.simulator.outline import refuse, thickness
from meso_robust.simulator.support import FILM_SLOTS, INERTIA_TIME, LAYS, THINNING
from meso_robust.simulator.tips import Flat, Tip
from meso_robust.simulator.touch import EDGE, TIP
from meso_robust.types import Floats, Ints

if TYPE_CHECKING:
    from meso_robust.simulator.effects import Effects
    from meso_robust.simulator.support_models import Tables


MAX_PROBES = 6
"""Most probes in one move."""
MAX_STEPS = 10**8
"""Most steps in one move."""
THICK = 0.5
"""Longest step over the thinnest place of a solid."""
START_DEPTH = 0.05
"""Depth at the start, in steps, that counts as touching.

The part is left this deep in a tip, at most, by the linear steps of a move before; the first step
takes it back.
"""


def check_arrays(arrays: Mapping[str, Floats], shapes: int) -> None:
    """Refuse arrays of the wrong shape or with values that are not finite.

    Parameters
    ----------
    arrays
        The array fields of a push by name.
    shapes
        Number of tip shapes that are given, zero for none.

    Raises
    ------
    ValueError
        Naming the argument, its shape or value, and what it should be.
    """
    runs = arrays["poses"].shape[0] if arrays["poses"].ndim else 0
    way = arrays["waypoints"].shape
    points, probes = (way[1], way[2]) if len(way) == 4 else (0, 0)
    corners, legs = arrays["vertices"].shape, arrays["friction"].ndim == 3
    many = len(corners) == 3
    wanted: dict[str, tuple[tuple[int, ...], str]] = {
        "vertices": (
            (runs if many else corners[0], *corners[1:-1], 2) if corners else (0, 2),
            "(V, 2) or (1|N, V, 2)" if many else "(V, 2)",
        ),
        "poses": ((runs, 3), "(N, 3)"),
        "waypoints": ((runs, points, probes, 2), "(1|N, T, P, 2)"),
        "times": ((runs, points), "(1|N, T)"),
        "friction": (
            (runs, points - 1, probes) if legs else (runs, probes),
            "(N,), (1|N, P) or (1|N, T − 1, P)",
        ),
    }
    if arrays["radii"].size:
        wanted["radii"] = ((runs, probes), "(1|N, P)")
    for name, (shape, letters) in wanted.items():
        one = (1, *shape[1:]) if letters.find("1|N") >= 0 else shape
        if arrays[name].shape not in (shape, one):
            refuse(
                name,
                f"shape {arrays[name].shape}",
                f"must be {letters} with N runs as in poses and P probes as in waypoints",
                f"reshape it to {shape}",
            )
        if not np.all(np.isfinite(arrays[name])):
            where = tuple(int(k) for k in np.argwhere(~np.isfinite(arrays[name]))[0])
            value = f"{arrays[name][where]} at {where}"
            refuse(name, value, "must be finite", "remove the run or correct the value")
    if points < 2:
        refuse("waypoints", f"{points} instants", "must be at least 2", "give start and end")
    if not 1 <= probes <= MAX_PROBES:
        advice = "leave out the probes that stay away from the part"
        refuse("waypoints", f"{probes} probes", f"must be 1 to {MAX_PROBES}", advice)
    if shapes not in (0, probes):
        refuse(
            "shapes",
            f"{shapes} shapes",
            f"must be {probes}, one for each probe",
            "give all or none",
        )


def check_numbers(friction: Floats, times: Floats, step: float, time_step: float) -> None:
    """Refuse a negative friction, clocks that do not go on, and steps that are not positive.

    Parameters
    ----------
    friction
        (1|N, 1|T − 1, P) values of μ.
    times
        (1|N, T) in s.
    step
        Longest tip displacement of one step in m.
    time_step
        Longest duration of one step in s.

    Raises
    ------
    ValueError
        Naming the argument and the first wrong run.
    """
    for run, leg, probe in np.argwhere(friction < 0.0):
        value = f"run {run} has {friction[run, leg, probe]:g}"
        refuse("friction", value, "must not be negative", "give μ as a number such as 0.33")
    for run, k in np.argwhere(~(np.diff(times, axis=1) > 0.0)):
        value = f"run {run} goes from {times[run, k]:g} to {times[run, k + 1]:g} s"
        refuse("times", value, "must increase", "give every waypoint a later time")
    if not (np.isfinite(step) and step > 0.0):
        refuse("step", f"{step} m", "must be positive and finite", "try 1e-6 m")
    if not (np.isfinite(time_step) and time_step > 0.0):
        refuse("time_step", f"{time_step} s", "must be positive and finite", "try 0.02 s")


def check_radii(radii: Floats, shapes: Sequence[Tip]) -> None:
    """Refuse radii (1|N, P), m, that are negative, and those of tips that have none.

    Raises
    ------
    ValueError
        Naming the run and the tip.
    """
    for run, tip in np.argwhere(radii < 0.0):
        value = f"run {run} has {radii[run, tip]:g} m"
        refuse("radii", value, "must not be negative", "give 0 for a point")
    if radii.size and any(isinstance(shape, Flat) for shape in shapes):
        refuse("radii", "a flat tip", "has no radius", "leave the radii out")


def check_legs(legs: Ints, runs: int, most: int) -> None:
    """Refuse numbers of legs that are not those of the runs, or more than there are.

    Parameters
    ----------
    legs
        (1|N,) or none.
    runs, most
        N, and the legs of the move.

    Raises
    ------
    ValueError
        Naming the argument.
    """
    if not legs.size:
        return
    if legs.shape not in ((1,), (runs,)) or legs.dtype.kind not in "iu":
        refuse(
            "legs",
            f"{legs.dtype} of shape {legs.shape}",
            f"must be {runs} whole numbers, or one",
            "count them",
        )
    for run in np.flatnonzero((legs < 1) | (legs > most)):
        rule = f"must be 1 to {most}, the legs of the move"
        refuse("legs", f"run {run} has {legs[run]}", rule, "leave them out to go all")


def check_tables(tables: Tables, effects: Effects, runs: int) -> None:
    """Refuse tables made for another number of runs, and a support that does not do.

    Raises
    ------
    ValueError
        Naming the argument.
    """
    for name, array in (*zip(tables._fields, tables, strict=True), ("effects", effects.table)):
        if len(array) not in (1, runs):
            refuse(name, f"{len(array)} runs", f"must be 1 or {runs}, as in poses", "repeat it")
    film = tables.film[:, 0] > 0.0
    if runs and not (film.any() or tables.points[..., 2:].any() or tables.surface.any()):
        refuse("support", "no film and no dry contact", "must resist motion", "give a film")
    if runs and not film.all() and effects.is_on(*FILM_SLOTS, *FLOW_SLOTS, THINNING):
        on = ", ".join(effects.values)
        refuse("effects", on, "need a film where they change its drag", "give a Film or a Mixture")


def check_effects(effects: Effects, corners: int, motion: MotionModel) -> None:
    """Refuse effects that have no meaning for a part of so many corners that moves so.

    Raises
    ------
    ValueError
        If an edge does not exist or a tip has no number, if the lays of stage and part add up to a drag that is not
        positive, if the support is changed although the motion model has none, or if it has an inertia itself.
    """
    table = effects.table
    if effects.is_on(INERTIA_TIME) and not isinstance(motion, QuasiStatic):
        given = f"given with motion = {type(motion).__name__}"
        refuse("effects.inertia", given, "must be left out, as it has its own", "use QuasiStatic")
    edge = table[:, EDGE]
    for run in np.flatnonzero((edge % 1.0 != 0.0) | (edge >= corners)):
        refuse(
            "effects.edge_dependent_friction.edge",
            f"run {run} has {edge[run]:g}",
            f"must be a whole number below {corners}, the corners of the part",
            "count the edges from 0, by their first corner",
        )
    tip = table[:, TIP]
    for run in np.flatnonzero(tip % 1.0 != 0.0):
        rule = "must be a whole number"
        advice = "count the tips from 0, in the order of the waypoints"
        refuse("effects.friction_spread.tip", f"run {run} has {tip[run]:g}", rule, advice)
    for run in np.flatnonzero(np.abs(table[:, LAYS]).sum(axis=1) >= 1.0):
        refuse(
            "effects",
            f"the fractions of both lays of run {run} add up to 1 or more",
            "must leave a positive drag in every direction",
            "lower anisotropic_drag or part_anisotropic_drag",
        )
    if isinstance(motion, FirstOrder) and effects.is_on(*range(32), *FLOW_SLOTS):
        on = ", ".join(effects.values)
        refuse("effects", on, "need a support, and FirstOrder has none", "use Dynamic")


def check_steps(
    *, step: float, longest: float, time_step: float, steps: int, times: Floats
) -> None:
    """Refuse steps so short that the move would not end.

    Parameters
    ----------
    step, longest
        Longest step and longest displacement of a tip between two waypoints, m.
    time_step, times
        Longest step, and the instants of the waypoints, s.
    steps
        Steps of the move by both.

    Raises
    ------
    ValueError
        Naming the argument and the limit.
    """
    if not longest / step <= MAX_STEPS:
        refuse(
            "step",
            f"{step:g} m for a travel of {longest:g} m",
            f"must give at most {MAX_STEPS:g} steps",
            "give lengths in m and a longer step",
        )
    if not steps <= MAX_STEPS:
        refuse(
            "time_step",
            f"{time_step:g} s for {np.ptp(times):g} s",
            f"must give at most {MAX_STEPS:g} steps",
            "give times in s and a longer time step",
        )


def check_thickness(step: float, part: float, shapes: Sequence[Tip], fixture: Fixture) -> None:
    """Refuse steps that could carry a tip, or the part, through what they meet.

    Parameters
    ----------
    step
        Longest displacement of a tip in one step, m.
    part
        Thickness of the part, m.
    shapes, fixture
        What else they meet, as in `Push`.

    Raises
    ------
    ValueError
        Naming what is too thin, and the longest step that it allows.
    """
    solids = [(f"shapes[{p}]", s.corners) for p, s in enumerate(shapes) if isinstance(s, Flat)]
    solids += [(f"fixture.outlines[{k}]", o) for k, o in enumerate(fixture.outlines)]
    measured = [(name, thickness(corners)) for name, corners in solids]
    for name, thin in [("vertices", part), *measured]:
        if step > THICK * thin:
            refuse(
                "step",
                f"{step:g} m where {name} is {thin:g} m thick",
                f"must be at most {THICK:g} of it",
                f"give at most {THICK * thin:.3g} m",
            )


def check_start(
    poses: Floats,
    vertices: Floats,
    starts: Floats,
    shapes: Sequence[Tip],
    stated_radii: Floats,
    fixture: Fixture,
    effects: Effects,
    limit: float,
) -> None:
    """Refuse a part that starts inside a tip or inside the fixture.

    Parameters
    ----------
    poses, vertices, shapes, fixture, effects
        As in `Push`, checked.
    starts, stated_radii
        (1|N, P, 2) tips at the start, m, world frame, and (1|N, P) their radii, m.
    limit
        Depth in m up to which the part counts as touching.

    Raises
    ------
    ValueError
        Naming the run, the probe or solid, and the depth.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # lengths that overflow end out of range
        reference = reference_of_tracked(poses, effects.table)
        true, radius = outlines(vertices, effects.table), radii(stated_radii, effects.table)
        for p, shape in enumerate(shapes):
            start = np.broadcast_to(starts[:, p], (len(poses), 2))
            if isinstance(shape, Flat):
                depth = _overlap(true, reference, shape.corners, start)
            else:
                centres = in_body(reference, start)
                if _all_beside(true, centres, radius[:, p]):
                    continue
                depth = depth_inside(true, centres) + radius[:, p]
            _refuse_overlap("waypoints", f"probe {p}", depth, limit, "the part")
        for k, outline in enumerate(fixture.outlines):
            depth = _overlap(true, reference, outline, np.zeros_like(reference[:, :2]))
            _refuse_overlap("poses", "the part", depth, limit, f"fixture.outlines[{k}]")


def _all_beside(vertices: Floats, centres: Floats, radius: Floats) -> bool:
    """Whether all discs are beside the rectangle about all parts, by far the most frequent case."""
    low, high = vertices.min(axis=(0, 1)), vertices.max(axis=(0, 1))
    x, y = centres[:, 0], centres[:, 1]
    beside = (x < low[0] - radius) | (x > high[0] + radius)
    beside |= (y < low[1] - radius) | (y > high[1] + radius)
    return bool(beside.all())


def _refuse_overlap(argument: str, what: str, depth: Floats, limit: float, other: str) -> None:
    for run in np.flatnonzero(depth > limit):
        refuse(
            argument,
            f"{what} of run {run} starts {1e6 * depth[run]:.4g} µm inside {other}",
            "must start outside or touching",
            "move them apart",
        )


def in_body(poses: Floats, points: Floats) -> Floats:
    """(N, 2) world points in the body frames of (N, 3) poses."""
    offset = points - poses[:, :2]
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x = cos * offset[:, 0] + sin * offset[:, 1]
    return np.column_stack([x, cos * offset[:, 1] - sin * offset[:, 0]])


def _in_world(poses: Floats, points: Floats) -> Floats:
    """(N, V, 2) body points (1|N, V, 2) in the world, for each of (N, 3) poses."""
    cos, sin = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
    x = poses[:, :1] + cos * points[..., 0] - sin * points[..., 1]
    y = poses[:, 1:2] + sin * points[..., 0] + cos * points[..., 1]
    return np.stack([x, y], axis=2)


def depth_inside(vertices: Floats, points: Floats) -> Floats:
    """Depth of points inside an outline.

    Parameters
    ----------
    vertices
        (V, 2) corners, the solid on the left of the edges; or (1|N, V, 2).
    points
        (N, 2)

    Returns
    -------
    ndarray
        (N,) distance to the nearest edge, negative for points outside.
    """
    nearest = np.full(len(points), np.inf)
    enclosed = np.zeros(
        len(points), dtype=np.bool_
    )  # a ray along x crosses the outline oddly often
    corners = np.moveaxis(
        vertices, -2, 0
    )  # edge by edge, to keep the memory at a few numbers a point
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        edge = end - start
        length = np.hypot(edge[..., 0], edge[..., 1])
        tx, ty = edge[..., 0] / length, edge[..., 1] / length
        x, y = points[:, 0] - start[..., 0], points[:, 1] - start[..., 1]
        along = np.clip(ty * y + tx * x, 0.0, length)
        nearest = np.minimum(nearest, np.hypot(x - along * tx, y - along * ty))
        beside = edge[..., 0] * y - edge[..., 1] * x
        enclosed ^= ((y < 0.0) != (y < edge[..., 1])) & (beside * np.sign(edge[..., 1]) > 0.0)
    turn = corners[..., 0] * np.roll(corners[..., 1], -1, axis=0)
    turn = turn - corners[..., 1] * np.roll(corners[..., 0], -1, axis=0)
    free = turn.sum() < 0.0  # clockwise: the solid is outside
    return np.asarray(np.where(enclosed != free, nearest, -nearest))


def _overlap(vertices: Floats, poses: Floats, outline: Floats, origin: Floats) -> Floats:
    """(N,) depth of the part (1|N, V, 2) in a solid or of the solid in the part.

    By corners and crossings.
    """
    world = _in_world(poses, vertices) - origin[:, None]
    depth = np.full(len(poses), -np.inf)
    for k in range(vertices.shape[1]):
        depth = np.maximum(depth, depth_inside(outline, world[:, k]))
    for corner in outline:
        own = in_body(poses, corner + origin)
        depth = np.maximum(depth, depth_inside(vertices, own))
    crossing = np.zeros(len(poses), dtype=bool)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        crossing |= _crosses(world, np.roll(world, -1, axis=1), a, b)
    # Solids that cross although no corner of one is in the other are deep in each other.
    return np.asarray(np.where(crossing & (depth < 0.0), np.inf, depth))


def _crosses(start: Floats, end: Floats, a: Floats, b: Floats) -> npt.NDArray[np.bool_]:
    """(N,) whether a segment from a to b properly crosses any of (N, V) segments."""

    def side(p: Floats, q: Floats, r: Floats) -> Floats:
        u, v = q - p, r - p
        return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

    one = side(start, end, a) * side(start, end, b) < 0.0
    two = side(a, b, start) * side(a, b, end) < 0.0
    return np.asarray((one & two).any(axis=1))
