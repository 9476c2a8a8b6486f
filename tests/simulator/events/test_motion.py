"""Smooth motion and its events against closed forms and SciPy."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import brentq

from meso_robust.simulator.events import integrate
from tests.simulator.events.reference import (
    HALF_LONG,
    HALF_SHORT,
    MU,
    PLAIN,
    PLATE,
    RHO,
    TILTED,
    UM,
    Contact,
    F,
    assert_same,
    end_of,
    follow,
    push,
    turn,
    velocity,
)

NAN = float("nan")
LEFT = np.array([-1.0, 0.0])
WIDTH = 2 * HALF_SHORT


def on_edge(pose: F, tip: F, speed: F, ratio: float) -> Contact:
    """Contact on the long edge of the plate with the body normal (0, −1)."""
    inward = turn(pose[2]) @ np.array([0.0, 1.0])
    return inward, tip, speed, ratio


def pushed(d2: float, travel: float, ratio: float) -> Callable[[F, float], list[Contact]]:
    """Contacts of a tip that goes left on the right-hand edge of the upright plate."""
    start = np.array([HALF_SHORT, d2])
    return lambda pose, s: [on_edge(pose, start + s * travel * LEFT, travel * LEFT, ratio)]


def test_sticking_tip_on_a_plain_film_has_the_closed_form() -> None:
    # dθ/dξ = r_y/(ρ + R²) with r the arm of the tip, integrated by hand.
    d2, travel = 200 * UM, 300 * UM
    R, delta = np.hypot(HALF_SHORT, d2), np.arctan2(HALF_SHORT, d2)
    growth = np.exp(R * travel / (RHO + R**2))
    angle = delta + 2 * np.arctan(np.tan((np.pi / 2 - delta) / 2) * growth)
    result = push([[418.5, 200]], [[-300, 0]], samples=4)
    assert result.poses[0, 2] == pytest.approx(angle, abs=1e-14)
    tips = np.array([HALF_SHORT, d2]) + np.linspace(0, 1, 5)[:, None] * travel * LEFT
    body = [turn(p[2]).T @ (tip - p[:2]) for p, tip in zip(result.path[0], tips, strict=True)]
    np.testing.assert_allclose(body, np.tile([d2, -HALF_SHORT], (5, 1)), atol=1e-17)


@pytest.mark.parametrize(("d2", "drag"), [(200, TILTED), (-250, TILTED), (150, PLAIN)])
def test_sticking_tip_on_any_film_agrees_with_scipy(d2: float, drag: F) -> None:
    result = push([[418.5, d2]], [[-300, 0]], mu=0.8, drag=drag)
    assert result.timeline(0).modes.tolist() == [[1]]
    exact = follow([0, 0, np.pi / 2], drag, pushed(d2 * UM, 300 * UM, NAN))
    assert_same(result.poses[0], end_of(exact), 300 * UM)


def test_sticking_tip_slips_where_the_force_leaves_the_cone() -> None:
    contacts = pushed(350 * UM, 1000 * UM, NAN)
    exact = follow([0, 0, np.pi / 2], PLAIN, contacts)

    def spare(s: float) -> float:
        normal, tangential = velocity(end_of(exact, s), PLAIN, contacts(end_of(exact, s), s))[1][0]
        return float(MU * normal - abs(tangential))

    at = brentq(spare, 0.1, 1.0, xtol=1e-15)
    timeline = push([[418.5, 350]], [[-1000, 0]]).timeline(0)
    assert timeline.modes.tolist() == [[1], [3]]
    assert timeline.times[1] == pytest.approx(at, abs=1e-10)
    assert_same(timeline.poses[1], end_of(exact, at), 1000 * UM)


@pytest.mark.parametrize("mu", [0.0, 0.1])
@pytest.mark.parametrize("drag", [PLAIN, TILTED])
def test_sliding_tip_agrees_with_scipy(mu: float, drag: F) -> None:
    result = push([[418.5, 600]], [[-150, 0]], mu=mu, drag=drag, samples=5)
    mode = int(result.timeline(0).modes[0, 0])
    assert mode in (2, 3)
    # The part slips along +t (mode 2) under a force along −t, and the other way round.
    exact = follow([0, 0, np.pi / 2], drag, pushed(600 * UM, 150 * UM, -mu if mode == 2 else mu))
    assert result.events[0] == 1
    expected = np.array([end_of(exact, s) for s in np.linspace(0, 1, 6)])
    assert_same(result.path[0], expected, 150 * UM)


def test_tip_that_passes_the_end_of_an_edge_leaves_the_part_at_rest() -> None:
    exact = follow([0, 0, np.pi / 2], PLAIN, pushed(700 * UM, 2000 * UM, 0.0), 0.9)

    def rest(s: float) -> float:
        pose = end_of(exact, s)
        tip = np.array([HALF_SHORT, 700 * UM]) + s * 2000 * UM * LEFT
        return float(HALF_LONG - (turn(pose[2]).T @ (tip - pose[:2]))[0])

    at = brentq(rest, 0.01, 0.9, xtol=1e-15)
    result = push([[418.5, 700]], [[-2000, 0]], mu=0)
    timeline = result.timeline(0)
    assert timeline.modes[:, 0].tolist() == [2, 0]
    assert timeline.times[1] == pytest.approx(at, abs=1e-10)
    assert_same(result.poses[0], end_of(exact, at), 2000 * UM)


def test_two_tips_that_go_together_carry_the_part_along() -> None:
    result = push([[418.5, 300], [418.5, -200]], [[-250, 10], [-250, 10]], drag=TILTED)
    expected = np.array([-250 * UM, 10 * UM, np.pi / 2])
    np.testing.assert_allclose(result.poses[0], expected, rtol=0, atol=1e-17)
    assert result.timeline(0).modes.tolist() == [[1, 1]]


def test_tip_reaches_the_part_and_the_part_the_passive_tip() -> None:
    # The plate is pushed at its centre, so it only translates, and meets a tip 70 um away.
    result = push([[468.5, 0], [-488.5, 0]], [[-200, 0], [0, 0]])
    assert result.outcomes[0] == 1  # it is held between two tips that come closer
    assert result.ended_at[0] == pytest.approx(120 / 200, abs=1e-12)
    assert_same(result.poses[0], np.array([-70 * UM, 0, np.pi / 2]), 200 * UM, 1e-11)


def test_second_tip_closes_to_rounding_where_a_step_of_the_search_ends_just_behind_the_edge() -> (
    None
):
    """A run of the paper's plan; the step ends in the band that does not count as an overlap yet."""
    pose = np.array([0.0013958197205965637, 0.00011343446016401739, 2.998432482416373])
    tips = np.array(
        [
            [0.002271285092334567, 0.0002430344601640174],
            [0.00226875434885856, -0.0003369655398359826],
        ]
    )
    travel = np.tile([-0.0014570197205965637, 0.0], (2, 1))
    result = integrate(
        vertices=PLATE,
        poses=pose[None],
        tips=tips[None],
        travel=travel[None],
        friction=np.full((1, 2), 0.3),
        drag=np.diag([1.0, 1.0, 3.9574500000000016e-07]),
    )
    x, y, angle = result.poses[0]
    beyond = (tips + travel - [x, y]) @ turn(angle)
    # the part, turned about by 180 deg, is met at its short edge on the left
    assert np.abs(beyond[:, 0] + HALF_LONG).max() < 1e-16


def test_part_between_two_tips_turns_as_its_width_demands() -> None:
    height = 1000 * UM
    result = push([[418.5, 500], [-418.5, -500]], [[-400, 0], [0, 0]], samples=8)
    base = WIDTH - np.linspace(0, 1, 9) * 400 * UM
    angle = np.arctan2(height, base) + np.arcsin(WIDTH / np.hypot(base, height))
    assert result.outcomes[0] == 0
    np.testing.assert_allclose(result.path[0, :, 2], angle, rtol=0, atol=1e-14)


@pytest.mark.parametrize("drag", [PLAIN, TILTED])
@pytest.mark.parametrize("radius", [0, 50])
@pytest.mark.parametrize("sliding", [0, 1])
def test_sticking_and_sliding_tip_hold_the_part_whatever_the_film(
    drag: F, radius: float, sliding: int
) -> None:
    mu, radii = np.full(2, 4.0), np.zeros(2)
    mu[sliding], radii[sliding] = 0.0, radius * UM
    wide = HALF_SHORT / UM + radii / UM
    tips = np.array([[wide[0], 500], [-wide[1], -500]])
    travel = np.array([[-400, 0], [0, 0]])
    result = push(tips, travel, mu=mu, radii=radii, drag=drag, samples=8)
    share = np.linspace(0, 1, 9)
    base, height = wide.sum() * UM - share * 400 * UM, 1000 * UM
    angle = np.arctan2(height, base) + np.arcsin(wide.sum() * UM / np.hypot(base, height))
    held = tips[1 - sliding] * UM
    place = [
        held + part * travel[1 - sliding] * UM - turn(one - np.pi / 2) @ held
        for part, one in zip(share, angle, strict=True)
    ]
    assert result.timeline(0).modes.shape == (1, 2)
    assert result.timeline(0).modes[0, 1 - sliding] == 1
    assert_same(result.path[0], np.column_stack([place, angle]), 400 * UM, 1e-13)


def test_part_snaps_where_the_tips_that_hold_it_are_as_near_as_it_is_wide() -> None:
    result = push([[418.5, 200], [-418.5, -200]], [[-300, 0], [0, 0]], mu=np.array([0.0, 9.0]))
    nearest = np.sqrt(WIDTH**2 - (400 * UM) ** 2)
    assert result.outcomes[0] == 1
    assert result.ended_at[0] * 300 * UM == pytest.approx(WIDTH - nearest, abs=1e-13)


@pytest.mark.parametrize("height", [400, 700, 880])
def test_part_jams_where_the_line_of_the_tips_enters_both_cones(height: float) -> None:
    # Tips D apart are w / D = cos of the angle to the normals apart; the cone is at atan μ.
    base = np.sqrt(WIDTH**2 * (1 + MU**2) - (height * UM) ** 2)
    half = height / 2
    result = push([[418.5, half], [-418.5, -half]], [[-820, 0], [0, 0]])
    assert result.outcomes[0] == 1
    assert result.ended_at[0] * 820 * UM == pytest.approx(WIDTH - base, abs=1e-13)


@pytest.mark.parametrize("drag", [PLAIN, TILTED])
@pytest.mark.parametrize("radii", [(0, 0), (50, 20)])
@pytest.mark.parametrize(
    ("places", "travel"),
    [
        ([(1, 500), (-1, -500)], [(-300, 0), (0, 0)]),
        ([(1, 300), (1, -250)], [(-60, 240), (-40, 240)]),
    ],
    ids=["opposite edges", "one edge"],
)
def test_two_sliding_tips_agree_with_scipy(
    drag: F, radii: tuple[int, int], places: list[tuple[int, int]], travel: list[tuple[int, int]]
) -> None:
    mu, round_ = np.array([0.15, 0.2]), UM * np.array(radii)
    tips = [(side * (HALF_SHORT / UM + r), y) for (side, y), r in zip(places, radii, strict=True)]
    result = push(tips, travel, drag=drag, mu=mu, radii=round_, samples=3)
    modes = result.timeline(0).modes
    assert len(modes) == 1
    assert modes.min() >= 2
    signs = np.where(modes[0] == 2, -mu, mu)

    def contacts(pose: F, s: float) -> list[Contact]:
        found = []
        for k, (side, _) in enumerate(places):
            inward, speed = turn(pose[2]) @ np.array([0.0, side]), UM * np.array(travel[k])
            found.append(
                (inward, UM * np.array(tips[k]) + s * speed + round_[k] * inward, speed, signs[k])
            )
        return found

    exact = follow([0, 0, np.pi / 2], drag, contacts)
    for share, pose in zip(np.linspace(0, 1, 4), result.path[0], strict=True):
        assert_same(pose, end_of(exact, share), 300 * UM)


def test_path_is_that_of_shorter_moves() -> None:
    result = push([[418.5, 600]], [[-1000, 0]], samples=7)
    assert result.events[0] == 3
    for k in range(8):
        shorter = push([[418.5, 600]], [[-1000 * k / 7, 0]])
        assert_same(result.path[0, k], shorter.poses[0], 1000 * UM, 1e-10)


def test_runs_of_a_batch_are_those_taken_alone() -> None:
    heights = np.linspace(-700, 700, 150)
    tips = UM * np.column_stack([np.full(150, 418.5), heights])[:, None]
    batch = integrate(
        vertices=PLATE,
        poses=np.tile([0, 0, np.pi / 2], (150, 1)),
        tips=tips,
        travel=np.tile(600 * UM * LEFT, (150, 1, 1)),
        friction=np.full((150, 1), MU),
        drag=np.tile(TILTED, (150, 1, 1)),
    )
    for k in (0, 70, 149):
        alone = push([[418.5, heights[k]]], [[-600, 0]], drag=TILTED)
        np.testing.assert_array_equal(batch.poses[k], alone.poses[0])
        assert batch.events[k] == alone.events[0]


def test_slip_reverses_where_the_tips_are_closest() -> None:
    # The passive tip sticks; the other slides on the opposite edge, √(D² − w²) along it from
    # there. Where D is least both contacts are at rest on the part, but only for an instant.
    width, height = WIDTH / UM, 600.0
    result = integrate(
        vertices=PLATE,
        poses=np.array([[0, 0, np.pi / 2]]),
        tips=UM * np.array([[[418.5, 300], [-418.5, -300]]]),
        travel=UM * np.array([[[-300, 300], [0.0, 0]]]),
        friction=np.array([[0.33, 0.99]]),
        drag=PLAIN,
    )
    timeline = result.timeline(0)
    assert timeline.modes.tolist() == [[2, 1], [3, 1]]
    at = (300 * width - 300 * height) / (300**2 + 300**2)
    assert timeline.times[1] == pytest.approx(at, abs=1e-9)
    base, rise = width - 300, height + 300
    angle = np.arctan2(rise, base) + np.arcsin(width / np.hypot(base, rise))
    assert result.poses[0, 2] == pytest.approx(angle, abs=1e-11)
