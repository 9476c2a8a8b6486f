"""One move in its own axes: the variables that it depends on, and where the tips are.

All that is not known is a variable of its own with a side of its own; what depends on the same
error depends on the same variable:

``x y theta``   true pose before the move (theta: direction of the edge that faces the probe)
``sx sy``       sensed minus true position
``px py``       true minus commanded position of the active probe
``qx qy``       the same of the passive one
``beta rho mu`` tip misalignment, drag ratio, friction
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

from flint import arb

from meso_robust.checker.document import AimDocument, RuleDocument
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.ids import Objection, named
from meso_robust.checker.inputs import Given, PoseBox, ball, metres
from meso_robust.checker.outline import Edge, Outline
from meso_robust.checker.ranges import Box, Side, shift, whole
from meso_robust.checker.refusal import Refused

HEADINGS = ("-x", "-y", "+x", "+y")
"""Where a push along -x of the move's own axes goes after 0 to 3 quarter turns of these axes."""


def negative(side: Side) -> Side:
    """A range with its sign changed."""
    return -side[1], -side[0]


@dataclass(frozen=True, slots=True)
class Frame:
    """Axes of a move: world = R(quarter turns) diag(1, -1 if mirrored else 1) own."""

    quarters: int
    mirrored: bool

    def own(self, box: PoseBox) -> PoseBox:
        """A box of poses of the world in these axes."""
        x, y = box.x, box.y
        for _ in range(self.quarters):  # turned back by a right angle
            x, y = y, negative(x)
        theta = shift(box.theta, -arb.pi() / 2 * self.quarters)
        if self.mirrored:
            y, theta = negative(y), negative(theta)
        return PoseBox(x=x, y=y, theta=theta)

    def world(self, box: PoseBox) -> PoseBox:
        """A box of poses of these axes in the world."""
        x, y, theta = box.x, box.y, box.theta
        if self.mirrored:
            y, theta = negative(y), negative(theta)
        for _ in range(self.quarters):
            x, y = negative(y), x
        return PoseBox(x=x, y=y, theta=shift(theta, arb.pi() / 2 * self.quarters))


def frame_of(rule: RuleDocument) -> Frame:
    """Axes of a rule."""
    return Frame(HEADINGS.index(rule.heading), rule.mirrored)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A move, its variables and the part."""

    rule: RuleDocument
    frame: Frame
    box: Box
    outline: Outline
    """The part's, in the axes of the move."""
    edge: Edge
    """The edge that faces the active probe."""
    spacing: arb

    @property
    def turn(self) -> arb:
        """Orientation of the part minus direction of the edge, rad."""
        return self.edge.turn

    @property
    def d1(self) -> arb:
        """Distance of the edge from the centre, m."""
        return self.edge.d1

    @property
    def half(self) -> arb:
        """Half the length of a rectangle's edge, m."""
        return self.edge.last

    def ahead(self, at: Point, side: int) -> Dual:
        """Upper (1) or lower (-1) tip at the start minus the part, x."""
        return aim(self.rule.dual_x, at, "x", "p") - self.lag(at, side)

    def ahead_end(self, at: Point, side: int) -> Dual:
        """That tip at the end of its travel minus the part before the move, x."""
        return aim(self.rule.dual_end_x, at, "x", "p") - self.lag(at, side)

    def rise(self, at: Point, side: int) -> Dual:
        """That tip minus the part before the move, y."""
        return aim(self.rule.dual_y, at, "y", "p") + self.spacing * side / 2

    def lag(self, at: Point, side: int) -> Dual:
        """In the axes of a move a positive misalignment puts the upper tip ahead, towards -x."""
        return at["beta"].tan() * (self.spacing * side / 2)

    def passive_ahead(self, at: Point) -> Dual:
        """Passive tip minus the part before the move, x."""
        return aim(given_aim(self.rule.single_x), at, "x", "q")

    def passive_rise(self, at: Point) -> Dual:
        """Passive tip minus the part before the move, y."""
        return aim(given_aim(self.rule.single_y), at, "y", "q")

    def apart(self, to: AimDocument, at: Point, axis: str) -> Dual:
        """An aim of the active probe minus that of the passive tip on an axis.

        What both share (the pose and its sensing) is left out rather than subtracted.
        """
        other = given_aim(self.rule.single_x if axis == "x" else self.rule.single_y)
        between = at["p" + axis] - at["q" + axis]
        between = between + (offset(to.offset_um) - offset(other.offset_um))
        if to.relative_to == other.relative_to:
            return between
        sensed = at[axis] + at["s" + axis]
        return between + sensed if to.relative_to == "sensed part" else between - sensed


def given_aim(to: AimDocument | None) -> AimDocument:
    """An aim that a rotation must have."""
    if to is None:
        raise Refused(
            named(Objection.PASSIVE_TIP, action="rotate"), "null", "single_x and single_y"
        )
    return to


@functools.cache
def offset(value_um: float) -> arb:
    """A commanded offset, m."""
    return ball(metres(value_um))


def aim(to: AimDocument, at: Point, axis: str, probe: str) -> Dual:
    """Where a probe is, minus the part's true coordinate."""
    place = at[probe + axis] + offset(to.offset_um)
    if to.relative_to == "sensed part":
        return place + at["s" + axis]
    return place - at[axis]


def scene_of(rule: RuleDocument, pre: PoseBox, given: Given) -> Scene:
    """A move that starts from any pose of ``pre`` (world axes)."""
    frame = frame_of(rule)
    own = frame.own(pre)
    outline = given.outline.mirrored() if frame.mirrored else given.outline
    edge = outline.facing(whole(own.theta))
    beta = negative(given.misalignment) if frame.mirrored else given.misalignment
    box = {
        "x": own.x,
        "y": own.y,
        "theta": shift(own.theta, -edge.turn),
        "sx": given.sensed,
        "sy": given.sensed,
        "px": given.probe,
        "py": given.probe,
        "qx": given.probe,
        "qy": given.probe,
        "beta": beta,
        "rho": given.film_ratio,
        "mu": given.friction,
    }
    return Scene(
        rule=rule,
        frame=frame,
        box=box,
        outline=outline,
        edge=edge,
        spacing=given.spacing,
    )


def direction(angle: Dual) -> tuple[Dual, Dual]:
    """Cosine and sine."""
    s, c = angle.sin_cos()
    return c, s
