"""A part between a moving tip D and a resting tip S on opposite edges.

Axes are those of the travel: one unit of it takes D by ``-(1, bend)``. The pushed edge has direction
``a = (c, s)`` and outward normal ``n = (s, -c)``; the far one is turned from it by an angle with the
tangent ``t``. With ``(h, V)`` from the centre of S to that of D, and the centres at ``p_D a + W_D n``
and ``b a - W_S n`` from the reference point,

    (h, V) = T a + W n,   T = p_D - b,   W = W_D + W_S,   W_S = (depth + radius) sqrt(1 + t^2) + t b,

the last because S touches the far edge. One coordinate is left: the reference point is ahead of S by
``-b`` along ``a``, and of D by ``-p_D = -b - T``; either will do.

The contacts are at ``p a + e_D n`` and ``r a - e_S n`` from the centre of drag. Let the part's centre
of drag move by ``u`` along ``a`` and the part turn by ``omega``. Both contacts hold if

    omega (p - R) = g - t u,   R = r + t e_S,   g = s - bend c

and the velocity along ``n`` is ``omega p - g``. Drag is ``((1 + stretch, shear), (shear, 1 -
stretch))`` for translations, with determinant ``D``, and ``rho`` for turns. A force at D is ``L (k a -
n)``, one at S ``M (l a + n)``: ``l`` is its friction ratio after a turn by the angle of the far edge.
Balance of force and moment (``a x n = -1``) is linear in ``L``, ``M``, ``u``, ``omega``, with the
solution

    L N = g (rho (A' + t B') + D m' R)      A = 1 + stretch + shear k,   A' = 1 + stretch - shear l
    M N = g (rho (A - t B) + D m R)         B = (1 - stretch) k + shear, B' = (1 - stretch) l - shear
    u N = g (rho P/D + R Q)                 m = p + e_D k,               m' = r + e_S l
    omega N = g (H + t Q)                   H = m A' - m' A,  P = A B' + A' B,  Q = m' B + m B'
    N = (p - R) H + t (rho P/D + p Q)

all of them linear in either ratio. The part slips over D at ``u + omega e_D + f`` with ``f = c + bend
s``, over S at ``u - omega e_S``; friction pushes it back. The reference point gets ahead of D's centre
by ``u + f + omega (e_D + radius)``, of S's by ``u - omega (e_S + level)`` with ``level`` how far the
contact of S is from its centre along ``n``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from flint import arb

from meso_robust.checker.dual import Dual
from meso_robust.checker.film import EVEN
from meso_robust.checker.rows import Rows

Real: TypeAlias = Any
"""A :data:`~meso_robust.checker.dual.Number` or :class:`~meso_robust.checker.rows.Rows` in a proof;
a float or an array where barriers are looked for."""


ZERO = arb(0)
D, S = 0, 1
"""The tips."""


@dataclass(frozen=True, slots=True)
class Sides:
    """What is constant: both edges, both tips, the centre of drag."""

    depth: Real
    """Of the pushed edge from the reference point, m."""
    depth_far: Real
    radius: Real
    """Of the tip at the pushed edge, m."""
    radius_far: Real
    tilt: Real = EVEN
    """Tangent of the angle from the pushed to the far edge."""
    drag_a: Real = EVEN
    drag_n: Real = EVEN

    @property
    def parallel(self) -> bool:
        """Whether both edges have exactly one direction."""
        return self.tilt is EVEN

    @property
    def stretched(self) -> Real:
        """Inverse cosine of the angle between the edges."""
        return 1 if self.parallel else root(squared(self.tilt) + 1)


@dataclass(frozen=True, slots=True)
class Drag:
    """Drag over that of a mean translation, at an instant."""

    rho: Real
    stretch: Real = EVEN
    shear: Real = EVEN

    @property
    def even(self) -> bool:
        """Whether the drag of translations is exactly the same in all directions."""
        return self.stretch is EVEN and self.shear is EVEN

    @property
    def determinant(self) -> Real:
        """Of the drag of translations."""
        return 1 if self.even else 1 - squared(self.stretch) - squared(self.shear)

    def along(self, k: Real) -> tuple[Real, Real]:
        """A and B: what a force at D with a friction ratio meets across and along its edge."""
        if self.even:
            return 1, k
        return self.shear * k + self.stretch + 1, (1 - self.stretch) * k + self.shear

    def along_far(self, ratio: Real) -> tuple[Real, Real]:
        """A' and B': likewise of one at S, which presses the other way."""
        if self.even:
            return 1, ratio
        return 1 + self.stretch - self.shear * ratio, (1 - self.stretch) * ratio - self.shear


@dataclass(frozen=True, slots=True)
class Grip:
    """The grip at one instant."""

    c: Real
    s: Real
    T: Real
    f: Real
    g: Real
    p: Real
    r: Real
    apart: Real
    """p - r"""
    share: Real
    """r over that."""
    e_moving: Real
    e_resting: Real
    level_moving: Real
    level_resting: Real
    """How far the contacts are from the centres of the tips along n, towards the part."""
    tilt: Real
    tip: int
    """Ahead of which tip the coordinate is: D or S."""
    D_place: Real
    """Contact at D along its edge, from the foot of the reference point, m."""
    b: Real
    """Centre of S along the pushed edge, and how far out it is on the other side, m."""
    out_resting: Real

    @classmethod
    def at(cls, sides: Sides, h: Real, V: Real, tip: int, ahead: Real, bend: Real = EVEN) -> Grip:
        """The grip with D's centre at ``(h, V)`` from that of S, the part ``ahead`` of a ``tip``."""
        t, near, out = sides.tilt, sides.depth + sides.radius, sides.depth_far + sides.radius_far
        out = out * sides.stretched
        c, s, T = _held(h, V, near + out, t, tip, ahead)
        p, b = (T - ahead, -ahead) if tip == S else (-ahead, -ahead - T)
        W_S, sine = out, EVEN
        if not sides.parallel:
            W_S, sine = W_S + t * b, t / sides.stretched
        level = sides.radius_far / sides.stretched
        r, e_resting = b + sides.radius_far * sine - sides.drag_a, W_S - level + sides.drag_n
        apart = T if sides.parallel else T - sides.radius_far * sine
        f, g = (c, s) if bend is EVEN else (c + s * bend, s - c * bend)
        if sides.parallel:  # the same as below, without what cancels in it
            share = -(ahead + sides.drag_a) / T - (0 if tip == S else 1)
        else:
            r, e_resting = settled(r), settled(e_resting)
            share = r / apart
        return cls(
            c=c,
            s=s,
            T=T,
            f=f,
            g=g,
            p=p - sides.drag_a,
            r=r,
            apart=apart,
            share=share,
            e_moving=sides.depth - sides.drag_n,
            e_resting=e_resting,
            level_moving=sides.radius,
            level_resting=level,
            tilt=t,
            tip=tip,
            D_place=p,
            b=b,
            out_resting=W_S,
        )

    @property
    def S_place(self) -> Real:
        """Contact at S along the far edge, from the foot of the reference point, m."""
        if self.tilt is EVEN:
            return self.b
        stretched = root(squared(self.tilt) + 1)
        return (self.b + self.tilt * self.out_resting) / stretched

    @property
    def R(self) -> Real:
        """Where the far contact counts, its edge being tilted."""
        return self.r if self.tilt is EVEN else self.r + self.tilt * self.e_resting

    def stick(self, tip: int) -> Real:
        """Rate at which the part gets ahead while a tip sticks; above that it slips over it forwards."""
        t, f = self.tilt, self.f
        if tip == S:
            omega = self.g / self.apart
            if self.tip == S:
                return -omega * self.level_resting
            return omega * (self.e_resting + self.e_moving + self.level_moving) + f
        if t is EVEN:
            omega = self.g / self.apart
        else:
            omega = (self.g + t * f) / (self.apart - t * (self.e_resting + self.e_moving))
        if self.tip == D:
            return omega * self.level_moving
        return -omega * (self.e_moving + self.e_resting + self.level_resting) - f

    def ratio_S(self, k: Real) -> Real:
        """Friction ratio at S, in the axes of the pushed edge."""
        return k if self.tilt is EVEN else (k + self.tilt) / (1 - k * self.tilt)

    def alone(self, film: Drag, k: Real) -> Real:
        """Positive where D alone would press, friction ratio k."""
        A = 1 if film.even else film.shear * k + film.stretch + 1
        return film.rho * A + (self.e_moving * k + self.p) * self.p * film.determinant

    def slides_alone(self, film: Drag) -> Real:
        """Positive where the part slips forward over D, which alone presses without friction."""
        A, B = (1, EVEN) if film.even else (film.stretch + 1, film.shear)
        lever = self.p * film.determinant
        turned = self.g * (film.rho * B + lever * self.e_moving)
        return turned + self.f * (film.rho * A + lever * self.p)

    def rate(self, film: Drag, k: Real, k_S: Real) -> Real:
        """Rate at which the part gets ahead at two friction ratios, where the grip cannot close.

        Over ``H``: ``Q/H = B'/A' + (m'/A') P/H``, so that what both forces share does not cancel.
        """
        t, R, ratio = self.tilt, self.R, self.ratio_S(k_S)
        m_S, room = self.e_resting * ratio + self.r, film.determinant
        by_turn, still = -(self.e_resting + self.level_resting), 0
        if self.tip == D:
            by_turn, still = self.e_moving + self.level_moving, self.f
        H, P, B_S = self._span(film, k, ratio)
        if film.even:
            tangent, lever, turning = ratio, m_S, film.rho
        else:
            A_S = 1 + film.stretch - film.shear * ratio
            tangent, lever, turning = B_S / A_S, m_S / A_S, film.rho / room
        uneven = settled(tight(P) / tight(H))  # P is zero where equal ratios cancel
        if t is EVEN:
            more = uneven * (turning + R * lever) + by_turn
            return self.g * (self.share * tangent + more / self.apart) + still
        along = R * tangent + uneven * (turning + R * lever)
        spin = 1 + t * (tangent + lever * uneven)
        whole = self.apart + t * (
            self.p * tangent - self.e_resting + uneven * (turning + self.p * lever)
        )
        return self.g * settled(along + spin * by_turn) / settled(whole) + still

    def _span(self, film: Drag, k: Real, ratio: Real) -> tuple[Real, Real, Real]:
        """H, P and B'."""
        H, both = self.apart + self.e_moving * k - self.e_resting * ratio, k + ratio
        if film.even:
            return H, both, ratio
        (A, B), (A_S, B_S) = film.along(k), film.along_far(ratio)
        m_S = self.e_resting * ratio + self.r
        return H * A_S - m_S * film.shear * both, A * B_S + A_S * B, B_S

    def forces(self, film: Drag, k: Real, k_S: Real) -> Forces:
        """Normal forces at two friction ratios."""
        return Forces(self, film, k, self.ratio_S(k_S))


@dataclass(frozen=True, slots=True, eq=False)
class Forces:
    """Normal forces of a grip at two friction ratios, each over ``divisor``; worked out as they are asked for."""

    grip: Grip
    film: Drag
    k: Real
    """Friction ratio at D."""
    ratio: Real
    """At S, in the axes of the pushed edge."""

    @property
    def moving(self) -> Real:
        """Of D, for drag 1 and one unit of travel per time."""
        grip, film = self.grip, self.film
        A, B = film.along_far(self.ratio)
        m = grip.e_resting * self.ratio + grip.r
        at = A if grip.tilt is EVEN else A + grip.tilt * B
        return grip.g * (film.rho * at + m * grip.R * film.determinant)

    @property
    def resting(self) -> Real:
        """Of S, likewise."""
        grip, film = self.grip, self.film
        A, B = film.along(self.k)
        m = grip.e_moving * self.k + grip.p
        at = A if grip.tilt is EVEN else A - grip.tilt * B
        return grip.g * (film.rho * at + m * grip.R * film.determinant)

    @property
    def slips(self) -> tuple[Real, Real]:
        """How fast the part slips forward over D and over S, times the divisor."""
        grip, film, k, ratio = self.grip, self.film, self.k, self.ratio
        H, P, B_S = grip._span(film, k, ratio)
        m, m_S = grip.e_moving * k + grip.p, grip.e_resting * ratio + grip.r
        Q = m_S * film.along(k)[1] + m * B_S
        u = grip.g * (film.rho * P / film.determinant + grip.R * Q)
        omega = grip.g * (H if grip.tilt is EVEN else H + grip.tilt * Q)
        over_D = u + omega * grip.e_moving + grip.f * self.divisor
        return over_D, u - omega * grip.e_resting

    @property
    def divisor(self) -> Real:
        """Positive where the grip cannot close."""
        grip, film, k, ratio = self.grip, self.film, self.k, self.ratio
        H, P, B_S = grip._span(film, k, ratio)
        if grip.tilt is EVEN:
            return grip.apart * H
        m, m_S = grip.e_moving * k + grip.p, grip.e_resting * ratio + grip.r
        Q = m_S * film.along(k)[1] + m * B_S
        return grip.apart * H + grip.tilt * (
            film.rho * P / film.determinant + grip.p * Q - grip.e_resting * H
        )


def _held(h: Real, V: Real, flat: Real, t: Real, tip: int, ahead: Real) -> tuple[Real, Real, Real]:
    """Direction of the pushed edge, and T.

    Slopes follow from ``d(h, V) = dT a + dW n + (W a - T n) dtheta``; differentiated term by term the
    quotients of :func:`_values` would lose most of what cancels in them.
    """
    if isinstance(h, float | np.ndarray):
        return _values(h, V, flat, t, tip, ahead)
    if isinstance(h, Rows):
        values = _values(h.plain(), _plain(V), _plain(flat), _plain(t), tip, ahead.plain())
        for _ in range(2):  # the second time with narrower values
            ends = (_plain(flat), _plain(t), ahead.plain())
            moved = _moved(values, [_change(one) for one in (h, V, flat, t, ahead)], ends, tip)
            found = [v.moving(own).tight() for v, own in zip(values, moved, strict=True)]
            values = found[0].plain(), found[1].plain(), found[2].plain()
        return found[0], found[1], found[2]
    flat = flat if isinstance(flat, Dual) else Dual(flat)
    c, s, T = _values(h.value, V.value, flat.value, _plain(t), tip, ahead.value)
    ends = (flat.value, _plain(t), ahead.value)
    turn_c, turn_s, grown = _moved(
        (c, s, T), [_change(one) for one in (h, V, flat, t, ahead)], ends, tip
    )
    return Dual(c, turn_c.slopes), Dual(s, turn_s.slopes), Dual(T, grown.slopes)


def _plain(value: Real) -> Real:
    if value is EVEN:
        return EVEN
    return value.plain() if isinstance(value, Rows) else value.value


def _change(value: Real) -> Real:
    """The slopes alone."""
    if value is EVEN:
        return EVEN
    return value.change() if isinstance(value, Rows) else Dual(ZERO, value.slopes)


def _moved(
    values: tuple[Real, Real, Real], changes: list[Real], ends: tuple[Real, ...], tip: int
) -> tuple[Real, Real, Real]:
    """By how much the direction and T change when h, V, W's constant part, t and ``ahead`` do."""
    (c, s, T), (x, y, across, leaned, moved), (W, t, ahead) = values, changes, ends
    along, across = x * c + y * s, across - x * s + y * c
    if t is EVEN:
        turned = settled(across / T)
        grown = along - turned * W
    else:
        b = -ahead if tip == S else -ahead - T
        W = W + t * b
        across = across + leaned * b - moved * t
        # b changes with T as well if the part is ahead of D
        share = 0 if tip == S else t
        across = settled(across)
        grown = settled((along - across * (W / T)) / (1 - share * W / T))
        turned = (across - grown * share) / T
    return turned * -s, turned * c, grown


def _values(
    h: Real, V: Real, flat: Real, t: Real, tip: int, ahead: Real
) -> tuple[Real, Real, Real]:
    square = squared(h) + squared(V)
    if t is EVEN:
        W = flat
        T = root(square - squared(W))
    elif tip == S:
        W = flat - t * ahead
        T = root(square - squared(W))
    else:
        y, more = flat - t * ahead, squared(t) + 1
        T = (t * y + root(square * more - squared(y))) / more
        W = y - t * T
    if not isinstance(T, arb):
        return (T * h - W * V) / square, (T * V + W * h) / square, T
    s, c = (arb.atan2(V, h) + (W / root(square)).asin()).sin_cos()
    return c, s, T


def tight(value: Real) -> Real:
    """The same, narrowed where a kind of number can be."""
    return value.tight() if isinstance(value, Rows) else value


def settled(value: Real) -> Real:
    """The same, its slopes worked out where a kind of number puts that off."""
    return value.settled() if isinstance(value, Rows) else value


def squared(value: Real) -> Real:
    """Its square, never negative."""
    return value.squared() if hasattr(value, "squared") else value * value


def root(value: Real) -> Real:
    """Its square root."""
    return value.sqrt() if hasattr(value, "sqrt") else np.sqrt(value)
