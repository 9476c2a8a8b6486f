"""The start of a rotation: the active tip alone pushes the part onto the passive one.

The contact slips or sticks; its friction ratio ``k`` lies in [-mu, mu]. With the contact at
``d2 a + d1 n`` and normal force ``L`` the film gives ``v = L (k a - n)`` and ``rho omega = L m``,
``m = d2 + d1 k``, and the edge gives way to the tip as fast as the tip comes:

    L (rho + d2 m) = rho s

The far edge closes on the passive tip, ``p`` along the edge from the centre's foot, with the speed
``(L/rho)(rho + p m)``. Against the closed gap, not time, the part therefore turns by
``m/(rho + p m)`` per metre and the contact creeps along its edge by

    -((c/s)(rho + d2 m) + rho k + d1 m)/(rho + p m)

(the tip's speed ``-c`` along ``a`` less that of the part's point, ``L k + omega d1``). Until the gap is
closed, turn and creep are the first gap times a mean of these rates, which lies between their bounds
over the states that can be visited: those in which turn and creep are the gap closed so far times
rates between such bounds. The bounds are guessed, and confirmed by recomputing them on the
states that follow from the guess: the motion cannot be the first to leave them.
"""

from __future__ import annotations

import dataclasses
import functools

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.contact import Contact, off_line, place_on_edge
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.grip import Grip
from meso_robust.checker.ids import Must, Named, Objection, named
from meso_robust.checker.pair import ACTIVE, Pair
from meso_robust.checker.passage import Pose, Sweep
from meso_robust.checker.pushing import UNIT, constant
from meso_robust.checker.ranges import ZERO, Box, Side, positive, span
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, Variables
from meso_robust.checker.scene import Scene, direction

NEAR_TURN, NEAR_CREEP, NEAR_RATIO = 20.0, 1e-2, 1e-2
"""How closely the rates are bounded: 1/m, 1 and 1."""
GUESSES = 12
"""How often the guess is enlarged before the checker gives up."""
START = (arb(0), arb(0))


@dataclasses.dataclass(frozen=True, slots=True)
class State:
    """The part while the active tip alone pushes."""

    contact: Contact
    place: Dual
    """p: the passive tip along the far edge, from the centre's foot, m."""
    ratio: Dual
    """k"""
    rho: Dual

    @property
    def lever(self) -> Dual:
        """Moment of the contact over its normal force (m)."""
        return self.ratio * self.contact.d1 + self.contact.d2

    @property
    def pressing(self) -> Dual:
        """Positive where the tip presses: ``rho + d2 m``."""
        return self.lever * self.contact.d2 + self.rho

    @property
    def closing(self) -> Dual:
        """Positive where the gap closes: ``rho + p m``."""
        return self.lever * self.place + self.rho

    @property
    def turn(self) -> Dual:
        """Turn per closed gap, 1/m."""
        return self.lever / self.closing

    @property
    def creep(self) -> Dual:
        """Way of the contact along its edge per closed gap."""
        ahead = self.contact.c / self.contact.s * self.pressing
        return -(ahead + self.rho * self.ratio + self.lever * self.contact.d1) / self.closing


@dataclasses.dataclass(frozen=True, slots=True)
class Approach:
    """All that can happen until both tips touch."""

    scene: Scene
    pair: Pair
    free: Box
    """The variables of the move that matter, and the first gap as one of them."""
    turn: Side
    """Bounds of the turn per closed gap, 1/m."""
    creep: Side
    """Bounds of the way of the contact along its edge per closed gap."""
    ratio: Side
    """Bounds of the friction ratio k."""

    def box(self) -> Box:
        """The variables: those above, the share of the gap that is left, k and the mean rates."""
        own = {"left": UNIT, "turn": self.turn, "creep": self.creep, "k": self.ratio}
        return {**self.free, **own}

    def angle(self, at: Point) -> Dual:
        """Direction of the edge."""
        return at["theta"] + at["turn"] * (1 - at["left"]) * at["gap"]

    def contact(self, at: Point) -> Contact:
        """The active tip on its edge."""
        d1 = self.scene.d1
        first = place_on_edge(*direction(at["theta"]), d1, self.scene.rise(at, ACTIVE))
        c, s = direction(self.angle(at))
        return Contact(c, s, d1, first + at["creep"] * (1 - at["left"]) * at["gap"])

    def state(self, at: Point) -> State:
        """The part, its contact and the passive tip."""
        contact = self.contact(at)
        across = at["left"] * at["gap"] + self.scene.d1
        place = (contact.arm_y - self.pair.V(at) - contact.c * across) / contact.s
        return State(contact, place, at["k"], at["rho"])

    def pose(self, at: Point) -> Pose:
        """The part: the active tip keeps its height, the passive one is off the far edge by the gap."""
        scene, contact = self.scene, self.contact(at)
        y = at["y"] + scene.rise(at, ACTIVE) - contact.arm_y
        across = at["left"] * at["gap"] + scene.d1
        below = contact.arm_y - self.pair.V(at)
        x = at["x"] + scene.passive_ahead(at) + (across - contact.c * below) / contact.s
        return x, y, self.angle(at)

    def swept(self) -> Sweep:
        """All poses until the gap is closed."""
        own = {key: self.scene.box[key] for key in ("x", "sensed_x", "passive_x")}
        return Sweep(self.pose, {**self.box(), **own}, "left")

    def touching(self, at: Point) -> tuple[Dual, Dual]:
        """Position h and slide sigma when the gap is closed; the mean rates are those of some state before."""
        d1, before = self.scene.d1, self.state(at)
        first = place_on_edge(*direction(at["theta"]), d1, self.scene.rise(at, ACTIVE))
        c, s = direction(at["theta"] + before.turn * at["gap"])
        grip = Grip.of_angle(c, s, self.pair.V(at), d1)
        return grip.h, grip.T / 2 - (first + before.creep * at["gap"])

    def requirements(self) -> list[Requirement]:
        """What is asked of every visited state."""
        box = self.box()
        scene = self.scene
        contact: Variables = {
            "theta": self.angle,
            "d1": constant(scene.d1),
            "d2": lambda at: self.contact(at).d2,
            "rho": lambda at: at["rho"],
            "mu": lambda at: at["mu"],
            "half": constant(scene.half),
        }

        def one(must: Named, statement: st.Statement, keys: str) -> Requirement:
            part = Part({key: contact[key] for key in keys.split()}, box)
            return Requirement(
                name=must, statement=statement, parts=(part,), cover=(_at_first(part),)
            )

        return [
            one(named(Must.PUSHES_UNTIL_REST), st.PRESSES, "theta d1 d2 rho"),
            one(named(Must.UNIQUE_UNTIL_REST), st.ONLY, "d1 d2 rho mu"),
            one(named(Must.TIP_ON_EDGE, tip="active"), st.ON_EDGE, "d2 half"),
        ]


def _at_first(part: Part) -> Part:
    """The states of a part at the first touch."""
    return Part(part.variables, {**part.box, "left": (arb(1), arb(1))})


def approach(scene: Scene, pair: Pair) -> Approach:
    """Confirm bounds of the rates until the part rests on the passive tip.

    Raises
    ------
    Refused
        No guess could be confirmed.
    """
    box = scene.box
    free = {
        **box,
        "gap": span(functools.partial(_gap, scene), box),
    }
    trial = Approach(scene, pair, free, START, START, START)
    for _ in range(GUESSES):
        found = _follows(trial)
        if _inside(found.turn, trial.turn) and _inside(found.creep, trial.creep):
            return found
        trial = dataclasses.replace(found, turn=_enlarged(found.turn), creep=_enlarged(found.creep))
    raise Refused(named(Objection.COMES_TO_REST), "bounded rates", "no bound")


def _gap(scene: Scene, at: Point) -> Dual:
    """Distance of the passive tip from the far edge before the move."""
    c, s = direction(at["theta"])
    return -off_line(c, s, scene.passive_ahead(at), scene.passive_rise(at)) - scene.d1


def _follows(trial: Approach) -> Approach:
    """Bounds of the friction ratio and the rates on the states that follow from a guess."""
    ratio = _ratio(trial)
    trial = dataclasses.replace(trial, ratio=ratio)
    box = trial.box()
    for rate in ("pressing", "closing"):
        if not positive(functools.partial(_rate, trial, rate), box):
            raise Refused(named(Objection.PUSHES_ONTO_PASSIVE), "> 0", rate)
    turn = span(functools.partial(_rate, trial, "turn"), box, within=NEAR_TURN)
    low, high = span(functools.partial(_rate, trial, "creep"), box, within=NEAR_CREEP)
    least_mu = trial.scene.box["mu"][0]
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
        contact = trial.contact(at)
        return contact.shear(at["rho"]) / contact.press(at["rho"])

    low, high = span(sticking, trial.box(), within=NEAR_RATIO)
    least_mu, most_mu = trial.scene.box["mu"]
    return _clipped(low, least_mu, most_mu), -_clipped(-high, least_mu, most_mu)


def _clipped(low: arb, least_mu: arb, most_mu: arb) -> arb:
    """Lower bound of a ratio that is at least ``low`` before it is clipped to [-mu, mu]."""
    return low.max(-most_mu) if low < 0 else low.min(least_mu)


def _inside(one: Side, other: Side) -> bool:
    return bool(other[0] <= one[0] and one[1] <= other[1])


def _enlarged(side: Side) -> Side:
    reach = (side[1] - side[0]) / 10
    return side[0] - reach, side[1] + reach
