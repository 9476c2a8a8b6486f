"""A tilt: one tip sticks and turns the part, the other one passes the end of the edge."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace

from meso_robust.checker import statement as st
from meso_robust.checker.contact import Contact, Turning
from meso_robust.checker.dual import Dual, Number, Point, once
from meso_robust.checker.film import EVEN
from meso_robust.checker.ids import Must, Objection, Property, named
from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.outline import Rectangle
from meso_robust.checker.passage import Known, Passage, Pose, Sweep
from meso_robust.checker.pushing import (
    NEAR,
    TURNS,
    UNIT,
    any_of,
    beside,
    comes_free,
    constant,
    free_at_start,
    on_edge,
    passes,
    passes_hull,
    sticks,
    touch,
    turning,
)
from meso_robust.checker.ranges import ZERO, Box, Formula, component, shift, span
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, prove
from meso_robust.checker.scene import NOTHING, Scene


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
    while_it_turns = {**box, "share": UNIT}
    later = functools.partial(_angle, scene)
    end = functools.partial(_angle, scene, whole=True)
    offset = functools.partial(_offset, scene)
    in_flight = {**while_it_turns, **_stray(scene)}

    def idle(
        when: str, box: Box, contact: Callable[[Point], Contact], short: Formula, *angles: Formula
    ) -> Requirement:
        place = functools.partial(_idle_place, scene, contact, short)
        one = passes_hull(when, scene, angles, place, side, box)
        if not (scene.plain and isinstance(scene.outline, Rectangle)):
            return one
        # as certificates of point tips state it: off the edge's line or beyond its end
        parts = tuple(Part(beside(scene, angle, offset, short, side), box) for angle in angles)
        beyond = passes(when, parts[:1], parts[1:] or None)
        return replace(one, instead=(*one.instead, beyond)) if one.shown else any_of([beyond, one])

    def flight(at: Point) -> Dual:
        return at["share"] * (scene.ahead(at, -side) - touch(scene, at, -side).arm_x)

    def way_back(at: Point) -> Dual:
        return at["share"] * (scene.ahead(at, -side) - scene.ahead_end(at, -side))

    first = functools.partial(touch, scene, side=-side)
    requirements = [
        *free_at_start(scene, (-side, side)),
        Requirement(
            name=named(Must.TIP_REACHES_PART),
            statement=st.REACHES,
            parts=(Part({"travel": functools.partial(_travel, scene)}, box),),
        ),
        on_edge("pushing", scene, offset, while_it_turns),
        *sticks("pushing", scene, later, offset, -side, side, while_it_turns, (scene.angle, end)),
        idle("before_touch", in_flight, first, flight, scene.angle),
        idle(
            "while_turning",
            while_it_turns,
            functools.partial(_contact, scene),
            constant(ZERO),
            *(later, scene.angle, end),
        ),
        idle(
            "on_withdrawal",
            in_flight,
            functools.partial(_contact, scene, whole=True),
            way_back,
            end,
        ),
        comes_free("pushing", end, scene, box),
    ]
    for requirement in requirements:
        prove(requirement)

    centre = functools.partial(_centre, scene, left=ZERO)
    x, y, theta_end = (span(component(centre, k), box, within=NEAR) for k in range(3))
    return Passage(
        does=named(Property.TURNS_PART, turn=TURNS[side]),
        post=PoseBox(x=x, y=y, theta=shift(theta_end, scene.turn)),
        requirements=tuple(requirements),
        memory=functools.partial(_known, scene),
        swept=(
            Sweep(lambda at: _centre(scene, at, at["share"]), while_it_turns, "share", exact=True),
        ),
    )


def _stray(scene: Scene) -> Box:
    """By how much the probe strays at an instant more than when its place was looked at."""
    low, high = scene.box["wander_x"]
    both = NOTHING if low is high else (low - high, high - low)
    return {"stray_x": both, "stray_y": both}


def _idle_place(
    scene: Scene, contact: Callable[[Point], Contact], short: Formula, at: Point
) -> tuple[Dual, Dual]:
    """The idle tip from the part, the pushing one ``short`` of a contact."""
    x, y = scene.to_other(at, scene.rule.side)
    pushing = contact(at)
    if "stray_x" in at and not scene.exact("wander_x"):
        stray_x, stray_y = scene.in_travel(at, at["stray_x"], at["stray_y"])
        x, y = x + stray_x, y + stray_y
    return pushing.arm_x + short(at) + x, pushing.arm_y + y


def _turning(scene: Scene, at: Point) -> Turning:
    return turning(scene, at, -scene.rule.side, scene.rule.side)


def _travel(scene: Scene, at: Point) -> Dual:
    """Travel in contact."""
    pushing = -scene.rule.side
    return touch(scene, at, pushing).arm_x - scene.ahead_end(at, pushing)


def _turned(scene: Scene, at: Point, *, whole: bool = False) -> Dual:
    """Turn when all of the travel in contact is done, or ``share`` of it (of the turn, if it rolls)."""
    turn = _turning(scene, at)
    if whole or not turn.uniform:
        turned = once((id(scene), "turned"), at, lambda: turn.after(_travel(scene, at)))
        return turned if whole else turned * at["share"]
    return turn.after(_travel(scene, at) * at["share"])


def _angle(scene: Scene, at: Point, *, whole: bool = False) -> Dual:
    """Direction of the edge then."""
    return scene.angle(at) + _turned(scene, at, whole=whole)


def _contact(scene: Scene, at: Point, *, whole: bool = False) -> Contact:
    def work() -> Contact:
        return _turning(scene, at).contact(_turned(scene, at, whole=whole))

    return once((id(scene), "contact", whole), at, work)


def _offset(scene: Scene, at: Point) -> Dual:
    """Place of the contact along the edge then."""
    first = touch(scene, at, -scene.rule.side)
    if first.radius is EVEN:
        return first.d2
    return first.d2 - _turned(scene, at) * first.radius


def _centre(scene: Scene, at: Point, left: Number) -> Pose:
    """The part when a share ``left`` of the travel in contact is still to come."""
    pushing, travel = -scene.rule.side, _travel(scene, at)
    turned, arm_x, arm_y = _turning(scene, at).contact_after(travel * (1 - left))
    x = scene.ahead_end(at, pushing) + travel * left - arm_x
    x, y = scene.from_travel(at, x, scene.rise_end(at, pushing) - arm_y)
    return at["x"] + x, at["y"] + y, at["theta"] + turned


def _known(tilt: Scene, scene: Scene) -> Known | None:
    """What a tilt tells of y before a move with the same axes that pushes the same edge."""
    if tilt.frame != scene.frame or tilt.edge.name != scene.edge.name:
        return None
    own = {f"tilt {name}": side for name, side in tilt.box.items() if name not in LASTING}
    return Known(box=own, height=functools.partial(_height_before, tilt))


def _height_before(tilt: Scene, at: Point) -> Dual:
    """Where y was, from the tilt's own start; what is constant during a run is shared."""
    own = {key.removeprefix("tilt "): at[key] for key in at if key.startswith("tilt ")}
    shared = {name: at[name] for name in at if name in LASTING}
    return _height(tilt, {**shared, **own}, at["theta"])


def _height(scene: Scene, at: Point, theta: Dual) -> Dual:
    """Height of the part once the edge has the stated direction ``theta``: so has the contact."""
    pushing, start = -scene.rule.side, _turning(scene, at)
    contact = start.contact(scene.seen(at, theta) - start.angle)
    y = scene.rise_end(at, pushing) - contact.arm_y
    if scene.exact("direction"):
        return at["y"] + y
    return at["y"] + scene.from_travel(at, scene.ahead_end(at, pushing) - contact.arm_x, y)[1]


LASTING = frozenset(
    [
        "beta",
        "spacing",
        "radius_upper",
        "radius_lower",
        "radius_passive",
        "depth",
        "kappa",
        "size_other",
        "kappa_other",
        "drag_a",
        "drag_n",
        "rho",
        "mu",
    ]
)
"""What is constant during a run, or does not change where a tilt leaves the part at a given angle."""
