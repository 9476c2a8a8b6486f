"""A two-sided rotation as functions of the parameters of its move, from which correlation follows.

Both tips, the part before the move and the end of the travel depend on the same few errors. Written as
functions of these, the distance of the tips, the touch of the passive one and the pose at the end keep
what they have in common. The axes are those of the move, turned by the direction of its travel.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import casadi as ca

from meso_robust.bounds import Bounded, Curved, Interval, bounded, curved
from meso_robust.conditions.formula import formula
from meso_robust.motion.two_sided import CONSTANT, INSTANT, MODULE, Line
from meso_robust.primitives.base import bend_of
from meso_robust.primitives.move import Aim, MoveRule
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox, Setup

ZERO, ONE = Interval.point(0.0), Interval.point(1.0)
Values = Mapping[str, ca.SX]

MOVE = (
    *("x", "y", "theta", "sensed_x", "sensed_y", "probe_x", "probe_y", "passive_x", "passive_y"),
    *("beta", "spacing", "direction", "scale"),
)
"""What the tips' paths depend on, by the names of a certificate."""
AIMS = ("dual_x", "dual_y", "end_x", "single_x", "single_y")
RULE = (*AIMS, "turn")
"""What is commanded, and the turn of the pushed edge."""
PART = (
    *("radius_lower", "radius_passive", "depth", "depth_far", "kappa", "kappa_far"),
    *("drag_a", "drag_n"),
)
"""Constants of both tips and the part."""
NOW = (*INSTANT[:-2], "sway_first", "travel_x")  # without both coefficients of friction
CREEPS = ("first_p", "d_D", "r_D", "drag_a", "drag_n")
"""Constants that the creep of the contact per turn is told of."""
ALONE = (
    *("gap", "turned", "creep", "tau", "by_angle", "upright"),
    *(f"{kind}_{name}" for kind in ("by", "at") for name in CREEPS),
)
"""While the active tip pushes alone: the gap to the passive tip, the turn since the touch, the mean creep of
the contact along its edge per turn, less what is told of it: its slopes by the angle of the edge, from
``upright``, and by constants, from ``at_*``; the ratio of friction."""
LABELS = ("label", "first_angle", "turned")
"""What tells runs of a rotation apart: the part's height over the passive tip, the direction of its edge at
the first touch, and how much it turns until the second."""
PARAMETERS = (*CONSTANT, *LABELS)
LINE = (
    *("first", "value", "rate", "rest"),
    *(f"{kind}_{name}" for kind in ("middle", "spread", "drift") for name in PARAMETERS),
)
"""An affine bound of the slide (`motion.two_sided.Line`)."""
INPUTS = (*MOVE, *RULE, *PART, *NOW, *ALONE, *LINE, "h", "room")


@dataclass(frozen=True, slots=True)
class Relations:
    """The functions, each of what it depends on."""

    begin: Bounded
    """V, room, label, angle of the edge before, h at the end of the travel, first gap, travel before the first touch, all of it."""
    path: Bounded
    """Direction of the edge in the move's own axes, p_D, x and y, while the active tip pushes alone."""
    creep: Bounded
    """Then what is left of the creep per turn if the contact slips, if it sticks; the lever of the turn."""
    closing: Bounded
    """Then how much the gap closes per turn if the contact slips."""
    rolling: Bounded
    """The same if it sticks; the turn per travel then."""
    stiffness: Bounded
    """Then the stiffness."""
    sticking: Bounded
    """Then the ratio of friction at which the contact sticks, and how the tip presses."""
    constants: Bounded
    """The constants that the creep is told of."""
    touch: Bounded
    """h at the touch of the passive tip, the slide there, the slide beyond a line."""
    end: tuple[Bounded, ...]
    """At the end of the travel: x; y; cos and sin of the direction of the pushed edge as stated; p_D."""
    during: tuple[Bounded, ...]
    """The same wherever ``h`` is given."""
    placed: Curved
    """x and y at the end of the travel, the room a variable of its own; that less what it depends on."""


@cache
def relations(exact: frozenset[str], from_part: frozenset[str]) -> Relations:
    """The functions for one kind of move.

    Parameters
    ----------
    exact
        Inputs that are exactly zero, which are left out.
    from_part
        Those of ``AIMS`` that are measured from the sensed part, not in the world.

    Returns
    -------
    Relations
        Prepared once and kept.
    """
    x = {name: ca.SX(0.0) if name in exact else ca.SX.sym(name) for name in INPUTS}
    at = dict(x)
    _place(at, from_part)
    _before(at)
    alone = dict(at)
    _alone(alone)
    touched = {**at, "gap": ca.SX(0.0)}
    _alone(touched)
    touched["slide"] = touched["q"] - _on_line(touched)
    ended = dict(at)
    ended["h"] = at["h_end"]
    _held(ended)
    during = dict(at)
    _held(during)
    given = {**ended, "room": x["room"]}
    _held(given)
    given["off"] = given["room"] - at["room"]

    def prepared(name: str, values: Values, *results: str) -> Bounded:
        outputs = ca.cse(ca.densify(ca.vertcat(*(values[key] for key in results))))
        used = {symbol.name() for symbol in ca.symvar(outputs)}
        inputs = tuple(key for key in INPUTS if key in used)
        vector = ca.SX.sym("x", len(inputs))
        outputs = ca.substitute(outputs, ca.vertcat(*(x[key] for key in inputs)), vector)
        return bounded(name, inputs, ca.Function("f", [vector], [outputs]))

    held = {"x": ("pose_x",), "y": ("pose_y",), "direction": ("cosine", "sine"), "offset": ("p_D",)}
    return Relations(
        begin=prepared(
            "begin", at, "V", "room", "label", "first_angle", "h_end", "first_gap", "flight", "way"
        ),
        path=prepared("path", alone, "own_angle", "p_D", "pose_x", "pose_y"),
        creep=prepared("creep", alone, "slipping_left", "rolling_left", "lever"),
        closing=prepared("closing", alone, "gap_per_turn"),
        rolling=prepared("rolling", alone, "gap_per_rolling", "turn_rolling"),
        stiffness=prepared("stiffness", alone, "stiffness"),
        sticking=prepared("sticking", alone, "stick_ratio", "pressing"),
        constants=prepared("constants", alone, *CREEPS),
        touch=prepared("touch", touched, "h", "q", "slide"),
        end=tuple(prepared(name, ended, *results) for name, results in held.items()),
        during=tuple(prepared(name, during, *results) for name, results in held.items()),
        placed=curved(
            prepared("placed", given, "pose_x", "pose_y", "off"),
            set(LINE) - {"rest"},
        ),
    )


def _call(name: str, at: Values, *keys: str, module: str = MODULE) -> tuple[ca.SX, ...]:
    return formula(module, name)(ca, *(at[key] for key in keys))


def _place(at: dict[str, ca.SX], from_part: frozenset[str]) -> None:
    """Both tips relative to the part before the move, and the travel."""

    def sensed(axis: str, plus: str, minus: str = "") -> ca.SX:
        """What the sensed part adds: nothing, symbolically, where two aims have it in common."""
        count = int(plus in from_part) - int(minus in from_part)
        return count * (at[axis] + at[f"sensed_{axis}"])

    half = 0.5 * at["spacing"]
    lag = half * ca.sin(at["beta"]) / ca.cos(at["beta"])
    in_x = at["dual_x"] + at["probe_x"] + lag
    in_y = at["dual_y"] + at["probe_y"] - half
    passive_x, passive_y = at["single_x"] + at["passive_x"], at["single_y"] + at["passive_y"]
    apart_x = in_x - passive_x + sensed("x", "dual_x", "single_x")
    apart_y = in_y - passive_y + sensed("y", "dual_y", "single_y")
    active_x, active_y = (
        in_x + _ahead(at, "x", "dual_x" in from_part),
        in_y + _ahead(at, "y", "dual_y" in from_part),
    )
    at["passive_ahead"] = passive_x + _ahead(at, "x", "single_x" in from_part)
    at["passive_rise"] = passive_y + _ahead(at, "y", "single_y" in from_part)
    at["place_x"] = passive_x + sensed("x", "single_x")
    at["place_y"] = passive_y + sensed("y", "single_y")
    travel = at["dual_x"] - at["end_x"] + sensed("x", "dual_x", "end_x")
    c, s = ca.cos(at["direction"]), ca.sin(at["direction"])
    at["V"] = apart_y * c - apart_x * s
    at["way"] = travel * (1.0 + at["scale"]) + at["travel_x"]
    at["h_end"] = apart_x * c + apart_y * s - at["way"]
    at["label"] = at["passive_ahead"] * s - at["passive_rise"] * c
    at["active_height"] = active_y * c - active_x * s + at["sway_first"]
    at["active_ahead"] = active_x * c + active_y * s + at["travel_x"]
    at["to_part_x"] = -(at["passive_ahead"] * c + at["passive_rise"] * s)


def _ahead(at: Values, axis: str, from_part: bool) -> ca.SX:
    """What leads from a commanded coordinate to one from the part."""
    return at[f"sensed_{axis}"] if from_part else -at[axis]


def _before(at: dict[str, ca.SX]) -> None:
    """The touch of the active tip: direction of its edge, its place there, the gap to the passive tip."""
    at["d_D"], at["d_S"] = at["depth"], at["depth_far"]
    at["r_D"], at["r_S"] = at["radius_lower"], at["radius_passive"]
    own = at["kappa"]
    at["kappa"] = at["kappa_far"] - own
    at["own_kappa"] = own
    at["room"] = at["V"] - at["d_D"] - at["d_S"] - at["r_D"] - at["r_S"]
    at["first_angle"] = at["theta"] - at["turn"] + own - at["direction"]
    (at["first_gap"],) = formula("sticking_motion", "clearance")(
        ca,
        at["first_angle"] + at["kappa"],
        at["d_S"] + at["r_S"],
        at["to_part_x"],
        at["label"],
    )
    touching = at["first_angle"], at["d_D"] + at["r_D"], at["active_height"]
    (at["first_p"],) = formula("sticking_motion", "contact_offset")(ca, *touching)
    (reach,) = formula("sticking_motion", "contact_reach")(ca, *touching)
    at["flight"] = at["active_ahead"] - reach


def _alone(at: dict[str, ca.SX]) -> None:
    """The part when the active tip alone has turned it, at a mean creep per turn, and its rates then."""
    angle = at["first_angle"] + at["turned"]
    at["c"], at["s"] = ca.cos(angle), ca.sin(angle)
    at["own_angle"] = angle + at["direction"]
    told = sum((at[f"by_{name}"] * (at[name] - at[f"at_{name}"]) for name in CREEPS), ca.SX(0.0))
    halfway = at["first_angle"] - at["upright"] + 0.5 * at["turned"]
    at["p_D"] = at["first_p"] + at["turned"] * (at["creep"] + at["by_angle"] * halfway + told)
    touch = ("c", "s", "p_D", "V", "gap", "d_D", "d_S", "r_D", "r_S", "kappa")
    at["V"] = at["V"] + at["sway"]
    at["q"], apart = _call("passive_place", at, *touch)
    (width,) = _call("width", at, "q", "d_D", "d_S", "r_D", "r_S", "kappa")
    at["h"] = apart * at["c"] + width * at["s"]
    _pose(at, at["c"], at["s"], at["d_S"] + at["gap"])
    along, out = (at[f"drag_{axis}"] + at[f"centre_{axis}"] for axis in "an")
    at["along"], at["out"] = along, out
    film = ("along", "out", "rho", "stretch", "shear")
    (at["stiffness"],) = _call("stiffness", at, "p_D", "d_D", *film, "tau")
    for name in ("pressing", "stick_ratio"):
        (at[name],) = _call(name, at, "c", "s", "p_D", "d_D", *film, "bend")
    (at["gap_per_turn"],) = _call("gap_per_turn", at, *touch, *film, "tau")
    (at["gap_per_rolling"],) = _call("gap_per_rolling", at, *touch, *film, "bend")
    (at["turn_rolling"],) = _call("turn_rolling", at, "c", "s", "p_D", "d_D", *film, "bend")
    creeping = ("c", "s", "p_D", "d_D", "r_D", *film, "bend", "tau")
    slipping, at["lever"] = _call("creep_per_turn", at, *creeping)
    told += at["by_angle"] * (angle - at["upright"])
    at["slipping_left"], at["rolling_left"] = slipping - told, -at["r_D"] - told


def _on_line(at: Values) -> ca.SX:
    """The slide that a line bounds, with its rest."""
    gone = at["first"] - at["h"]
    total = at["value"] + at["rate"] * gone + at["rest"]
    for name in PARAMETERS:
        slope = at[f"spread_{name}"] + at[f"drift_{name}"] * gone
        total += slope * (at[name] - at[f"middle_{name}"])
    return total


def _held(at: dict[str, ca.SX]) -> None:
    """The part between both tips, its slide on a line."""
    at["q"] = _on_line(at)
    (at["W"],) = _call("width", at, "q", "d_D", "d_S", "r_D", "r_S", "kappa")
    swayed = {**at, "room": at["room"] + at["sway"]}
    (at["clear"],) = _call("clear", swayed, "q", "d_S", "r_S", "kappa", "room")
    (at["T"],) = _call("apart", at, "h", "clear", "W")
    c, s = _call("direction", {**at, "V": at["clear"] + at["W"]}, "h", "V", "W", "T")
    (at["p_D"],) = _call("active_offset", at, "T", "q", "d_S", "r_S", "kappa")
    _pose(at, c, s, at["d_S"])


def _pose(at: dict[str, ca.SX], c: ca.SX, s: ca.SX, far: ca.SX) -> None:
    """The part in the move's own axes, ``far`` from the passive tip's edge to where the tip is."""
    turned_c, turned_s = ca.cos(at["direction"]), ca.sin(at["direction"])
    own_c, own_s = c * turned_c - s * turned_s, s * turned_c + c * turned_s
    (from_x, from_y) = formula(MODULE, "place")(
        ca, own_c, own_s, at["q"], far, at["r_S"], at["kappa"]
    )
    at["pose_x"], at["pose_y"] = at["place_x"] + from_x, at["place_y"] + from_y
    # of the edge as stated: the part's orientation is known from it
    lean_c, lean_s = ca.cos(at["own_kappa"]), ca.sin(at["own_kappa"])
    at["cosine"] = own_c * lean_c + own_s * lean_s
    at["sine"] = own_s * lean_c - own_c * lean_s


def aims_of(rule: MoveRule) -> dict[str, Aim]:
    """What is commanded, by the names of ``AIMS``.

    Parameters
    ----------
    rule
        A rotation.

    Returns
    -------
    dict[str, Aim]
        Each from the sensed part or in the world.

    Raises
    ------
    ValueError
        The rule has no passive tip.
    """
    if rule.single is None:
        raise ValueError(f"rotation rule needs a passive tip, got {rule}")
    aims = rule.dual.x, rule.dual.y, rule.dual_end, rule.single.x, rule.single.y
    return dict(zip(AIMS, aims, strict=True))


def ranges(
    rule: MoveRule, pre: PoseBox, edge: Edge, far: Edge, setup: Setup
) -> dict[str, Interval]:
    """What is known of a rotation, by the names of ``INPUTS``; SI, in the axes of the move.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it, the task.
    edge, far
        The pushed edge and the one that the passive tip holds.

    Returns
    -------
    dict[str, Interval]
        The parameters of the move and the part, and what is commanded.

    Raises
    ------
    ValueError
        The rule has no passive tip.
    """
    u, off = setup.uncertainty, setup.uncertainty.probe_position
    commanded = {name: aim.offset for name, aim in aims_of(rule).items()}
    # a deviation of w in x and in y is one of at most w (1 + |direction|) in the turned axes
    wander = u.probe_wander * (ONE + u.travel_direction.hull(-u.travel_direction))
    return {
        "x": pre.x, "y": pre.y, "theta": pre.theta,
        "sensed_x": u.sensed_position, "sensed_y": u.sensed_position,
        "probe_x": off, "probe_y": off, "passive_x": off, "passive_y": off,
        "beta": u.misalignment, "spacing": setup.spacing,
        "direction": u.travel_direction, "scale": u.travel_scale,
        **commanded, "turn": edge.turn,
        "radius_lower": u.tip_radius, "radius_passive": u.passive_tip_radius,
        "depth": edge.depth, "depth_far": far.depth,
        "kappa": u.squareness, "kappa_far": u.squareness,
        "drag_a": setup.fixed_centre, "drag_n": setup.fixed_centre,
        "centre_a": setup.moving_centre, "centre_n": setup.moving_centre,
        "rho": u.film_ratio, "stretch": u.drag_anisotropy, "shear": u.drag_anisotropy,
        "bend": bend_of(u), "sway": wander, "sway_first": wander, "travel_x": wander,
    }  # fmt: skip


def on_line(line: Line, parameters: Mapping[str, Interval]) -> dict[str, Interval]:
    """The inputs that stand for an affine bound of the slide."""
    found = {
        "first": Interval.point(line.first),
        "value": Interval.point(line.value),
        "rate": Interval.point(line.rate),
        "rest": line.rest,
    }
    for name in PARAMETERS:
        side = parameters.get(name, ZERO)
        found[f"middle_{name}"] = Interval.point(side.mid)
        found[f"spread_{name}"] = Interval.point(line.spread.get(name, 0.0))
        found[f"drift_{name}"] = Interval.point(line.drift.get(name, 0.0))
    return found
