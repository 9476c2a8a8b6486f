"""Whole runs with point, round and flat tips against closed forms."""

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp

from meso_robust.simulator import Flat, Outcome, Point, Round, simulate
from meso_robust.simulator.tips import Tip
from tests.simulator.draws import L_SHAPE
from tests.simulator.oracle import turned
from tests.simulator.problems import HALF_LONG, HALF_SHORT, RHO, UM, rectangle, single

F = npt.NDArray[np.float64]


@pytest.mark.parametrize("shape", [Point(), Round(12 * UM), Flat(np.pi / 2), Flat(np.pi / 2, 1e-4)])
@pytest.mark.parametrize("mu", [0.0, 0.6])
def test_push_through_the_centre_translates(shape: Tip, mu: float) -> None:
    """The 950 µm push from 1 µm off moves the part by 949 µm (Table V of the paper)."""
    start = [0.0, -HALF_SHORT - shape.radius - 1 * UM]
    push = single(rectangle(), start, [0.0, 950 * UM], shape=shape, mu=mu)
    result = simulate(push, record=5)
    assert result.outcomes[0] == Outcome.COMPLETED
    np.testing.assert_allclose(result.poses[0], [0.0, 949 * UM, 0.0], atol=1e-12)
    # The film's drag is the speed of the part: all of it is the force of the probe.
    np.testing.assert_allclose(result.forces[0, -1, 0], [0.0, 75 * UM], atol=1e-12)
    assert result.max_penetration[0] < 1e-15


@pytest.mark.parametrize("offset", [5.0, -11.0])
def test_flat_side_keeps_a_face_square(offset: float) -> None:
    # The centre is ahead of the side, so that its two ends hold the part against turning.
    start = [offset * UM, -HALF_SHORT - 1 * UM]
    result = simulate(single(rectangle(), start, [0.0, 300 * UM], shape=Flat(np.pi / 2)))
    np.testing.assert_allclose(result.poses[0], [0.0, 299 * UM, 0.0], atol=1e-12)


def test_flat_side_beside_the_centre_turns_the_part_on_its_end() -> None:
    # Farther out than half its length: the part turns on the inner end of the side, as on a point.
    flat, inner = Flat(np.pi / 2, 50 * UM), 175 * UM
    way = [0.0, 200 * UM]
    wide = simulate(single(rectangle(), [200 * UM, -HALF_SHORT], way, shape=flat, step=0.5 * UM))
    sharp = simulate(single(rectangle(), [inner, -HALF_SHORT], way, step=0.5 * UM))
    assert sharp.poses[0, 2] > 0.02
    # The first step differs: both ends touch, of which one leaves.
    np.testing.assert_allclose(wide.poses[0], sharp.poses[0], atol=1e-12)


def disc_on_corner(radius: float, travel: float) -> F:
    """End pose of a part whose corner is pushed by a disc without friction, by an ODE solver.

    The force λ along n, from the disc's centre to the corner, moves the part by E⁻¹ (n, r × n) λ, and
    the corner keeps its distance from the centre: n · v_corner = n · v_disc.
    """
    corner = np.array([-HALF_LONG, -HALF_SHORT])
    start = corner - radius * np.array([np.cos(0.6), np.sin(0.6)])

    def rate(s: float, pose: F) -> F:
        arm = turned(pose[2]) @ corner
        n = pose[:2] + arm - (start + np.array([s, 0.0]))
        n = n / np.hypot(*n)
        wrench = np.array([*n, arm[0] * n[1] - arm[1] * n[0]])
        resist = wrench / [1, 1, RHO]
        return np.asarray(resist * n[0] / (wrench @ resist))

    return np.asarray(solve_ivp(rate, (0, travel), np.zeros(3), rtol=1e-10, atol=1e-15).y[:, -1])


@pytest.mark.parametrize("radius", [60 * UM, 300 * UM])
def test_disc_pushes_a_corner_along_the_line_from_its_centre(radius: float) -> None:
    corner = np.array([-HALF_LONG, -HALF_SHORT])
    start = corner - radius * np.array([np.cos(0.6), np.sin(0.6)])
    travel = 0.5 * radius
    exact = disc_on_corner(radius, travel)
    errors = []
    for step in (0.4 * UM, 0.2 * UM):
        push = single(rectangle(), start, [travel, 0.0], shape=Round(radius), mu=0.0, step=step)
        result = simulate(push, record=10)
        errors.append(np.max(np.abs(result.poses[0] - exact) / [UM, UM, 1e-3]))
        for pose, tip, force in zip(
            result.path[0], result.tips[0, :, 0], result.forces[0, :, 0], strict=True
        ):
            line = pose[:2] + turned(pose[2]) @ corner - tip
            across = force[0] * line[1] - force[1] * line[0]
            assert abs(across) < 2 * step / radius * np.hypot(*force) * np.hypot(*line)
    assert abs(exact[2]) > 0.01
    assert errors[0] < 0.5
    assert errors[0] / errors[1] > 1.8  # of the first order at least


def test_disc_rolls_with_friction_and_keeps_its_distance() -> None:
    radius, corner = 200 * UM, np.array([-HALF_LONG, -HALF_SHORT])
    start = corner - radius * np.array([np.cos(0.6), np.sin(0.6)])
    push = single(rectangle(), start, [150 * UM, 0.0], shape=Round(radius), mu=5.0, step=0.5 * UM)
    result = simulate(push, record=50)
    assert np.all(result.modes[0, :, 0] == 1)
    for pose, tip in zip(result.path[0], result.tips[0, :, 0], strict=True):
        line = pose[:2] + turned(pose[2]) @ corner - tip
        # Sticking: the corner does not move along the disc, which does not turn.
        np.testing.assert_allclose(line, corner - start, atol=0.3 * UM)


@pytest.mark.parametrize("turn", [0.0, 0.1, 0.7, np.pi / 3])
@pytest.mark.parametrize("shape", [Point(), Round(40 * UM)])
def test_tip_in_a_re_entrant_corner_carries_the_part_along(turn: float, shape: Tip) -> None:
    corners = L_SHAPE * 800 * UM
    notch = corners[3] + shape.radius
    R = turned(turn)
    # Along the line from the notch to the centre: no torque, in both walls' cones.
    way = -notch / np.hypot(*notch)
    assert way[0] == pytest.approx(way[1])
    push = single(
        corners, R @ (notch - 1 * UM * way), R @ way * 300 * UM, shape=shape, pose=[0, 0, turn]
    )
    result = simulate(push, record=3)
    assert result.outcomes[0] == Outcome.COMPLETED
    expected = np.append(R @ way * 299 * UM, turn)
    np.testing.assert_allclose(result.poses[0], expected, atol=1e-10)
    assert result.modes[0, -1, 0] == 1


def test_tip_in_the_notch_is_a_pivot() -> None:
    """Pushed askew the part turns about the tip, which stays in the notch: dθ by the film's law."""
    corners = L_SHAPE * 800 * UM
    notch, way = corners[3], np.array([-1.0, -0.4]) / np.hypot(1.0, 0.4)

    def rate(s: float, pose: F) -> F:
        # The tip gives the notch its velocity; without torque of its own the part turns by the
        # film: ρ ω = r × f with f = v of the centre, r from the centre to the notch.
        r = turned(pose[2]) @ notch
        turn = (r[0] * way[1] - r[1] * way[0]) / (RHO + r @ r)
        return np.array([way[0] + turn * r[1], way[1] - turn * r[0], turn])

    exact = solve_ivp(rate, (0, 250 * UM), np.zeros(3), rtol=1e-10, atol=1e-15).y[:, -1]
    push = single(corners, notch, way * 250 * UM, mu=1.0, step=0.1 * UM)
    result = simulate(push)
    assert abs(exact[2]) > 0.01
    np.testing.assert_allclose(
        result.poses[0] / [UM, UM, 1], exact / [UM, UM, 1], atol=2e-2, rtol=1e-3
    )


def test_disc_in_the_mouth_of_a_pocket_carries_the_part_along() -> None:
    vertices = np.array([[-5, -5], [5, -5], [5, 5], [2, 5], [2, -2], [-2, -2], [-2, 5], [-5, 5]])
    height = 500 * UM + np.sqrt(300.0**2 - 200.0**2) * UM + 1 * UM
    push = single(vertices * 100 * UM, [0.0, height], [0.0, -300 * UM], shape=Round(300 * UM))
    result = simulate(push)
    # Not straight at the corners, but down: the gap of the disc closes along the slanted lines.
    fall = height - 500 * UM - np.sqrt(300.0**2 - 200.0**2) * UM
    np.testing.assert_allclose(result.poses[0], [0.0, -300 * UM + fall, 0.0], atol=1e-11)
