"""The whole box of a task of schema 2: what is drawn, and the parts, films and ways made of it."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.laboratory.draws import LEGS, Draws, draw, nominal
from meso_robust.laboratory.judging import UNFINISHED
from meso_robust.laboratory.making import WANDERS_WITHIN, film_of, true_outlines, true_ways
from meso_robust.laboratory.replay import Feedback, limits, nominal_row
from meso_robust.laboratory.running import run
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.task import Task, parse_task
from tests.laboratory.paper import paper_player
from tests.paper import paper_task

Floats = npt.NDArray[np.float64]
UM, DEG = 1e-6, math.radians(1.0)
BOX: dict[str, dict[str, Any]] = {
    "part": {"size_tolerance_um": 4.0, "squareness_deg": 0.2, "corner_radius_um": 5.0},
    "probe": {"tip_radius_um": [2.5, 12.5], "tip_spacing_tolerance_um": 1.0},
    "uncertainty": {
        "travel_direction_deg": [-0.1, 0.2], "travel_scale_percent": 0.5, "drag_centre_um": 20.0,
        "drag_anisotropy_percent": 5.0, "probe_wander_um": 1.0,
    },
}  # fmt: skip


def real_task(**changes: Any) -> Task:
    """The paper's task with everything of schema 2."""
    values = {k: v for k, v in paper_task().to_dict().items() if v is not None}
    values["schema"] = "meso-robust/task/2"
    for section, keys in BOX.items():
        stated = {k: v for k, v in values[section].items() if v is not None}
        values[section] = {**stated, **keys, **changes.get(section, {})}
    return parse_task(values, "real paper task")


@cache
def setup() -> Setup:
    return setup_of(real_task())


def player(**changes: Any) -> Feedback:
    made = setup_of(real_task(**changes)) if changes else setup()
    return Feedback(rules=paper_player().rules, setup=made, engine="events")


def drawn(runs: int = 400) -> Draws:
    return draw(setup(), 4, runs, np.random.default_rng(2))


def test_a_task_of_schema_1_has_the_columns_that_it_had() -> None:
    names = [column.name for column in paper_player().columns]
    assert names[:8] == [
        "start x_m", "start y_m", "start theta_rad", "friction", "film_ratio_m2",
        "misalignment_rad", "move 1 dtp x_m", "move 1 dtp y_m",
    ]  # fmt: skip
    assert paper_player().leading == 6
    assert not any(word in " ".join(names) for word in ("radius", "edge", "wander", "scale"))


def test_rows_and_draws_are_the_same_numbers_within_their_ranges() -> None:
    rows = player().draw(40, np.random.default_rng(0))
    low, high = limits(player())

    again = player().rows_of(player().draws_of(rows))

    assert np.array_equal(again, rows)
    assert ((low <= rows) & (rows <= high)).all()
    at_ends = (rows == low) | (rows == high)
    assert at_ends[20:].all()
    assert not at_ends[:20].any()
    assert len({column.name for column in player().columns}) == rows.shape[1]
    assert not any(column.name == "friction" for column in player().columns)


def test_edges_of_a_part_lie_and_are_turned_as_drawn() -> None:
    task = real_task(part={"corner_radius_um": 0.0})
    draws = draw(setup_of(task), 1, 50, np.random.default_rng(1))
    assert draws.edges is not None
    corners = true_outlines(setup_of(task), draws)
    side = np.roll(corners, -1, axis=1) - corners
    angle = np.unwrap(np.arctan2(side[..., 1], side[..., 0]), axis=1)
    outward = np.stack([side[..., 1], -side[..., 0]], axis=2)
    outward /= np.linalg.norm(outward, axis=2, keepdims=True)
    far = np.sum(outward * corners, axis=2)

    assert far == pytest.approx(np.array([418.5, 808.0, 418.5, 808.0]) * UM + draws.edges[..., 0])
    assert angle == pytest.approx(np.array([0, 90, 180, 270]) * DEG + draws.edges[..., 1])
    assert np.abs(draws.edges[..., 0]).max() == pytest.approx(2.0 * UM)
    assert np.abs(draws.edges[..., 1]).max() == pytest.approx(0.2 * DEG)


def test_rounded_corners_lie_on_circles_that_touch_both_edges() -> None:
    exact = real_task(part={"size_tolerance_um": 0.0, "squareness_deg": 0.0})
    (corners,) = true_outlines(setup_of(exact), nominal(setup_of(exact), 1))
    centres = np.array([[-803.0, -413.5], [803.0, -413.5], [803.0, 413.5], [-803.0, 413.5]]) * UM

    away = corners.reshape(4, 3, 2) - centres[:, None]
    assert np.linalg.norm(away, axis=2) == pytest.approx(np.full((4, 3), 5.0 * UM))
    assert corners[0] == pytest.approx(np.array([-808.0, -413.5]) * UM)
    assert corners[2] == pytest.approx(np.array([-803.0, -418.5]) * UM)


def test_a_force_at_the_centre_of_drag_does_not_turn_the_part() -> None:
    draws = drawn()
    assert draws.drag_centre is not None
    assert draws.lay is not None
    film = film_of(setup(), draws)
    centre = draws.drag_centre * np.minimum(
        1.0, 20.0 * UM / np.linalg.norm(draws.drag_centre, axis=1, keepdims=True)
    )
    force = np.array([np.cos(1.0), np.sin(1.0)])
    moment = centre[:, 0] * force[1] - centre[:, 1] * force[0]
    wrench = np.column_stack([np.tile(force, (len(centre), 1)), moment])
    twist = np.linalg.solve(film.drag, wrench[..., None])[..., 0]

    assert np.abs(twist[:, 2]).max() < 1e-9
    assert film.drag[:, 2, 2] - np.sum(centre**2, axis=1) * 1.0 == pytest.approx(
        draws.film_ratio, rel=0.1
    )
    # the principal drags differ by no more than 5 % of their mean, part and stage together
    part = 0.5 * (film.drag[:, 0, 0] - film.drag[:, 1, 1])
    most = np.hypot(part, film.drag[:, 0, 1]) + np.linalg.norm(film.stage_lay, axis=1)
    assert most.max() == pytest.approx(0.025)
    assert np.linalg.norm(centre, axis=1).max() == pytest.approx(20.0 * UM)


def test_ways_are_turned_scaled_and_stray_no_more_than_they_may() -> None:
    draws = drawn()
    assert draws.direction is not None
    assert draws.scale is not None
    count = len(draws.start)
    tips = np.zeros((count, 3, 2))
    travel = np.tile([[-300.0, 0.0], [-300.0, 0.0], [0.0, 0.0]], (count, 1, 1)) * UM
    ways = true_ways(setup(), draws, 1, tips, travel)
    length = 300.0 * UM * (1.0 + draws.scale[:, 1])
    turn = draws.direction[:, 1]
    straight = -length[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])

    assert ways.shape == (count, LEGS + 1, 3, 2)
    assert not ways[:, :, 2].any()
    off = ways[:, :, 0] - np.linspace(0.0, 1.0, LEGS + 1)[:, None] * straight[:, None]
    assert np.abs(off).max() == pytest.approx(1.0 * UM)
    np.testing.assert_array_equal(ways[:, :, 0], ways[:, :, 1])
    legs = np.diff(ways[:, :, 0], axis=1)
    bend = np.arctan2(-legs[..., 1], -legs[..., 0]) - turn[:, None]
    assert np.abs(np.tan(bend)).max() <= 1.0 * UM / WANDERS_WITHIN
    short = true_ways(setup(), draws, 1, tips, 0.1 * travel)
    legs = np.diff(short[:, :, 0], axis=1)
    bend = np.arctan2(-legs[..., 1], -legs[..., 0]) - turn[:, None]
    assert np.abs(np.tan(bend)).max() <= 1.0 * UM / WANDERS_WITHIN
    assert np.abs(np.tan(bend)).max() > 0.9 * UM / WANDERS_WITHIN


def test_radius_and_friction_belong_to_a_tip_whichever_way_the_axes_lie() -> None:
    """The tip on the right, seen along the push, is the upper one unless the axes are mirrored."""
    draws = replace(nominal(setup(), 4), radii=np.array([[3.0, 5.0, 7.0]]) * UM)
    runs = run(player().rules, setup(), draws, engine="events")
    for rule, move in zip(player().rules, runs.moves, strict=True):
        right_first = [3.0, 5.0, 7.0] if not rule.frame.mirrored else [5.0, 3.0, 7.0]
        assert move.radii[0] / UM == pytest.approx(right_first[: move.radii.shape[1]])
        way = move.travel[0, 0]
        right = np.array([way[1], -way[0]])
        three = int(np.argmin(np.abs(move.radii[0] - 3.0 * UM)))
        other = 1 - three
        assert right @ (move.tips[0, three] - move.tips[0, other]) > 0.0


def test_both_engines_end_alike_on_draws_of_the_whole_box() -> None:
    rows = player().draw(24, np.random.default_rng(7))
    exact = player().run(rows)
    stepped = replace(player(), engine="stepper").run(rows, step=0.5 * UM)

    assert (exact.completed == stepped.completed).all()
    done = exact.completed
    assert done.sum() > 10
    assert not np.isin(exact.outcomes, UNFINISHED).any()
    assert np.abs(exact.final - stepped.final)[done, :2].max() < 0.2 * UM


@pytest.mark.parametrize(
    "field",
    ["tip_friction", "spacing", "radii", "edges", "drag_centre", "lay", "direction", "scale", "wander"],
)  # fmt: skip
def test_everything_that_is_drawn_changes_the_runs(field: str) -> None:
    draws = drawn(12)
    exact: dict[str, Any] = {field: None}
    without = replace(draws, **exact)
    ends = [run(player().rules[:3], setup(), d, engine="events").final for d in (draws, without)]
    assert np.abs(ends[0] - ends[1]).max() > 1e-9


def test_the_nominal_row_is_the_nominal_run() -> None:
    runs = player().run(nominal_row(player()))
    again = run(player().rules, setup(), nominal(setup(), 4), engine="events")
    assert np.array_equal(runs.final, again.final)
