"""What else than the support resists a motion: nothing, inertia alone, or both.

* Quasi-static (the default): the support balances the contacts, eq. (1) of the paper.
* Dynamic: the momentum changes by the impulse of all forces in the step,
  ``M (v − v_last) / dt = forces − D(v)``, with impacts that do not rebound (Stewart and Trinkle 1996,
  doi:10.1002/(SICI)1097-0207(19960815)39:15<2673::AID-NME972>3.0.CO;2-I).
* First-order: every step starts from rest and no support resists, ``M v / dt = forces``: of all motions
  that the contacts allow, the one of least kinetic energy.

The paper's Section VI has these three as plug-ins of its simulator.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.kernels import sealed
from meso_robust.types import Floats

FIRST_ORDER = 1.0
DYNAMIC = 2.0


@dataclass(frozen=True, slots=True)
class QuasiStatic:
    """No inertia."""

    def row(self) -> tuple[float, float, float]:
        """Kind, mass and moment of inertia for the kernels."""
        return 0.0, 0.0, 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Dynamic:
    """Inertia and support."""

    mass: float
    """Mass over the film's translational drag e_x, s: the time in which a free part stops."""
    inertia: float
    """Moment of inertia about the reference point over e_x, m² s."""

    def __post_init__(self) -> None:
        """Refuse values that are not positive."""
        _check(self.mass, self.inertia)

    def row(self) -> tuple[float, float, float]:
        """Kind, mass and moment of inertia for the kernels."""
        return DYNAMIC, self.mass, self.inertia


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstOrder:
    """Inertia without memory, no support; only the ratio of the two numbers matters."""

    mass: float
    """As in `Dynamic`."""
    inertia: float
    """As in `Dynamic`."""

    def __post_init__(self) -> None:
        """Refuse values that are not positive."""
        _check(self.mass, self.inertia)

    def row(self) -> tuple[float, float, float]:
        """Kind, mass and moment of inertia for the kernels."""
        return FIRST_ORDER, self.mass, self.inertia


MotionModel = QuasiStatic | Dynamic | FirstOrder


def _check(mass: float, inertia: float) -> None:
    for name, value in (("mass", mass), ("inertia", inertia)):
        if not 0.0 < value < np.inf:
            raise ValueError(
                f"{name}: {value}; must be positive and finite; "
                "divide the part's by the film's drag e_x"
            )


@sealed
def add_inertia(inertia: Floats, velocity: Floats, dt: float, K: Floats, offset: Floats) -> None:
    """Add the change of momentum in a step to the tangent and its offset.

    Parameters
    ----------
    inertia
        (5,) row of the motion model, and mass times the place of its centre from the reference point.
    velocity
        (3,) velocity at the end of the last step, body frame.
    dt
        Length of the step, s.
    K, offset
        (6,) and (3,) as in `support.resist_dry`.
    """
    mass, moment, x, y = inertia[1] / dt, inertia[2] / dt, inertia[3] / dt, inertia[4] / dt
    K[0] += mass
    K[2] -= y
    K[3] += mass
    K[4] += x
    K[5] += moment
    if inertia[0] == DYNAMIC:
        offset[0] += mass * velocity[0] - y * velocity[2]
        offset[1] += mass * velocity[1] + x * velocity[2]
        offset[2] += moment * velocity[2] - y * velocity[0] + x * velocity[1]
