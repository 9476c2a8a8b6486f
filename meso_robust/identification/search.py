"""Many searches from random starts, as in Section VI: the ends of Nelder and Mead's simplexes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from meso_robust.identification.models.model import Model
from meso_robust.identification.nelder_mead import around, minimised
from meso_robust.identification.objective import score
from meso_robust.identification.prepared import Prepared
from meso_robust.types import Flags as Bools, Floats

THRESHOLD = 10e-6
"""Size of a simplex at which a search ends, m, the paper's; for a part of `PART`."""
PART = 910e-6
"""Characteristic length of the paper's part, m."""
MOST = 400
"""Most iterations of a search."""
_EDGE = 0.15  # of a first simplex, in coordinates


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ends:
    """Where S searches ended.

    Attributes
    ----------
    values
        (S, n) best vector of each, SI.
    objective
        (S,) F in m.
    sizes
        (S,) sizes of the last simplexes in coordinates; times the characteristic length, m.
    spreads
        (S, n) half the extent of the last simplex along each parameter, SI.
    evaluations
        (S,) how often F was evaluated.
    """

    values: Floats
    objective: Floats
    sizes: Floats
    spreads: Floats
    evaluations: Floats


def searched(
    prepared: Prepared,
    model: Model,
    starts: Floats,
    *,
    threshold: float = THRESHOLD,
    told: Callable[[int], None] = lambda _: None,
) -> Ends:
    """Minimise F of eq. (4) from S vectors (S, n) in SI.

    Parameters that no motion shows stay as they are. Simplexes live in the model's coordinates, in
    which the characteristic length is one.

    Parameters
    ----------
    prepared, model, starts
        What is fitted to what, and from where.
    threshold
        Size of a simplex at which its search ends, m, scaled with the part.
    told
        Called with the number of searches that have ended.
    """
    fitted = model.fitted
    first = model.coordinates(starts)[:, fitted]
    rest = starts[0]

    def whole(points: Floats) -> Floats:
        coordinates = np.tile(model.coordinates(rest[None]), (len(points), 1))
        coordinates[:, fitted] = points
        return model.values(coordinates)

    def inside(points: Floats) -> Bools:
        return model.valid(whole(points))

    def cost(points: Floats) -> Floats:
        return score(prepared, model, whole(points)).values

    found = minimised(
        cost, around(first, _EDGE, inside), threshold=threshold / PART, most=MOST, told=told
    )
    corners = whole(found.points.reshape(-1, first.shape[1])).reshape(*found.points.shape[:2], -1)
    return Ends(
        values=corners[:, 0],
        objective=found.values[:, 0],
        sizes=found.sizes,
        spreads=0.5 * np.ptp(corners, axis=1),
        evaluations=found.evaluations.astype(float),
    )
