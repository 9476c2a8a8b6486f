"""One move in its own axes: the variables that it depends on, and where the tips are.

All that is not known is a variable of its own with a side of its own; what depends on the same
error depends on the same variable:

``x y theta``             true pose before the move (theta: stated direction of the pushed edge,
                          ``turn`` less than the part's orientation)
``sensed_x sensed_y``     sensed minus true position
``probe_x probe_y``       true minus commanded position of the active probe
``passive_x passive_y``   the same of the passive one
``beta spacing``          tip misalignment, distance of the tips across the push
``direction scale``       of the travel: turned from the commanded one, longer by this share
``radius_upper radius_lower radius_passive``
``depth kappa``           of the pushed edge: its distance from the reference point, its turn
``size_other kappa_other`` of another edge: how much farther out it lies, its turn
``drag_a drag_n``         centre of drag, along and across the pushed edge, where it is fixed in the part
``centre_a centre_n``     the same where it may move, on the way; ``_now`` at the instant
``rho stretch shear bend`` drag ratio, unevenness of drag, tangent between path and straight line,
                          as they act on the way; with ``_now`` at the instant that is looked at
``mu``                    friction, or ``mu_upper mu_lower mu_passive`` if each tip has its own
``wander_x wander_y``     of the probe from its straight line at the touch; ``_now`` at the instant

Where a travel is turned from the axes of the move, contacts are looked at in *axes of the travel*,
in which every probe moves along -x: ``ahead``, ``rise`` and ``angle`` are those of these axes.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

from flint import arb

from meso_robust.checker.document import AimDocument, RuleDocument
from meso_robust.checker.dual import Dual, Number, Point
from meso_robust.checker.film import EVEN, MOVING, Film
from meso_robust.checker.ids import Objection, named
from meso_robust.checker.inputs import Given, PoseBox, ball, metres
from meso_robust.checker.outline import Edge, Outline
from meso_robust.checker.ranges import Box, Formula, Side, shift, side_of, whole
from meso_robust.checker.refusal import Refused

HEADINGS = ("-x", "-y", "+x", "+y")
"""Where a push along -x of the move's own axes goes after 0 to 3 quarter turns of these axes."""


NAMES = {1: "upper", -1: "lower"}
NOTHING = side_of(arb(0))
"""The side of what is exactly zero."""
WANDERS_IN = arb("1e-4")
"""m of travel in which a probe strays by no more than ``probe_wander``."""


PLAIN = {
    *("x", "y", "theta", "turn", "sensed_x", "sensed_y", "probe_x", "probe_y"),
    *("passive_x", "passive_y", "beta", "spacing", "depth", "rho", "mu"),
}
"""Variables that a move of points on an exact part depends on."""


def is_nothing(side: Side) -> bool:
    """Whether a side is the number zero."""
    return bool(side[0] == 0 and side[1] == 0)


def negative(side: Side) -> Side:
    """A range with its sign changed."""
    if side[0] is side[1]:
        return side_of(-side[0])
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
    """The edge that faces the active probe, as stated."""
    far: Edge
    """The one on the other side of the part."""
    askew: arb
    """Direction of that, run backwards, minus that of the other one as stated, rad; 0: they are parallel."""
    corner_radius: arb

    @property
    def turn(self) -> arb:
        """Orientation of the part minus direction of the edge, rad."""
        return self.edge.turn

    @property
    def d1(self) -> arb:
        """Distance of the edge from the reference point as stated, m."""
        return self.edge.d1

    @property
    def half(self) -> arb:
        """Half the length of a rectangle's edge, m."""
        return self.edge.last

    def exact(self, *names: str) -> bool:
        """Whether some variables are all exactly zero."""
        return all(self.box[name] is NOTHING for name in names)

    @property
    def plain(self) -> bool:
        """Whether tips are points, the part and the film as stated and travels as commanded."""
        return all(side is NOTHING or name in PLAIN for name, side in self.box.items())

    def mu(self, side: int) -> str:
        """Name of the friction coefficient of the upper (1) or lower (-1) tip."""
        return "mu" if "mu" in self.box else f"mu_{NAMES[side]}"

    @property
    def rho_now(self) -> str:
        """Name of the drag ratio at the instant that is looked at."""
        return "rho_now" if "rho_now" in self.box else "rho"

    def film(self, at: Point, when: str = "") -> Film:
        """Drag and path on the way, or ``_now``; what is exactly zero is left out."""
        rho = self.rho_now if when else "rho"
        names = [f"stretch{when}", f"shear{when}", f"bend{when}", *self._centre(when)]
        film = (EVEN if self.exact(name) else at[name] for name in names)
        return Film(at[rho], *film, moves=self.centre_moves)

    @property
    def centre_moves(self) -> bool:
        """Whether the centre of drag may be elsewhere at every instant."""
        return not self.exact(*MOVING.values())

    def _centre(self, when: str) -> tuple[str, ...]:
        """The variables that its coordinates are."""
        return (
            tuple(f"{name}{when}" for name in MOVING.values())
            if self.centre_moves
            else tuple(MOVING)
        )

    def film_variables(self, when: str = "") -> dict[str, Formula]:
        """The same as variables of an inequality, by their names there."""
        sources = {
            "rho": self.rho_now if when else "rho",
            **{name: f"{name}{when}" for name in ("stretch", "shear", "bend")},
            **{name.removesuffix(when): name for name in self._centre(when)},
        }
        return {
            name: functools.partial(_variable, source)
            for name, source in sources.items()
            if not self.exact(source)
        }

    def angle(self, at: Point) -> Dual:
        """Direction of the pushed edge before the move, from the axes of the travel."""
        return self.seen(at, at["theta"])

    def seen(self, at: Point, theta: Dual) -> Dual:
        """That direction at the stated one ``theta``."""
        turned = theta if self.exact("kappa") else theta + at["kappa"]
        return turned if self.exact("direction") else turned - at["direction"]

    def stated(self, at: Point, angle: Dual) -> Dual:
        """The inverse: the stated direction, axes of the move."""
        turned = angle if self.exact("direction") else angle + at["direction"]
        return turned if self.exact("kappa") else turned - at["kappa"]

    def radius(self, at: Point, side: int) -> Number:
        """Of the upper (1) or lower (-1) tip, m."""
        name = f"radius_{NAMES[side]}"
        return EVEN if self.exact(name) else at[name]

    def lean(self, at: Point) -> Dual | None:
        """An edge on both tips minus the line through their centres; None: their radii are one."""
        if self.equal_tips:
            return None
        c, _ = direction(at["beta"])
        differ = at["radius_upper"] - at["radius_lower"]
        return (differ * c / at["spacing"]).asin()

    @property
    def equal_tips(self) -> bool:
        """Whether the radii of both tips of the active probe are one."""
        low, high = self.box["radius_upper"]
        return low is high

    def gap(self, at: Point) -> Dual:
        """Distance of the contacts of both tips on an edge, m."""
        c, _ = direction(at["beta"])
        lean = self.lean(at)
        apart = at["spacing"] / c
        return apart if lean is None else apart * direction(lean)[0]

    def aligned(self, at: Point) -> Dual:
        """Direction of an edge on both tips, from the axes of the travel, less a right angle."""
        lean = self.lean(at)
        off = at["beta"] if lean is None else at["beta"] + lean
        return off if self.exact("direction") else off - at["direction"]

    def ahead(self, at: Point, side: int) -> Dual:
        """Upper (1) or lower (-1) tip at the start minus the part, x."""
        if self.exact("direction"):
            return self._first_x(at, side) + at["wander_x"]
        return self._start(at, side, "wander")[0]

    def rise(self, at: Point, side: int) -> Dual:
        """That tip up to its touch minus the part before the move, y."""
        if self.exact("direction"):
            return self._first_y(at, side) + at["wander_y"]
        return self._start(at, side, "wander")[1]

    def ahead_end(self, at: Point, side: int) -> Dual:
        """That tip at the end of its travel minus the part before the move, x."""
        if self.exact("direction", "scale"):
            end = aim(self.rule.dual_end_x, at, "x", "probe_")
            return end - self.lag(at, side) + at["wander_x_now"]
        return self._start(at, side, "wander", "_now")[0] - self.travelled(at)

    def rise_end(self, at: Point, side: int) -> Dual:
        """That tip after its touch minus the part before the move, y."""
        if self.exact("direction"):
            return self._first_y(at, side) + at["wander_y_now"]
        return self._start(at, side, "wander", "_now")[1]

    def travelled(self, at: Point) -> Dual:
        """True length of the travel, wandering left aside."""
        first = aim(self.rule.dual_x, at, "x") - aim(self.rule.dual_end_x, at, "x")
        return first * (at["scale"] + 1)

    def _start(self, at: Point, side: int, wander: str, when: str = "") -> tuple[Dual, Dual]:
        """A tip at the start, moved by what it strays at some instant, in the axes of the travel."""
        x = self._first_x(at, side) + at[f"{wander}_x{when}"]
        return self.in_travel(at, x, self._first_y(at, side) + at[f"{wander}_y{when}"])

    def _first_x(self, at: Point, side: int) -> Dual:
        return aim(self.rule.dual_x, at, "x", "probe_") - self.lag(at, side)

    def _first_y(self, at: Point, side: int) -> Dual:
        return aim(self.rule.dual_y, at, "y", "probe_") + at["spacing"] * side / 2

    def in_travel(self, at: Point, x: Dual, y: Dual) -> tuple[Dual, Dual]:
        """A vector from the axes of the move in those of the travel."""
        if self.exact("direction"):
            return x, y
        s, c = at["direction"].sin_cos()
        return c * x + s * y, c * y - s * x

    def from_travel(self, at: Point, x: Dual, y: Dual) -> tuple[Dual, Dual]:
        """A vector from the axes of the travel in those of the move."""
        if self.exact("direction"):
            return x, y
        s, c = at["direction"].sin_cos()
        return c * x - s * y, c * y + s * x

    def lag(self, at: Point, side: int) -> Dual:
        """In the axes of a move a positive misalignment puts the upper tip ahead, towards -x."""
        return at["beta"].tan() * (at["spacing"] * side / 2)

    def to_other(self, at: Point, side: int) -> tuple[Dual, Dual]:
        """From a tip of the active probe to the one on ``side``, in the axes of the travel."""
        return self.in_travel(at, -(self.lag(at, side) * 2), at["spacing"] * side)

    def passive_ahead(self, at: Point) -> Dual:
        """Passive tip minus the part before the move, x, axes of the move."""
        return aim(given_aim(self.rule.single_x), at, "x", "passive_")

    def passive_rise(self, at: Point) -> Dual:
        """Passive tip minus the part before the move, y, axes of the move."""
        return aim(given_aim(self.rule.single_y), at, "y", "passive_")

    def apart(self, to: AimDocument, at: Point, axis: str) -> Dual:
        """An aim of the active probe minus that of the passive tip on an axis of the move.

        What both share (the pose and its sensing) is left out rather than subtracted.
        """
        other = given_aim(self.rule.single_x if axis == "x" else self.rule.single_y)
        between = at["probe_" + axis] - at["passive_" + axis]
        between = between + (offset(to.offset_um) - offset(other.offset_um))
        if to.relative_to == other.relative_to:
            return between
        sensed = at[axis] + at["sensed_" + axis]
        return between + sensed if to.relative_to == "sensed part" else between - sensed


def given_aim(to: AimDocument | None) -> AimDocument:
    """An aim that a rotation must have."""
    if to is None:
        raise Refused(
            named(Objection.PASSIVE_TIP, action="rotate"), "null", "single_x and single_y"
        )
    return to


def _variable(name: str, at: Point) -> Dual:
    return at[name]


@functools.cache
def offset(value_um: float) -> arb:
    """A commanded offset, m."""
    return ball(metres(value_um))


def aim(to: AimDocument, at: Point, axis: str, probe: str | None = None) -> Dual:
    """Where a probe is, or is commanded to be, minus the part's true coordinate."""
    place = Dual(offset(to.offset_um)) if probe is None else at[probe + axis] + offset(to.offset_um)
    if to.relative_to == "sensed part":
        return place + at["sensed_" + axis]
    return place - at[axis]


def scene_of(rule: RuleDocument, pre: PoseBox, given: Given) -> Scene:
    """A move that starts from any pose of ``pre`` (world axes)."""
    frame = frame_of(rule)
    own = frame.own(pre)
    outline = given.outline.mirrored() if frame.mirrored else given.outline
    edge = outline.facing(whole(own.theta))
    far, askew = outline.opposite(edge)
    pushed = (edge, far) if rule.action == "rotate" else (edge,)
    if not all(outline.holds(one, given.size, given.squareness) for one in pushed):
        raise Refused(named(Objection.EDGE_ON_HULL), "some of the part", "none on its outer side")
    angles = {"beta": given.misalignment, "direction": given.direction}
    if frame.mirrored:
        angles = {name: negative(side) for name, side in angles.items()}
    box = {
        "x": own.x,
        "y": own.y,
        "theta": shift(own.theta, -edge.turn),
        "turn": side_of(edge.turn),
        "sensed_x": given.sensed,
        "sensed_y": given.sensed,
        "probe_x": given.probe,
        "probe_y": given.probe,
        "passive_x": given.probe,
        "passive_y": given.probe,
        **angles,
        "spacing": shift(given.spacing, given.apart),
        "scale": given.scale,
        "radius_upper": given.radius,
        "radius_lower": given.radius,
        "radius_passive": given.passive_radius,
        "depth": shift(given.size, edge.d1),
        "kappa": given.squareness,
        "size_other": given.size,
        "kappa_other": given.squareness,
        **dict.fromkeys(MOVING, NOTHING if given.centre_moves else given.drag_centre),
        **dict.fromkeys(("wander_x", "wander_y", "wander_x_now", "wander_y_now"), given.wander),
        **_film(given),
        **_friction(given),
    }
    return Scene(
        rule=rule,
        frame=frame,
        box={name: NOTHING if is_nothing(side) else side for name, side in box.items()},
        outline=outline,
        edge=edge,
        far=far,
        askew=askew,
        corner_radius=given.corner_radius,
    )


def _film(given: Given) -> Box:
    """Drag, and slope of the path: on the way and at the instant that is looked at."""
    most = given.wander[1] / WANDERS_IN
    bend = (-most, most)
    changing = {
        "rho": given.film_ratio,
        "stretch": given.anisotropy,
        "shear": given.anisotropy,
        "bend": given.wander if given.wander[0] is given.wander[1] else bend,
        **dict.fromkeys(MOVING.values(), given.drag_centre if given.centre_moves else NOTHING),
    }
    now = {f"{name}_now": side for name, side in changing.items()}
    if given.film_constant:
        del now["rho_now"]
    return {**changing, **now}


def _friction(given: Given) -> Box:
    if given.common_friction:
        return {"mu": given.friction}
    return {f"mu_{tip}": given.friction for tip in ("upper", "lower", "passive")}


def direction(angle: Dual) -> tuple[Dual, Dual]:
    """Cosine and sine."""
    s, c = angle.sin_cos()
    return c, s
