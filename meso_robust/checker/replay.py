"""The run of a REFUTED certificate, made once more by the checker's own proof of every move.

A run is the claim with each range that the witness states put to one number (all others stay as wide as the
task leaves them: what is proved holds for the run as well), so what proves a move from a whole box proves
where this run goes: to a box that is as narrow as the arithmetic, or as the tube of a rotation, whose
slide need not be unique. Three things can come out:

- every motion of the run ends in the goal: the witness is untrue;
- the run fails: a tip would be lowered onto the part, the part meets a wall, or every motion ends
  outside the goal;
- a move does not follow: a tip slips, say, or the part jams, which the checker has no formulas for.
  Whether the run fails stays undecided then.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial

from flint import arb

from meso_robust.checker.chain import within
from meso_robust.checker.contact import off_line
from meso_robust.checker.document import RuleDocument, WitnessDocument
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.ids import Named, Objection, named, place
from meso_robust.checker.inputs import Given, PoseBox
from meso_robust.checker.moves import verify_scene
from meso_robust.checker.numbers import double
from meso_robust.checker.outline import Edge, Polygon
from meso_robust.checker.passage import Passage
from meso_robust.checker.pushing import line_angle, line_depth
from meso_robust.checker.ranges import ZERO, Side, positive, side_of
from meso_robust.checker.refusal import Refused
from meso_robust.checker.scene import Scene, direction, frame_of, scene_of
from meso_robust.checker.walls import clear_of_walls, meets_a_wall

INSIDE, MISSES = "starts_inside", "misses_goal"
"""Outcomes of a witness that are found here as well."""
Three = tuple[arb, arb, arb]
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
    run = _Run.of(witness, given)
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
            return Fate(fails=False, why=refused.name, move=number + 1)
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


@dataclass(frozen=True, slots=True, kw_only=True)
class _Run:
    """A run in exact numbers."""

    given: Given
    """The task, what is constant during the run put to one number."""
    start: PoseBox
    sensing: tuple[Three, ...]
    """Sensed minus true pose before each move."""
    dual: tuple[tuple[arb, arb], ...]
    """True minus commanded position of the active probe in each move."""
    single: tuple[tuple[arb, arb], ...]

    @classmethod
    def of(cls, witness: WitnessDocument, given: Given) -> _Run:
        start, sensed, probe = given.start, given.sensed, given.probe
        at = _numbers(witness.start, (start.x, start.y, start.theta))
        # the first pose is sensed as the task states it
        first = [
            (low + high) / 2 - own
            for own, (low, high) in zip(at, (start.x, start.y, start.theta), strict=True)
        ]
        later = (_numbers(one, (sensed, sensed, given.turned)) for one in witness.sensing[1:])

        def pairs(texts: Iterable[tuple[str, str]]) -> tuple[tuple[arb, arb], ...]:
            return tuple((_number(x, probe), _number(y, probe)) for x, y in texts)

        return cls(
            given=replace(
                given,
                # of tips that each have a friction of their own the witness's one number tells nothing
                friction=side_of(_number(witness.friction, given.friction))
                if given.common_friction
                else given.friction,
                film_ratio=side_of(_number(witness.film_ratio_m2, given.film_ratio)),
                misalignment=side_of(_number(witness.misalignment_rad, given.misalignment)),
            ),
            start=_box(*at),
            sensing=((first[0], first[1], first[2]), *later),
            dual=pairs(witness.dual_probe),
            single=pairs(witness.single_probe),
        )

    def scene(self, rule: RuleDocument, number: int, pose: PoseBox) -> Scene:
        """A move of the run, every error of it put to one number."""
        scene, frame = scene_of(rule, pose, self.given), frame_of(rule)
        errors = {
            "sensed": self.sensing[number][:2],
            "probe": self.dual[number],
            "passive": self.single[number],
        }
        box = dict(scene.box)
        for name, (x, y) in errors.items():
            own = frame.own(_box(x, y, ZERO))  # an error turns with the axes as a position does
            box[f"{name}_x"], box[f"{name}_y"] = side_of(own.x[0]), side_of(own.y[0])
        return replace(scene, box=box)


def _number(text: str, bounds: Side) -> arb:
    """A number of the run, put back into its bounds where rounding took it out."""
    return arb(double(text, place("witness"))).max(bounds[0]).min(bounds[1])


def _numbers(texts: tuple[str, str, str], bounds: tuple[Side, Side, Side]) -> Three:
    x, y, theta = (_number(text, side) for text, side in zip(texts, bounds, strict=True))
    return x, y, theta


def _box(x: arb, y: arb, theta: arb) -> PoseBox:
    return PoseBox(x=side_of(x), y=side_of(y), theta=side_of(theta))


def _starts_inside(scene: Scene) -> bool:
    """Whether a tip is proved to lie within the part at the start of a move.

    Of a part that is not convex that is left open: a notch may hold the tip.
    """
    outline = scene.outline
    if isinstance(outline, Polygon) and len(outline.around) < len(outline.corners):
        return False
    return any(
        all(
            positive(partial(_depth, scene, line, tip), scene.box)
            for line in outline.sides(scene.edge)
        )
        for tip in _tips(scene)
    )


def _depth(scene: Scene, line: Edge, tip: Place, at: Point) -> Dual:
    """How far the centre of a tip is on the inner side of an edge, and of what its corners lack."""
    c, s = direction(line_angle(scene, line, scene.angle, at))
    return line_depth(scene, line, at) - scene.corner_radius - off_line(c, s, *tip(at))


def _tips(scene: Scene) -> Iterator[Place]:
    """Where the centre of each tip is before the move, from the part, in the axes of the travel."""
    for side in (1, -1):
        yield partial(_of_tip, scene, side)
    if scene.rule.single_x is not None:
        yield lambda at: scene.in_travel(at, scene.passive_ahead(at), scene.passive_rise(at))


def _of_tip(scene: Scene, side: int, at: Point) -> tuple[Dual, Dual]:
    return scene.ahead(at, side), scene.rise(at, side)


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
