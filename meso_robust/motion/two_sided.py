"""Enclosure of the rotation between a moving and a passive tip, although it need not be unique.

While both tips touch one freedom is left, the slide ``q`` of the reference point ahead of the passive
tip's contact (derivations/opposite_edges.py). In every contact mode dq/d(travel) is an explicit function
of the distance ``h`` of the tips along the push, of ``q``, of constants ``p`` (separation, depths, radii,
...) and of what may change at every instant (friction, drag, wander). The tube is

    q = c(h) + sum g_i(h) (p_i - middle of p_i) + s,   lower(h) <= s <= upper(h)

with ``c`` and ``g`` piecewise linear. Any ``c`` and ``g`` are sound; those of the linearised motion keep
what is left, ``s``, narrow, although every constant is anywhere in its range. Let f+ (f-) be the supremum
(infimum) of ds/d(travel) over all modes and parameters that are possible at (h, s). A line that rises at
least as fast as f+ everywhere in a strip around itself cannot be crossed from below: if it were, the
motion would be above it inside the strip after its last point on the line, where it rises no faster.
The tube is bounded by such lines, one pair a step in h.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cache
from typing import NamedTuple

import casadi as ca
import numpy as np
from numba import njit

from meso_robust.bounds import Bounded, Interval, bounded
from meso_robust.bounds.arithmetic import add, down, mul, up
from meso_robust.bounds.bulk import Program, program
from meso_robust.bounds.tape import OUTPUT, run, run_block
from meso_robust.conditions.formula import formula
from meso_robust.kernels import fingerprint
from meso_robust.types import Floats

STEPS = 210  # per width of the part: about 4 um for the paper's part
CHECKED = 4  # steps whose forces and edges are checked together: half as long, and hardly looser
MODULE = "opposite_edges"
CONSTANT = ("room", "d_D", "d_S", "r_D", "r_S", "kappa", "drag_a", "drag_n")
INSTANT = ("rho", "stretch", "shear", "bend", "sway", "mu_D", "mu_S")
H, Q = 0, 1  # the first two inputs of every function here
DOWN_DOWN, DOWN_UP, UP_DOWN, UP_UP, D_STICKS, S_STICKS = range(6)
"""Outputs of the rates: signs of both friction ratios, and the rate at which a tip sticks; then, at each
pair of signs, how far the rate is above that of D sticking, of S sticking, and the opening."""
RATES, OVER_D, OVER_S, OPENING, ALL = 6, 6, 10, 14, 18
SIGNS = ((-1, -1), (-1, 1), (1, -1), (1, 1))
ZERO = Interval.point(0.0)
ANYWHERE = Interval(-np.inf, np.inf)


class TubeStatus(IntEnum):
    """How far an enclosure came."""

    COMPLETE = 0
    UNBOUNDED = 1
    """A rate could not be bounded: the grasp may close (jam)."""
    CONTACT_LOST = 2
    """A tip may be left: the other one alone might push."""
    OFF_EDGE = 3
    """A tip may pass the end of its edge."""
    NO_MODE = 4
    """No contact mode has a solution somewhere: a jam."""

    @property
    def message(self) -> str:
        """What it means."""
        return {
            TubeStatus.COMPLETE: "both tips touch all the way and the slide stays in the tube",
            TubeStatus.UNBOUNDED: "the slide could not be bounded: the two tips may close on the part",
            TubeStatus.CONTACT_LOST: "the part may leave the passive tip",
            TubeStatus.OFF_EDGE: "a tip may pass the end of its edge",
            TubeStatus.NO_MODE: "no contact mode has a solution: a jam",
        }[self]


@dataclass(frozen=True, slots=True, kw_only=True)
class Grip:
    """What is known of a part between two tips; lengths in m, axes turned by the travel's direction."""

    room: Interval
    """Distance of the tips' centres across the travel, less both radii and depths, without wander.

    What decides how far the tips are from closing on the part; the parts of it hardly matter then.
    """
    d_D: Interval
    """Distance of the moving tip's edge from the reference point."""
    d_S: Interval
    """The same of the passive tip's edge."""
    ends_D: tuple[Interval, Interval]
    """First and last point of the moving tip's edge, from the foot of the reference point."""
    ends_S: tuple[Interval, Interval]
    """The same of the passive tip's edge, in the same direction."""
    rho: Interval
    """e_theta/e_x, m^2."""
    mu: Interval
    """At either tip."""
    common: bool = True
    """Whether both tips have the same friction coefficient at every instant."""
    r_D: Interval = ZERO
    r_S: Interval = ZERO
    kappa: Interval = ZERO
    """Direction of the passive tip's edge less that of the moving tip's, rad."""
    drag_a: Interval = ZERO
    """Centre of drag along the moving tip's edge, from the reference point."""
    drag_n: Interval = ZERO
    """Centre of drag towards the moving tip's edge."""
    stretch: Interval = ZERO
    shear: Interval = ZERO
    bend: Interval = ZERO
    """dV/d(travel) by wander."""
    sway: Interval = ZERO
    """Deviation of V by wander."""

    def box(self) -> dict[str, Interval]:
        """The ranges by the names of the formulas."""
        names = (*CONSTANT, *INSTANT[:-2])
        friction = {"mu_D": self.mu} if self.common else {"mu_D": self.mu, "mu_S": self.mu}
        return {**{name: getattr(self, name) for name in names}, **friction}


@dataclass(frozen=True, slots=True, kw_only=True)
class Start:
    """The slide where both tips touch first, in terms of h, the constants and a label.

    ``q = value + rate (h.hi - h) + sum spread_i (p_i - middle) + rest``.
    """

    h: Interval
    """m"""
    labels: Mapping[str, Interval]
    """Further constants that tell runs apart, m, such as where the part is before the move."""
    value: float
    rate: float
    spread: Mapping[str, float]
    """By constant or label."""
    rest: Interval

    @property
    def line(self) -> Line:
        """The same, for every h."""
        return Line(
            first=self.h.hi,
            value=self.value,
            rate=self.rate,
            spread=self.spread,
            drift={},
            rest=self.rest,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """``q = value + rate (first - h) + sum (spread_i + drift_i (first - h)) (p_i - middle_i) + rest``."""

    first: float
    value: float
    rate: float
    spread: Mapping[str, float]
    drift: Mapping[str, float]
    rest: Interval


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cell:
    """Bounds of the slide at every knot, for a part of the range of room."""

    h: Floats
    """(K+1,) x of the moving tip minus x of the passive one, decreasing, m."""
    centre: Floats
    """(K+1,) c, m."""
    spread: Floats
    """(K+1, P) g, by parameter."""
    lower: Floats
    """(K+1,) lower bound of s at the knot, m."""
    upper: Floats
    """(K+1,) upper bound, m."""
    parameters: Mapping[str, Interval]
    """The constants whose effect ``spread`` holds, and the labels."""
    status: TubeStatus
    margins: Floats
    """(4,) as of `SlideTube`."""

    def line(self, first: int, last: int) -> Line:
        """One affine enclosure of the slide between two knots."""
        used = slice(first, last + 1)
        reach = float(self.h[first] - self.h[last])
        rate = float(self.centre[last] - self.centre[first]) / reach
        drift = (self.spread[last] - self.spread[first]) / reach
        off_lo, off_hi = _offsets(
            self.h[used],
            self.centre[used],
            self.spread[used],
            rate,
            drift,
            *deviations(self.parameters),
        )
        return Line(
            first=float(self.h[first]),
            value=float(self.centre[first]),
            rate=rate,
            spread=dict(zip(self.parameters, self.spread[first].tolist(), strict=True)),
            drift=dict(zip(self.parameters, drift.tolist(), strict=True)),
            rest=Interval(
                float(np.nextafter(self.lower[used] + off_lo, -np.inf).min()),
                float(np.nextafter(self.upper[used] + off_hi, np.inf).max()),
            ),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SlideTube:
    """All slides from the touch of both tips to the end of the travel."""

    cells: tuple[Cell, ...]
    """By rising room; all with the same knots."""
    parameters: Mapping[str, Interval]
    """The constants whose effect is kept, over all cells, and the labels."""

    @property
    def h(self) -> Floats:
        """(K+1,) the knots, decreasing, m."""
        return self.cells[0].h

    @property
    def status(self) -> TubeStatus:
        """How far the cell came that came least far."""
        return max(cell.status for cell in self.cells)

    @property
    def force_margin(self) -> float:
        """Smallest proved lower bound of the force at the passive tip, over e_x and travel rate."""
        return min(float(cell.margins[0]) for cell in self.cells)

    @property
    def edge_margin(self) -> float:
        """Smallest proved distance of a contact from the end of its edge, m."""
        return min(float(cell.margins[1]) for cell in self.cells)

    @property
    def grip_margin(self) -> float:
        """Smallest proved grip, m."""
        return min(float(cell.margins[2]) for cell in self.cells)

    @property
    def largest_force(self) -> float:
        """Proved upper bound of the normal force at either tip, over e_x and travel rate."""
        return max(float(cell.margins[3]) for cell in self.cells)

    def line(self, h: Interval) -> Line:
        """One affine enclosure of the slide wherever h is in a range.

        Parameters
        ----------
        h
            m; within the tube.

        Returns
        -------
        Line
            Between the knots that hold the range; its middles are those of `parameters`.
        """
        first = max(int(np.searchsorted(-self.h, -h.hi, side="right")) - 1, 0)
        last = min(int(np.searchsorted(-self.h, -h.lo, side="left")), self.h.size - 1)
        last = max(last, first + 1)
        lines = [cell.line(first, last) for cell in self.cells]
        if len(lines) == 1:
            return lines[0]
        return _joined(lines, self, Interval(0.0, float(up(self.h[first] - self.h[last]))))


def _joined(lines: list[Line], tube: SlideTube, gone: Interval) -> Line:
    """One line for all cells: whatever slopes it has, what is left of each cell is in its rest."""
    middles = [cell.parameters["room"].mid for cell in tube.cells]
    wide = middles[-1] - middles[0]

    def mean(values: list[float]) -> float:
        return sum(values) / len(values)

    spread, drift = (
        {name: mean([getattr(line, kind)[name] for line in lines]) for name in tube.parameters}
        for kind in ("spread", "drift")
    )
    # along the room by what the cells differ in
    spread["room"] = (lines[-1].value - lines[0].value) / wide
    drift["room"] = (lines[-1].rate - lines[0].rate) / wide
    whole = Line(
        first=lines[0].first,
        value=mean([line.value for line in lines]),
        rate=mean([line.rate for line in lines]),
        spread=spread,
        drift=drift,
        rest=ZERO,
    )
    rests = [
        _less(line, whole, cell, tube, gone) for line, cell in zip(lines, tube.cells, strict=True)
    ]
    return replace(
        whole, rest=Interval(min(rest.lo for rest in rests), max(rest.hi for rest in rests))
    )


def _less(line: Line, whole: Line, cell: Cell, tube: SlideTube, gone: Interval) -> Interval:
    """What is left of a cell's slide beside another line."""
    point = Interval.point
    left = line.rest + point(line.value) - point(whole.value)
    left = left + (point(line.rate) - point(whole.rate)) * gone
    for name, side in cell.parameters.items():
        middle, middle_of_all = point(side.mid), point(tube.parameters[name].mid)
        steeper = point(line.spread[name]) - point(whole.spread[name])
        steeper = steeper + (point(line.drift[name]) - point(whole.drift[name])) * gone
        left = left + steeper * (side - middle)
        if middle != middle_of_all:
            slope = point(whole.spread[name]) + point(whole.drift[name]) * gone
            left = left - slope * (middle - middle_of_all)
    return left


def deviations(parameters: Mapping[str, Interval]) -> tuple[Floats, Floats]:
    """Ends of all parameters less their middles, rounded outward."""
    off = [side - Interval.point(side.mid) for side in parameters.values()]
    return np.array([side.lo for side in off]), np.array([side.hi for side in off])


class _Programs(NamedTuple):
    """The functions that the kernels evaluate."""

    rates: Program
    state: Program


class _Formulas(NamedTuple):
    """They and the names of their inputs."""

    inputs: tuple[str, ...]
    rates: Bounded
    state: Bounded


@cache
def _formulas(exact: frozenset[str], common: bool) -> _Formulas:
    """Slide rates, and what must hold of a state, without the inputs that are exactly zero.

    The state's outputs: contacts of D and S along their edges, the grips, the forces.
    """
    names = ("h", "q", *CONSTANT, *INSTANT)
    free = tuple(name for name in names if name not in exact and not (common and name == "mu_S"))
    x = ca.SX.sym("x", len(free))
    at = dict.fromkeys(names, ca.SX(0.0)) | dict(zip(free, ca.vertsplit(x), strict=True))
    if common:
        at["mu_S"] = at["mu_D"]
    separation = at["room"] + at["d_D"] + at["d_S"] + at["r_D"] + at["r_S"] + at["sway"]

    def value(name: str, *keys: str) -> tuple[ca.SX, ...]:
        return formula(MODULE, name)(ca, *(at[key] for key in keys))

    (at["W"],) = value("width", "q", "d_D", "d_S", "r_D", "r_S", "kappa")
    (at["T"],) = formula(MODULE, "apart")(ca, at["h"], separation, at["W"])
    at["c"], at["s"] = formula(MODULE, "direction")(ca, at["h"], separation, at["W"], at["T"])
    (place,) = value("active_offset", "T", "q", "d_S", "r_S", "kappa")
    held = ("c", "s", "T", "q", "d_D", "d_S", "r_S", "kappa", "drag_a", "drag_n")
    held += ("rho", "stretch", "shear", "bend", "mu_D", "mu_S")
    sticking = value("stick_rates", "c", "s", "T", "q", "d_D", "d_S", "r_D", "r_S", "kappa", "bend")
    corners = []
    for of_D, of_S in SIGNS:
        at["tau_D"], at["tau_S"] = of_D * at["mu_D"], of_S * at["mu_S"]
        # where both have one coefficient and opposite signs their sum is zero, not an interval
        at["total"] = ca.SX(0.0) if common and of_D != of_S else at["tau_D"] + at["tau_S"]
        corners.append(value("corner", *held[:6], "r_D", *held[6:-2], "tau_D", "tau_S", "total"))
    rates = (*(corner[0] for corner in corners), *sticking)
    rates += tuple(corner[k] for k in (1, 2, 3) for corner in corners)
    state = (place, -at["q"], *value("corner_grips", *held), *value("corner_forces", *held))

    def prepared(name: str, results: tuple[ca.SX, ...]) -> Bounded:
        both = ca.cse(ca.densify(ca.vertcat(*results)))
        return bounded(f"{MODULE}.{name}", free, ca.Function(name, [x], [both]))

    return _Formulas(free, prepared("rates", rates), prepared("state", state))


class _Frame(NamedTuple):
    """One step of the tube, and what its parameters range over."""

    h_first: float
    h_last: float
    centre: float
    rate: float
    spread: Floats
    drift: Floats
    dev_lo: Floats
    dev_hi: Floats


@njit
def _hull(frame: _Frame, s_lo: float, s_hi: float) -> tuple[float, float]:
    """All slides of a step whose s is in a range."""
    dh_lo, dh_hi = 0.0, up(frame.h_first - frame.h_last)
    way_lo, way_hi = mul(frame.rate, frame.rate, dh_lo, dh_hi)
    lo, hi = add(way_lo, way_hi, frame.centre, frame.centre)
    lo, hi = add(lo, hi, s_lo, s_hi)
    for i in range(frame.spread.size):
        g_lo, g_hi = _slope(frame, i, dh_lo, dh_hi)
        off_lo, off_hi = mul(g_lo, g_hi, frame.dev_lo[i], frame.dev_hi[i])
        lo, hi = add(lo, hi, off_lo, off_hi)
    return lo, hi


@njit
def _slope(frame: _Frame, i: int, gone_lo: float, gone_hi: float) -> tuple[float, float]:
    """g_i after ``gone`` of a step."""
    more_lo, more_hi = mul(frame.drift[i], frame.drift[i], gone_lo, gone_hi)
    return add(frame.spread[i], frame.spread[i], more_lo, more_hi)


@njit
def _along(frame: _Frame, which: Floats) -> tuple[float, float]:
    """c' + g' (p - middle), ``which`` (P, 2) the deviations."""
    lo = hi = frame.rate
    for i in range(frame.spread.size):
        off_lo, off_hi = mul(frame.drift[i], frame.drift[i], which[i, 0], which[i, 1])
        lo, hi = add(lo, hi, off_lo, off_hi)
    return lo, hi


@njit
def _pick(d_lo: float, d_hi: float, a: float, b: float, side: int) -> tuple[float, float, float]:
    """Where a mean-value form is centred in one variable, and what the rest of its range can add.

    At the end where the bound is attained, if the derivative has one sign.
    """
    if (side == 1 and d_lo >= 0.0) or (side == 0 and d_hi <= 0.0):
        return b, 0.0, 0.0
    if (side == 1 and d_hi <= 0.0) or (side == 0 and d_lo >= 0.0):
        return a, 0.0, 0.0
    middle = 0.5 * (a + b)
    p_lo, p_hi = mul(d_lo, d_hi, down(a - middle), up(b - middle))
    return middle, p_lo, p_hi


@njit
def _bound(
    of: Program,
    frame: _Frame,
    lo: Floats,
    hi: Floats,
    constants: int,
    s_lo: float,
    s_hi: float,
    shifted: int,
    lower: Floats,
    upper: Floats,
) -> None:
    """Bound all outputs over a step, wherever the constants and what changes are; a mean-value form.

    The slide depends on h and on the constants, so the derivatives are total ones. The first ``shifted``
    outputs are taken less c' + g' (p - middle), which makes rates of q rates of s.
    """
    inputs, outputs, params = lo.size, lower.size, frame.spread.size
    box_lo, box_hi = lo.copy(), hi.copy()
    box_lo[H], box_hi[H] = frame.h_last, frame.h_first
    box_lo[Q], box_hi[Q] = _hull(frame, s_lo, s_hi)
    run(of.slope_code, of.slope_constant, box_lo, box_hi, of.work, of.slope)
    gone_hi = up(frame.h_first - frame.h_last)
    dev = np.empty((params, 2))
    dev[:, 0], dev[:, 1] = frame.dev_lo, frame.dev_hi
    all_lo, all_hi = _along(frame, dev)
    spread = np.zeros((outputs, 2))
    shift = np.zeros((outputs, 2))
    for i in range(outputs):
        lower[i], upper[i] = of.slope[i, 0], of.slope[i, 1]
        if i < shifted:
            lower[i], upper[i] = down(lower[i] - all_hi), up(upper[i] - all_lo)
        grad = of.slope[outputs + i * inputs : outputs + (i + 1) * inputs]
        q_lo, q_hi = grad[Q, 0], grad[Q, 1]
        for side in range(2):
            column, total = 2 * i + side, 0.0
            middle = np.empty((params, 2))
            # h: q falls by c' + g' (p - middle) where h grows
            by_lo, by_hi = _along(frame, dev)
            by_lo, by_hi = mul(q_lo, q_hi, -by_hi, -by_lo)
            by_lo, by_hi = add(grad[H, 0], grad[H, 1], by_lo, by_hi)
            at_h, p_lo, p_hi = _pick(by_lo, by_hi, frame.h_last, frame.h_first, side)
            total = up(total + p_hi) if side == 1 else down(total + p_lo)
            at_s, p_lo, p_hi = _pick(q_lo, q_hi, s_lo, s_hi, side)
            total = up(total + p_hi) if side == 1 else down(total + p_lo)
            for j in range(params):
                g_lo, g_hi = _slope(frame, j, 0.0, gone_hi)
                by_lo, by_hi = mul(q_lo, q_hi, g_lo, g_hi)
                if j < constants:
                    by_lo, by_hi = add(by_lo, by_hi, grad[2 + j, 0], grad[2 + j, 1])
                if i < shifted:
                    by_lo, by_hi = add(by_lo, by_hi, -frame.drift[j], -frame.drift[j])
                if j < constants:
                    at, p_lo, p_hi = _pick(by_lo, by_hi, lo[2 + j], hi[2 + j], side)
                    of.block_lo[2 + j, column] = of.block_hi[2 + j, column] = at
                    # the deviation that belongs to the value itself
                    base = 0.5 * (lo[2 + j] + hi[2 + j])
                    middle[j, 0], middle[j, 1] = down(at - base), up(at - base)
                else:
                    at, p_lo, p_hi = _pick(by_lo, by_hi, dev[j, 0], dev[j, 1], side)
                    middle[j, 0] = middle[j, 1] = at
                total = up(total + p_hi) if side == 1 else down(total + p_lo)
            for j in range(2 + constants, inputs):
                at, p_lo, p_hi = _pick(grad[j, 0], grad[j, 1], lo[j], hi[j], side)
                of.block_lo[j, column] = of.block_hi[j, column] = at
                total = up(total + p_hi) if side == 1 else down(total + p_lo)
            of.block_lo[H, column] = of.block_hi[H, column] = at_h
            gone_a, gone_b = down(frame.h_first - at_h), up(frame.h_first - at_h)
            here_lo, here_hi = mul(frame.rate, frame.rate, gone_a, gone_b)
            here_lo, here_hi = add(here_lo, here_hi, frame.centre, frame.centre)
            here_lo, here_hi = add(here_lo, here_hi, at_s, at_s)
            for j in range(params):
                g_lo, g_hi = _slope(frame, j, gone_a, gone_b)
                off_lo, off_hi = mul(g_lo, g_hi, middle[j, 0], middle[j, 1])
                here_lo, here_hi = add(here_lo, here_hi, off_lo, off_hi)
            of.block_lo[Q, column], of.block_hi[Q, column] = here_lo, here_hi
            if i < shifted:
                m_lo, m_hi = _along(frame, middle)
                shift[i, side] = m_lo if side == 1 else m_hi
            spread[i, side] = total
    run_block(of.code, of.constant, of.block_lo, of.block_hi, 2 * outputs, of.block)
    for k in range(of.code.shape[0]):
        if of.code[k, 0] != OUTPUT:
            continue
        i = of.code[k, 1]
        if not (np.isfinite(lower[i]) and np.isfinite(upper[i])):
            continue  # perhaps undefined somewhere: a gradient proves nothing
        mean = down(down(of.block[k, 0, 2 * i] - shift[i, 0]) + spread[i, 0])
        if mean > lower[i]:
            lower[i] = mean
        mean = up(up(of.block[k, 1, 2 * i + 1] - shift[i, 1]) + spread[i, 1])
        if mean < upper[i]:
            upper[i] = mean


@njit
def _hull_of_modes(lower: Floats, upper: Floats) -> tuple[float, float]:
    """Infimum and supremum of ds/d(travel) over all possible modes; (inf, -inf) if none.

    A tip over which the part slips towards +a has the ratio -mu, towards -a mu. The part slips so where
    the rate is above (below) the one at which it sticks. How far it is above, times the opening, is of
    first degree in either ratio, so a tip can stick only if that has both signs at the ends of its cone.
    """
    d_lo, d_hi = lower[D_STICKS], upper[D_STICKS]
    s_lo, s_hi = lower[S_STICKS], upper[S_STICKS]
    least, most = np.inf, -np.inf
    for mode in range(4):
        r_lo, r_hi = lower[mode], upper[mode]
        over_d, over_s = OVER_D + mode, OVER_S + mode
        opening = lower[OPENING + mode]
        possible = True
        if mode == DOWN_DOWN or mode == DOWN_UP:
            r_lo = max(r_lo, d_lo)
            possible = upper[over_d] >= 0.0
            if opening > 0.0:
                r_hi = min(r_hi, up(d_hi + up(upper[over_d] / opening)))
        else:
            r_hi = min(r_hi, d_hi)
            possible = lower[over_d] <= 0.0
            if opening > 0.0:
                r_lo = max(r_lo, down(d_lo + down(lower[over_d] / opening)))
        if mode == DOWN_DOWN or mode == UP_DOWN:
            r_lo = max(r_lo, s_lo)
            possible = possible and upper[over_s] >= 0.0
            if opening > 0.0:
                r_hi = min(r_hi, up(s_hi + up(upper[over_s] / opening)))
        else:
            r_hi = min(r_hi, s_hi)
            possible = possible and lower[over_s] <= 0.0
            if opening > 0.0:
                r_lo = max(r_lo, down(s_lo + down(lower[over_s] / opening)))
        if possible and not r_lo > r_hi:
            least, most = min(least, r_lo), max(most, r_hi)
    for other in range(
        2
    ):  # the ratio of the tip that slips: 0 negative, as the rate is above its own
        one, two = (DOWN_DOWN, UP_DOWN) if other == 0 else (DOWN_UP, UP_UP)
        if ((other == 0 and d_hi >= s_lo) or (other == 1 and d_lo <= s_hi)) and _both_signs(
            lower, upper, OVER_D + one, OVER_D + two
        ):
            least, most = min(least, d_lo), max(most, d_hi)
        one, two = (DOWN_DOWN, DOWN_UP) if other == 0 else (UP_DOWN, UP_UP)
        if ((other == 0 and s_hi >= d_lo) or (other == 1 and s_lo <= d_hi)) and _both_signs(
            lower, upper, OVER_S + one, OVER_S + two
        ):
            least, most = min(least, s_lo), max(most, s_hi)
    if not (d_lo > s_hi or s_lo > d_hi):  # both may stick, whatever the ratios
        least, most = min(least, max(d_lo, s_lo)), max(most, min(d_hi, s_hi))
    return least, most


@njit
def _both_signs(lower: Floats, upper: Floats, one: int, two: int) -> bool:
    """Whether one of two outputs may be positive and one negative, or one zero."""
    return min(lower[one], lower[two]) <= 0.0 <= max(upper[one], upper[two])


@njit
def _next_bound(
    rates: Program,
    frame: _Frame,
    lo: Floats,
    hi: Floats,
    constants: int,
    at: float,
    side: int,
    strip: float,
    keep: bool,
) -> tuple[float, int]:
    """Bound of s one step on: upper (side = 1) or lower (0), and a status.

    ``keep``: a motion may still start here, so the bound must not move inward.
    """
    dh = frame.h_first - frame.h_last
    lower, upper = np.empty(ALL), np.empty(ALL)
    pad = strip
    for _ in range(12):  # widen the strip until the line stays inside
        _bound(rates, frame, lo, hi, constants, down(at - pad), up(at + pad), RATES, lower, upper)
        least, most = _hull_of_modes(lower, upper)
        if least > most:
            return at, 4
        slope = most if side == 1 else least
        if keep:
            slope = max(slope, 0.0) if side == 1 else min(slope, 0.0)
        rise_lo, rise_hi = mul(slope, slope, down(dh), up(dh))
        reach = max(abs(rise_lo), abs(rise_hi))
        if reach < pad:
            return (up(at + rise_hi) if side == 1 else down(at + rise_lo)), 0
        pad = 1.5 * reach
        if not pad < 1.0:
            break
    return at, 1


@njit
def _guess(
    rates: Program,
    at: Floats,
    constants: int,
    spread: Floats,
    drift: Floats,
) -> float:
    """c' of the motion with middle values, from its active mode; fills g'. Any guess is sound."""
    inputs, outputs = at.size, ALL
    run(rates.slope_code, rates.slope_constant, at, at, rates.work, rates.slope)
    value = 0.5 * (rates.slope[:outputs, 0] + rates.slope[:outputs, 1])
    high, low = S_STICKS, D_STICKS
    if value[D_STICKS] > value[S_STICKS]:
        high, low = D_STICKS, S_STICKS
    between = DOWN_UP if low == D_STICKS else UP_DOWN
    if value[DOWN_DOWN] >= value[high]:
        mode = DOWN_DOWN
    elif value[UP_UP] <= value[low]:
        mode = UP_UP
    elif value[between] >= value[high]:
        mode = high
    elif value[between] <= value[low]:
        mode = low
    else:
        mode = between
    grad = rates.slope[outputs + mode * inputs : outputs + (mode + 1) * inputs]
    by_q = 0.5 * (grad[Q, 0] + grad[Q, 1])
    for j in range(spread.size):
        drift[j] = by_q * spread[j]
        if j < constants:
            drift[j] += 0.5 * (grad[2 + j, 0] + grad[2 + j, 1])
    return value[mode]


@njit
def _holds(
    state: Program,
    frame: _Frame,
    lo: Floats,
    hi: Floats,
    constants: int,
    s_lo: float,
    s_hi: float,
    ends: Floats,
    margins: Floats,
) -> int:
    """Check over one slice of the tube that both tips stay in contact and on their edges."""
    lower, upper = np.empty(10), np.empty(10)
    _bound(state, frame, lo, hi, constants, s_lo, s_hi, 0, lower, upper)
    tightest, widest = lower[2:6].min(), upper[2:6].max()
    margins[2] = min(margins[2], tightest)
    if not margins[2] > 0.0:
        return 1
    margins[0] = min(margins[0], down(lower[6:8].min() / widest))
    margins[3] = max(margins[3], up(upper[6:].max() / tightest))
    for k in range(2):
        margins[1] = min(margins[1], down(lower[k] - ends[k, 0]))
        margins[1] = min(margins[1], down(ends[k, 1] - upper[k]))
    if not (margins[0] > 0.0 and lower[6:].min() > 0.0):
        return 2
    return 0 if margins[1] > 0.0 else 3


class _Tube(NamedTuple):
    """What is filled."""

    h: Floats
    centre: Floats
    spread: Floats
    lower: Floats
    upper: Floats
    margins: Floats


@njit
def _bound_lines(
    programs: _Programs,
    lo: Floats,
    hi: Floats,
    dev_lo: Floats,
    dev_hi: Floats,
    constants: int,
    band: float,
    ends: Floats,
    every: int,
    tube: _Tube,
) -> int:
    """Fill the knots of ``tube`` from its first one; see the module's text.

    Until h has fallen to ``band`` a motion may still start anywhere between the first bounds, so the tube
    does not shrink there, and its knots are given.
    """
    h = tube.h
    middle = 0.5 * (lo + hi)
    drift = np.zeros(dev_lo.size)
    strip_lo = strip_hi = 1e-9
    checked = 0
    for k in range(h.size - 1):
        dh = h[k] - h[k + 1]
        starts = h[k] > band
        if not starts:
            point = middle.copy()
            point[H] = 0.5 * (h[k] + h[k + 1])
            point[Q] = tube.centre[k] + 0.5 * (tube.centre[k] - tube.centre[k - 1])
            rate = _guess(programs.rates, point, constants, tube.spread[k], drift)
            if not (np.isfinite(rate) and np.isfinite(drift).all()):
                return 1
            tube.centre[k + 1] = tube.centre[k] + rate * dh
            tube.spread[k + 1] = tube.spread[k] + drift * dh
        # what is used are the slopes between the rounded knots
        rate = (tube.centre[k + 1] - tube.centre[k]) / dh
        slopes = (tube.spread[k + 1] - tube.spread[k]) / dh
        frame = _Frame(h[k], h[k + 1], tube.centre[k], rate, tube.spread[k], slopes, dev_lo, dev_hi)
        rest_lo, rest_hi = tube.lower[k], tube.upper[k]
        next_lo, status = _next_bound(
            programs.rates, frame, lo, hi, constants, rest_lo, 0, strip_lo, starts
        )
        if status != 0:
            return status
        next_hi, status = _next_bound(
            programs.rates, frame, lo, hi, constants, rest_hi, 1, strip_hi, starts
        )
        if status != 0:
            return status
        strip_lo = max(1.5 * abs(next_lo - rest_lo), 1e-4 * dh)
        strip_hi = max(1.5 * abs(next_hi - rest_hi), 1e-4 * dh)
        # the next knot is where the line ends, to within rounding
        off_lo, off_hi = _offsets(
            h[k : k + 2],
            tube.centre[k : k + 2],
            tube.spread[k : k + 2],
            rate,
            slopes,
            dev_lo,
            dev_hi,
        )
        tube.lower[k + 1], tube.upper[k + 1] = down(next_lo - off_hi[1]), up(next_hi - off_lo[1])
        if k + 1 - checked == every or k + 2 == h.size or starts:
            status = _check_slice(
                programs.state, lo, hi, dev_lo, dev_hi, constants, ends, tube, checked, k + 1
            )
            if status != 0:
                return status
            checked = k + 1
    return 0


@njit
def _check_slice(
    state: Program,
    lo: Floats,
    hi: Floats,
    dev_lo: Floats,
    dev_hi: Floats,
    constants: int,
    ends: Floats,
    tube: _Tube,
    first: int,
    last: int,
) -> int:
    """What must hold, over the knots ``first`` to ``last``."""
    reach = tube.h[first] - tube.h[last]
    rate = (tube.centre[last] - tube.centre[first]) / reach
    drift = (tube.spread[last] - tube.spread[first]) / reach
    off_lo, off_hi = _offsets(
        tube.h[first : last + 1],
        tube.centre[first : last + 1],
        tube.spread[first : last + 1],
        rate,
        drift,
        dev_lo,
        dev_hi,
    )
    least, most = np.inf, -np.inf
    for k in range(first, last + 1):
        least = min(least, down(tube.lower[k] + off_lo[k - first]))
        most = max(most, up(tube.upper[k] + off_hi[k - first]))
    frame = _Frame(
        tube.h[first], tube.h[last], tube.centre[first], rate, tube.spread[first], drift,
        dev_lo, dev_hi,
    )  # fmt: skip
    return _holds(state, frame, lo, hi, constants, least, most, ends, tube.margins)


@njit
def _offsets(
    h: Floats,
    centre: Floats,
    spread: Floats,
    rate: float,
    drift: Floats,
    dev_lo: Floats,
    dev_hi: Floats,
) -> tuple[Floats, Floats]:
    """How far c + g (p - middle) at each knot can be off one line from the first knot."""
    off_lo, off_hi = np.zeros(h.size), np.zeros(h.size)
    for k in range(h.size):
        gone_lo, gone_hi = down(h[0] - h[k]), up(h[0] - h[k])
        way_lo, way_hi = mul(rate, rate, gone_lo, gone_hi)
        ahead_lo, ahead_hi = down(centre[k] - centre[0]), up(centre[k] - centre[0])
        lo, hi = add(ahead_lo, ahead_hi, -way_hi, -way_lo)
        for j in range(drift.size):
            way_lo, way_hi = mul(drift[j], drift[j], gone_lo, gone_hi)
            more_lo, more_hi = down(spread[k, j] - spread[0, j]), up(spread[k, j] - spread[0, j])
            more_lo, more_hi = add(more_lo, more_hi, -way_hi, -way_lo)
            more_lo, more_hi = mul(more_lo, more_hi, dev_lo[j], dev_hi[j])
            lo, hi = add(lo, hi, more_lo, more_hi)
        off_lo[k], off_hi[k] = lo, hi
    return off_lo, off_hi


def _compiled() -> Callable[..., int]:
    """The kernel that is called from Python, kept on disk; see ``kernels.fingerprint``."""
    key = fingerprint("bounds", "motion")

    @njit(cache=True, nogil=True)
    def grow(
        programs: _Programs,
        lo: Floats,
        hi: Floats,
        dev_lo: Floats,
        dev_hi: Floats,
        constants: int,
        band: float,
        ends: Floats,
        every: int,
        tube: _Tube,
    ) -> int:
        if key < 0:
            return 1
        return _bound_lines(programs, lo, hi, dev_lo, dev_hi, constants, band, ends, every, tube)

    return grow


_grow = _compiled()


def parameters_of(grip: Grip, labels: Mapping[str, Interval]) -> dict[str, Interval]:
    """The constants of a grip that are not exactly zero, and the labels.

    Parameters
    ----------
    grip
        What is known.
    labels
        `Start.labels`.

    Returns
    -------
    dict[str, Interval]
        In the order of `SlideTube.spread`.
    """
    box = grip.box()
    return {name: box[name] for name in CONSTANT if box[name] != ZERO} | dict(labels)


def rate_at(grip: Grip, h: float, q: float) -> float:
    """The slide's rate in the middle of all that is known, in plain numbers; a guess."""
    box = grip.box()
    formulas = _formulas(_exact(box), grip.common)
    at = np.array([h, q, *(box[name].mid for name in formulas.inputs[2:])])
    rates = np.array(formulas.rates.function(at)).ravel()[:RATES]
    low, high = sorted(rates[[D_STICKS, S_STICKS]])
    between = rates[DOWN_UP if low == rates[D_STICKS] else UP_DOWN]
    clipped = min(max(between, low), high)
    return float(max(rates[DOWN_DOWN], min(rates[UP_UP], clipped)) if high > low else clipped)


def _exact(box: Mapping[str, Interval]) -> frozenset[str]:
    return frozenset(name for name, side in box.items() if side == ZERO)


def enclose_slide(
    grip: Grip, start: Start, h_end: float, *, coarse: float = 1.0, cells: int = 1
) -> SlideTube:
    """Enclose the slide from the touch of the second tip to the end of the travel.

    Parameters
    ----------
    grip
        What is known during the rotation.
    start
        Where and how both tips touch for the first time.
    h_end
        Lower bound of h at the end, m.
    coarse
        Factor on the step in h, which is 1/``STEPS`` of the part's width.
    cells
        Into how many parts the range of the room is cut: what is left of a cell falls with the square of
        its width.

    Returns
    -------
    SlideTube
        Bounds of the slide at every h, how far they could be grown, and what they leave in hand.

    Raises
    ------
    ValueError
        If the travel may end before both tips touch: there is nothing to enclose then.
    """
    if not h_end < start.h.lo:
        raise ValueError(
            f"h_end = {h_end} must be below every h_start = [{start.h.lo}, {start.h.hi}]: the push "
            "may end before both tips touch; make it longer"
        )
    ends = np.linspace(grip.room.lo, grip.room.hi, cells + 1).tolist()
    ends[0], ends[-1] = grip.room.lo, grip.room.hi
    rooms = [Interval(*pair) for pair in itertools.pairwise(ends)]
    return SlideTube(
        cells=tuple(
            _cell(replace(grip, room=room), _moved(start, grip.room, room), h_end, coarse)
            for room in rooms
        ),
        parameters=parameters_of(grip, start.labels),
    )


def _moved(start: Start, whole: Interval, room: Interval) -> Start:
    """A start told about the middle of another range of the room."""
    if room == whole:
        return start
    slope = start.spread.get("room", 0.0)
    value = start.value + slope * (room.mid - whole.mid)
    point = Interval.point
    told = point(start.value) + point(slope) * (point(room.mid) - point(whole.mid))
    return replace(start, value=value, rest=start.rest + (told - point(value)))


def _cell(grip: Grip, start: Start, h_end: float, coarse: float) -> Cell:
    box = grip.box()
    formulas = _formulas(_exact(box), grip.common)
    used = formulas.inputs[2:]
    parameters = parameters_of(grip, start.labels)
    constants = len(parameters) - len(start.labels)
    step = coarse * (grip.d_D.mid + grip.d_S.mid) / STEPS
    count = max(2, int(np.ceil((start.h.hi - h_end) / step)))
    h = np.linspace(start.h.hi, h_end, count + 1)
    # the tube begins where it is stated to, whatever linspace makes of it
    h[0], h[-1] = start.h.hi, h_end
    tube = _Tube(
        h=h,
        centre=np.full(count + 1, np.nan),
        spread=np.full((count + 1, len(parameters)), np.nan),
        lower=np.full(count + 1, np.nan),
        upper=np.full(count + 1, np.nan),
        margins=np.array([np.inf, np.inf, np.inf, -np.inf]),
    )
    spread = np.array([start.spread.get(name, 0.0) for name in parameters])
    starts = slice(0, int((h > start.h.lo).sum()) + 1)
    tube.centre[starts] = start.value + start.rate * (start.h.hi - h[starts])
    tube.spread[starts] = spread
    dev = deviations(parameters)
    off = _offsets(
        h[starts], tube.centre[starts], tube.spread[starts], start.rate, 0.0 * spread, *dev
    )
    # what starts is known from a line, and the knots are that line to within rounding
    tube.lower[0] = np.nextafter(start.rest.lo - max(0.0, float(off[1].max())), -np.inf)
    tube.upper[0] = np.nextafter(start.rest.hi - min(0.0, float(off[0].min())), np.inf)
    sides = [ZERO, ZERO, *(box[name] for name in used)]
    ends = [[first.hi, last.lo] for first, last in (grip.ends_D, grip.ends_S)]
    status = _grow(
        _Programs(program(formulas.rates), program(formulas.state)),
        np.array([side.lo for side in sides]),
        np.array([side.hi for side in sides]),
        *dev,
        constants,
        start.h.lo,
        np.array(ends),
        max(1, round(CHECKED / coarse)),
        tube,
    )
    return Cell(
        h=h,
        centre=tube.centre,
        spread=tube.spread,
        lower=tube.lower,
        upper=tube.upper,
        parameters=parameters,
        status=TubeStatus(status),
        margins=tube.margins,
    )
