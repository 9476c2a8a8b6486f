"""Planar quasi-static pushing, simulated by two engines.

A part slides on a film or on dry contact and is pushed by probe tips with prescribed paths, with
Coulomb friction at the contacts. `simulate` takes any move in complementarity time steps; `exact`
follows a move on a film from event to event, by code of its own, so that the two check each other.
The simulator is the judge of the verified bounds and shares no
code with them.
"""

from meso_robust.simulator.batch import simulate as simulate
from meso_robust.simulator.effects import Effects as Effects
from meso_robust.simulator.exact import exact as exact
from meso_robust.simulator.fixture import Fixture as Fixture
from meso_robust.simulator.motion_model import (
    Dynamic as Dynamic,
    FirstOrder as FirstOrder,
    QuasiStatic as QuasiStatic,
)
from meso_robust.simulator.outcome import Outcome as Outcome
from meso_robust.simulator.push import Push as Push, PushResult as PushResult
from meso_robust.simulator.support_models import (
    Film as Film,
    LimitSurface as LimitSurface,
    Mixture as Mixture,
    PressurePoints as PressurePoints,
    ThreePoints as ThreePoints,
)
from meso_robust.simulator.tips import Flat as Flat, Point as Point, Round as Round
