"""A two-sided rotation, as a whole: start, push onto the passive tip, turn between both tips.

The first stage is ``approach.py``, the second ``slide.py``; this file joins them and looks after the
idle tip and the end.

While both tips can touch none is left: if the part left S, D alone would push it and its far edge
would close on S again (it would press, and S's force is positive for all friction ratios); if it left D, it
would rest, as S rests, and D would run into it. Motion exists: the forces are positive for all
ratios of either tip and the map from slip directions to speeds has a fixed point, because the divisor
of ``grip.py`` vanishes nowhere.

Of the ratios of D those from -mu to 0 are enough where D alone, without friction, lets the part slip
forward: the slip grows with the ratio (``film.py``), so with a positive ratio the part would slip forward
as well, against which friction would pull it back. D alone thus has no positive ratio, and closes the
part on S. S's force has the sign of that closing at the same ratio, whatever S's own. If it vanishes at a
positive ratio of D, take that as the end of D's cone: a fixed point there would be D alone at a
positive ratio, which cannot be; so any fixed point is a motion.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt
from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.approach import Approach, approaches, pose_from
from meso_robust.checker.dual import Dual, Point, once
from meso_robust.checker.grip import D, Drag, Forces, Grip, Real, S
from meso_robust.checker.ids import Must, Objection, Property, named
from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.outline import Edge, Neighbour, Rectangle
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
from meso_robust.checker.ranges import (
    ZERO,
    Around,
    Box,
    Formula,
    Side,
    component,
    hull,
    least,
    lows,
    positive,
    shift,
    span,
    whole,
)
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, Variables, prove
from meso_robust.checker.rows import Rows, boxes_of, lowest
from meso_robust.checker.scene import Scene
from meso_robust.checker.slide import (
    CUTS,
    Between,
    Piece,
    Start,
    drag_of,
    enclose,
    grip_of,
    ratios_of,
)

IDLE = 1
"""The upper tip of the active probe touches nothing; the lower one pushes."""
NEAR = 2e-7
"""How closely the touch is bounded, m."""
NEAR_FORCE = 0.05
"""How closely forces are bounded, over drag and speed."""
SIGNS = (-1, 1)
MOST_LEAN = arb("0.78")
"""rad out of parallel, beyond which two edges are no opposite ones."""
AHEAD = "ahead"
"""A variable: how far the part is ahead of the passive tip."""
LABELS = {"begun": "theta", "turned": "turned"}
"""What tells how a part came to both tips: its barriers have slopes along it."""


@dataclasses.dataclass(frozen=True, slots=True)
class Landing:
    """How a rotation comes to both tips, as far as it is proved."""

    pair: Pair
    """Both tips, with the turn until the part rests on them."""
    stages: tuple[Approach, ...]
    """Of the push by the active tip alone."""
    spans: tuple[Side, ...]
    """h at the touch, of each stage in which there can be one."""
    box: Box
    """Ranges of all that a grip of both tips depends on."""
    before: tuple[Requirement, ...]
    """What is proved of the start, and of that push."""
    during: tuple[Requirement, ...]

    @property
    def touching(self) -> tuple[Approach, ...]:
        """The stages in which both tips can touch first."""
        return tuple(one for one in self.stages if one.rests is not None)

    @property
    def h(self) -> Side:
        """Ends of h at the touch, m."""
        return functools.reduce(hull, self.spans)

    def starts(self) -> list[Start]:
        """Where the turn between both tips can begin."""
        return [
            Start(one.box_at_touch(), one.lead, self.at_touch, own, LABELS, like=id(one.trend))
            for one, own in zip(self.touching, self.spans, strict=True)
        ]

    def at_touch(self, at: Point) -> Point:
        """What barriers are linear in when both tips touch."""
        return self.known(at, {"stray": at["stray"]} if "stray" in at else {})

    def known(self, at: Point, more: dict[str, Dual]) -> dict[str, Dual]:
        """What is constant during a run, and what else is told."""
        return {**self.pair.constants(at), **more}


def _far_force_faces(pair: Pair) -> None:
    """Refuse edges so far out of parallel that a force in the far one's cone of friction may not face the pushed one.

    In the axes of that its ratio would be none.
    """
    box = pair.box
    tilt = whole(box["kappa_far"]) - whole(box["kappa"])
    friction = whole(box["mu" if "mu" in box else "mu_passive"])
    if not abs(friction * tilt.tan()) < 1:
        most = (1 / friction).atan()
        raise Refused(named(Objection.EDGES_OPPOSITE), str(abs(tilt)), f"less than {most}")


def landing(scene: Scene, *more: Requirement) -> Landing:
    """Prove how a counter-clockwise rotation comes to both tips.

    Parameters
    ----------
    scene
        The move.
    more
        What else must hold before it starts.

    Raises
    ------
    Refused
        A requirement does not follow.
    """
    if not abs(scene.askew) < MOST_LEAN:
        raise Refused(named(Objection.EDGES_OPPOSITE), float(scene.askew), float(MOST_LEAN))
    if scene.rule.side != 1:
        raise Refused(named(Objection.SIDE_OF_MOVE, action="rotate"), scene.rule.side, 1)
    pair = Pair(scene)
    _far_force_faces(pair)
    before = (*free_at_start(scene, (ACTIVE, IDLE)), _passive_free(pair), *more)
    prove_all(before)
    stages = approaches(pair)
    touching = [(one, one.rests) for one in stages if one.rests is not None]
    during = tuple(map(_of_all, zip(*(one.requirements() for one in stages), strict=True)))
    prove_all(during)
    held = Pair(scene, functools.reduce(hull, (rests for _, rests in touching)))
    return Landing(
        pair=held,
        stages=stages,
        spans=tuple(span(one.h, one.box_at_touch(), within=NEAR) for one, _ in touching),
        box=held.ranges(),
        before=before,
        during=during,
    )


def check_rotate(scene: Scene) -> Passage:
    """Prove a counter-clockwise rotation from every pose of its scene.

    Raises
    ------
    Refused
        A requirement does not follow.
    """
    land = landing(scene, _no_jam(Pair(scene)))
    h_end = span(land.pair.h_end, land.pair.box)
    arrival = (*land.during, _rests(land.touching, h_end))
    prove(arrival[-1])
    turn = turn_until(land, h_end)
    after = turn.requirements()
    prove_all(after)
    return Passage(
        does=named(Property.TURNS_BETWEEN_TIPS),
        post=turn.post(),
        requirements=(*land.before, *arrival, *after),
        swept=(*(one.swept() for one in land.stages), *turn.swept()),
        largest_force=turn.largest_force,
    )


def prove_all(requirements: Iterable[Requirement]) -> None:
    """Prove some requirements.

    Raises
    ------
    Refused
        One does not follow.
    """
    for requirement in requirements:
        prove(requirement)


def _passive_free(pair: Pair) -> Requirement:
    """The passive tip stands off the line of the far edge."""
    variables: Variables = {
        "theta": lambda at: pair.scene.angle(at) + (pair.turned(at) or 0),
        "d1": lambda at: pair.depth_far(at) + at["radius_passive"],
        "dx": lambda at: -pair.passive(at)[0],
        "dy": lambda at: -pair.passive(at)[1],
    }
    return Requirement(
        name=named(Must.TIP_FREE_AT_START, tip="passive"),
        statement=st.CLEARANCE,
        parts=(Part(variables, pair.box),),
    )


def _no_jam(pair: Pair) -> Requirement:
    """A bound of the separation; that a motion exists is proved of every grip on the way."""
    mu, scene = pair.scene.mu(ACTIVE), pair.scene
    must, strays = named(Must.NO_JAM), not scene.exact("wander_x", "wander_y")

    def apart(at: Point) -> Dual:
        return pair.V(at) + pair.stray(at) if strays else pair.V(at)

    variables: Variables = {
        "V": apart,
        "width": lambda at: at["depth"] + pair.depth_far(at),
        "radii": lambda at: at["radius_lower"] + at["radius_passive"],
        "mu": lambda at: at[mu],
    }
    points: Variables = {"V": apart, "d1": lambda at: at["depth"], "mu": lambda at: at[mu]}
    required = Requirement(name=must, statement=st.NO_JAM, parts=(Part(variables, pair.box),))
    if not (scene.plain and isinstance(scene.outline, Rectangle)):
        return required
    other = Requirement(name=must, statement=st.NO_JAM_POINTS, parts=(Part(points, pair.box),))
    return dataclasses.replace(required, instead=(other,))


def _of_all(same: tuple[Requirement, ...]) -> Requirement:
    """One requirement of several approaches."""
    parts = tuple(part for one in same for part in one.parts)
    cover = tuple(part for one in same for part in one.cover or one.parts)
    return dataclasses.replace(same[0], parts=parts, cover=cover)


def _rests(touching: tuple[Approach, ...], h_end: Side) -> Requirement:
    def part(one: Approach) -> Part:
        variables: Variables = {"h_start": one.h, "h_end": lambda at: at["h_end"]}
        return Part(variables, {**one.box_at_touch(), "h_end": h_end})

    return Requirement(
        name=named(Must.RESTS_BEFORE_END),
        statement=st.RESTS,
        parts=tuple(map(part, touching)),
    )


@dataclasses.dataclass(frozen=True)
class Held:
    """The part held between both tips: at a point, or at many."""

    grip: Grip
    at: Mapping[str, Real]

    @property
    def ratios(self) -> tuple[Real, Real]:
        """Friction of D and of S."""
        return ratios_of(self.at)

    @property
    def drag(self) -> Drag:
        """The drag of the instant."""
        return drag_of(self.at)

    def forces(self, k: int, k_S: int) -> Forces:
        """The forces at shares of both cones."""
        mu_D, mu_S = self.ratios
        return self.grip.forces(self.drag, mu_D * k, mu_S * k_S)

    @functools.cached_property
    def corners(self) -> list[Forces]:
        """The forces at the corners of both cones; numerators and divisor are linear in the ratios."""
        return [self.forces(*ends) for ends in itertools.product(SIGNS, repeat=2)]


Spares = Sequence[Callable[[], Real]]
"""By how much something exceeds a bound, in several ways, each worked out if it is asked for."""
Spare = Callable[[Held, arb], Spares]
"""By how much a grip does."""


def _resting(forces: Forces, bound: arb) -> Real:
    """By how much the resting tip presses more than ``bound``."""
    return forces.resting - forces.divisor * bound


def turn_until(land: Landing, h_end: Side) -> Turn:
    """Prove how a rotation goes on from the touch of both tips until h is ``h_end``, m.

    Raises
    ------
    Refused
        The slide could not be enclosed, or on the way the grip may close, a tip be left or pass the end of
        its edge.
    """
    pieces = enclose(land.box, land.starts(), land.h, h_end)
    turn = Turn(land, pieces, (h_end[0], land.h[1]))
    turn.hold((Must.NO_JAM, (turn.open,)), *turn.kept)
    return turn


class Turn:
    """The turn between both tips, or a stretch of it."""

    def __init__(self, land: Landing, pieces: Sequence[Piece], h: Side) -> None:
        self.land, self.pieces, self.h = land, tuple(pieces), h
        self.pair, self.scene, self.box = land.pair, land.pair.scene, land.box
        self.around = Around.of(self.states())
        self.near = self._straight(self.scene.edge, "depth")
        before, beyond = self._straight(self.scene.far, "depth_far")
        self.far = beyond, before  # it runs the other way

    @property
    def kept(self) -> tuple[tuple[Must | Objection, tuple[Spare, ...]], ...]:
        """What keeps both tips on their edges and pressing, each in one of some ways."""
        return (
            (Must.ACTIVE_PRESSES, (self._pressed,)),
            (Must.BOTH_TIPS_TOUCH, (self._forces, self._forces_back)),
            (Must.BOTH_TIPS_ON_EDGES, (self._on_edges,)),
        )

    def hold(self, *musts: tuple[Must | Objection, tuple[Spare, ...]]) -> None:
        """Prove what must be positive in all grips, each in one of some ways.

        Raises
        ------
        Refused
            One of them is not proved to be.
        """
        for must, spares in musts:
            if not self._exceeds(ZERO, *spares):
                raise Refused(named(must), "more than 0", "not shown")

    def states(self) -> Box:
        """All grips of a piece."""
        return {**self.box, "done": UNIT, "share": UNIT}

    def _exceeds(self, bound: arb, *spares: Spare) -> bool:
        """Whether one of some things has more than ``bound`` to spare in all grips of each piece."""
        left = list(self.pieces)
        for spare in spares:
            left = self._left(left, spare, bound)
        return all(
            any(
                self._in_piece(functools.partial(self._spares, one, spare, bound))
                for spare in spares
            )
            for one in left
        )

    def _left(self, pieces: list[Piece], spare: Spare, bound: arb) -> list[Piece]:
        """The pieces of which it is not shown when all with barriers ahead of the same tips are looked at together."""
        found = []
        for tips in itertools.product((D, S), repeat=2):
            own = [one for one in pieces if (one.lower.tip, one.upper.tip) == tips]
            if own:
                shown = self._together(own, spare, bound)
                found += [one for one, is_so in zip(own, shown, strict=True) if not is_so]
        return found

    def _together(self, pieces: list[Piece], spare: Spare, bound: arb) -> npt.NDArray[np.bool_]:
        """Of which pieces it is shown."""
        between = Between(pieces)
        boxes, exact = boxes_of(self.states(), len(pieces))
        places = {name: k for k, name in enumerate(boxes.names)}

        def one(k: int, at: Mapping[str, Rows], which: npt.NDArray[np.int64]) -> Rows:
            known = {**exact, **at}
            found: Rows = spare(Held(between.grip(known, places, which), known), bound)[k]()
            return found

        count = len(self._spares(pieces[0], spare, bound, self.around.middle))
        with np.errstate(all="ignore"):  # what is not a number proves nothing
            lows = [lowest(functools.partial(one, k), boxes, 0.0, CUTS, 0.0) for k in range(count)]
        return np.all(np.array(lows) > 0, axis=0)

    def _in_piece(self, of: Callable[[Point], Spares]) -> bool:
        def every(at: Point) -> list[Dual]:
            return [one() for one in of(at)]

        def one(k: int, at: Point) -> Dual:
            return of(at)[k]()

        return all(
            low > 0 or positive(functools.partial(one, k), self.states())
            for k, low in enumerate(lows(every, self.around))
        )

    def _held(self, piece: Piece, at: Point) -> Held:
        return once((piece, "held"), at, lambda: Held(piece.grip(at), at))

    def _spares(self, piece: Piece, spare: Spare, bound: arb, at: Point) -> Spares:
        return spare(self._held(piece, at), bound)

    def open(self, held: Held, bound: arb) -> Spares:
        """The grip cannot close, whatever the ratios."""

        def spare(forces: Forces) -> Real:
            return forces.divisor - bound

        return [functools.partial(spare, one) for one in held.corners]

    def _pressed(self, held: Held, bound: arb) -> Spares:
        """D presses, also alone."""

        def spare(forces: Forces) -> Real:
            return forces.moving - bound

        def alone(k: int) -> Real:
            return held.grip.alone(held.drag, held.ratios[0] * k) - bound

        found = [functools.partial(spare, one) for one in held.corners]
        return [*found, *(functools.partial(alone, k) for k in SIGNS)]

    def _forces(self, held: Held, bound: arb) -> Spares:
        return [functools.partial(_resting, one, bound) for one in held.corners]

    def _forces_back(self, held: Held, bound: arb) -> Spares:
        """The same where D alone would let the part slip forward: of half of its cone."""
        half = (held.forces(k, k_S) for k, k_S in itertools.product((-1, 0), SIGNS))
        found = [functools.partial(_resting, one, bound) for one in half]
        return [functools.partial(held.grip.slides_alone, held.drag), *found]

    def _on_edges(self, held: Held, bound: arb) -> Spares:
        def spare(far: bool, reach: arb, sign: int) -> Real:
            return reach - bound + (held.grip.S_place if far else held.grip.D_place) * sign

        return [
            functools.partial(spare, far, reach, sign)
            for far, reaches in ((False, self.near), (True, self.far))
            for reach, sign in zip(reaches, (1, -1), strict=True)
        ]

    def largest_force(self) -> arb:
        """The largest normal force of all, over drag and commanded speed, friction not counted.

        The rate of travel along the line is at most the probe's speed.
        """
        first = ZERO
        for one in self.land.stages:
            first = first.max(span(one.force, one.box(), within=NEAR_FORCE)[1])
        states = self.states()

        def forces(piece: Piece, at: Point) -> tuple[Dual, ...]:
            corners = self._held(piece, at).corners
            return tuple(
                -(normal / one.divisor) for one in corners for normal in (one.moving, one.resting)
            )

        for piece in self.pieces:
            of = functools.partial(forces, piece)
            for k, low in enumerate(lows(of, self.around)):
                if -low > first:  # bounded with more care only where it may matter
                    low = low.max(least(component(of, k), states, within=NEAR_FORCE))
                first = first.max(-low)
        return first

    def _straight(self, edge: Edge, depth: str) -> tuple[arb, arb]:
        """How far the straight part of an edge reaches at least, before and beyond the part's foot, m."""
        scene = self.scene
        if scene.exact("kappa", "kappa_other", "size_other") and scene.corner_radius == 0:
            return -edge.first, edge.last
        if edge.ends is None:
            raise Refused(named(Objection.EDGE_ON_HULL), 0, "1 or more")
        size, kappa = whole(scene.box["size_other"]), whole(scene.box["kappa_other"])
        turned, deep = kappa - whole(scene.box["kappa"]), whole(self.box[depth])

        def reach(other: Neighbour) -> arb:
            corner = other.turn + turned
            s, c = corner.sin_cos()
            out = other.d1 + size
            return ((out - deep * c) / s - (corner / 2).tan() * scene.corner_radius).lower()

        return reach(edge.ends[0]), reach(edge.ends[1])

    def requirements(self) -> list[Requirement]:
        """What is asked of the turn until the end of the travel, and of the tips on their way back."""
        span_of = (Part({"h": lambda at: at["h"], "V": lambda at: at["V"]}, self.ends()),)
        while_turning = tuple(self.idle(piece) for piece in self._stages())

        def shown(must: Must, statement: st.Statement, *spares: Spare) -> Requirement:
            return Requirement(
                name=named(must),
                statement=statement,
                parts=(),
                cover=span_of,
                verify=lambda stated, bound: self._exceeds(bound, *spares),
            )

        return [
            shown(Must.BOTH_TIPS_TOUCH, st.PASSIVE_FORCE, self._forces, self._forces_back),
            shown(Must.BOTH_TIPS_ON_EDGES, st.TIPS_ON_EDGES, self._on_edges),
            passes("before_touch", (self.flight(),)),
            passes("early_in_turn", tuple(map(self.early, self.land.stages))),
            passes("late_in_turn", while_turning, cover=(self.at_end(),)),
            passes("on_withdrawal", (self.withdrawal(),)),
            self.comes_free(),
        ]

    def comes_free(self) -> Requirement:
        """Both edges face away from the ways on which the tips back off."""
        pushed = comes_free("both", self.end_angle, self.scene, self.end_box())
        if self.pair.parallel:
            return pushed

        def held(at: Point) -> Dual:
            return self.end_angle(at) + (self.pair.turned(at) or 0)

        far = comes_free("both", held, self.scene, self.end_box())
        return dataclasses.replace(pushed, parts=(*pushed.parts, *far.parts))

    def _stages(self) -> Iterator[Piece]:
        yield from self.pieces

    def ends(self) -> Box:
        """What the tips' distance is during the turn."""
        return {"h": self.h, "V": self._apart()}

    def _apart(self) -> Side:
        V = self.box["V"]
        if "stray" not in self.box:
            return V
        return V[0] + self.box["stray"][0], V[1] + self.box["stray"][1]

    def idle(self, piece: Piece) -> Part:
        """The upper tip while a piece is passed."""
        own = {
            name: self.scene.box[name] for name in ("beta", "spacing", "direction", "radius_upper")
        }

        def offset(at: Point) -> Dual:
            return piece.grip(at).D_place

        variables = self.beside(lambda at: _angle(piece.grip(at)), offset, constant(ZERO), "radius")
        return Part(variables, {**self.states(), **own})

    def beside(
        self, theta: Formula, offset: Formula, flight: Formula, radius: str = "radius_lower"
    ) -> Variables:
        """The upper tip while the lower one is ``flight`` short of its place on the edge."""
        scene = self.scene
        variables = dict(beside(scene, theta, offset, flight, IDLE))
        if not scene.exact("radius_upper", "radius_lower"):
            # centres: the line off which the upper one must be is moved by the difference of radii
            x, y = variables["dx"], variables["dy"]

            def more(at: Point) -> Dual:
                return at[radius] - at["radius_upper"]

            variables["dx"] = lambda at: x(at) + theta(at).sin_cos()[0] * more(at)
            variables["dy"] = lambda at: y(at) - theta(at).sin_cos()[1] * more(at)
        # the whole part is on one side of the line across the pushed edge that it reaches to
        out, across = scene.outline.extent(scene.edge)
        if scene.plain:
            return {**variables, "half": constant(out)}
        size, kappa = scene.box["size_other"], scene.box["kappa_other"]
        leaning = (abs(kappa[0]).max(abs(kappa[1])).sin() * across).upper()
        out = out + scene.outline.astray(size, kappa) + leaning
        return {**variables, "half": lambda at: at["radius_upper"] + out}

    def flight(self) -> Part:
        """Until the active tip touches the part."""
        scene = self.scene

        def short(at: Point) -> Dual:
            return at["share"] * (scene.ahead(at, ACTIVE) - touch(scene, at, ACTIVE).arm_x)

        variables = self.beside(scene.angle, lambda at: touch(scene, at, ACTIVE).d2, short)
        return Part(self._straying(variables), {**scene.box, "share": UNIT})

    def _straying(self, variables: Variables) -> Variables:
        """The same in the air, where the probe is not on the line of the touch or of the end."""
        pair = self.pair
        if self.scene.exact("wander_x", "wander_y"):
            return variables
        y = variables["dy"]
        return {**variables, "dy": lambda at: y(at) + pair.stray(at, "_now") - pair.stray(at)}

    def early(self, stage: Approach) -> Part:
        """Until the part rests on the passive tip."""
        variables = self.beside(stage.angle, stage.place, constant(ZERO))
        return Part(variables, stage.box())

    def end_box(self) -> Box:
        """The variables of the end, and of the way back."""
        return {**self.pair.box, "share": UNIT, "back": UNIT}

    def end_grip(self, at: Point) -> Grip:
        """The grip at the end of the travel."""
        strays = "stray" in self.box
        more = {"stray": self.pair.stray(at, "_now")} if strays else {}
        known = self.land.known(at, {**more, "share": at["share"]})
        return self.pieces[-1].grip_at(self.pair.h_end(at), known)

    def end_angle(self, at: Point) -> Dual:
        """Direction of the pushed edge then."""
        return _angle(self.end_grip(at))

    def at_end(self) -> Part:
        """The upper tip then."""
        return Part(self.beside_at_end(constant(ZERO)), self.end_box())

    def beside_at_end(self, short: Formula) -> Variables:
        """The same while the lower one is ``short`` of its place on the edge."""
        return self.beside(self.end_angle, lambda at: self.end_grip(at).D_place, short)

    def withdrawal(self) -> Part:
        """While the active probe backs off to its start."""
        scene = self.scene

        def way(at: Point) -> Dual:
            return at["back"] * (scene.ahead(at, ACTIVE) - scene.ahead_end(at, ACTIVE))

        return Part(self._straying(self.beside_at_end(way)), self.end_box())

    def swept(self) -> tuple[Sweep, ...]:
        """All poses between both tips."""
        box = {**self.pair.box, **self.pair.instants(), "done": UNIT, "share": UNIT}

        def pose(piece: Piece, at: Point) -> Pose:
            more = {name: at[name] for name in ("stray", "done", "share") if name in at}
            return self._pose(at, piece.grip(self.land.known(at, more)))

        return tuple(Sweep(functools.partial(pose, one), box, "done") for one in self.pieces)

    def _pose(self, at: Point, grip: Grip) -> Pose:
        return pose_from(self.pair, at, grip.c, grip.s, grip.b, grip.out_resting)

    def post(self) -> PoseBox:
        """All poses at the end, in the axes of the move."""
        box = {name: side for name, side in self.end_box().items() if name != "back"}

        def at_end(k: int, at: Point) -> Dual:
            return self._pose(at, self.end_grip(at))[k]

        x, y = (span(functools.partial(at_end, k), box, within=1e-9) for k in range(2))
        theta = span(self._end_theta, {**box, AHEAD: self._end_ahead(box)}, within=1e-9)
        return PoseBox(x=x, y=y, theta=shift(theta, self.scene.turn))

    def _end_ahead(self, box: Box) -> Side:
        """How far the part is ahead of the passive tip at the end."""
        return span(lambda at: -self.end_grip(at).b, box, within=1e-9)

    def _end_theta(self, at: Point) -> Dual:
        """Its orientation then, which hangs on that only as far as the edges are out of parallel."""
        strays = "stray" in self.box
        known = self.land.known(at, {"stray": self.pair.stray(at, "_now")} if strays else {})
        grip = grip_of(known, self.pair.h_end(at), S, at[AHEAD])
        return self.scene.stated(at, _angle(grip))


def _angle(grip: Grip) -> Dual:
    """Direction of the edges; ``s`` is positive throughout."""
    return arb.pi() / 2 - (grip.c / grip.s).atan()
