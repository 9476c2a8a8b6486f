"""Which pushes to make next: the set that shrinks the uncertainty of the parameters most.

Candidates are pushes at several places of every edge, from several directions and of several
lengths. Those whose start is pathological, that lose the part or leave the field are excluded by
name. The set is found greedily and then by exchanges (Fedorov, Theory of Optimal Experiments, 1972)
until none helps, by the determinant of the information or the variance of one named parameter.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.errors import InputError
from meso_robust.identification.candidates import Candidates, candidates, safe
from meso_robust.identification.experiment import Experiment, PlannedPush
from meso_robust.identification.information import information, prior
from meso_robust.identification.models import Model
from meso_robust.identification.rollout import Setting
from meso_robust.identification.sensitivity import StartBox
from meso_robust.recordings import SensorInfo
from meso_robust.types import Floats
from meso_robust.wording import counted

DETERMINANT = "determinant"
"""Criterion of the whole set of parameters; the other criteria are their keys."""
QUANTILE = 1.6448536269514722
"""Of the normal distribution, for intervals of 90 %."""
_LEAST_GAIN = 1e-9  # below which an exchange is rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """How well a parameter is expected to be known, 90 %, SI.

    Attributes
    ----------
    key
        Of the parameter.
    value
        Taken for the truth.
    low, high
        Ends. They are the normal approximation's and may lie beyond the parameter's range.
    informed
        Whether motion was informative: if not, the ends only restate the width of the range.
    """

    key: str
    value: float
    low: float
    high: float
    informed: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Design:
    """A chosen set of pushes.

    Attributes
    ----------
    experiment
        The pushes, each to be made once, and what was excluded and why.
    before, after
        Intervals of every parameter without and with the pushes.
    criterion
        What was minimised.
    matrix
        (n, n) information with the pushes, in the model's coordinates.
    """

    experiment: Experiment
    before: tuple[Interval, ...]
    after: tuple[Interval, ...]
    criterion: str
    matrix: Floats


def design(
    setting: Setting,
    values: Floats,
    sensor: SensorInfo,
    count: int,
    *,
    choice: Candidates | None = None,
    known: Floats | None = None,
    criterion: str = DETERMINANT,
    box: StartBox | None = None,
) -> Design:
    """Choose the pushes to make.

    Parameters
    ----------
    setting
        Part, bench and model.
    values
        (n,) parameters in SI that are taken for the truth.
    sensor
        Frame rate and standard deviations.
    count
        Number of pushes.
    choice
        What to choose from.
    known
        (n, n) information already available, in the model's coordinates, such as that of
        recordings; the ranges of the parameters always count besides.
    criterion
        `DETERMINANT`, or the key of the parameter whose interval is to be the shortest.
    box
        Starts in which a push must not be pathological; the paper's by default.

    Returns
    -------
    Design
        The pushes, and the intervals of all parameters without and with them.

    Raises
    ------
    InputError
        If the count or criterion is wrong, or too few candidates are left.
    """
    column = _column(setting.model, criterion)
    choice = choice or Candidates()
    pushes, excluded = candidates(setting.part, setting.bench, choice)
    _check_count(count, choice.repeats * len(pushes))
    pushes, pathological = safe(setting, pushes, values, box or StartBox())
    _check_count(count, choice.repeats * len(pushes))
    found = information(setting, pushes, values, sensor)
    base = prior(setting.model)
    base = base if known is None else base + _checked(known, len(base))
    rows = chosen(found.matrices, base, count, choice.repeats, column)
    matrix = base + found.matrices[list(rows)].sum(axis=0)
    return Design(
        experiment=Experiment(
            part=setting.part,
            bench=replace(setting.bench, trials=1),
            pushes=_numbered([pushes[row] for row in rows]),
            left_out=(*excluded, *pathological),
        ),
        before=intervals(setting.model, values, base),
        after=intervals(setting.model, values, matrix),
        criterion=criterion,
        matrix=matrix,
    )


def chosen(
    matrices: Floats, base: Floats, count: int, repeats: int, column: int | None
) -> tuple[int, ...]:
    """Indices of the best set found.

    Parameters
    ----------
    matrices
        (C, n, n) information of the candidates.
    base
        (n, n) information that is there, positive definite.
    count
        Size of the set.
    repeats
        Most times that one candidate is taken; ``repeats · C`` is at least the count.
    column
        Parameter whose variance counts, or None for the determinant.
    """
    rows: list[int] = []
    while len(rows) < count:
        rows.append(_best(matrices, base, rows, repeats, column)[0])
    improved = True
    while improved:
        improved = False
        for k in range(count):
            others = rows[:k] + rows[k + 1 :]
            row, gain = _best(matrices, base, others, repeats, column)
            now = _merits(matrices[rows[k]][None], base + matrices[others].sum(axis=0), column)[0]
            if gain > now + _LEAST_GAIN:
                rows[k], improved = row, True
    return tuple(sorted(rows))


def intervals(model: Model, values: Floats, matrix: Floats) -> tuple[Interval, ...]:
    """Intervals of 90 % that an information (n, n) in coordinates leaves about values (n,) in SI."""
    deviation = np.sqrt(np.diag(np.linalg.inv(matrix)))
    here = model.coordinates(values[None])[0]
    low, high = model.values(np.stack([here - QUANTILE * deviation, here + QUANTILE * deviation]))
    told = np.diag(matrix) > np.diag(prior(model)) * (1.0 + 1e-9)
    return tuple(
        Interval(key=key, value=float(v), low=float(a), high=float(b), informed=bool(t))
        for key, v, a, b, t in zip(model.keys, values, low, high, told, strict=True)
    )


def _best(
    matrices: Floats, base: Floats, rows: Sequence[int], repeats: int, column: int | None
) -> tuple[int, float]:
    """The candidate that helps most beside others, and its merit there."""
    merits = _merits(matrices, base + matrices[list(rows)].sum(axis=0), column)
    used = Counter(rows)
    merits[[row for row, times in used.items() if times >= repeats]] = -np.inf
    best = int(np.argmax(merits))
    return best, float(merits[best])


def _merits(matrices: Floats, rest: Floats, column: int | None) -> Floats:
    """(C,) logarithm of the determinant, or minus that of one variance, with each candidate.

    But for a number that depends on the rest only, so that merits beside the same rest compare.
    """
    scale = 1.0 / np.sqrt(np.diag(rest))
    whole = (matrices + rest) * scale[:, None] * scale
    if column is None:
        return np.asarray(np.linalg.slogdet(whole)[1])
    return np.asarray(-np.log(np.linalg.inv(whole)[:, column, column]))


def _checked(known: Floats, count: int) -> Floats:
    """Information that is there, if it can be one."""
    sound = known.shape == (count, count) and bool(np.all(np.isfinite(known)))
    if not sound or np.linalg.eigvalsh(known).min() < -1e-9 * np.abs(known).max():
        raise InputError(
            f"known: shape {known.shape}; must be ({count}, {count}), finite and without negative "
            "eigenvalues; give the information of recordings in the model's coordinates"
        )
    return known


def _column(model: Model, criterion: str) -> int | None:
    if criterion == DETERMINANT:
        return None
    seen = [p.key for p in model.parameters if not p.unseen]
    if criterion not in seen:
        raise InputError(
            f"criterion: {criterion!r}; must be {DETERMINANT} or a parameter that motion can show: "
            f"{', '.join(seen)}; change it"
        )
    return model.keys.index(criterion)


def _check_count(count: int, most: int) -> None:
    if not 1 <= count <= most:
        raise InputError(
            f"design: {counted(count, 'push', 'pushes')}; must be 1 to {most}, which is how many the candidates that can be "
            "made and are not pathological allow; ask for fewer, or give more places, angles or repeats"
        )


def _numbered(pushes: Sequence[PlannedPush]) -> tuple[PlannedPush, ...]:
    """The pushes under names that differ: the second of a name becomes ``…_2``."""
    seen: Counter[str] = Counter()
    result = []
    for push in pushes:
        seen[push.name] += 1
        times = seen[push.name]
        result.append(push if times == 1 else replace(push, name=f"{push.name}_{times}"))
    return tuple(result)


def shrinking(before: Interval, after: Interval) -> float:
    """Length of an interval after over that before.

    Parameters
    ----------
    before, after
        Of one parameter, in one unit.

    Returns
    -------
    float
        1 where nothing was gained; NaN of an interval without a length.
    """
    length = before.high - before.low
    return (after.high - after.low) / length if length > 0.0 else math.nan
