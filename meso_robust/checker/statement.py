"""The inequalities that a certificate may state, each with the checker's own formula for it.

An inequality is named by its id: one with a dot is what that file of the derivations states. What is
not in this table is not understood, and the certificate is rejected. Variables that are exactly zero
for a task (radii, an uneven film ...) may be left out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from flint import arb

from meso_robust.checker.contact import Contact, Turning, along, off_line
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.film import EVEN, Arm, Film

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


def _arm(at: Point) -> Arm:
    return Arm.of(at["d1"], at["d2"], Film.at(at))


def _clearance(at: Point) -> Values:
    s, c = at["theta"].sin_cos()
    return (off_line(c, s, at["dx"], at["dy"]) - at["d1"],)


def _beside(at: Point) -> Values:
    s, c = at["theta"].sin_cos()
    beyond = (along(c, s, at["dx"], at["dy"]) + at["d2"]) * at["side"] - at["half"]
    return off_line(c, s, at["dx"], at["dy"]), beyond


def _press(at: Point) -> Values:
    s, c = at["theta"].sin_cos()
    return (_arm(at).press(c, s),)


def _friction(at: Point) -> Values:
    s, c = at["theta"].sin_cos()
    arm = _arm(at)
    cone, shear = arm.press(c, s) * at["mu"], arm.shear(c, s)
    return cone - shear, cone + shear


def _turns(at: Point) -> Values:
    s, c = at["theta"].sin_cos()
    return (_arm(at).turn(c, s) * at["side"],)


def _only(at: Point) -> Values:
    # normal speed per normal force of the contact, while it slips either way, times rho
    arm = _arm(at)
    straight, across = arm.straight, at["mu"] * arm.mixed
    return straight - across, straight + across


def _turns_any_way(at: Point) -> Values:
    # moment about the centre of drag of one unit of pressing, whatever friction does: the turn's sign
    arm = _arm(at)
    return (arm.d2 * at["side"] - at["mu"] * arm.d1,)


def _turns_back(at: Point) -> Values:
    # while it slips that way it turns the part faster, and the other way by its own moment
    s, c = at["theta"].sin_cos()
    arm = _arm(at)
    across = arm.d1 * (arm.film.stretch + 1) - arm.d2 * arm.film.shear
    return arm.turn(c, s) * at["side"], arm.d2 * at["side"] + at["mu"] * arm.d1, across


def _slips_one_way(at: Point) -> Values:
    s, c = at["theta"].sin_cos()
    arm = _arm(at)
    inward, across = arm.film.along(c, s)[1], at["mu"] * arm.mixed
    other_way = arm.press(c, s) * at["mu"] - arm.shear(c, s) * at["side"]
    return inward * (arm.straight + across), inward * (arm.straight - across), other_way


def _creeps_less(at: Point) -> Values:
    # slip per turn is what friction lacks over the turn's own factor; allowed is creep d(-cos^3 - cos/256)
    s, c = at["theta"].sin_cos()
    arm, side = _arm(at), at["side"]
    turned = arm.film.along(c, s)[1] * (arm.d2 * side - at["mu"] * arm.d1) * arm.room
    lacking = -(arm.press(c, s) * at["mu"] + arm.shear(c, s) * side)
    return (at["creep"] * (c.squared() * 3 + arb(1) / 256) * s * turned - lacking,)


def _pair_sticks(at: Point) -> Values:
    """Both tips together hold the part against the drag of its translation, and nothing else can be.

    A part that slides along both tips by ``y`` more has the forces ``f_a + (1 + stretch) y`` and ``N -
    shear y``, with ``f_a = -+k N`` for y above or below zero and some k between both friction
    coefficients: impossible where ``|f_a| < k N`` and ``1 + stretch > k |shear|``.
    """
    film, ratios = Film.at(at), [at[key] for key in ("mu", "mu_other") if key in at]
    s, c = at["beta"].sin_cos()
    along, press = film.force_of_slide(-s, c)
    held = [press * mu + along * sign for mu in ratios for sign in (-1, 1)]
    if film.even:
        return tuple(held)
    return *held, *(film.shear * mu * k + (film.stretch + 1) for mu in ratios for k in (-1, 1))


def _pair_presses(at: Point) -> Values:
    # the drag acts at its centre: each tip carries the lever of the other one
    film = Film.at(at)
    s, c = at["beta"].sin_cos()
    along, press = film.force_of_slide(-s, c)
    arm = _arm(at)
    height = press * arm.d2 + along * arm.d1
    return (press * at["gap"] if "gap" in at else at["d4"]) - height, height


def _arrives(at: Point) -> Values:
    side = 1 if at["side"].value > 0 else -1
    s, c = at["theta_start"].sin_cos()
    start = Contact(c, s, at["d1"], at["d2"], at.get("radius", EVEN))
    turning = Turning(start, at["theta_start"], side, Film.at(at))
    return (at["travel"] - turning.needed(at["theta_end"] - at["theta_start"]),)


def _faces_back(at: Point) -> Values:
    s, c = at["theta"].sin_cos()
    return (Film.at(at).along(c, s)[1],)


def _on_edge(at: Point) -> Values:
    if "half" in at:
        return at["half"] - at["d2"], at["half"] + at["d2"]
    return at["d2"] - at["first"], at["last"] - at["d2"]


def _no_jam(at: Point) -> Values:
    stretched = (at["mu"].squared() + 1).sqrt()
    return (at["V"] * stretched - at["width"] * stretched.squared() - at["radii"],)


def _no_jam_points(at: Point) -> Values:
    width = at["d1"] * 2
    return (at["V"].squared() - width.squared() * (at["mu"].squared() + 1),)


def _in_slot(at: Point) -> Values:
    return at["front"], at["rear"], at["end"], at["aside"]


def _bears(at: Point) -> Values:
    # moment about the slot's edge, and the film's about the centre, for either end of the cone
    lever = (at["d1"] + at["p"] - at["mu_w"] * at["b"]) * at["mu"]
    return at["d2"] - lever, at["d2"] + lever


def _steers(at: Point) -> Values:
    s, c = at["psi"].sin_cos()
    return (c * at["d2"] - s * at["d1"],)


def _corner_turns(at: Point) -> Values:
    s, c = at["phi"].sin_cos()
    d1, b, mu = at["d1"], at["b"], at["mu_w"]
    return (c * (d1 - mu * b) - s * (mu * d1 + b),)


def _stiff(at: Point) -> Values:
    return (at["rho"] * 4 - (at["mu_w"] * at["b"]).squared(),)


def _one_wall(at: Point) -> Values:
    s, c = at["phi"].sin_cos()
    return (at["room"] - c * at["b"] * 2 - s * at["engaged"],)


def _no_jam_in_slot(at: Point) -> Values:
    # cosine of both angles of friction and the lean together
    s, c = at["phi"].sin_cos()
    return (c * (-(at["mu"] * at["mu_w"]) + 1) - s * (at["mu"] + at["mu_w"]),)


def _less(values: Callable[[Point], Values]) -> Callable[[Point, arb], Values]:
    return lambda at, above: tuple(value - above for value in values(at))


def _plain(id_: str, values: Callable[[Point], Values], *, any_value: bool = False) -> Statement:
    return Statement(id_, _less(values), any_value)


CLEARANCE = _plain("sticking_motion.clearance", _clearance)
BESIDE = _plain("sticking_motion.beside", _beside, any_value=True)
BESIDE_ONE = _plain("sticking_motion.beside", _clearance)
"""The same of a tip that is off one and the same of these lines all the time."""
ANY_WAY = _plain("drag_tensor.turns_any_way", _turns_any_way)
TURNS_BACK = _plain("drag_tensor.turns_back", _turns_back)
SLIPS_ONE_WAY = _plain("drag_tensor.slips_one_way", _slips_one_way)
CREEPS_LESS = _plain("drag_tensor.creeps_less", _creeps_less)
PRESSES = _plain("one_point_sticking.normal_force", _press)
STICKS = _plain("one_point_sticking.friction_margin", _friction)
TURNS = _plain("one_point_sticking.turning", _turns)
ONLY = _plain("one_point_sticking.only_solution", _only)
PAIR_STICKS = _plain("two_point_sticking.friction_margin", _pair_sticks)
PAIR_PRESSES = _plain("two_point_sticking.normal_forces", _pair_presses)
NO_JAM = _plain("opposite_edges.no_jam", _no_jam)
NO_JAM_POINTS = _plain("two_sided_rotation.no_jam", _no_jam_points)
REACHES = _plain("travel", lambda at: (at["travel"],))
ON_EDGE = _plain("within_edge", _on_edge)
BETWEEN_ENDS = _plain("between_corners", _on_edge)
ARRIVES = _plain("travel_to_spare", _arrives)
ARRIVES_SLIPPING = _plain("travel_to_spare", lambda at: (at["spare"],))
"""The same of a first tip that may slip."""
RESTS = _plain("touch_before_end", lambda at: (at["h_start"] - at["h_end"],))
COMES_FREE = _plain("faces_back", _faces_back)
IN_SLOT = _plain("in_slot", _in_slot)
BEARS = _plain("slot_walls.bears", _bears)
STEERS = _plain("slot_walls.steers", _steers)
CORNER_TURNS = _plain("slot_walls.corner", _corner_turns)
STIFF = _plain("slot_walls.stiff", _stiff)
ONE_WALL = _plain("slot_walls.one_wall", _one_wall)
NO_JAM_IN_SLOT = _plain("slot_walls.no_jam", _no_jam_in_slot)
PASSIVE_FORCE, TIPS_ON_EDGES, PART_CLEAR, TIPS_CLEAR, FORCE = (
    # verified over a tube (rotate.py), a sweep (walls.py) or all (force.py), not as a formula of a few numbers
    Statement(id_, lambda at, above: ())
    for id_ in (
        "two_sided_rotation.passive_force", "two_sided_rotation.ends_of_edges", "part_to_wall", "tip_to_wall",
        "force_to_spare",
    )
)  # fmt: skip
STATEMENTS: Mapping[str, Statement] = {
    one.id: one
    for one in (
        CLEARANCE, BESIDE, PRESSES, STICKS, TURNS, ONLY, ANY_WAY, TURNS_BACK, SLIPS_ONE_WAY, CREEPS_LESS, PAIR_STICKS, PAIR_PRESSES, NO_JAM,
        NO_JAM_POINTS, REACHES, ON_EDGE, BETWEEN_ENDS, ARRIVES, RESTS, COMES_FREE, PASSIVE_FORCE, TIPS_ON_EDGES, PART_CLEAR,
        TIPS_CLEAR, FORCE, IN_SLOT, BEARS, STEERS, CORNER_TURNS, STIFF, ONE_WALL, NO_JAM_IN_SLOT,
    )
}  # fmt: skip
