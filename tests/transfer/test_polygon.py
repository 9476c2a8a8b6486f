"""The promise made again for a part that is no rectangle."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import meso_robust as mr
from meso_robust.errors import InputError
from meso_robust.simulator.geometry import outlines
from meso_robust.task import PolygonPart, Task, load_task
from meso_robust.transfer.assumption_check import standings
from meso_robust.transfer.changing import changed, check_part
from meso_robust.transfer.envelope import reach_um
from meso_robust.transfer.promise import promise
from tests.transfer.models import budget, model

TASKS = Path(mr.__file__).parent / "tasks"
RANGES = {"rho_um2": (111_000.0, 114_000.0), "mu": (0.31, 0.35)}


def task_of(name: str) -> Task:
    return load_task(TASKS / f"{name}.toml")


def corners_of(task: Task) -> list[list[float]]:
    assert isinstance(task.part, PolygonPart)
    return [[x, y] for x, y in task.part.polygon_um]


def fitted(task: Task, effects: dict[str, tuple[float, float]], **more: Any) -> Any:
    return model(effects, base=RANGES, part={"polygon_um": corners_of(task)}, **more)


def test_a_hexagon_is_proved_again_where_the_camera_sees_it_too_long() -> None:
    task = task_of("hexagon")
    found = promise(task, fitted(task, {"camera_scale.percent": (0.02, 0.04)}), 50, 0, lambda _: nullcontext())  # fmt: skip

    assert found.planned.certificate.verdict == "PROVED"
    assert found.evidence is not None
    assert (found.evidence.runs, found.evidence.in_goal) == (50, 50)
    assert mr.check(found.planned.certificate, found.planned.task).verdict == "VERIFIED"
    # 0.04 % of 1800 um and a little more, in y as in x
    assert found.planned.task.uncertainty.sensed_position_um == pytest.approx(2.75, abs=0.05)


@pytest.mark.parametrize(
    ("effect", "word"),
    [
        ("drag_gradient.x_per_mm", "breaks a premise"),
        ("shear_thinning.exponent_drop", "breaks a premise"),
        ("drag_centre_offset.x_um", "absorbed"),
    ],
)
def test_bounds_of_the_film_under_a_rectangle_are_of_no_other_part(effect: str, word: str) -> None:
    document = fitted(task_of("hexagon"), {effect: (0.001, 0.002)})
    found = {one.name: one for one in standings(document, budget(rectangle=False, slender=0.0))}
    one = found[effect.partition(".")[0]]
    assert one.word == word
    assert ("rectangle" in one.said) == (word != "absorbed")
    of_a_rectangle = {one.name: one for one in standings(document, budget())}
    assert of_a_rectangle[one.name].word == "absorbed"


@pytest.mark.parametrize("name", ["hexagon", "l_shape"])
def test_edges_of_a_stretched_polygon_lie_within_the_tolerances(name: str) -> None:
    """Parts as the simulator stretches them, against what is written into the task."""
    task = task_of(name)
    document = fitted(task, {"part_geometry.x_um": (0.8, 1.6), "part_geometry.y_um": (-0.5, 0.1)})
    after = changed(task, document, standings(document, budget(rectangle=False))).task
    assert isinstance(after.part, PolygonPart)
    stated = _lines(np.array(corners_of(after)))
    rng, most = np.random.default_rng(4), np.zeros(2)
    for share in (*rng.random((20, 2)), *np.array([[0, 0], [0, 1], [1, 0], [1, 1]])):
        values = document.values.copy()
        for k, one in enumerate(document.made().parameters):
            if one.key.startswith("part_geometry"):
                section = document.parameters[one.key]
                axis = int(one.key.endswith("y_um"))
                values[k] = (section.low + share[axis] * (section.high - section.low)) * one.to_si
        table = document.made().physics(values[None]).effects.table
        true = _lines(1e6 * outlines(1e-6 * np.array(corners_of(task)), table)[0])
        turned = np.abs((true[:, 1] - stated[:, 1] + np.pi) % (2 * np.pi) - np.pi)
        most = np.maximum(most, [np.abs(true[:, 0] - stated[:, 0]).max(), np.degrees(turned).max()])
    allowed = np.array([0.5 * (after.part.size_tolerance_um or 0.0), after.part.squareness_deg])
    assert (most <= allowed).all()
    # beyond that are roundings of corners and tolerances to 0.01 um and 0.01 deg only
    assert (most > allowed - [0.03, 0.011]).all()


def test_a_polygon_that_may_be_turned_inside_out_is_refused() -> None:
    task = task_of("hexagon")
    document = fitted(task, {"part_geometry.x_um": (-500.0, 1.0)})
    with pytest.raises(InputError, match="part_geometry: an edge may stand in by half the part"):
        changed(task, document, standings(document, budget(rectangle=False)))


def _lines(corners: Any) -> Any:
    """(V, 2) distance of each edge from the reference point, um, and direction."""
    along = np.roll(corners, -1, axis=0) - corners
    cross = corners[:, 0] * along[:, 1] - corners[:, 1] * along[:, 0]
    return np.column_stack([cross / np.hypot(*along.T), np.arctan2(along[:, 1], along[:, 0])])


def test_the_farthest_corner_is_how_far_a_contact_can_be() -> None:
    assert reach_um(task_of("l_shape")) == pytest.approx(np.hypot(760.0, 440.0))


def test_a_model_is_of_the_same_polygon_whichever_its_first_corner() -> None:
    task = task_of("l_shape")
    corners = corners_of(task)
    check_part(task, model(part={"polygon_um": [*corners[2:], *corners[:2]]}), "here")
    other = [corners[0], [760.0, -441.0], *corners[2:]]
    for part in ({"polygon_um": other}, {"length_um": 1200.0, "width_um": 1200.0}):
        with pytest.raises(InputError, match=r"here: key part.*polygon of 6 corners"):
            check_part(task, model(part=part), "here")
