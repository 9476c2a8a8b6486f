"""The catalogue of effects, and the table that the kernels read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NoReturn

import numpy as np

from meso_robust.simulator.actuation import ACTUATION
from meso_robust.simulator.environment import ENVIRONMENT
from meso_robust.simulator.geometry import GEOMETRY
from meso_robust.simulator.observation import OBSERVATION
from meso_robust.simulator.residual import RESIDUAL
from meso_robust.simulator.stage import FORM, SLOTS, Effect, Parameter, Stage
from meso_robust.simulator.support import SUPPORT
from meso_robust.simulator.touch import CONTACT
from meso_robust.types import Floats

STAGES: tuple[Stage, ...] = (
    SUPPORT, ENVIRONMENT, CONTACT, GEOMETRY, ACTUATION, OBSERVATION, RESIDUAL
)  # fmt: skip
"""The stages, in the order of their columns."""

CATALOGUE: Mapping[str, Effect] = {
    effect.name: effect for stage in STAGES for effect in stage.effects
}
"""Every effect by name."""

FAMILIES: Mapping[str, str] = {
    name: physics
    for physics, names in (
        (
            "friction of solids under the part",
            ("dry_friction", "stribeck_friction", "breakaway_friction"),
        ),
        (
            "pull of the stage on the part",
            ("body_force", "film_flow", "wall_capillarity", "point_pull"),
        ),
        ("pull of the tip on the part", ("tip_adhesion", "tip_attraction")),
    )
    for name in names
}
"""Effects that are laws of one piece of physics, by that piece: what they have in common is known though the law is not.

Friction of solids is one force with a state. The age of a contact that slides at a steady speed v is D / v, so that
friction which grows with age falls with speed, and is dry friction where the speed is one. Only how it follows a change
of speed, within a few D, or how long a part has rested tells which law it is; and part and stage touch in any of them.

A tilt, a flow of the film, a meniscus and a charge pull a part that no tip touches, by a force that follows from where it is. As
far as the pushes go, a far wall pulls as a stage does whose tilt grows along it.

A meniscus at the tip and a charge on it pull alike while the tip is drawn back; only on the way to the part do they differ."""


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


def family_of(effect: str) -> str:
    """Piece of physics that an effect is a law of.

    Parameters
    ----------
    effect
        Its name.

    Returns
    -------
    str
        In words; the effect's own name where it is the only law.
    """
    return FAMILIES.get(effect, effect)


Values = Mapping[str, Mapping[str, float | Floats]]
"""``{effect: {parameter: value}}``; a value is a number for all runs or an array (N,)."""


def parameter_of(argument: str, effect: str, key: str) -> Parameter:
    """A number of an effect.

    Parameters
    ----------
    argument
        What names it, for messages.
    effect, key
        Names in the catalogue.

    Returns
    -------
    Parameter
        Its unit, its range and its meaning.

    Raises
    ------
    ValueError
        If the catalogue has no such effect, or the effect no such number.
    """
    parameters = {parameter.key: parameter for parameter in _effect(argument, effect).parameters}
    if key not in parameters:
        _refuse(f"{argument}.{effect}", repr(key), "is unknown", f"use {', '.join(parameters)}")
    return parameters[key]


def values_in_si(stated: Values) -> dict[str, dict[str, float | Floats]]:
    """Values in SI of values in the units that the names of their parameters end in.

    Parameters
    ----------
    stated
        Numbers, or (N,) arrays for as many runs, by effect and key.

    Returns
    -------
    dict
        The same in SI.

    Raises
    ------
    ValueError
        If a name is unknown, or a value is no number.
    """
    return {
        name: {
            key: parameter_of("effects", name, key).to_si * _numbers(f"effects.{name}.{key}", value)
            for key, value in of.items()
        }
        for name, of in stated.items()
    }


def _effect(argument: str, name: str) -> Effect:
    if name not in CATALOGUE:
        advice = f"use one of {', '.join(CATALOGUE)}"
        _refuse(argument, repr(name), "is not in the catalogue", advice)
    return CATALOGUE[name]


def table_of(values: Values) -> Floats:
    """Arrange the values of effects as the table of `Effects`.

    Parameters
    ----------
    values
        ``{effect: {parameter: value}}`` in SI.

    Returns
    -------
    ndarray
        (1, SLOTS) or (N, SLOTS) in SI.

    Raises
    ------
    ValueError
        If a name is unknown, values are of different numbers of runs, or a value is not finite or
        out of its range.
    """
    runs = {np.size(value) for given in values.values() for value in given.values()} - {1}
    if len(runs) > 1:
        _refuse("effects", f"arrays of {sorted(runs)} runs", "must have one length", "repeat")
    table = np.zeros((max(runs, default=1), SLOTS))
    for name, given in values.items():
        effect = _effect("effects", name)
        for key in given:
            parameter_of("effects", name, key)
        _write(table, stage_of(name), effect, given)
    return table


def _write(
    table: Floats, stage: Stage, effect: Effect, given: Mapping[str, float | Floats]
) -> None:
    block = np.zeros((len(table), len(effect.parameters)))
    on = np.zeros(len(table), dtype=bool)
    for column, parameter in enumerate(effect.parameters):
        value = np.asarray(given.get(parameter.key, parameter.default), dtype=np.float64)
        _check(effect, parameter, value)
        block[:, column] = value
        on |= parameter.size & (block[:, column] != 0.0)
    first = stage.slot(effect.name, effect.parameters[0].key)
    # An effect of no size leaves no trace, whatever its other parameters.
    table[on, first : first + len(effect.parameters)] = block[on]


def _numbers(argument: str, value: object) -> Floats:
    """A number or a one-dimensional array of some; anything else is refused."""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        _refuse(argument, repr(value), "must be a number or an array (N,)", "give numbers")
    if array.ndim > 1 or not array.size:
        _refuse(argument, f"shape {array.shape}", "must be a number or an array (N,)", "reshape it")
    return array


def _check(effect: Effect, parameter: Parameter, value: Floats) -> None:
    wrong = value[~((value >= parameter.low) & (value <= parameter.high) & np.isfinite(value))]
    if wrong.size:
        low, high = parameter.shown(parameter.low), parameter.shown(parameter.high)
        shown = f"{parameter.shown(wrong.flat[0])}"
        rule = f"must be finite and within {low:g} … {high:g}"
        _refuse(f"effects.{effect.name}.{parameter.key}", shown, rule, "change it")
    if parameter.key == FORM and np.any(value % 1.0 != 0.0):
        shown = f"{value[value % 1.0 != 0.0].flat[0]}"
        _refuse(f"effects.{effect.name}.{FORM}", shown, "must be a whole number", parameter.meaning)


def _refuse(argument: str, value: str, rule: str, advice: str) -> NoReturn:
    raise ValueError(f"{argument}: {value}; {rule}; {advice}")
