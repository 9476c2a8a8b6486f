"""The turn between both tips: barriers that no motion crosses.

While both tips touch the part has one freedom left, how far its reference point is ahead of a tip along
the pushed edge. Where that grows faster than at the rate at which a tip sticks, the part slips forward
over that tip and its friction ratio is ``-mu`` (``grip.py``).

A curve ``U(h)`` with the slope ``u`` per travel is an upper barrier if no motion on it has a rate ``y
>= u``. Assume one had. A tip that sticks at a rate below ``u`` is slipped over forwards then, its ratio
is ``-mu``. A tip that sticks at a rate ``v`` above ``u`` has the ratio ``mu`` if ``y < v``; that ``y >=
v`` is excluded separately, with any ratio of this tip. Otherwise the ratio is anything in its cone. The
rate is a quotient of two linear functions of either ratio, with a positive divisor, hence greatest at
ends of the cones: where it is below ``u`` (or ``v``) at all of those that are left, ``y`` cannot be.
Such a curve cannot be crossed, as a motion on it is slower by a margin than the curve is. For lower
barriers all signs change. Nothing is asked of the motion itself, which need not be unique.

What is constant during the run (the tips' distance across the push, edges, radii, the centre of drag,
how high the part was before) is known to a barrier, which is linear in it: there are as many curves
as values of the constants. Only friction, drag and the path's waviness are taken at their worst at
every instant. Where the path strays from its line, the barrier moves with it.

Barriers are cubic in ``h``, piece by piece; how they were found does not matter. A piece tells how far
the part is ahead of the tip that is thought to stick: that hardly changes.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable, Mapping
from functools import partial

from flint import arb

from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.film import EVEN
from meso_robust.checker.grip import D, Drag, Grip, S, Sides
from meso_robust.checker.guess import Flow, Guess, first_ahead
from meso_robust.checker.ids import Objection, named
from meso_robust.checker.pushing import UNIT
from meso_robust.checker.ranges import ZERO, Box, Formula, Side, least, point_of, positive, whole
from meso_robust.checker.refusal import Refused

LONG, SHORT = 4e-5, 6e-6
"""m; pieces are at most and, if they are no barrier, at least about as long."""
GROWS = 1.3
"""How much longer the next piece is tried."""
FEW = 1
"""Cuts of the box before a steeper slope is tried."""
CLOSE = 5e-5
"""How closely the least lead of a barrier over all motions is bounded; a slope, like the next two."""
LEAST = 1e-5
"""Added to any guess."""
STEEP = 5e-3
"""Added to a guess at most, if the piece can be cut instead."""
SETTLES = 0.3
"""Share of what was added to a piece that is first added to the next one."""
TRIES = 10
STARTS = 200
"""Cuts of the box of all places at which a turn can begin."""
BOTH = (-1, 1)
ROOM = 1e-12
"""m; between what must be held and what holds it."""
NEAR = 2e-8
"""m; how closely the slides at which a turn can begin are bounded."""
CONSTANT = (
    "V", "Z", "depth", "depth_far", "radius", "radius_far", "tilt", "drag_a", "drag_n", "stray",
)  # fmt: skip
"""What a barrier is linear in; the stray is not constant, its rate is the bend of the path."""
CLAIM = named(Objection.SLIDE_IN_TUBE)


@dataclasses.dataclass(frozen=True, slots=True)
class Cubic:
    """A cubic in the share of a piece that is done."""

    coefficients: tuple[float, float, float, float]

    @classmethod
    def through(cls, first: float, last: float, start: float, end: float) -> Cubic:
        """From values and slopes at both ends."""
        rise = last - first
        return cls((first, start, 3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise))

    def __call__(self, done: Dual) -> Dual:
        """Value."""
        a, b, c, d = map(arb, self.coefficients)
        return ((done * d + c) * done + b) * done + a

    def slope(self, done: Dual) -> Dual:
        """Derivative."""
        _, b, c, d = map(arb, self.coefficients)
        return (done * (3 * d) + 2 * c) * done + b

    @property
    def end(self) -> float:
        """A number near the value at the end."""
        return math.fsum(self.coefficients)


@dataclasses.dataclass(frozen=True, slots=True)
class Curve:
    """One piece of a barrier."""

    first: float
    """h at its start, m."""
    last: float
    tip: int
    """Ahead of which tip the part is told to be."""
    ahead: Cubic
    """Where all constants have their middle values."""
    slopes: Mapping[str, Cubic]
    """Change per change of a constant."""
    middle: Mapping[str, float]

    @property
    def length(self) -> arb:
        """Travel."""
        return arb(self.first) - arb(self.last)

    def done(self, h: Dual) -> Dual:
        """The share of the piece that is done."""
        return (arb(self.first) - h) / self.length

    def at(self, done: Dual, at: Point) -> Dual:
        """How far ahead the part is on the curve."""
        found = self.ahead(done)
        for name, cubic in self.slopes.items():
            found = found + cubic(done) * (at[name] - arb(self.middle[name]))
        return found

    def rate(self, done: Dual, at: Point) -> Dual:
        """Its change with the travel."""
        found = self.ahead.slope(done)
        for name, cubic in self.slopes.items():
            found = found + cubic.slope(done) * (at[name] - arb(self.middle[name]))
        found = found / self.length
        return found + self.slopes["stray"](done) * at["bend"] if "stray" in self.slopes else found

    def grip(self, done: Dual, at: Point) -> Grip:
        """The grip on the curve."""
        h = arb(self.first) - done * self.length
        return grip_of(at, h, self.tip, self.at(done, at))

    def steeper(self, by: float) -> Curve:
        """One that rises more along the piece."""
        a, b, c, d = self.ahead.coefficients
        return dataclasses.replace(self, ahead=Cubic((a, b + by, c, d)))

    def shifted(self, by: float) -> Curve:
        """One that is higher."""
        a, b, c, d = self.ahead.coefficients
        return dataclasses.replace(self, ahead=Cubic((a + by, b, c, d)))


@dataclasses.dataclass(frozen=True, slots=True)
class Piece:
    """A piece of the tube."""

    first: float
    """h at its start, m."""
    last: float
    lower: Curve
    upper: Curve

    def h(self, done: Dual) -> Dual:
        """Where h is when ``done`` of the piece is done."""
        return arb(self.first) - done * (arb(self.first) - arb(self.last))

    def grip(self, at: Point) -> Grip:
        """Any grip in the tube, by the shares ``done`` of the travel and ``share`` of the width."""
        return self.grip_at(self.h(at["done"]), at)

    def grip_at(self, h: Dual, at: Point) -> Grip:
        """The same by h."""
        low, high = self.lower, self.upper
        tip = low.tip if low.tip == high.tip else S
        ends = [curve.at(curve.done(h), at) for curve in (low, high)]
        for k, curve in enumerate((low, high)):
            if curve.tip != tip:
                ends[k] = ends[k] + grip_of(at, h, D, ends[k]).T
        return grip_of(at, h, tip, ends[0] + at["share"] * (ends[1] - ends[0]))


def sides_of(at: Point) -> Sides:
    """Edges, tips and centre of drag; what is left out is exactly zero."""
    return Sides(
        at["depth"], at["depth_far"], at["radius"], at["radius_far"],
        *(at.get(name, EVEN) for name in ("tilt", "drag_a", "drag_n")),
    )  # fmt: skip


def grip_of(at: Point, h: Dual, tip: int, ahead: Dual) -> Grip:
    """The grip in some state."""
    apart = at["V"] + at["stray"] if "stray" in at else at["V"]
    return Grip.at(sides_of(at), h, apart, tip, ahead, at.get("bend", EVEN))


def drag_of(at: Point) -> Drag:
    """The drag of an instant."""
    return Drag(at["rho"], at.get("stretch", EVEN), at.get("shear", EVEN))


def ratios_of(at: Point) -> tuple[Dual, Dual]:
    """Friction of D and of S."""
    return (at["mu"], at["mu"]) if "mu" in at else (at["mu_lower"], at["mu_passive"])


@dataclasses.dataclass(frozen=True, slots=True)
class Start:
    """Where both tips can touch first."""

    box: Box
    lead: Callable[[Point, Callable[[Dual], tuple[Dual, Dual]]], Dual]
    """How far a barrier is ahead, from how far ahead of S it is by h and its slope."""
    constants: Callable[[Point], Point]
    """What the barriers are linear in."""


def enclose(box: Box, start: Start, h: Side, h_end: Side) -> tuple[Piece, ...]:
    """Barriers from the touch of both tips to the end of the travel.

    Parameters
    ----------
    box
        Sides of all constants, and of what may change at every instant.
    start
        Where both tips can touch first.
    h, h_end
        h then, and at the end of the travel.

    Raises
    ------
    Refused
        No barrier was confirmed.
    """
    top, landed = _beyond(h[1], 1), _beyond(h[0], -1)
    near, bottom = _beyond(h_end[1], 1), _beyond(h_end[0], -1)
    if not landed > near:
        raise Refused(named(Objection.RESTS_WELL_BEFORE_END), landed, near)
    barriers = [_Barrier(box, start, side).pieces(top, landed, near, bottom) for side in BOTH]
    knots = sorted({h for one in barriers for c in one for h in (c.first, c.last)}, reverse=True)
    return tuple(
        Piece(first, last, *(_over(barrier, first, last) for barrier in barriers))
        for first, last in itertools.pairwise(knots)
    )


def _over(barrier: list[Curve], first: float, last: float) -> Curve:
    """The piece of a barrier that holds a range of h."""
    return next(curve for curve in barrier if curve.first >= first and last >= curve.last)


def _beyond(value: arb, side: int) -> float:
    """A double above (1) or below (-1) a number."""
    return math.nextafter(float(value), side * math.inf) + side * ROOM


class _Barrier:
    """One barrier, piece by piece; a curve that is not confirmed is tried again with a steeper slope."""

    def __init__(self, box: Box, start: Start, side: int) -> None:
        self.box, self.start, self.side = box, start, side
        reach = {name: float(whole(s).rad()) for name, s in box.items() if s[0] is not s[1]}
        self.flow = Flow(
            middle={name: float(whole(s).mid()) for name, s in box.items()},
            reach=reach,
            side=side,
        )
        self.corners = self.flow.corners()
        self.names = [name for name in CONSTANT if name in reach]
        self.spare = LEAST

    def pieces(self, top: float, landed: float, near: float, bottom: float) -> list[Curve]:
        """The whole barrier; its first piece holds every start, its last one every end."""
        curve = self._next(top, landed, self._begin(top))
        raised = self._raised(self._ahead(curve), self.start.box)
        found = [self._steep(curve.shifted(raised), math.inf)]
        length = LONG
        while (first := found[-1].last) > near:
            last = first - length if first - near > 1.5 * length else near
            curve = self._next(first, last, self._handed_on(found[-1]))
            try:
                found.append(self._steep(curve, STEEP if length > SHORT else math.inf))
                length = min(GROWS * length, LONG)
            except Refused:
                if length <= SHORT:
                    raise
                length = max(length / 2, SHORT)
        return [*found, self._steep(self._next(near, bottom, self._handed_on(found[-1])), math.inf)]

    def _begin(self, h: float) -> Guess:
        """The first guess: how a start depends on the constants."""
        middle, reach = self.flow.middle, self.flow.reach

        def slope(name: str) -> float:
            low, high = (
                first_ahead(h, {**middle, name: middle[name] + sign * reach[name]}) for sign in BOTH
            )
            return (high - low) / (2 * reach[name])

        return Guess(S, first_ahead(h, middle), {name: slope(name) for name in self.names})

    def _next(self, first: float, last: float, at: Guess) -> Curve:
        """A curve that is as fast as any motion."""
        length = first - last
        corner = self.flow.worst(first, at, self.corners)
        before = self.flow.change(first, at, corner)
        end = self.flow.step(first, length, at, before, corner)
        after = self.flow.change(last, end, self.flow.worst(last, end, self.corners))

        def cubic(of: Callable[[Guess], float]) -> Cubic:
            return Cubic.through(of(at), of(end), length * of(before), length * of(after))

        slopes = {name: cubic(partial(_slope, name)) for name in self.names}
        return Curve(first, last, at.tip, cubic(lambda one: one.ahead), slopes, self.flow.middle)

    def _handed_on(self, curve: Curve) -> Guess:
        """Where the next piece begins: where this one ends or beyond, for all constants."""
        h, slopes = curve.last, {name: cubic.end for name, cubic in curve.slopes.items()}
        at = Guess(curve.tip, curve.ahead.end + self.side * ROOM, slopes)
        tip = self.flow.sticks(h, at, self.flow.worst(h, at, self.corners))
        if tip == at.tip:
            self._no_gap(curve, at)
            return at
        seen = self.flow.ahead_of(tip, h, at)

        def beyond(point: Point) -> Dual:
            told = curve.at(Dual(arb(1)), point)
            grip = grip_of(point, Dual(arb(h)), curve.tip, told)
            own = told - grip.T if curve.tip == S else told + grip.T
            new: Dual = Dual(arb(seen.ahead)) - own
            for name, slope in seen.slopes.items():
                new = new + (point[name] - arb(self.flow.middle[name])) * arb(slope)
            return new * self.side

        raised = self._raised(beyond, self.box)
        return dataclasses.replace(seen, ahead=seen.ahead + raised)

    def _raised(self, beyond: Formula, box: Box) -> float:
        """By how much a value must be moved for ``beyond`` to be positive."""
        missing = least(beyond, box, within=NEAR, cuts=STARTS)
        raised = max(-float(missing), 0.0) + ROOM
        if not missing + arb(raised) > ROOM / 2:
            raise Refused(
                CLAIM, "holds every state in which both tips can touch first", "not shown"
            )
        return self.side * raised

    def _ahead(self, curve: Curve) -> Formula:
        """How far a curve is beyond the places at which a turn can begin."""

        def spare(at: Point) -> Dual:
            known = {**self.start.constants(at), "bend": Dual(ZERO)}

            def barrier(h: Dual) -> tuple[Dual, Dual]:
                done = curve.done(h)
                return curve.at(done, known), curve.rate(done, known)

            return self.start.lead(at, barrier) * self.side

        return spare

    def _steep(self, curve: Curve, most: float) -> Curve:
        """The curve, as much steeper as it must be to be a barrier."""
        spare, length = max(LEAST, SETTLES * self.spare), curve.first - curve.last
        for _ in range(TRIES):
            steeper = curve.steeper(self.side * spare * length)
            lead = least_lead(steeper, self.box, self.side)
            if lead > 0:
                self.spare = spare
                return steeper
            # a lead may be short only as it is open which tip is slipped over which way
            spare += min(1.2 * -float(lead) + LEAST, 2 * spare + 10 * LEAST)
            if not spare < most:
                break
        raise Refused(
            CLAIM, "a barrier", f"none at h = {curve.first:.6g} m: the tips may close on the part"
        )

    def _no_gap(self, before: Curve, at: Guess) -> None:
        one = Dual(arb(1))
        step = (arb(at.ahead) - before.ahead(one).value) * self.side
        for name, cubic in before.slopes.items():
            turned = arb(at.slopes[name]) - cubic(one).value
            step -= abs(turned) * abs(whole(self.box[name]) - arb(self.flow.middle[name]))
        if not step >= 0:
            raise Refused(CLAIM, "without a gap", "a gap")


def _slope(name: str, of: Guess) -> float:
    return of.slopes[name]


@dataclasses.dataclass(frozen=True, slots=True)
class _OnCurve:
    """A curve and the motions on it."""

    grip: Grip
    rate: Dual
    drag: Drag
    friction: tuple[Dual, Dual]

    def ahead(self, level: Dual, k_D: int, k_S: int) -> Dual:
        """Positive where a motion with these ratios is slower than ``level``."""
        at_D, at_S = self.friction
        opposite = at_D is at_S and k_D == -k_S
        found: Dual = self.grip.rate(self.drag, at_D * k_D, at_S * k_S, opposite)
        return level - found


Level = Callable[[_OnCurve], Dual]


def _faster(of: Level, on: _OnCurve) -> Dual:
    return on.rate - of(on)


def _slower(of: Level, on: _OnCurve) -> Dual:
    return of(on) - on.rate


def least_lead(curve: Curve, box: Box, side: int) -> arb:
    """By how much the curve is faster than every motion on it at least (see the module's text)."""
    states: Box = {**box, "done": UNIT}

    def on_curve(at: Point) -> _OnCurve:
        done = at["done"]
        return _OnCurve(curve.grip(done, at), curve.rate(done, at), drag_of(at), ratios_of(at))

    def exceeds(one: Callable[[_OnCurve], Dual]) -> bool:
        return positive(lambda at: one(on_curve(at)) * side, states, cuts=FEW)

    sticks: tuple[Level, ...] = (lambda on: on.grip.stick(D), lambda on: on.grip.stick(S))
    glance = on_curve(point_of(states))
    seen = [(glance.rate - of(glance)).value * side for of in sticks]
    below = [
        not lead < 0 and (lead > 0 or exceeds(partial(_faster, of)))
        for lead, of in zip(seen, sticks, strict=True)
    ]
    above = [
        not under and (lead < 0 or exceeds(partial(_slower, of)))
        for lead, under, of in zip(seen, below, sticks, strict=True)
    ]
    ratios = [_ratios(under, over, side) for under, over in zip(below, above, strict=True)]
    levels: list[tuple[Level, list[tuple[int, ...]]]] = [(lambda on: on.rate, ratios)]
    for tip in (0, 1):
        if above[tip]:
            other = (-side,) if below[1 - tip] else BOTH
            levels.append((sticks[tip], [BOTH, other] if tip == 0 else [other, BOTH]))
    found = arb("inf")
    for level, pairs in levels:
        for k_D, k_S in itertools.product(*pairs):

            def lead(at: Point, level: Level = level, k_D: int = k_D, k_S: int = k_S) -> Dual:
                on = on_curve(at)
                return on.ahead(level(on), k_D, k_S) * side

            low = least(lead, states, within=CLOSE, cuts=FEW)
            found = found.min(low)
    return found


def _ratios(below: bool, above: bool, side: int) -> tuple[int, ...]:
    """Friction ratios, over mu, of a tip while the slide is about as fast as the curve.

    ``below``: the rate at which the tip sticks is proved to be below the curve's slope.
    """
    if below:
        return (-side,)
    return (side,) if above else BOTH
