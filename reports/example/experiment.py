"""The experiment that the example's videos show: what is true of it, and how the part moves.

The motion is that of the blind benchmark's generator (compliant contact, finite mass), which shares no
code with the package. Lengths in um, angles in rad, times in s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from reports.blind.kernel import simulate
from reports.blind.laws import Laws

Floats = npt.NDArray[np.float64]

LENGTH, WIDTH = 1560.0, 800.0
"""The part as its drawing has it, and as a camera sees its upper face."""
BURR = (0.0, 4.5)
"""By how much each short and each long edge stands out below that face, where the tip touches."""
RHO_UM2, MU = 332_000.0, 0.285
"""Film ratio and friction coefficient of tip and part."""
TIP_RADIUS = 12.5
FRAME_RATE = 20.0
STEP = 8e-5
GAP, RETRACT, REST = 90.0, 60.0, 0.4


@dataclass(frozen=True, slots=True)
class Plan:
    """A push: the pose of the part, the edge and the place where it is aimed, and its travel."""

    start: tuple[float, float, float]
    """x, y in um, θ in deg."""
    edge: int
    """0 below, 1 right, 2 above, 3 left, at heading 0."""
    place: float
    """Along the edge, counter-clockwise, from -1 to 1."""
    slant_deg: float
    """Of the travel against the edge's inward normal."""
    speed: float
    length: float

    @property
    def behind(self) -> float:
        """Direction in which the probe's shaft runs, rad: it stands on the side that it pushes from."""
        return 0.5 * math.pi * (self.edge - 1)


PLANS = (
    Plan((-40.0, 150.0, 4.0), 2, -0.55, 6.0, 120.0, 400.0),
    Plan((-150.0, 30.0, -6.0), 1, 0.40, -7.0, 120.0, 300.0),
    Plan((0.0, -160.0, -3.0), 0, -0.50, -5.0, 120.0, 400.0),
    Plan((150.0, 0.0, 9.0), 3, 0.45, 6.0, 60.0, 250.0),
    Plan((60.0, 140.0, -12.0), 2, 0.45, -9.0, 120.0, 400.0),
    Plan((-120.0, -40.0, 14.0), 1, -0.55, 9.0, 180.0, 350.0),
    Plan((-20.0, -150.0, 20.0), 0, 0.60, 8.0, 180.0, 400.0),
    Plan((30.0, 120.0, 0.0), 2, -0.20, -13.0, 60.0, 300.0),
)
"""What the laboratory recorded."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """What happened in a push.

    Attributes
    ----------
    times
        (T,) of the frames.
    poses
        (T, 3) true poses at the frames.
    tips
        (T, 2) places of the tip at the frames, as commanded.
    """

    times: Floats
    poses: Floats
    tips: Floats


def moved(plan: Plan, burr: tuple[float, float] = BURR) -> Motion:
    """The motion of a push.

    Parameters
    ----------
    plan
        The push; it is aimed at the part of the drawing.
    burr
        By how much the edges stand out.
    """
    times, way = _path(plan)
    start = np.array([*plan.start[:2], math.radians(plan.start[2])])
    frames = np.arange(int(times[-2] * FRAME_RATE) + 1) / FRAME_RATE
    half = np.array([0.5 * LENGTH, 0.5 * WIDTH])
    outline = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * (half + burr)
    path = np.column_stack([times, way])
    poses, _ = simulate(Laws(mu=MU), outline, _film(), path, start, frames, STEP)
    tips = np.column_stack([np.interp(frames, times, way[:, k]) for k in range(2)])
    return Motion(times=frames, poses=poses, tips=tips)


def _film() -> Floats:
    """(4, 3) nodes of a uniform film of the true ratio, and the relative pressure there."""
    side = math.sqrt(RHO_UM2 / (LENGTH**2 + WIDTH**2))
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return np.column_stack([signs * [side * LENGTH, side * WIDTH], np.ones(4)])


def _path(plan: Plan) -> tuple[Floats, Floats]:
    """Times (K,) and places (K, 2) of the corners of the tip's path."""
    angle = 0.5 * math.pi * (plan.edge - 1)
    normal = np.array([round(math.cos(angle)), round(math.sin(angle))], dtype=np.float64)
    along = np.array([-normal[1], normal[0]])
    point = 0.5 * np.array([LENGTH, WIDTH]) * (normal + plan.place * along) + TIP_RADIUS * normal
    heading = math.radians(plan.start[2])
    touch = np.array(plan.start[:2]) + _turned(point, heading)
    ahead = _turned(-normal, heading + math.radians(plan.slant_deg))
    end = plan.length
    stops = np.array([-GAP, -GAP, end, end, end - RETRACT, end - RETRACT])
    push, back = (GAP + end) / plan.speed, RETRACT / plan.speed
    spans = np.array([REST, push, REST, back, REST])
    times = np.concatenate([[0.0], np.cumsum(spans)])
    way = touch + stops[:, None] * ahead
    return np.append(times, 1e4), np.vstack([way, way[-1:]])


def _turned(vector: Floats, angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])
