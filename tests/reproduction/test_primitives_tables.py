"""Tables III to V: against closed forms written out here, and against the simulator."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.reproduction.primitive_runs import (
    lying,
    measured,
    net,
    nominal_runs,
    paper_setup,
    rotation,
    turned_deg,
    x_translation,
    y_translations,
)
from meso_robust.reproduction.primitives_tables import standing
from meso_robust.reproduction.primitives_tables_figures import arm_um, stops_at
from meso_robust.simulator import Outcome

Floats = npt.NDArray[np.float64]


def kinematic_deg(push: float, separation: float) -> float:
    """The turn by the law of sines, as one would draw it."""
    across, width = width_left(push), 837.0
    return float(
        np.degrees(np.arctan2(separation, across) + np.arcsin(width / np.hypot(across, separation)))
        - 90.0
    )


def width_left(push: float) -> float:
    return 837.0 - push


@pytest.mark.parametrize(
    ("push", "separation"), [(0.0, 857.0), (500.0, 857.0), (1100.0, 930.0), (2000.0, 890.0)]
)
def test_the_turn_is_that_of_two_tips_on_parallel_edges(push: float, separation: float) -> None:
    assert turned_deg(push, separation) == pytest.approx(kinematic_deg(push, separation), abs=1e-9)


def test_printed_numbers_of_the_turn() -> None:
    assert 90.0 - turned_deg(1100.0, 857.0) == pytest.approx(3.9, abs=0.05)
    # eq. (11) is reached where the tips stand on opposite corners
    diagonal = np.hypot(837.0, 1616.0)
    corners = 837.0 + np.sqrt(diagonal**2 - 857.0**2)
    tilt = np.degrees(np.arcsin(857.0 / diagonal) - np.arctan(837.0 / 1616.0))
    assert 90.0 - turned_deg(corners, 857.0) == pytest.approx(tilt, abs=1e-9)


@pytest.mark.parametrize(("push", "separation"), [(600.0, 930.0), (1100.0, 890.0)])
def test_the_simulated_turn_is_the_kinematic_one(push: float, separation: float) -> None:
    setup = paper_setup()
    found = net(rotation(separation, push, setup), setup)[0]
    assert found[2] == pytest.approx(kinematic_deg(push, separation), abs=1e-6)


def test_the_printed_separation_jams_from_the_friction_on_that_the_grasp_closes() -> None:
    setup = paper_setup()
    closes = np.sqrt((857.0 / 837.0) ** 2 - 1.0)
    friction = [closes - 0.01, closes + 0.01, 0.33]
    runs = nominal_runs(rotation(857.0, 1100.0, setup), setup, friction=friction)
    assert runs.outcomes.tolist() == [Outcome.COMPLETED, Outcome.JAM, Outcome.JAM]
    assert np.degrees(runs.final[2, 2]) == pytest.approx(148.2, abs=0.1)


@pytest.mark.parametrize("edge", ["long", "short"])
def test_aligned_tips_push_the_part_straight_on(edge: str) -> None:
    setup = paper_setup() if edge == "long" else lying(paper_setup())
    np.testing.assert_allclose(
        net(x_translation(950.0, setup), setup)[0], [950.0, 0.0, 0.0], atol=1e-3
    )


def test_simulated_y_translations_gain_arm_times_versed_tilt() -> None:
    found = y_translations(paper_setup(), 600, 1)
    assert len(found.arm_um) >= 10
    versed = 1.0 - np.cos(np.radians(found.tilt_deg))
    np.testing.assert_allclose(found.net[:, 1], found.arm_um * versed, atol=0.01)
    np.testing.assert_allclose(found.net[:, 2], 0.0, atol=1e-6)
    np.testing.assert_allclose(found.theory_um, found.arm_um * versed, rtol=1e-9)
    assert np.all(found.net[:, 0] > 0.0)


def test_the_curve_of_a_gain() -> None:
    tilt = np.array([5.0, 10.0, 20.0])
    np.testing.assert_allclose(arm_um(tilt, 11.0), 11.0 / (1.0 - np.cos(np.radians(tilt))))


def test_the_camera_adds_its_errors_before_and_after() -> None:
    setup = paper_setup()
    found = measured([x_translation(950.0, setup)], setup, 200, 0)
    off = np.abs(found.seen - found.true)
    assert np.all(off <= np.array([10.0, 10.0, 0.6]) * (1 + 1e-9))
    assert np.all(off.max(axis=0) > np.array([5.0, 5.0, 0.3]))
    # the start is off by the camera's error, and the end by that of sensing and probe
    assert 10.0 < np.ptp(found.true[:, 0]) <= 20.2


def test_a_path_stops_where_it_no_longer_turns() -> None:
    path: Floats = np.column_stack([np.arange(6.0), [0.0, 1.0, 2.0, 3.0, 3.0, 3.0]])
    assert stops_at(path) == 3
    assert stops_at(path[:1]) == 0


def test_a_table_stands_only_if_its_numbers_do() -> None:
    def trials(x: float, completed: bool) -> Any:
        return SimpleNamespace(seen=np.full((2, 3), x), completed=np.array([True, completed]))

    def free(error: float) -> Any:
        return SimpleNamespace(theory_um=np.array([11.0 + error]), net=np.array([[0.0, 11.0, 0.0]]))

    def turns(ends: bool, turn: float) -> Any:
        return SimpleNamespace(printed=trials(0.0, ends), nominal=np.array([[0.0, 0.0, turn]]))

    good = standing(free(0.0), turns(True, 80.0), {"long": trials(950.0, True)})
    assert good == {"III": True, "IV": True, "V": True}
    bad = standing(free(0.1), turns(False, 80.0), {"long": trials(900.0, True)})
    assert bad == {"III": False, "IV": False, "V": False}
    jammed = standing(free(0.0), turns(False, 90.0), {"long": trials(950.0, False)})
    assert jammed == {"III": True, "IV": True, "V": False}
