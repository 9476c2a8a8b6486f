"""The range of the outputs of a motion over the box of its parameters.

A motion goes from its start to an ``end`` that one equation gives; integrals over the way may enter
that equation and the outputs. The sign of a total derivative over the whole box (by the chain rule,
through the integrals and the end) tells at which end of its range a parameter makes an output least,
and there it is put; what is left of the box is looked at again. So the bounds are those at corners
wherever the outputs are monotone, and mean-value bounds for the parameters that stay undecided.

Parameters of ``history`` may change at every instant of the motion. An output is then a functional
of their course, whose derivative at an instant is the slope of the integrand there: the corner holds
if that has one sign on all of the way, and else its absolute value is integrated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
import numpy.typing as npt

from meso_robust.bounds.bulk import Bounded, enclose_many
from meso_robust.bounds.interval import Interval
from meso_robust.bounds.prove import Box
from meso_robust.bounds.tape import compile_tape
from meso_robust.types import Floats

PIECES = 8
"""Of the way, of each of which an integrand is enclosed; more only make the bounds tighter."""
CUTS_OF_WAY = np.arange(PIECES + 1) / PIECES  # a power of 2: exact
EVERY_PIECE = CUTS_OF_WAY[:-1], CUTS_OF_WAY[1:]
MIDDLES = (0.5 * (EVERY_PIECE[0] + EVERY_PIECE[1]),) * 2
ROUNDS = 4
"""How often what is left of a box is looked at again; effort, no proof rests on it."""
CUTS = 6
"""How often the box of a margin is halved that is not proved yet; effort, no proof rests on it."""
TRIES = 7
"""How often a range that may hold all ends is widened; effort, no proof rests on it."""
PAD, LEAST_ROOM = 0.02, 1e-9
"""Room on either side of the ends at two corners, as a share of their distance and in rad."""
WIDEST = 1.5
"""rad: a range of ends beyond which nothing is tried."""
STEPS = 40
"""Of Newton's method for the end at one point, in plain numbers."""
SETTLED = 1e-5
"""rad: the next step of Newton's method is exact to about the square of it."""
LONGEST_STEP = 0.2
"""rad: of Newton's method, which may start far off."""
ULP = 2.0**-52
HUGE = 1e300
TINY = 5e-324

Signs = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Quadrature:
    """An integral over a clock that runs on the way."""

    rate: ca.SX
    clock: ca.SX
    """Symbol."""
    start: ca.SX
    stop: ca.SX
    """What the clock shows at the start and where the integral ends."""


@dataclass(frozen=True, slots=True, eq=False)
class Implicit:
    """Outputs of a motion, prepared for bounds over boxes."""

    parameters: tuple[str, ...]
    constants: tuple[str, ...]
    outputs: tuple[str, ...]
    history: Signs
    """(parameters,) which may change at every instant."""
    uses: Signs
    """(outputs, parameters) what an output depends on."""
    rate: Bounded
    """(parameters, constants, end, way) -> rates per share of the way, which is in [0, 1]."""
    curvature: Bounded
    """The same -> their second derivatives along the way."""
    rate_slopes: Bounded
    """The same -> rates, and their slopes in every parameter at a fixed clock."""
    residual: Bounded
    """(parameters, constants, end, integrals) -> residual, and its total slope in the end."""
    rough: Bounded
    """(parameters, constants, end) -> the same with midpoint sums for the integrals: no proof."""
    values: Bounded
    """(parameters, constants, end, integrals) -> outputs."""
    slopes: Bounded
    """(parameters, constants, end, integrals, their slopes at a fixed clock) -> slope of the residual in the end,
    in the parameters at a fixed end; total slopes of the outputs."""


@dataclass(frozen=True, slots=True, eq=False)
class Ends:
    """Proved bounds of the outputs over a box."""

    end: Interval
    lower: Mapping[str, float]
    upper: Mapping[str, float]


def implicit(
    name: str,
    parameters: Mapping[str, ca.SX],
    constants: Mapping[str, ca.SX],
    history: Sequence[str],
    end: ca.SX,
    integrals: Sequence[tuple[ca.SX, Quadrature]],
    residual: ca.SX,
    outputs: Mapping[str, ca.SX],
) -> Implicit:
    """Prepare a motion for bounds.

    Parameters
    ----------
    name
        For messages.
    parameters, constants
        Symbols by name; only for parameters can a range of more than rounding be afforded.
    history
        Parameters that may change at every instant; they enter integrands only.
    end
        Its symbol.
    integrals
        The symbol of each and what it is.
    residual
        Zero at the end.
    outputs
        What is wanted, by name.

    Returns
    -------
    Implicit
        With tapes of all derivatives.

    Raises
    ------
    ValueError
        A tape has no interval form.
    """
    p, c = ca.vertcat(*parameters.values()), ca.vertcat(*constants.values())
    total, way = ca.vertcat(*(symbol for symbol, _ in integrals)), ca.SX.sym("way")
    n, k = p.numel(), total.numel()
    y = ca.vertcat(*outputs.values())
    by_clock = ca.SX.sym("by_clock", k, n)
    rates, slopes, total_p, total_e = [], [], [], []
    for row, (_, integral) in enumerate(integrals):
        length = integral.stop - integral.start
        now = [integral.rate, ca.jacobian(integral.rate, p)]
        rate, slope = ca.substitute(now, [integral.clock], [integral.start + way * length])
        rates.append(length * rate)
        slopes.append(length * slope)
        first, last = (
            ca.substitute(integral.rate, integral.clock, at)
            for at in (integral.start, integral.stop)
        )
        moved = last * ca.jacobian(integral.stop, p) - first * ca.jacobian(integral.start, p)
        total_p.append(by_clock[row, :] + moved)
        total_e.append(last * ca.jacobian(integral.stop, end))
    integrand, by_end = ca.vertcat(*rates), ca.vertcat(*total_e)

    def along(of: ca.SX) -> ca.SX:
        return ca.jacobian(of, p) + ca.jacobian(of, total) @ ca.vertcat(*total_p)

    end_slope = ca.jacobian(residual, end) + ca.jacobian(residual, total) @ by_end
    residual_p = along(residual)
    end_p = -residual_p / end_slope
    y_p = along(y) + (ca.jacobian(y, end) + ca.jacobian(y, total) @ by_end) @ end_p
    here = (p, c, end, way)
    middles = MIDDLES[0].tolist()
    sums = ca.vertcat(*(ca.substitute(integrand, way, at).T for at in middles))
    about = ca.substitute([residual, end_slope], [total], [ca.sum1(sums).T / PIECES])
    bend = ca.jacobian(ca.jacobian(integrand, way), way)  # each rate by the way alone
    return Implicit(
        parameters=tuple(parameters),
        constants=tuple(constants),
        outputs=tuple(outputs),
        history=np.isin(list(parameters), list(history)),
        uses=_uses(y, residual, p, end, total, integrand),
        rate=_prepared(f"{name}: rate", here, (integrand,)),
        curvature=_prepared(f"{name}: curvature", here, (bend,)),
        rate_slopes=_prepared(
            f"{name}: slopes on the way", here, (integrand, ca.vertcat(*slopes).T)
        ),
        residual=_prepared(f"{name}: end", (p, c, end, total), (residual, end_slope)),
        rough=_prepared(f"{name}: about the end", (p, c, end), about),
        values=_prepared(f"{name}: outputs", (p, c, end, total), (y,)),
        slopes=_prepared(
            f"{name}: slopes",
            (p, c, end, total, by_clock.T),
            (end_slope, residual_p.T, y_p.T),
        ),
    )


def _uses(y: ca.SX, residual: ca.SX, p: ca.SX, end: ca.SX, total: ca.SX, integrand: ca.SX) -> Signs:
    """(outputs, parameters) structural dependence, also through integrals and the end."""

    def pattern(of: ca.SX, by: ca.SX) -> Signs:
        found = ca.DM(ca.jacobian_sparsity(of, by), 1.0)
        return np.array(ca.densify(found), dtype=bool).reshape(of.numel(), by.numel())

    inner = pattern(integrand, p)
    ends = pattern(residual, p) | pattern(residual, total) @ inner
    return pattern(y, p) | pattern(y, total) @ inner | pattern(y, end) @ ends


def _prepared(name: str, arguments: Sequence[ca.SX], results: Sequence[ca.SX]) -> Bounded:
    """For the natural extension, which needs no gradient."""
    inputs = ca.vertcat(*(ca.vec(part) for part in arguments))
    x = ca.vertcat(*(ca.densify(ca.vec(part)) for part in results))
    function = ca.Function("f", [inputs], [ca.cse(x)])
    tape = compile_tape(function)
    return Bounded(name, (), function, tape, tape)


@dataclass(frozen=True, slots=True, eq=False)
class _Rows:
    """Boxes of the parameters, a row each; the constants are the same in all of them."""

    lo: Floats
    hi: Floats
    constants: Floats
    """(2, constants)"""

    def columns(self, *more: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
        """Ends of the boxes as the tapes take them, followed by ``more``."""
        rows, inner = self.lo.shape
        known = inner + self.constants.shape[1]
        width = known + sum(low.size for low, _ in more) // rows
        both = np.empty((2, rows, width))
        both[0, :, :inner], both[1, :, :inner] = self.lo, self.hi
        both[:, :, inner:known] = self.constants[:, None, :]
        for ends in more:
            used = ends[0].size // rows
            both[0, :, known : known + used] = ends[0].reshape(rows, used)
            both[1, :, known : known + used] = ends[1].reshape(rows, used)
            known += used
        return both[0], both[1]

    def middles(self) -> _Rows:
        """One point of each box."""
        middle = 0.5 * (self.lo + self.hi)
        return _Rows(middle, middle, self.constants)

    def repeated(self, times: int) -> _Rows:
        """Every box so many times, one after the other."""
        return _Rows(np.repeat(self.lo, times, 0), np.repeat(self.hi, times, 0), self.constants)

    def some(self, rows: npt.NDArray[np.intp] | Signs) -> _Rows:
        """A selection."""
        return _Rows(self.lo[rows], self.hi[rows], self.constants)


def _over_way(
    of: Bounded, rows: _Rows, end: tuple[Floats, Floats], *, middle: bool
) -> tuple[Floats, Floats]:
    """(rows, PIECES, results) enclosures on every piece of the way, or at its middle."""
    count, inner = rows.lo.shape
    known = inner + rows.constants.shape[1]
    both = np.empty((2, count, PIECES, known + 2))
    both[0, :, :, :inner], both[1, :, :, :inner] = rows.lo[:, None], rows.hi[:, None]
    both[..., inner:known] = rows.constants[:, None, None]
    both[0, :, :, known], both[1, :, :, known] = end[0][:, None], end[1][:, None]
    both[0, :, :, -1], both[1, :, :, -1] = MIDDLES if middle else EVERY_PIECE
    lower, upper = enclose_many(of, *both.reshape(2, count * PIECES, known + 2), natural=True)
    return lower.reshape(count, PIECES, -1), upper.reshape(count, PIECES, -1)


def _mean(lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
    """Ends of the mean over axis 1, rounded outward: PIECES terms, and a power of 2 below."""
    size = np.add.reduce(np.abs(lower), 1) + np.add.reduce(np.abs(upper), 1)
    room = size * (ULP * (PIECES + 2)) + TINY
    whole = np.isfinite(room)
    with np.errstate(invalid="ignore"):
        least = (np.add.reduce(lower, 1) - room) / PIECES
        most = (np.add.reduce(upper, 1) + room) / PIECES
    return np.where(whole, least, -np.inf), np.where(whole, most, np.inf)


def _down(value: Floats) -> Floats:
    return value - (np.abs(value) * ULP + TINY)


def _up(value: Floats) -> Floats:
    return value + (np.abs(value) * ULP + TINY)


def _integrals(of: Implicit, rows: _Rows, end: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    """Enclose the integrals at points: midpoint sums with the second derivative on every piece."""
    lower, upper = _over_way(of.rate, rows, end, middle=True)
    bent = _over_way(of.curvature, rows, end, middle=False)
    # of a piece of length h = 1/PIECES: h f(middle) + h^3/24 f''
    share = 1.0 / (24.0 * PIECES**2)
    low = _down(lower + _down(_down(bent[0] * share) - np.abs(bent[0]) * ULP))
    high = _up(upper + _up(_up(bent[1] * share) + np.abs(bent[1]) * ULP))
    return _mean(low, high)


def _newton(of: Implicit, rows: _Rows, guess: Floats, *, exact: bool = False) -> Floats:
    """Ends at points, in plain numbers: a start for proofs. NaN where none is found.

    With ``exact`` a step more is made, with the errors of the midpoint sums taken off.
    """
    end = guess
    for _ in range(STEPS):
        low, high = enclose_many(of.rough, *rows.columns((end, end)), natural=True)
        end, largest = _stepped(end, low, high)
        if not SETTLED <= largest < np.inf:
            break
    if exact:
        total = _integrals(of, rows, (end, end))
        low, high = enclose_many(of.residual, *rows.columns((end, end), total), natural=True)
        end, _ = _stepped(end, low, high)
    return end


def _stepped(end: Floats, low: Floats, high: Floats) -> tuple[Floats, float]:
    with np.errstate(all="ignore"):
        step = (low[:, 0] + high[:, 0]) / (low[:, 1] + high[:, 1])
    return end - np.clip(step, -LONGEST_STEP, LONGEST_STEP), float(np.max(np.abs(step)))


def _residual(of: Implicit, rows: _Rows, end: Floats) -> tuple[Floats, Floats]:
    """Enclose the residual at points."""
    total = _integrals(of, rows, (end, end))
    low, high = enclose_many(of.residual, *rows.columns((end, end), total), natural=True)
    return low[:, 0], high[:, 0]


@dataclass(frozen=True, slots=True, eq=False)
class _Slopes:
    """Enclosures over rows of boxes; a row of the first axis each."""

    end: tuple[Floats, Floats]
    """(rows,) of the residual in the end."""
    residual: tuple[Floats, Floats]
    """(rows, parameters) of the residual at a fixed end."""
    outputs: tuple[Floats, Floats]
    """(rows, outputs, parameters)"""


def _slopes(of: Implicit, rows: _Rows, end: tuple[Floats, Floats]) -> _Slopes:
    count, n = rows.lo.shape
    k, m = of.curvature.values.outputs, len(of.outputs)
    lower, upper = _over_way(of.rate_slopes, rows, end, middle=False)
    total = _mean(lower[..., :k], upper[..., :k])
    lower, upper = lower[..., k:], upper[..., k:]
    low, high = _mean(lower, upper)
    # at every instant another value: one sign must hold on every piece, or absolute values count
    mixed = np.tile(of.history, k) & ~((lower >= 0.0).all(1) | (upper <= 0.0).all(1))
    most = np.maximum(np.abs(lower), np.abs(upper))
    _, most = _mean(most, most)
    low, high = np.where(mixed, -most, low), np.where(mixed, most, high)
    changing = np.tile(of.history, k) & (k > 1)
    # an instant may be on the way of one integral and not on that of another
    alone = (
        np.where(changing, np.minimum(low, 0.0), low),
        np.where(changing, np.maximum(high, 0.0), high),
    )
    found = enclose_many(of.slopes, *rows.columns(end, total, alone), natural=True)
    if changing.any():
        # without one sign for each of them, one may act against the other: sizes count, not the sum
        sizes = np.where(changing, -most, low), np.where(changing, most, high)
        apart = enclose_many(of.slopes, *rows.columns(end, total, sizes), natural=True)
        undecided = (found[0] < 0.0) & (found[1] > 0.0)
        found = np.where(undecided, apart[0], found[0]), np.where(undecided, apart[1], found[1])
    return _Slopes(
        end=(found[0][:, 0], found[1][:, 0]),
        residual=(found[0][:, 1 : n + 1], found[1][:, 1 : n + 1]),
        outputs=(
            found[0][:, n + 1 :].reshape(count, m, n),
            found[1][:, n + 1 :].reshape(count, m, n),
        ),
    )


def _reach(slopes: tuple[Floats, Floats], rows: _Rows) -> Floats:
    """(rows,) how far a value can be from that at the middle, by the mean value theorem."""
    middle = 0.5 * (rows.lo + rows.hi)
    half = np.maximum(_up(rows.hi - middle), _up(middle - rows.lo))
    half[rows.lo == rows.hi] = 0.0
    steepest = np.maximum(np.abs(slopes[0]), np.abs(slopes[1]))
    terms = np.where(half > 0.0, steepest * np.where(half > 0.0, half, 1.0), 0.0)
    return terms.sum(1) * (1.0 + ULP * (terms.shape[1] + 3)) + TINY


def bound(
    of: Implicit,
    box: Box,
    guess: float,
    *,
    both: Sequence[str] = (),
    lower: Sequence[str] = (),
    spare: Sequence[str] = (),
    proofs_only: bool = False,
) -> Ends | None:
    """Bound outputs over a box.

    Parameters
    ----------
    of
        The motion.
    box
        An interval for each parameter and constant.
    guess
        Where the end may be at the middle of the box: only where the search starts.
    both, lower, spare
        Outputs of which both bounds, or the lower one, are wanted; the last may well not be positive.
    proofs_only
        Give up, with None, as soon as one of ``lower`` is seen not to be positive everywhere.

    Returns
    -------
    Ends or None
        The ends of all motions, and the bounds wanted; None if no range was proved to hold all ends.

    Notes
    -----
    For every motion of the box the residual is proved to have one sign at one end of a range and the
    other sign at the other, and to be monotone in between: there is one end, and it lies there.
    """
    rows = _rows(of, box)
    middle = _finite_middle(of, rows, guess)
    if middle is None or (proofs_only and _refuted(of, rows, middle, lower)[0]):
        return None
    found = _all_ends(of, rows, middle)
    if found is None:
        return None
    return _bounded(of, rows, *found, both, (*lower, *spare))[0]


def bound_slices(
    of: Implicit,
    box: Box,
    guess: float,
    along: str,
    slices: Sequence[tuple[float, float]],
    both: Sequence[str],
) -> tuple[Ends, ...]:
    """Bound outputs over slices of a box, all of them at once.

    Parameters
    ----------
    of, box, guess, both
        As for `bound`.
    along, slices
        A parameter, and ends of the slices of its range.

    Returns
    -------
    tuple[Ends, ...]
        One a slice; none if no range was proved to hold all ends.
    """
    rows = _rows(of, box)
    middle = _finite_middle(of, rows, guess)
    found = None if middle is None else _all_ends(of, rows, middle)
    if found is None:
        return ()
    side, parts = of.parameters.index(along), rows.repeated(len(slices))
    parts.lo[:, side], parts.hi[:, side] = np.transpose(slices)
    return _bounded(of, parts, *found, both, ())


def _finite_middle(of: Implicit, rows: _Rows, guess: float) -> Floats | None:
    """The end at the middle of a box, in plain numbers."""
    if not (np.isfinite(rows.lo).all() and np.isfinite(rows.hi).all()):
        return None
    middle = _newton(of, rows.middles(), np.array([guess]))
    return middle if np.isfinite(middle[0]) else None


def at_middle(of: Implicit, box: Box, guess: float) -> dict[str, float]:
    """Outputs at the middle of a box, in plain numbers: for choosing, not for proofs.

    Parameters
    ----------
    of, box, guess
        As for `bound`.

    Returns
    -------
    dict
        By name, and the end as ``end``; NaN where there is none.
    """
    point = _rows(of, box).middles()
    end = _newton(of, point, np.array([guess]), exact=True)
    total = _integrals(of, point, (end, end))
    low, high = enclose_many(of.values, *point.columns((end, end), total), natural=True)
    with np.errstate(invalid="ignore"):
        values = 0.5 * (low[0] + high[0])
    return {"end": float(end[0]), **dict(zip(of.outputs, values.tolist(), strict=True))}


def _rows(of: Implicit, box: Box) -> _Rows:
    constants = [box[name] for name in of.constants]
    return _Rows(
        np.array([[box[name].lo for name in of.parameters]]),
        np.array([[box[name].hi for name in of.parameters]]),
        np.array([[side.lo for side in constants], [side.hi for side in constants]]),
    )


def refuted_along(
    of: Implicit, box: Box, guess: float, lower: Sequence[str], along: str, shifts: Floats
) -> Signs:
    """Whether `bound` would give up, with ``proofs_only``, if one parameter's range were elsewhere.

    Many at once take a small part of the time that one after the other does.

    Parameters
    ----------
    of, box, guess, lower
        As for `bound`.
    along
        A parameter that is not exactly zero.
    shifts
        (N,) what is added to its range.

    Returns
    -------
    Signs
        (N,) In plain numbers: no proof rests on it.
    """
    rows, side = _rows(of, box).repeated(len(shifts)), of.parameters.index(along)
    rows.lo[:, side] += shifts
    rows.hi[:, side] += shifts
    middle = _newton_each(of, rows.middles(), np.full(len(shifts), guess))
    found = ~np.isfinite(middle)
    left = np.flatnonzero(~found)
    if left.size:
        found[left] = _refuted(of, rows.some(left), middle[left], lower)
    return found


def _newton_each(of: Implicit, rows: _Rows, guess: Floats) -> Floats:
    """As `_newton`, where a point without an end does not keep the others from theirs."""
    end = _newton(of, rows, guess)
    left = np.isfinite(end)
    while left.any() and not left.all():
        end[left] = _newton(of, rows.some(left), end[left])
        if np.isfinite(end[left]).all():
            break
        left &= np.isfinite(end)
    return end


def _refuted(of: Implicit, rows: _Rows, at_middle: Floats, lower: Sequence[str]) -> Signs:
    """(rows,) whether an output is not positive at its least corner.

    In plain numbers: only so that no time is spent on proofs that are bound to fail.
    """
    corners, end = _least_corners(of, rows, at_middle, lower)
    total = _integrals(of, corners, (end, end))
    _, high = enclose_many(of.values, *corners.columns((end, end), total), natural=True)
    output = np.tile([of.outputs.index(name) for name in lower], len(at_middle))
    least = high[np.arange(len(output)), output].reshape(len(at_middle), -1)
    return ~(least > 0.0).all(1)


def _least_corners(
    of: Implicit, rows: _Rows, at_middle: Floats, outputs: Sequence[str]
) -> tuple[_Rows, Floats]:
    """For each row and output the corner where its slopes at the middle point to, and the end there."""
    here = _slopes(of, rows.middles(), (at_middle, at_middle))
    output = np.array([of.outputs.index(name) for name in outputs])
    count = len(at_middle) * len(output)
    slopes = [part[:, output].reshape(count, -1) for part in here.outputs]
    corners, _ = _collapsed(rows.repeated(len(output)), slopes, np.full((count, 1), -1))
    corners = corners.middles()
    return corners, _newton_each(of, corners, np.repeat(at_middle, len(output)))


def failing_point(of: Implicit, box: Box, guess: float, outputs: Sequence[str]) -> Box | None:
    """Find a point of a box at which an output is proved not to be positive.

    Parameters
    ----------
    of, box, guess
        As for `bound`.
    outputs
        Those that are to be positive.

    Returns
    -------
    Box or None
        The parameters there; None if the corners tried, one an output, show nothing.
    """
    rows = _rows(of, box)
    middle = _finite_middle(of, rows, guess)
    found = None if middle is None else _all_ends(of, rows, middle)
    if middle is None or found is None:
        return None
    corners, _ = _least_corners(of, rows, middle, outputs)
    bounds = _bounded(of, corners, *found, outputs, ())
    for output, corner, ends in zip(outputs, corners.lo.tolist(), bounds, strict=True):
        if ends.upper[output] <= 0.0:
            return dict(zip(of.parameters, map(Interval.point, corner), strict=True))
    return None


def _all_ends(
    of: Implicit, rows: _Rows, at_middle: Floats
) -> tuple[tuple[float, float], _Slopes] | None:
    """A range that is proved to hold the ends of all motions, and the slopes over the box.

    Beyond either end of the range the residual has one sign over all of the box, each its own: it is
    bounded like an output, at a fixed end.
    """
    here = _slopes(of, rows.middles(), (at_middle, at_middle))
    sign = 1 if here.end[0][0] > 0.0 else -1
    # the end is largest where the residual is smallest, if that grows with the end
    sides = np.array([sign, -sign])[:, None]
    corners, _ = _collapsed(rows.repeated(2), here.residual, sides)
    near = _newton(of, corners.middles(), np.repeat(at_middle, 2))
    room = PAD * abs(near[1] - near[0]) + LEAST_ROOM
    for again in range(TRIES):
        ends = np.array([near.min() - room, near.max() + room])
        if not np.isfinite(ends).all() or ends[1] - ends[0] > WIDEST:
            return None
        slopes = _slopes(of, rows, (ends[:1], ends[1:]))
        steep = float(np.minimum(np.abs(slopes.end[0]), np.abs(slopes.end[1]))[0])
        if not (slopes.end[0][0] > 0.0 or slopes.end[1][0] < 0.0):
            return None
        if _beyond(of, rows.repeated(2), ends, sides):
            return (float(ends[0]), float(ends[1])), slopes
        # what the mean value theorem grants from the middle on is more than enough
        reach = float(_reach(slopes.residual, rows)[0]) / steep if again else 0.0
        room = max(4.0 * room, min(1.1 * reach, WIDEST))
    return None


def _beyond(of: Implicit, rows: _Rows, ends: Floats, sides: npt.NDArray[np.int_]) -> bool:
    """Whether the residual at the first (last) of these ends is proved to lie before (beyond) zero."""
    for _ in range(2):
        slopes = _slopes(of, rows, (ends, ends))
        rows, moved = _collapsed(rows, slopes.residual, sides)
        if not moved.any() or (rows.lo == rows.hi).all():
            break
    low, high = _residual(of, rows.middles(), ends)
    reach = _reach(slopes.residual, rows)
    low, high = _down(low - reach), _up(high + reach)
    return bool(high[0] < 0.0 < low[1] if sides[0] > 0 else low[0] > 0.0 > high[1])


@dataclass(frozen=True, slots=True, eq=False)
class _Sought:
    """Extremes that are sought, a row each, and what is known of them."""

    output: npt.NDArray[np.intp]
    side: npt.NDArray[np.intp]
    """-1: the least value, 1: the largest."""
    rows: _Rows
    """Where it is sought."""

    def some(self, rows: Signs) -> _Sought:
        """A selection."""
        return _Sought(self.output[rows], self.side[rows], self.rows.some(rows))


def _bounded(
    of: Implicit,
    boxes: _Rows,
    ends: tuple[float, float],
    slopes: _Slopes,
    both: Sequence[str],
    lower: Sequence[str],
) -> tuple[Ends, ...]:
    """The faces of every box at which the outputs are extreme, and the outputs there."""
    wanted = [(of.outputs.index(name), side) for name in both for side in (-1, 1)]
    wanted += [(of.outputs.index(name), -1) for name in lower]
    count = len(boxes.lo)
    output, side = np.tile(np.array(wanted).T, count)
    part = np.repeat(np.arange(count), len(wanted))
    margin = np.isin(output, [of.outputs.index(name) for name in lower])
    least = np.full((count, len(of.outputs)), np.inf)
    most = np.full((count, len(of.outputs)), -np.inf)
    sought = _Sought(output, side, boxes.repeated(len(wanted)))
    for again in range(CUTS + 1):
        value, middle, weight = _extremes(of, sought, ends, slopes)
        cut = (value <= 0.0) & (middle > 0.0) & margin & (again < CUTS)
        below = (sought.side < 0) & ~cut
        np.minimum.at(least, (part[below], sought.output[below]), value[below])
        above = sought.side > 0
        np.maximum.at(most, (part[above], sought.output[above]), value[above])
        # once one part of a box is undecided for good, the rest cannot help
        hopeless = cut & (least[part, sought.output] <= 0.0)
        least[part[hopeless], sought.output[hopeless]] = -np.inf
        cut &= ~hopeless
        if not cut.any():
            break
        sought, part = _halves(sought.some(cut), weight[cut]), np.repeat(part[cut], 2)
        margin = np.repeat(margin[cut], 2)
    names = of.outputs
    return tuple(
        Ends(
            end=Interval(*ends),
            lower={name: _or(least[k, names.index(name)], -np.inf) for name in (*both, *lower)},
            upper={name: _or(most[k, names.index(name)], np.inf) for name in both},
        )
        for k in range(count)
    )


def _halves(sought: _Sought, weight: Floats) -> _Sought:
    """Every box cut in two where that matters most."""
    rows = sought.rows.repeated(2)
    first, widest = np.arange(0, 2 * len(weight), 2), weight.argmax(1)
    middle = 0.5 * (rows.lo[first, widest] + rows.hi[first, widest])
    rows.hi[first, widest] = middle
    rows.lo[first + 1, widest] = middle
    return _Sought(np.repeat(sought.output, 2), np.repeat(sought.side, 2), rows)


def _extremes(
    of: Implicit, sought: _Sought, ends: tuple[float, float], slopes: _Slopes
) -> tuple[Floats, Floats, Floats]:
    """(rows,) bounds, values at a point that are no worse, and (rows, parameters) what is undecided.

    ``slopes`` are those over a box that holds all of the rows.
    """
    output, side, rows = sought.output, sought.side[:, None], sought.rows
    count = len(output)
    residual = [np.repeat(part, count, 0) for part in slopes.residual]
    here = [part[0, output] for part in slopes.outputs]
    steep = [np.full(count, part[0]) for part in slopes.end]
    within = [np.full(count, end) for end in ends]
    start, open_ = np.full(count, 0.5 * (ends[0] + ends[1])), np.ones(count, dtype=bool)
    weight = np.zeros_like(rows.lo)
    for again in range(ROUNDS):
        rows, moved = _collapsed(rows, here, side)
        # an output whose box has not shrunk further, or is a point, will not be known any better
        weight = np.maximum(np.abs(here[0]), np.abs(here[1]))
        width = rows.hi - rows.lo
        weight = np.where(width > 0.0, np.minimum(weight, HUGE) * width, 0.0)
        open_ &= (weight > 0.0).any(1) & (moved | (again == 0))
        if again == ROUNDS - 1 or not open_.any():
            break
        some = rows.some(open_)
        start[open_] = _newton(of, some.middles(), start[open_])
        known = within[0][open_], within[1][open_]
        slope = steep[0][open_], steep[1][open_]
        at = _end_at(of, some.middles(), start[open_], known, slope)
        reach = _reach((residual[0][open_], residual[1][open_]), some)
        reach = _up(reach / np.minimum(np.abs(slope[0]), np.abs(slope[1])))
        low = np.maximum(_down(at[0] - reach), known[0])
        high = np.minimum(_up(at[1] + reach), known[1])
        closer = _slopes(of, some, (low, high))
        index = np.arange(len(some.lo)), output[open_]
        for part in (0, 1):
            here[part][open_] = closer.outputs[part][index]
            residual[part][open_] = closer.residual[part]
            steep[part][open_] = closer.end[part]
            within[part][open_] = (low, high)[part]
    points = rows.middles()
    start = _newton(of, points, start, exact=True)
    at = _end_at(of, points, start, (within[0], within[1]), (steep[0], steep[1]))
    low, high = enclose_many(
        of.values, *points.columns(at, _integrals(of, points, at)), natural=True
    )
    reach, index = _reach((here[0], here[1]), rows), (np.arange(count), output)
    upper = sought.side > 0
    return (
        np.where(upper, _up(high[index] + reach), _down(low[index] - reach)),
        np.where(upper, low[index], high[index]),
        weight,
    )


def _or(value: float, otherwise: float) -> float:
    return float(value) if np.isfinite(value) else otherwise


def _collapsed(
    rows: _Rows, slopes: Sequence[Floats], side: npt.NDArray[np.intp]
) -> tuple[_Rows, Signs]:
    """Every parameter of one sign at the end where the output is least (side -1) or most (1)."""
    rises, falls = slopes[0] >= 0.0, slopes[1] <= 0.0
    to_hi = (rises & (side > 0)) | (falls & (side < 0))
    to_lo = ((falls & (side > 0)) | (rises & (side < 0))) & ~to_hi
    lo, hi = np.where(to_hi, rows.hi, rows.lo), np.where(to_lo, rows.lo, rows.hi)
    moved = ((lo != rows.lo) | (hi != rows.hi)).any(1)
    return _Rows(lo, hi, rows.constants), moved


def _end_at(
    of: Implicit,
    points: _Rows,
    near: Floats,
    ends: tuple[Floats, Floats],
    slope: tuple[Floats, Floats],
) -> tuple[Floats, Floats]:
    """Enclose the ends at points, known to be in ``ends``, where the residual has this slope."""
    near = np.clip(np.where(np.isfinite(near), near, 0.5 * (ends[0] + ends[1])), *ends)
    low, high = _residual(of, points, near)
    with np.errstate(all="ignore"):
        quotients = np.stack([-top / below for top in (low, high) for below in slope])
        room = np.abs(quotients) * (2.0 * ULP) + TINY
        nearer = _down(near + (quotients - room).min(0)), _up(near + (quotients + room).max(0))
    return (
        np.where(nearer[0] >= ends[0], nearer[0], ends[0]),
        np.where(nearer[1] <= ends[1], nearer[1], ends[1]),
    )
