"""The plant's effects, each against what it is by hand."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.plant.part import LyingPart, nodes_of, outline_of
from meso_robust.plant.world import World, world_of
from meso_robust.simulator.catalogue import CATALOGUE

Floats = npt.NDArray[np.float64]
PLATE = np.array([[-808.0, -418.5], [808.0, -418.5], [808.0, 418.5], [-808.0, 418.5]])
RHO = 376900.0
Effects = Mapping[str, Mapping[str, float]]


def lying(effects: Effects, pose: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> LyingPart:
    return LyingPart(PLATE, RHO, world_of(effects), np.array(pose))


def pushed(
    effects: Effects, start: tuple[float, float], way: tuple[float, float], mu: float = 0.3
) -> Floats:
    """Pose after a push by a tip of 12.5 um at 75 um/s."""
    part, tip = lying(effects), np.array(start)
    length = float(np.hypot(*way))
    steps = max(int(length / 1.25), 1)
    for _ in range(steps):
        after = tip + np.array(way) / steps
        part.pushed({"tip": (tip, after, 12.5, mu)}, length / 75.0 / steps)
        tip = after
    assert not part.stuck
    return part.pose


def test_names_and_parameters_are_those_of_the_catalogue() -> None:
    from meso_robust.plant.world import _EFFECTS

    for name, (defaults, _) in _EFFECTS.items():
        # the plant has one form of each law, and turns and scales an image about the origin of the stage
        other = {"turned", "form", "about_x_um", "about_y_um", "time_s", "growth_um_s_per_mm"}
        if name in ("probe_compliance", "body_force"):
            other |= {"direction_deg", "across"}  # of their other forms
        if name == "shear_thinning":
            other |= {"speed_um_s"}  # likewise
        keys = {parameter.key for parameter in CATALOGUE[name].parameters} - other
        assert set(defaults) == keys, name
        for parameter in CATALOGUE[name].parameters:
            if parameter.key in defaults:
                shown = parameter.shown(parameter.default)
                assert defaults[parameter.key] == pytest.approx(shown), (name, parameter.key)


def test_what_is_unknown_is_refused() -> None:
    with pytest.raises(ValueError, match="must be one of dry_friction"):
        world_of({"magic": {}})
    with pytest.raises(ValueError, match=r"effects\.dry_friction\.size: must be one of ratio"):
        world_of({"dry_friction": {"size": 1.0}})


def test_a_part_that_nothing_acts_on_stays() -> None:
    part = lying({}, (3.0, 4.0, 0.5))
    part.pushed({}, 100.0)
    assert part.pose.tolist() == [3.0, 4.0, 0.5]


def test_a_flow_takes_the_part_along_and_a_force_drives_it_as_fast_as_the_drag_allows() -> None:
    for name in ("film_flow", "body_force"):
        part = lying({name: {"x_um_s": 3.0, "y_um_s": -1.0}})
        part.pushed({}, 10.0)
        assert part.pose == pytest.approx([30.0, -10.0, 0.0], abs=0.01), name


def test_friction_under_the_part_withstands_a_force_that_is_smaller() -> None:
    part = lying({"dry_friction": {"ratio": 0.2}, "body_force": {"x_um_s": 10.0}})
    part.pushed({}, 2.0)
    assert 0.0 < part.pose[0] < 0.1  # what creeps
    part = lying({"dry_friction": {"ratio": 0.1}, "body_force": {"x_um_s": 10.0}})
    part.pushed({}, 2.0)
    assert part.pose[0] == pytest.approx(2.0 * 2.5, rel=0.02)


def test_a_post_holds_the_part_back() -> None:
    post = {"unmodelled_wall": {"radius_um": 50.0, "x_um": -880.0, "y_um": 300.0}}
    free = pushed({}, (821.0, 0.0), (-50.0, 0.0))
    held = pushed(post, (821.0, 0.0), (-50.0, 0.0), 0.0)
    assert free[2] == pytest.approx(0.0, abs=1e-4)
    assert held[2] < -0.05  # it turns about the post: its upper side stays


def test_a_part_between_a_tip_and_a_post_jams_where_friction_outweighs_the_lever() -> None:
    post = {"unmodelled_wall": {"radius_um": 50.0, "x_um": -880.0, "y_um": 300.0}}
    part, tip = lying(post), np.array([821.0, 0.0])
    part.pushed({"tip": (tip, tip - [100.0, 0.0], 12.5, 0.3)}, 100.0 / 75.0)
    assert part.stuck  # 1638 um x 0.3 > 300 um


def test_a_soft_probe_lags_by_its_time_times_the_force() -> None:
    stiff = pushed({}, (820.5, 0.0), (-200.0, 0.0))
    soft = pushed({"probe_compliance": {"time_ms": 100.0}}, (820.5, 0.0), (-200.0, 0.0))
    assert soft[0] - stiff[0] == pytest.approx(0.1 * 75.0, rel=0.02)


def test_a_tip_that_adheres_pulls_the_part_along() -> None:
    part = lying({"tip_adhesion": {"pull_um_s": 200.0, "range_um": 3.0}})
    tip = np.array([820.0, 0.0])
    for way in [np.array([-0.5, 0.0])] * 20 + [np.array([0.5, 0.0])] * 60:
        part.pushed({"tip": (tip, tip + way, 12.5, 0.3)}, 0.5 / 75.0)
        tip = tip + way
    assert part.pose[0] > 5.0


def test_the_film_has_its_ratio_whatever_its_nodes() -> None:
    for world in (World(), world_of({"dry_friction": {"ratio": 0.1}})):
        nodes = nodes_of(PLATE, RHO, world)
        assert np.mean(np.sum(nodes[:, :2] ** 2, axis=1)) == pytest.approx(RHO)
        assert nodes[:, :2].mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_edges_stand_out_by_what_is_stated() -> None:
    grown = outline_of(PLATE, world_of({"part_geometry": {"x_um": 2.0, "y_um": -1.0}}))
    assert np.ptp(grown, axis=0) == pytest.approx([1620.0, 835.0])
