"""Linear explanations of a residual, and tests of them by the signs of whole recordings.

Frames of one recording err together, so a recording is the unit of chance: under the hypothesis that
an effect is not there, the signs of the residuals of whole recordings are arbitrary, and the score of
its columns is compared with scores under flipped signs (Cameron, Gelbach and Miller 2008,
doi:10.1162/rest.90.3.414). The largest score of all effects is compared with the largest under each
flip, so that trying many does not find one (Westfall and Young 1993). So is the criterion of the best of all sets:
of a hundred sets one explains a few recordings well, and each member stands the test beside the others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from meso_robust.recordings.direct.finding import Estimate, Finding
from meso_robust.types import Floats, Ints

FLIPS = 999
LEVEL = 0.05
"""Family-wise p-value up to which an effect is taken."""
_GAIN = 0.03  # share of the residual that an effect must remove: less is of no use to anybody
_ALIKE = 2.0  # of the information criterion, within which another set is hardly distinguishable
_HUBER = 2.0  # robust standard deviations beyond which a frame counts less
_PASSES = 4
_NORMAL = 1.4826
_EACH = 2  # recordings for each number of a set: what half as many tell, they tell by chance
_EITHER = (
    frozenset({"tip_radius", "part_geometry"}),
    frozenset({"camera_scale", "camera_anisotropy"}),
)
"""Effects of which one holds the other: together they only cancel."""
_T90 = (6.31, 2.92, 2.35, 2.13, 2.02, 1.94, 1.89, 1.86, 1.83, 1.81)  # Student, 1 … 10 degrees


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Comparison:
    """Rows of a test as the files have them, and with what was found taken out.

    Attributes
    ----------
    recording
        (n,) number of the recording of each row.
    before, after
        (n,) in m.
    findings
        What explains them.
    """

    recording: Ints
    before: Floats
    after: Floats
    findings: tuple[Finding, ...]

    @property
    def rms(self) -> tuple[float, float]:
        """Root mean square in m, far frames clipped, before and after."""
        return spread(self.before), spread(self.after)


@dataclass(frozen=True, slots=True, eq=False)
class Columns:
    """An effect as columns of a linear fit.

    Attributes
    ----------
    keys
        Names of its m numbers, in the unit that a column is the derivative for.
    values
        (n, m) what each of n rows changes by, per unit.
    """

    keys: tuple[str, ...]
    values: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """An effect that was taken: robust deviations without and with it, p-value, what is alike."""

    effect: str
    before: float
    after: float
    p_value: float
    alike: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Selection:
    """The set of effects that explains most for its size.

    Attributes
    ----------
    steps
        One an effect, all others being in the fit.
    estimates
        By effect, of the fit with all of them.
    residual
        (n,) what is left.
    """

    steps: tuple[Step, ...]
    estimates: Mapping[str, tuple[Estimate, ...]]
    residual: Floats


def spread(values: Floats) -> float:
    """Root mean square with far values clipped at three robust deviations."""
    if not values.size:
        return 0.0
    most = 3.0 * max(_NORMAL * float(np.median(np.abs(values))), 1e-300)
    return float(np.sqrt(np.mean(np.clip(values, -most, most) ** 2)))


def selected(
    values: Floats,
    groups: Ints,
    candidates: Mapping[str, Columns],
    possible: Callable[[str, str, float], bool],
    fixed: tuple[str, ...] = (),
    most: int = 4,
) -> Selection:
    """The set of effects with the least information criterion whose members chance does not explain.

    All sets are compared: one effect at a time, a mixture of three goes unseen, as each alone stands
    against the noise of the others. Far frames weigh as in the fit of all effects together.

    Parameters
    ----------
    values
        (n,) what should be zero.
    groups
        (n,) number of the recording of each row, 0 … K - 1.
    candidates
        Effects by name.
    possible
        Tells whether effect, key, value are within physical ranges; a set with others is passed over.
    fixed
        Effects that are in every set.
    most
        Effects of a set at most.

    Returns
    -------
    Selection
        May be empty.
    """
    names = [name for name in candidates if name not in fixed]
    weights, _ = _robust(_stacked(values, candidates, list(candidates)), values)
    problem = _Problem(values, weights, groups, candidates)
    sets = [
        (*fixed, *chosen)
        for count in range(most + 1 - len(fixed))
        for chosen in combinations(names, count)
        if not any(pair <= {*fixed, *chosen} for pair in _EITHER)
        and (not chosen or _EACH * problem.numbers((*fixed, *chosen)) <= problem.recordings)
    ]
    costs = {one: cost for one in sets if (cost := problem.cost(one, possible)) is not None}
    chosen: tuple[str, ...] = min(costs, key=lambda one: (costs[one], len(one)), default=())
    if len(chosen) > len(fixed) and problem.by_chance(chosen, sets, fixed) > LEVEL:
        chosen = tuple(fixed)
    while True:
        p_values = {name: problem.p_value(chosen, name) for name in chosen if name not in fixed}
        worst = max(p_values, key=lambda name: p_values[name], default=None)
        if worst is None or p_values[worst] <= LEVEL:
            break
        chosen = tuple(name for name in chosen if name != worst)
    estimates, residual = fitted(values, groups, {name: candidates[name] for name in chosen})
    steps = []
    for name in p_values:
        others = [other for other in chosen if other != name]
        without = spread(_robust(_stacked(values, candidates, others), values)[1])
        alike = tuple(
            other
            for other in names
            if other not in chosen
            and costs.get(_ordered((*others, other), candidates, fixed), np.inf)
            < costs.get(chosen, -np.inf) + _ALIKE
        )
        steps.append(
            Step(
                effect=name,
                before=without,
                after=spread(residual),
                p_value=p_values[name],
                alike=alike,
            )
        )
    kept = [step for step in steps if step.before - step.after >= _GAIN * step.before]
    kept.sort(key=lambda step: -step.before)
    return Selection(steps=tuple(kept), estimates=estimates, residual=residual)


def _ordered(
    names: tuple[str, ...], candidates: Mapping[str, Columns], fixed: tuple[str, ...]
) -> tuple[str, ...]:
    """A set as the search lists it."""
    return (*fixed, *(name for name in candidates if name in names and name not in fixed))


class _Problem:
    """Weighted sums of a fit, from which every set of effects is judged without its rows."""

    def __init__(
        self, values: Floats, weights: Floats, groups: Ints, candidates: Mapping[str, Columns]
    ) -> None:
        whole = _stacked(values, candidates, list(candidates))
        self._recordings = int(groups.max()) + 1
        size = np.maximum(np.linalg.norm(whole, axis=0), 1e-300)
        self._size = size
        columns = whole / size
        self._places: dict[str, list[int]] = {}
        at = 0
        for name, one in candidates.items():
            self._places[name] = list(range(at, at + len(one.keys)))
            at += len(one.keys)
        self._keys = {name: one.keys for name, one in candidates.items()}
        weighted = columns * weights[:, None]
        self._gram = weighted.T @ columns
        # of each recording by itself: its sums change sign together with its residuals
        self._scores = np.zeros((self._recordings, at))
        np.add.at(self._scores, groups, weighted * values[:, None])
        self._grams = np.zeros((self._recordings, at, at))
        for k in range(self._recordings):
            rows = groups == k
            self._grams[k] = weighted[rows].T @ columns[rows]
        self._square = float(np.sum(weights * values**2))
        rng = np.random.default_rng(0)  # the same recordings give the same answer
        self._signs = rng.choice([-1.0, 1.0], size=(FLIPS, self._recordings))

    def cost(
        self, names: tuple[str, ...], possible: Callable[[str, str, float], bool]
    ) -> float | None:
        """Bayesian information criterion with a recording as the unit; None if impossible."""
        at = self._at(names)
        solution = self._solved(at)
        scaled = iter(solution / self._size[at])
        for name in names:
            for key in self._keys[name]:
                if not possible(name, key, float(next(scaled))):
                    return None
        left = self._square - float(solution @ self._scores[:, at].sum(axis=0))
        count = self._recordings
        relative = max(left / self._square, 1e-12) if self._square > 0.0 else 1.0
        return float(count * np.log(relative) + len(at) * np.log(max(count, 2)))

    def correlation(self, name: str) -> float:
        """Root of the share of the weighted square sum that an effect by itself explains."""
        at = self._places[name]
        explained = float(self._solved(at) @ self._scores[:, at].sum(axis=0))
        return float(np.sqrt(np.clip(explained / self._square, 0.0, 1.0))) if self._square else 0.0

    def p_value(self, names: tuple[str, ...], name: str) -> float:
        """Share of flips under which any effect scores as high as this one does, the rest fitted."""
        others = [other for other in names if other != name]
        at = self._at(tuple(others))
        solution = self._solved(at)
        left = self._scores - self._grams[:, :, at] @ solution  # scores of what the rest leaves
        largest, observed = np.zeros(FLIPS), 0.0
        for other, places in self._places.items():
            if other in others:
                continue
            # freed of what the rest can make up for
            across = np.linalg.pinv(self._gram[np.ix_(at, at)]) @ self._gram[np.ix_(at, places)]
            free = left[:, places] - left[:, at] @ across
            spread_ = self._gram[np.ix_(places, places)] - self._gram[np.ix_(places, at)] @ across
            inverse = np.linalg.pinv(spread_, rcond=1e-8, hermitian=True)
            flipped = self._signs @ free
            score = np.einsum("fi,ij,fj->f", flipped, inverse, flipped) / len(places)
            largest = np.maximum(largest, score)
            if other == name:
                total = free.sum(axis=0)
                observed = float(total @ inverse @ total) / len(places)
        beyond = np.sum(largest >= observed * (1.0 - 1e-12))
        return float((1 + beyond) / (1 + FLIPS))

    def by_chance(
        self, chosen: tuple[str, ...], sets: Sequence[tuple[str, ...]], fixed: tuple[str, ...]
    ) -> float:
        """Share of flips under which the criterion of the best of all sets is as low as that of the chosen one."""
        at = self._at(fixed)
        solution = self._solved(at)
        left = self._scores - self._grams[:, :, at] @ solution
        whole = self._square - float(solution @ self._scores[:, at].sum(axis=0))
        across = np.linalg.pinv(self._gram[np.ix_(at, at)]) @ self._gram[at]
        free = left - left[:, at] @ across
        spread_ = self._gram - self._gram[:, at] @ across
        flipped = np.vstack([np.ones(self._recordings), self._signs]) @ free
        lowest, observed = np.full(1 + FLIPS, np.inf), np.inf
        for names in sets:
            own = self._at(tuple(name for name in names if name not in fixed))
            inverse = np.linalg.pinv(spread_[np.ix_(own, own)], rcond=1e-8, hermitian=True)
            explained = np.einsum("fi,ij,fj->f", flipped[:, own], inverse, flipped[:, own])
            rest = np.maximum(1.0 - explained / max(whole, 1e-300), 1e-12)
            count = self._recordings
            costs = count * np.log(rest) + len(own) * np.log(max(count, 2))
            lowest = np.minimum(lowest, costs)
            if names == chosen:
                observed = float(costs[0])
        return float((1 + np.sum(lowest[1:] <= observed + 1e-9)) / (1 + FLIPS))

    @property
    def recordings(self) -> int:
        """Number of recordings."""
        return self._recordings

    def numbers(self, names: tuple[str, ...]) -> int:
        """How many numbers a set of effects has."""
        return len(self._at(names))

    def _at(self, names: tuple[str, ...]) -> list[int]:
        return [place for name in names for place in self._places[name]]

    def _solved(self, at: list[int]) -> Floats:
        gram = self._gram[np.ix_(at, at)]
        return np.asarray(
            np.linalg.pinv(gram, rcond=1e-10, hermitian=True) @ self._scores[:, at].sum(axis=0)
        )


def scores(
    residual: Floats, groups: Ints, columns: Mapping[str, Columns]
) -> Mapping[str, tuple[float, float]]:
    """How a residual goes with covariates, each by itself.

    Parameters
    ----------
    residual, groups
        As ``values`` and ``groups`` of `selected`.
    columns
        By covariate.

    Returns
    -------
    dict
        Correlation 0 … 1 and family-wise p-value of each.
    """
    weights = _huber(residual, _NORMAL * float(np.median(np.abs(residual))))
    problem = _Problem(residual, weights, groups, columns)
    return {name: (problem.correlation(name), problem.p_value((name,), name)) for name in columns}


def fitted(
    values: Floats, groups: Ints, candidates: Mapping[str, Columns]
) -> tuple[Mapping[str, tuple[Estimate, ...]], Floats]:
    """Fit all of some effects.

    Parameters
    ----------
    values, groups, candidates
        As for `selected`.

    Returns
    -------
    dict, (n,)
        Estimates by effect, and what is left.
    """
    names = list(candidates)
    columns = _stacked(values, candidates, names)
    estimates = _estimates(columns, values, groups, candidates, names)
    return estimates, _robust(columns, values)[1]


def _stacked(values: Floats, candidates: Mapping[str, Columns], names: list[str]) -> Floats:
    return np.hstack([np.zeros((values.size, 0)), *(candidates[name].values for name in names)])


def _robust(columns: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Weights and residuals of a fit by Huber's rule."""
    weights, residual = np.ones(values.size), values
    if not columns.shape[1]:
        scale = _NORMAL * float(np.median(np.abs(values)))
        return _huber(values, scale), values
    for _ in range(_PASSES):
        residual = values - columns @ _solution(columns, values, weights)
        weights = _huber(residual, _NORMAL * float(np.median(np.abs(residual))))
    return weights, residual


def _huber(residual: Floats, scale: float) -> Floats:
    if scale == 0.0:
        return np.ones(residual.size)
    return np.minimum(1.0, _HUBER * scale / np.maximum(np.abs(residual), 1e-300))


def _solution(columns: Floats, values: Floats, weights: Floats) -> Floats:
    root = np.sqrt(weights)
    size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    solution = np.linalg.lstsq((columns / size) * root[:, None], values * root, rcond=1e-10)[0]
    return np.asarray(solution / size)


def _estimates(
    columns: Floats,
    values: Floats,
    groups: Ints,
    candidates: Mapping[str, Columns],
    taken: list[str],
) -> Mapping[str, tuple[Estimate, ...]]:
    """Values with intervals by leaving out one recording at a time."""
    if not taken:
        return {}
    weights, _ = _robust(columns, values)
    whole = _solution(columns, values, weights)
    numbers = np.unique(groups)
    without = np.array(
        [
            _solution(columns[groups != k], values[groups != k], weights[groups != k])
            for k in numbers
        ]
    )
    count = len(numbers)
    error = np.sqrt((count - 1) / count * np.sum((without - without.mean(axis=0)) ** 2, axis=0))
    # of one recording nothing can be left out: any value may be the true one
    half = error * _student(count - 1) if count > 1 else np.full(error.shape, np.inf)
    estimates: dict[str, tuple[Estimate, ...]] = {}
    at = 0
    for name in taken:
        keys = candidates[name].keys
        estimates[name] = tuple(
            Estimate(
                key=key,
                value=float(whole[at + k]),
                low=float(whole[at + k] - half[at + k]),
                high=float(whole[at + k] + half[at + k]),
            )
            for k, key in enumerate(keys)
        )
        at += len(keys)
    return estimates


def _student(freedom: int) -> float:
    """95 % point of Student's t."""
    if freedom < 1:
        return float("inf")
    return _T90[freedom - 1] if freedom <= len(_T90) else 1.645 + 1.6 / freedom
