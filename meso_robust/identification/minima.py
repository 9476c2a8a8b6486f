"""Local minima: which searches have found the same explanation, and how good each is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meso_robust.identification.forward import predicted
from meso_robust.identification.models.model import Model
from meso_robust.identification.objective import scores_of
from meso_robust.identification.prepared import Prepared
from meso_robust.types import Floats

ALIKE = 1e-6
"""Predictions closer than this (eq. 4 between them, m) count as the same for a part of 1.6 mm."""
_LENGTH = 910e-6  # characteristic length of that part, m


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Minimum:
    """A local minimum.

    Attributes
    ----------
    values
        (n,) in SI, in the model's standard form.
    cost
        What was minimised: F in m, or χ².
    objective
        F of eq. (4) in m, each recording from its first pose as seen.
    axes
        (3,) root mean squares over all recordings along x, y (m) and θ (rad).
    found
        Number of searches that ended there.
    spread
        (n,) half the range of the vectors that ended there, SI: a wide one tells that different
        vectors predict the same.
    members
        Which of the ends these were, the best first.
    """

    values: Floats
    cost: float
    objective: float
    axes: Floats
    found: int
    spread: Floats
    members: tuple[int, ...]


def minima(
    prepared: Prepared,
    model: Model,
    values: Floats,
    costs: Floats,
    weights: Sequence[int] | None = None,
) -> tuple[Minimum, ...]:
    """Group the ends of searches by what they predict, the best group first.

    Two ends are the same minimum if their predictions differ by less than `ALIKE`, whatever their
    parameters: the same motion may follow from different support points.

    Parameters
    ----------
    prepared, model
        What was fitted to what.
    values, costs
        (S, n) in SI and (S,) what was minimised there.
    weights
        S numbers of searches that each stands for; one by default.
    """
    prediction = predicted(prepared, model, values)
    scores = scores_of(prepared, prediction)
    limit = ALIKE * prepared.length / _LENGTH
    groups: list[list[int]] = []
    for k in np.argsort(costs, kind="stable"):
        own = [g for g in groups if _away(prepared, prediction.poses[[k, g[0]]]) < limit]
        if own:
            own[0].append(int(k))
        else:
            groups.append([int(k)])
    scale = np.array([1.0, 1.0, prepared.length])
    standard, counts = model.alike(values), np.ones(len(values), dtype=int)
    counts = counts if weights is None else np.array(weights)
    return tuple(
        Minimum(
            values=standard[group[0]],
            cost=float(costs[group[0]]),
            objective=float(scores.values[group[0]]),
            axes=np.sqrt(np.mean(scores.axes[group[0]] ** 2, axis=0)) / scale,
            found=int(counts[group].sum()),
            spread=0.5 * np.ptp(standard[group], axis=0),
            members=tuple(group),
        )
        for group in groups
    )


def _away(prepared: Prepared, two: Floats) -> float:
    """Eq. (4) between two predictions (2, R, T, 3) where something was seen, m."""
    scale = np.array([1.0, 1.0, prepared.length])
    apart = np.where(np.isfinite(prepared.seen), (two[0] - two[1]) * scale, 0.0)
    rms = np.sqrt(np.sum(apart**2, axis=1) / np.maximum(prepared.counts, 1))
    return float(rms.max(axis=1).mean())
