"""The inequalities that a certificate may state, each with the checker's own formula for it.

An inequality is named by its id: one with a dot is what that file of the derivations states. What is
not in this table is not understood, and the certificate is rejected.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from flint import arb

from meso_robust.checker.contact import Contact, Turning, along, off_line
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.grip import Forces, Grip

Values = tuple[Dual, ...]


@dataclass(frozen=True, slots=True)
class Statement:
    """One kind of inequality."""

    id: str
    of: Callable[[Point, arb], Values]
    """Values that are positive where the inequality holds with more than a number to spare."""
    any_value: bool = False
    """Whether it is enough that one value is positive at each point."""

    @property
    def derivation(self) -> str | None:
        """File that derives it; None: it follows from the enclosures."""
        module, dot, _ = self.id.partition(".")
        return f"derivations/{module}.py" if dot else None


def _contact(at: Point) -> Contact:
    s, c = at["theta"].sin_cos()
    return Contact(c, s, at["d1"], at["d2"])


def _clearance(at: Point) -> Values:
    s, c = at["theta"].sin_cos()
    return (off_line(c, s, at["dx"], at["dy"]) - at["d1"],)


def _beside(at: Point) -> Values:
    s, c = at["theta"].sin_cos()
    beyond = (along(c, s, at["dx"], at["dy"]) + at["d2"]) * at["side"] - at["half"]
    return off_line(c, s, at["dx"], at["dy"]), beyond


def _friction(at: Point) -> Values:
    contact = _contact(at)
    cone, shear = contact.press(at["rho"]) * at["mu"], contact.shear(at["rho"])
    return cone - shear, cone + shear


def _only(at: Point) -> Values:
    # normal speed per normal force of the contact, while it slips either way, times rho
    straight, across = at["rho"] + at["d2"].squared(), at["mu"] * at["d1"] * at["d2"]
    return straight - across, straight + across


def _pair_sticks(at: Point) -> Values:
    # the drag of a translation along -x: cos(beta) on the edge, sin(beta) along it
    s, c = at["beta"].sin_cos()
    return c * at["mu"] - s, c * at["mu"] + s


def _pair_presses(at: Point) -> Values:
    # that drag acts at the centre: each tip carries the lever of the other one
    s, c = at["beta"].sin_cos()
    height = c * at["d2"] + s * at["d1"]
    return at["d4"] - height, height


def _arrives(at: Point) -> Values:
    side = 1 if at["side"].value > 0 else -1
    start, end = (
        Contact(c, s, at["d1"], at["d2"])
        for s, c in (at["theta_start"].sin_cos(), at["theta_end"].sin_cos())
    )
    return (at["travel"] - Turning(start, side).needed(end, at["rho"]),)


def _no_jam(at: Point) -> Values:
    width = at["d1"] * 2
    return (at["V"].squared() - width.squared() * (at["mu"].squared() + 1),)


def _forces(at: Point) -> list[Forces]:
    grip, mu = Grip.at(at["h"], at["V"], at["d1"]), at["mu"]
    ends = itertools.product((-1, 1), repeat=2)
    return [grip.forces(at["sigma"], at["rho"], mu * one, mu * two) for one, two in ends]


def _passive_force(at: Point, above: arb) -> Values:
    return tuple(forces.S - forces.divisor * above for forces in _forces(at))


def _active_force(at: Point, above: arb) -> Values:
    return tuple(forces.D - forces.divisor * above for forces in _forces(at))


def _alone(at: Point) -> Values:
    # its force L follows from L (rho + d2 m) = rho sin(theta), see approach.py
    d2 = Grip.at(at["h"], at["V"], at["d1"]).T / 2 - at["sigma"]
    lever = at["mu"] * at["d1"]
    return tuple(at["rho"] + d2 * (d2 + lever * sign) for sign in (-1, 1))


def _tips_on_edges(at: Point) -> Values:
    reach = Grip.at(at["h"], at["V"], at["d1"]).T / 2
    return tuple(at["half"] - (reach + at["sigma"] * sign) for sign in (-1, 1))


def _less(values: Callable[[Point], Values]) -> Callable[[Point, arb], Values]:
    return lambda at, above: tuple(value - above for value in values(at))


def _plain(id_: str, values: Callable[[Point], Values], *, any_value: bool = False) -> Statement:
    return Statement(id_, _less(values), any_value)


CLEARANCE = _plain("sticking_motion.clearance", _clearance)
BESIDE = _plain("sticking_motion.beside", _beside, any_value=True)
PRESSES = _plain(
    "one_point_sticking.normal_force",
    lambda at: (_contact(at).press(at["rho"]),),
)
STICKS = _plain("one_point_sticking.friction_margin", _friction)
TURNS = _plain(
    "one_point_sticking.turning",
    lambda at: (_contact(at).arm_y * at["side"],),
)
ONLY = _plain("one_point_sticking.only_solution", _only)
PAIR_STICKS = _plain("two_point_sticking.friction_margin", _pair_sticks)
PAIR_PRESSES = _plain("two_point_sticking.normal_forces", _pair_presses)
NO_JAM = _plain("two_sided_rotation.no_jam", _no_jam)
REACHES = _plain("travel", lambda at: (at["travel"],))
ON_EDGE = _plain("within_edge", lambda at: (at["half"] - at["d2"], at["half"] + at["d2"]))
BETWEEN_ENDS = _plain(
    "between_corners",
    lambda at: (at["d2"] - at["first"], at["last"] - at["d2"]),
)
ARRIVES = _plain("travel_to_spare", _arrives)
RESTS = _plain("touch_before_end", lambda at: (at["h_start"] - at["h_end"],))
COMES_FREE = _plain("faces_back", lambda at: (at["theta"].sin_cos()[0],))
PASSIVE_FORCE = Statement("two_sided_rotation.passive_force", _passive_force)
ALONE = _plain("active_alone", _alone)
ACTIVE_FORCE = Statement("active_force", _active_force)
TIPS_ON_EDGES = _plain("two_sided_rotation.ends_of_edges", _tips_on_edges)
PART_CLEAR, TIPS_CLEAR = (
    # verified over what is swept (walls.py), not as a formula of a few numbers
    Statement(id_, lambda at, above: ())
    for id_ in ("part_to_wall", "tip_to_wall")
)
STATEMENTS: Mapping[str, Statement] = {
    one.id: one
    for one in (
        CLEARANCE, BESIDE, PRESSES, STICKS, TURNS, ONLY, PAIR_STICKS, PAIR_PRESSES, NO_JAM,
        REACHES, ON_EDGE, BETWEEN_ENDS, ARRIVES, RESTS, COMES_FREE, PASSIVE_FORCE, TIPS_ON_EDGES, PART_CLEAR,
        TIPS_CLEAR,
    )
}  # fmt: skip
