"""Recordings of pushes in the foreign plant, seen by a camera of its own.

The plant is `meso_robust.plant`: a part with mass, pushed by a compliant round tip on a film
that is a quadrature over nodes. Nothing is shared with the package's simulator but the format of the
recordings. `Wrongs` are small things that no catalogue lists together: contact compliance, stamps that
jitter, noise of the tip's log, an uneven film, rounded corners; `Concealed` is what is to be found.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from meso_robust.plant.kernel import TIP, Grain, advance
from meso_robust.plant.laws import Laws
from meso_robust.recordings import Recording, RecordingSet, Rectangle, SensorInfo
from meso_robust.types import Floats

UM = 1e-6
LENGTH, WIDTH, RADIUS = 1616.0, 837.0, 12.5
"""um: of the part and of the tip."""
RHO_UM, MU = 470.0, 0.31
"""Square root of the film's ratio in um, and friction at the tip."""
SIGMA_UM, SIGMA_DEG, RATE = 1.2, 0.08, 30.0
REST_S, BACK_UM = 0.7, 60.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Wrongs:
    """Small things that are wrong with every set, in the units of their names."""

    compliance_um: float = 0.05
    jitter_ms: float = 0.5
    tip_log_um: float = 0.05
    anisotropy: float = 0.004
    rounding_um: float = 3.0


NONE = Wrongs(compliance_um=0.01, jitter_ms=0.0, tip_log_um=0.0, anisotropy=0.0, rounding_um=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Concealed:
    """What is to be found, in the units of its names."""

    camera_turn_deg: float = 0.0
    camera_scale: float = 0.0
    latency_ms: float = 0.0
    wider_um: float = 0.0
    anisotropy: float = 0.0
    anisotropy_deg: float = 20.0
    edge_friction: float = 0.0
    centre_um: tuple[float, float] = (0.0, 0.0)
    drift_um_s: tuple[float, float] = (0.0, 0.0)
    shift_um: tuple[float, float] = (0.0, 0.0)
    play_x_um: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Pushes:
    """How the pushes are made: ranges that are drawn from."""

    count: int = 12
    speeds: tuple[float, ...] = (40.0, 75.0, 150.0)
    length_um: float = 280.0
    tip_radius_um: float = RADIUS
    spread_um: float = 500.0
    wait_s: tuple[float, float] = field(default=(0.4, 0.9))


def outline_of(wider: float, rounding: float) -> Floats:
    """(V, 2) corners in um, each cut by a chamfer of three pieces where it is rounded."""
    x, y = 0.5 * LENGTH, 0.5 * (WIDTH + wider)
    corners = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    if rounding == 0.0:
        return corners
    points = []
    for k, corner in enumerate(corners):
        middle = corner - rounding * np.sign(corner)
        angles = np.radians(np.array([180.0, 210.0, 240.0, 270.0]) + 90.0 * k)
        points += [middle + rounding * np.array([np.cos(a), np.sin(a)]) for a in angles]
    return np.array(points)


def made(
    seed: int, concealed: Concealed, wrongs: Wrongs = Wrongs(), pushes: Pushes = Pushes()
) -> RecordingSet:
    """A recording set.

    Parameters
    ----------
    seed
        Of poses, pushes and noise.
    concealed, wrongs
        What is wrong.
    pushes
        What is done.
    """
    rng = np.random.default_rng(seed)
    recordings = tuple(_pushed(rng, k, concealed, wrongs, pushes) for k in range(pushes.count))
    return RecordingSet(
        part=Rectangle(length=LENGTH * UM, width=WIDTH * UM),
        tip_radius=pushes.tip_radius_um * UM,
        position_source="controller",
        sensor=SensorInfo(frame_rate=RATE, position_sigma=None, orientation_sigma=None),
        recordings=recordings,
    )


def _pushed(
    rng: np.random.Generator, k: int, concealed: Concealed, wrongs: Wrongs, pushes: Pushes
) -> Recording:
    axis, side = k % 2, float(1 - 2 * (k // 2 % 2))
    half = 0.5 * np.array([LENGTH, WIDTH + concealed.wider_um])
    normal = np.eye(2)[axis] * side
    place = np.where(np.arange(2) == axis, side, rng.uniform(-0.75, 0.75, 2)) * half
    pose = np.array(
        [*rng.uniform(-pushes.spread_um, pushes.spread_um, 2), rng.uniform(-np.pi, np.pi)]
    )
    speed = float(rng.choice(pushes.speeds))
    gap, slant = rng.uniform(30.0, 45.0), rng.uniform(-0.25, 0.25)
    body, way = _turn(pose[2]), gap + pushes.length_um
    start = pose[:2] + body @ (place + (pushes.tip_radius_um + gap) * normal)
    ahead = -_turn(slant) @ body @ normal
    wait = rng.uniform(*pushes.wait_s)
    clock = np.cumsum([0.0, wait, way / speed, BACK_UM / speed, REST_S])
    along = np.array([0.0, 0.0, way, way - BACK_UM, way - BACK_UM])
    times = np.arange(0.0, clock[-1], 1.0 / RATE)
    tips = start + np.interp(times, clock, along)[:, None] * ahead
    mu = MU * (1.0 + (concealed.edge_friction if k % 4 == 0 else 0.0))
    instants = times - 1e-3 * concealed.latency_ms
    seen_tips = start + np.interp(instants, clock, along)[:, None] * ahead
    seen_tips[:, 0] = _carried(seen_tips[:, 0], concealed.play_x_um)
    poses = _moved(pose, seen_tips, speed, mu, concealed, wrongs, pushes.tip_radius_um)
    poses[:, :2] += np.array(concealed.drift_um_s) * times[:, None]
    poses[:, :2] = (
        (1.0 + concealed.camera_scale)
        * poses[:, :2]
        @ _turn(np.radians(concealed.camera_turn_deg)).T
    )
    poses[:, :2] += concealed.shift_um
    poses[:, 2] += np.radians(concealed.camera_turn_deg)
    noise = rng.normal(size=poses.shape) * [SIGMA_UM, SIGMA_UM, np.radians(SIGMA_DEG)]
    stamps = times + 1e-3 * wrongs.jitter_ms * rng.uniform(-1.0, 1.0, len(times))
    stamps[0] = 0.0
    logged = tips + wrongs.tip_log_um * rng.normal(size=tips.shape)
    return Recording(
        file=f"push_{k:02d}.csv",
        probe_names=("probe1",),
        times=stamps,
        poses=(poses + noise) * [UM, UM, 1.0],
        probes=logged[:, None] * UM,
    )


def _carried(screw: Floats, play: float) -> Floats:
    """Where a slide stands that a nut carries by one flank or the other, at first by that behind it."""
    at, path = screw[0], []
    for place in screw:
        at = min(max(at, place - play), place)
        path.append(at)
    return np.array(path)


def _moved(
    pose: Floats,
    tips: Floats,
    speed: float,
    mu: float,
    concealed: Concealed,
    wrongs: Wrongs,
    radius: float,
) -> Floats:
    """(T, 3) poses in um and rad as the plant has them while the tip is at tips (T, 2)."""
    outline = outline_of(concealed.wider_um, wrongs.rounding_um)
    grain = Grain(overlap=max(wrongs.compliance_um, 0.01), coast=0.02, speed=speed, deepest=20.0)
    nodes = RHO_UM * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]) / np.sqrt(2.0)
    nodes = nodes + np.array(concealed.centre_um)
    angle = 2.0 * np.radians(concealed.anisotropy_deg)
    whole = concealed.anisotropy * np.array([np.cos(angle), np.sin(angle)])
    nodes = np.column_stack([nodes, np.ones(4)])
    film = (nodes, np.array([0.0, wrongs.anisotropy, *whole]), Laws())
    body = np.zeros((1, TIP))
    body[0, :2], body[0, 4] = tips[0], radius
    state = (pose.copy(), np.zeros(3), np.zeros(1), np.zeros(1))
    path = [pose.copy()]
    for before, after in pairwise(tips):
        way = (after - before)[None]
        if way.any():
            duration = float(np.hypot(*way[0])) / speed
            advance(outline, film, body, way, np.array([mu]), grain, state, duration)
        path.append(state[0].copy())
    return np.array(path)


def _turn(angle: float) -> Floats:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
