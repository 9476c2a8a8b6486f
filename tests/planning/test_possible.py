"""Tasks that no plan can do are refused before anything is searched."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.planning.possible import _overlap, refuse_impossible, remarks
from meso_robust.task import Task, load_task
from meso_robust.tasks import HEXAGON, L_SHAPE, SLOT, TASKS


def changed(task: Task, **sections: dict[str, Any]) -> Task:
    values = task.to_dict()
    for name, keys in sections.items():
        values[name] |= keys
    return Task.from_dict(values)


@pytest.mark.parametrize("path", TASKS, ids=lambda path: path.stem)
def test_shipped_tasks_are_possible_and_usual(path: Any) -> None:
    task = load_task(path)
    refuse_impossible(task)
    assert not [one for one in remarks(task) if not one.startswith("uncertainty.film_ratio_um2")]


def test_a_part_that_may_touch_a_wall_at_its_start_is_refused() -> None:
    task = load_task(SLOT)
    slot = task.slot
    assert slot is not None
    inside = {"x_um": slot.mouth_x_um, "y_um": slot.mouth_y_um}
    with pytest.raises(
        InputError, match=r"key start: .* may touch a wall .* start further outside"
    ):
        refuse_impossible(changed(task, start=inside))


@pytest.mark.parametrize(("width", "fits"), [(800.0, False), (830.0, False), (838.0, True)])
def test_a_slot_that_is_narrower_than_the_part_is_refused(width: float, fits: bool) -> None:
    """The part is 837 um wide, and the goal lies within the slot by more than its tolerance."""
    task = load_task(SLOT)
    narrow = changed(
        task,
        slot={"width_um": width},
        goal={"position_tolerance_um": 20.0, "orientation_tolerance_deg": 1.0},
    )
    if fits:
        refuse_impossible(narrow)
        return
    with pytest.raises(
        InputError, match=f"key goal: .* {width:g} um wide .* widen or move the slot"
    ):
        refuse_impossible(narrow)


def test_more_than_any_drag_is_refused_and_a_unit_is_guessed() -> None:
    task = load_task(HEXAGON)
    ratio = task.uncertainty.film_ratio_um2
    with pytest.raises(InputError, match=r"film_ratio_um2: .* must be no more than .* identify"):
        refuse_impossible(changed(task, uncertainty={"film_ratio_um2": 5.0 * ratio}))
    for unit, factor in (("mm^2", 1e-6), ("m^2", 1e-12)):
        (said,) = remarks(changed(task, uncertainty={"film_ratio_um2": factor * ratio}))
        assert f"as if it were in {unit};" in said


@pytest.mark.parametrize(
    ("section", "keys", "said"),
    [
        ("probe", {"tip_spacing_um": 5000.0}, "wider than every edge"),
        ("goal", {"position_tolerance_um": 2.0}, "finer than the probes are placed"),
        ("start", {"theta_deg": 1.588}, "quarter turns in rad"),
    ],
)
def test_what_leaves_no_plan_is_remarked(section: str, keys: dict[str, float], said: str) -> None:
    task = (
        changed(Task.paper(), goal={"theta_deg": 3.14159}) if section == "start" else Task.paper()
    )
    assert not [one for one in remarks(Task.paper()) if said in one]
    assert [one for one in remarks(changed(task, **{section: keys})) if said in one]


def test_overlap_is_that_of_opencv() -> None:
    rng = np.random.default_rng(3)
    part = np.array(
        [[400.0, 0.0], [100.0, 250.0], [-300.0, 150.0], [-350.0, -200.0], [200.0, -260.0]]
    )
    wall = np.array([[x, y] for x in (0.0, 900.0) for y in (0.0, 300.0)])
    square = wall[[0, 2, 3, 1]]
    seen = []
    for x, y, theta in rng.uniform((-600.0, -600.0, -3.2), (1400.0, 900.0, 3.2), (400, 3)):
        depth = _overlap(part, (x, y, theta), wall)
        c, s = np.cos(theta), np.sin(theta)
        placed = part @ np.array([[c, s], [-s, c]]) + [x, y]
        area, _ = cv2.intersectConvexConvex(placed.astype(np.float32), square.astype(np.float32))
        if abs(depth) > 0.05:
            assert (depth > 0.0) == (area > 0.0)
            seen.append(depth > 0.0)
            # pushed away by less along any direction, it still overlaps
            way = rng.normal(size=2)
            less = 0.99 * depth / np.hypot(*way) * way
            assert depth < 0.0 or _overlap(part, (x + less[0], y + less[1], theta), wall) > 0.0
    assert 50 < sum(seen) < 350


def test_a_part_with_a_notch_is_left_to_the_search() -> None:
    """A wall may stand in the notch."""
    shape, slot = load_task(L_SHAPE).to_dict(), load_task(SLOT).to_dict()
    task = Task.from_dict(
        {**shape, "slot": slot["slot"] | {"mouth_x_um": -4000.0, "width_um": 100.0}}
    )
    on_wall = {"x_um": -4500.0, "y_um": task.slot.mouth_y_um if task.slot else 0.0}
    refuse_impossible(changed(task, goal=on_wall))
