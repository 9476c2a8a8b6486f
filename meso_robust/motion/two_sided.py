"""Enclosure of the rotation between a moving and a passive tip, although it is not unique.

The orientation follows from the tips alone (derivations/two_sided_rotation.py); one unknown is
left, the slide sigma of the centre along the long axis from the middle of the pair. In every
contact mode d(sigma)/d(travel) is an explicit function, so with f+ (f-) its supremum (infimum) over
all modes and parameters that are possible at (h, sigma), every motion obeys

    f-(h, sigma) <= d(sigma)/d(travel) <= f+(h, sigma),

and a line that rises faster than f+ everywhere in a strip around itself cannot be crossed from
below: if it were, the motion would be above it inside the strip after its last point on the line,
where it rises more slowly. The tube is bounded by such lines, one pair a step in h.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numba import njit

from meso_robust.bounds.arithmetic import down, mul, up
from meso_robust.bounds.bulk import Program, bound_box, program
from meso_robust.bounds.interval import Interval
from meso_robust.bounds.tape import run
from meso_robust.conditions import condition
from meso_robust.kernels import fingerprint
from meso_robust.types import Floats

STEPS = 420  # per width of the part: about 2 um for the paper's part
H, V, D1, SIGMA, RHO, MU = range(6)  # arguments of slide_rates
DOWN_DOWN, DOWN_UP, UP_DOWN, UP_UP, HALF_T_RATE = range(5)  # its values: which way D and S slip


class TubeStatus(IntEnum):
    """How far an enclosure came."""

    COMPLETE = 0
    UNBOUNDED = 1
    """A rate could not be bounded: the grasp may close (jam)."""
    CONTACT_LOST = 2
    """The passive tip may be left: the moving tip alone might push."""
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SlideTube:
    """Bounds of the slide at every knot."""

    h: Floats
    """(K+1,) x of the moving tip minus x of the passive one, decreasing, m."""
    lower: Floats
    """(K+1,) lower bound of sigma at the knot, m."""
    upper: Floats
    """(K+1,) upper bound, m."""
    status: TubeStatus
    edge_margin: float
    """Smallest proved distance of a tip from the end of its edge, m."""
    force_margin: float
    """Smallest proved lower bound of the force at the passive tip, over e_x and travel rate, m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Grip:
    """What stays constant while two tips turn the part."""

    separation: Interval
    """y distance V of the two tips, m."""
    depth: Interval
    """Half the width of the part, m."""
    half: Interval
    """Half its length, m."""
    ratio: Interval
    """rho, m^2."""
    friction: Interval
    """mu, the same at both tips (it may change, but not differ between them)."""


class _Programs(NamedTuple):
    """The functions that the kernels evaluate."""

    rates: Program
    pair: Program
    force: Program


def _programs() -> _Programs:
    return _Programs(
        *(
            program(condition("two_sided_rotation", name))
            for name in ("slide_rates", "pair", "passive_force")
        )
    )


@njit
def _slips(lower: Floats, upper: Floats) -> tuple[float, float]:
    """Hull of the rates of the modes in which both contacts slip; (inf, -inf) if none can."""
    v_lo, v_hi = lower[HALF_T_RATE], upper[HALF_T_RATE]
    q_lo = 0.0 if v_lo <= 0.0 <= v_hi else min(abs(v_lo), abs(v_hi))
    q_hi = max(abs(v_lo), abs(v_hi))
    least, most = np.inf, -np.inf
    for mode in range(4):
        r_lo, r_hi = lower[mode], upper[mode]
        if mode == UP_UP:
            r_hi = min(r_hi, -q_lo)
        elif mode == DOWN_DOWN:
            r_lo = max(r_lo, q_lo)
        else:  # away from each other (v > 0) or towards each other (v < 0)
            if (mode == UP_DOWN and v_hi < 0.0) or (mode == DOWN_UP and v_lo > 0.0):
                continue
            r_lo, r_hi = max(r_lo, -q_hi), min(r_hi, q_hi)
        if not r_lo > r_hi:
            least, most = min(least, r_lo), max(most, r_hi)
    return least, most


@njit
def _sticks(lower: Floats, upper: Floats) -> tuple[float, float]:
    """Hull of the rates of the modes in which one contact sticks; (inf, -inf) if none can."""
    v_lo, v_hi = lower[HALF_T_RATE], upper[HALF_T_RATE]
    crossing = v_lo <= 0.0 <= v_hi
    least, most = np.inf, -np.inf
    for apart in range(2):
        if (apart == 1 and v_hi < 0.0) or (apart == 0 and v_lo > 0.0):
            continue
        for stuck in range(2):  # 0: D sticks, 1: S sticks; the other one slips
            slips = UP_DOWN if apart == 1 else DOWN_UP
            other = (
                (DOWN_DOWN if apart == 1 else UP_UP)
                if stuck == 0
                else (UP_UP if apart == 1 else DOWN_DOWN)
            )
            span_lo = min(lower[slips], lower[other])
            span_hi = max(upper[slips], upper[other])
            r_lo, r_hi = (v_lo, v_hi) if stuck == 0 else (-v_hi, -v_lo)
            # where v = 0 both stick, whatever the ratios
            if crossing or not (r_lo > span_hi or r_hi < span_lo):
                least, most = min(least, r_lo), max(most, r_hi)
    return least, most


@njit
def _mode_bounds(programs: _Programs, lo: Floats, hi: Floats) -> tuple[float, float]:
    """Infimum and supremum of d(sigma)/d(travel) over all possible modes; (inf, -inf) if none.

    A tip slips towards +a with ratio mu, towards -a with -mu. With v = T'/2 the rate is below -|v|
    if both slip up, above |v| if both slip down, between if they slip apart or together, v if D
    sticks and -v if S sticks. The rate is a Moebius function of either ratio, hence monotone, so a
    sticking contact is possible only if its rate lies between the rates at the ends of its cone.
    """
    lower, upper, seen = np.empty(5), np.empty(5), np.empty((5, 2))
    bound_box(programs.rates, lo, hi, lower, upper, seen)
    slip_lo, slip_hi = _slips(lower, upper)
    stick_lo, stick_hi = _sticks(lower, upper)
    return min(slip_lo, stick_lo), max(slip_hi, stick_hi)


@njit
def _next_bound(
    programs: _Programs, lo: Floats, hi: Floats, at: float, dh: float, side: int, keep: bool
) -> tuple[float, int]:
    """Bound of sigma one step on: upper (side = 1) or lower (0), and a status.

    ``keep``: a motion may still start here, so the bound must not move inward.
    """
    pad = 2.0 * dh
    box_lo, box_hi = lo.copy(), hi.copy()
    for _ in range(4):  # widen the strip until the line stays inside
        box_lo[SIGMA], box_hi[SIGMA] = down(at - pad), up(at + pad)
        least, most = _mode_bounds(programs, box_lo, box_hi)
        if least > most:
            return at, 4
        slope = most if side == 1 else least
        if keep:
            slope = max(slope, 0.0) if side == 1 else min(slope, 0.0)
        rise_lo, rise_hi = mul(slope, slope, down(dh), up(dh))
        if max(abs(rise_lo), abs(rise_hi)) < pad:
            return (up(at + rise_hi) if side == 1 else down(at + rise_lo)), 0
        pad = 2.0 * max(abs(rise_lo), abs(rise_hi))
        if not pad < 1.0:
            break
    return at, 1


@njit
def _holds(programs: _Programs, lo: Floats, hi: Floats, half: float, margins: Floats) -> int:
    """Check over one slice of the tube that both tips stay in contact and on their edges."""
    force_lo, force_hi = np.empty(7), np.empty(7)  # (h, V, d1, sigma, rho, tau_D, tau_S)
    force_lo[:5], force_hi[:5] = lo[:5], hi[:5]
    force_lo[5:], force_hi[5:] = -hi[MU], hi[MU]
    of = programs.force
    run(of.code, of.constant, force_lo, force_hi, of.work, of.value)
    margins[0] = min(margins[0], of.value[0, 0])
    of = programs.pair
    run(of.code, of.constant, lo, hi, of.work, of.value)
    reach = 0.5 * of.value[0, 1]
    margins[1] = min(margins[1], down(half - up(reach - lo[SIGMA])))
    margins[1] = min(margins[1], down(half - up(reach + hi[SIGMA])))
    if not margins[0] > 0.0:
        return 2
    return 0 if margins[1] > 0.0 else 3


@njit
def _bound_lines(
    programs: _Programs,
    h: Floats,
    lo: Floats,
    hi: Floats,
    half: float,
    band: float,
    bounds: Floats,
    margins: Floats,
) -> int:
    """Fill the rows of ``bounds`` (lower, upper) from their first entries; see the module's text.

    Until h has fallen to ``band`` a motion may still start anywhere in the first slice, so the tube
    does not shrink there.
    """
    box_lo, box_hi = lo.copy(), hi.copy()
    lower, upper = bounds[0], bounds[1]
    for k in range(h.size - 1):
        box_lo[H], box_hi[H] = h[k + 1], h[k]
        dh = h[k] - h[k + 1]
        keep = h[k] > band
        lower[k + 1], status = _next_bound(programs, box_lo, box_hi, lower[k], dh, 0, keep)
        if status != 0:
            return status
        upper[k + 1], status = _next_bound(programs, box_lo, box_hi, upper[k], dh, 1, keep)
        if status != 0:
            return status
        box_lo[SIGMA] = min(lower[k], lower[k + 1])
        box_hi[SIGMA] = max(upper[k], upper[k + 1])
        status = _holds(programs, box_lo, box_hi, half, margins)
        if status != 0:
            return status
    return 0


def _compiled() -> Callable[..., int]:
    """The kernel that is called from Python, kept on disk; see ``kernels.fingerprint``."""
    key = fingerprint("bounds", "motion")

    @njit(cache=True, nogil=True)
    def grow(
        programs: _Programs,
        h: Floats,
        lo: Floats,
        hi: Floats,
        half: float,
        band: float,
        bounds: Floats,
        margins: Floats,
    ) -> int:
        if key < 0:
            return 1
        return _bound_lines(programs, h, lo, hi, half, band, bounds, margins)

    return grow


_grow = _compiled()


def enclose_slide(
    grip: Grip, h_start: Interval, h_end: float, sigma: Interval, *, coarse: float = 1.0
) -> SlideTube:
    """Enclose the slide from the touch of the second tip to the end of the travel.

    Parameters
    ----------
    grip
        What stays constant during the rotation.
    h_start
        h at which both tips touch for the first time, m.
    h_end
        Lower bound of h at the end, m.
    sigma
        Slide when both touch, m.
    coarse
        Factor on the step in h, which is 1/``STEPS`` of the part's width.

    Returns
    -------
    SlideTube
        Bounds of the slide at every h, how far they could be grown, and what they leave in hand.

    Raises
    ------
    ValueError
        If the travel may end before both tips touch: there is nothing to enclose then.
    """
    if not h_end < h_start.lo:
        raise ValueError(
            f"h_end = {h_end} must be below every h_start = [{h_start.lo}, {h_start.hi}]: the push "
            "may end before both tips touch; make it longer"
        )
    step = coarse * 2.0 * grip.depth.mid / STEPS
    count = max(2, int(np.ceil((h_start.hi - h_end) / step)))
    h = np.linspace(h_start.hi, h_end, count + 1)
    bounds = np.full((2, count + 1), np.nan)
    bounds[:, 0] = sigma.lo, sigma.hi
    sides = (grip.separation, grip.depth, sigma, grip.ratio, grip.friction)
    lo = np.array([h_end, *(side.lo for side in sides)])
    hi = np.array([h_start.hi, *(side.hi for side in sides)])
    margins = np.full(2, np.inf)
    status = _grow(_programs(), h, lo, hi, grip.half.lo, h_start.lo, bounds, margins)
    return SlideTube(
        h=h,
        lower=bounds[0],
        upper=bounds[1],
        status=TubeStatus(status),
        force_margin=float(margins[0]),
        edge_margin=float(margins[1]),
    )
