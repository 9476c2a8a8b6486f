"""A tilt: one tip sticks and turns the part, the other one passes the end of the edge."""

from __future__ import annotations

import functools

from meso_robust.checker import statement as st
from meso_robust.checker.contact import Contact, Turning
from meso_robust.checker.dual import Dual, Number, Point
from meso_robust.checker.ids import Must, Objection, Property, named
from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.outline import Rectangle
from meso_robust.checker.passage import Memory, Passage, Pose, Sweep
from meso_robust.checker.pushing import (
    TURNS,
    UNIT,
    beside,
    comes_free,
    constant,
    free_at_start,
    on_edge,
    passes,
    passes_hull,
    sticks,
    touch,
)
from meso_robust.checker.ranges import ZERO, Formula, component, shift, span
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, prove
from meso_robust.checker.scene import Scene


def check_tilt(scene: Scene) -> Passage:
    """Prove a tilt from every pose of its scene.

    Raises
    ------
    Refused
        A requirement does not follow.
    """
    side, box = scene.rule.side, scene.box
    if side == 0:
        raise Refused(named(Objection.SIDE_OF_MOVE, action="tilt"), 0, "1 or -1")
    turning = functools.partial(_turning, scene)
    offset: Formula = lambda at: turning(at).start.d2  # noqa: E731
    while_it_turns = {**box, "share": UNIT}
    theta: Formula = lambda at: at["theta"]  # noqa: E731
    later = functools.partial(_angle, scene)
    end = functools.partial(_angle, scene, whole=True)

    def flight(at: Point) -> Dual:
        return at["share"] * (scene.ahead(at, -side) - turning(at).start.arm_x)

    def way_back(at: Point) -> Dual:
        return at["share"] * (scene.ahead(at, -side) - scene.ahead_end(at, -side))

    def idle(when: str, short: Formula, angle: Formula, *ends: Formula) -> Requirement:
        def states(angle: Formula) -> Part:
            return Part(beside(scene, angle, offset, short, side), while_it_turns)

        if not isinstance(scene.outline, Rectangle):
            angles = (angle, *ends)
            return passes_hull(when, scene, offset, short, side, angles, while_it_turns)
        return passes(when, (states(angle),), tuple(map(states, ends)) or None)

    requirements = [
        *free_at_start(scene, (-side, side)),
        Requirement(
            name=named(Must.TIP_REACHES_PART),
            statement=st.REACHES,
            parts=(Part({"travel": functools.partial(_travel, scene)}, box),),
        ),
        on_edge("pushing", scene, offset, box),
        *sticks("pushing", scene, later, offset, side, while_it_turns, (theta, end)),
        idle("before_touch", flight, theta),
        idle("while_turning", constant(ZERO), later, theta, end),
        idle("on_withdrawal", way_back, end),
        comes_free("pushing", end, box),
    ]
    for requirement in requirements:
        prove(requirement)

    centre = functools.partial(_centre, scene, left=ZERO)
    x, y, theta_end = (span(component(centre, k), box) for k in range(3))
    return Passage(
        does=named(Property.TURNS_PART, turn=TURNS[side]),
        post=PoseBox(x=x, y=y, theta=shift(theta_end, scene.turn)),
        requirements=tuple(requirements),
        memory=Memory(scene=scene, height=functools.partial(_height, scene)),
        swept=(
            Sweep(lambda at: _centre(scene, at, at["share"]), while_it_turns, "share", exact=True),
        ),
    )


def _turning(scene: Scene, at: Point) -> Turning:
    return Turning(touch(scene, at, -scene.rule.side), scene.rule.side)


def _travel(scene: Scene, at: Point) -> Dual:
    """Travel in contact."""
    return _turning(scene, at).start.arm_x - scene.ahead_end(at, -scene.rule.side)


def _angle(scene: Scene, at: Point, *, whole: bool = False) -> Dual:
    """Direction of the edge when ``share`` of the travel in contact is done."""
    travel = _travel(scene, at)
    turned, _, _ = _turning(scene, at).after(travel if whole else travel * at["share"], at["rho"])
    return at["theta"] + turned


def _centre(scene: Scene, at: Point, left: Number) -> Pose:
    """The part when a share ``left`` of the travel in contact is still to come."""
    side, travel = scene.rule.side, _travel(scene, at)
    turned, arm_x, arm_y = _turning(scene, at).after(travel * (1 - left), at["rho"])
    x = at["x"] + scene.ahead_end(at, -side) + travel * left - arm_x
    return x, at["y"] + scene.rise(at, -side) - arm_y, at["theta"] + turned


def _height(scene: Scene, at: Point, c: Dual, s: Dual) -> Dual:
    """Height of the centre once the edge has the direction ``(c, s)``: the contact keeps its height."""
    first = touch(scene, at, -scene.rule.side)
    return at["y"] + scene.rise(at, -scene.rule.side) - Contact(c, s, scene.d1, first.d2).arm_y
