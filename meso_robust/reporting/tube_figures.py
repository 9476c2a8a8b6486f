"""Pictures of what is certified, with what was simulated inside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from meso_robust.pipeline import Planned
from meso_robust.primitives.setup import PoseBox
from meso_robust.reporting.canvas import (
    CERTIFIED,
    CERTIFIED_FILL,
    COLUMN,
    GOAL,
    GOAL_FILL,
    INK,
    MISS,
    OPEN,
    OPEN_FILL,
    Coordinate,
    ends,
    poses_shown,
)
from meso_robust.reporting.plot import equal, limits
from meso_robust.reporting.reading import Standing, standings, thinned, through
from meso_robust.reporting.scene import (
    Boxes,
    Dots,
    Ends,
    Line,
    Look,
    Picture,
    Shape,
    Words,
    faces,
    panel,
    panel_and_strip,
    room,
)
from meso_robust.types import Floats

PATHS = 24  # simulated ones that are drawn through a tube
PANEL = (5.6, 3.9)  # inches
TALL = (5.6, 5.4)
GOLDEN = 0.5 * (5.0**0.5 - 1.0)  # multiples modulo one spread dots evenly, and alike every time
CERTIFIED_LOOK = Look(fill=CERTIFIED_FILL, line=CERTIFIED, width=1.3)
OPEN_LOOK = Look(fill=OPEN_FILL, line=OPEN, width=1.3, dash="3.9 2.6")
GOAL_LOOK = Look(fill=GOAL_FILL, line=GOAL, width=1.2)


def spread_figure(result: Planned, index: int) -> Picture:
    """Simulated poses after one move, and the box that must hold them.

    Parameters
    ----------
    result
        The plan.
    index
        Which move, from 0.
    """
    check, steps = result.check, result.chain.steps
    poses = poses_shown(check.sampled.moves[index].after[through(check, index)])
    post = steps[index].post if index < len(steps) else None
    boxes = [] if post is None else [post]
    plane, strip = [], []
    for box in boxes:
        plane.append(_box(result, index, box))
        strip.append(_band(plane[0], box))
    return panel_and_strip(
        *PANEL,
        *_limits(poses, boxes),
        [*plane, *_dots(poses, INK), *_nothing(poses, boxes)],
        [*strip, *_dots_of_strip(poses, INK)],
    )


def final_figure(result: Planned) -> Picture:
    """The last poses in the certified box in the goal."""
    check, goal, end = result.check, result.setup.goal, result.chain.end
    done = check.sampled.completed
    plane, boxes = [faces("goal box", [goal], "x", "y", GOAL_LOOK)], [goal]
    if end is not None:
        plane.append(_box(result, len(result.found.rules) - 1, end))
        boxes.append(end)
    final = poses_shown(check.sampled.final)
    hits, misses = final[done & check.in_goal], final[done & ~check.in_goal]
    x, y, theta = _limits(final[done], boxes)
    x, y = equal(np.array([x, y]).T, *room(*TALL, strip=True), 0.0)
    return panel_and_strip(
        *TALL,
        x,
        y,
        theta,
        [*plane, *_dots(hits, INK), *_dots(misses, MISS), *_nothing(final[done], boxes)],
        [
            *(_band(shape, box) for shape, box in zip(plane, boxes, strict=True)),
            *_dots_of_strip(hits, INK),
            *_dots_of_strip(misses, MISS),
        ],
    )


def tube_figure(result: Planned, index: int, up: Coordinate) -> Picture:
    """The certified tube of one move, slice by slice, and simulated paths through it.

    Parameters
    ----------
    result, index
        The plan, and which move, from 0.
    up
        What is drawn over x: ``"y"`` (um) or ``"theta"`` (deg).
    """
    check, step = result.check, result.chain.steps[index]
    slices = [knot.box for knot in step.tube]
    outer = [box for box in (step.pre, step.post) if box is not None]
    paths = poses_shown(thinned_paths(check.sampled.moves[index].path[through(check, index)]))
    lines, thin = paths[:, :, [0, COLUMN[up]]], Look(line=INK, width=0.45, opacity=0.55)
    tube = faces("tube slice", slices, "x", up, Look(fill=CERTIFIED_FILL))
    edges = faces("box", outer, "x", up, Look(line=CERTIFIED, width=1.3))
    seen = [*slices, step.pre]
    x = limits(_all(lines[..., 0], [ends(box, "x") for box in seen]))
    y = limits(_all(lines[..., 1], [ends(box, up) for box in seen]))
    drawn = [Line(name="path", points=line, look=thin) for line in lines]
    return panel(*PANEL, (x, y), [tube, *drawn, edges], up)


def thinned_paths(paths: Floats) -> Floats:
    """(PATHS, T, 3) evenly chosen paths, or all if there are fewer."""
    if len(paths) <= PATHS:
        return paths
    return paths[np.linspace(0, len(paths) - 1, PATHS).astype(np.int64)]


def has_tube(result: Planned, index: int) -> bool:
    """Whether the proof of a move kept more than one slice for drawing."""
    steps = result.chain.steps
    sound = standings(result.chain, len(result.found.rules))[index] is Standing.CERTIFIED
    return sound and len(steps[index].tube) > 1


def _box(result: Planned, index: int, box: PoseBox) -> Boxes:
    """The box after a move, as what is known of it."""
    sound = standings(result.chain, len(result.found.rules))[index] is Standing.CERTIFIED
    name, look = ("certified box", CERTIFIED_LOOK) if sound else ("unproved box", OPEN_LOOK)
    return faces(name, [box], "x", "y", look)


def _band(shape: Boxes, box: PoseBox) -> Boxes:
    """The same box in the strip."""
    return replace(shape, ends=np.array([[*ends(box, "theta"), -0.06, 1.06]]))


def _dots(poses: Floats, colour: str) -> Sequence[Dots]:
    """Scatter of x and y."""
    return _scatter(thinned(poses)[:, :2], colour)


def _dots_of_strip(poses: Floats, colour: str) -> Sequence[Dots]:
    """Scatter of theta with heights that only keep the dots apart."""
    theta = thinned(poses)[:, 2]
    heights = np.modf(GOLDEN * np.arange(1, len(theta) + 1))[0]
    return _scatter(np.stack([theta, heights], axis=1), colour)


def _scatter(points: Floats, colour: str) -> Sequence[Dots]:
    look = Look(fill=colour, opacity=0.6)
    return (Dots(name="runs", points=points, radius=0.85, look=look),) if len(points) else ()


def _nothing(poses: Floats, boxes: list[PoseBox]) -> Sequence[Shape]:
    """Words for axes that no run has got to."""
    if len(poses):
        return ()
    x, y, _ = _limits(poses, boxes)
    middle = np.array([0.5 * sum(x), 0.5 * sum(y)])
    return (Words(name="none", text="no run completed this move", point=middle, size=9.0),)


def _limits(poses: Floats, boxes: list[PoseBox]) -> tuple[Ends, Ends, Ends]:
    """Of x, y and theta, so that all runs and boxes are shown."""

    def of(side: Coordinate) -> Ends:
        return limits(_all(poses[:, COLUMN[side]], [ends(box, side) for box in boxes]))

    return of("x"), of("y"), of("theta")


def _all(values: Floats, sides: list[tuple[float, float]]) -> Floats:
    return np.concatenate([values.ravel(), np.array(sides, dtype=np.float64).ravel()])
