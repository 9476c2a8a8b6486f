"""Real parts and probes in both engines: each against the other, and against SciPy by another route."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp

from meso_robust.simulator import Film, Outcome, Push, simulate
from meso_robust.simulator.exact import exact
from tests.simulator.events.reference import HALF_SHORT, PLATE, RHO, UM, turn, velocity

F = npt.NDArray[np.float64]
LEGS = 3


def film(rng: np.random.Generator, runs: int) -> Film:
    """Off centre, with a lay of the part and one of the stage."""
    x, y = rng.uniform(-30.0, 30.0, (2, runs)) * UM
    p, q = rng.uniform(-0.05, 0.05, (2, runs))
    tensor = np.array([[1.0 + p, q], [q, 1.0 - p]]).transpose(2, 0, 1)
    arm = np.zeros((runs, 2, 3))
    arm[:, 0, 0] = arm[:, 1, 1] = 1.0
    arm[:, 0, 2], arm[:, 1, 2] = -y, x
    drag = arm.transpose(0, 2, 1) @ tensor @ arm
    drag[:, 2, 2] += RHO * rng.uniform(0.9, 1.1, runs)
    return Film(0.5 * (drag + drag.transpose(0, 2, 1)), rng.uniform(-0.05, 0.05, (runs, 2)))


def pushes(rng: np.random.Generator, runs: int, step: float, **changes: Any) -> Push:
    """Two tips come from the right and push a part, which may meet a third one on its left."""
    start = np.array([[620.0, 300.0], [620.0, -300.0], [-1500.0, 100.0]]) * UM
    start = start + rng.uniform(-20.0, 20.0, (runs, 3, 2)) * UM
    start[:, :2, 1] += rng.uniform(-400.0, 400.0, (runs, 1)) * UM
    slant, length = rng.uniform(-0.03, 0.03, (runs, LEGS)), rng.uniform(100, 200, (runs, LEGS)) * UM
    way = -length[..., None] * np.stack([np.cos(slant), np.sin(slant)], axis=2)
    ways = np.repeat(start[:, None], LEGS + 1, axis=1)
    ways[:, 1:, :2] += np.cumsum(way, axis=1)[:, :, None]
    given: dict[str, Any] = {
        "vertices": PLATE + rng.uniform(-4.0, 4.0, (runs, 4, 2)) * UM,
        "poses": np.column_stack([np.zeros((runs, 2)), 0.5 * np.pi + rng.uniform(-0.15, 0.15, runs)]),
        "radii": rng.uniform(0.0, 12.5, (runs, 3)) * UM * rng.integers(0, 2, (runs, 3)),
        "friction": rng.uniform(0.2, 0.5, (runs, LEGS, 3)),
        "support": film(rng, runs),
    }  # fmt: skip
    return Push.along(ways=ways, step=step, **{**given, **changes})


def apart(one: F, other: F) -> F:
    """(N,) um: positions, and turns at 400 um."""
    off = np.abs(one - other) * [1.0, 1.0, 400.0 * UM]
    return np.asarray(off.max(axis=1) / UM)


def test_the_engines_agree_to_a_nanometre_on_parts_and_probes_drawn_at_random() -> None:
    """The stepper is of first order in the instants at which modes change: so is the difference."""
    most, ended = {}, {}
    for step in (0.08, 0.04, 0.02):
        push = pushes(np.random.default_rng(3), 60, step * UM)
        stepped, found = simulate(push), exact(push)
        assert (stepped.outcomes == found.outcomes).all()
        both = found.outcomes == Outcome.COMPLETED
        assert both.sum() > 50
        assert found.events.max() > 3
        most[step], ended[step] = apart(stepped.poses, found.poses)[both], stepped.poses
    # extrapolated to steps of no length
    limit = 2.0 * ended[0.02] - ended[0.04]
    assert np.median(apart(limit, found.poses)) < 1e-3
    assert most[0.02].max() < 5e-3
    assert most[0.02].max() < 0.5 * most[0.08].max()


@pytest.mark.parametrize(
    "changed", ["vertices", "radii", "friction", "support", "lay", "waypoints"]
)
def test_every_quantity_shows_in_both_engines_alike(changed: str) -> None:
    """One that an engine passed over would leave its end where it was."""
    push = pushes(np.random.default_rng(8), 12, 0.25 * UM)
    support = push.support
    assert isinstance(support, Film)
    plain: dict[str, Any] = {
        "vertices": PLATE,
        "radii": np.zeros((1, 3)),
        "friction": np.full((12, 3), 0.35),
        "support": Film(np.diag([1.0, 1.0, RHO])),
        "lay": Film(support.drag),
        "waypoints": push.waypoints + np.linspace(0.0, 5.0 * UM, LEGS + 1)[:, None, None],
    }
    field = "support" if changed == "lay" else changed
    other = replace(push, **{field: plain[changed]})
    exactly = exact(push).poses - exact(other).poses
    stepped = simulate(push).poses - simulate(other).poses

    assert np.quantile(np.abs(exactly[:, :2]).max(axis=1), 0.7) > 0.1 * UM
    assert np.median(apart(exactly, stepped)) < 0.05


@pytest.mark.parametrize("ratio", [np.nan, -0.05])
def test_a_disc_on_a_film_with_a_lay_of_the_stage_agrees_with_scipy(ratio: float) -> None:
    """In the world frame, the film's matrix turned with the part; the contact sticks or slips."""
    radius, place, lay = 12.5 * UM, 200.0 * UM, np.array([0.04, -0.03])
    (drag,) = film(np.random.default_rng(0), 1).drag
    arm = np.linalg.solve(drag[:2, :2], drag[:2, 2])
    centre = np.array([arm[1], -arm[0]])

    def slopes(way: float, pose: F) -> F:
        body = turn(pose[2])
        tensor = body.T @ np.array([[lay[0], lay[1]], [lay[1], -lay[0]]]) @ body
        move = np.array([[1.0, 0.0, -centre[1]], [0.0, 1.0, centre[0]]])
        tip = np.array([HALF_SHORT + radius - way, place])
        outward = body @ [0.0, -1.0]
        point = tip - radius * outward
        contact = (-outward, point, np.array([-1.0, 0.0]), ratio)
        return np.asarray(velocity(pose, drag + move.T @ tensor @ move, [contact])[0])

    start = np.array([0.0, 0.0, 0.5 * np.pi])
    solved = solve_ivp(slopes, (0.0, 200.0 * UM), start, rtol=1e-11, atol=1e-14, method="DOP853")
    tips = np.array([[[HALF_SHORT + radius, place]]])
    push = Push.straight(
        vertices=PLATE,
        poses=start[None],
        tips=tips,
        travel=np.array([[[-200.0 * UM, 0.0]]]),
        friction=np.array([5.0 if np.isnan(ratio) else abs(ratio)]),
        radii=np.array([[radius]]),
        support=Film(drag, lay),
        step=0.1 * UM,
    )

    assert apart(exact(push).poses, solved.y[:, -1][None]).max() < 1e-6
    assert apart(simulate(push).poses, solved.y[:, -1][None]).max() < 5e-3


def test_friction_that_drops_during_a_move_lets_a_tip_slip_from_there() -> None:
    push = pushes(np.random.default_rng(1), 1, 0.25 * UM, friction=np.full((1, LEGS, 3), 5.0))
    mu = push.friction.copy()
    mu[:, 1:] = 0.01
    dropped = replace(push, friction=mu)
    first = replace(
        push, waypoints=push.waypoints[:, :2], times=push.times[:, :2], friction=mu[:, 0]
    )

    for engine in (exact, simulate):
        assert apart(engine(dropped).poses, engine(push).poses)[0] > 1.0
    path = exact(dropped, samples=300).path[0]
    at = np.linspace(0.0, 1.0, 301) * push.times[0, -1]
    before = int(np.searchsorted(at, push.times[0, 1])) - 1
    np.testing.assert_allclose(path[before], exact(push, samples=300).path[0, before], atol=1e-12)
    assert apart(exact(first).poses, path[before][None])[0] < 5.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"radii": np.full((1, 3), -1e-6)}, "radii: run 0 has -1e-06 m"),
        ({"friction": np.full((2, LEGS, 2), 0.3)}, "friction: shape"),
        ({"vertices": np.stack([PLATE, PLATE[::-1]])}, "vertices: corner 0 of run 1"),
    ],
)
def test_refusals_name_the_argument(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pushes(np.random.default_rng(0), 2, UM, **changes)


def test_a_path_of_less_than_no_intervals_is_refused() -> None:
    with pytest.raises(ValueError, match="samples: -1; must not be negative"):
        exact(pushes(np.random.default_rng(0), 2, UM), samples=-1)


def test_a_lay_that_leaves_no_drag_is_refused() -> None:
    with pytest.raises(ValueError, match="stage_lay: that of run 0"):
        Film(np.diag([1.0, 1.0, RHO]), np.array([1.0, 0.2]))
