"""Ellipsoidal limit surface, the simplest model of dry contact over an area."""

from __future__ import annotations

import numpy as np

from meso_robust.identification.models.model import (
    Model,
    Parameter,
    Physics,
    about_reference,
    centroid,
    characteristic_length,
)
from meso_robust.identification.models.viscous import FINENESS, tip_friction
from meso_robust.simulator import Effects, LimitSurface
from meso_robust.types import Floats


def limit_surface(outline: Floats) -> Model:
    """``f_x² + f_y² + (m / c)² = const``, Coulomb friction μ at the tips.

    Pushed by one tip the part moves exactly as on a film with ρ = c².

    Parameters
    ----------
    outline
        (V, 2) corners of the part in m; their centroid is the centre of friction.
    """
    length, centre = characteristic_length(outline), centroid(outline)

    def physics(values: Floats) -> Physics:
        surface = LimitSurface(about_reference(centre, values[:, 0] ** 2))
        return Physics(support=surface, friction=values[:, 1], effects=Effects())

    arm = Parameter(
        key="c_um",
        unit="µm",
        to_si=1e-6,
        low=1e-2 * length,
        high=1e1 * length,
        scale=length,
        meaning="largest torque of the support over its largest force, c",
        log=True,
        likely=(1e-1 * length, length),
        why_likely="a support under the part has no longer an arm than its farthest corner, and "
        "hardly less than a tenth of that",
    )

    def draw(rng: np.random.Generator, count: int) -> Floats:
        arms = length * np.exp(rng.uniform(np.log(0.17), np.log(1.0), count))
        return np.column_stack([arms, rng.uniform(0.0, 1.0, count)])

    return Model(
        name="limit_surface",
        parameters=(arm, tip_friction()),
        physics=physics,
        constraint=lambda values: np.ones(len(values), dtype=bool),
        draw=draw,
        step=0.5 * FINENESS * length,
    )
