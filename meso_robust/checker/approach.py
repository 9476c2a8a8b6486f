"""The start of a rotation: the active tip alone pushes the part onto the passive one.

The contact slips or sticks; its friction ratio ``k`` lies in [-mu, mu]. It is at ``p a + e n`` from the
centre of drag and comes with the speed ``-f`` along ``a``, ``-g`` along ``n`` (``grip.py``). With the
normal force ``L`` the film gives, ``D`` being the determinant of the drag of translations,

    D v = L (B a - A n),   rho omega = L m       A = 1 + stretch + shear k,  B = (1 - stretch) k + shear
    L (rho A + D m p) = rho D g                  m = p + e k

What happens to the part does not hang on the passive tip yet, so **the turn since the first touch is the
clock**. Per turn the contact creeps along its edge (the tip's speed along ``a`` less that of the part under
it), besides the rolling of a round tip, by

    -((f/g)(rho A + D m p) + rho B + D m e)/(D m)

and has crept the turn times a mean of these rates. Stage by stage of the turn they lie between their
bounds over the states that can be visited: those in which the mean is one of rates between such bounds.
The bounds are guessed, and confirmed by recomputing them on the states that follow from the guess: the
motion cannot be the first to leave them.

The centre of the passive tip is at ``b a - E n`` from the centre of drag; the far edge, turned by an angle
with the tangent ``t`` and the cosine ``1/q``, closes on it with the speed ``(L/(rho D)) K``,

    q K = rho A + D m b - t (rho B - D m E)

so that per turn the gap closes by ``K/(D m)``. What a stage leaves of it tells in which stages the part can
come to rest on both tips, and how long the clock runs at most.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping
from typing import Any

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.contact import place_on_edge
from meso_robust.checker.dual import Dual, Number, Point
from meso_robust.checker.film import EVEN, Arm, Film
from meso_robust.checker.grip import tight
from meso_robust.checker.ids import Must, Objection, named
from meso_robust.checker.pair import ACTIVE, Pair
from meso_robust.checker.passage import Pose, Sweep
from meso_robust.checker.pushing import on_edge
from meso_robust.checker.ranges import (
    ZERO,
    Box,
    Side,
    halved,
    hull,
    positive,
    side_of,
    span,
    whole,
)
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, Variables
from meso_robust.checker.rows import ends_of
from meso_robust.checker.scene import Scene, direction

STAGE, MOST_STAGES = arb("0.02"), 25
"""Of the turn, rad, and how many may pass before the checker gives up."""
NEAR_CLOSING, NEAR_CREEP, NEAR_RATIO = 1e-2, 4e-3, 1e-2
"""How closely are bounded: what the gap closes, and the contact creeps, per turn, of the width; friction."""
CUTS = 3
"""How often a box of states is cut in four for that."""
HALVED = 3
"""How often parts of the orientations are tried, twice as many each time."""
SLIGHT = arb("0.01")
"""Share of a rate by which it must change with a variable for the trend to know."""
GUESSES = 12
"""How often a guess is enlarged before the checker gives up."""
START = (arb(0), arb(0))
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
    def closes(self) -> Dual:
        """By how much the gap closes per turn, m."""
        return self.closing / self.lever

    @property
    def creep(self) -> Dual:
        """Way of the tip along its edge per turn, without the rolling."""
        f, g = self.film.along(self.c, self.s)
        across = self.film.rho * self._drag[1]
        return -(f / g * self.pressing + across) / self.lever - self.arm.d1

    @property
    def ahead(self) -> Dual:
        """How far the reference point is ahead of the passive tip."""
        return -self.b

    def h(self, across: Dual) -> Dual:
        """Active minus passive tip, x; ``across`` the pushed edge the former is so far out."""
        return (self.place - self.b) * self.c + (across + self.out) * self.s


@dataclasses.dataclass(frozen=True, slots=True)
class Trend:
    """What a rate is thought to be: linear in what is constant during the run and in the way.

    Any will do; what rates differ from it is bounded.
    """

    value: arb
    slopes: Mapping[str, arb]
    middle: Mapping[str, arb]
    along: arb
    """Change per turn since ``half`` of the longest one."""
    half: arb

    def rate(self, at: Point) -> Dual:
        """The rate at an instant."""
        return self._constant(at) + (at["turned"] - self.half) * self.along

    def mean(self, at: Point) -> Dual:
        """Its mean until the part has turned so far."""
        return self._constant(at) + (at["turned"] / 2 - self.half) * self.along

    def _constant(self, at: Point) -> Dual:
        found = at["turned"] * 0 + self.value
        for name, slope in self.slopes.items():
            found = found + (at[name] - self.middle[name]) * slope
        return found


NO_TREND = Trend(ZERO, {}, {}, ZERO, ZERO)
HALF = arb(0.5)


@dataclasses.dataclass(frozen=True, slots=True)
class Approach:
    """All that can happen in a stage of the turn, until both tips touch."""

    pair: Pair
    free: Box
    """The variables of the move."""
    turned: Side
    """From the first touch to this stage, and to its end, rad."""
    open: arb
    """Largest gap."""
    creep: Side = START
    """Bounds of the way of the tip along its edge per turn so far, less its trend, m."""
    ratio: Side = START
    """Bounds of the friction ratio k."""
    trend: Trend = NO_TREND
    rests: Side | None = None
    """The turn at which the part can come to rest on both tips; None: it cannot yet."""

    @property
    def scene(self) -> Scene:
        """The move."""
        return self.pair.scene

    @property
    def lasting(self) -> frozenset[str]:
        """Variables that are constant during the run and not exact."""
        own = {"open", "turned", "creep", "k", "stray", *self.pair.instants()}
        return frozenset(
            n for n, (low, high) in self.free.items() if low is not high and n not in own
        )

    def box(self) -> Box:
        """The variables: those above, the gap, the turn so far, k and the creep."""
        own = {"open": (ZERO, self.open), "turned": self.turned}
        return {**self.free, **own, "creep": self.creep, "k": self.ratio}

    def box_at_touch(self) -> Box:
        """The same when it is closed."""
        return {**self.box(), "open": side_of(ZERO), "turned": self.rests or self.turned}

    def angle(self, at: Point) -> Dual:
        """Direction of the edge."""
        return self.scene.angle(at) + at["turned"]

    def place(self, at: Point) -> Dual:
        """The active tip on its edge."""
        place = self.first(at) + (self.trend.mean(at) + at["creep"]) * at["turned"]
        if self.pair.exact("radius_lower"):
            return place
        return place - at["radius_lower"] * at["turned"]

    def first(self, at: Point) -> Dual:
        """That place at the first touch."""
        c, s = direction(self.scene.angle(at))
        return place_on_edge(c, s, at["depth"] + at["radius_lower"], self.scene.rise(at, ACTIVE))

    def state(self, at: Point) -> State:
        """The part, its contact and the passive tip."""
        c, s = map(tight, direction(self.angle(at)))
        place, turned = tight(self.place(at)), self.pair.turned(at)
        near = at["depth"] + at["radius_lower"]
        out = self.pair.depth_far(at) + at["radius_passive"] + at["open"]
        apart = self.pair.V(at) + at["stray"] if "stray" in at else self.pair.V(at)
        tilt: Number = EVEN
        cosine: Number = EVEN
        if turned is None:
            b = tight((place * s - (near + out) * c - apart) / s)
        else:
            tilt, cosine = turned.tan(), direction(turned)[0]
            out = out / cosine
            b = tight((place * s - (near + out) * c - apart) / (s + c * tilt))
            out = tight(out + b * tilt)
        return State(
            c=c,
            s=s,
            place=place,
            b=b,
            out=out,
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
        return Sweep(self.pose, self.box(), "turned")

    def h(self, at: Point) -> Dual:
        """The tips' distance in x when the gap is closed."""
        return self.state(at).h(at["depth"] + at["radius_lower"])

    def lead(self, at: Point, barrier: Barrier) -> Dual:
        """How far a part on a barrier is ahead of this one then."""
        now = self.state(at)
        return barrier(tight(now.h(at["depth"] + at["radius_lower"])))[0] - now.ahead

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
    return Part(part.variables, {**part.box, "turned": side_of(ZERO)})


def approaches(pair: Pair) -> tuple[Approach, ...]:
    """Confirm bounds of the rates, stage by stage, until the part rests on the passive tip.

    Where they cannot be for all parts at once they are for parts of the orientations.

    Raises
    ------
    Refused
        No guess could be confirmed.
    """
    pairs = [pair]
    for _ in range(HALVED):
        try:
            return tuple(stage for one in pairs for stage in _stages(one))
        except Refused as refused:
            last = refused
        pairs = [
            Pair(dataclasses.replace(one.scene, box=half))
            for one in pairs
            for half in halved(one.scene.box, "theta")
        ]
    raise last


def _stages(pair: Pair) -> list[Approach]:
    """From the first touch until the gap is closed."""
    least, most = span(pair.first_gap, pair.box, within=1e-9)
    free = {**pair.box}
    free |= {name: side for name, side in pair.instants().items() if name == "stray"}
    trend = _trend(Approach(pair, free, (ZERO, STAGE), most))
    stages: list[Approach] = []
    crept, rates, start = START, [START], ZERO
    for _ in range(MOST_STAGES):
        stage = Approach(pair, free, (start, start + STAGE), most, trend=trend)
        stage, crept, found = _confirmed(stage, crept, _expected(*rates[-2:]))
        rates.append(found)
        slow, fast = _closes(stage)
        soonest, latest = start + (least / fast).max(ZERO), start + most / slow
        end = start + STAGE
        # undecided, it may rest here
        rests = None if soonest > end else (start.max(soonest), end.min(latest))
        stages.append(dataclasses.replace(stage, rests=rests))
        if latest <= end:
            return stages
        least, most, start = least - fast * STAGE, (most - slow * STAGE).upper(), end
    raise Refused(named(Objection.COMES_TO_REST), "a closed gap", "a gap that stays open")


def _confirmed(stage: Approach, before: Side, guess: Side) -> tuple[Approach, Side, Side]:
    """With bounds of the mean creep; those of it at the end, and of its rates.

    ``before``: those of the mean creep at the start, ``guess``: of the rates.
    """
    for _ in range(GUESSES):
        trial = dataclasses.replace(stage, creep=_mean(stage, before, guess))
        trial = dataclasses.replace(trial, ratio=_ratio(trial))
        for rate in ("lever", "pressing", "closing"):
            if not positive(functools.partial(_rate, trial, rate), trial.box()):
                raise Refused(named(Objection.PUSHES_ONTO_PASSIVE), "> 0", rate)
        found = _creep(trial)
        if _inside(found, guess):
            # no state that follows from the guess has other rates than these
            after = _after(stage, before, found)
            return trial, (after[0].lower(), after[1].upper()), found
        guess = _enlarged(found)
    raise Refused(named(Objection.COMES_TO_REST), "bounded rates", "no bound")


def _after(stage: Approach, before: Side, rates: Side) -> Side:
    """Bounds of the mean creep at the end of a stage, from those at its start and those of the rates."""
    start, end = stage.turned
    low, high = ((a * start + b * (end - start)) / end for a, b in zip(before, rates, strict=True))
    return low, high


def _mean(stage: Approach, before: Side, rates: Side) -> Side:
    """The same of all instants of the stage."""
    after = _after(stage, before, rates)
    mean = after if stage.turned[0] == 0 else hull(before, after)
    return mean[0].lower(), mean[1].upper()


def _closes(stage: Approach) -> Side:
    """By how much the gap closes per turn."""
    near = NEAR_CLOSING * 2.0 * float(stage.scene.d1)
    slow, fast = ends_of(functools.partial(_rate, stage, "closes"), stage.box(), near, CUTS)
    if not slow > 0:
        raise Refused(named(Objection.PUSHES_ONTO_PASSIVE), "> 0", "closes")
    return slow, fast


def _trend(trial: Approach) -> Trend:
    """That of the creep at the middle of all variables."""
    point = {name: whole(side).mid() for name, side in trial.box().items()}
    ratio = _ratio_at(trial, point)
    if abs(ratio) < trial.scene.box[trial.scene.mu(ACTIVE)][0]:
        return NO_TREND  # a tip that sticks does not creep
    at = {name: Dual(value, {name: arb(1)}) for name, value in {**point, "k": ratio}.items()}
    creep = trial.state(at).creep
    own = {
        name: slope.mid()
        for name, slope in creep.slopes.items()
        if name in trial.lasting
        and abs(slope) * whole(trial.free[name]).rad() > abs(creep.value) * SLIGHT
    }
    middle = {name: point[name] for name in own}
    return Trend(creep.value.mid(), own, middle, creep.slopes["turned"].mid(), point["turned"])


def _ratio_at(trial: Approach, point: Mapping[str, arb]) -> arb:
    """The friction ratio at the middle of all variables."""
    now = trial.state({**{n: Dual(v) for n, v in point.items()}, "k": Dual(ZERO)})
    sticking = (now.arm.shear(now.c, now.s) / now.arm.press(now.c, now.s)).value.mid()
    mu = point[trial.scene.mu(ACTIVE)]
    return sticking.max(-mu).min(mu)


def _creep(trial: Approach) -> Side:
    """Bounds of the creep less its trend.

    Where the contact never slides towards ``a`` it creeps by the smaller of what it does at the ratio
    ``-mu`` and nothing: the former is negative where it slides, positive where it sticks. The other way
    round likewise.
    """
    box, mu = trial.box(), trial.scene.box[trial.scene.mu(ACTIVE)]
    near = NEAR_CREEP * 2.0 * float(trial.scene.d1)

    def off_rest(at: Any) -> Any:
        return -trial.trend.rate(at)

    rests = START if trial.trend is NO_TREND else ends_of(off_rest, box, near, CUTS)
    one_way = [sign for sign, most in ((-1, trial.ratio[1]), (1, -trial.ratio[0])) if most < mu[0]]
    if len(one_way) == 2:
        return rests
    sign = one_way[0] if one_way else 0
    ratios = {-1: (-mu[1], -mu[0]), 1: mu, 0: trial.ratio}

    def off_trend(at: Any) -> Any:
        return _rate(trial, "creep", at) - trial.trend.rate(at)

    slides = ends_of(off_trend, {**box, "k": ratios[sign]}, near, CUTS)
    if sign == 0:
        return slides
    if sign < 0:
        return slides[0].min(rests[0]), slides[1].min(rests[1])
    return slides[0].max(rests[0]), slides[1].max(rests[1])


def _rate(trial: Approach, rate: str, at: Any) -> Any:
    """One of the rates, at a point or at many."""
    return getattr(trial.state(at), rate)


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


def _expected(*rates: Side) -> Side:
    """A guess of bounds of rates from those in the last stages: they go on as they changed."""
    before, last = rates[0], rates[-1]
    low, high = (2 * b - a for a, b in zip(before, last, strict=True))
    return _enlarged((low, high) if low < high else last)


def _inside(one: Side, other: Side) -> bool:
    return bool(other[0] <= one[0] and one[1] <= other[1])


def _enlarged(side: Side) -> Side:
    reach = (side[1] - side[0]) / 10
    return side[0] - reach, side[1] + reach
