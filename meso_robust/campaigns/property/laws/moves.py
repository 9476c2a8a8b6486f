"""Random moves of a rectangle on a film: one tip or two push along -x, a third may be in the way."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st

from meso_robust.simulator import Film, Push
from meso_robust.types import Floats

UM = 1e-6
STEP = 2.0 * UM  # of the stepper, of the probes


@dataclass(frozen=True, slots=True)
class Passive:
    """A tip at rest on the far side."""

    height: float
    """Of the tip over the part's centre, as a share of the part's half height."""
    gap_um: float
    """To the part, along x."""


@dataclass(frozen=True, slots=True)
class Move:
    """A move; um, rad, um^2."""

    half_length_um: float
    half_width_um: float
    angle: float
    """Of the part, whose centre is at the origin."""
    height: float
    """Of the tip over the part's centre, as a share of the part's half height."""
    gap_um: float
    """Between tip and part, along x."""
    spacing_um: float | None
    """From the tip down to the second one; there is no second one if None."""
    travel_um: float
    friction: float
    ratio_um2: float
    """rho"""
    passive: Passive | None

    @property
    def corners(self) -> Floats:
        """(4, 2) of the part, body axes, m."""
        a, b = self.half_length_um * UM, self.half_width_um * UM
        return np.array([[-a, -b], [a, -b], [a, b], [-a, b]])

    @property
    def size(self) -> float:
        """Radius of the part, m."""
        return math.hypot(self.half_length_um, self.half_width_um) * UM


gaps = st.floats(0.001, 40.0)
heights = st.floats(-0.95, 0.95)
moves = st.builds(
    Move,
    half_length_um=st.floats(300.0, 900.0),
    half_width_um=st.floats(200.0, 600.0),
    angle=st.floats(-3.2, 3.2),
    height=heights,
    gap_um=gaps,
    spacing_um=st.none() | st.floats(100.0, 800.0),
    travel_um=st.floats(20.0, 500.0),
    friction=st.floats(0.0, 0.5),
    ratio_um2=st.floats(5e4, 8e5),
    passive=st.none() | st.builds(Passive, height=heights, gap_um=gaps),
)


def push_of(move: Move, drag: float = 1.0) -> Push:
    """The move for the simulator; all of the film's drag times ``drag``."""
    tips, travel = _tips(move)
    film = np.diag([1.0, 1.0, move.ratio_um2 * UM**2]) * drag
    return Push.straight(
        vertices=move.corners,
        poses=np.array([[0.0, 0.0, move.angle]]),
        tips=tips[None],
        travel=travel[None],
        friction=np.array([move.friction]),
        support=Film(film),
        step=STEP,
    )


def _tips(move: Move) -> tuple[Floats, Floats]:
    """(P, 2) starts and (P, 2) travel of all tips, m."""
    world = _outline(move)
    top = float(world[:, 1].max())
    high = move.height * top
    pair = [high] if move.spacing_um is None else [high, high - move.spacing_um * UM]
    ahead = max(_reach(world, y, 1.0) for y in pair) + move.gap_um * UM
    tips = [[ahead, y] for y in pair]
    travel = [[-move.travel_um * UM, 0.0]] * len(pair)
    if move.passive is not None:
        y = move.passive.height * top
        tips.append([-_reach(world, y, -1.0) - move.passive.gap_um * UM, y])
        travel.append([0.0, 0.0])
    return np.array(tips), np.array(travel)


def _outline(move: Move) -> Floats:
    c, s = math.cos(move.angle), math.sin(move.angle)
    return np.asarray(move.corners @ np.array([[c, s], [-s, c]]))


def _reach(world: Floats, y: float, way: float) -> float:
    """How far the part reaches along ``way`` times x at height ``y``; its centre if it does not."""
    found = [0.0]
    for one, other in zip(world, np.roll(world, -1, axis=0), strict=True):
        if (one[1] - y) * (other[1] - y) < 0.0:
            share = (y - one[1]) / (other[1] - one[1])
            found.append(way * float(one[0] + share * (other[0] - one[0])))
    return max(found)
