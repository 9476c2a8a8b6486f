"""Whole runs among solids at rest, by hand."""

import numpy as np
import pytest
from scipy.optimize import newton

from meso_robust.simulator import Fixture, Flat, Outcome, Push, Round, simulate
from meso_robust.simulator.fixture import channel, playpen, slot
from tests.simulator.oracle import placed, signed_distance
from tests.simulator.problems import HALF_LONG, HALF_SHORT, MU, UM, rectangle, single

WALL = np.array([[-5e-3, -1e-3], [5e-3, -1e-3], [5e-3, 0.0], [-5e-3, 0.0]])
FLOOR = Fixture((WALL,), 0.2)


def test_walls_are_where_they_are_said_to_be() -> None:
    points = np.array([[0, 0], [0.99, 0.49], [1.01, 0], [0, -0.51], [0, 0.51]]) * 1e-3
    points = points + np.array([5e-3, 0])
    free = [True, True, False, False, False]
    pen = playpen((5e-3, 0), (2e-3, 1e-3), friction=0.1)
    assert ((signed_distance(pen.outlines[0], points) > 0) == free).all()
    lane = channel((5e-3, 0), 2e-3, 1e-3, friction=0.1)
    gaps = np.min([signed_distance(wall, points) for wall in lane.outlines], axis=0)
    assert ((gaps > 0) == [True, True, True, False, False]).all()
    hole = slot((5e-3, 0), 1e-3, 0.4e-3, approach=1e-3, lead=2e-3, friction=0.1)
    points = np.array([[-0.9, 0.19], [-0.9, 0.21], [-1.1, 0], [0.1, 0.49], [0.1, 0.51]]) * 1e-3
    gaps = signed_distance(hole.outlines[0], points + np.array([5e-3, 0]))
    assert ((gaps > 0) == [True, False, False, True, False]).all()


@pytest.mark.parametrize("shape", [None, Flat(-np.pi / 2)])
def test_pressing_a_part_against_a_wall_is_a_jam(shape: Flat | None) -> None:
    height = HALF_SHORT + 10 * UM
    push = single(
        rectangle(), [0.0, 2 * HALF_SHORT + 12 * UM], [0.0, -60 * UM], shape=shape,
        pose=[0.0, height, 0.0], fixture=FLOOR,
    )  # fmt: skip
    result = simulate(push, record=60)
    assert result.outcomes[0] == Outcome.JAM
    np.testing.assert_allclose(result.poses[0], [0.0, HALF_SHORT, 0.0], atol=1e-12)
    # 2 µm to the part, 10 µm to the wall; nothing moves any more.
    moved = np.flatnonzero(np.diff(result.path[0, :, 1]))
    assert (moved[0], moved[-1]) == (2, 11)
    assert result.max_penetration[0] < 1e-15


def test_walls_of_the_playpen_stop_the_part_on_each_side() -> None:
    pen = playpen((0.0, 0.0), (3e-3, 2e-3), friction=0.3)
    reach = {0: 1.5e-3 - HALF_LONG, 1: 1e-3 - HALF_SHORT}
    for axis in (0, 1):
        for sign in (1.0, -1.0):
            ahead = sign * np.eye(2)[axis]
            push = single(
                rectangle(),
                -(HALF_LONG, HALF_SHORT)[axis] * ahead,
                2e-3 * ahead,
                fixture=pen,
                step=2 * UM,
            )
            result = simulate(push)
            assert result.outcomes[0] == Outcome.JAM
            np.testing.assert_allclose(
                result.poses[0], [*(reach[axis] * ahead), 0.0], atol=2.01 * UM
            )
            assert np.all(np.abs(placed(rectangle(), result.poses[0])) <= [1.5e-3, 1e-3])


@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_part_slides_along_a_wall(mu: float) -> None:
    """A flat side that goes along the wall and towards it keeps the part square and on the wall."""
    push = single(
        rectangle(), [-HALF_LONG - 1 * UM, HALF_SHORT], [300 * UM, -60 * UM],
        shape=Flat(0.0, 400 * UM), pose=[0.0, HALF_SHORT, 0.0], fixture=Fixture((WALL,), mu),
    )  # fmt: skip
    result = simulate(push, record=10)
    assert result.outcomes[0] == Outcome.COMPLETED
    np.testing.assert_allclose(result.poses[0], [299 * UM, HALF_SHORT, 0.0], atol=1e-11)
    # The wall's friction is along −x, its inward normal turned by +90°: slip +. The tip's is along −y,
    # against its inward normal turned: slip −, with the force on that edge of the cone.
    assert result.fixture_modes[0, -1] == 2
    assert result.modes[0, -1, 0] == 3
    force = result.forces[0, -1, 0]
    assert force[1] == pytest.approx(-MU * force[0])
    # Along x: tip less friction of the wall, which bears the tip's friction, is the film's drag.
    speed = 75 * UM * 300 / np.hypot(300, 60)
    assert force[0] * (1 - mu * MU) == pytest.approx(speed)


def test_part_goes_into_the_slot_of_figure_1() -> None:
    hole = slot((0.0, 0.0), 2e-3, friction=0.3)
    depth = 1.5e-3
    for aside in (0.0, 60 * UM):
        push = single(
            rectangle(), [2 * HALF_LONG + 2e-4, aside], [-depth - 2e-4, 0.0], shape=Flat(np.pi),
            pose=[HALF_LONG + 1e-4, aside, 0.0], fixture=hole, step=2 * UM,
        )  # fmt: skip
        result = simulate(push)
        assert result.outcomes[0] == Outcome.COMPLETED
        np.testing.assert_allclose(result.poses[0], [HALF_LONG - depth, aside, 0.0], atol=1e-10)


def test_part_that_misses_the_slot_turns_about_its_edge() -> None:
    # 139 µm of clearance: with 80 µm aside the corner meets the end wall of the channel.
    hole = slot((0.0, 0.0), 2e-3, friction=0.0)
    push = single(
        rectangle(), [2 * HALF_LONG + 2e-4, 80 * UM], [-4e-4, 0.0], shape=Flat(np.pi, 200 * UM),
        pose=[HALF_LONG + 1e-4, 80 * UM, 0.0], fixture=hole, mu=0.0,
    )  # fmt: skip
    result = simulate(push, record=400)
    assert result.max_penetration[0] < 0.3 * UM
    # Until it meets after 200 µm, it is pushed squarely; then the lower side goes on.
    np.testing.assert_array_equal(result.path[0, :199, 2], 0.0)
    assert np.all(np.diff(result.path[0, 201:225, 2]) < 0)
    gaps = signed_distance(hole.outlines[0], placed(rectangle(), result.poses[0]))
    assert gaps.min() > -0.3 * UM


def test_ladder_slides_down_in_the_corner_of_two_walls() -> None:
    """Both lower corners on walls without friction: the tip alone says where the part is.

    The lower face is a ladder of length L from (L cos φ, 0) to (0, L sin φ). The upper face is the
    line x sin φ + y cos φ = L sin φ cos φ + w, on which the tip is.
    """
    L, w, start = 2 * HALF_LONG, 2 * HALF_SHORT, 1.0
    corner = np.array([[0, 0], [6e-3, 0], [6e-3, -1e-3], [-1e-3, -1e-3], [-1e-3, 6e-3], [0, 6e-3]])
    walls = Fixture((corner[::-1],), 0.0)

    def line(phi: float) -> float:
        return float(L * np.sin(phi) * np.cos(phi) + w)

    along = np.array([-np.cos(start), np.sin(start)])  # from the foot up the ladder
    normal = np.array([np.sin(start), np.cos(start)])
    middle = np.array([L * np.cos(start), 0]) + 0.5 * L * along
    # Above the middle: the push turns the ladder down, its foot going out.
    tip = middle + 0.35 * L * along + w * normal
    travel = np.array([0.0, -200 * UM])
    pose = np.append(middle + 0.5 * w * normal, -start)
    push = single(rectangle(), tip, travel, mu=0.0, pose=pose, fixture=walls, step=0.2 * UM)
    result = simulate(push, record=10)
    assert result.outcomes[0] == Outcome.COMPLETED
    phi = start
    for pose, (x, y) in zip(result.path[0], result.tips[0, :, 0], strict=True):
        phi = newton(lambda a, x=x, y=y: x * np.sin(a) + y * np.cos(a) - line(a), phi)
        assert -pose[2] == pytest.approx(phi, abs=2e-4)
        centre = 0.5 * L * np.array([np.cos(phi), np.sin(phi)])
        centre = centre + 0.5 * w * np.array([np.sin(phi), np.cos(phi)])
        np.testing.assert_allclose(pose[:2], centre, atol=0.2 * UM)
    assert result.poses[0, 2] > -start + 0.05


def test_translated_turned_and_mirrored_world_has_that_path() -> None:
    block = np.array([[200, -900], [900, -950], [850, -480], [300, -450]]) * UM
    vertices = np.array([[-700, -400], [650, -450], [300, 100], [800, 300], [-500, 420]]) * UM
    tips = np.array([[[-300.0, 900.0], [-900.0, -100.0]]]) * UM
    travel = np.array([[[60.0, -900.0], [0.0, 0.0]]]) * UM
    shapes = (Round(50 * UM), Flat(0.3, 100 * UM))

    def path(turn: float, shift: complex, flip: bool) -> np.ndarray:
        def moved(points: np.ndarray, by: complex = shift) -> np.ndarray:
            z = points[..., 0] + 1j * points[..., 1]
            z = (-z.conjugate() if flip else z) * np.exp(1j * turn) + by
            return np.stack([z.real, z.imag], axis=-1)

        def order(corners: np.ndarray) -> np.ndarray:
            return corners[::-1] if flip else corners

        facing = turn + (np.pi - 0.3 if flip else 0.3)
        push = Push.straight(
            vertices=order(vertices * [-1 if flip else 1, 1]),
            poses=np.array([[shift.real, shift.imag, turn]]),
            tips=moved(tips),
            travel=moved(travel, 0j),
            friction=np.array([[0.3, 0.4]]),
            film_ratio=2e-7,
            shapes=(shapes[0], Flat(facing, shapes[1].side)),
            fixture=Fixture((order(moved(block)),), 0.25),
            step=1 * UM,
        )
        result = simulate(push, record=20)
        back = result.path[0, :, :2] @ [1, 1j] - shift
        back = back * np.exp(-1j * turn)
        back = -back.conjugate() if flip else back
        angle = (result.path[0, :, 2] - turn) * (-1 if flip else 1)
        return np.column_stack([back.real, back.imag, angle])

    plain = path(0.0, 0j, False)
    assert np.ptp(plain[:, 2]) > 0.1
    np.testing.assert_allclose(path(0.0, 3e-3 - 2e-3j, False), plain, atol=1e-11)
    np.testing.assert_allclose(path(2.1, 1e-3 + 5e-3j, False), plain, atol=1e-11)
    np.testing.assert_allclose(path(0.0, 0j, True), plain, atol=1e-11)
