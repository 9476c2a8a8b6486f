"""A round tip that sticks rolls along its edge: the turn that belongs to a travel, enclosed.

The tip does not turn, so while the part turns by ``x`` the contact moves by ``-r x`` along the edge,
and with ``film.py`` the travel of a turn from the angle ``A`` is the quadrature

    integral of F/(p s - q c) over x,  (c, s) the direction of A + x,  d2 = d2_first - r x.

At a point it is a sum of Taylor polynomials with their remainders. Over a box the mean value theorem
gives it, and the turn as its inverse: slopes are sums over a few arcs of what the integrand's slopes
can be there. ``stretch``, ``shear``, ``bend`` and ``centre_a``, ``centre_n`` (which take the contact from
``d2``, ``d1`` to where the centre of drag is) may change at every instant: a slope along one of
them is the whole turn times *all* that the integrand's slope can be on the way, so that where it has
a sign, each instant has it, and where it has none its largest value bounds the effect of any history.
``rho`` may change as well, but the integrand grows with it at every instant: every history of it
turns the part as some constant does.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from flint import arb, arb_series

from meso_robust.checker.dual import Dual, Number

HISTORIES = frozenset({"stretch", "shear", "bend", "centre_a", "centre_n"})
"""What may change at every instant on the way: no box may be cut along it."""
ARCS = 8
"""On each the slopes of the integrand are bounded."""
LONGEST = 0.13
"""rad: of the arcs of a quadrature; with eight terms the remainder is far below a nanometre, but not where
the part hardly begins to turn."""
CLOSE, HALVINGS = 1e-13, 8
"""m: an arc whose remainder is not below is halved, so often at most."""
TERMS = 8
"""Terms of a Taylor polynomial; even, so that the power in the remainder has one sign."""
STEPS = 24
"""Of the floating-point guess, on which no proof rests."""
DOUBLINGS, GROWTH = 8, arb("1.2")
"""How often rough bounds are enlarged, and by how much."""
LEAST = arb(1e-9)
"""rad: first room around a guessed turn."""
NAN = arb("nan")
State = tuple[arb, ...]
"""Angle, d1, d2 (both from where the centre of drag is fixed), radius, rho, stretch, shear, bend, centre_a
and centre_n."""
SLOPES = 10
CHANGING = (5, 6, 7, 8, 9)
"""Places of the histories in a state."""


def travel_of(state: Sequence[Number], turned: Dual) -> Dual:
    """Travel until the part has turned by ``turned``."""
    if not turned.slopes and not any(_varies(one) for one in state):
        return Dual(_quadrature(_values(state), turned.value))
    values, end = _values(state), turned.value
    slopes, last = _slopes(values, end)
    value = _quadrature(_middles(values), end.mid()) + last * (end - end.mid())
    value += _reach(slopes, values)
    return _joined(value, [*slopes, last], [*state, turned])


def turn_of(state: Sequence[Number], travel: Dual, side: int) -> Dual:
    """Turn after ``travel``, to ``side``; not finite where the part may stop turning on the way."""
    values = _values(state)
    if not travel.slopes and not any(_varies(one) for one in state):
        return Dual(_turn_at(values, travel.value, side))
    room = _rough(values, travel.value, side)
    if not room.is_finite():
        return _joined(NAN, [NAN] * (SLOPES + 1), [*state, travel])
    # narrowed by what these slopes say of the ends, then bounded again for good
    ends = _turns(values, travel.value, side, room)
    slopes, last = _slopes(values, ends)
    own = [-_times(slope, 1 / last) for slope in slopes]
    return _joined(ends, [*own, 1 / last], [*state, travel])


def _turns(values: State, travel: arb, side: int, room: arb) -> arb:
    """Bounds of the turn over a box, ``room`` being some: those at its two extreme corners.

    What the turn is not proved to grow or fall with stays a range; the mean value theorem bounds it.
    """
    slopes, _ = _slopes(values, room)
    grows = [slope * -side for slope in slopes]  # with which the turn grows, as a signed number
    found = []
    for end in (-1, 1):
        corner = tuple(
            _end(value, end if slope >= 0 else -end) if slope >= 0 or slope <= 0 else value
            for value, slope in zip(values, grows, strict=True)
        )
        way = _end(travel, end * side)
        found.append(_turn_over(corner, way, side, room))
    low, high = found[0].lower(), found[1].upper()
    return _common(room, low.union(high)) if low <= high else room


def _turn_over(values: State, travel: arb, side: int, room: arb) -> arb:
    """Bounds of the turn over a box, by its slopes."""
    if all(value.rad() < LEAST for value in (*values, travel)):
        return _turn_at(values, travel, side)
    slopes, last = _slopes(values, room)
    change = travel - travel.mid() - _reach(slopes, values)
    middle = _turn_at(_middles(values), travel.mid(), side)
    return _common(room, middle + change / last)


def _end(value: arb, which: int) -> arb:
    return value.upper() if which > 0 else value.lower()


def _times(one: arb, other: arb) -> arb:
    """Product of two ranges from those of their ends: of wide balls it keeps the sign."""
    ends = [p * q for p in (one.lower(), one.upper()) for q in (other.lower(), other.upper())]
    if not all(end.is_finite() for end in ends):
        return NAN
    low, high = ends[0], ends[0]
    for end in ends[1:]:
        low, high = low.min(end), high.max(end)
    return low.union(high)


def _rough(values: State, travel: arb, side: int) -> arb:
    """Some bounds of the turn: all rates up to them take no motion out of them."""
    # not zero where nothing is travelled: what is found must lie inside
    most = _steepness(values, arb(0)) * abs(travel).upper() + LEAST
    for _ in range(DOUBLINGS):
        turned = arb(0).union(most * side) if travel > 0 else most * arb(0, 1)
        rate = 1 / _integrand(*_at(values, turned))
        found = travel * rate
        if not found.is_finite():
            break
        if abs(found).upper() < most and rate * side > 0:
            return found
        most = abs(found).upper() * GROWTH
    return NAN


def _common(one: arb, other: arb) -> arb:
    """What lies in both of two balls that have something in common."""
    if not other.is_finite():
        return one
    return one.lower().max(other.lower()).union(one.upper().min(other.upper()))


def _turn_at(values: State, travel: arb, side: int) -> arb:
    """The turn at a point of a box."""
    guess = _guess(values, travel, side)
    short = _quadrature(values, guess) - travel
    room = guess + (abs(short).upper() * 4 + LEAST) * arb(0, 1) * _steepness(values, guess)
    found = guess - short / _integrand(*_at(values, room))
    return found if found.is_finite() and room.contains_interior(found) else NAN


def _steepness(values: State, turned: arb) -> arb:
    slope = abs(1 / _integrand(*_at(values, turned))).upper()
    return (slope + 1) if slope.is_finite() else arb(1)


def _varies(value: Number) -> bool:
    return isinstance(value, Dual) and bool(value.slopes)


def _values(state: Sequence[Number]) -> State:
    return tuple(value.value if isinstance(value, Dual) else arb(value) for value in state)


def _middles(values: State) -> State:
    return tuple(value.mid() for value in values)


def _reach(slopes: Sequence[arb], values: State) -> arb:
    """By how much the travel can differ from that at the middle of the box."""
    found = arb(0)
    for slope, value in zip(slopes, values, strict=True):
        found += slope * (value - value.mid())
    return found


def _joined(value: arb, slopes: Sequence[arb], of: Sequence[Number]) -> Dual:
    """A value and its slopes, from those along numbers that depend on the variables themselves."""
    found: dict[str, arb] = {}
    for slope, one in zip(slopes, of, strict=True):
        if isinstance(one, Dual):
            for name, own in one.slopes.items():
                found[name] = found[name] + slope * own if name in found else slope * own
    return Dual(value, found)


def _at(values: State, turned: Any) -> tuple[Any, ...]:
    """Arguments of the integrand when the part has turned so far."""
    angle, d1, d2, radius, *film, centre_a, centre_n = values
    s, c = (turned + angle).sin_cos()
    return s, c, d1 - centre_n, d2 - centre_a - turned * radius, *film


def _integrand(
    s: Any, c: Any, d1: Any, d2: Any, rho: Any, stretch: Any, shear: Any, bend: Any
) -> Any:
    p, q = d2 * (1 - stretch) - d1 * shear, d2 * (-shear) + d1 * (1 + stretch)
    return (p * d2 + q * d1 + rho) / (p * (s + c * bend) - q * (c - s * bend))


def _quadrature(values: State, turned: arb) -> arb:
    """Travel of a turn at a point of a box."""
    if not turned.is_finite():
        return NAN
    pieces = max(1, math.ceil(abs(float(turned)) / LONGEST))
    half = turned / (2 * pieces)
    return sum((_arc(values, half * (2 * k + 1), half, HALVINGS) for k in range(pieces)), arb(0))


def _arc(values: State, middle: arb, half: arb, halvings: int) -> arb:
    """Travel of a turn from ``middle - half`` to ``middle + half``."""
    around = _taylor(values, (middle - half).union(middle + half))
    square, power = half * half, half * 2
    remainder = NAN
    if around is not None:
        remainder = around[TERMS] * half * 2 * square ** (TERMS // 2) / (TERMS + 1)
    if halvings and not remainder.rad() < CLOSE:
        ends = (_arc(values, middle + half / 2 * k, half / 2, halvings - 1) for k in (-1, 1))
        return sum(ends, arb(0))
    near, found = _taylor(values, middle), remainder
    if near is None:
        return NAN
    for n in range(0, TERMS, 2):
        found += near[n] * power / (n + 1)
        power *= square
    return found


def _taylor(values: State, at: arb) -> arb_series | None:
    """The integrand as a power series about a point; about a ball, the one about each of its points.

    None where it may have a pole.
    """
    try:
        found = _integrand(*_at(values, arb_series([at, arb(1)], prec=TERMS + 1)))
    except ValueError:  # python-flint's word for a divisor that may be zero
        return None
    if not isinstance(found, arb_series) or found.prec <= TERMS:
        raise ArithmeticError(f"a power series of fewer than {TERMS + 1} terms")
    return found


def _slopes(values: State, turned: arb) -> tuple[list[arb], arb]:
    """Slopes of the travel along the state, and along the turn at its end."""
    found: list[arb] = [arb(0)] * SLOPES
    arc = turned / ARCS
    for k in range(ARCS):
        now = (arc * k).union(arc * (k + 1))
        for place, slope in enumerate(_slopes_at(values, now)):
            if place not in CHANGING:
                found[place] += slope / ARCS
            else:
                found[place] = slope if k == 0 else found[place].union(slope)
    return [_times(turned, slope) for slope in found], _integrand(*_at(values, turned))


def _slopes_at(values: State, turned: arb) -> tuple[arb, ...]:
    """Slopes of the integrand along the state, the turn so far being given."""
    s, c, d1, d2, rho, stretch, shear, bend = _at(values, turned)
    more, less = 1 + stretch, 1 - stretch
    p, q = d2 * less - d1 * shear, d1 * more - d2 * shear
    S, C = s + c * bend, c - s * bend
    turn = p * S - q * C
    rate = (p * d2 + q * d1 + rho) / turn
    along = (p * 2 - rate * (less * S + shear * C)) / turn  # along d2
    out = (q * 2 + rate * (shear * S + more * C)) / turn  # along d1
    return (
        -rate * (p * C + q * S) / turn,
        out,
        along,
        -turned * along,
        1 / turn,
        (d1 * d1 - d2 * d2 + rate * (d2 * S + d1 * C)) / turn,
        (d1 * d2 * -2 + rate * (d1 * S - d2 * C)) / turn,
        -rate * (p * c + q * s) / turn,
        -along,
        -out,
    )


def _guess(values: State, travel: arb, side: int) -> arb:
    """The turn after a travel, in floating point."""
    angle, d1, d2, radius, *film, centre_a, centre_n = (float(value.mid()) for value in values)
    d1, d2 = d1 - centre_n, d2 - centre_a
    step, turned = float(travel.mid()) / STEPS, 0.0

    def rate(turned: float) -> float:
        s, c = math.sin(angle + turned), math.cos(angle + turned)
        try:
            return 1.0 / float(_integrand(s, c, d1, d2 - radius * turned, *film))
        except ZeroDivisionError:
            return 0.0

    for _ in range(STEPS):
        one = rate(turned)
        two = rate(turned + step * one / 2)
        three = rate(turned + step * two / 2)
        four = rate(turned + step * three)
        turned += step * (one + 2 * two + 2 * three + four) / 6
    return arb(turned) if math.isfinite(turned) else NAN
