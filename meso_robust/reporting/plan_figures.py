"""Pictures of the plan: one panel a move, and the whole way from start to goal."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from meso_robust import units
from meso_robust.laboratory.making import outline as outline_of_part
from meso_robust.laboratory.running import MoveRun
from meso_robust.pipeline import Planned
from meso_robust.planning.document import names_of
from meso_robust.reporting.canvas import (
    AFTER,
    BEFORE,
    CERTIFIED,
    GHOST,
    GOAL,
    GOAL_FILL,
    INK,
    MUTED,
    OPEN,
    TIP,
    corners,
    poses_shown,
)
from meso_robust.reporting.plot import equal
from meso_robust.reporting.reading import Standing, standings
from meso_robust.reporting.scene import (
    Arrow,
    Boxes,
    Dots,
    Line,
    Look,
    Picture,
    Shape,
    Words,
    faces,
    panel,
    room,
)
from meso_robust.reporting.theme import PAPER, WALL
from meso_robust.types import Floats

GHOSTS = 4  # outlines between the first and the last
PANEL = (5.6, 4.3)  # inches
WIDE = (11.6, 4.9)


def ghost_rows(length: int) -> tuple[int, ...]:
    """Rows of a recorded path at which the part is drawn, evenly spaced, both ends left out."""
    return tuple(int(row) for row in np.linspace(0, length - 1, GHOSTS + 2).round()[1:-1])


def goal_pose(result: Planned) -> Floats:
    """(3,) middle of the goal, m and rad."""
    return np.array(result.setup.goal.mid)


def move_figure(result: Planned, index: int) -> Picture:
    """One move of the nominal run, in um.

    Parameters
    ----------
    result
        The plan.
    index
        Which move, from 0.
    """
    move, body = result.check.nominal.moves[index], outline_of_part(result.setup)
    path, last = move.path[0], index + 1 == len(result.found.rules)
    goal_box, goal_outline = _goal(result, body) if last else ((), ())
    tips = _reached(move)
    drawn = [corners(pose, body) for pose in (move.before[0], *path, move.after[0])]
    if last:
        drawn.append(corners(goal_pose(result), body))
    extent = np.concatenate([*drawn, tips])
    extent = np.concatenate([extent, _room_for_names(move, extent)])
    return panel(
        *PANEL,
        equal(extent, *room(*PANEL), 0.06),
        [
            *goal_box,
            _outline("before", move.before[0], body, BEFORE, 1.3),
            *(_outline("ghost", path[row], body, GHOST, 0.8) for row in ghost_rows(len(path))),
            _outline("after", move.after[0], body, AFTER, 1.5),
            *goal_outline,
            _centre_path(path),
            *_box_after(result, index),
            *_tips(move),
            *_names_of_tips(move, names_of(result.found.rules[index])),
        ],
    )


def overview_figure(result: Planned) -> Picture:
    """The way of the part from the start to the goal, in um."""
    body, moves = outline_of_part(result.setup), result.check.nominal.moves
    goal_box, goal_outline = _goal(result, body)
    poses = [moves[0].before[0], *(move.after[0] for move in moves)]
    strength = np.linspace(0.4, 1.0, len(poses)).tolist()
    drawn = np.concatenate([corners(pose, body) for pose in (*poses, goal_pose(result))])
    return panel(
        *WIDE,
        equal(drawn, *room(*WIDE), 0.03),
        [
            *goal_box,
            *(
                _outline(f"pose {number}", pose, body, AFTER, 1.2, opacity)
                for number, (pose, opacity) in enumerate(zip(poses, strength, strict=True))
            ),
            *_slot(result),
            *goal_outline,
            _centre_path(np.concatenate([move.path[0] for move in moves])),
            *(
                Words(
                    name="pose", text=str(number), point=poses_shown(pose)[:2], size=8.0, disc=6.5
                )
                for number, pose in enumerate(poses)
            ),
        ],
    )


def _outline(
    name: str, pose: Floats, body: Floats, colour: str, width: float, opacity: float = 1.0
) -> Line:
    look = Look(line=colour, width=width, opacity=opacity)
    return Line(name=name, points=corners(pose, body), look=look, closed=True)


def _slot(result: Planned) -> Sequence[Shape]:
    """The walls, as far as the picture goes."""
    if result.task.slot is None:
        return ()
    points = np.array(result.task.slot.outline_um, dtype=np.float64)
    return (Line(name="slot", points=points, look=Look(fill=WALL, line=INK), closed=True),)


def _goal(result: Planned, body: Floats) -> tuple[Sequence[Shape], Sequence[Shape]]:
    """What is drawn of the goal under the part, and over it."""
    dashed = Look(line=GOAL, width=1.7, dash="6.8 5.1")
    shape = Line(
        name="goal outline", points=corners(goal_pose(result), body), look=dashed, closed=True
    )
    box = faces("goal box", [result.setup.goal], "x", "y", Look(fill=GOAL_FILL, line=GOAL))
    return (box,), (shape,)


def _centre_path(path: Floats) -> Line:
    return Line(name="centre", points=poses_shown(path)[:, :2], look=Look(line=MUTED))


def _box_after(result: Planned, index: int) -> Sequence[Boxes]:
    """The box of poses after the move at the part's centre, if the proof got so far."""
    steps = result.chain.steps
    post = steps[index].post if index < len(steps) else None
    if post is None:
        return ()
    sound = standings(result.chain, len(result.found.rules))[index] is Standing.CERTIFIED
    colour, name, dash = (
        (CERTIFIED, "certified box", "") if sound else (OPEN, "unproved box", "4.2 2.8")
    )
    return (faces(name, [post], "x", "y", Look(line=colour, width=1.4, dash=dash)),)


def _reached(move: MoveRun) -> Floats:
    """(2P, 2) where the tips start and end, um."""
    return np.concatenate([move.tips[0], move.tips[0] + move.travel[0]]) / units.UM


def _tips(move: MoveRun) -> list[Shape]:
    """The tips, their travel, and the circles of their radii."""
    starts, ends = np.split(_reached(move), 2)
    arrows: list[Shape] = []
    marks: list[Shape] = []
    turns = np.linspace(0.0, 2.0 * np.pi, 49)[:-1]
    circle = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    for start, end, radius in zip(starts, ends, move.radii[0] / units.UM, strict=True):
        active = bool((start != end).any())
        if active:
            arrows.append(Arrow(name="travel", start=start, end=end, colour=TIP))
        if radius > 0.0:
            ring, thin = start + radius * circle, Look(line=TIP, width=0.8)
            marks.append(Line(name="tip's edge", points=ring, look=thin, closed=True))
        marks.append(
            Dots(
                name="active tip" if active else "passive tip",
                points=start[None],
                radius=2.75,
                look=Look(fill=TIP if active else PAPER, line=TIP, width=1.4),
            )
        )
    return [*arrows, *marks]


def _ahead(move: MoveRun) -> npt.NDArray[np.bool_]:
    """(P,) whether a tip starts on the side of the part that the probe comes from."""
    return np.asarray(move.tips[0, :, 0] > move.before[0, 0])


def _room_for_names(move: MoveRun, extent: Floats) -> Floats:
    """Points, um, that a panel must also show so that the tips' names fit into it."""
    reach = 0.2 * float(np.ptp(extent, axis=0).max())
    outward = np.where(_ahead(move), reach, -reach)
    return move.tips[0] / units.UM + np.stack([outward, np.zeros_like(outward)], axis=1)


def _names_of_tips(move: MoveRun, names: tuple[str, ...]) -> list[Words]:
    """The name of each tip on the side that faces away from the part."""
    return [
        Words(name="tip", text=name, point=place, colour=TIP, shift=7.0 if ahead else -7.0)
        for name, ahead, place in zip(names, _ahead(move), move.tips[0] / units.UM, strict=True)
    ]
