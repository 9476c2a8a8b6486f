"""Bounds of effects, held against the simulator's own laws and against numbers by hand."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.simulator import Effects, Push, simulate
from meso_robust.simulator.geometry import tracked_of_reference
from meso_robust.simulator.observation import observe
from meso_robust.transfer.inflation import Absorbed, Ends, rounded_up, spelled
from meso_robust.transfer.lines import LINES
from tests.transfer.models import budget

Floats = npt.NDArray[np.float64]
BUDGET = budget(radius_um=2500.0, seconds=120.0)
SEEN = {
    "camera_rotation": {
        "angle_deg": (-0.2, 0.1),
        "about_x_um": (-900.0, 300.0),
        "about_y_um": (200.0, 400.0),
    },
    "lens_distortion": {"k1_per_mm2": (-1e-3, 4e-4), "turned": (0.2, 1.0)},
    "camera_scale": {
        "percent": (-0.3, 0.2),
        "about_x_um": (100.0, 200.0),
        "about_y_um": (-700.0, 700.0),
    },
    "camera_drift": {"x_um_s": (-0.05, 0.02), "y_um_s": (0.0, 0.1)},
    "reference_offset": {"x_um": (3.0, 8.0), "y_um": (-4.0, -2.0)},
    "part_yaw": {"angle_deg": (-0.3, 0.1)},
    "camera_anisotropy": {
        "x_percent": (-0.4, 0.1),
        "y_percent": (0.1, 0.5),
        "shear_percent": (-0.05, 0.1),
        "turned": (0.0, 1.0),
    },
    "registration_shift": {"x_um": (-5.0, 2.0), "y_um": (1.0, 1.5)},
}
"""Effects on what is seen of a part at rest, with intervals that are not symmetric."""
HALF = np.array([808e-6, 418.5e-6])


def bound(effect: str, ranges: dict[str, Ends]) -> Absorbed:
    absorb = LINES[effect].absorb
    assert absorb is not None
    found = absorb(ranges, BUDGET)
    assert found is not None
    return found


def errors(effects: dict[str, dict[str, Ends]], runs: int = 3000) -> tuple[float, float]:
    """Largest error (um, deg) of poses seen within the budget, by the simulator's own stages."""
    rng = np.random.default_rng(3)
    angle = rng.uniform(-4.0, 4.0, (3, runs))
    # half of them as far out as they can be
    far = (1e-6 * BUDGET.radius_um - 100e-6) * np.rint(rng.random(runs))
    poses = np.stack([far * np.cos(angle[0]), far * np.sin(angle[0]), angle[1]], axis=1)
    drawn = {
        effect: {
            key: low + np.rint(rng.random(runs)) * (high - low) for key, (low, high) in of.items()
        }
        for effect, of in effects.items()
    }
    table = Effects(drawn).table
    shown, _ = observe(
        np.array([BUDGET.seconds]),
        tracked_of_reference(poses, table)[:, None],
        np.zeros((runs, 1, 1, 2)),
        table,
        probes_seen_by_camera=False,
    )
    off = np.abs(shown[:, 0] - poses).max(axis=0)
    return float(1e6 * off[:2].max()), float(np.degrees(off[2]))


@pytest.mark.parametrize("effect", SEEN)
def test_what_is_added_to_sensing_holds_and_is_not_needlessly_wide(effect: str) -> None:
    most_um, most_deg = errors({effect: SEEN[effect]})
    found = bound(effect, SEEN[effect])

    assert 0.8 * found.sensed_um <= most_um <= found.sensed_um
    assert most_deg <= found.turned_deg + 1e-9
    assert found.turned_deg <= 1.1 * most_deg + 0.01


def test_the_bounds_together_hold_for_all_effects_together() -> None:
    """All that is added stays below the 100 um that the poses keep from the edge of the budget."""
    most_um, _ = errors({name: dict(of) for name, of in SEEN.items()})
    added = [bound(name, of).sensed_um for name, of in SEEN.items()]

    assert sum(added) < 100.0
    assert max(added) < most_um <= sum(added)


def test_bounds_by_hand() -> None:
    # 0.1 deg at 2.5 mm is 4.363 um; 0.2 % of it 5 um; 0.001/mm^2 of (2.5 mm)^3 15.625 um
    assert bound("camera_rotation", {"angle_deg": (-0.1, 0.05)}).sensed_um == pytest.approx(4.37)
    assert bound("camera_scale", {"percent": (0.0, 0.2)}).sensed_um == pytest.approx(5.0, abs=0.011)
    # a middle 500 um from the origin: 0.2 % of 3 mm is 6 um, 0.1 deg of it 5.236 um
    middle = {"about_x_um": (-300.0, 100.0), "about_y_um": (0.0, 400.0)}
    scale, turn = {"percent": (0.0, 0.2), **middle}, {"angle_deg": (0.0, 0.1), **middle}
    assert bound("camera_scale", scale).sensed_um == pytest.approx(6.0, abs=0.011)
    assert bound("camera_rotation", turn).sensed_um == pytest.approx(5.24, abs=0.011)
    assert bound("lens_distortion", {"k1_per_mm2": (1e-3, 1e-3)}).sensed_um == pytest.approx(15.63)
    # b = 0.00625 of a lens of 0.001/mm^2 at 2.5 mm: arcsin(0.00625 / 0.9875) is 0.36264 deg
    lens = {"k1_per_mm2": (0.0, 1e-3), "turned": (-0.5, 1.0)}
    assert bound("lens_distortion", lens).turned_deg == pytest.approx(0.37)
    folded = {"k1_per_mm2": (0.0, 0.06), "turned": (0.0, 0.1)}
    assert bound("lens_distortion", folded).turned_deg >= 180.0
    assert bound("backlash", {"width_um": (2.0, 6.0)}).probe_um == 3.0
    assert bound("part_geometry", {"x_um": (2.0, 4.0), "y_um": (-1.0, 0.5)}).length_um == (4.0, 8.0)
    assert "61 ms" in bound("camera_latency", {"time_ms": (-20.0, 60.5)}).condition


def test_rounding_up_never_falls_below() -> None:
    rng = np.random.default_rng(1)
    for value in rng.uniform(0.0, 1e3, 200):
        assert spelled(rounded_up(value)) > spelled(value)
        assert rounded_up(value) - value < 0.01001
    assert rounded_up(spelled(6.7) + spelled(0.07)) == 6.77


def pushed(
    effects: dict[str, dict[str, float | Floats]], shift: float = 0.0, runs: int = 1
) -> Floats:
    """Final poses of a slanting one-tip push along -x on the long edge, shifted along x."""
    tips = np.tile([[[HALF[1] + 30e-6 + shift, 150e-6]]], (runs, 1, 1))
    travel = np.tile([[[-400e-6, 0.0]]], (runs, 1, 1))
    corners = HALF * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    result = simulate(
        Push.straight(
            vertices=corners,
            poses=np.tile([[0.0, 0.0, 0.5 * math.pi]], (runs, 1)),
            tips=tips,
            travel=travel,
            friction=np.full(runs, 0.3),
            film_ratio=3.7e-7,
            effects=Effects(effects),
            step=2e-6,
        )
    )
    assert np.all(result.outcomes == 0)
    return result.poses


def test_backlash_moves_the_part_as_a_constant_error_of_half_the_lost_motion_does() -> None:
    slack = pushed({"backlash": {"width_um": 8.0}})
    late = pushed({}, shift=4e-6)

    np.testing.assert_allclose(slack[0, :2], late[0, :2], atol=0.05e-6)
    assert abs(slack[0, 2] - late[0, 2]) < 1e-4
    assert np.hypot(*(pushed({})[0, :2] - slack[0, :2])) > 3e-6


def test_a_drag_that_grows_as_a_whole_moves_the_part_alike() -> None:
    """Up to the steps, which are of another length where something goes on in time."""
    drifting, plain = pushed({"drag_drift": {"rate_percent_s": 30.0}}), pushed({})

    assert not np.array_equal(drifting, plain)
    np.testing.assert_allclose(drifting, plain, rtol=0, atol=1e-6)
    np.testing.assert_allclose(drifting[:, :2], plain[:, :2], rtol=0, atol=1e-9)
