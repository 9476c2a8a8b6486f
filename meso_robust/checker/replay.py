"""The run of a REFUTED certificate, made once more by the checker's own proof of every move.

A run is the claim with each range that the witness states put to one number (all others stay as wide as the
task leaves them: what is proved holds for the run as well), so what proves a move from a whole box proves
where this run goes: to a box that is as narrow as the arithmetic, or as the tube of a rotation, whose
slide need not be unique. Three things can come out:

- every motion of the run ends in the goal: the witness is untrue;
- the run fails: a tip would be lowered onto the part, the part jams between the tips of a rotation
  (``jam.py``) or meets a wall, or every motion ends outside the goal;
- a move does not follow: a tip slips, say, which the checker has no formulas for, or it is left open
  whether the part jams. Whether the run fails stays undecided then.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

from meso_robust.checker.chain import within
from meso_robust.checker.contact import off_line
from meso_robust.checker.document import RuleDocument, WitnessDocument
from meso_robust.checker.dual import Dual, Number, Point
from meso_robust.checker.film import EVEN
from meso_robust.checker.ids import Must, Named, Objection, named
from meso_robust.checker.inputs import Given, PoseBox
from meso_robust.checker.jam import check_jam
from meso_robust.checker.moves import verify_scene
from meso_robust.checker.outline import Edge, Polygon
from meso_robust.checker.passage import Passage
from meso_robust.checker.pushing import line_angle, line_depth
from meso_robust.checker.ranges import positive
from meso_robust.checker.refusal import Refused
from meso_robust.checker.run import Run
from meso_robust.checker.scene import Scene, direction
from meso_robust.checker.walls import clear_of_walls, meets_a_wall

INSIDE, JAM, MISSES = "starts_inside", "jam", "misses_goal"
"""Outcomes of a witness that are found here as well."""
Place = Callable[[Point], tuple[Dual, Dual]]


@dataclass(frozen=True, slots=True)
class Fate:
    """What becomes of a run that is not proved to end in the goal."""

    fails: bool
    """Whether that was proved; else nothing was."""
    why: Named
    """How it fails, or what could not be shown."""
    move: int | None = None
    """In which move, from 1; None: at the end."""
    outcome: str | None = None
    """What the witness must name; None: whatever the simulator found."""


def replay(witness: WitnessDocument, policy: tuple[RuleDocument, ...], given: Given) -> Fate:
    """Follow a run as far as it is proved where it goes.

    Parameters
    ----------
    witness
        The run; its numbers lie within their bounds up to rounding, and are put back where that
        takes them out: what is followed is a run that the claim is about.
    policy, given
        The moves, and the task.

    Raises
    ------
    Refused
        Every motion of the run ends in the goal: it does not fail.
    """
    run = Run.of(witness, given)
    pose, memory = run.start, None
    for number, rule in enumerate(policy):
        scene = run.scene(rule, number, pose)
        if _starts_inside(scene):
            return Fate(
                fails=True, why=named(Objection.STARTS_INSIDE), move=number + 1, outcome=INSIDE
            )
        try:
            passage = verify_scene(scene, run.given, memory)
        except Refused as refused:
            return _stopped(scene, run.given, number, refused.name)
        fate = _at_walls(scene, passage, run.given, number)
        if fate is not None:
            return fate
        pose, memory = scene.frame.world(passage.post), passage.memory
    if within(pose, given.goal):
        stated, found = "it fails", "every motion of it is proved to end in the goal"
        raise Refused(named(Objection.WITNESS_FAILS), f"{stated} ({witness.outcome})", found)
    if _outside(pose, given.goal):
        return Fate(fails=True, why=named(Objection.MISSES_GOAL), outcome=MISSES)
    return Fate(fails=False, why=named(Objection.END_UNDECIDED))


def _stopped(scene: Scene, given: Given, number: int, why: Named) -> Fate:
    """What becomes of a move that does not follow: of tips that may close on the part it may that it jams."""
    if scene.rule.action == "rotate" and why.id is Must.NO_JAM:
        try:
            passage = check_jam(scene)
        except Refused:
            return Fate(fails=False, why=why, move=number + 1)
        jams = Fate(fails=True, why=named(Objection.JAMS), move=number + 1, outcome=JAM)
        return _at_walls(scene, passage, given, number) or jams
    return Fate(fails=False, why=why, move=number + 1)


def _starts_inside(scene: Scene) -> bool:
    """Whether a tip is proved to overlap the part at the start of a move.

    Of a part that is not convex that is left open: a notch may hold the tip.
    """
    outline = scene.outline
    if isinstance(outline, Polygon) and len(outline.around) < len(outline.corners):
        return False
    return any(
        all(
            positive(partial(_depth, scene, line, nearest), scene.box)
            for line in outline.sides(scene.edge)
        )
        for nearest in _nearest(scene)
    )


def _depth(scene: Scene, line: Edge, place: Place, at: Point) -> Dual:
    """How far a point is on the inner side of an edge, and of what its corners lack."""
    c, s = direction(line_angle(scene, line, scene.angle, at))
    return line_depth(scene, line, at) - scene.corner_radius - off_line(c, s, *place(at))


def _nearest(scene: Scene) -> Iterator[Place]:
    """A point for each tip, from the part, in the axes of the travel.

    It is as far from the tip's centre as tip and roundest corner reach together, across the edges that
    are pushed. Where it is within the part less that corner's radius on all sides, the tip overlaps the
    part: of a part with rounded corners all is within it that is no farther than their radius from there.
    """
    for side in (1, -1):
        yield partial(_across, scene, side, -1)
    if scene.rule.single_x is not None:
        yield partial(_across, scene, 0, 1)


def _across(scene: Scene, side: int, sign: int, at: Point) -> tuple[Dual, Dual]:
    """The point for the upper (1), lower (-1) or passive (0) tip; ``sign``: out or into the edge."""
    radius: Number
    if side == 0:
        x, y = scene.in_travel(at, scene.passive_ahead(at), scene.passive_rise(at))
        radius = EVEN if scene.exact("radius_passive") else at["radius_passive"]
    else:
        x, y = scene.ahead(at, side), scene.rise(at, side)
        radius = scene.radius(at, side)
    c, s = direction(scene.angle(at))
    reach = (radius + scene.corner_radius) * sign
    return x + s * reach, y - c * reach


def _at_walls(scene: Scene, passage: Passage, given: Given, number: int) -> Fate | None:
    """What the walls make of a move that there would be without them; None if it keeps clear."""
    try:
        clear_of_walls(scene, passage, given)
    except Refused as refused:
        touches = meets_a_wall(scene, passage, given)
        why = named(Objection.MEETS_WALL) if touches else refused.name
        return Fate(fails=touches, why=why, move=number + 1)
    return None


def _outside(pose: PoseBox, goal: PoseBox) -> bool:
    pairs = ((pose.x, goal.x), (pose.y, goal.y), (pose.theta, goal.theta))
    return any(one[1] < other[0] or one[0] > other[1] for one, other in pairs)
