"""What one concealed effect changes in a world, and how large it may be."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from reports.blind.world import World


@dataclass(frozen=True, slots=True)
class Change:
    """Fields of the laws and of the camera, edges' excess, and the published parameters."""

    parameters: Mapping[str, float]
    """In the units of the catalogue of effects, by their published keys."""
    laws: Mapping[str, Any] = field(default_factory=dict)
    camera: Mapping[str, Any] = field(default_factory=dict)
    excess: tuple[float, float] = (0.0, 0.0)

    def of(self, world: World) -> World:
        """The world with the change."""
        return World(
            laws=world.laws._replace(**self.laws),
            camera=replace(world.camera, **self.camera),
            excess=(world.excess[0] + self.excess[0], world.excess[1] + self.excess[1]),
        )


Law = Callable[[float, np.random.Generator], Change]
"""From a size and a generator, of which all other parameters are drawn, to the change."""


@dataclass(frozen=True, slots=True)
class Effect:
    """A law with the size at which to start looking for the just-detectable one, and a limit."""

    name: str
    stage: str
    law: Law
    guess: float
    most: float
    """Size above which the law, or the experiment, makes no sense any more."""

    def change(self, size: float, seed: int) -> Change:
        """The change of a size; the seed settles directions and places."""
        return self.law(size, np.random.default_rng(seed))


def direction(rng: np.random.Generator) -> tuple[float, float]:
    """A random unit vector."""
    angle = rng.uniform(-np.pi, np.pi)
    return float(np.cos(angle)), float(np.sin(angle))


def sign(rng: np.random.Generator) -> float:
    """Plus or minus one."""
    return float(rng.choice([-1.0, 1.0]))
