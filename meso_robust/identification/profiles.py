"""Profile likelihood: how far a parameter can move while all others follow.

A parameter is held at a value and everything else refitted; χ² then rises by Δ. By Wilks' theorem
(doi:10.1214/aoms/1177732360) the values with Δ below the quantile of χ² with one degree of freedom
form a confidence interval. Where Δ never gets there before the range of the parameter ends, the
interval is open on that side: the recordings give no bound. χ² has kinks where a contact begins to
slip, and dips between them: what lies beyond the end of a dip is looked at as well.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import chi2 as chi2_law

from meso_robust.identification.likelihood import Fits, Fitted, Settings, fit
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared
from meso_robust.types import Flags, Floats

CONFIDENCE = 0.9
"""Default probability with which an interval covers."""
_ROUNDS = 8  # most values that are tried on one side of a parameter
_CLOSE = 0.12  # relative distance from the quantile (as a root) from which a line is good enough
_FITS = 8  # most iterations of a fit with one parameter held
_BETTER = 0.5  # fall of χ² that shows that the fit was not the best one
_BEYOND = (2.0, 4.0, 8.0, 16.0)  # times the distance of an end, where it is looked for another dip
_DIPS = 3  # most that are gone through


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Profile:
    """One parameter.

    Attributes
    ----------
    key
        Its name.
    value, low, high
        Best value and the ends of the interval, SI.
    open_low, open_high
        Whether the recordings give no bound there: `low` or `high` is then the end of the range.
    curve
        (M, 2) values in SI and Δ over the inflation, in the order of the values.
    """

    key: str
    value: float
    low: float
    high: float
    open_low: bool
    open_high: bool
    curve: Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Profiled:
    """Profiles of all fitted parameters; `better` (n,) is a vector found that fits better, or None."""

    profiles: tuple[Profile, ...]
    better: Floats | None


@dataclass(slots=True)
class _Side:
    """The search along one parameter to one side; distances in coordinates, t = √(Δ / inflation)."""

    column: int
    sign: float
    trial: float
    limit: float
    inner: tuple[float, float] = (0.0, 0.0)
    outer: tuple[float, float] | None = None
    points: list[tuple[float, float]] = field(default_factory=list)
    done: bool = False
    open: bool = False


def profiled(
    prepared: Prepared,
    model: Model,
    settings: Settings,
    best: Fitted,
    *,
    confidence: float = CONFIDENCE,
    inflation: float = 1.0,
) -> Profiled:
    """Profiles of the fitted parameters about the best fit, all sides in common batches.

    Parameters
    ----------
    prepared, model, settings
        As in `likelihood.fit`.
    best
        The best fit, one only.
    confidence
        Probability with which each interval shall cover.
    inflation
        By how much more χ² varies than white noise of the stated σ lets it.
    """
    root = float(np.sqrt(chi2_law.ppf(confidence, 1)))
    quick = settings.by_chord(_FITS, settings.flat)
    centre = model.coordinates(best.fits.values)[0]
    slopes, widths = _conditionals(best.information[0], model.fitted)
    sides = [
        _Side(
            int(k), sign, root * np.sqrt(inflation) * widths[k], _room(model, centre, int(k), sign)
        )
        for k in np.flatnonzero(model.fitted)
        for sign in (-1.0, 1.0)
    ]
    for side in sides:
        side.trial = min(side.trial, side.limit)
        side.done = side.open = side.limit <= 0.0
    lowest, better = -_BETTER, None

    def rises(trials: list[_Side]) -> list[tuple[float, float]]:
        """Distance and t of each trial, all others following."""
        nonlocal lowest, better
        values = np.stack([_placed(model, best.fits.values[0], slopes, side) for side in trials])
        held = np.zeros(values.shape, dtype=bool)
        held[np.arange(len(trials)), [side.column for side in trials]] = True
        found = fit(
            prepared,
            model,
            values,
            quick,
            starts=best.fits.starts[0],
            offsets=best.fits.offsets[0],
            held=held,
            jacobian=best.jacobian,
        ).fits
        rise = found.chi2 - best.fits.chi2[0]
        if rise.min() < lowest:
            lowest, better = float(rise.min()), found.values[int(np.argmin(rise))]
        reached = np.abs(model.coordinates(found.values) - centre)
        roots = np.sqrt(np.maximum(rise, 0.0) / inflation)
        return [
            (float(of[one.column]), float(t))
            for one, of, t in zip(trials, reached, roots, strict=True)
        ]

    _search(sides, rises, root)
    columns = np.flatnonzero(model.fitted)
    pairs = zip(sides[::2], sides[1::2], strict=True)
    made = [
        _profile(model, best.fits, centre, int(k), pair, root)
        for k, pair in zip(columns, pairs, strict=True)
    ]
    return Profiled(profiles=tuple(made), better=better)


def _search(
    sides: list[_Side], rises: Callable[[list[_Side]], list[tuple[float, float]]], root: float
) -> None:
    """Find the end of every side, and go on where there is another dip beyond it."""
    for _ in range(_DIPS):
        for _ in range(_ROUNDS):
            active = [side for side in sides if not side.done]
            if not active:
                break
            for side, (distance, t) in zip(active, rises(active), strict=True):
                _advance(side, distance, t, root)
        far = [one for side in sides if not side.open for one in _beyond(side, root)]
        found = rises([trial for _, trial in far]) if far else []
        for (side, trial), (distance, t) in zip(far, found, strict=True):
            if t < root and trial.trial > side.inner[0]:
                side.inner, side.outer, side.done = (distance, t), None, False
                side.trial = min(1.5 * distance, side.limit)
                side.points.append(side.inner)
        if all(side.done for side in sides):
            break


def _beyond(side: _Side, root: float) -> list[tuple[_Side, _Side]]:
    """The side, and trials of its own beyond where it ended."""
    end = _crossing(side, root)
    return [
        (side, replace(side, trial=share * end, points=[]))
        for share in _BEYOND
        if 0.0 < share * end < side.limit
    ]


def _conditionals(information: Floats, fitted: Flags) -> tuple[Floats, Floats]:
    """How all others follow a parameter (n, n), row by row, and its standard deviation (n,)."""
    n = len(information)
    slopes, widths = np.eye(n), np.full(n, np.inf)
    columns = np.flatnonzero(fitted)
    for k in columns:
        rest = columns[columns != k]
        inverse = np.linalg.pinv(information[np.ix_(rest, rest)], rcond=1e-12, hermitian=True)
        follow = -inverse @ information[rest, k]
        slopes[k, rest] = follow
        left = information[k, k] + information[k, rest] @ follow
        widths[k] = 1.0 / np.sqrt(left) if left > 1e-12 else np.inf
    return slopes, widths


def _room(model: Model, centre: Floats, column: int, sign: float) -> float:
    """Distance in coordinates to the end of the range of a parameter; at most a large number."""
    parameter = model.parameters[column]
    end = np.array([p.scale for p in model.parameters])
    end[column] = parameter.high if sign > 0.0 else parameter.low
    away = float(model.coordinates(end[None])[0, column]) if np.isfinite(end[column]) else np.inf
    return float(min(max(sign * (away - centre[column]), 0.0), 20.0))


def _placed(model: Model, values: Floats, slopes: Floats, side: _Side) -> Floats:
    """A valid vector with one parameter moved and the others following, as far as they may."""
    low = np.array([parameter.low for parameter in model.parameters])
    high = np.array([parameter.high for parameter in model.parameters])
    centre, alone = model.coordinates(values[None]), np.eye(len(values))[side.column]
    distance = side.trial
    for _ in range(30):
        for way in (slopes[side.column], alone):
            moved = np.clip(model.values(centre + side.sign * distance * way)[0], low, high)
            moved = np.where(way == 0.0, values, moved)
            if model.valid(moved[None])[0]:
                return np.asarray(moved)
        # the constraint ends the range before its stated end does
        distance = side.inner[0] + 0.7 * (distance - side.inner[0])
        side.limit = distance
    return values


def _advance(side: _Side, distance: float, t: float, root: float) -> None:
    """Take a value in, and choose the next one to try."""
    side.points.append((distance, t))
    if t >= root:
        side.outer = (distance, t)
    else:
        side.inner = (distance, t)
    if abs(t - root) < _CLOSE * root:
        side.done = True
    elif side.outer is None:
        side.done = side.open = distance >= side.limit * (1.0 - 1e-9)
        guess = distance * (1.05 * root / t if t > 0.0 else 4.0)
        side.trial = min(max(guess, 1.5 * distance), 4.0 * distance, side.limit)
    else:
        (a, ta), (b, tb) = side.inner, side.outer
        share = np.clip((root - ta) / max(tb - ta, 1e-12), 0.1, 0.9)
        side.trial = a + float(share) * (b - a)


def _crossing(side: _Side, root: float) -> float:
    """Distance at which t reaches the root last, by a line through the nearest point and its neighbour."""
    every = sorted({(0.0, 0.0), *side.points})
    last = every.index(side.inner)  # before it χ² may have reached the root, and come back
    points = every[max(last - 1, 0) :]
    distance, t = np.array(points).T
    nearest = 1 + int(np.argmin(np.abs(t[1:] - root)))
    other = nearest - 1
    if t[nearest] < root and nearest + 1 < len(t):
        other = nearest + 1
    rise = t[nearest] - t[other]
    if rise * (distance[nearest] - distance[other]) <= 0.0:
        return float(distance[nearest])
    slope = (distance[nearest] - distance[other]) / rise
    return float(min(max(distance[nearest] + slope * (root - t[nearest]), 0.0), side.limit))


def _profile(
    model: Model, best: Fits, centre: Floats, column: int, pair: tuple[_Side, _Side], root: float
) -> Profile:
    def at(distances: Floats) -> Floats:
        coordinates = np.tile(centre, (len(distances), 1))
        coordinates[:, column] += distances
        return np.asarray(model.values(coordinates)[:, column])

    low, high = pair
    ends = [
        side.sign * (side.limit if side.open else _crossing(side, root)) for side in (low, high)
    ]
    points = [(s.sign * d, t) for s in pair for d, t in s.points]
    table = np.array(sorted([(0.0, 0.0), *points]))
    left, right = at(np.array(ends))
    return Profile(
        key=model.keys[column],
        value=float(best.values[0, column]),
        low=float(left),
        high=float(right),
        open_low=low.open,
        open_high=high.open,
        curve=np.column_stack([at(table[:, 0]), table[:, 1] ** 2]),
    )
