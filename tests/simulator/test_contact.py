"""Contacts found against distances to outlines by plain NumPy."""

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.simulator import Fixture, Flat, Point, Push, Round
from meso_robust.simulator.fixture import playpen
from tests.simulator.draws import COMB, L_SHAPE, U_SHAPE, convex, star
from tests.simulator.oracle import crosses, gap_of_outlines, placed, signed_distance, turned
from tests.simulator.problems import UM, contacts_at, rectangle, single

F = npt.NDArray[np.float64]

REACH = 16 * UM
SHAPES = ["convex", "star", "L", "U", "comb"]


def part(kind: str, rng: np.random.Generator) -> F:
    given = {"L": L_SHAPE, "U": U_SHAPE, "comb": COMB}
    if kind in given:
        shape = given[kind]
    else:
        make = convex(rng, 6) if kind == "convex" else star(rng, 8, 0.45)
        shape = make
    return np.asarray((shape - shape.mean(axis=0)) * 600 * UM)


def near_outline(vertices: F, count: int, spread: float, rng: np.random.Generator) -> F:
    """Points about the edges, half of them about the corners."""
    k = rng.integers(len(vertices), size=count)
    share = np.where(rng.random(count) < 0.5, 0.0, rng.random(count))[:, None]
    foot = vertices[k] + share * (np.roll(vertices, -1, axis=0)[k] - vertices[k])
    return np.asarray(foot + rng.normal(0, spread, (count, 2)))


def slid_up(solid: F, world: F, rng: np.random.Generator) -> F:
    """Where to put a solid about the origin to be 0.2 to 20 µm from another, from any side."""
    way, far, wanted = rng.uniform(0, 7), 4e-3, rng.uniform(0.2, 20) * UM
    ahead = np.array([np.cos(way), np.sin(way)])
    aside = rng.uniform(-6e-4, 6e-4) * np.array([-ahead[1], ahead[0]])
    while (gap := gap_of_outlines(solid + aside + far * ahead, world) - wanted) > 1e-9 and far > 0:
        far -= gap
    return np.asarray(aside + far * ahead)


def far_push(vertices: F, shape: Point | Round | Flat) -> Push:
    return single(vertices, [5e-3, 5e-3], [1 * UM, 0.0], shape=shape)


def gaps_of(push: Push, pose: F, tip: F) -> F:
    return contacts_at(push, pose, tip, np.zeros(2), reach=REACH)[0]


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("radius", [0.0, 6 * UM, 150 * UM])
def test_disc_outside_has_its_distance_and_no_invented_contact(kind: str, radius: float) -> None:
    rng = np.random.default_rng(SHAPES.index(kind))
    vertices, pose = part(kind, rng), np.array([1e-4, -2e-4, 0.7])
    push = far_push(vertices, Round(radius) if radius else Point())
    points = near_outline(vertices, 400, 10 * UM + radius, rng)
    distance = signed_distance(vertices, points)
    seen = 0
    for point, apart in zip(points, distance, strict=True):
        if apart < 0.1 * UM:
            continue
        found = gaps_of(push, pose, turned(pose[2]) @ point + pose[:2])
        if apart - radius > REACH:
            assert len(found) == 0
            continue
        seen += 1
        assert found[:, 0].min() == pytest.approx(apart - radius, abs=1e-15)
        # The contact leads from the point of the part along the normal to the disc.
        there = found[:, 3:5] + (found[:, [0]] + radius) * found[:, 1:3]
        np.testing.assert_allclose(there, np.tile(point, (len(found), 1)), atol=1e-15)
    assert seen > 60


@pytest.mark.parametrize("kind", SHAPES)
def test_point_inside_has_its_depth(kind: str) -> None:
    rng = np.random.default_rng(10 + SHAPES.index(kind))
    vertices, pose = part(kind, rng), np.array([1e-4, -2e-4, -2.0])
    push = far_push(vertices, Point())
    points = near_outline(vertices, 300, 4 * UM, rng)
    depth = -signed_distance(vertices, points)
    corner = np.min(np.hypot(*np.moveaxis(points[:, None] - vertices, 2, 0)), axis=1)
    seen, wedged = 0, 0
    for point, deep, to_corner in zip(points, depth, corner, strict=True):
        if deep <= 0.0:
            continue
        gaps = gaps_of(push, pose, turned(pose[2]) @ point + pose[:2])[:, 0]
        inward = gaps[gaps < 0.0]
        if to_corner > deep * (1 + 1e-9):
            # Beyond a re-entrant corner an edge may hold as well, at less.
            assert np.min(np.abs(inward + deep)) < 1e-15
            seen += 1
        else:  # nearest to a re-entrant corner: both its edges hold, each at less than the distance
            assert len(inward) >= 2
            assert np.sum(inward >= -deep) == 2
            wedged += 1
    assert seen > 60
    assert wedged > 0 or kind in ("convex", "star")


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("other", ["tip", "block", "walls"])
def test_outlines_apart_have_their_distance(kind: str, other: str) -> None:
    rng = np.random.default_rng(20 + SHAPES.index(kind))
    vertices = part(kind, rng)
    seen = 0
    for _ in range(80):
        pose = np.append(rng.uniform(-1, 1, 2) * 200 * UM, rng.uniform(-3, 3))
        world, at = placed(vertices, pose), np.array([5e-3, 5e-3])
        if other == "tip":
            flat = Flat(rng.uniform(0, 6), 80 * UM)
            at = slid_up(flat.corners, world, rng)
            solid = flat.corners + at
            push = far_push(vertices, flat)
        elif other == "block":
            solid = part("star", rng) @ turned(rng.uniform(0, 6)).T
            solid = solid + slid_up(solid, world, rng)
            push = single(vertices, at, [0, 1 * UM], pose=pose, fixture=Fixture((solid,)))
        else:
            low, high = world.min(axis=0), world.max(axis=0)
            room, place = high - low + rng.uniform(0.1, 15, 2) * UM, rng.uniform(0, 1, 2)
            centre = 0.5 * room + low - place * (room - high + low)
            fixture = playpen((centre[0], centre[1]), (room[0], room[1]), friction=0.0)
            solid = fixture.outlines[-1]
            push = single(vertices, at, [0, 1 * UM], pose=pose, fixture=fixture)
        apart = gap_of_outlines(world, solid)
        if crosses(world, solid) or apart < 0.1 * UM:
            continue
        found = gaps_of(push, pose, at)
        if apart > REACH:
            assert len(found) == 0
        else:
            seen += 1
            assert found[:, 0].min() == pytest.approx(apart, abs=1e-15)
    assert seen > 15


@pytest.mark.parametrize("offset", [0.0, 30.0, 70.0])
def test_edge_on_edge_gives_the_two_ends_of_the_overlap(offset: float) -> None:
    vertices, tip = rectangle(60 * UM, 40 * UM), Flat(np.pi / 2, 100 * UM)
    push = far_push(vertices, tip)
    found = gaps_of(push, np.zeros(3), np.array([offset * UM, -42 * UM]))
    near = found[found[:, 0] < 3 * UM]
    np.testing.assert_allclose(near[:, 0], 2 * UM, rtol=1e-12)
    np.testing.assert_allclose(near[:, 1:3], [[0, -1]] * 2, atol=1e-12)
    ends = [max(-60.0, offset - 50.0), min(60.0, offset + 50.0)]
    np.testing.assert_allclose(np.sort(near[:, 3]), np.array(ends) * UM, rtol=1e-9)


@pytest.mark.parametrize(
    ("tip", "move", "normal", "gap"),
    [
        # Beyond the corner (808, 418.5), less than a step away.
        ((809.0, 418.6), (-5.0, 0.0), (0.0, 1.0), 0.1),  # grazes along the top
        ((808.1, 420.0), (0.0, -5.0), (1.0, 0.0), 0.1),  # grazes along the side
        ((809.0, 419.0), (-5.0, -1.0), (0.0, 1.0), 0.5),  # crosses the side's line, then the top
        ((809.0, 419.0), (-1.2, -5.0), (1.0, 0.0), 1.0),  # crosses the top's line, then the side
    ],
)
def test_tip_near_a_corner_is_held_off_by_the_edge_it_meets(
    tip: tuple[float, float],
    move: tuple[float, float],
    normal: tuple[float, float],
    gap: float,
) -> None:
    push = far_push(rectangle(), Point())
    found, _ = contacts_at(push, np.zeros(3), np.array(tip) * UM, np.array(move) * UM, reach=REACH)
    assert len(found) == 1
    np.testing.assert_allclose(found[0, 1:3], normal, atol=1e-9)
    np.testing.assert_allclose(found[0, [0, 3, 4]] / UM, [gap, 808.0, 418.5], atol=1e-9)


def test_motion_of_the_part_counts_in_which_edge_is_met() -> None:
    # The tip stands still; the part comes up from below, or from the left.
    push, tip = far_push(rectangle(), Point()), np.array([809.0, 419.0]) * UM
    for last, normal in (([0, 5 * UM, 0], (1, 0)), ([5 * UM, 0, 0], (0, 1))):
        found, _ = contacts_at(
            push, np.zeros(3), tip, np.zeros(2), last=np.array(last, dtype=float), reach=REACH
        )
        np.testing.assert_allclose(found[0, 1:3], normal, atol=1e-9)


def test_slow_tip_beyond_a_corner_faces_the_corner() -> None:
    push = far_push(rectangle(), Point())
    tip, way = np.array([811.0, 422.5]) * UM, np.array([-1.0, 0.0]) * UM
    found, _ = contacts_at(push, np.zeros(3), tip, way, reach=REACH)
    expected = [5.0 * UM, 0.6, 0.8, 808 * UM, 418.5 * UM, -1.0 * UM, 0.0]
    np.testing.assert_allclose(found, [expected], atol=1e-9 * UM, rtol=1e-9)


def test_tip_on_a_corner_has_an_edge_normal() -> None:
    push = far_push(rectangle(), Point())
    tip = np.array([808e-6, 418.5e-6])
    found, _ = contacts_at(push, np.zeros(3), tip, np.zeros(2), reach=REACH)
    assert found[0, 0] == pytest.approx(0.0, abs=1e-18)
    assert sorted(found[0, 1:3].tolist()) == [0.0, 1.0]


def test_disc_in_the_mouth_of_a_pocket_touches_both_corners() -> None:
    vertices = np.array([[-5, -5], [5, -5], [5, 5], [2, 5], [2, -2], [-2, -2], [-2, 5], [-5, 5]])
    push = far_push(vertices * 100 * UM, Round(300 * UM))
    height = 500 * UM + np.sqrt(300.0**2 - 200.0**2) * UM + 1 * UM
    found = gaps_of(push, np.zeros(3), np.array([0.0, height]))
    gap = np.hypot(200 * UM, height - 500 * UM) - 300 * UM
    np.testing.assert_allclose(found[:, 0], [gap, gap], rtol=1e-9)
    np.testing.assert_allclose(np.sort(found[:, 3]), [-200 * UM, 200 * UM])


def test_tip_just_past_both_edges_of_a_re_entrant_corner_is_held_by_both() -> None:
    vertices = L_SHAPE * 11.4 * 50 * UM  # re-entrant corner at (100, 100) µm
    found = gaps_of(far_push(vertices, Point()), np.zeros(3), np.array([99.9, 99.8]) * UM)
    np.testing.assert_allclose(np.sort(found[:, 0]) / UM, [-0.2, -0.1], atol=1e-9)


@pytest.mark.parametrize("thickness", [5 * UM, 12 * UM, 30 * UM])
def test_other_side_of_a_thin_part_is_not_a_contact(thickness: float) -> None:
    push = far_push(rectangle(800 * UM, thickness / 2), Point())
    found = gaps_of(push, np.zeros(3), np.array([100 * UM, thickness / 2 + 1 * UM]))
    np.testing.assert_allclose(found[:, 0], [1 * UM], rtol=1e-9)
