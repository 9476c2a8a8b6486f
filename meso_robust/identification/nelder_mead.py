"""The downhill simplex method of Nelder and Mead, for many starts side by side.

The steps of every simplex are those of SciPy's ``Nelder-Mead`` (Lagarias et al. 1998,
doi:10.1137/S1052623496303470), one after the other. Only the evaluations of all simplexes are put
into common calls, because the simulator is fast on large batches.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from meso_robust.types import Flags, Floats, Ints

Function = Callable[[Floats], Floats]
"""(K, m) points to (K,) values; infinite outside the constraints."""

REFLECT, EXPAND, CONTRACT, SHRINK = 1.0, 2.0, 0.5, 0.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Simplexes:
    """Ends of S searches in m dimensions.

    Attributes
    ----------
    points, values
        (S, m + 1, m) and (S, m + 1), the best first.
    sizes
        (S,) average distance of the points from their centre.
    iterations, evaluations
        (S,) numbers.
    """

    points: Floats
    values: Floats
    sizes: Floats
    iterations: Ints
    evaluations: Ints


def size(points: Floats) -> Floats:
    """(S,) average distance of the points (S, m + 1, m) of simplexes from their centres."""
    away = points - points.mean(axis=1, keepdims=True)
    return np.asarray(np.sqrt(np.sum(away**2, axis=2)).mean(axis=1))


def around(starts: Floats, edge: float, inside: Callable[[Floats], Flags]) -> Floats:
    """Simplexes (S, m + 1, m) with edges along the axes, turned inwards where they leave a range.

    Parameters
    ----------
    starts
        (S, m) points that are inside.
    edge
        Length of the edges.
    inside
        (K, m) points to (K,) whether they are admissible.
    """
    m = starts.shape[1]
    points = np.repeat(starts[:, None], m + 1, axis=1)
    for axis in range(m):
        forth, back = starts.copy(), starts.copy()
        forth[:, axis] += edge
        back[:, axis] -= edge
        turned = ~inside(forth) & inside(back)
        points[:, axis + 1] = np.where(turned[:, None], back, forth)
    return points


def minimised(
    function: Function,
    points: Floats,
    *,
    threshold: float,
    most: int,
    told: Callable[[int], None] = lambda _: None,
) -> Simplexes:
    """Contract simplexes until each is small.

    Parameters
    ----------
    function
        What to minimise.
    points
        (S, m + 1, m) simplexes.
    threshold
        Size below which a search ends.
    most
        Most iterations.
    told
        Called in every iteration with the number of searches that have ended.
    """
    search = _Search(function, points.copy())
    for _ in range(most):
        search.sort()
        active = np.flatnonzero(size(search.points) >= threshold)
        told(len(points) - len(active))
        if not active.size:
            break
        search.step(active)
    search.sort()
    return Simplexes(
        points=search.points,
        values=search.values,
        sizes=size(search.points),
        iterations=search.iterations,
        evaluations=search.evaluations,
    )


class _Search:
    """S simplexes under way."""

    def __init__(self, function: Function, points: Floats) -> None:
        count, corners, m = points.shape
        self.function, self.points = function, points
        self.values = function(points.reshape(-1, m)).reshape(count, corners)
        self.iterations = np.zeros(count, dtype=np.int64)
        self.evaluations = np.full(count, corners, dtype=np.int64)

    def sort(self) -> None:
        """Put the best point of every simplex first."""
        order = np.argsort(self.values, axis=1, kind="stable")
        self.values = np.take_along_axis(self.values, order, axis=1)
        self.points = np.take_along_axis(self.points, order[..., None], axis=1)

    def step(self, which: Ints) -> None:
        """One iteration of some of the simplexes, which are sorted."""
        self.iterations[which] += 1
        best, second = self.values[which, 0], self.values[which, -2]
        reflected, value = self._tried(which, REFLECT)
        far, near = value < best, value >= second
        kept, kept_value = reflected.copy(), value.copy()
        if np.any(far):
            self._replace(kept, kept_value, far, *self._tried(which[far], EXPAND), value[far])
        shrink = np.zeros(len(which), dtype=bool)
        if np.any(near):
            worst = self.values[which[near], -1]
            factor = np.where(value[near] < worst, CONTRACT, -CONTRACT)
            contracted, found = self._tried(which[near], factor)
            good = np.where(factor > 0.0, found <= value[near], found < worst)
            kept[near], kept_value[near] = contracted, found
            shrink[np.flatnonzero(near)[~good]] = True
        self.points[which[~shrink], -1] = kept[~shrink]
        self.values[which[~shrink], -1] = kept_value[~shrink]
        if np.any(shrink):
            self._shrink(which[shrink])

    def _tried(self, which: Ints, factor: float | Floats) -> tuple[Floats, Floats]:
        """Points along the line from the worst point through the centre of the others."""
        centre = self.points[which, :-1].mean(axis=1)
        way = np.broadcast_to(factor, len(which))[:, None]
        points = centre + way * (centre - self.points[which, -1])
        self.evaluations[which] += 1
        return points, self.function(points)

    @staticmethod
    def _replace(
        kept: Floats,
        kept_value: Floats,
        far: Flags,
        expanded: Floats,
        found: Floats,
        value: Floats,
    ) -> None:
        better = found < value
        where = np.flatnonzero(far)[better]
        kept[where], kept_value[where] = expanded[better], found[better]

    def _shrink(self, which: Ints) -> None:
        """Draw all points half way to the best."""
        first = self.points[which, :1]
        points = first + SHRINK * (self.points[which, 1:] - first)
        self.points[which, 1:] = points
        count, corners, m = points.shape
        self.values[which, 1:] = self.function(points.reshape(-1, m)).reshape(count, corners)
        self.evaluations[which] += corners
