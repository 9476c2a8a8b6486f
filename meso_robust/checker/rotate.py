"""A two-sided rotation, as a whole: start, push onto the passive tip, turn between both tips.

The first stage is ``approach.py``, the second ``slide.py``; this file joins them and looks after the
idle tip and the end.

While both tips can touch none is left: if the part left S, D alone would push it and its far edge
would close on S again (it would press, and S's force is positive for all friction ratios); if it left D, it
would rest, as S rests, and D would run into it. Motion exists: the forces are positive for all
ratios and the map from slip directions to speeds has a fixed point, because ``T + d1 (k_D - k_S)``
vanishes nowhere (``V^2 > w^2 (1 + mu^2)``).
"""

from __future__ import annotations

import functools

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.approach import Approach, approach
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.grip import Grip
from meso_robust.checker.ids import Must, Objection, Property, named
from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.outline import Rectangle
from meso_robust.checker.pair import ACTIVE, Pair
from meso_robust.checker.passage import Passage, Pose, Sweep
from meso_robust.checker.pushing import (
    UNIT,
    beside,
    comes_free,
    constant,
    free_at_start,
    passes,
    touch,
)
from meso_robust.checker.ranges import ZERO, Box, Formula, Side, component, shift, side_of, span
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, Variables, prove
from meso_robust.checker.scene import Scene
from meso_robust.checker.slide import Piece, enclose

IDLE = 1
"""The upper tip of the active probe touches nothing; the lower one pushes."""
NEAR = 2e-7
"""How closely the touch is bounded, m."""


def check_rotate(scene: Scene) -> Passage:
    """Prove a counter-clockwise rotation from every pose of its scene.

    Raises
    ------
    Refused
        A requirement does not follow.
    """
    if not isinstance(scene.outline, Rectangle):
        raise Refused(named(Objection.IS_RECTANGLE), "a polygon", "a rectangle")
    if scene.rule.side != 1:
        raise Refused(named(Objection.SIDE_OF_MOVE, action="rotate"), scene.rule.side, 1)
    if not scene.plain:
        raise Refused(named(Objection.IS_RECTANGLE), "round tips, or an uneven film", "points")
    pair, box = Pair(scene), scene.box
    before = [*free_at_start(scene, (ACTIVE, IDLE)), _passive_free(scene), _no_jam(pair)]
    _prove(before)
    touching = approach(scene, pair)
    at_touch = touching.box()
    h, sigma = (span(component(touching.touching, k), at_touch, within=NEAR) for k in (0, 1))
    h_end = span(pair.h_end, box)
    arrival = [
        *touching.requirements(),
        _rests(touching, h_end),
    ]
    _prove(arrival)
    turn = _Turn(scene, pair, touching, {
        "V": span(pair.V, box), "rho": box["rho"], "mu": box["mu"], "d1": side_of(scene.d1),
    }, h, sigma, h_end)  # fmt: skip
    after = turn.requirements()
    _prove(after)
    return Passage(
        does=named(Property.TURNS_BETWEEN_TIPS),
        post=turn.post(),
        requirements=(*before, *arrival, *after),
        swept=(touching.swept(), *turn.swept()),
    )


def _prove(requirements: list[Requirement]) -> None:
    for requirement in requirements:
        prove(requirement)


def _passive_free(scene: Scene) -> Requirement:
    variables: Variables = {
        "theta": lambda at: at["theta"],
        "d1": constant(scene.d1),
        "dx": lambda at: -scene.passive_ahead(at),
        "dy": lambda at: -scene.passive_rise(at),
    }
    return Requirement(
        name=named(Must.TIP_FREE_AT_START, tip="passive"),
        statement=st.CLEARANCE,
        parts=(Part(variables, scene.box),),
    )


def _no_jam(pair: Pair) -> Requirement:
    variables: Variables = {
        "V": pair.V,
        "d1": constant(pair.scene.d1),
        "mu": lambda at: at["mu"],
    }
    return Requirement(
        name=named(Must.NO_JAM),
        statement=st.NO_JAM,
        parts=(Part(variables, pair.scene.box),),
    )


def _rests(touching: Approach, h_end: Side) -> Requirement:
    variables: Variables = {
        "h_start": lambda at: touching.touching(at)[0],
        "h_end": lambda at: at["h_end"],
    }
    return Requirement(
        name=named(Must.RESTS_BEFORE_END),
        statement=st.RESTS,
        parts=(Part(variables, {**touching.box(), "h_end": h_end}),),
    )


class _Turn:
    """The turn between both tips."""

    def __init__(
        self,
        scene: Scene,
        pair: Pair,
        touching: Approach,
        box: Box,
        h: Side,
        sigma: Side,
        h_end: Side,
    ) -> None:
        self.scene, self.pair, self.touching = scene, pair, touching
        self.box, self.h, self.h_end = box, h, h_end
        self.pieces = enclose(box, h, sigma, h_end)

    def grip(self, at: Point, piece: Piece) -> Grip:
        return Grip.at(piece.h(at["done"]), at["V"], self.scene.d1)

    def part(self, piece: Piece) -> Part:
        """The states of a piece, by the names of the inequalities."""
        variables: Variables = {
            "h": lambda at: piece.h(at["done"]),
            "V": lambda at: at["V"],
            "d1": constant(self.scene.d1),
            "sigma": lambda at: piece.sigma(at["done"], at["share"]),
            "rho": lambda at: at["rho"],
            "mu": lambda at: at["mu"],
            "half": constant(self.scene.half),
        }
        return Part(variables, {**self.box, "done": UNIT, "share": UNIT})

    def offset(self, at: Point, piece: Piece) -> Dual:
        """d2 of the active tip."""
        return self.grip(at, piece).T / 2 - piece.sigma(at["done"], at["share"])

    def idle(self, piece: Piece) -> Part:
        """The upper tip while a piece is passed."""
        variables = beside(
            self.scene,
            lambda at: _angle(self.grip(at, piece)),
            lambda at: self.offset(at, piece),
            constant(ZERO),
            IDLE,
        )
        tips = {name: self.scene.box[name] for name in ("beta", "spacing")}
        return Part(variables, {**self.box, **tips, "done": UNIT, "share": UNIT})

    def requirements(self) -> list[Requirement]:
        tube = tuple(self.part(piece) for piece in self.pieces)
        span_of = (Part({"h": lambda at: at["h"], "V": lambda at: at["V"]}, self.ends()),)
        while_turning = tuple(self.idle(piece) for piece in self.pieces)
        return [
            Requirement(
                name=named(Must.BOTH_TIPS_TOUCH),
                statement=st.PASSIVE_FORCE,
                parts=tube,
                cover=span_of,
                over_parts=True,
            ),
            Requirement(
                name=named(Must.BOTH_TIPS_ON_EDGES),
                statement=st.TIPS_ON_EDGES,
                parts=tube,
                cover=span_of,
                over_parts=True,
            ),
            Requirement(
                name=named(Must.ACTIVE_PRESSES),
                statement=st.ACTIVE_FORCE,
                parts=tube,
                stated=False,
            ),
            Requirement(
                name=named(Must.ACTIVE_PRESSES_ALONE),
                statement=st.ALONE,
                parts=tube,
                stated=False,
            ),
            passes("before_touch", (self.flight(),)),
            passes("early_in_turn", (self.early(),)),
            passes("late_in_turn", while_turning, cover=(self.at_end(),)),
            passes("on_withdrawal", (self.withdrawal(),)),
            comes_free("both", self.end_angle, self.scene, self.end_box()),
        ]

    def ends(self) -> Box:
        return {"h": (self.h_end[0], self.h[1]), "V": self.box["V"]}

    def flight(self) -> Part:
        """Until the active tip touches the part."""
        scene = self.scene

        def short(at: Point) -> Dual:
            return at["share"] * (scene.ahead(at, ACTIVE) - touch(scene, at, ACTIVE).arm_x)

        variables = beside(
            scene, lambda at: at["theta"], lambda at: touch(scene, at, ACTIVE).d2, short, IDLE
        )
        return Part(variables, {**scene.box, "share": UNIT})

    def early(self) -> Part:
        """Until the part rests on the passive tip."""
        touching = self.touching
        offset: Formula = lambda at: touching.contact(at).d2  # noqa: E731
        variables = beside(self.scene, touching.angle, offset, constant(ZERO), IDLE)
        return Part(variables, {**touching.box(), "beta": self.scene.box["beta"]})

    def end_box(self) -> Box:
        return {**self.scene.box, "share": UNIT, "back": UNIT}

    def end_grip(self, at: Point) -> Grip:
        return Grip.at(self.pair.h_end(at), self.pair.V(at), self.scene.d1)

    def end_angle(self, at: Point) -> Dual:
        return _angle(self.end_grip(at))

    def end_sigma(self, at: Point) -> Dual:
        piece = self.pieces[-1]
        return piece.sigma(piece.done(self.pair.h_end(at)), at["share"])

    def at_end(self) -> Part:
        return Part(self.beside_at_end(constant(ZERO)), self.end_box())

    def beside_at_end(self, short: Formula) -> Variables:
        def offset(at: Point) -> Dual:
            return self.end_grip(at).T / 2 - self.end_sigma(at)

        return beside(self.scene, self.end_angle, offset, short, IDLE)

    def withdrawal(self) -> Part:
        """While the active probe backs off to its start."""
        scene = self.scene

        def way(at: Point) -> Dual:
            return at["back"] * (scene.ahead(at, ACTIVE) - scene.ahead_end(at, ACTIVE))

        return Part(self.beside_at_end(way), self.end_box())

    def swept(self) -> tuple[Sweep, ...]:
        """All poses between both tips."""
        names = ("x", "sensed_x", "passive_x", "y", "sensed_y", "passive_y")
        box = {**self.box, **{name: self.scene.box[name] for name in names}}

        def pose(piece: Piece, at: Point) -> Pose:
            grip, sigma = self.grip(at, piece), piece.sigma(at["done"], at["share"])
            x = at["x"] + self.scene.passive_ahead(at) + grip.h / 2 + sigma * grip.c
            y = at["y"] + self.scene.passive_rise(at) + at["V"] / 2 + sigma * grip.s
            return x, y, _angle(grip)

        states = {**box, "done": UNIT, "share": UNIT}
        return tuple(Sweep(functools.partial(pose, one), states, "done") for one in self.pieces)

    def post(self) -> PoseBox:
        """All poses at the end, in the axes of the move."""
        box = {name: side for name, side in self.end_box().items() if name != "back"}

        def x(at: Point) -> Dual:
            grip, h = self.end_grip(at), self.pair.h_end(at)
            return at["x"] + self.scene.passive_ahead(at) + h / 2 + self.end_sigma(at) * grip.c

        def y(at: Point) -> Dual:
            return at["y"] + self.pair.middle(at) + self.end_sigma(at) * self.end_grip(at).s

        theta = shift(span(self.end_angle, box), self.scene.turn)
        return PoseBox(x=span(x, box), y=span(y, box), theta=theta)


def _angle(grip: Grip) -> Dual:
    """Direction of the edges; ``s`` is positive throughout."""
    return arb.pi() / 2 - (grip.c / grip.s).atan()
