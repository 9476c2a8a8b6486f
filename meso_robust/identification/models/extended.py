"""A model with parameters of the simulator's effects added."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from meso_robust.identification.models.model import Model, Parameter, Physics
from meso_robust.simulator import Effects
from meso_robust.simulator.catalogue import parameter_of, values_in_si
from meso_robust.types import Floats

Scales = Mapping[str, Mapping[str, float]]


def with_effects(model: Model, scales: Scales, fixed: Scales | None = None) -> Model:
    """The model with parameters of effects, each starting from an effect that is off.

    Parameters
    ----------
    model
        Any model.
    scales
        ``{effect: {parameter: typical change}}`` in the units of the catalogue; these are fitted,
        under the name ``effect.parameter``.
    fixed
        ``{effect: {parameter: value}}`` in the units of the catalogue, held.

    Raises
    ------
    ValueError
        If an effect or parameter is not in the catalogue, or a scale is not positive.
    """
    added = tuple(
        _parameter(effect, key, scale) for effect, of in scales.items() for key, scale in of.items()
    )
    columns = [(effect, key) for effect, of in scales.items() for key in of]
    held = values_in_si(fixed or {})
    base = len(model.parameters)

    def physics(values: Floats) -> Physics:
        plain = model.physics(values[:, :base])
        given: dict[str, dict[str, float | Floats]] = {
            effect: dict(of) for effect, of in plain.effects.values.items()
        }
        for effect, of in held.items():
            given.setdefault(effect, {}).update(of)
        for column, (effect, key) in enumerate(columns, start=base):
            given.setdefault(effect, {})[key] = values[:, column]
        return replace(plain, effects=Effects.in_si(given))

    def draw(rng: np.random.Generator, count: int) -> Floats:
        spread = np.array([[parameter.scale for parameter in added]])
        low = np.array([parameter.low for parameter in added])
        high = np.array([parameter.high for parameter in added])
        extra = np.clip(spread * rng.standard_normal((count, len(added))), low, high)
        return np.hstack([model.draw(rng, count), extra])

    return Model(
        name="+".join([model.name, *scales]),
        parameters=(*model.parameters, *added),
        physics=physics,
        constraint=lambda values: model.constraint(values[:, :base]),
        draw=draw,
        step=model.step,
        alike=lambda values: np.hstack([model.alike(values[:, :base]), values[:, base:]]),
    )


def off(model: Model, values: Floats, extended: Model) -> Floats:
    """Values (K, n) of a model as values of its extension with the added effects off."""
    extra = len(extended.parameters) - len(model.parameters)
    return np.hstack([values, np.zeros((len(values), extra))])


def _parameter(effect: str, key: str, scale: float) -> Parameter:
    parameter = parameter_of("scales", effect, key)
    if not 0.0 < scale < np.inf:
        raise ValueError(
            f"scales.{effect}.{key}: {scale}; must be positive and finite; give a typical change"
        )
    return replace(parameter, key=f"{effect}.{key}", scale=scale * parameter.to_si)
