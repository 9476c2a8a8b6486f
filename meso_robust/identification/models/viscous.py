"""Viscous film: the ratio of its drags and the friction at the tips."""

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
from meso_robust.simulator import Effects, Film
from meso_robust.types import Floats

FINENESS = 1.0 / 182.0
"""Step on a film over the characteristic length: 5 µm for the part of the paper."""


def film_ratio(outline: Floats) -> Parameter:
    """ρ = e_θ / e_x; a film no larger than the part has at most the square of its half diagonal."""
    length = characteristic_length(outline)
    return Parameter(
        key="rho_um2",
        unit="µm²",
        to_si=1e-12,
        low=1e-4 * length**2,
        high=1e2 * length**2,
        scale=length**2,
        meaning="rotational over translational drag of the film, e_θ / e_x",
        log=True,
        likely=(1e-2 * length**2, length**2),
        why_likely="a film under the part has no more than its farthest corner's distance squared, "
        "and hardly less than a hundredth of that",
    )


def tip_friction(key: str = "mu") -> Parameter:
    """Coulomb's coefficient between tips and part, in the paper's range (Section VI)."""
    return Parameter(
        key=key,
        unit="",
        to_si=1.0,
        low=0.0,
        high=1.0,
        scale=1.0,
        meaning="friction coefficient between tips and part",
    )


def viscous(outline: Floats) -> Model:
    """``D = diag(1, 1, ρ) v`` under the part, Coulomb friction μ at the tips.

    Parameters
    ----------
    outline
        (V, 2) corners of the part in m; their centroid is the centre of drag.
    """
    length, centre = characteristic_length(outline), centroid(outline)

    def physics(values: Floats) -> Physics:
        film = Film(about_reference(centre, values[:, 0]))
        return Physics(support=film, friction=values[:, 1], effects=Effects())

    def draw(rng: np.random.Generator, count: int) -> Floats:
        ratio = length**2 * np.exp(rng.uniform(np.log(0.03), np.log(1.0), count))
        return np.column_stack([ratio, rng.uniform(0.0, 1.0, count)])

    return Model(
        name="viscous",
        parameters=(film_ratio(outline), tip_friction()),
        physics=physics,
        constraint=lambda values: np.ones(len(values), dtype=bool),
        draw=draw,
        step=FINENESS * length,
    )
