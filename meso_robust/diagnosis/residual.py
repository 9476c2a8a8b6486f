"""A residual law for what has no name: a few bases of a hidden wrench, chosen by recordings that agree.

Where the catalogue leaves a mismatch, a sparse regression looks for the few bases of
`simulator.residual` that predict it. The regression is in what the camera sees, not in differentiated
poses: each base's effect on the predictions, with starts and parameters free to follow. Bases are added
one by one (orthogonal matching pursuit, doi:10.1109/TIT.2007.909108) on random halves of the
recordings, and only those are taken that most halves choose (stability selection, N. Meinshausen and
P. Bühlmann 2010, doi:10.1111/j.1467-9868.2010.00740.x; halves in complementary pairs, R. D. Shah and
R. J. Samworth 2013, doi:10.1111/j.1467-9868.2011.01034.x).

What the law is worth is told by roll-outs of recordings that saw neither the choice nor the fit: bases
are chosen again for every fold, without it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.diagnosis.folds import Bench, RollOut, intervals_by_fold, rolled_out, weights_of
from meso_robust.diagnosis.tangent import CONFIDENCE, Interval
from meso_robust.diagnosis.trials import typical_speed
from meso_robust.identification.likelihood import fit
from meso_robust.identification.models import Model, with_effects
from meso_robust.identification.prepared import Prepared
from meso_robust.identification.problem import Problem
from meso_robust.simulator.residual import BASES, RESIDUAL
from meso_robust.types import Floats, Ints

NAME = "residual"
"""Of the term in ``model.toml``."""
_HALVES = 50  # pairs of random halves
_MOST_BASES = 4  # that a half of the recordings chooses
# of the halves, that must choose a base: of 30 bases, 4 a half, at most 4² / (30 (2 · 0.75 − 1)) = 1.1
# are expected to be chosen by chance
_STABLE = 0.75
_FEWEST = 6  # recordings of which halves can be drawn
_CHANGE = 0.02  # of the motion, by which a base is changed to see what it does
_RESAMPLED = 4000
_WORTH = 0.05  # of the mean square error, that a law must take out of fold to be offered


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResidualLaw:
    """A sum of bases that predicts what no named effect explains; no name of a cause.

    Attributes
    ----------
    chosen
        Share of the halves that chose a base, of those of the law that all recordings choose.
    model, values
        The model it was added to, with it; (n,) in SI.
    intervals
        Of its fitted numbers, by leaving out one fold at a time.
    poses, outcomes
        (R, T, 3) and (R,) of the roll-outs, NaN where nothing was seen.
    metres, radians
        Root mean square errors out of fold without and with it.
    fall
        Share of the mean square error beyond the camera's noise that it takes out of fold, with the
        ends of its interval by bootstrap over recordings.
    offered
        Whether the interval is above nothing, and the fall of use.
    """

    chosen: Mapping[str, float]
    model: Model
    values: Floats
    intervals: tuple[Interval, ...]
    poses: Floats
    outcomes: Ints
    metres: tuple[float, float]
    radians: tuple[float, float]
    fall: tuple[float, float, float]
    offered: bool

    @property
    def bases(self) -> tuple[Interval, ...]:
        """Coefficients of the bases."""
        return tuple(one for one in self.intervals if one.key.partition(".")[0] == NAME)


def residual_law(bench: Bench, before: RollOut, seed: int) -> ResidualLaw | None:
    """Look for a residual law beyond a model.

    Parameters
    ----------
    bench
        All recordings.
    before
        Roll-outs of the model that the law is added to.
    seed
        Of halves and intervals.

    Returns
    -------
    ResidualLaw or None
        None where there are too few recordings, or no base is chosen by most halves.
    """
    if len(bench.fold) < _FEWEST:
        return None
    scales = _scales(bench.prepared)
    system = _system(bench, before, scales)
    everything = np.arange(len(bench.fold))
    shares = _stability(system, everything, seed)
    chosen = _stable(shares)
    if not chosen:
        return None
    sets: dict[tuple[str, ...], list[int]] = {}
    for k in range(bench.count):
        rest = np.flatnonzero(bench.fold != k)
        sets.setdefault(_stable(_stability(system, rest, seed)), []).append(k)
    whole = _rolled(bench, before, chosen, scales)
    squares, poses, outcomes = before.squares.copy(), before.poses.copy(), before.outcomes.copy()
    for names, folds in sets.items():
        if not names:
            continue
        found = whole if names == chosen else _rolled(bench, before, names, scales)
        rows = np.isin(bench.fold, folds)
        squares[rows], poses[rows] = found.squares[rows], found.poses[rows]
        outcomes[rows] = found.outcomes[rows]
    fall = _fall(bench, before, squares, seed)
    return ResidualLaw(
        chosen={key: float(shares[BASES.index(key)]) for key in chosen},
        model=whole.model,
        values=whole.values,
        intervals=intervals_by_fold(whole),
        poses=poses,
        outcomes=outcomes,
        metres=(_metres(bench, before.poses), _metres(bench, poses)),
        radians=(_radians(bench, before.poses), _radians(bench, poses)),
        fall=fall,
        offered=fall[1] > 0.0 and fall[0] >= _WORTH,
    )


def _scales(prepared: Prepared) -> dict[str, float]:
    """Typical changes of the coefficients, in their units."""
    speed, length = typical_speed(prepared), prepared.length
    time = float(np.median(np.ptp(prepared.instants, axis=1)))
    sizes = {
        "": 1.0,
        "µm": length,
        "µm/s": speed,
        "1/s": speed / length,
        "µm/s²": speed / time,
        "µm²/s": speed * length,
    }
    return {
        one.key: _CHANGE * sizes[one.unit] / one.to_si for one in RESIDUAL.effects[0].parameters
    }


def _with_law(before: RollOut, names: tuple[str, ...], scales: Mapping[str, float]) -> Model:
    return with_effects(before.model, {NAME: {key: scales[key] for key in names}})


@dataclass(frozen=True, slots=True, eq=False)
class _System:
    """Normal equations by recording, the starts following."""

    normal: Floats
    """(R, n, n)"""
    slope: Floats
    """(R, n)"""
    own: int
    """How many of the n are the model's own parameters, the first ones."""


def _system(bench: Bench, before: RollOut, scales: Mapping[str, float]) -> _System:
    """What every base does to the predictions about the model's fit."""
    settings = bench.baseline.settings.by_chord(8, 0.05)
    weights = weights_of(bench, before.model, before.values)
    prepared = replace(bench.prepared, weights=weights)
    held = np.ones(len(before.values), dtype=bool)
    plain = fit(prepared, before.model, before.values[None], settings, held=held).fits
    model = _with_law(before, BASES, scales)
    problem = Problem(prepared, model, replace(settings, central=True))
    values = np.append(before.values, np.zeros(len(BASES)))[None]
    fits = problem.at(values, plain.starts, plain.offsets)
    spans = np.full(values.shape, 0.1)
    spans[:, held.size :] = 1.0
    jacobian = problem.jacobian(fits, spans, model.fitted[None])
    arrow = problem.arrow(fits, jacobian)
    each = [
        replace(arrow, normal=arrow.normal[:, [r]], slope=arrow.slope[:, [r]])
        for r in range(len(bench.fold))
    ]
    return _System(
        np.stack([one.information()[0] for one in each]),
        np.stack([one.gradients()[0, 0] for one in each]),
        len(held),
    )


def _stability(system: _System, rows: Ints, seed: int) -> Floats:
    """(J,) share of the halves of some recordings that choose a base."""
    rng = np.random.default_rng([seed, 7])
    count = np.zeros(len(BASES))
    for _ in range(_HALVES):
        order = rng.permutation(rows)
        for half in (order[: len(rows) // 2], order[len(rows) // 2 :]):
            count[_pursued(system, half)] += 1.0
    return count / (2 * _HALVES)


def _pursued(system: _System, rows: Ints) -> list[int]:
    """Bases that explain most of some recordings, one after the other."""
    normal, slope = system.normal[rows].sum(axis=0), system.slope[rows].sum(axis=0)
    size = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    normal, slope = normal / np.outer(size, size), slope / size
    active = list(range(system.own))
    for _ in range(_MOST_BASES):
        inverse = np.linalg.pinv(normal[np.ix_(active, active)], rcond=1e-9, hermitian=True)
        cross = normal[:, active] @ inverse
        left = slope - cross @ slope[active]
        free = np.diag(normal) - np.sum(cross * normal[:, active], axis=1)
        # a base that the others imitate tells nothing: its own part is rounding
        gain = np.where(free > 1e-3, left**2 / np.maximum(free, 1e-3), 0.0)
        gain[active] = 0.0
        active.append(int(np.argmax(gain)))
    return [k - system.own for k in active[system.own :]]


def _stable(shares: Floats) -> tuple[str, ...]:
    return tuple(key for key, share in zip(BASES, shares, strict=True) if share >= _STABLE)


def _rolled(
    bench: Bench, before: RollOut, names: tuple[str, ...], scales: Mapping[str, float]
) -> RollOut:
    values = np.append(before.values, np.zeros(len(names)))
    return rolled_out(bench, _with_law(before, names, scales), values)


def _fall(bench: Bench, before: RollOut, squares: Floats, seed: int) -> tuple[float, float, float]:
    """Share of the squared error beyond the noise that goes, with its interval over recordings."""
    was, now = before.squares.sum(axis=(1, 2)), squares.sum(axis=(1, 2))
    noise = bench.seen.sum(axis=(1, 2)) * (1.0 + before.start_squares)
    drawn = np.random.default_rng([seed, 8]).integers(0, len(was), (_RESAMPLED, len(was)))
    floor = 1e-3 * float(was.sum())  # the noise cannot be all of an error that is to be explained
    gone = (was - now)[drawn].sum(axis=1) / np.maximum((was - noise)[drawn].sum(axis=1), floor)
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = np.quantile(gone, [tail, 1.0 - tail])
    share = float((was - now).sum() / max((was - noise).sum(), floor))
    return share, min(float(low), share), max(float(high), share)


def _metres(bench: Bench, poses: Floats) -> float:
    away = bench.prepared.seen[..., :2] - poses[..., :2]
    return float(np.sqrt(np.nanmean(np.sum(away**2, axis=2))))


def _radians(bench: Bench, poses: Floats) -> float:
    return float(np.sqrt(np.nanmean((bench.prepared.seen[..., 2] - poses[..., 2]) ** 2)))
