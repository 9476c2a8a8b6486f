"""Random pushes with everything at once: nothing overlaps, and forces balance at sampled poses."""

from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.optimize import nnls

from meso_robust.simulator.events import EventResult, integrate
from tests.simulator.events.reference import UM, F, cross, turn

SAMPLES = 4000
TOUCHING = 2e-9  # m
SPEED = 2e-3  # of the fastest tip; slower slips may be of either sign
BALANCE = 5e-3  # relative; differences of poses are not velocities


class Case(NamedTuple):
    """A push as `integrate` takes it."""

    vertices: F
    pose: F
    tips: F
    travel: F
    mu: float
    drag: F
    radius: float
    fixture: list[F]


def distance(point: F, polygon: F) -> float:
    """Signed distance from the solid of a polygon, by the crossing number."""
    after = np.roll(polygon, -1, axis=0)
    edge = after - polygon
    part = np.clip(((point - polygon) * edge).sum(1) / (edge**2).sum(1), 0, 1)
    nearest = float(np.hypot(*(point - polygon - part[:, None] * edge).T).min())
    above = (polygon[:, 1] > point[1]) != (after[:, 1] > point[1])
    with np.errstate(all="ignore"):
        at = polygon[:, 0] + (point[1] - polygon[:, 1]) / edge[:, 1] * edge[:, 0]
    inside = bool((above & (point[0] < at)).sum() % 2)
    clockwise = float(np.sum(polygon[:, 0] * after[:, 1] - polygon[:, 1] * after[:, 0])) < 0
    return -nearest if inside != clockwise else nearest


def random_case(rng: np.random.Generator) -> Case:
    """A star-shaped part, up to three tips around it, and maybe a pen or a block."""
    count = int(rng.integers(3, 8))
    angle = 2 * np.pi * (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count
    size = rng.uniform(250, 800, count) * UM
    vertices = np.column_stack([size * np.cos(angle), size * np.sin(angle)])
    pose = np.array([*rng.uniform(-100, 100, 2) * UM, rng.uniform(-3, 3)])
    part = pose[:2] + vertices @ turn(pose[2]).T
    radius = float(rng.choice([0.0, 12.5])) * UM
    right = part[:, 0].max() + rng.uniform(5, 100) * UM
    block = np.array([[right, -3e-4], [right + 4e-4, -3e-4], [right + 4e-4, 2e-4], [right, 2e-4]])
    pen = 1.15e-3 * np.array([[-1, -1], [-1, 1], [1, 1], [1, -1.0]])
    fixture: list[F] = [[], [pen], [block]][int(rng.integers(3))]
    tips: list[F] = []
    while len(tips) < 1 + count % 3:
        tip = pose[:2] + rng.uniform(-1.2, 1.2, 2) * 1e-3
        room = min([distance(tip, part), *(distance(tip, f) for f in fixture)])
        if radius + 5 * UM < room and distance(tip, part) < 200 * UM:
            tips.append(tip)
    way = pose[:2] + rng.uniform(-4e-4, 4e-4, (len(tips), 2)) - tips
    travel = way / np.hypot(*way.T)[:, None] * rng.uniform(300, 900, (len(tips), 1)) * UM
    travel[1:] *= rng.random((len(tips) - 1, 1)) < 0.6
    skew = 0.3 * rng.uniform(-1, 1, (3, 3))
    stretch = np.diag([1, 1, 1e-3])
    drag = stretch @ (np.diag([1, 1, 0.3]) + skew @ skew.T) @ stretch
    mu = float(rng.choice([0.0, 0.2, 0.5, 1.0]))
    return Case(vertices, pose, np.array(tips), travel, mu, drag, radius, fixture)


def take(case: Case, samples: int) -> EventResult:
    shape = (1, len(case.tips))
    return integrate(
        vertices=case.vertices,
        poses=case.pose[None],
        tips=case.tips[None],
        travel=case.travel[None],
        friction=np.full(shape, case.mu),
        drag=case.drag,
        radii=np.full(shape[1], case.radius),
        fixture=case.fixture,
        fixture_friction=0.5 * case.mu,
        samples=samples,
    )


def overlap(case: Case, pose: F, s: float) -> float:
    """Deepest overlap at a pose."""
    part = pose[:2] + case.vertices @ turn(pose[2]).T
    depths = [case.radius - distance(tip, part) for tip in case.tips + s * case.travel]
    for polygon in case.fixture:
        depths += [-distance(corner, polygon) for corner in part]
        depths += [-distance(corner, part) for corner in polygon]
    return max(depths)


def near(point: F, polygon: F) -> list[tuple[F, F]]:
    """Edges near a point: nearest point and outward normal."""
    found = []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        edge = b - a
        part = np.clip((point - a) @ edge / (edge @ edge), 0, 1)
        found.append((a + part * edge, np.array([edge[1], -edge[0]]) / np.hypot(*edge)))
    return found


def contacts(case: Case, pose: F, s: float) -> list[tuple[F, F, F, float]]:
    """Normal on the part, point, velocity of the obstacle and friction of what touches."""
    part = pose[:2] + case.vertices @ turn(pose[2]).T
    found = []
    for tip, speed in zip(case.tips + s * case.travel, case.travel, strict=True):
        for foot, normal in near(tip, part):
            way = foot - tip
            if abs(np.hypot(*way) - case.radius) < TOUCHING:
                inward = way / np.hypot(*way) if case.radius > 0 else -normal
                found.append((inward, foot, speed, case.mu))
    for polygon in case.fixture:
        places = [(corner, *edge, 1.0) for corner in part for edge in near(corner, polygon)]
        places += [(corner, *edge, -1.0) for corner in polygon for edge in near(corner, part)]
        for corner, foot, normal, side in places:
            if np.hypot(*(foot - corner)) < TOUCHING:
                found.append((side * normal, corner, np.zeros(2), 0.5 * case.mu))
    return found


def imbalance(case: Case, poses: F, s: float) -> float:
    """Part of the wrench of the film that no admissible forces balance, from three poses."""
    stretch = np.diag([1, 1, 1e3])
    v = (poses[2] - poses[0]) * SAMPLES / 2
    spin = np.eye(3)
    spin[:2, :2] = turn(poses[1, 2])
    wrench = stretch @ spin @ case.drag @ spin.T @ v
    limit = SPEED * np.hypot(*case.travel.T).max()
    wrenches: list[list[float]] = []
    for normal, point, speed, mu in contacts(case, poses[1], s):
        tangent = np.array([normal[1], -normal[0]])
        arm = point - poses[1, :2]
        slip = v[:2] + v[2] * np.array([-arm[1], arm[0]]) - speed
        for side in (-1, 1):
            if side * (slip @ tangent) < limit and slip @ normal < limit:
                force = normal + side * mu * tangent
                wrenches.append([*force, cross(arm, force)])
    size = float(np.linalg.norm(wrench))
    if size < 1e-6 * limit:
        return 0.0
    if not wrenches:
        return 1.0
    return float(nnls(stretch @ np.transpose(wrenches), wrench)[1]) / size


@pytest.mark.parametrize("seed", range(60))
def test_nothing_overlaps_and_forces_balance(seed: int) -> None:
    case = random_case(np.random.default_rng(seed))
    result: Any = take(case, SAMPLES)
    assert result.outcomes[0] in (0, 1, 4)
    assert result.events[0] < 40
    end = result.ended_at[0]
    path = result.path[0]
    for i in range(0, int(end * SAMPLES), SAMPLES // 25):
        assert overlap(case, path[i], i / SAMPLES) < 1e-12
    times = np.append(result.timeline(0).times, end) * SAMPLES
    for middle in np.rint((times[1:] + times[:-1]) / 2).astype(int):
        if np.abs(times - middle).min() > 10:
            poses = path[middle - 1 : middle + 2]
            assert imbalance(case, poses, middle / SAMPLES) < BALANCE
