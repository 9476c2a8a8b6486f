"""The foreign plant by itself, by hand, and a proved plan in it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.plant.kernel import COARSE, DONE, FINE, STUCK, Grain, nearest, push
from meso_robust.plant.laws import Laws
from reports.foreign_plant.campaign import Outcome, Plan, carried_on, drawn, outcome_of, plan_of
from tests.paper import paper_task

Floats = npt.NDArray[np.float64]

PLATE = np.array([[-808.0, -418.5], [808.0, -418.5], [808.0, 418.5], [-808.0, 418.5]])
RHO = 376900.0
ARM = np.sqrt(0.5 * RHO)
CROSS = np.array([[ARM, ARM, 1.0], [-ARM, ARM, 1.0], [-ARM, -ARM, 1.0], [ARM, -ARM, 1.0]])
EVEN = np.zeros(4)


def after(tip: list[float], way: list[float], mu: float = 0.3, *, lay: Floats = EVEN, **more: object) -> Floats:  # fmt: skip
    """Pose of the plate, at first at the origin, after a push by one tip."""
    grain, radius = more.get("grain", COARSE), more.get("radius", 0.0)
    ways = np.array([[tip], [[tip[0] + way[0], tip[1] + way[1]]]])
    pose = np.zeros(3)
    found = push(
        PLATE, (CROSS, lay, Laws()), ways, np.array([radius]), np.array([[mu]]), grain, pose
    )
    assert found == DONE
    return pose


def test_a_push_through_the_centre_carries_the_part_along() -> None:
    assert after([808.0, 0.0], [-100.0, 0.0]) == pytest.approx([-100.0, 0.0, 0.0], abs=0.05)


def test_a_tip_that_sticks_turns_the_part_as_gauss_says() -> None:
    """tan(psi / 2 + pi / 4) grows by exp(kappa xi), psi from where the arm is square to the push."""
    arm = np.array([808.0, 100.0])
    kappa, psi = np.hypot(*arm) / (RHO + arm @ arm), -np.arctan2(arm[0], arm[1])
    end = 2.0 * (np.arctan(np.tan(0.5 * psi + 0.25 * np.pi) * np.exp(kappa * 200.0)) - 0.25 * np.pi)
    assert after([808.0, 100.0], [-200.0, 0.0], 5.0)[2] == pytest.approx(end - psi, abs=2e-5)


def test_a_disc_that_sticks_rolls_back_on_its_edge_by_its_radius_times_the_turn() -> None:
    radius = 100.0
    found = after([908.0, 100.0], [-300.0, 0.0], 5.0, radius=radius, grain=FINE)
    tip = np.array([608.0, 100.0]) - found[:2]
    c, s = np.cos(found[2]), np.sin(found[2])
    own = np.array([c * tip[0] + s * tip[1], c * tip[1] - s * tip[0]])
    assert own == pytest.approx([908.0, 100.0 - radius * found[2]], abs=0.05)
    assert abs(radius * found[2]) > 1.0


def test_a_lay_of_the_part_and_of_the_stage_bends_a_push_without_friction() -> None:
    """The force is along -x; the speed is that over the tensor, the part not yet turned."""
    inverse = np.linalg.inv([[1.05, 0.03], [0.03, 0.95]])
    aside = inverse[1, 0] / inverse[0, 0]
    for place in (0, 2):
        lay = np.zeros(4)
        lay[place : place + 2] = 0.05, 0.03
        found = after([808.0, 0.0], [-50.0, 0.0], 0.0, lay=lay)
        assert found[1] / found[0] == pytest.approx(aside, rel=0.02)


def test_distance_from_a_part_that_is_not_convex() -> None:
    ell = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]])
    assert nearest(ell, 2.0, 2.0)[0] == pytest.approx(1.0)
    assert nearest(ell, 0.5, 3.0)[0] == pytest.approx(-0.5)
    assert nearest(ell, 5.0, 2.0)[0] == pytest.approx(np.sqrt(2.0))


@pytest.mark.parametrize("first", range(6))
def test_a_tip_at_a_corner_presses_inward_wherever_the_outline_begins(first: int) -> None:
    turns = np.arange(first, first + 6) * np.pi / 3.0
    hexagon = 400.0 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    for corner in hexagon:
        for beside in (-0.1, 0.1):
            outside = 1.01 * corner + beside * np.array([-corner[1], corner[0]]) / 400.0
            distance, *_, inward_x, inward_y, _ = nearest(hexagon, *outside)
            way = (corner - outside) / distance
            assert distance > 0.0
            assert (inward_x, inward_y) == pytest.approx(tuple(way), abs=1e-9)


def test_a_part_that_cannot_give_way_is_stuck() -> None:
    ways = np.array([[[808.0, 0.0], [-808.0, 0.0]], [[700.0, 0.0], [-808.0, 0.0]]])
    friction, pose = np.full((1, 2), 0.3), np.zeros(3)
    assert push(PLATE, (CROSS, EVEN, Laws()), ways, np.zeros(2), friction, Grain(), pose) == STUCK


@cache
def paper() -> Plan:
    return plan_of(paper_task())


def runs(plan: Plan, radius: tuple[float, float] | None = None) -> Outcome:
    return outcome_of(plan, drawn(plan, 4, np.random.default_rng(5), radius))


def test_a_proved_plan_holds_with_the_tips_that_it_is_proved_for_and_with_no_others() -> None:
    assert runs(paper()).outside == 0
    assert runs(paper(), (12.5, 12.5)).outside >= 3


def test_a_box_that_is_too_small_is_noticed() -> None:
    first = paper().posts[0]
    assert first is not None
    low = replace(first, y=replace(first.y, hi=first.y.mid))
    found = runs(replace(paper(), posts=(low, *paper().posts[1:])))
    assert found.outside_box > 0
    assert found.worst[1] > 1.0


def test_runs_go_on_where_they_were_stopped(tmp_path: Path) -> None:
    first = carried_on(paper(), 2, 0, None, "paper", tmp_path)
    before = (tmp_path / "results.json").read_bytes()

    assert carried_on(paper(), 2, 0, None, "paper", tmp_path) == first
    assert (tmp_path / "results.json").read_bytes() == before
    assert "| paper | 4 of 4 | 2 |" in (tmp_path / "results.md").read_text(encoding="utf-8")
