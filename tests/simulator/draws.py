"""Random moves of the property campaign, one for each seed."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import Fixture, Flat, Point, Push, Round
from meso_robust.simulator.outline import check_outline
from meso_robust.simulator.tips import Tip
from tests.simulator.oracle import crosses, placed, signed_distance, turned

F = npt.NDArray[np.float64]

UM = 1e-6
STEP = 2e-6


def star(rng: np.random.Generator, corners: int, least: float) -> F:
    """A star-shaped outline about the origin, mostly not convex."""
    angle = (np.arange(corners) + rng.uniform(-0.3, 0.3, corners)) * 2 * np.pi / corners
    radius = rng.uniform(least, 1.0, corners)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def convex(rng: np.random.Generator, corners: int) -> F:
    """Corners on a circle, squeezed and turned."""
    angle = (np.arange(corners) + rng.uniform(-0.35, 0.35, corners)) * 2 * np.pi / corners
    round_one = np.column_stack([np.cos(angle), rng.uniform(0.4, 1.0) * np.sin(angle)])
    return np.asarray(round_one @ turned(rng.uniform(0, 2 * np.pi)).T)


L_SHAPE = np.array([[-4, -4], [8, -4], [8, 2], [2, 2], [2, 8], [-4, 8]]) / 11.4
U_SHAPE = np.array([[-7, -6], [7, -6], [7, 6], [4, 6], [4, -2], [-4, -2], [-4, 6], [-7, 6]]) / 9.3
COMB = (
    np.array(
        [[-9, -5], [9, -5], [9, 5], [5, 5], [5, 0], [2, 0], [2, 5], [-2, 5], [-2, 0], [-5, 0],
         [-5, 5], [-9, 5]]
    ) / 10.3
)  # fmt: skip


def outline(rng: np.random.Generator) -> F:
    """A part of 300 to 900 µm radius."""
    kind = rng.integers(6)
    if kind < 2:
        shape = convex(rng, int(rng.integers(3, 8)))
    elif kind < 4:
        shape = star(rng, int(rng.integers(5, 10)), 0.45)
    else:
        shape = (L_SHAPE, U_SHAPE, COMB)[rng.integers(3)]
    return np.asarray((shape - shape.mean(axis=0)) * rng.uniform(300, 900) * UM)


def tip_corners(shape: Tip, where: F) -> F:
    """Corners (K, 2) of a tip in the world; of a disc its centre."""
    return shape.corners + where if isinstance(shape, Flat) else where[None]


def clearance(vertices: F, pose: F, shape: Tip, where: F) -> float:
    """Gap of a tip, negative inside."""
    world = placed(vertices, pose)
    corners = tip_corners(shape, where)
    gap = float(signed_distance(world, corners).min()) - shape.radius
    if isinstance(shape, Flat):
        gap = min(gap, float(signed_distance(corners, world).min()))
        gap = min(gap, -np.inf if crosses(world, corners) else np.inf)
    return gap


def _tip(rng: np.random.Generator, facing: float) -> Tip:
    kind = rng.integers(3)
    if kind == 0:
        return Point()
    if kind == 1:
        return Round(float(rng.uniform(5, 200)) * UM)
    return Flat(facing, float(rng.choice([25.0, 60.0, 200.0])) * UM)


def _approach(rng: np.random.Generator, vertices: F, pose: F, shape: Tip, way: float) -> F | None:
    """A start on a line through the part, 0 to 10 µm before contact."""
    ahead = np.array([np.cos(way), np.sin(way)])
    across = np.array([-ahead[1], ahead[0]])
    size = float(np.hypot(*vertices.T).max())
    line = pose[:2] + rng.uniform(-0.9, 0.9) * size * across
    behind, reached = line - (1.5 * size + 400 * UM) * ahead, 0.0
    for _ in range(200):
        gap = clearance(vertices, pose, shape, behind + reached * ahead)
        if gap < 1e-3 * UM:
            return behind + (reached - rng.uniform(0, 10) * UM * (rng.random() < 0.5)) * ahead
        reached += max(gap * 0.999, 1e-4 * UM)
        if reached > 3 * size + 800 * UM:
            return None
    return behind + reached * ahead


def _fixture(rng: np.random.Generator, vertices: F, pose: F) -> Fixture:
    """None, a block, a wall with a notch, or walls around."""
    kind = rng.integers(8)
    world, size = placed(vertices, pose), float(np.hypot(*vertices.T).max())
    friction = float(rng.uniform(0, 0.8))
    if kind >= 3:
        return Fixture()
    if kind == 0:  # walls around
        low, high = world.min(axis=0) - rng.uniform(0, 0.3, 2) * size, world.max(axis=0)
        high = high + rng.uniform(0, 0.3, 2) * size
        corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
        out = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 1e-3
        return Fixture(
            tuple(
                np.array([corners[k], corners[k] + out[k], corners[j] + out[j], corners[j]])
                for k, j in ((0, 1), (1, 2), (2, 3), (3, 0))
            )
            if rng.random() < 0.5
            else (corners[::-1],),
            friction,
        )
    # a block or an L put beside the part, slid up to it
    shape = convex(rng, 5) * size if kind == 1 else L_SHAPE * 1.5 * size
    shape = shape @ turned(rng.uniform(0, 2 * np.pi)).T
    way, far = rng.uniform(0, 2 * np.pi), 4.0 * size
    ahead = np.array([np.cos(way), np.sin(way)])
    for _ in range(100):
        block = pose[:2] + shape + far * ahead
        gap = min(
            float(signed_distance(world, block).min()), float(signed_distance(block, world).min())
        )
        if gap < rng.uniform(0.1, 60) * UM:
            break
        far -= 0.999 * gap
    return Fixture((block,), friction)


def draw(seed: int) -> Push | None:
    """The push of a seed, or None where no probe meets the part."""
    rng = np.random.default_rng(seed)
    vertices = outline(rng)
    check_outline("vertices", vertices)
    pose = np.append(rng.uniform(-1, 1, 2) * 1e-3, rng.uniform(-np.pi, np.pi))
    starts, ends, shapes = [], [], []
    way = rng.uniform(0, 2 * np.pi)
    for p in range(int(rng.integers(1, 4))):
        facing = way + (rng.normal(0, 0.3) if p else 0.0)
        passive = p > 0 and rng.random() < 0.5
        if passive:
            facing += np.pi + rng.normal(0, 0.5)
        shape = _tip(rng, facing)
        start = _approach(rng, vertices, pose, shape, facing)
        if start is None or clearance(vertices, pose, shape, start) < 0.0:
            continue
        aside = facing + rng.normal(0, 0.3)
        travel = 0.0 if passive else rng.uniform(100, 700) * UM
        starts.append(start)
        ends.append(start + travel * np.array([np.cos(aside), np.sin(aside)]))
        shapes.append(shape)
    if not shapes:
        return None
    fixture = _fixture(rng, vertices, pose)
    world = placed(vertices, pose)
    if any(crosses(world, solid) for solid in fixture.outlines):
        return None
    start_array, end_array = np.array(starts), np.array(ends)
    return Push.straight(
        vertices=vertices,
        poses=pose[None],
        tips=start_array[None],
        travel=(end_array - start_array)[None],
        friction=rng.uniform(0, 1, (1, len(shapes))) * (rng.random() < 0.9),
        film_ratio=float(rng.uniform(0.1, 0.6) * np.max(np.sum(vertices**2, axis=1))),
        shapes=tuple(shapes),
        fixture=fixture,
        step=STEP,
    )
