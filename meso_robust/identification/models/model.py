"""What a model is: named parameters, and the physics that they stand for; effects can be added."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.simulator import Effects
from meso_robust.simulator.catalogue import parameter_of, values_in_si
from meso_robust.simulator.stage import Parameter as Parameter
from meso_robust.simulator.support_models import Support
from meso_robust.types import Flags, Floats

_FARTHEST = 5.0  # typical changes of the size of an effect, that a search goes in a step


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Physics:
    """What the simulator needs to know of N runs, beside their geometry."""

    support: Support
    friction: Floats
    """(N,) μ between tips and part."""
    effects: Effects


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Model:
    """A parametric model of the push.

    Attributes
    ----------
    name
        As in ``model.toml``.
    parameters
        The n parameters, in the order of the vectors.
    physics
        (N, n) values in SI of N runs, all valid, to their physics.
    constraint
        (N, n) values in SI, all within their ranges, to (N,) whether the physics exists.
    draw
        Generator and count K to (K, n) random valid values in SI.
    step
        Longest displacement of a tip in one step, m, at which predicted positions were measured to
        be within 0.05 µm of the converged ones (median over pushes), for a part of 1.6 mm.
    alike
        (N, n) values to the (N, n) that stand for the same physics in a standard form.
    """

    name: str
    parameters: tuple[Parameter, ...]
    physics: Callable[[Floats], Physics]
    constraint: Callable[[Floats], Flags]
    draw: Callable[[np.random.Generator, int], Floats]
    step: float
    alike: Callable[[Floats], Floats] = lambda values: values

    @property
    def keys(self) -> tuple[str, ...]:
        """Names of the n parameters."""
        return tuple(parameter.key for parameter in self.parameters)

    @property
    def fitted(self) -> Flags:
        """(n,) whether a parameter can show in motion at all and is searched for."""
        return np.array([not parameter.unseen for parameter in self.parameters])

    def valid(self, values: Floats) -> Flags:
        """(K,) whether values (K, n) in SI keep their ranges and the constraint."""
        low, high = self._of("low"), self._of("high")
        inside = np.all((values >= low) & (values <= high), axis=1)  # NaN is not
        if np.any(inside):
            inside[inside] = self.constraint(values[inside])
        return inside

    def coordinates(self, values: Floats) -> Floats:
        """Dimensionless coordinates (K, n) of values (K, n) in SI."""
        scaled = values / self._of("scale")
        log = self._of("log").astype(bool)
        return np.where(log, np.log(np.where(log, scaled, 1.0)), scaled)

    def values(self, coordinates: Floats) -> Floats:
        """Values (K, n) in SI at coordinates (K, n)."""
        log = self._of("log").astype(bool)
        plain = np.where(log, np.exp(np.where(log, np.clip(coordinates, -50.0, 50.0), 0.0)), 0.0)
        return np.where(log, plain, coordinates) * self._of("scale")

    def shown(self, values: Floats) -> list[float]:
        """Values (n,) in SI in the units of the parameters' names."""
        return [p.shown(value) for p, value in zip(self.parameters, values.tolist(), strict=True)]

    def _of(self, field: str) -> Floats:
        return np.array([getattr(parameter, field) for parameter in self.parameters], dtype=float)


def characteristic_length(outline: Floats) -> float:
    """Distance in m of the farthest corner (V, 2) from the reference point.

    θ times it is by how much a rotation moves the outline at most. It is positive.
    """
    return float(np.hypot(outline[:, 0], outline[:, 1]).max())


def centroid(outline: Floats) -> Floats:
    """(2,) centroid of the area of an outline (V, 2): where an even film or mass has its centre.

    Parameters
    ----------
    outline
        (V, 2) corners of a simple polygon, m.

    Returns
    -------
    ndarray
        (2,) m, in the axes of the corners.
    """
    x, y = outline.T
    cross = x * np.roll(y, -1) - y * np.roll(x, -1)
    ends = outline + np.roll(outline, -1, axis=0)
    return np.asarray(cross @ ends / (3.0 * cross.sum()))


def about_reference(centre: Floats, moment: Floats) -> Floats:
    """``diag(1, 1, moment)`` about a centre (2,), m, as matrices (N, 3, 3) about the reference point.

    Of a film's drag the columns are twists, of a limit surface wrenches; both shift alike.
    """
    x, y = centre
    matrix = np.zeros((len(moment), 3, 3))
    matrix[:, 0, 0] = matrix[:, 1, 1] = 1.0
    matrix[:, 0, 2] = matrix[:, 2, 0] = -y
    matrix[:, 1, 2] = matrix[:, 2, 1] = x
    matrix[:, 2, 2] = moment + x * x + y * y
    return matrix


Scales = Mapping[str, Mapping[str, float]]


def with_effects(
    model: Model, scales: Scales, fixed: Scales | None = None, *, tip_radius: float = np.inf
) -> Model:
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
    tip_radius
        Stated radius of the tips, m: no deficit may be larger. Infinite: not known.

    Returns
    -------
    Model
        Its parameters are those of ``model``, then those of the effects in the order of ``scales``; its
        values are in SI as any model's.

    Raises
    ------
    ValueError
        If an effect or parameter is not in the catalogue, or a scale is not positive.
    """
    added = tuple(
        _parameter(effect, key, scale, tip_radius)
        for effect, of in scales.items()
        for key, scale in of.items()
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


def _parameter(effect: str, key: str, scale: float, tip_radius: float) -> Parameter:
    parameter = parameter_of("scales", effect, key)
    if not 0.0 < scale < np.inf:
        raise ValueError(
            f"scales.{effect}.{key}: {scale}; must be positive and finite; give a typical change"
        )
    low = max(parameter.low, -tip_radius) if effect == "tip_radius" else parameter.low
    # predictions are about linear in a size, which may be any number of changes that matter; not in a form
    return replace(
        parameter,
        key=f"{effect}.{key}",
        scale=scale * parameter.to_si,
        low=low,
        farthest=_FARTHEST if parameter.size else parameter.farthest,
    )
