"""Three support points, the model of the paper's Section VI: eight parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.identification.models.model import (
    Model,
    Parameter,
    Physics,
    centroid,
    characteristic_length,
)
from meso_robust.identification.models.viscous import FINENESS, tip_friction
from meso_robust.simulator import Effects, ThreePoints
from meso_robust.simulator.checks import depth_inside
from meso_robust.simulator.support_models import Tables
from meso_robust.types import Flags, Floats

POINTS = slice(2, 8)
"""Columns of x1, y1, x2, y2, x3, y3 in a vector."""
LEAST_LOAD = 1e-4
"""Least share of the weight on a point: what "strictly inside the hull" means in numbers."""
LEAST_FRICTION = 1e-3
"""Least μ_s: a part on points without friction resists nothing, so that no motion follows."""

UNSEEN = (
    "the motion does not depend on it: it multiplies all forces between part and support alike, and "
    "forces are not measured (paper, remark on Table I)"
)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class FrictionPoints:
    """Three points whose μ_s really multiplies their strength, a number for each run.

    The simulator's own `ThreePoints` leaves μ_s out because it cancels; here it stays, so that the
    simulator can show that it does.
    """

    points: Floats
    """(N, 3, 2) m, body frame."""
    friction: Floats
    """(N,) μ_s."""
    centre_of_mass: tuple[float, float]
    """m, body frame."""

    def tables(self) -> Tables:
        """Three dry points."""
        tables = ThreePoints(points=self.points, centre_of_mass=self.centre_of_mass).tables()
        rows = tables.points.copy()
        rows[..., 2] *= self.friction[:, None]
        return Tables(tables.film, rows, tables.surface)


def three_point(outline: Floats) -> Model:
    """Coulomb friction μ_s at three support points, μ_t at the tips.

    The points lie in the part, and the centre of mass, the outline's centroid, lies strictly inside
    their hull; the coefficients are in 0 … 1 (Section VI).

    Parameters
    ----------
    outline
        (V, 2) corners of the part in m, body frame.

    Returns
    -------
    Model
        Eight parameters, of which μ_s shows in no motion (`UNSEEN`).
    """
    length, centre = characteristic_length(outline), centroid(outline)
    surface = Parameter(
        key="mu_s",
        unit="",
        to_si=1.0,
        low=LEAST_FRICTION,
        high=1.0,
        scale=1.0,
        meaning="friction coefficient between support and part",
        unseen=UNSEEN,
    )
    low, high = outline.min(axis=0), outline.max(axis=0)
    places = tuple(
        _place(axis, k, float(low[a]), float(high[a]), length)
        for k in range(3)
        for a, axis in enumerate("xy")
    )

    def constraint(values: Floats) -> Flags:
        points = values[:, POINTS].reshape(-1, 3, 2)
        return _inside(outline, points) & (_loads(points - centre).min(axis=1) > LEAST_LOAD)

    def physics(values: Floats) -> Physics:
        support = FrictionPoints(
            points=values[:, POINTS].reshape(-1, 3, 2),
            friction=values[:, 1],
            centre_of_mass=(float(centre[0]), float(centre[1])),
        )
        return Physics(support=support, friction=values[:, 0], effects=Effects())

    def draw(rng: np.random.Generator, count: int) -> Floats:
        points = _draw_points(rng, count, outline, centre)
        return np.column_stack(
            [rng.uniform(0.0, 1.0, count), rng.uniform(LEAST_FRICTION, 1.0, count), points]
        )

    return Model(
        name="three_point",
        parameters=(tip_friction("mu_t"), surface, *places),
        physics=physics,
        constraint=constraint,
        draw=draw,
        step=0.5 * FINENESS * length,
        alike=lambda values: _sorted(values, centre),
    )


def _place(axis: str, k: int, low: float, high: float, length: float) -> Parameter:
    return Parameter(
        key=f"point{k + 1}_{axis}_um",
        unit="µm",
        to_si=1e-6,
        low=low,
        high=high,
        scale=length,
        meaning=f"{axis} of support point {k + 1}, frame of the part",
    )


def _inside(outline: Floats, points: Floats) -> Flags:
    """(N,) whether three points (N, 3, 2) lie in the part."""
    depth = depth_inside(outline, points.reshape(-1, 2)).reshape(-1, 3)
    return np.asarray(np.all(depth >= 0.0, axis=1))


def _loads(points: Floats) -> Floats:
    """(N, 3) shares of the weight; from the centre; not all positive where it is outside the hull."""
    b, c = np.roll(points, -1, axis=1), np.roll(points, -2, axis=1)
    pieces = b[..., 0] * c[..., 1] - b[..., 1] * c[..., 0]
    whole = pieces.sum(axis=1, keepdims=True)
    return np.asarray(pieces / np.where(whole == 0.0, np.inf, whole))


def _draw_points(rng: np.random.Generator, count: int, outline: Floats, centre: Floats) -> Floats:
    """(count, 6) points uniform in the part, those sets kept that stand around its centre."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    kept = np.zeros((0, 3, 2))
    while len(kept) < count:
        points = rng.uniform(low, high, (8 * count, 3, 2))
        points = points[_inside(outline, points)]
        kept = np.concatenate([kept, points[_loads(points - centre).min(axis=1) > 0.02]])
    return kept[:count].reshape(count, 6)


def _sorted(values: Floats, centre: Floats) -> Floats:
    """The same physics with the points in the order of their angle about the centre."""
    points = values[:, POINTS].reshape(-1, 3, 2)
    away = points - centre
    order = np.argsort(np.arctan2(away[..., 1], away[..., 0]), axis=1)
    result = values.copy()
    result[:, POINTS] = np.take_along_axis(points, order[..., None], axis=1).reshape(-1, 6)
    return result
