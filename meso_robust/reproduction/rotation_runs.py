"""The rotation of Table IV at the printed separation of the tips, and at ones that do not jam."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval
from meso_robust.conditions import values
from meso_robust.planning.nominal import straightens
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.reproduction.primitive_runs import (
    WIDTH_UM,
    Measured,
    lying,
    measured,
    net,
    nominal_runs,
    rotation,
)
from meso_robust.types import Floats

PRINTED_SEPARATION_UM = 857.0
"""Eq. (10): 837 um and twice the errors of sensing and control."""
CORRECTED_UM = 930.0
"""A separation that does not jam at any stated friction: d_w sqrt(1 + mu^2) is 890 um at 0.36."""
PUSH_UM = 1100.0  # of Table IV
LONGEST_UM = 2500.0
"""A push after which a tip has passed the end of its edge."""
LOW_FRICTION = (0.05, 0.1, 0.15, 0.2)
"""At which the printed separation does not jam."""
CORRECTED = tuple(
    (separation, gap) for separation in (890.0, 910.0, 930.0) for gap in (1.0, 20.0, 60.0)
)
"""Separations without jam and gaps at the start, um: neither is printed."""
FRICTIONS = (0.30, 0.33, 0.36)
"""Ends and middle of the range of Section X-A."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rotations:
    """What the rotation does; displacements as in `Measured`."""

    least_um: tuple[float, float]
    """Separation above which nothing jams, at the smallest and the largest friction."""
    printed: Measured
    """Trials with the separation of eq. (10)."""
    frictionless: Floats
    """(4, 3) nominal with that separation, friction as ``LOW_FRICTION``."""
    without_jam: float
    """Friction below which that separation does not jam."""
    corrected: Measured
    """Trials with 930 um."""
    nominal: Floats
    """(27, 3) nominal over ``CORRECTED`` and ``FRICTIONS``."""
    longest: Floats
    """(3,) nominal with 930 um and a push that no tip survives on its edge."""
    righted_deg: float
    """Largest lean of the lying part that a nominal t² push rights."""
    enough_um: float
    """Push with 930 um that leaves so much."""
    paths: dict[float, Floats]
    """(R, 2) push in um and turn in deg of nominal runs, by separation."""


def _least_separation(friction: float, setup: Setup) -> float:
    """Separation, um, at which two contacts on opposite edges just cannot close."""
    (short,) = values("two_sided_rotation", "no_jam")(V=0.0, d1=setup.half_width.mid, mu=friction)
    return units.to_um(math.sqrt(-float(short)))


def rotations(setup: Setup, runs: int, seed: int) -> Rotations:
    """All of it; ``runs`` trials of either separation over all stated uncertainties."""
    mu = setup.uncertainty.friction
    lean = _rightable_lean_deg(lying(setup))
    width = setup.half_width.mid
    (apart,) = values("two_sided_rotation", "pair_position")(
        theta=math.radians(180.0 - lean), V=CORRECTED_UM * units.UM, d1=width
    )
    return Rotations(
        least_um=(_least_separation(mu.lo, setup), _least_separation(mu.hi, setup)),
        printed=measured([rotation(PRINTED_SEPARATION_UM, PUSH_UM, setup)], setup, runs, seed),
        frictionless=net(rotation(PRINTED_SEPARATION_UM, PUSH_UM, setup), setup, LOW_FRICTION),
        without_jam=math.sqrt((PRINTED_SEPARATION_UM / WIDTH_UM) ** 2 - 1.0),
        corrected=measured([rotation(CORRECTED_UM, PUSH_UM, setup)], setup, runs, seed),
        nominal=np.concatenate(
            [
                net(rotation(separation, PUSH_UM, setup, gap), setup, FRICTIONS)
                for separation, gap in CORRECTED
            ]
        ),
        longest=net(rotation(CORRECTED_UM, LONGEST_UM, setup), setup)[0],
        righted_deg=lean,
        enough_um=WIDTH_UM - units.to_um(float(apart)),
        paths={um: _path(um, setup) for um in (PRINTED_SEPARATION_UM, 890.0, CORRECTED_UM)},
    )


def _path(separation: float, setup: Setup) -> Floats:
    """Push and turn of the nominal run with a push longer than the edges."""
    found = nominal_runs(rotation(separation, LONGEST_UM, setup), setup, record=500).moves[0]
    gone = np.linspace(0.0, 1.0, found.path.shape[1]) * -found.travel[0, 0, 0]
    apart = found.tips[0, 0, 0] - gone - found.tips[0, 2, 0]
    turn = np.degrees(found.path[0, :, 2]) - 90.0
    return np.column_stack([WIDTH_UM - apart / units.UM, turn])


def _rightable_lean_deg(setup: Setup) -> float:
    """Largest lean of the lying part that a t² push at some height rights, every contact sticking."""
    heights = np.arange(-300e-6, 300e-6, 10e-6)
    leans = np.arange(0.5, 20.0, 0.25)
    upright = 2.0 * HALF_PI.mid

    def works(lean: float) -> bool:
        theta = Interval.point(upright - math.radians(lean))
        pre = PoseBox(x=setup.start.x, y=setup.start.y, theta=theta)
        return any(straightens(float(height), pre, setup) for height in heights)

    return max((float(lean) for lean in leans if works(float(lean))), default=0.0)
