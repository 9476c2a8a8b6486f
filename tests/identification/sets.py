"""Recording sets of known truth, made without the stepper where that is possible.

Motion on a film is from the event-driven engine, which shares no code with the one that fits.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.recordings import (
    PositionSource,
    RecordingSet,
    Rectangle,
    SensorInfo,
    from_simulation,
)
from meso_robust.simulator import Film, Outcome, Push, Round, ThreePoints, exact, simulate
from meso_robust.simulator.observation import Sensor, sense

Floats = npt.NDArray[np.float64]

UM = 1e-6
PART = Rectangle(length=1616 * UM, width=837 * UM)
RADIUS = 12.5 * UM
SPEED = 75 * UM
SENSOR = Sensor(
    position_sigma=1.2 * UM, orientation_sigma=np.radians(0.08), frame_rate=30.0, dropout=0.03
)
FIRST_TABLE_POINTS = np.array([[-563.3, -411.3], [605.9, 409.1], [-102.1, 273.2]]) * UM
"""Support points of the paper's p1*, the part's long axis turned from y to x."""


@dataclass(frozen=True, slots=True, eq=False)
class Pushes:
    """Starts (N, 3), tips (N, 1, 2) and travels (N, 1, 2) of straight pushes, m and rad."""

    poses: Floats
    tips: Floats
    travels: Floats


def random_pushes(rng: np.random.Generator, count: int, slant: float = 0.35) -> Pushes:
    """Pushes at random places of all sides, slanted by up to `slant` rad, at random poses."""
    half = 0.5 * np.array([PART.length, PART.width])
    poses, tips, travels = np.zeros((count, 3)), np.zeros((count, 1, 2)), np.zeros((count, 1, 2))
    for k in range(count):
        axis, side = int(rng.random() < 0.6), float(rng.choice([-1.0, 1.0]))
        normal = np.eye(2)[axis] * side
        place = np.where(np.arange(2) == axis, side, rng.uniform(-0.85, 0.85)) * half
        poses[k] = [*rng.uniform(-500 * UM, 500 * UM, 2), rng.uniform(-np.pi, np.pi)]
        body = turned(poses[k, 2])
        tips[k, 0] = poses[k, :2] + body @ (place + (RADIUS + 15 * UM) * normal)
        travels[k, 0] = -600 * UM * turned(rng.uniform(-slant, slant)) @ body @ normal
    return Pushes(poses, tips, travels)


def turned(angle: float) -> Floats:
    """Rotation by an angle in rad."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def push_of(pushes: Pushes, support: Film | ThreePoints, friction: float, step: float) -> Push:
    return Push.straight(
        vertices=PART.outline,
        poses=pushes.poses,
        tips=pushes.tips,
        travel=pushes.travels,
        friction=np.full(len(pushes.poses), friction),
        support=support,
        shapes=(Round(RADIUS),),
        step=step,
        speed=SPEED,
    )


def recorded(
    pushes: Pushes,
    support: Film | ThreePoints,
    friction: float,
    rng: np.random.Generator,
    *,
    sensor: Sensor = SENSOR,
    source: PositionSource = "controller",
) -> RecordingSet:
    """What a camera sees of the pushes that do not jam."""
    push = push_of(pushes, support, friction, 1.0 * UM)
    duration = float(push.times[0, -1])
    count = 4 * int(np.ceil(duration * sensor.frame_rate))
    times = np.linspace(0.0, duration, count + 1)
    if isinstance(support, Film):
        moved = exact(push, samples=count)
        path, outcomes = moved.path, moved.outcomes
    else:
        instants = np.minimum(times, push.times[:, -1:])  # durations differ by rounding
        result = simulate(push, instants=instants)
        shorter = simulate(replace(push, step=0.5 * push.step), instants=instants)
        # the stepper's error is of first order where something slips; two steps tell the limit
        path, outcomes = 2.0 * shorter.path - result.path, shorter.outcomes
    kept = outcomes == Outcome.COMPLETED
    share = np.linspace(0.0, 1.0, count + 1)[None, :, None, None]
    tips = pushes.tips[:, None] + share * pushes.travels[:, None]
    seen = source == "camera"
    frames = sense(sensor, times, path[kept], tips[kept], rng, probes_seen_by_camera=seen)
    return from_simulation(
        frames.times,
        frames.poses,
        frames.probes,
        part=PART,
        tip_radius=RADIUS,
        position_source=source,
        sensor=SensorInfo(
            frame_rate=sensor.frame_rate,
            position_sigma=sensor.position_sigma or None,
            orientation_sigma=sensor.orientation_sigma or None,
        ),
    )


def first(recordings: RecordingSet, count: int) -> RecordingSet:
    """The first few recordings of a set."""
    return replace(recordings, recordings=recordings.recordings[:count])
