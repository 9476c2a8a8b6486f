"""Dry contact with uniform pressure under the whole part: nothing is free but the tips' friction."""

from __future__ import annotations

import numpy as np

from meso_robust.identification.models.model import Model, Physics, characteristic_length
from meso_robust.identification.models.viscous import FINENESS, tip_friction
from meso_robust.simulator import Effects, PressurePoints
from meso_robust.types import Floats


def uniform_pressure(outline: Floats) -> Model:
    """Coulomb friction under the whole outline (V, 2), m, and friction μ at the tips."""
    support = PressurePoints.under(outline)

    def physics(values: Floats) -> Physics:
        return Physics(support=support, friction=values[:, 0], effects=Effects())

    return Model(
        name="uniform_pressure",
        parameters=(tip_friction(),),
        physics=physics,
        constraint=lambda values: np.ones(len(values), dtype=bool),
        draw=lambda rng, count: rng.uniform(0.0, 1.0, (count, 1)),
        step=0.5 * FINENESS * characteristic_length(outline),
    )
