"""Clean recording sets of a pushed part, made by the simulator with noise and lost frames."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.laboratory.filming import Camera, film
from meso_robust.recordings import PositionSource, Recording, RecordingSet, SensorInfo
from meso_robust.simulator import Effects, Film, Point, Push, Round
from meso_robust.simulator.observation import Sensor

Floats = npt.NDArray[np.float64]
UM = 1e-6
OUTLINES = (
    np.array([[-808.0, -418.5], [808, -418.5], [808, 418.5], [-808, 418.5]]) * UM,
    np.array([[-500.0, -400], [700, -400], [-200, 800]]) * UM,
    np.array([[-600.0, -600], [600, -600], [600, 0], [0, 0], [0, 600], [-600, 600]]) * UM,
)


@dataclass(frozen=True, kw_only=True)
class Kind:
    """What a clean set is made of."""

    seed: int
    outline: int = 0
    tips: int = 1
    radius: float = 12.5 * UM
    speed: float = 75 * UM
    position_sigma: float = 1.2 * UM
    orientation_sigma: float = 1.4e-3
    correlation_time: float = 0.0
    dropout: float = 0.1
    latency_ms: float = 0.0
    seen_tips: bool = False
    stated: bool = True
    wrapped: bool = True
    runs: int = 3


def made(kind: Kind) -> RecordingSet:
    """Pushes from random sides: rest, approach, push, rest, retract, rest."""
    rng = np.random.default_rng(kind.seed)
    outline = OUTLINES[kind.outline]
    starts = np.column_stack(
        (rng.uniform(-3e-3, 3e-3, (kind.runs, 2)), rng.uniform(-9, 9, kind.runs))
    )
    places = [_places(outline, pose, kind, rng) for pose in starts]
    waypoints = np.array(places)
    ways = np.linalg.norm(np.diff(waypoints, axis=1), axis=3).max(axis=(0, 2))
    times = np.concatenate(([0.0], np.cumsum(np.maximum(ways / kind.speed, 0.7))))
    push = Push(
        vertices=outline,
        poses=starts,
        waypoints=waypoints,
        times=times[None],
        friction=rng.uniform(0.1, 0.6, kind.runs),
        support=Film.ratio(rng.uniform(0.5, 1.5) * 0.3 * UM),
        shapes=(Round(radius=kind.radius) if kind.radius else Point(),) * kind.tips,
        effects=Effects({"camera_latency": {"time_ms": kind.latency_ms}}),
        step=2 * UM,
    )
    sensor = Sensor(
        position_sigma=kind.position_sigma,
        orientation_sigma=kind.orientation_sigma,
        frame_rate=30.0,
        correlation_time=kind.correlation_time,
        dropout=kind.dropout,
    )
    source: PositionSource = "camera" if kind.seen_tips else "controller"
    _, found = film(push, Camera(sensor=sensor, effects=Effects(), source=source), rng)
    if not kind.stated:
        found = replace(found, sensor=SensorInfo(frame_rate=30.0))
    if kind.wrapped:
        found = replace(found, recordings=tuple(map(_wrapped, found.recordings)))
    return found


def _wrapped(recording: Recording) -> Recording:
    poses = recording.poses.copy()
    poses[:, 2] = np.angle(np.exp(1j * poses[:, 2]))
    return replace(recording, poses=poses)


def _places(outline: Floats, pose: Floats, kind: Kind, rng: np.random.Generator) -> Floats:
    """(6, P, 2) waypoints: towards a side of the part, some way into where it is, and back."""
    side = int(rng.integers(len(outline)))
    a, b = outline[side], outline[(side + 1) % len(outline)]
    along = (b - a) / np.linalg.norm(b - a)
    inward = np.array([-along[1], along[0]])
    if kind.outline == 2 and side in (2, 3):  # the notch: another tip or corner may be in the way
        return _places(outline, pose, kind, rng)
    middle = rng.uniform(0.35, 0.65)
    shares = [middle] if kind.tips == 1 else [middle - 0.2, middle + 0.2]
    c, s = np.cos(pose[2]), np.sin(pose[2])
    turn = np.array([[c, -s], [s, c]])
    gap, depth = rng.uniform(60, 150) * UM, rng.uniform(60, 300) * UM
    angle = rng.uniform(-0.5, 0.5) if kind.tips == 1 else 0.0
    way = np.cos(angle) * inward + np.sin(angle) * along
    tips = []
    for share in shares:
        touch = a + share * (b - a) - kind.radius * inward
        far, deep = touch - gap * way, touch + depth * way
        tips.append([far, far, deep, deep, far, far])
    return np.asarray(np.array(tips).transpose(1, 0, 2) @ turn.T + pose[:2])
