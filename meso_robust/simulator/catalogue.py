"""The catalogue of effects, and the table that the kernels read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NoReturn

import numpy as np

from meso_robust.simulator.actuation import ACTUATION
from meso_robust.simulator.environment import ENVIRONMENT
from meso_robust.simulator.geometry import GEOMETRY
from meso_robust.simulator.observation import OBSERVATION
from meso_robust.simulator.stage import SLOTS, Effect, Parameter, Stage
from meso_robust.simulator.support import SUPPORT
from meso_robust.simulator.touch import CONTACT
from meso_robust.types import Floats

STAGES: tuple[Stage, ...] = (SUPPORT, ENVIRONMENT, CONTACT, GEOMETRY, ACTUATION, OBSERVATION)
"""The stages, in the order of their columns."""

CATALOGUE: Mapping[str, Effect] = {
    effect.name: effect for stage in STAGES for effect in stage.effects
}
"""Every effect by name."""


def stage_of(effect: str) -> Stage:
    """Stage that an effect belongs to.

    Parameters
    ----------
    effect
        Its name.

    Returns
    -------
    Stage
        The one that declares it.

    Raises
    ------
    KeyError
        If the effect is unknown.
    """
    return next(s for s in STAGES if any(e.name == effect for e in s.effects))


def table_of(values: Mapping[str, Mapping[str, float | Floats]]) -> Floats:
    """Arrange the values of effects as the table of `Effects`.

    Parameters
    ----------
    values
        ``{effect: {parameter: value}}``, see `Effects`.

    Returns
    -------
    ndarray
        (1, SLOTS) or (N, SLOTS) in SI.

    Raises
    ------
    ValueError
        If a name is unknown or a value is not finite or out of its range.
    """
    for name, given in values.items():
        for key, value in given.items():
            _check_form(f"effects.{name}.{key}", value)
    runs = {np.size(value) for given in values.values() for value in given.values()} - {1}
    if len(runs) > 1:
        _refuse("effects", f"arrays of {sorted(runs)} runs", "must have one length", "repeat")
    table = np.zeros((max(runs, default=1), SLOTS))
    for name, given in values.items():
        if name not in CATALOGUE:
            known = ", ".join(CATALOGUE)
            _refuse("effects", repr(name), "is not in the catalogue", f"use one of {known}")
        _write(table, stage_of(name), CATALOGUE[name], given)
    return table


def _write(
    table: Floats, stage: Stage, effect: Effect, given: Mapping[str, float | Floats]
) -> None:
    keys = [parameter.key for parameter in effect.parameters]
    for key in given:
        if key not in keys:
            _refuse(f"effects.{effect.name}", repr(key), "is unknown", f"use {', '.join(keys)}")
    block = np.zeros((len(table), len(effect.parameters)))
    on = np.zeros(len(table), dtype=bool)
    for column, parameter in enumerate(effect.parameters):
        value = np.asarray(given.get(parameter.key, parameter.default), dtype=np.float64)
        _check(effect, parameter, value)
        block[:, column] = value * parameter.to_si
        on |= parameter.size & (block[:, column] != 0.0)
    first = stage.slot(effect.name, keys[0])
    # An effect of no size leaves no trace, whatever its other parameters.
    table[on, first : first + len(keys)] = block[on]


def _check_form(argument: str, value: object) -> None:
    """Refuse what is not a number or a one-dimensional array of some."""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        _refuse(argument, repr(value), "must be a number or an array (N,)", "give numbers")
    if array.ndim > 1 or not array.size:
        _refuse(argument, f"shape {array.shape}", "must be a number or an array (N,)", "reshape it")


def _check(effect: Effect, parameter: Parameter, value: Floats) -> None:
    wrong = value[~((value >= parameter.low) & (value <= parameter.high) & np.isfinite(value))]
    if wrong.size:
        rule = f"must be finite and within {parameter.low:g} … {parameter.high:g}"
        _refuse(f"effects.{effect.name}.{parameter.key}", f"{wrong.flat[0]}", rule, "change it")


def _refuse(argument: str, value: str, rule: str, advice: str) -> NoReturn:
    raise ValueError(f"{argument}: {value}; {rule}; {advice}")
