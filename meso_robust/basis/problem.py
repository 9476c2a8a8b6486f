"""The contact problem as a list of scalar pieces of the parameters, with their gradients.

Balance and contact of one instant, body axes, twist ``v``, contact forces in the coordinates of
their cone, ``f = a (n + mu t) + b (n - mu t)``:

    E v = sum of (n +- mu t, r x (n +- mu t)) times its force        (paper, Section IX-B)
    n . (velocity of the part at r) - n . u = gap speed              (and the same along t)

Every entry of these equations is one piece or a constant; a mode only says which entries stand
where (:mod:`meso_robust.basis.layout`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import casadi as ca
import numpy as np

from meso_robust.basis.contact import Contact, Corner, Part, Quantity, Tip
from meso_robust.basis.support import Entries, Support
from meso_robust.bounds import Bounded, Box, Interval, bounded
from meso_robust.bounds.tape import Tape, compile_tape
from meso_robust.errors import InputError
from meso_robust.types import Floats, Ints

ANGLE = "theta"
"""Name of the part's angle in every box, rad."""
DRAG = 6
"""Pieces of the drag matrix, before those of the contacts."""
PER_CONTACT = 17
NORMAL, TANGENT, PLUS, MINUS, SPEED, CARRY = 0, 3, 6, 9, 12, 14
"""First piece of: J_n (3), J_t (3), the cone's edges n + mu t and n - mu t as wrenches (3 each), the
obstacle's speed along n and t (2), and its twist (3)."""


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """One contact problem over a box of parameters.

    Attributes
    ----------
    names
        Parameters, in the order of the box columns; those that vary come first.
    varying
        How many of them vary.
    lo, hi
        (parameters,) ends of the whole box.
    values, slopes
        Tapes of the pieces, and of their derivatives that are not identically zero.
    first, by
        (pieces + 1,) and (derivatives,): the derivatives of piece p are ``first[p]`` to
        ``first[p + 1]``, by the parameters ``by``.
    movers
        (contacts,) index of the solid of each contact.
    sound
        What must be positive besides: minors of the drag matrix and friction.
    pushing
        Speed of every obstacle into the part.
    inside
        Distances of the tips from the ends of their edges, m.
    """

    names: tuple[str, ...]
    varying: int
    lo: Floats
    hi: Floats
    values: Tape
    slopes: Tape
    first: Ints
    by: Ints
    movers: Ints
    sound: Bounded
    pushing: Bounded
    inside: Bounded

    @property
    def contacts(self) -> int:
        """Number of contacts."""
        return len(self.movers)

    def named(self, lo: Floats, hi: Floats) -> Box:
        """Rows of ends as a box by names; constants are left out."""
        ends = zip(self.names[: self.varying], lo.tolist(), hi.tolist(), strict=False)
        return {name: Interval(a, b) for name, a, b in ends}


def drift(contact: int) -> str:
    """Parameter by which a tip has moved along its edge, m; zero unless a box gives it."""
    return f"drift {contact}"


@dataclass(slots=True)
class _Parameters:
    """Collects the symbols that expressions are made of, and what they stand for."""

    box: Box
    symbols: dict[str, ca.SX] = field(default_factory=dict)
    ranges: dict[str, Interval] = field(default_factory=dict)

    def named(self, name: str) -> ca.SX:
        """The symbol of a name of the box."""
        if name not in self.ranges:
            if name not in self.box:
                raise InputError(
                    f"box: {name!r} is missing; must hold every named parameter; add an interval for it"
                )
            self.symbols[name], self.ranges[name] = ca.SX.sym(name), self.box[name]
        return self.symbols[name]

    def own(self, label: str, range_: Interval) -> ca.SX:
        """A symbol for a range that no other quantity shares."""
        name, count = label, 1
        while name in self.ranges or name in self.box:
            name, count = f"{label} ({count})", count + 1
        self.symbols[name], self.ranges[name] = ca.SX.sym(name), range_
        return self.symbols[name]

    def of(self, quantity: Quantity, label: str) -> ca.SX:
        """Any quantity as an expression."""
        if isinstance(quantity, str):
            return self.named(quantity)
        if isinstance(quantity, Interval):
            return self.own(label, quantity)
        if isinstance(quantity, int | float):
            return self._number(float(quantity), label)
        used = ca.symvar(quantity)
        if not used:
            return quantity
        known = [self.named(one.name()) for one in used]
        return ca.substitute(quantity, ca.vertcat(*used), ca.vertcat(*known))

    def _number(self, value: float, label: str) -> ca.SX:
        if not np.isfinite(value):
            raise InputError(f"{label}: {value}; must be finite; correct the value")
        if (value * 1024.0).is_integer() and abs(value) < 2.0**40:
            return ca.SX(value)
        return self.own(label, Interval.point(value))


def assemble(
    part: Part,
    contacts: Sequence[Contact],
    support: Support,
    box: Box,
    states: Sequence[str] = (),
) -> Problem:
    """Write down the contact problem.

    Parameters
    ----------
    part, contacts, support
        What is pushed, by what, on what.
    box
        An interval for ``theta`` in rad and for every parameter that is named.
    states
        Parameters that count as varying even where their interval is a point. The drift of
        contact i along its edge, m, is the parameter ``drift i``; it is zero unless given.

    Raises
    ------
    InputError
        If the box lacks a name, or a contact names no corner of the part.
    """
    drifts = {drift(i): Interval.point(0.0) for i in range(len(contacts))}
    parameters = _Parameters({**drifts, **box})
    for name in (ANGLE, *states):
        parameters.named(name)
    drag = _drag(parameters, support)
    pieces, asides = [*drag], Asides(_minors(drag), [], [])
    movers = list(dict.fromkeys(contact.mover for contact in contacts))
    velocities = [
        [parameters.of(v, f"mover {m} velocity {axis}") for v, axis in zip(mover.velocity, "xy", strict=True)]
        for m, mover in enumerate(movers)
    ]  # fmt: skip
    for i, contact in enumerate(contacts):
        mu = parameters.of(contact.friction, f"contact {i} friction")
        velocity = velocities[movers.index(contact.mover)]
        own = _contact(parameters, part, contact, i, mu, _to_body(parameters, *velocity))
        pieces += own
        asides.positive.append(mu)
        asides.pushing.append(own[SPEED])
        if isinstance(contact, Tip):
            asides.inside.extend(_room(parameters, part, contact, own[NORMAL + 2]))
    return _compiled(parameters, states, pieces, asides, [movers.index(c.mover) for c in contacts])


class Asides(NamedTuple):
    """Expressions that are checked beside the equations; see `Problem`."""

    positive: list[ca.SX]
    pushing: list[ca.SX]
    inside: list[ca.SX]


def _compiled(
    parameters: _Parameters,
    states: Sequence[str],
    pieces: list[ca.SX],
    asides: Asides,
    movers: list[int],
) -> Problem:
    ranges = parameters.ranges
    varying = [n for n in ranges if n not in states and ranges[n].lo < ranges[n].hi]
    varying = [*states, *varying]
    names = (*varying, *(name for name in ranges if name not in varying))
    x = ca.SX.sym("x", len(names))
    old = ca.vertcat(*(parameters.symbols[name] for name in names))

    def function(name: str, results: list[ca.SX]) -> ca.Function:
        stacked = ca.substitute(ca.vertcat(*results), old, x) if results else ca.SX(0, 1)
        return ca.Function(name, [x], [ca.densify(stacked)])

    values = function("pieces", pieces)
    jacobian = ca.jacobian(values(x), x)[:, : len(varying)]
    rows, columns = (np.array(each, dtype=np.int64) for each in jacobian.sparsity().get_triplet())
    order = np.lexsort((columns, rows))
    slopes = [jacobian[int(rows[q]), int(columns[q])] for q in order]
    return Problem(
        names=names,
        varying=len(varying),
        lo=np.array([ranges[name].lo for name in names]),
        hi=np.array([ranges[name].hi for name in names]),
        values=compile_tape(values),
        slopes=compile_tape(ca.Function("slopes", [x], [ca.densify(ca.vertcat(0, *slopes))])),
        first=np.searchsorted(rows[order], np.arange(len(pieces) + 1)) + 1,
        by=np.concatenate([[0], columns[order]]),
        movers=np.array(movers, dtype=np.int64),
        sound=bounded("sound", names, function("sound", asides.positive)),
        pushing=bounded("pushing", names, function("pushing", asides.pushing)),
        inside=bounded("inside", names, function("inside", [ca.SX(1), *asides.inside])),
    )


def _drag(parameters: _Parameters, support: Support) -> list[ca.SX]:
    def entries(of: Entries, label: str) -> list[ca.SX]:
        return [
            parameters.of(entry, f"{label} {place}")
            for entry, place in zip(of, ("xx", "xy", "xt", "yy", "yt", "tt"), strict=True)
        ]

    drag = entries(support.film, "drag")
    if support.surface is None:
        return drag
    share = parameters.of(support.share, "share of the limit surface")
    dry = entries(support.surface, "surface")
    return [one + share * (two - one) for one, two in zip(drag, dry, strict=True)]


def _minors(e: list[ca.SX]) -> list[ca.SX]:
    """Sylvester's leading minors of the drag matrix."""
    second = e[0] * e[3] - e[1] ** 2
    third = (
        e[0] * (e[3] * e[5] - e[4] ** 2)
        - e[1] * (e[1] * e[5] - e[4] * e[2])
        + e[2] * (e[1] * e[4] - e[3] * e[2])
    )
    return [e[0], second, third]


def _to_body(parameters: _Parameters, x: ca.SX, y: ca.SX) -> tuple[ca.SX, ca.SX]:
    """A vector of the world in body axes."""
    theta = parameters.named(ANGLE)
    c, s = ca.cos(theta), ca.sin(theta)
    return c * x + s * y, c * y - s * x


def _contact(
    parameters: _Parameters,
    part: Part,
    contact: Contact,
    i: int,
    mu: ca.SX,
    carry: tuple[ca.SX, ca.SX],
) -> list[ca.SX]:
    """The pieces of one contact, in the order of the module's constants."""
    if isinstance(contact, Tip):
        along_n, along_t = _on_edge(parameters, part, contact, i)
    else:
        along_n, along_t = _at_corner(parameters, part, contact, i)
    plus = [n + mu * t for n, t in zip(along_n, along_t, strict=True)]
    minus = [n - mu * t for n, t in zip(along_n, along_t, strict=True)]
    speed = [row[0] * carry[0] + row[1] * carry[1] for row in (along_n, along_t)]
    return [*along_n, *along_t, *plus, *minus, *speed, *carry, ca.SX(0)]


Rows = tuple[list[ca.SX], list[ca.SX]]
_Point = tuple[ca.SX, ca.SX]


def _edge(parameters: _Parameters, part: Part, tip: Tip) -> tuple[_Point, _Point, _Point]:
    """First and last corner of an edge and its direction."""
    first = _corner_of(parameters, part, "Tip.edge", tip.edge)
    last = _corner_of(parameters, part, "Tip.edge", (tip.edge + 1) % len(part.vertices))
    way = last[0] - first[0], last[1] - first[1]
    length = ca.sqrt(way[0] ** 2 + way[1] ** 2)
    return first, last, (way[0] / length, way[1] / length)


def _room(parameters: _Parameters, part: Part, tip: Tip, at: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Distances of a tip from the ends of its edge."""
    first, last, (x, y) = _edge(parameters, part, tip)
    return at - (first[0] * x + first[1] * y), last[0] * x + last[1] * y - at


def _on_edge(parameters: _Parameters, part: Part, tip: Tip, i: int) -> Rows:
    """J_n and J_t of a tip: n is the edge's inward normal, t points against the edge."""
    first, _, (x, y) = _edge(parameters, part, tip)
    depth = first[0] * y - first[1] * x
    at = parameters.of(tip.at, f"contact {i} at") + parameters.named(drift(i))
    return [-y, x, at], [-x, -y, -depth]


def _at_corner(parameters: _Parameters, part: Part, contact: Corner, i: int) -> Rows:
    """J_n and J_t of a corner of the part on an edge whose normal is fixed in the world."""
    x, y = _corner_of(parameters, part, "Corner.corner", contact.corner)
    nx, ny = (parameters.of(v, f"contact {i} normal") for v in contact.normal)
    nx, ny = _to_body(parameters, nx, ny)
    return [nx, ny, x * ny - y * nx], [-ny, nx, x * nx + y * ny]


def _corner_of(parameters: _Parameters, part: Part, what: str, index: int) -> _Point:
    """A corner of the part as exact numbers."""
    if not 0 <= index < len(part.vertices):
        raise InputError(
            f"{what}: {index}; must be 0 to {len(part.vertices) - 1}; the part has no more corners"
        )
    x, y = part.vertices[index]
    return parameters.of(x, "corner"), parameters.of(y, "corner")
