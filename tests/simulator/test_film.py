"""Films with a full matrix against the plain film elsewhere and linear algebra."""

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.simulator import Film, Outcome, Push, simulate
from tests.simulator.oracle import turned
from tests.simulator.problems import HALF_LONG, HALF_SHORT, MU, RHO, UM, rectangle

F = npt.NDArray[np.float64]


def pushed(
    vertices: F,
    pose: F,
    film: Film,
    *,
    mu: float = MU,
    travel: float = 300 * UM,
    step: float = 1 * UM,
) -> Push:
    """A tip at rest in the world, going up, and another one as an obstacle."""
    return Push.straight(
        vertices=vertices,
        poses=pose[None],
        tips=np.array(
            [[[-0.5 * HALF_LONG, -HALF_SHORT - 1 * UM], [0.7 * HALF_LONG, HALF_SHORT + 20 * UM]]]
        ),
        travel=np.array([[[20 * UM, travel], [0.0, 0.0]]]),
        friction=np.array([mu]),
        support=film,
        step=step,
    )


def about(centre: F, drag: F) -> F:
    """Drag of a twist of the origin, given that of a twist of the centre: v_c = v + ω × c."""
    shift = np.array([[1, 0, -centre[1]], [0, 1, centre[0]], [0, 0, 1]])
    return np.asarray(shift.T @ drag @ shift)


def test_film_off_the_centre_is_the_plain_film_about_its_own_centre() -> None:
    centre = np.array([150.0, -70.0]) * UM
    plain = np.diag([1.0, 1.0, RHO])
    off = simulate(pushed(rectangle(), np.zeros(3), Film(about(centre, plain))), record=30)
    own = simulate(pushed(rectangle() - centre, np.append(centre, 0.0), Film(plain)), record=30)
    assert np.ptp(own.path[0, :, 2]) > 0.1
    for one, other in zip(off.path[0], own.path[0], strict=True):
        np.testing.assert_allclose(one[:2] + turned(one[2]) @ centre, other[:2], atol=2e-9)
        assert one[2] == pytest.approx(other[2], abs=1e-6)
    np.testing.assert_allclose(off.forces, own.forces, rtol=1e-3, atol=1e-7)
    plain_there = simulate(pushed(rectangle(), np.zeros(3), Film(plain)))
    assert np.max(np.abs(plain_there.poses - off.poses)) > 3 * UM  # it does matter


def test_scale_of_the_film_does_not_matter() -> None:
    plain = np.diag([1.0, 1.0, RHO])
    one = simulate(pushed(rectangle(), np.zeros(3), Film(plain)))
    ten = simulate(pushed(rectangle(), np.zeros(3), Film(1e-7 * plain)))
    ratio = simulate(pushed(rectangle(), np.zeros(3), Film.ratio(RHO)))
    np.testing.assert_allclose(ten.poses, one.poses, atol=1e-13)
    np.testing.assert_array_equal(ratio.poses, one.poses)


@pytest.mark.parametrize("mu", [0.0, 0.15, 10.0])
def test_anisotropic_film_by_hand_in_one_step(mu: float) -> None:
    """One contact: force in the cone or on its edge, motion E⁻¹ w, the point goes with the tip."""
    rng = np.random.default_rng(5)
    A = rng.normal(size=(3, 3)) * [1, 1, HALF_SHORT]
    E = A.T @ A + np.diag([1.0, 0.4, RHO])
    pose, point = np.array([1e-4, 2e-4, 0.8]), np.array([300 * UM, -HALF_SHORT])
    R = turned(pose[2])
    d = np.array([0.6, 0.8]) * UM  # body frame
    wn = np.array([0.0, 1.0, point[0]])
    wt = np.array([-1.0, 0.0, point[1]])  # inward normal turned by +90°, with its torque
    D = np.linalg.inv(E)
    W = np.column_stack([wn, wt])
    goal = np.array([d[1], -d[0]])
    forces = np.linalg.solve(W.T @ D @ W, goal)
    if abs(forces[1]) > mu * forces[0]:
        edge = wn + np.sign(forces[1]) * mu * wt
        motion = D @ edge * goal[0] / (wn @ D @ edge)
    else:
        motion = D @ W @ forces
    push = Push.straight(
        vertices=rectangle(), poses=pose[None], tips=(pose[:2] + R @ point)[None, None],
        travel=(R @ d)[None, None], friction=np.array([mu]), support=Film(E), step=1 * UM,
    )  # fmt: skip
    result = simulate(push)
    assert push.steps == 1
    assert result.outcomes[0] == Outcome.COMPLETED
    moved = result.poses[0] - pose
    np.testing.assert_allclose(np.append(R.T @ moved[:2], moved[2]), motion, rtol=1e-9, atol=1e-18)


def test_each_run_has_its_own_film() -> None:
    drags = np.array([np.diag([1.0, 1.0, RHO]), np.diag([1.0, 0.3, 2 * RHO])])
    one = pushed(rectangle(), np.zeros(3), Film(drags[1]))
    both = Push(
        vertices=one.vertices,
        poses=np.zeros((2, 3)),
        waypoints=one.waypoints,
        times=one.times,
        friction=one.friction,
        support=Film(drags),
        step=one.step,
    )
    np.testing.assert_array_equal(simulate(both).poses[1], simulate(one).poses[0])
    assert np.max(np.abs(np.diff(simulate(both).poses, axis=0))) > 1 * UM
