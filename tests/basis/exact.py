"""The contact problem at one point in exact rational arithmetic, by a route of its own.

World axes throughout; friction by the tangential force itself, not by the edges of the cone. The
angle is a rational point of the circle.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from random import Random

import casadi as ca
from flint import arb

from meso_robust.basis import Corner, Mode, Part, Tip
from meso_robust.basis.contact import Contact, Quantity
from meso_robust.basis.support import Support
from meso_robust.bounds import Interval

Q = Fraction
Row = list[Fraction]
Point = Mapping[str, Fraction]


def rational_turn(angle: Interval, share: Fraction) -> tuple[Fraction, Fraction] | None:
    """(cos, sin), rational, of an angle that is proved to lie in the interval; None if too narrow."""
    wanted = angle.lo + float(share) * (angle.hi - angle.lo)
    turns = round(wanted / (2 * math.pi))
    half = Q(math.tan(0.5 * (wanted - 2 * math.pi * turns))).limit_denominator(10**9)
    exact = 2 * arb(half.numerator).__truediv__(half.denominator).atan() + 2 * turns * arb.pi()
    if not (exact > angle.lo and exact < angle.hi):
        return None
    return (1 - half**2) / (1 + half**2), 2 * half / (1 + half**2)


def value(quantity: Quantity, at: Point, random: Random) -> Fraction:
    """A quantity at a point of the box, exactly (sums and differences of names)."""
    if isinstance(quantity, str):
        return at[quantity]
    if isinstance(quantity, Interval):
        return Q(quantity.lo) + Q(random.randint(0, 8), 8) * (Q(quantity.hi) - Q(quantity.lo))
    if isinstance(quantity, int | float):
        return Q(quantity)
    names = [one.name() for one in ca.symvar(quantity)]
    slope = ca.jacobian(quantity, ca.vertcat(*ca.symvar(quantity)))
    assert not ca.symvar(slope), "only linear expressions"
    return sum((Q(float(slope[k])) * at[name] for k, name in enumerate(names)), Q(0))


def solve(rows: list[Row], right: Row) -> Row | None:
    """Gauss elimination; None if singular."""
    table = [[*row, b] for row, b in zip(rows, right, strict=True)]
    n = len(table)
    for c in range(n):
        pivot = next((r for r in range(c, n) if table[r][c] != 0), None)
        if pivot is None:
            return None
        table[c], table[pivot] = table[pivot], table[c]
        table[c] = [x / table[c][c] for x in table[c]]
        for r in range(n):
            if r != c and table[r][c] != 0:
                table[r] = [x - table[r][c] * y for x, y in zip(table[r], table[c], strict=True)]
    return [row[-1] for row in table]


class Instant:
    """All contacts at one exact point."""

    def __init__(
        self,
        part: Part,
        contacts: Sequence[Contact],
        support: Support,
        turn: tuple[Fraction, Fraction],
        at: Point,
        random: Random,
    ) -> None:
        c, s = turn
        entries = [value(entry, at, random) for entry in support.film]
        if support.surface is not None:
            share = Q(random.randint(0, 8), 8)
            other = [value(entry, at, random) for entry in support.surface]
            entries = [(1 - share) * e + share * o for e, o in zip(entries, other, strict=True)]
        xx, xy, xt, yy, yt, tt = entries
        body = [[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]]
        turned = [[c, -s, Q(0)], [s, c, Q(0)], [Q(0), Q(0), Q(1)]]
        self.drag = [
            [
                sum((turned[i][k] * body[k][l] * turned[j][l] for k in range(3) for l in range(3)), Q(0))  # noqa: E741
                for j in range(3)
            ]
            for i in range(3)
        ]  # fmt: skip
        velocities = {
            id(contact.mover): [value(v, at, random) for v in contact.mover.velocity]
            for contact in contacts
        }
        self.mover = [id(contact.mover) for contact in contacts]
        self.velocity = [velocities[key] for key in self.mover]
        self.friction = [value(contact.friction, at, random) for contact in contacts]
        self.arm, self.normal = [], []
        for contact in contacts:
            r, n = _place(part, contact, turn, at, random)
            self.arm.append(r)
            self.normal.append(n)

    def rows(self, i: int) -> tuple[Row, Row]:
        """Speed of the part's point along n and t as rows over the twist (world)."""
        (x, y), (nx, ny) = self.arm[i], self.normal[i]
        return [nx, ny, x * ny - y * nx], [-ny, nx, x * nx + y * ny]

    def solutions(self, modes: Sequence[Mode]) -> list[Row] | None:
        """Twist and (normal, tangential) forces: the solution, or both ends of the line of internal
        forces that obeys the cones of a sticking pair; None if there is none."""
        k = len(modes)
        rows, right = [], []
        for i, mode in enumerate(modes):
            n, t = self.rows(i)
            u = self.velocity[i]
            nx, ny = self.normal[i]
            pad = [Q(0)] * (2 * k)
            if mode is not Mode.OPEN:
                rows.append(n + pad)
                right.append(nx * u[0] + ny * u[1])
            else:
                rows.append([Q(0)] * 3 + [Q(int(j == 2 * i)) for j in range(2 * k)])
                right.append(Q(0))
            if mode is Mode.STICK:
                rows.append(t + pad)
                right.append(nx * u[1] - ny * u[0])
            else:
                sign = {Mode.OPEN: 0, Mode.SLIP_PLUS: 1, Mode.SLIP_MINUS: -1}[mode]
                row = [Q(0)] * (3 + 2 * k)
                row[3 + 2 * i + 1], row[3 + 2 * i] = Q(1), -sign * self.friction[i]
                rows.append(row)
                right.append(Q(0))
        for a in range(3):
            row = [*self.drag[a]]
            for i in range(k):
                n, t = self.rows(i)
                row += [-n[a], -t[a]]
            rows.append(row)
            right.append(Q(0))
        return self._solved(modes, rows, right)

    def _solved(self, modes: Sequence[Mode], rows: list[Row], right: Row) -> list[Row] | None:
        stuck = [i for i, mode in enumerate(modes) if mode is Mode.STICK]
        pair = next(
            ((i, j) for i, j in itertools.combinations(stuck, 2) if self.mover[i] == self.mover[j]),
            None,
        )
        if pair is None:
            found = solve(rows, right)
            return None if found is None else [found]
        # the second contact's speed rows follow from "does not turn"; one force stays open
        first_of_second = 2 * pair[1]
        rows[first_of_second] = [Q(0), Q(0), Q(1), *[Q(0)] * (2 * len(modes))]
        right[first_of_second] = Q(0)
        results = []
        for fixed in (Q(0), Q(1)):
            row = [Q(0)] * (3 + 2 * len(modes))
            along = [a - b for a, b in zip(self.arm[pair[0]], self.arm[pair[1]], strict=True)]
            nx, ny = self.normal[pair[1]]
            row[3 + 2 * pair[1]] = along[0] * nx + along[1] * ny
            row[4 + 2 * pair[1]] = -along[0] * ny + along[1] * nx
            rows[first_of_second + 1], right[first_of_second + 1] = row, fixed
            found = solve(rows, right)
            if found is None:
                return None
            results.append(found)
        return results

    def margins(self, modes: Sequence[Mode], solution: Row) -> Row:
        """What must be positive in these modes."""
        out: Row = []
        for i, mode in enumerate(modes):
            n, t = self.rows(i)
            u, (nx, ny) = self.velocity[i], self.normal[i]
            force, side = solution[3 + 2 * i], solution[4 + 2 * i]
            gap = (
                sum((a * b for a, b in zip(n, solution[:3], strict=True)), Q(0))
                - nx * u[0]
                - ny * u[1]
            )
            slide = (
                sum((a * b for a, b in zip(t, solution[:3], strict=True)), Q(0))
                + ny * u[0]
                - nx * u[1]
            )
            mu = self.friction[i]
            out += {
                Mode.OPEN: [gap],
                Mode.STICK: [mu * force - side, mu * force + side],
                Mode.SLIP_PLUS: [force, -slide],
                Mode.SLIP_MINUS: [force, slide],
            }[mode]
        return out

    def holds(self, modes: Sequence[Mode]) -> bool:
        """Whether the modes solve the problem, every margin strictly positive."""
        found = self.solutions(modes)
        if found is None:
            return False
        lines = [self.margins(modes, solution) for solution in found]
        if len(lines) == 1:
            return all(margin > 0 for margin in lines[0])
        low, high = None, None
        for start, end in zip(*lines, strict=True):
            slope = end - start
            if slope == 0:
                if start <= 0:
                    return False
                continue
            root = -start / slope
            if slope > 0:
                low = root if low is None else max(low, root)
            else:
                high = root if high is None else min(high, root)
        return low is None or high is None or low < high


def _place(
    part: Part,
    contact: Contact,
    turn: tuple[Fraction, Fraction],
    at: Point,
    random: Random,
) -> tuple[Row, Row]:
    """Arm and inward normal, world axes; the edge's direction from its exact corners.

    An edge whose length is not rational is stretched: the normal then has another length, which
    scales force and speed of the contact without changing a sign, and the place along it is taken
    with a direction that is right to 1e-30.
    """
    c, s = turn
    corners = [(Q(x), Q(y)) for x, y in part.vertices]
    if isinstance(contact, Corner):
        x, y = corners[contact.corner]
        normal = [value(v, at, random) for v in contact.normal]
        return [c * x - s * y, s * x + c * y], normal
    assert isinstance(contact, Tip)
    first, last = corners[contact.edge], corners[(contact.edge + 1) % len(corners)]
    way = last[0] - first[0], last[1] - first[1]
    length = _root(way[0] ** 2 + way[1] ** 2)
    e = way[0] / length, way[1] / length
    along = value(contact.at, at, random) - (first[0] * e[0] + first[1] * e[1])
    x, y = first[0] + along * e[0], first[1] + along * e[1]
    return [c * x - s * y, s * x + c * y], [-c * e[1] - s * e[0], -s * e[1] + c * e[0]]


def _root(square: Fraction) -> Fraction:
    """Square root, exact where it is rational, else right to 1e-30 of itself."""
    scale = 10**40
    return Q(math.isqrt(square.numerator * scale**2 // square.denominator), scale)
