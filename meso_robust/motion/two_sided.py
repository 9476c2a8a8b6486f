"""Enclosure of the rotation between a moving and a passive tip, although it need not be unique.

While both tips touch one freedom is left, the slide ``q`` of the reference point ahead of the passive
tip's contact (derivations/opposite_edges.py). In every contact mode dq/d(travel) is an explicit function
of the distance ``h`` of the tips along the push, of ``q``, of constants ``p`` (separation, depths, radii,
...) and of what may change at every instant (friction, drag, wander). The tube is

    q = c(h) + sum g_i(h) (p_i - middle of p_i) + s,   lower(h) <= s <= upper(h)

with ``c`` piecewise a parabola and ``g`` piecewise linear. Any ``c`` and ``g`` are sound; those of the linearised motion keep
what is left, ``s``, narrow, although every constant is anywhere in its range. Let f+ (f-) be the supremum
(infimum) of ds/d(travel) over all modes and parameters that are possible at (h, s). A line that rises at
least as fast as f+ everywhere in a strip around itself cannot be crossed from below: if it were, the
motion would be above it inside the strip after its last point on the line, where it rises no faster.
The tube is bounded by such lines, one pair a step in h.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cache
from typing import NamedTuple

import casadi as ca
import numpy as np

from meso_robust import kernels
from meso_robust.bounds import Bounded, Interval, bounded
from meso_robust.bounds.bulk import program
from meso_robust.conditions.formula import formula
from meso_robust.motion.barrier import (
    D_STICKS,
    DOWN_DOWN,
    DOWN_UP,
    RATES,
    S_STICKS,
    UP_DOWN,
    UP_UP,
    Known,
    Programs,
    Tube,
    beside_chords,
    grow,
    offsets,
)
from meso_robust.types import Floats

STEPS = 120  # per width of the part: about 7 um for the paper's part
CHECKED = 3  # steps whose forces and edges are checked together: half as long, and hardly looser
MODULE = "opposite_edges"
CONSTANT = ("room", "d_D", "d_S", "r_D", "r_S", "kappa", "drag_a", "drag_n")
INSTANT = ("rho", "stretch", "shear", "bend", "centre_a", "centre_n", "sway", "mu_D", "mu_S")
FIELDS = {"d_D": "depth", "d_S": "depth_far", "r_D": "radius", "r_S": "radius_far"}
"""Names of `Grip` for those of the formulas."""
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
    depth: Interval
    """Distance of the moving tip's edge from the reference point."""
    depth_far: Interval
    """The same of the passive tip's edge."""
    ends: tuple[Interval, Interval]
    """First and last point of the moving tip's edge, from the foot of the reference point."""
    ends_far: tuple[Interval, Interval]
    """The same of the passive tip's edge, in the same direction."""
    rho: Interval
    """e_theta/e_x, m^2."""
    mu: Interval
    """At either tip."""
    common: bool = True
    """Whether both tips have the same friction coefficient at every instant."""
    radius: Interval = ZERO
    """Of the moving tip."""
    radius_far: Interval = ZERO
    """Of the passive one."""
    kappa: Interval = ZERO
    """Direction of the passive tip's edge less that of the moving tip's, rad."""
    drag_a: Interval = ZERO
    """Centre of drag along the moving tip's edge, from the reference point."""
    drag_n: Interval = ZERO
    """Centre of drag towards the moving tip's edge."""
    centre_a: Interval = ZERO
    """The same of a centre of drag that moves, at an instant, from there."""
    centre_n: Interval = ZERO
    stretch: Interval = ZERO
    shear: Interval = ZERO
    bend: Interval = ZERO
    """dV/d(travel) by wander."""
    sway: Interval = ZERO
    """Deviation of V by wander."""

    def constants(self) -> dict[str, Interval]:
        """What is constant during the rotation, by the names of the formulas."""
        box = self.box()
        return {name: box[name] for name in CONSTANT}

    def box(self) -> dict[str, Interval]:
        """The ranges by the names of the formulas."""
        names = {name: FIELDS.get(name, name) for name in (*CONSTANT, *INSTANT[:-2])}
        friction = {"mu_D": self.mu} if self.common else {"mu_D": self.mu, "mu_S": self.mu}
        return {**{name: getattr(self, own) for name, own in names.items()}, **friction}


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
    bend: Floats
    """(K,) c'' between two knots, 1/m."""
    spread: Floats
    """(K+1, P) g, by parameter."""
    lower: Floats
    """(K+1,) lower bound of s at the knot, m."""
    upper: Floats
    """(K+1,) upper bound, m."""
    parameters: Mapping[str, Interval]
    """The constants whose effect ``spread`` holds, and the labels."""
    ranges: Known
    """The same as the kernels take them."""
    status: TubeStatus
    margins: Floats
    """(4,) as of `SlideTube`."""

    @property
    def checked(self) -> int:
        """The last knot down to which all is checked, if all knots were to be."""
        # growing ends where a knot is bounded but perhaps does not hold
        bounded_ = int(np.isfinite(self.upper).sum()) - 1
        return bounded_ if self.status is TubeStatus.COMPLETE else max(bounded_ - 1, 0)

    def around(self, h: Interval) -> Line:
        """An affine enclosure of the slide wherever h is in a range within the tube."""
        first = max(int(np.searchsorted(-self.h, -h.hi, side="right")) - 1, 0)
        last = min(int(np.searchsorted(-self.h, -h.lo, side="left")), self.h.size - 1)
        return self.line(first, max(last, first + 1))

    def line(self, first: int, last: int) -> Line:
        """One affine enclosure of the slide between two knots."""
        used = slice(first, last + 1)
        reach = float(self.h[first] - self.h[last])
        rate = float(self.centre[last] - self.centre[first]) / reach
        drift = (self.spread[last] - self.spread[first]) / reach
        off_lo, off_hi = offsets(
            self.h[used], self.centre[used], self.spread[used], rate, drift, self.ranges
        )
        sag_lo, sag_hi = beside_chords(self.h[first : last + 1], self.bend[first:last])
        return Line(
            first=float(self.h[first]),
            value=float(self.centre[first]),
            rate=rate,
            spread=dict(zip(self.parameters, self.spread[first].tolist(), strict=True)),
            drift=dict(zip(self.parameters, drift.tolist(), strict=True)),
            rest=Interval(
                float(np.nextafter(self.lower[used] + off_lo, -np.inf).min()),
                float(np.nextafter(self.upper[used] + off_hi, np.inf).max()),
            )
            + Interval(sag_lo, sag_hi),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SlideTube:
    """All slides from the touch of both tips to the end of the travel."""

    cells: tuple[Cell, ...]
    """By rising room; all with the same knots."""

    @property
    def h(self) -> Floats:
        """(K+1,) the knots, decreasing, m."""
        return self.cells[0].h

    @property
    def widest(self) -> float:
        """Largest width of what is left uncertain of a cell when its constants are known, m."""
        return max(float(np.max(cell.upper - cell.lower)) for cell in self.cells)

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

    def lines(self, h: Interval) -> tuple[Line, ...]:
        """An affine enclosure of the slide wherever h is in a range, for each cell.

        Parameters
        ----------
        h
            m; within the tube.

        Returns
        -------
        tuple[Line, ...]
            Between the knots that hold the range (`Cell.around`); middles are those of the cell's parameters.
        """
        return tuple(cell.around(h) for cell in self.cells)


def known(
    parameters: Mapping[str, Interval],
    sides: Sequence[Interval] = (),
    constants: int = 0,
    ratios: int = 0,
) -> Known:
    """Ranges as the kernels take them; deviations of parameters from their middles rounded outward."""
    off = [side - Interval.point(side.mid) for side in parameters.values()]
    return Known(
        lo=np.array([side.lo for side in sides]),
        hi=np.array([side.hi for side in sides]),
        dev_lo=np.array([side.lo for side in off]),
        dev_hi=np.array([side.hi for side in off]),
        constants=constants,
        ratios=ratios,
    )


class _Formulas(NamedTuple):
    """They and the names of their inputs."""

    inputs: tuple[str, ...]
    rates: Bounded
    state: Bounded


@cache
def _formulas(exact: frozenset[str], common: bool) -> _Formulas:
    """Slide rates, and what must hold of a state, without the inputs that are exactly zero.

    The state's outputs are those of `barrier.GRIPS` and so on.
    """
    names = ("h", "q", *CONSTANT, *INSTANT)
    free = tuple(name for name in names if name not in exact and not (common and name == "mu_S"))
    x = ca.SX.sym("x", len(free))
    at = dict.fromkeys(names, ca.SX(0.0)) | dict(zip(free, ca.vertsplit(x), strict=True))
    if common:
        at["mu_S"] = at["mu_D"]
    at["room"] = at["room"] + at["sway"]
    for axis in "an":
        at[f"drag_{axis}"] = at[f"drag_{axis}"] + at[f"centre_{axis}"]

    def value(name: str, *keys: str) -> tuple[ca.SX, ...]:
        return formula(MODULE, name)(ca, *(at[key] for key in keys))

    (at["W"],) = value("width", "q", "d_D", "d_S", "r_D", "r_S", "kappa")
    (at["clear"],) = value("clear", "q", "d_S", "r_S", "kappa", "room")
    (at["T"],) = value("apart", "h", "clear", "W")
    at["V"] = at["clear"] + at["W"]
    at["c"], at["s"] = value("direction", "h", "V", "W", "T")
    (place,) = value("active_offset", "T", "q", "d_S", "r_S", "kappa")
    held: tuple[str, ...] = ("c", "s", "T", "q", "d_D", "d_S", "r_S", "kappa", "drag_a", "drag_n")
    held += ("rho", "stretch", "shear", "bend", "mu_D", "mu_S")
    sticking = value("stick_rates", "c", "s", "T", "q", "d_D", "d_S", "r_D", "r_S", "kappa", "bend")
    corners = []
    for of_D, of_S in SIGNS:
        at["tau_D"], at["tau_S"] = of_D * at["mu_D"], of_S * at["mu_S"]
        # where both have one coefficient and opposite signs their sum is zero, not an interval
        at["total"] = ca.SX(0.0) if common and of_D != of_S else at["tau_D"] + at["tau_S"]
        corners.append(value("corner", *held[:6], "r_D", *held[6:-2], "tau_D", "tau_S", "total"))
    rates = (*(corner[0] for corner in corners), *sticking)
    rates += tuple(corner[k] for k in (1, 2) for corner in corners)
    state = (place, -at["q"], *value("corner_grips", *held), *value("corner_forces", *held))
    at["place"] = place
    alone = ("c", "s", "place", "d_D", "drag_a", "drag_n", "rho", "stretch", "shear", "bend")
    state += (*value("slip_alone", *alone), *value("pressing", *alone))

    def prepared(name: str, results: tuple[ca.SX, ...]) -> Bounded:
        both = ca.cse(ca.densify(ca.vertcat(*results)))
        return bounded(f"{MODULE}.{name}", free, ca.Function(name, [x], [both]))

    return _Formulas(free, prepared("rates", rates), prepared("state", state))


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
        In the order of `Cell.spread`.
    """
    wide = {name: side for name, side in grip.constants().items() if side != ZERO}
    return wide | dict(labels)


def rate_at(grip: Grip, h: float, q: float) -> float:
    """The slide's rate in the middle of all that is known, in plain numbers; a guess.

    Parameters
    ----------
    grip
        What is known.
    h, q
        Distance of the tips along the travel and the slide, m.

    Returns
    -------
    float
        dq/d(travel).
    """
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


def cut(grip: Grip, cells: int) -> list[Interval]:
    """The range of the room in parts: what is left uncertain of each falls with the square of its width.

    Parameters
    ----------
    grip
        What is known during the rotation.
    cells
        How many.

    Returns
    -------
    list[Interval]
        By rising room, m.
    """
    ends = np.linspace(grip.room.lo, grip.room.hi, cells + 1).tolist()
    ends[0], ends[-1] = grip.room.lo, grip.room.hi
    return list(itertools.starmap(Interval, itertools.pairwise(ends)))


Part = tuple[Grip, Mapping[str, Interval]]
"""What is known of the grip, and the labels, if the room is in a part of its range."""


def enclose_slide(
    grip: Grip,
    start: Start,
    h_end: float,
    *,
    coarse: float = 1.0,
    parts: Sequence[Part] | None = None,
    stops: Sequence[float] = (),
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
    parts
        What is known for each part of the range of the room, by rising room (see `cut`); the whole in one
        if it is not given.
    stops
        Values of h, falling, at which the travel may end as well: each is a knot, and all knots are checked.

    Returns
    -------
    SlideTube
        Bounds of the slide at every h, how far they could be grown, and what they leave in hand; a cell for
        each part.

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
    whole = parameters_of(grip, start.labels)
    step = coarse * (grip.depth.mid + grip.depth_far.mid) / STEPS
    given = parts or [(grip, start.labels)]
    for own, _ in given:
        _formulas(_exact(own.box()), own.common)  # prepared once, before threads ask for them

    def cell(part: Part) -> Cell:
        own, labels = part
        moved = _about(replace(start, labels=labels), whole, parameters_of(own, labels))
        knots = _knots(start.h.hi, [*stops, h_end], step)
        every = 1 if stops else max(1, round(CHECKED / coarse))
        return _cell(own, moved, knots, every)

    return SlideTube(cells=tuple(kernels.spread(cell, given)))


def _about(start: Start, before: Mapping[str, Interval], after: Mapping[str, Interval]) -> Start:
    """A start told about the middles of other ranges."""
    point = Interval.point
    value, told = start.value, point(start.value)
    for name, side in before.items():
        old, new, slope = side.mid, after.get(name, ZERO).mid, start.spread.get(name, 0.0)
        if old != new:
            value += slope * (new - old)
            told = told + point(slope) * (point(new) - point(old))
    return replace(start, value=value, rest=start.rest + (told - point(value)))


def _knots(first: float, stops: Sequence[float], step: float) -> Floats:
    """From the first to the last, with all stops in between, and at most a step apart."""
    knots = [first]
    for stop in stops:
        if stop < knots[-1]:
            count = max(1 if len(stops) > 1 else 2, int(np.ceil((knots[-1] - stop) / step)))
            # the tube is to end where it is stated to, whatever linspace makes of it
            knots += [*np.linspace(knots[-1], stop, count + 1)[1:-1].tolist(), stop]
    return np.array(knots)


def _cell(grip: Grip, start: Start, h: Floats, every: int) -> Cell:
    box = grip.box()
    formulas = _formulas(_exact(box), grip.common)
    used = formulas.inputs[2:]
    parameters = parameters_of(grip, start.labels)
    constants = len(parameters) - len(start.labels)
    count = h.size - 1
    tube = Tube(
        h=h,
        centre=np.full(count + 1, np.nan),
        bend=np.zeros(count),
        spread=np.full((count + 1, len(parameters)), np.nan),
        lower=np.full(count + 1, np.nan),
        upper=np.full(count + 1, np.nan),
        margins=np.array([np.inf, np.inf, np.inf, -np.inf]),
    )
    spread = np.array([start.spread.get(name, 0.0) for name in parameters])
    starts = slice(0, int((h > start.h.lo).sum()) + 1)
    tube.centre[starts] = start.value + start.rate * (start.h.hi - h[starts])
    tube.spread[starts] = spread
    sides = [ZERO, ZERO, *(box[name] for name in used)]
    ranges = known(parameters, sides, constants, 0 if grip.common else 2)
    off = offsets(
        h[starts], tube.centre[starts], tube.spread[starts], start.rate, 0.0 * spread, ranges
    )
    # what starts is known from a line, and the knots are that line to within rounding
    tube.lower[0] = np.nextafter(start.rest.lo - max(0.0, float(off[1].max())), -np.inf)
    tube.upper[0] = np.nextafter(start.rest.hi - min(0.0, float(off[0].min())), np.inf)
    ends = np.array([[first.hi, last.lo] for first, last in (grip.ends, grip.ends_far)])
    both = formulas.rates, formulas.state
    programs = Programs(*(program(of, 2 * of.values.outputs) for of in both))
    status = grow(programs, ranges, start.h.lo, ends, every, tube)
    return Cell(
        h=h,
        centre=tube.centre,
        bend=tube.bend,
        spread=tube.spread,
        lower=tube.lower,
        upper=tube.upper,
        parameters=parameters,
        ranges=ranges,
        status=TubeStatus(status),
        margins=tube.margins,
    )
