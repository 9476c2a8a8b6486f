"""Models that can be fitted, by name; one file each."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from meso_robust.identification.models.limit_surface import limit_surface as limit_surface
from meso_robust.identification.models.model import (
    Model as Model,
    Parameter as Parameter,
    Physics as Physics,
    characteristic_length as characteristic_length,
    with_effects as with_effects,
)
from meso_robust.identification.models.three_point import three_point as three_point
from meso_robust.identification.models.uniform_pressure import uniform_pressure as uniform_pressure
from meso_robust.identification.models.viscous import viscous as viscous
from meso_robust.types import Floats

MODELS: Mapping[str, Callable[[Floats], Model]] = {
    "viscous": viscous,
    "three_point": three_point,
    "limit_surface": limit_surface,
    "uniform_pressure": uniform_pressure,
}
"""Makers of the models; each takes the outline (V, 2) of the part in m."""
