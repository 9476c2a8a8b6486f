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
as values of the constants. Only friction, drag (with its centre, where that moves) and the path's waviness
are taken at their worst at every instant. Where the path strays from its line, the barrier moves with it.

Barriers are cubic in ``h``, piece by piece; how they were found does not matter. A piece tells how far
the part is ahead of the tip that is thought to stick: that hardly changes.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
from flint import arb

from meso_robust.checker.dual import Dual, Point, once
from meso_robust.checker.film import EVEN, MOVING
from meso_robust.checker.grip import D, Drag, Grip, Real, S, Sides
from meso_robust.checker.guess import Flow, Guess, first_ahead, rate
from meso_robust.checker.ids import Objection, named
from meso_robust.checker.pushing import UNIT
from meso_robust.checker.ranges import ZERO, Box, Side, whole
from meso_robust.checker.refusal import Refused
from meso_robust.checker.rows import (
    Boxes,
    Ends,
    Floats,
    Rows,
    boxes_of,
    boxes_of_all,
    choose,
    ends_of,
    halves,
    joined,
    lowest,
    varies,
)

LONG, SHORT = 7e-2, 7e-3
"""Of the width between the pushed edges; pieces are at most and, if they are no barrier, at least about
as long."""
CUTS, HALVED = 4, 1
"""How often a box is cut in four or in two before something else is tried (a steeper slope, or balls): for a closer
bound, and where it is open which tip is slipped over which way."""
CLOSE = 2e-5
"""How closely the least lead of a barrier over all motions is bounded: a slope, like the next two."""
LEAST = 1e-5
"""Lead that is asked for, so that pieces after a steeper one need not be tried again and again."""
STEEP = 5e-3
"""Added to a guess at most, if the piece can be cut instead."""
MOST = 0.3
"""The same at a time."""
MOST_PARTS = 8
"""Into which a piece is cut at a time."""
FINER, TRIES = 1, 36
"""How often pieces are cut, and cut or made steeper."""
STRETCH, LONGER = 2, 2.0
"""Pieces that are looked at together, before they are cut; how many times as long as the last one they may
be at first."""
STEP = 2e-3
"""Of the width; a piece that would have to rise by more is cut later, too: the path comes near a slide."""
STARTS = 3
"""How often the box of all places at which a turn can begin is cut in four."""
BOTH = (-1, 1)
ROOM = 1e-12
"""m; between what must be held and what holds it."""
NEAR = 1e-4
"""Of the width; how closely the slides at which a turn can begin are bounded."""
CONSTANT = (
    "V", "Z", "begun", "turned", "depth", "depth_far", "radius", "radius_far", "tilt", "drag_a", "drag_n",
    "stray",
)  # fmt: skip
"""What a barrier is linear in; the stray is not constant, its rate is the bend of the path."""
CLAIM = named(Objection.SLIDE_IN_TUBE)
Where = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]


@dataclasses.dataclass(frozen=True, slots=True)
class Cubic:
    """A cubic in the share of a piece that is done."""

    coefficients: tuple[float, float, float, float]

    @classmethod
    def through(cls, first: float, last: float, start: float, end: float) -> Cubic:
        """From values and slopes at both ends."""
        rise = last - first
        return cls((first, start, 3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise))

    def __call__(self, done: Real) -> Real:
        """Value."""
        a, b, c, d = self.coefficients
        if isinstance(done, Dual):  # fewer places where a ball may grow than by the product rule
            return done.through(self(done.value), self.slope(done.value))
        return ((done * d + c) * done + b) * done + a

    def slope(self, done: Real) -> Real:
        """Derivative."""
        _, b, c, d = self.coefficients
        return (done * d * 3 + 2 * c) * done + b  # twice a double is one

    @property
    def end(self) -> float:
        """A number near the value at the end."""
        return math.fsum(self.coefficients)

    def raised(self, by: float, steeper: float) -> Cubic:
        """One that is higher at the start, and rises more along the piece."""
        a, b, c, d = self.coefficients
        return Cubic((a + by, b + steeper, c, d))


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
    def key(self) -> tuple[float, ...]:
        """All that tells it from other curves of one barrier."""
        cubics = (self.ahead, *self.slopes.values())
        ends = (self.first, self.last, float(self.tip))
        return (*ends, *(value for cubic in cubics for value in cubic.coefficients))

    @property
    def end(self) -> Guess:
        """Where it ends."""
        slopes = {name: cubic.end for name, cubic in self.slopes.items()}
        return Guess(self.tip, self.ahead.end, slopes)

    @property
    def length(self) -> arb:
        """Travel."""
        return arb(self.first) - arb(self.last)

    def done(self, h: Real) -> Real:
        """The share of the piece that is done."""
        return (arb(self.first) - h) / self.length

    def at(self, done: Real, at: Mapping[str, Real]) -> Real:
        """How far ahead the part is on the curve."""
        found = self.ahead(done)
        for name, cubic in self.slopes.items():
            found = found + cubic(done) * (at[name] - self.middle[name])
        return found

    def rate(self, done: Real, at: Mapping[str, Real]) -> Real:
        """Its change with the travel."""
        found = self.ahead.slope(done)
        for name, cubic in self.slopes.items():
            found = found + cubic.slope(done) * (at[name] - self.middle[name])
        found = found / self.length
        return found + self.slopes["stray"](done) * at["bend"] if "stray" in self.slopes else found

    def raised(self, by: float, steeper: float) -> Curve:
        """One that is higher at the start, and rises more along the piece."""
        return dataclasses.replace(self, ahead=self.ahead.raised(by, steeper))

    def grip(self, done: Real, at: Mapping[str, Real]) -> Grip:
        """The grip on the curve."""
        h = arb(self.first) - done * self.length
        return grip_of(at, h, self.tip, self.at(done, at))


class _Curves:
    """Curves ahead of one tip, as arrays."""

    def __init__(self, curves: Sequence[Curve]) -> None:
        one = curves[0]
        self.tip, self.names = one.tip, tuple(one.slopes)
        self.middle = np.array([one.middle[name] for name in self.names])[:, None]
        self.first, self.last = (
            np.array([getattr(curve, end) for curve in curves]) for end in ("first", "last")
        )
        # (4, 1 + slopes, curves)
        self.coefficients = np.array(
            [
                [curve.ahead.coefficients, *(curve.slopes[n].coefficients for n in self.names)]
                for curve in curves
            ]
        ).transpose(2, 1, 0)

    def on(
        self, at: Mapping[str, Rows], places: Mapping[str, int], which: Where
    ) -> tuple[Grip, Rows]:
        """The grip on some of the curves, and the rates of these."""
        done = at["done"]
        value, slope, bent = self._polynomials(done, which)
        length = Rows.constant(self.first[which]) - Rows.constant(self.last[which])
        ahead = self._linear(at, places, done, value, slope.over(done))
        rate = self._linear(at, places, done, slope, bent.over(done)) / length
        if "stray" in self.names:
            own, ramp = (one.row(1 + self.names.index("stray")) for one in (value, slope))
            rate = rate + joined(own, {places["done"]: ramp.over(done)}, done) * at["bend"]
        h = Rows.constant(self.first[which]) - done * length
        return grip_of(at, h, self.tip, ahead), rate

    def ahead(
        self, at: Mapping[str, Rows], places: Mapping[str, int], which: Where, h: Rows
    ) -> Rows:
        """How far the part is ahead on some of the curves, by h, which changes with ``done`` alone."""
        first, last = (Rows.constant(ends[which]) for ends in (self.first, self.last))
        done = (first - h) / (first - last)
        value, slope, _ = self._polynomials(done, which)
        per = Ends(done.slopes()[:, places["done"], None])
        return self._linear(at, places, done, value, slope.over(done) * per)

    def _polynomials(self, done: Rows, which: Where) -> tuple[Ends, Ends, Ends]:
        """The cubics of some of the curves, with their first and second derivatives."""
        a, b, c, d = map(Ends.exactly, self.coefficients[..., which])
        share = Ends.of([done])
        value = ((share * d + c) * share + b) * share + a
        return value, (share * d * THREE + c * TWO) * share + b, share * d * SIX + c * TWO

    def guessed(self, flow: Flow, corners: Mapping[str, Floats]) -> Floats:
        """By how much each curve is faster than motions at some values of the constants: a guess."""
        done, constants = np.array([0.0, 0.5, 1.0]), flow.tried()
        a, b, c, d = self.coefficients[..., None]
        value, slope = ((d * done + c) * done + b) * done + a, (3.0 * d * done + 2.0 * c) * done + b
        off = np.array([constants[name] for name in self.names]) - self.middle
        length = self.first - self.last
        ahead, gain = (
            one[0][:, None] + np.einsum("ncd,ns->csd", one[1:], off) for one in (value, slope)
        )
        gain = gain / length[:, None, None]
        h = self.first[:, None, None] - done * length[:, None, None]
        best = flow.rivals(h[:, :, 1], self.tip, value[0][:, 1, None], corners)
        now = {name: own[best][:, None, None] for name, own in corners.items()}
        run = {name: own[:, None, None] for name, own in constants.items()}
        known = {**flow.middle, **run, **now}
        fastest = rate(h[..., None], self.tip, ahead[..., None], known)
        if "stray" in self.names:
            own = value[1 + self.names.index("stray")][:, None, :, None]
            fastest = fastest - own * now.get("bend", 0.0)
        lead = flow.side * (gain[..., None] - fastest)
        return lead.reshape(len(length), -1).min(axis=1)

    def _linear(
        self,
        at: Mapping[str, Rows],
        places: Mapping[str, int],
        done: Rows,
        value: Ends,
        slope: Ends,
    ) -> Rows:
        """What is linear in the constants: the first row and the others times their changes."""
        if not self.names:
            return joined(value.row(0), {places["done"]: slope.row(0)}, done)
        off = Ends.of([at[name] for name in self.names]) + Ends.exactly(-self.middle)
        found = value.row(0) + (value.rows() * off).total()
        ramp = slope.row(0) + (slope.rows() * off.over(done)).total()
        slopes = {places[name]: value.row(1 + k).over(done) for k, name in enumerate(self.names)}
        return joined(found, {**slopes, places["done"]: ramp}, done)


TWO, THREE, SIX = (Ends.exactly(np.full((1, 1), value)) for value in (2.0, 3.0, 6.0))


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A piece of the tube, equal only to itself."""

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
        return once((self, "grip"), at, lambda: self.grip_at(self.h(at["done"]), at))

    def grip_at(self, h: Dual, at: Point) -> Grip:
        """The same by h."""
        low, high = self.lower, self.upper
        tip = low.tip if low.tip == high.tip else S
        ends = [curve.at(curve.done(h), at) for curve in (low, high)]
        for k, curve in enumerate((low, high)):
            if curve.tip != tip:
                ends[k] = ends[k] + grip_of(at, h, D, ends[k]).T
        return grip_of(at, h, tip, ends[0] + at["share"] * (ends[1] - ends[0]))


class Between:
    """Grips between the barriers of several pieces as arrays: all lower ones ahead of one tip, all upper ones too."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.lower, self.upper = (
            _Curves([getattr(piece, end) for piece in pieces]) for end in ("lower", "upper")
        )
        self.first, self.last = (
            np.array([getattr(piece, end) for piece in pieces]) for end in ("first", "last")
        )

    def grip(self, at: Mapping[str, Rows], places: Mapping[str, int], which: Where) -> Grip:
        """Any grip in some of the pieces, by the shares ``done`` of the travel and ``share`` of the width."""
        first, last = (Rows.constant(ends[which]) for ends in (self.first, self.last))
        h = first - at["done"] * (first - last)
        tip = self.lower.tip if self.lower.tip == self.upper.tip else S
        ends = [one.ahead(at, places, which, h) for one in (self.lower, self.upper)]
        for k, curves in enumerate((self.lower, self.upper)):
            if curves.tip != tip:
                ends[k] = (ends[k] + grip_of(at, h, D, ends[k]).T).tight()
        return grip_of(at, h, tip, ends[0] + at["share"] * (ends[1] - ends[0]))


def sides_of(at: Mapping[str, Real]) -> Sides:
    """Edges, tips and centre of drag; what is left out is exactly zero."""
    return Sides(
        at["depth"], at["depth_far"], at["radius"], at["radius_far"],
        at.get("tilt", EVEN),
        *(at.get(fixed, at.get(moving, EVEN)) for fixed, moving in MOVING.items()),
    )  # fmt: skip


def grip_of(at: Mapping[str, Real], h: Real, tip: int, ahead: Real) -> Grip:
    """The grip in some state."""
    apart = at["V"] + at["stray"] if "stray" in at else at["V"]
    return Grip.at(sides_of(at), h, apart, tip, ahead, at.get("bend", EVEN))


def drag_of(at: Mapping[str, Real]) -> Drag:
    """The drag of an instant."""
    return Drag(at["rho"], at.get("stretch", EVEN), at.get("shear", EVEN))


def ratios_of(at: Mapping[str, Real]) -> tuple[Real, Real]:
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
    h: Side
    """What h can be then."""
    labels: Mapping[str, str] = dataclasses.field(default_factory=dict)
    """Constants on which only the start depends, and the variables that they grow with."""
    like: Hashable = dataclasses.field(default_factory=object)
    """The same of starts that differ in box and h alone."""


def enclose(box: Box, starts: Sequence[Start], h: Side, h_end: Side) -> tuple[Piece, ...]:
    """Barriers from the touch of both tips to the end of the travel.

    Parameters
    ----------
    box
        Sides of all constants, and of what may change at every instant.
    starts
        Where both tips can touch first.
    h, h_end
        h then, and at the end of the travel.

    Raises
    ------
    Refused
        No barrier was confirmed.
    """
    top, landed = beyond(h[1], 1), beyond(h[0], -1)
    near, bottom = beyond(h_end[1], 1), beyond(h_end[0], -1)
    if not landed > near:
        raise Refused(named(Objection.RESTS_WELL_BEFORE_END), landed, near)
    with np.errstate(all="ignore"):  # what is not a number proves nothing
        barriers = [_Barrier(box, starts, side).pieces(top, landed, near, bottom) for side in BOTH]
    knots = sorted({h for one in barriers for c in one for h in (c.first, c.last)}, reverse=True)
    return tuple(
        Piece(first, last, *(_over(barrier, first, last) for barrier in barriers))
        for first, last in itertools.pairwise(knots)
    )


def _over(barrier: list[Curve], first: float, last: float) -> Curve:
    """The piece of a barrier that holds a range of h."""
    return next(curve for curve in barrier if curve.first >= first and last >= curve.last)


def beyond(value: arb, side: int) -> float:
    """A double above (1) or below (-1) a number."""
    return math.nextafter(float(value), side * math.inf) + side * ROOM


@dataclasses.dataclass(frozen=True, slots=True)
class _Leg:
    """A piece of a path that is as fast as any motion, in floating point."""

    first: float
    last: float
    at: Guess
    end: Guess
    before: Guess
    """Rates at the start, and at the end."""
    after: Guess
    drift: float
    """Change of the rate with how far the part is ahead, 1/m."""

    @property
    def length(self) -> float:
        return self.first - self.last


class _Barrier:
    """One barrier: the path of the fastest motion, made steeper where it is overtaken."""

    def __init__(self, box: Box, starts: Sequence[Start], side: int) -> None:
        self.box, self.starts, self.side = box, starts, side
        reach = {name: float(whole(s).rad()) for name, s in box.items() if varies(s)}
        self.flow = Flow(
            middle={name: float(whole(s).mid()) for name, s in box.items()},
            reach=reach,
            side=side,
        )
        self.corners = self.flow.corners()
        self.names = [name for name in CONSTANT if name in reach]
        self.states = {**box, "done": UNIT}
        self.known: dict[tuple[float, ...], tuple[float, float]] = {}
        self.begun: dict[tuple[float, ...], float] = {}
        self.landed = min(beyond(one.h[0], -1) for one in starts)

    def pieces(self, top: float, landed: float, near: float, bottom: float) -> list[Curve]:
        """The whole barrier; its first stretch holds every start, the last piece every end.

        Stretch by stretch: what is found to be behind is moved before what comes after it is looked at.
        """
        count = math.ceil((landed - near) / (LONG * self.flow.width))
        inner = [landed + (near - landed) * k / count for k in range(1, count)]
        knots = [landed, *inner, near, bottom]
        found = self._stretch([top, landed], None)
        for k in range(0, len(knots) - 1, STRETCH):
            found += self._stretch(knots[k : k + STRETCH + 1], found[-1])
        return found

    def _stretch(self, knots: list[float], before: Curve | None) -> list[Curve]:
        """Some pieces, from the end of the one before them; not much longer than that at first."""
        labels = {} if before else self._labelled(knots)
        if before:
            most = max(LONGER * (before.first - before.last), SHORT * self.flow.width)
            knots = [
                *itertools.chain(*(_even(*ends, most) for ends in itertools.pairwise(knots))),
                knots[-1],
            ]
        legs = self._path(knots, labels, before)
        spare = np.full(len(legs), LEAST)
        judged = 0
        for _ in range(TRIES):
            curves = self._curves(legs, spare, before)
            lead, missing = self._guessed(curves), np.zeros(len(curves))
            if (lead > 0).all():
                lead, missing = self._leads(curves)
                judged += 1
            if (lead > 0).all():
                return curves
            more = _wanted(lead, missing)
            cuts = [
                _parts(leg, by, SHORT * self.flow.width)
                if judged <= FINER or by * leg.length > STEP * self.flow.width
                else []
                for leg, by in zip(legs, more, strict=True)
            ]
            if any(cuts):
                knots = sorted([*knots, *itertools.chain(*cuts)], reverse=True)
                legs = self._path(knots, labels, before)
                spare = np.repeat(spare, [len(own) + 1 for own in cuts])
            else:
                spare = spare + more
        first = legs[int(np.argmin(lead > 0))].first
        raise Refused(
            CLAIM, "a barrier", f"none at h = {first:.6g} m: the tips may close on the part"
        )

    def _guessed(self, curves: list[Curve]) -> Floats:
        """Leads at some values of the constants: what is behind there need not be proved to be."""
        found = np.empty(len(curves))
        for tip in (D, S):
            own = [k for k, curve in enumerate(curves) if curve.tip == tip]
            if own:
                found[own] = _Curves([curves[k] for k in own]).guessed(self.flow, self.corners)
        return found

    def _leads(self, curves: list[Curve]) -> tuple[Floats, Floats]:
        """Their leads and what is missing, of those that were not looked at before."""
        new = [curve for curve in curves if curve.key not in self.known]
        if new:
            found = least_leads(new, self.states, self.side)
            self.known |= {
                c.key: pair for c, pair in zip(new, zip(*found, strict=True), strict=True)
            }
        lead, missing = np.array([self.known[curve.key] for curve in curves]).T
        return lead, missing

    def _path(
        self, knots: Sequence[float], labels: Mapping[str, float], curve: Curve | None = None
    ) -> list[_Leg]:
        """The path of the motion that gains most, in floating point; on from the end of a curve."""
        legs: list[_Leg] = []
        at = self._begin(knots[0]) if curve is None else curve.end
        at = dataclasses.replace(at, slopes={**at.slopes, **labels})
        corner = self.flow.worst(knots[0], at, self.corners)
        before = self.flow.change(knots[0], at, corner)
        for first, last in itertools.pairwise(knots):
            tip = self.flow.sticks(first, at, corner)
            # starts are told to be ahead of S
            if (legs or curve) and tip != at.tip and not self._begins(first):
                at = self.flow.ahead_of(tip, first, at)
                before = self.flow.change(first, at, corner)
            end = self.flow.step(first, first - last, at, before, corner)
            drift = self.flow.drift(first, at, corner)
            corner = self.flow.worst(last, end, self.corners)
            after = self.flow.change(last, end, corner)
            legs.append(_Leg(first, last, at, end, before, after, drift))
            # the rest follows the curve that is moved to hold every start
            if curve is None and len(legs) == 1 and len(knots) > 2:
                moved = self.side * self._first_raised(legs[0])
                end = dataclasses.replace(end, ahead=end.ahead + moved)
                corner = self.flow.worst(last, end, self.corners)
                after = self.flow.change(last, end, corner)
            at, before = end, after
        return legs

    def _begin(self, h: float) -> Guess:
        """The first guess: how a start depends on the constants."""
        middle, reach = self.flow.middle, self.flow.reach

        def slope(name: str) -> float:
            low, high = (
                first_ahead(h, {**middle, name: middle[name] + sign * reach[name]}) for sign in BOTH
            )
            return (high - low) / (2 * reach[name])

        return Guess(S, first_ahead(h, middle), {name: slope(name) for name in self.names})

    def _labelled(self, knots: Sequence[float]) -> dict[str, float]:
        """Slopes along the labels: those by which a start at the middle of all ranges does not change."""
        start = self.starts[len(self.starts) // 2]
        one, exact = boxes_of(start.box, 1)
        # of a single run a label may vary by what rounding leaves of it, and what it grows with not at all
        labels = {
            name: own
            for name, own in start.labels.items()
            if name in self.names and own in one.names
        }
        if not labels:
            return {}
        leg = self._path(knots[:2], {})[0]
        lead = self._ahead(start, self._curve(leg))({**exact, **one.amid().points()})
        slopes = lead.slopes()
        return {
            name: self.side * float(slopes[0, one.names.index(own), 0])
            for name, own in labels.items()
        }

    def _curves(self, legs: list[_Leg], spare: Floats, before: Curve | None = None) -> list[Curve]:
        """The path as curves without gaps, each steeper than it by a slope."""
        found: list[Curve] = []
        off = ROOM if before else 0.0
        for leg, more in zip(legs, map(float, spare), strict=True):
            # the path goes on from where the first piece was moved to
            moved = self._first_raised(leg)
            if before:
                moved = off = max(off, moved)
            back = leg.drift * off
            # a start that a piece holds is held by a steeper one, not by one less steep
            more += max(back, 0.0) if self._begins(leg.first) else back
            curve = self._curve(leg).raised(self.side * moved, self.side * more * leg.length)
            if before and before.tip != curve.tip:
                raised = self._raised(before, curve)
                off += raised
                curve = curve.raised(self.side * raised, 0.0)
            elif before:
                self._no_gap(before, curve)
            found.append(curve)
            before = curve
            off += more * leg.length + ROOM
        return found

    def _begins(self, h: float) -> bool:
        """Whether a turn can begin on a piece that starts at ``h``."""
        return h > self.landed

    def _first_raised(self, leg: _Leg) -> float:
        """By how much a piece of the path must be moved to hold every start on it; the more so a steeper curve does."""
        starts = [one for one in self.starts if not (one.h[1] < leg.last or one.h[0] > leg.first)]
        if not (starts and self._begins(leg.first)):
            return 0.0
        curve = self._curve(leg)
        if curve.key not in self.begun:
            least = np.inf
            for like in dict.fromkeys(one.like for one in starts):
                alike = [one for one in starts if one.like == like]
                least = min(least, self._start(alike, curve, enough=min(least, 0.0)))
            self.begun[curve.key] = self._moved(arb(least))
        return self.begun[curve.key]

    def _start(self, alike: Sequence[Start], curve: Curve, enough: float) -> float:
        """A lower bound of how far a curve is beyond the places at which a turn can begin."""
        boxes, exact = boxes_of_all([one.box for one in alike])
        ahead, near = self._ahead(alike[0], curve), NEAR * self.flow.width
        together = np.zeros(boxes.count, dtype=np.int64)
        found = lowest(
            lambda at, _: ahead({**exact, **at}), boxes, near, STARTS, enough, groups=together
        )
        return float(found[0])

    def _curve(self, leg: _Leg) -> Curve:
        def cubic(of: Callable[[Guess], float]) -> Cubic:
            return Cubic.through(
                of(leg.at), of(leg.end), leg.length * of(leg.before), leg.length * of(leg.after)
            )

        slopes = {name: cubic(partial(_slope, name)) for name in self.names}
        ahead = cubic(lambda one: one.ahead)
        return Curve(leg.first, leg.last, leg.at.tip, ahead, slopes, self.flow.middle)

    def _beyond(self, before: Curve, curve: Curve, at: Mapping[str, Real]) -> Real:
        """How far a curve begins beyond the end of one that tells the part to be ahead of the other tip."""
        told, h = before.at(arb(1), at), Rows.constant(before.last)
        grip = grip_of(at, h, before.tip, told)
        own = told - grip.T if before.tip == S else told + grip.T
        return (curve.at(ZERO, at) - own) * self.side

    def _raised(self, before: Curve, curve: Curve) -> float:
        """By how much a curve must be moved to begin beyond the end of such a one."""
        near = NEAR * self.flow.width
        return self._moved(ends_of(partial(self._beyond, before, curve), self.box, near, CUTS)[0])

    def _moved(self, missing: arb) -> float:
        raised = max(-float(missing), 0.0) + ROOM
        if not missing + arb(raised) > ROOM / 2:
            raise Refused(
                CLAIM, "holds every state in which both tips can touch first", "not shown"
            )
        return raised

    def _ahead(self, start: Start, curve: Curve) -> Callable[[Mapping[str, Any]], Any]:
        """How far a curve is beyond the places at which a turn can begin."""

        def spare(at: Point) -> Dual:
            known = {**start.constants(at), "bend": EVEN}

            def barrier(h: Dual) -> tuple[Dual, Dual]:
                done = curve.done(h)
                return curve.at(done, known), curve.rate(done, known)

            return start.lead(at, barrier) * self.side

        return spare

    def _no_gap(self, before: Curve, after: Curve) -> None:
        one, none = Dual(arb(1)), Dual(ZERO)
        step = (after.ahead(none).value - before.ahead(one).value) * self.side
        for name, cubic in before.slopes.items():
            turned = after.slopes[name](none).value - cubic(one).value
            step -= abs(turned) * abs(whole(self.box[name]) - arb(self.flow.middle[name]))
        if not step >= 0:
            raise Refused(CLAIM, "without a gap", "a gap")


def _even(first: float, last: float, most: float) -> list[float]:
    """Where pieces begin that are equally long, and none longer than ``most``."""
    count = math.ceil((first - last) / most)
    return [first + (last - first) * k / count for k in range(count)]


def _wanted(lead: Floats, missing: Floats) -> Floats:
    """How much steeper each curve is tried next."""
    more = np.where((missing > 0) & (missing < -lead), missing, -lead)
    return np.where(lead > 0, 0.0, 1.05 * np.minimum(more, MOST) + LEAST)


def _parts(leg: _Leg, more: float, short: float) -> list[float]:
    """Where to cut a piece that would have to be steeper by so much, into none shorter than ``short``."""
    count = min(math.ceil(more / STEEP), math.ceil(leg.length / short), MOST_PARTS)
    return [leg.first - leg.length * k / count for k in range(1, count)]


def _slope(name: str, of: Guess) -> float:
    return of.slopes[name]


def least_leads(curves: Sequence[Curve], states: Box, side: int) -> tuple[Floats, Floats]:
    """By how much each curve is faster than every motion on it at least (see the module's text).

    And how much steeper it must be for it to be clear which tip is slipped over which way; zero if it
    is, or hardly can be.
    """
    leads, missing = np.empty(len(curves)), np.empty(len(curves))
    for tip in (D, S):
        own = [k for k, curve in enumerate(curves) if curve.tip == tip]
        if own:
            leads[own], missing[own] = _Leads([curves[k] for k in own], states, side).least()
    return leads, missing


class _Leads:
    """Curves ahead of one tip, and the motions on them."""

    def __init__(self, curves: Sequence[Curve], states: Box, side: int) -> None:
        self.curves, self.side, self.count = _Curves(curves), side, len(curves)
        self.boxes, self.exact = boxes_of(states, self.count)
        self.places = {name: k for k, name in enumerate(self.boxes.names)}

    def least(self) -> tuple[Floats, Floats]:
        """The least lead of each curve, and what is missing for a decision."""
        found, missing = np.full(self.count, np.inf), np.zeros(self.count)
        which, boxes = np.arange(self.count), self.boxes
        for left in range(HALVED, -1, -1):
            below, above, short, weight = self._sides(boxes, which)
            lead = self._leads(boxes, which, below, above)
            # where it is open which way a tip is slipped over, parts of the box may decide
            cut = (lead <= 0) & ~(below | above).all(axis=0) & (left > 0)
            np.minimum.at(found, which[~cut], lead[~cut])
            np.maximum.at(missing, which[~cut], np.where(lead <= 0, short, 0.0)[~cut])
            if not cut.any():
                break
            boxes, which = halves(boxes.of(cut), weight[:, cut]), np.tile(which[cut], 2)
        return found, missing

    def _on(self, at: Mapping[str, Rows], which: Where) -> tuple[Grip, Rows, Mapping[str, Rows]]:
        known = {**self.exact, **at}
        return *self.curves.on(known, self.places, which), known

    def _sides(self, boxes: Boxes, which: Where) -> tuple[Flags, Flags, Floats, Floats]:
        """Whether each tip sticks at a rate that is proved to be below that of the curve, or above.

        And by how much it is short of being below, and along what to cut.
        """
        count, tips = boxes.count, (D, S)
        spares = [one.tight() for one in self._spares(boxes.points(), np.tile(which, 2))]
        low = np.array([-one.ends[0, :count] for one in spares])
        below = low > 0
        above = np.array([one.ends[1, :count] < 0 for one in spares])
        open_ = ~(below | above)
        steep = np.array([one.slopes().max(axis=0) for one in spares])
        steep = np.where(np.isfinite(steep), steep, 1e30) * (boxes.high - boxes.low)
        weight = np.where(open_[:, None], steep, 0.0).max(axis=0)
        tip, of = np.nonzero(open_)
        if len(of):  # looked at again where the spare is least, or greatest
            sign = np.where(np.array([spares[k].ends[0, count:] < 0 for k in tips])[open_], 1, -1)
            stick = partial(self._stick, tip, sign, which[of])
            closer = lowest(stick, boxes.of(of), CLOSE, 0)
            low[tip, of] = np.where(sign > 0, closer, low[tip, of])
            below[tip, of], above[tip, of] = (sign > 0) & (closer > 0), (sign < 0) & (closer > 0)
        short = np.where(below | above, 0.0, -low).max(axis=0)
        return below, above & ~below, np.maximum(short, 0.0), weight

    def _spares(self, at: Mapping[str, Rows], which: Where) -> list[Rows]:
        """By how much the curve is faster than where each tip sticks."""
        grip, rate, _ = self._on(at, which)
        return [(rate - grip.stick(tip)) * self.side for tip in (D, S)]

    def _leads(self, boxes: Boxes, which: Where, below: Flags, above: Flags) -> Floats:
        """The least lead in each box, or a negative one that is attained there."""
        cases = np.array(
            [
                (k, *case)
                for k in range(boxes.count)
                for case in _cases(below[:, k], above[:, k], self.side)
            ]
        ).T
        of = partial(self._lead, which[cases[0]], cases[1:])
        return lowest(of, boxes.of(cases[0]), CLOSE, CUTS, LEAST, 0.0, cases[0])

    def _stick(
        self, tips: Where, signs: Where, of: Where, at: Mapping[str, Rows], which: Where
    ) -> Rows:
        one, other = self._spares(at, of[which])
        return choose(tips[which] == D, one, other) * Rows.constant(signs[which])

    def _lead(self, of: Where, cases: Where, at: Mapping[str, Rows], which: Where) -> Rows:
        """Positive where a motion is slower than the curve, or than it would be if a tip stuck."""
        level, k_D, k_S = cases[:, which]
        grip, rate, known = self._on(at, of[which])
        for tip in (D, S):
            if (level == tip).any():
                rate = choose(level == tip, grip.stick(tip), rate)
        mu_D, mu_S = ratios_of(known)
        return (rate - grip.rate(drag_of(known), mu_D * k_D, mu_S * k_S)) * self.side


def _cases(below: Flags, above: Flags, side: int) -> Iterator[tuple[int, int, int]]:
    """Motions to compare with a curve: friction ratios over mu, and the rate not to be reached.

    That is the curve's (-1), or that at which a tip sticks.
    """
    ratios = [_ratios(bool(u), bool(o), side) for u, o in zip(below, above, strict=True)]
    for k_D, k_S in itertools.product(*ratios):
        yield -1, k_D, k_S
    for tip in (D, S):
        if above[tip]:
            other = (-side,) if below[1 - tip] else BOTH
            for k_D, k_S in itertools.product(*((BOTH, other) if tip == D else (other, BOTH))):
                yield tip, k_D, k_S


def _ratios(below: bool, above: bool, side: int) -> tuple[int, ...]:
    """Friction ratios, over mu, of a tip while the slide is about as fast as the curve.

    ``below``: the rate at which the tip sticks is proved to be below the curve's slope.
    """
    if below:
        return (-side,)
    return (side,) if above else BOTH
