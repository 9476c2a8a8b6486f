"""Recordings of pushes in the independent plant, with laws that the catalogue lists in no such form.

The plant is `meso_robust.plant`; hooks of a `Change` alter it from instant to instant, so that any
law can be put in. Of the package nothing else is used but what writes recordings.
Units are um, s and rad; forces are over the film's drag and hence speeds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt

from meso_robust.plant.kernel import TIP, Grain, advance, nearest
from meso_robust.plant.laws import Laws
from meso_robust.recordings import Recording, RecordingSet, Rectangle, SensorInfo, write_set

Floats = npt.NDArray[np.float64]

LENGTH, WIDTH, RADIUS = 1616.0, 837.0, 12.5
"""um: of the part and of the tip."""
MU, RHO = 0.31, 470.0
"""Friction of the tip; root of the film's ratio in um."""
SIGMAS = np.array([1.2, 1.2, np.radians(0.08)])
"""Noise of the camera, um and rad."""
RATE, SUBSTEPS = 20.0, 4
"""Frames a second, and instants of the plant in a frame at which its laws are renewed."""
SPEEDS = (40.0, 80.0, 150.0)
TRAVEL, BACK, REST = 280.0, 60.0, 0.6
"""um pushed, um drawn back, s of rest after it."""
PUSHES = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Instant:
    """What a law may depend on."""

    pose: Floats
    speed: Floats
    tip: Floats
    time: float
    places: Floats
    """(Q, 2) nodes of the film in the stage's frame, from its origin."""
    own: Floats
    """(Q, 2) the same in the part's frame."""
    slips: Floats
    """(Q, 2) their velocities."""
    gap: float
    """Between tip and part."""
    at: Floats
    """(2,) tip in the part's frame."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """What differs from a plain film, a rigid tip and a perfect camera."""

    drag: Callable[[Instant], Floats] | None = None
    """(Q,) force against the slip at every node, um/s."""
    force: Callable[[Instant], Floats] | None = None
    """(2,) force on the part."""
    friction: Callable[[Instant], float] | None = None
    """Factor of the tip's friction."""
    adhesion: Callable[[float], float] | None = None
    """Pull at a gap, once touched."""
    attraction: Callable[[float], float] | None = None
    """Pull at a gap, touched or not."""
    give: Callable[[float], float] | None = None
    """Compliance of the tip in s for a heading of the push."""
    drive: Callable[[Floats, Floats], Floats] | None = None
    """True way of the tip for times (T,) and commanded way (T, 2)."""
    see: Callable[[Floats, Floats], Floats] | None = None
    """Seen poses for times (T,) and true poses (T, 3), fine instants."""
    corners: Callable[[Floats], Floats] | None = None
    """True corners (4, 2) for stated ones."""
    truth: Mapping[str, float] = field(default_factory=dict)
    """Numbers that the catalogue has too, in its units."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wrongs:
    """Small things that are wrong with a set at once."""

    compliance_um: float = 0.005
    jitter_ms: float = 0.0
    tip_log_um: float = 0.0
    lay: float = 0.0
    lay_deg: float = 0.0
    rounding_um: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """What is true of a set."""

    changes: tuple[Change, ...] = ()
    wrongs: Wrongs = Wrongs()
    mu: float = MU
    rho: float = RHO


@dataclass(frozen=True, slots=True, kw_only=True)
class Push:
    """A push as commanded, at fine instants."""

    start: Floats
    times: Floats
    tips: Floats


def small_wrongs(rng: np.random.Generator) -> Wrongs:
    """Wrongs of a set: none of them zero."""
    return Wrongs(
        compliance_um=float(rng.uniform(0.02, 0.08)),
        jitter_ms=float(rng.uniform(0.2, 1.0)),
        tip_log_um=float(rng.uniform(0.02, 0.08)),
        lay=float(rng.uniform(0.0005, 0.002)),
        lay_deg=float(rng.uniform(0.0, 180.0)),
        rounding_um=float(rng.uniform(1.0, 4.0)),
    )


def turn(angle: float) -> Floats:
    """Rotation matrix."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def pushes(rng: np.random.Generator, count: int = PUSHES) -> list[Push]:
    """Pushes on all edges at several speeds, places and headings."""
    return [_push(rng, k) for k in range(count)]


def _push(rng: np.random.Generator, k: int) -> Push:
    axis, side = k % 2, float(1 - 2 * (k // 2 % 2))
    half = 0.5 * np.array([LENGTH, WIDTH])
    normal = np.eye(2)[axis] * side
    place = np.where(np.arange(2) == axis, side, rng.uniform(-0.7, 0.7, 2)) * half
    pose = np.array([*rng.uniform(-500.0, 500.0, 2), rng.uniform(-np.pi, np.pi)])
    speed, gap = SPEEDS[(k + int(rng.integers(3))) % 3], rng.uniform(30.0, 45.0)
    body, way = turn(pose[2]), gap + TRAVEL
    start = pose[:2] + body @ (place + (RADIUS + gap) * normal)
    ahead = -turn(rng.uniform(-0.25, 0.25)) @ body @ normal
    clock = np.cumsum([0.0, rng.uniform(0.5, 0.9), way / speed, BACK / speed, REST])
    times = np.arange(0.0, clock[-1], 1.0 / (RATE * SUBSTEPS))
    along = np.interp(times, clock, [0.0, 0.0, way, way - BACK, way - BACK])
    return Push(start=pose, times=times, tips=start + along[:, None] * ahead)


def corners_of(world: World) -> Floats:
    """(V, 2) true outline, with its corners rounded."""
    half = 0.5 * np.array([LENGTH, WIDTH])
    sharp = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * half
    for change in world.changes:
        sharp = change.corners(sharp) if change.corners else sharp
    radius = world.wrongs.rounding_um
    if radius == 0.0:
        return sharp
    arcs = []
    for k, corner in enumerate(sharp):
        middle = corner - radius * np.sign(corner)
        angles = np.radians(np.array([180.0, 210.0, 240.0, 270.0]) + 90.0 * k)
        arcs += [middle + radius * np.array([np.cos(a), np.sin(a)]) for a in angles]
    return np.array(arcs)


def film_nodes(rho: float) -> Floats:
    """(Q, 2) nodes of equal weight whose second moment is the film's ratio."""
    x, y = (np.arange(9) - 4.0) * LENGTH / 9.0, (np.arange(5) - 2.0) * WIDTH / 5.0
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.asarray(grid * rho / np.sqrt(np.mean(np.sum(grid**2, axis=1))))


def moved(world: World, push: Push) -> Floats:
    """(T, 3) true poses at the fine instants of a push."""
    outline, own = corners_of(world), film_nodes(world.rho)
    wrongs, changes = world.wrongs, world.changes
    grain = Grain(overlap=max(wrongs.compliance_um, 0.005), coast=0.05, deepest=60.0)
    angle = 2.0 * np.radians(wrongs.lay_deg)
    lay = np.array([0.0, 0.0, wrongs.lay * np.cos(angle), wrongs.lay * np.sin(angle)])
    tips = push.tips
    for change in changes:
        tips = change.drive(push.times, tips) if change.drive else tips
    away = push.tips - push.tips[0]
    heading = away[np.argmax(np.hypot(*away.T))]
    give = sum(c.give(np.arctan2(heading[1], heading[0])) for c in changes if c.give)
    body = np.zeros((1, TIP))
    body[0, :2], body[0, 4] = tips[0], RADIUS
    state = (push.start.copy(), np.zeros(3), np.zeros(1), np.zeros(1))
    path = np.empty((len(tips), 3))
    path[0] = push.start
    base = Laws(compliance=float(give), adhesion_range=0.0)
    for k, (before, after) in enumerate(pairwise(tips)):
        laws, pressure, mu = _renewed(base, world, (outline, own), state, before)
        support = (np.column_stack([own, pressure]), lay, laws)
        friction = np.array([mu])
        duration = push.times[k + 1] - push.times[k]
        advance(outline, support, body, (after - before)[None], friction, grain, state, duration)
        path[k + 1] = state[0]
    return path


def _renewed(
    base: Laws,
    world: World,
    shape: tuple[Floats, Floats],
    state: tuple[Floats, Floats, Floats, Floats],
    tip: Floats,
) -> tuple[Laws, Floats, float]:
    pose, speed, time, _ = state
    outline, own = shape
    c, s = np.cos(pose[2]), np.sin(pose[2])
    arms = own @ np.array([[c, s], [-s, c]])
    away = tip - pose[:2]
    at = np.array([c * away[0] + s * away[1], c * away[1] - s * away[0]])
    instant = Instant(
        pose=pose,
        speed=speed,
        tip=tip,
        time=float(time[0]),
        places=pose[:2] + arms,
        own=own,
        slips=speed[:2] + speed[2] * np.column_stack([-arms[:, 1], arms[:, 0]]),
        gap=float(nearest(outline, *at)[0]) - RADIUS,
        at=at,
    )
    laws, pressure, mu = base, np.zeros(len(own)), world.mu
    for change in world.changes:
        if change.drag:
            pressure += change.drag(instant)
        if change.force:
            x, y = change.force(instant)
            laws = laws._replace(force_x=laws.force_x + x, force_y=laws.force_y + y)
        if change.friction:
            mu *= change.friction(instant)
        if change.adhesion:
            pull = change.adhesion(max(instant.gap, 0.0))
            laws = laws._replace(adhesion=pull, adhesion_range=1e3 if pull > 0.0 else 0.0)
        if change.attraction:
            laws = laws._replace(
                attraction=change.attraction(max(instant.gap, 0.0)), attraction_range=1e9
            )
    return laws._replace(uneven=1.0 if pressure.any() else 0.0), pressure, mu


def filmed(world: World, push: Push) -> Floats:
    """(F, 3) poses at the frames as a camera without noise sees them."""
    poses = moved(world, push)
    for change in world.changes:
        poses = change.see(push.times, poses) if change.see else poses
    return poses[::SUBSTEPS]


def recorded(
    world: World, plan: list[Push], seen: list[Floats], rng: np.random.Generator
) -> RecordingSet:
    """The set as it is written, with noise, jitter and what the controller logged."""
    wrongs = world.wrongs
    rows = []
    for k, (push, poses) in enumerate(zip(plan, seen, strict=True)):
        times = push.times[::SUBSTEPS]
        stamps = times + 1e-3 * wrongs.jitter_ms * rng.uniform(-1.0, 1.0, len(times))
        stamps[0] = 0.0
        tips = push.tips[::SUBSTEPS]
        logged = tips + wrongs.tip_log_um * rng.normal(size=tips.shape)
        noisy = poses + SIGMAS * rng.normal(size=poses.shape)
        rows.append(
            Recording(
                file=f"push_{k:02d}.csv",
                probe_names=("probe1",),
                times=stamps,
                poses=noisy * [1e-6, 1e-6, 1.0],
                probes=logged[:, None] * 1e-6,
            )
        )
    return RecordingSet(
        part=Rectangle(length=LENGTH * 1e-6, width=WIDTH * 1e-6),
        tip_radius=RADIUS * 1e-6,
        position_source="controller",
        sensor=SensorInfo(frame_rate=RATE, position_sigma=None, orientation_sigma=None),
        recordings=tuple(rows),
    )


def clear_norm(world: World, plan: list[Push]) -> Callable[[list[Floats]], float]:
    """Measure of a change of poses in standard deviations of the camera's noise.

    What another start of each push, another friction or another ratio of the film would do as well
    is projected out: these a plain model fits.
    """
    base = [filmed(world, push) for push in plan]
    columns = []
    for near in (replace(world, mu=world.mu + 0.004), replace(world, rho=world.rho * 1.005)):
        columns.append(_level([filmed(near, p) for p in plan], base))
    basis = np.linalg.qr(np.stack(columns, axis=1))[0]

    def norm(seen: list[Floats]) -> float:
        change = _level(seen, base)
        return float(np.linalg.norm(change - basis @ (basis.T @ change)))

    return norm


def _level(seen: list[Floats], base: list[Floats]) -> Floats:
    parts = [(a - b) / SIGMAS for a, b in zip(seen, base, strict=True)]
    return np.concatenate([(part - part.mean(axis=0)).ravel() for part in parts])


def write(folder: Path, made: RecordingSet) -> None:
    """Write a set as a folder."""
    write_set(folder, made)
