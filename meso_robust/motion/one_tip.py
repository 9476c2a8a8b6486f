"""One sticking tip turns the part: where that leads and what keeps it so, over base parameters.

The formulas are those of derivations/drag_tensor.py and round_tips.py, put together here as CasADi
expressions of what is uncertain by itself; :mod:`meso_robust.bounds.implicit` bounds them. The clock
is the direction of the edge: the travel is one quadrature in it, everything else is explicit.

Names of parameters are those of certificates; axes are those of the move. What acts on the way has
another value at the instant that a condition is about (``_now``).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import casadi as ca

from meso_robust.bounds import Bounded, Box, bounded
from meso_robust.bounds.implicit import Implicit, Quadrature, implicit
from meso_robust.conditions import formula

Symbols = dict[str, ca.SX]

POSE = ("x", "y", "theta")
PLACE = ("sensed_x", "sensed_y", "probe_x", "probe_y")
CREEP, CREEP_MOST = "creep_now", "creep_most"
"""How far the contact has slipped, over that of derivations/drag_tensor.py per unit of its ``creep``, and
the most that can be, m."""
TURNED, PROGRESS = "turned", "progress"
"""How far the part has been turned since the touch, rad; the share of the travel in contact."""
PATH = (
    *("direction", "scale", "wander_x", "wander_y", "wander_x_now", "wander_y_now"),
    CREEP,
)
TIPS = ("beta", "spacing", "radius_upper", "radius_lower")
PART = ("depth", "kappa", "drag_a", "drag_n")
DRAG = ("rho", "stretch", "shear", "bend")
CENTRE = ("centre_a", "centre_n")
"""Of drag, where it moves: from ``drag_a``, ``drag_n``."""
HISTORY = (*DRAG, *CENTRE)
NOW = (*(f"{name}_now" for name in HISTORY), "mu_upper_now", "mu_lower_now", "share")
PARAMETERS = (*POSE, *PLACE, *PATH, *TIPS, *PART, *HISTORY, CREEP_MOST, TURNED, PROGRESS, *NOW)

AIM = ("turn", "part_x", "part_y", "part_end", "offset_x", "offset_y", "offset_end")
"""The direction of the edge in the part, and the commands; ``part_x`` is 1 if that coordinate is
commanded from the sensed part, 0 if in the world."""
BEFORE = (*POSE, *PLACE, *PATH)
"""Of the tilt just before a straightening: what has another value there."""
BEFORE_AIM = AIM[1:]
ACROSS, LEVER = "across", "lever"
"""Of a coordinate that hangs on the orientation: what it is less ``lever`` times that, m, and m per rad."""
ERRORS = frozenset((*PARAMETERS[len(POSE) :], *(f"tilt_{name}" for name in (*PLACE, *PATH)))) - {
    "share"
}
"""Parameters that may be exactly zero: all but poses and the share of the way."""
LINES = ("before_touch", "while_turning", "on_withdrawal")
"""When the idle tip must be off the line of some side of the part's convex hull."""


NONE: frozenset[str] = frozenset()


def _call(module: str, name: str, *arguments: ca.SX) -> tuple[ca.SX, ...]:
    return tuple(map(ca.SX, formula(module, name)(ca, *arguments)))


def _two(module: str, name: str, *arguments: ca.SX) -> tuple[ca.SX, ca.SX]:
    first, second = _call(module, name, *arguments)
    return first, second


def zeros(box: Box) -> frozenset[str]:
    """Which parameters are exactly zero: a motion is prepared without them.

    Parameters
    ----------
    box
        By name.

    Returns
    -------
    frozenset
        Names. The formulas of point tips and an isotropic film are much shorter than the general
        ones, and so are their enclosures.
    """
    return frozenset(name for name, side in box.items() if side.lo == 0.0 == side.hi) & ERRORS


def _named(names: Iterable[str], zero: frozenset[str], prefix: str = "") -> Symbols:
    keys = [prefix + name for name in names]
    return {key: ca.SX(0) if key in zero else ca.SX.sym(key) for key in keys}


@dataclass(frozen=True, slots=True, eq=False)
class _Push:
    """One tip on its way to the part, from where it starts to where it touches."""

    v: Mapping[str, ca.SX]
    """Parameters and constants."""
    tip: int
    """1: the upper one, -1: the lower one."""
    at: str = ""
    """Prefix of what belongs to this move alone."""

    def own(self, name: str) -> ca.SX:
        """A parameter or constant of this move."""
        return self.v[self.at + name]

    def radius(self, tip: int) -> ca.SX:
        """Of the upper or the lower tip."""
        return self.v["radius_upper" if tip > 0 else "radius_lower"]

    @property
    def angle(self) -> ca.SX:
        """Direction of the edge at the start."""
        return self.own("theta") - self.v["turn"] + self.v["kappa"]

    @property
    def unit(self) -> tuple[ca.SX, ca.SX]:
        """The direction that the tip comes from."""
        return ca.cos(self.own("direction")), ca.sin(self.own("direction"))

    def start(self, tip: int, wander: str = "") -> tuple[ca.SX, ca.SX]:
        """Centre of a tip from the part's reference point, before it has travelled."""
        beta, half = self.v["beta"], tip * 0.5 * self.v["spacing"]
        off = -half * ca.sin(beta) / ca.cos(beta), half
        found = []
        for axis, lag in zip("xy", off, strict=True):
            part = self.own(f"part_{axis}")
            base = (part - 1) * self.own(axis) + part * self.own(f"sensed_{axis}")
            error = self.own(f"probe_{axis}") + self.own(f"wander_{axis}{wander}")
            found.append(base + self.own(f"offset_{axis}") + error + lag)
        return found[0], found[1]

    @property
    def other(self) -> tuple[ca.SX, ca.SX]:
        """From this tip to the other one of the pair."""
        beta, down = self.v["beta"], -self.tip * self.v["spacing"]
        return -down * ca.sin(beta) / ca.cos(beta), down

    @property
    def travel(self) -> ca.SX:
        """True length of the whole travel."""
        sensed = self.own("x") + self.own("sensed_x")
        commanded = (self.own("part_x") - self.own("part_end")) * sensed
        commanded += self.own("offset_x") - self.own("offset_end")
        return commanded * (1 + self.own("scale"))

    @property
    def touch(self) -> tuple[ca.SX, ca.SX]:
        """Travel until the tip touches, and the offset of its contact."""
        place = self.start(self.tip)
        reach = self.angle, self.own("direction"), self.v["depth"], self.radius(self.tip), *place
        return _two("round_tips", "touch", *reach)

    @property
    def in_contact(self) -> ca.SX:
        """Progress along the push from the touch to the end."""
        c, s = self.unit
        astray = [self.own(f"wander_{axis}_now") - self.own(f"wander_{axis}") for axis in "xy"]
        return self.travel - self.touch[0] - astray[0] * c - astray[1] * s

    def offset(self, angle: ca.SX, creep: str = CREEP) -> ca.SX:
        """Of the contact, which rolls and may have slipped, when the edge has come to ``angle``."""
        rolled = angle, self.angle, self.touch[1], self.radius(self.tip)
        return _call("round_tips", "rolled", *rolled)[0] - self.slipped(angle, creep)

    def slipped(self, angle: ca.SX, creep: str) -> ca.SX:
        """How far the contact has slipped since the touch."""
        angles = angle - self.own("direction"), self.angle - self.own("direction")
        return _call("drag_tensor", "slipped", *angles, self.own(creep))[0]

    def arm(self, angle: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Centre of the touching tip from the reference point when the edge has come to ``angle``."""
        out = self.v["depth"] + self.radius(self.tip)
        return _two("sticking_motion", "arm", angle, out, self.offset(angle))

    def centre(self, angle: ca.SX) -> tuple[ca.SX, ca.SX]:
        """The part's reference point at the end of the travel, where the edge is at ``angle``."""
        start, arm = self.start(self.tip, "_now"), self.arm(angle)
        found = [
            self.own(axis) + start[k] - self.travel * self.unit[k] - arm[k]
            for k, axis in enumerate("xy")
        ]
        return found[0], found[1]

    def state(self, angle: ca.SX, offset: ca.SX, now: str = "_now") -> tuple[ca.SX, ...]:
        """Arguments of the formulas of one contact: direction, d1, d2, drag and bend."""
        v = self.v
        drag = (v[f"{name}{now}"] for name in DRAG)
        along, out = (v[f"drag_{axis}"] + v[f"centre_{axis}{now}"] for axis in "an")
        about = v["depth"] - out, offset - along
        return angle - self.own("direction"), *about, *drag

    def clear(self, tip: int, angle: ca.SX, depth: ca.SX, place: tuple[ca.SX, ca.SX]) -> ca.SX:
        """How far a tip at ``place`` from the reference point is off a line."""
        return _call("sticking_motion", "clearance", angle, depth + self.radius(tip), *place)[0]


def _margins(push: _Push, tip: int, side: int, angle: ca.SX, offset: ca.SX) -> list[ca.SX]:
    """One contact pushes, sticks (two margins), turns the part to ``side``, and only sticks (two)."""
    direction, d1, d2, rho, stretch, shear, bend = push.state(angle, offset)
    mu = push.v["mu_upper_now" if tip > 0 else "mu_lower_now"]
    drag = rho, stretch, shear, bend
    turned = direction, d1, d2, stretch, shear, bend, ca.SX(side)
    return [
        *_call("drag_tensor", "normal_force", direction, d1, d2, *drag),
        *_call("drag_tensor", "friction_margin", direction, d1, d2, *drag, mu),
        *_call("drag_tensor", "turning", *turned),
        *_call("drag_tensor", "only_solution", d1, d2, rho, stretch, shear, mu),
    ]


def _numbered(name: str, values: Iterable[ca.SX]) -> Symbols:
    return {f"{name}_{k}": value for k, value in enumerate(values)}


def _about(push: _Push, tip: int, angle: ca.SX, offset: ca.SX) -> tuple[ca.SX, ...]:
    """Arguments of the formulas of a contact that may slip towards its own side."""
    mu = push.v["mu_upper_now" if tip > 0 else "mu_lower_now"]
    return *push.state(angle, offset), mu, ca.SX(tip)


def _turns_any_way(push: _Push, tip: int, angle: ca.SX, offset: ca.SX) -> ca.SX:
    _, d1, d2, *_ = push.state(angle, offset)
    mu = push.v["mu_upper_now" if tip > 0 else "mu_lower_now"]
    return _call("drag_tensor", "turns_any_way", d1, d2, mu, ca.SX(tip))[0]


def _turns_back(name: str, push: _Push, tip: int, angle: ca.SX, offset: ca.SX) -> Symbols:
    """One contact turns the part towards its own side, whether it sticks or slips."""
    direction, d1, d2, _, *rest = _about(push, tip, angle, offset)
    values = _call("drag_tensor", "turns_back", direction, d1, d2, *rest)
    return _numbered(f"{name}_turns_back", values)


MARGINS = ("pushes", "sticks_up", "sticks_down", "turns", "only_up", "only_down")
TURNS_BACK = tuple(f"turns_back_{k}" for k in range(3))
SLIPS_ONE_WAY = tuple(f"first_slips_one_way_{k}" for k in range(3))


def _sticks(name: str, margins: list[ca.SX]) -> Symbols:
    return {f"{name}_{key}": value for key, value in zip(MARGINS, margins, strict=True)}


def _on_edge(name: str, push: _Push, offset: ca.SX) -> Symbols:
    return {
        f"{name}_below_end": push.v["last"] - offset,
        f"{name}_above_end": offset - push.v["first"],
    }


@cache
def tilt(side: int, zero: frozenset[str] = NONE) -> Implicit:
    """The lower tip (``side`` = 1: the part turns counter-clockwise) or the upper one (-1) turns.

    Parameters
    ----------
    side
        Which way the part turns.

    Returns
    -------
    Implicit
        Its end is the direction of the edge after the tilt; outputs are the pose after it and all
        margins, each positive where it holds.
    """
    v, end, total = _symbols(zero, LINE_NAMES)
    push = _Push(v, -side)
    turned = end - push.angle
    angle = push.angle + v["share"] * turned
    x, y = push.centre(end)
    c, s = push.unit
    to_idle, travelled, touched = push.other, v["share"] * push.travel, push.touch[0]
    start = push.start(-push.tip, "_now")
    flight = start[0] - v["share"] * touched * c, start[1] - v["share"] * touched * s
    rolling, last = push.arm(angle), push.arm(end)
    back = (
        last[0] + to_idle[0] + travelled * c + v["stray_x"] - v["wander_x_now"],
        last[1] + to_idle[1] + travelled * s + v["stray_y"] - v["wander_y_now"],
    )
    places = {
        "before_touch": (push.angle, flight),
        "while_turning": (angle, (rolling[0] + to_idle[0], rolling[1] + to_idle[1])),
        "on_withdrawal": (end, back),
    }
    outputs = {
        **{"x": x, "y": y, "theta": end + v["turn"] - v["kappa"]},
        "reaches": push.in_contact,
        **_on_edge("pushing", push, push.offset(angle)),
        **_sticks("pushing", _margins(push, push.tip, side, angle, push.offset(angle))),
        **{
            when: push.clear(
                -push.tip, edge - v["kappa"] - v[f"{when}_turn"], v[f"{when}_depth"], place
            )
            for when, (edge, place) in places.items()
        },
        "withdraws": _faces_back(push, end),
    }
    return _prepared(
        "tilt", v, end, [(total, _needed(push, end))], total - push.in_contact, outputs
    )


def _faces_back(push: _Push, end: ca.SX) -> ca.SX:
    c, s = ca.cos(end - push.own("direction")), ca.sin(end - push.own("direction"))
    return s - push.v["bend_now"] * c


def _needed(push: _Push, stop: ca.SX) -> Quadrature:
    """Travel that turns the edge from where it is touched to ``stop`` while the tip sticks."""
    angle = ca.SX.sym("angle")
    offset = push.offset(angle) + push.slipped(angle, CREEP)
    (rate,) = _call("drag_tensor", "travel_rate", *push.state(angle, offset, ""))
    return Quadrature(rate=rate, clock=angle, start=push.angle, stop=stop)


LINE_NAMES = tuple(f"{when}_{key}" for when in LINES for key in ("turn", "depth"))
ENDS = ("first", "last", "stray_x", "stray_y")


def _symbols(zero: frozenset[str], more: tuple[str, ...] = ()) -> tuple[Symbols, ca.SX, ca.SX]:
    v = _named((*PARAMETERS, *AIM, *ENDS, *more), zero)
    return v, ca.SX.sym("end"), ca.SX.sym("total")


def _prepared(
    name: str,
    v: Symbols,
    end: ca.SX,
    integrals: Sequence[tuple[ca.SX, Quadrature]],
    residual: ca.SX,
    outputs: Symbols,
) -> Implicit:
    names = {*PARAMETERS, *(f"tilt_{name}" for name in BEFORE), ACROSS}
    free = {key: symbol for key, symbol in v.items() if symbol.is_symbolic()}
    return implicit(
        name,
        parameters={key: symbol for key, symbol in free.items() if key in names},
        constants={key: symbol for key, symbol in free.items() if key not in names},
        history=HISTORY,
        end=end,
        integrals=integrals,
        residual=residual,
        outputs=outputs,
    )


@cache
def straighten(side: int, zero: frozenset[str] = NONE) -> Implicit:
    """The upper tip (``side`` = 1: the part turns counter-clockwise) or the lower one turns it, then both push.

    Parameters
    ----------
    side
        Which way the part turns.

    Returns
    -------
    Implicit
        Its end is the direction of the edge at which both tips touch.
    """
    v, end, total = _symbols(zero)
    push = _Push(v, side)
    angle = push.angle + v["share"] * (end - push.angle)
    (gap,) = _call("round_tips", "contact_gap", end, v["beta"], v["spacing"])
    first = push.offset(end)
    second = first - side * gap
    direction, d1, upper, _, *drag = push.state(end, first if side > 0 else second)
    friction = [
        value
        for mu in ("mu_upper_now", "mu_lower_now")
        for value in _call("drag_tensor", "pair_friction", direction, *drag, v[mu])
    ]
    forces = _call("drag_tensor", "pair_forces", direction, d1, upper, gap, *drag)
    x, y = push.centre(end)
    outputs = {
        **{"x": x, "y": y, "theta": end + v["turn"] - v["kappa"]},
        "withdraws": _faces_back(push, end),
        **_on_edge("first", push, push.offset(angle)),
        **_sticks("first", _margins(push, side, side, angle, push.offset(angle))),
        **_turns_back("first", push, side, angle, push.offset(angle)),
        **_numbered(
            "first_slips_one_way",
            _call("drag_tensor", "slips_one_way", *_about(push, side, angle, push.offset(angle))),
        ),
        **_on_edge("second", push, second),
        **{f"pair_sticks_{k}": value for k, value in enumerate(friction)},
        **{f"pair_pushes_{k}": value for k, value in enumerate(forces)},
        **_sticks("second", _margins(push, -side, -side, end, second)),
        "second_turns_any_way": _turns_any_way(push, -side, end, second),
        **_turns_back("second", push, -side, end, second),
        "spare": push.in_contact - total,
    }
    needed = [(total, _needed(push, end))]
    return _prepared("straighten", v, end, needed, _flush(push, end), outputs)


@cache
def creeping(side: int, zero: frozenset[str] = NONE) -> Bounded:
    """Whether the first contact of a straightening that has slipped by its bound slips by less per turn.

    Parameters
    ----------
    side
        As for `straighten`.

    Returns
    -------
    Bounded
        One output, m^2, positive if so; of the base parameters and of how far the part is ``turned``.
    """
    v = _named((*PARAMETERS, *AIM), zero)
    push = _Push(v, side)
    angle = push.angle + side * v[TURNED]
    about = _about(push, side, angle, push.offset(angle, CREEP_MOST))
    (less,) = _call("drag_tensor", "creeps_less", *about, v[CREEP_MOST])
    return _bounded("creeping", v, less)


@cache
def slowness(side: int, zero: frozenset[str] = NONE) -> Bounded:
    """How much travel a straightening needs while its first contact may slip.

    Parameters
    ----------
    side
        As for `straighten`.

    Returns
    -------
    Bounded
        Travel per radian, m, at most, when the part is ``turned`` so far; all travel in contact, m.
    """
    v = _named((*PARAMETERS, *AIM), zero)
    push = _Push(v, side)
    angle = push.angle + side * v[TURNED]
    # a contact that slips turns the part faster
    state = push.state(angle, push.offset(angle), "")
    (rate,) = _call("drag_tensor", "travel_rate", *state)
    return _bounded("slowness", v, ca.vertcat(side * rate, push.in_contact))


@cache
def straighten_height(side: int, tilted: int, zero: frozenset[str] = NONE) -> Implicit:
    """Where a straightening leaves y just after a tilt to ``tilted``.

    The tilt's contact keeps the height of its tip, so that y before the straightening hangs on the
    direction that the tilt has left; in the sum of both the largest part of that cancels
    (derivations/y_translation.py). What belongs to the tilt alone has ``tilt_`` before its name.

    Parameters
    ----------
    side, tilted
        Which way the straightening and the tilt before it turn the part.

    Returns
    -------
    Implicit
        With the one output ``y``.
    """
    v, end, total = _symbols(zero)
    v |= _named((*BEFORE, *BEFORE_AIM), zero, "tilt_")
    before = _Push(v, -tilted, "tilt_")
    push = _Push({**v, "y": before.centre(_Push(v, side).angle)[1]}, side)
    del v["y"]
    needed = [(total, _needed(push, end))]
    return _prepared(
        "height after a tilt", v, end, needed, _flush(push, end), {"y": push.centre(end)[1]}
    )


@cache
def left_ahead(side: int, zero: frozenset[str] = NONE) -> Implicit:
    """Where a straightening leaves x, less ``LEVER`` times the orientation that it leaves.

    The radii of the tips decide both, so that the difference is known better than its terms.

    Parameters
    ----------
    side
        Which way it turns the part.

    Returns
    -------
    Implicit
        With the one output ``ACROSS``.
    """
    v, end, total = _symbols(zero, (LEVER,))
    push = _Push(v, side)
    across = push.centre(end)[0] - v[LEVER] * (end + v["turn"] - v["kappa"])
    needed = [(total, _needed(push, end))]
    return _prepared("left ahead", v, end, needed, _flush(push, end), {ACROSS: across})


@cache
def straighten_across(side: int, zero: frozenset[str] = NONE) -> Implicit:
    """Where a straightening leaves y if ``ACROSS`` of it is known before.

    Parameters
    ----------
    side
        As for `straighten`.

    Returns
    -------
    Implicit
        With the one output ``y``.
    """
    v, end, total = _symbols(zero, (LEVER,))
    before = ca.SX.sym(ACROSS)
    push = _Push({**v, "y": before + v[LEVER] * v["theta"]}, side)
    v |= {"y": ca.SX(0), ACROSS: before}
    needed = [(total, _needed(push, end))]
    return _prepared(
        "height after a push", v, end, needed, _flush(push, end), {"y": push.centre(end)[1]}
    )


@cache
def tilt_tube(side: int, zero: frozenset[str] = NONE) -> Implicit:
    """The pose when ``share`` of a tilt's turn is done.

    Parameters
    ----------
    side
        As for `tilt`.

    Returns
    -------
    Implicit
        Its end is that of `tilt`; outputs are the pose on the way.
    """
    v, end, total = _symbols(zero)
    push = _Push(v, -side)
    residual = total - push.in_contact
    return _tube(push, v, end, [(total, _needed(push, end))], residual)


@cache
def straighten_tube(side: int, zero: frozenset[str] = NONE, *, slips: bool = False) -> Implicit:
    """The pose when ``share`` of a straightening's turn is done.

    Parameters
    ----------
    side
        As for `straighten`.
    slips
        Whether the first contact may slip: the travel until then is ``PROGRESS``, whatever it is.

    Returns
    -------
    Implicit
        Its end is that of `straighten`; outputs are the pose on the way.
    """
    v, end, _ = _symbols(zero)
    push = _Push(v, side)
    passed = v[PROGRESS] * push.in_contact if slips else None  # anywhere on its way
    return _tube(push, v, end, [], _flush(push, end), passed)


@cache
def passing(tip: int, zero: frozenset[str] = NONE) -> Bounded:
    """How far a tip is off a line when ``share`` of its travel is done: nothing touches the part.

    Parameters
    ----------
    tip
        1: the upper one, -1: the lower one.

    Returns
    -------
    Bounded
        One output, m, of the base parameters and ``line_turn``, ``line_depth``; the line's own error
        of direction is in its turn.
    """
    v = _named((*PARAMETERS, *AIM, "line_turn", "line_depth"), zero)
    push = _Push(v, tip)
    start, travelled, unit = push.start(tip), v["share"] * push.travel, push.unit
    place = start[0] - travelled * unit[0], start[1] - travelled * unit[1]
    clear = push.clear(tip, v["theta"] - v["line_turn"], v["line_depth"], place)
    return _bounded("passing", v, clear)


def _bounded(name: str, v: Symbols, output: ca.SX) -> Bounded:
    used = {str(symbol) for symbol in ca.symvar(output)}
    names = tuple(key for key in v if key in used)
    x = ca.vertcat(*(v[key] for key in names))
    return bounded(name, names, ca.Function(name, [x], [output]))


def _tube(
    push: _Push,
    v: Symbols,
    end: ca.SX,
    integrals: Sequence[tuple[ca.SX, Quadrature]],
    residual: ca.SX,
    passed: ca.SX | None = None,
) -> Implicit:
    so_far = ca.SX.sym("so_far")
    angle = push.angle + v["share"] * (end - push.angle)
    start, arm = push.start(push.tip), push.arm(angle)
    travelled = push.touch[0] + (so_far if passed is None else passed)
    pose = {
        axis: v[axis] + start[k] - travelled * push.unit[k] + v[f"stray_{axis}"] - arm[k]
        for k, axis in enumerate("xy")
    }
    return _prepared(
        "tube",
        v,
        end,
        [*integrals, (so_far, _needed(push, angle))],
        residual,
        {**pose, "theta": angle + v["turn"] - v["kappa"]},
    )


def _flush(push: _Push, end: ca.SX) -> ca.SX:
    """Zero where both tips touch."""
    v = push.v
    radii = v["radius_upper"], v["radius_lower"]
    return _call("round_tips", "upper_first", end, v["beta"], v["spacing"], *radii)[0]
