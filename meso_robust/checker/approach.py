"""The start of a rotation: the active tip alone pushes the part onto the passive one.

The contact slips or sticks; its friction ratio ``k`` lies in [-mu, mu]. It is at ``p a + e n`` from the
centre of drag and comes with the speed ``-f`` along ``a``, ``-g`` along ``n`` (``grip.py``). With the
normal force ``L`` the film gives, ``D`` being the determinant of the drag of translations,

    D v = L (B a - A n),   rho omega = L m       A = 1 + stretch + shear k,  B = (1 - stretch) k + shear
    L (rho A + D m p) = rho D g                  m = p + e k

The centre of the passive tip is at ``b a - E n`` from there; the far edge, turned by an angle with the
tangent ``t`` and the cosine ``1/q``, closes on it with the speed ``(L/(rho D)) K``,

    q K = rho A + D m b - t (rho B - D m E)

Against the closed gap, not time, the part therefore turns by ``D m/K`` per metre, and the contact creeps
along its edge (the tip's speed along ``a`` less that of the part under it) by

    -((f/g)(rho A + D m p) + rho B + D m e)/K

besides the rolling of a round tip, its radius times the turn.

Until the gap is closed, turn and creep are the first gap times a mean of these rates, which lies between
their bounds over the states that can be visited: those in which turn and creep are the gap closed so far
times rates between such bounds. The bounds are guessed, and confirmed by recomputing them on the states
that follow from the guess: the motion cannot be the first to leave them.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.contact import place_on_edge
from meso_robust.checker.dual import Dual, Number, Point
from meso_robust.checker.film import EVEN, Arm, Film
from meso_robust.checker.grip import tight
from meso_robust.checker.ids import Must, Objection, named
from meso_robust.checker.pair import ACTIVE, Pair
from meso_robust.checker.passage import Pose, Sweep
from meso_robust.checker.pushing import UNIT, on_edge
from meso_robust.checker.ranges import ZERO, Box, Side, halved, positive, span, whole
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, Variables
from meso_robust.checker.scene import Scene, direction

NEAR_TURN, NEAR_CREEP, NEAR_RATIO = 30.0, 2e-2, 1e-2
"""How closely the rates are bounded: 1/m, 1 and 1."""
CLOSE_CREEP = 5e-3
"""The same once they are confirmed: what creeps in the gap is how wide the start of the slide is."""
HALVED = 3
"""How often parts of the orientations are tried, twice as many each time."""
SLIGHT = arb("0.01")
"""Share of a rate by which it must change with a variable for the trend to know."""
TRENDS = 2
"""How often the trends are worked out, each time from states that follow them."""
GUESSES = 12
"""How often the guess is enlarged before the checker gives up."""
START = (arb(0), arb(0))
EARLIER = "stray earlier"
"""The path's distance from its line while the gap closes; ``stray`` is that when it is closed."""
Barrier = Callable[[Dual], tuple[Dual, Dual]]
"""By h, how far ahead of S a part on a barrier is, and the barrier's slope per travel."""


@dataclasses.dataclass(frozen=True, slots=True)
class State:
    """The part while the active tip alone pushes."""

    c: Dual
    s: Dual
    place: Dual
    """The active tip along its edge, from the foot of the reference point, m."""
    b: Dual
    """The passive tip along the pushed edge, from the reference point, m."""
    out: Dual
    """How far it is out on the other side, m."""
    film: Film
    depth: Dual
    tilt: Number
    cosine: Number
    """Tangent and cosine of the angle from the pushed to the far edge."""
    ratio: Dual
    """k"""

    @property
    def arm(self) -> Arm:
        """The contact from the centre of drag."""
        return Arm.of(self.depth, self.place, self.film)

    @property
    def _drag(self) -> tuple[Number, Number]:
        """A and B."""
        if self.film.even:
            return 1, self.ratio
        stretch, shear = self.film.stretch, self.film.shear
        return self.ratio * shear + stretch + 1, self.ratio * (1 - stretch) + shear

    @property
    def lever(self) -> Dual:
        """D m (m)."""
        arm = self.arm
        return (self.ratio * arm.d1 + arm.d2) * arm.room

    @property
    def pressing(self) -> Dual:
        """Positive where the tip presses."""
        return self.lever * self.arm.d2 + self.film.rho * self._drag[0]

    @property
    def closing(self) -> Dual:
        """K: positive where the gap closes."""
        A, B = self._drag
        found = self.lever * (self.b - self.film.drag_a) + self.film.rho * A
        if self.tilt is EVEN:
            return found
        beside = self.film.rho * B - self.lever * (self.out + self.film.drag_n)
        return (found - beside * self.tilt) * self.cosine

    @property
    def force(self) -> Dual:
        """L, over drag and rate of travel."""
        _, g = self.film.along(self.c, self.s)
        return self.film.rho * self.arm.room * g / self.pressing

    @property
    def turn(self) -> Dual:
        """Turn per closed gap, 1/m."""
        return tight(self.lever) / tight(self.closing)

    @property
    def creep(self) -> Dual:
        """Way of the tip along its edge per closed gap, without the rolling."""
        f, g = self.film.along(self.c, self.s)
        under = self.lever * self.arm.d1 + self.film.rho * self._drag[1]
        return -tight(tight(f / g) * tight(self.pressing) + under) / tight(self.closing)


@dataclasses.dataclass(frozen=True, slots=True)
class Trend:
    """What a rate is thought to be: linear in what is constant during the run and in the way.

    Any will do; what rates differ from it is bounded.
    """

    value: arb
    slopes: Mapping[str, arb]
    middle: Mapping[str, arb]
    along: arb
    """Change per share of the gap that is left."""

    def rate(self, at: Point) -> Dual:
        """The rate at an instant."""
        return self._constant(at) + (at["left"] - HALF) * self.along

    def mean(self, at: Point, left: Number) -> Dual:
        """Its mean until a share of the gap is ``left``."""
        return self._constant(at) + left * HALF * self.along

    def _constant(self, at: Point) -> Dual:
        found = at["gap"] * 0 + self.value
        for name, slope in self.slopes.items():
            found = found + (at[name] - self.middle[name]) * slope
        return found


NO_TREND = Trend(ZERO, {}, {}, ZERO)
HALF = arb(0.5)


@dataclasses.dataclass(frozen=True, slots=True)
class Approach:
    """All that can happen until both tips touch."""

    pair: Pair
    free: Box
    """The variables of the move, and the first gap as one of them."""
    turn: Side
    """Bounds of the turn per closed gap less its trend, 1/m."""
    creep: Side
    """Bounds of the way of the tip along its edge per closed gap less its trend."""
    ratio: Side
    """Bounds of the friction ratio k."""
    turn_trend: Trend = NO_TREND
    creep_trend: Trend = NO_TREND

    @property
    def scene(self) -> Scene:
        """The move."""
        return self.pair.scene

    @property
    def lasting(self) -> frozenset[str]:
        """Variables that are constant during the run and not exact."""
        own = {"left", "turn", "creep", "k", "stray", EARLIER, *self.pair.instants()}
        return frozenset(
            n for n, (low, high) in self.free.items() if low is not high and n not in own
        )

    def box(self) -> Box:
        """The variables: those above, the share of the gap that is left, k and the mean rates."""
        own = {"left": UNIT, "turn": self.turn, "creep": self.creep, "k": self.ratio}
        return {**self.free, **own}

    def box_at_touch(self) -> Box:
        """The same when it is closed."""
        box = {**self.box(), "part": UNIT, "whole": self.turn}
        if "stray" in box:
            box[EARLIER] = box["stray"]
        if not self.pair.parallel:
            # S is farther out where the far edge leans towards it
            box["lift"] = span(self._lift, self.box(), within=1e-9)
        return box

    def _lift(self, at: Point) -> Dual:
        now = self.state(at)
        out = self.pair.depth_far(at) + at["radius_passive"]
        return now.out - out - at["left"] * at["gap"] / now.cosine

    def angle(self, at: Point) -> Dual:
        """Direction of the edge."""
        return self.scene.angle(at) + self._turned(at)

    def _turned(self, at: Point) -> Dual:
        """Turn since the first touch."""
        mean = self.turn_trend.mean(at, at["left"]) + at["turn"]
        return mean * (1 - at["left"]) * at["gap"]

    def place(self, at: Point) -> Dual:
        """The active tip on its edge."""
        mean = self.creep_trend.mean(at, at["left"]) + at["creep"]
        place = self.first(at) + mean * (1 - at["left"]) * at["gap"]
        if self.pair.exact("radius_lower"):
            return place
        return place - at["radius_lower"] * self._turned(at)

    def first(self, at: Point) -> Dual:
        """That place at the first touch."""
        c, s = direction(self.scene.angle(at))
        return place_on_edge(c, s, at["depth"] + at["radius_lower"], self.scene.rise(at, ACTIVE))

    def state(self, at: Point) -> State:
        """The part, its contact and the passive tip."""
        c, s = direction(self.angle(at))
        place, turned = self.place(at), self.pair.turned(at)
        near = at["depth"] + at["radius_lower"]
        out = self.pair.depth_far(at) + at["radius_passive"] + at["left"] * at["gap"]
        apart = self.pair.V(at) + at["stray"] if "stray" in at else self.pair.V(at)
        tilt: Number = EVEN
        cosine: Number = EVEN
        if turned is None:
            b = (place * s - (near + out) * c - apart) / s
        else:
            tilt, cosine = turned.tan(), direction(turned)[0]
            out = out / cosine
            b = (place * s - (near + out) * c - apart) / (s + c * tilt)
            out = out + b * tilt
        return State(
            c=tight(c),
            s=tight(s),
            place=tight(place),
            b=tight(b),
            out=tight(out),
            film=self.scene.film(at),
            depth=at["depth"],
            tilt=tilt,
            cosine=cosine,
            ratio=at["k"],
        )

    def force(self, at: Point) -> Dual:
        """Normal force of the active tip, over drag and rate of travel."""
        return self.state(at).force

    def pose(self, at: Point) -> Pose:
        """The part: the passive tip is off the far edge by the gap."""
        now = self.state(at)
        return pose_from(self.pair, at, now.c, now.s, now.b, now.out)

    def swept(self) -> Sweep:
        """All poses until the gap is closed."""
        return Sweep(self.pose, self.box(), "left")

    def h(self, at: Point) -> Dual:
        """The tips' distance in x when the gap is closed: the mean turn is that of some state before."""
        turned = self._earlier(at).turn * at["gap"]
        return self._level(at, self.scene.angle(at) + turned)[0]

    def _earlier(self, at: Point) -> State:
        return self.state({**at, "stray": at[EARLIER]} if EARLIER in at else at)

    def _level(self, at: Point, angle: Dual) -> tuple[Dual, Dual, Dual]:
        """h, T and the sine of the angle, the gap being closed."""
        c, s = direction(angle)
        apart = self.pair.V(at) + at["stray"] if "stray" in at else self.pair.V(at)
        across = at["depth"] + at["radius_lower"] + self.pair.depth_far(at) + at["radius_passive"]
        if "lift" in at:
            across = across + at["lift"]
        return (apart * c + across) / s, (across * c + apart) / s, s

    def lead(self, at: Point, barrier: Barrier) -> Dual:
        """How far a part on a barrier is ahead of this one when the gap is closed.

        S is at ``place - T`` along the edge, ``T = (V + W c)/s``. The part's way ahead is thus linear
        in how far the contact crept, and has the slope ``h/s`` over the turn, a barrier ``T/s`` times
        its own. With that slope at some angle on the way the lead is linear in turn and creep, which are
        the gap times mean rates: those of one state before, as the mean is that of one function.
        """
        start, now = self.scene.angle(at), self._earlier(at)
        h, T, *_ = map(tight, self._level(at, start))
        first = barrier(h)[0] + self.first(at) - T
        whole = self.turn_trend.mean(at, 0) + at["whole"]
        h, T, s = map(tight, self._level(at, start + at["part"] * whole * at["gap"]))
        steep = (tight(barrier(h)[1]) * T + h) / s
        if not self.pair.exact("radius_lower"):
            steep = steep - at["radius_lower"]
        return first + at["gap"] * tight(tight(now.creep) + tight(steep) * tight(now.turn))

    def requirements(self) -> list[Requirement]:
        """What is asked of every visited state."""
        box, scene, mu = self.box(), self.scene, self.scene.mu(ACTIVE)
        film = scene.film_variables()
        uneven = " ".join(name for name in film if name != "rho")
        variables: Variables = {
            "theta": self.angle,
            "d1": lambda at: at["depth"],
            "d2": self.place,
            "mu": lambda at: at[mu],
            **film,
        }

        def one(must: Must, statement: st.Statement, keys: str) -> Requirement:
            part = Part({key: variables[key] for key in keys.split()}, box)
            cover = (_at_first(part),)
            return Requirement(name=named(must), statement=statement, parts=(part,), cover=cover)

        edge = on_edge("active", scene, self.place, box)
        return [
            one(Must.PUSHES_UNTIL_REST, st.PRESSES, f"theta d1 d2 rho {uneven}"),
            one(Must.UNIQUE_UNTIL_REST, st.ONLY, f"d1 d2 rho mu {uneven}"),
            dataclasses.replace(edge, cover=tuple(map(_at_first, edge.parts))),
        ]


def pose_from(pair: Pair, at: Point, c: Dual, s: Dual, b: Dual, out: Dual) -> Pose:
    """The part, the passive tip's centre being at ``b a - out n`` from it; axes of the move."""
    scene = pair.scene
    x, y = scene.from_travel(at, out * s - b * c, -(b * s) - out * c)
    angle = arb.pi() / 2 - (c / s).atan()
    return (
        at["x"] + scene.passive_ahead(at) + x,
        at["y"] + scene.passive_rise(at) + y,
        scene.stated(at, angle),
    )


def _at_first(part: Part) -> Part:
    """The states of a part at the first touch."""
    return Part(part.variables, {**part.box, "left": (arb(1), arb(1))})


def approaches(pair: Pair) -> tuple[Approach, ...]:
    """Confirm bounds of the rates until the part rests on the passive tip.

    Where they cannot be for all parts at once they are for parts of the orientations.

    Raises
    ------
    Refused
        No guess could be confirmed.
    """
    pairs = [pair]
    for _ in range(HALVED):
        try:
            return tuple(map(_approach, pairs))
        except Refused as refused:
            last = refused
        pairs = [
            Pair(dataclasses.replace(one.scene, box=half))
            for one in pairs
            for half in halved(one.scene.box, "theta")
        ]
    raise last


def _approach(pair: Pair) -> Approach:
    free = {**pair.box, "gap": span(pair.first_gap, pair.box, within=1e-9)}
    free |= {name: side for name, side in pair.instants().items() if name == "stray"}
    trial = Approach(pair, free, START, START, START)
    for _ in range(TRENDS):
        trial = _with_trend(trial)
    for _ in range(GUESSES):
        found = _follows(trial)
        if _inside(found.turn, trial.turn) and _inside(found.creep, trial.creep):
            # what is confirmed holds, and so does what follows from it
            return _follows(found, CLOSE_CREEP)
        trial = dataclasses.replace(found, turn=_enlarged(found.turn), creep=_enlarged(found.creep))
    raise Refused(named(Objection.COMES_TO_REST), "bounded rates", "no bound")


def _with_trend(trial: Approach) -> Approach:
    """With the trends of the rates at the middle of all variables."""
    point = {name: whole(side).mid() for name, side in trial.box().items()}
    ratio = _ratio_at(trial, point)
    at = {name: Dual(value, {name: arb(1)}) for name, value in {**point, "k": ratio}.items()}
    state = trial.state({**at, "left": Dual(HALF, {"left": arb(1)})})
    least_mu = trial.scene.box[trial.scene.mu(ACTIVE)][0]

    def trend(rate: Dual) -> Trend:
        own = {
            name: slope.mid()
            for name, slope in rate.slopes.items()
            if name in trial.lasting
            and abs(slope) * whole(trial.free[name]).rad() > abs(rate.value) * SLIGHT
        }
        middle = {name: point[name] for name in own}
        return Trend(rate.value.mid(), own, middle, rate.slopes["left"].mid())

    slides = not abs(ratio) < least_mu  # a tip that sticks does not creep
    return dataclasses.replace(
        trial,
        turn_trend=trend(state.turn),
        creep_trend=trend(state.creep) if slides else NO_TREND,
    )


def _ratio_at(trial: Approach, point: Mapping[str, arb]) -> arb:
    """The friction ratio at the middle of all variables."""
    now = trial.state(
        {**{n: Dual(v) for n, v in point.items()}, "left": Dual(HALF), "k": Dual(ZERO)}
    )
    sticking = (now.arm.shear(now.c, now.s) / now.arm.press(now.c, now.s)).value.mid()
    mu = point[trial.scene.mu(ACTIVE)]
    return sticking.max(-mu).min(mu)


def _follows(trial: Approach, near_creep: float = NEAR_CREEP) -> Approach:
    """Bounds of the friction ratio and the rates on the states that follow from a guess."""
    ratio = _ratio(trial)
    trial = dataclasses.replace(trial, ratio=ratio)
    box = trial.box()
    for rate in ("pressing", "closing"):
        if not positive(functools.partial(_rate, trial, rate), box):
            raise Refused(named(Objection.PUSHES_ONTO_PASSIVE), "> 0", rate)

    def off_trend(rate: str, trend: Trend, at: Point) -> Dual:
        return _rate(trial, rate, at) - trend.rate(at)

    of = functools.partial(off_trend, "turn", trial.turn_trend)
    turn = span(of, box, within=NEAR_TURN)
    of = functools.partial(off_trend, "creep", trial.creep_trend)
    low, high = span(of, box, within=near_creep)
    least_mu = trial.scene.box[trial.scene.mu(ACTIVE)][0]
    if trial.creep_trend is NO_TREND:
        if ratio[1] < least_mu:  # it never slides towards +a
            high = high.min(ZERO)
        if ratio[0] > -least_mu:
            low = low.max(ZERO)
    return dataclasses.replace(trial, turn=turn, creep=(low, high))


def _rate(trial: Approach, rate: str, at: Point) -> Dual:
    found: Dual = getattr(trial.state(at), rate)
    return found


def _ratio(trial: Approach) -> Side:
    """Friction ratio of the contact: that of sticking, clipped to the cone.

    Under one contact whose normal speed grows with its normal force however it slips (required
    below), the motion is unique and slips only if sticking would need more friction than there is.
    """

    def sticking(at: Point) -> Dual:
        now = trial.state(at)
        return now.arm.shear(now.c, now.s) / now.arm.press(now.c, now.s)

    low, high = span(sticking, trial.box(), within=NEAR_RATIO)
    least_mu, most_mu = trial.scene.box[trial.scene.mu(ACTIVE)]
    return _clipped(low, least_mu, most_mu), -_clipped(-high, least_mu, most_mu)


def _clipped(low: arb, least_mu: arb, most_mu: arb) -> arb:
    """Lower bound of a ratio that is at least ``low`` before it is clipped to [-mu, mu]."""
    return low.max(-most_mu) if low < 0 else low.min(least_mu)


def _inside(one: Side, other: Side) -> bool:
    return bool(other[0] <= one[0] and one[1] <= other[1])


def _enlarged(side: Side) -> Side:
    reach = (side[1] - side[0]) / 10
    return side[0] - reach, side[1] + reach
