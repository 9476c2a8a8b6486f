"""Why a run jammed: contacts and closing friction against the geometry of the line of tips."""

import numpy as np
import pytest

from meso_robust.simulator import Film, Fixture, Push, simulate
from meso_robust.simulator.jam import explain_jam
from tests.simulator.problems import HALF_SHORT, RHO, UM, rectangle, two_sided


@pytest.mark.parametrize("height", [820, 857, 875])
def test_cones_close_on_the_line_through_the_tips(height: float) -> None:
    push = two_sided([height * UM], 1700 * UM, 0.5 * UM)
    jam = explain_jam(push, 0)
    assert jam.obstacles == ("probe 0", "probe 1")
    np.testing.assert_array_equal(jam.pose, simulate(push).poses[0])
    # The part jams when the line through both contacts lies in both friction cones, so the
    # friction at which that begins is the angle between the line and the normals.
    line = jam.points[1] - jam.points[0]
    line /= np.hypot(*line)
    angles = [np.arccos(abs(normal @ line)) for normal in jam.normals]
    assert jam.closing_angle == pytest.approx(max(angles), abs=2e-3)
    assert jam.closing_angle == pytest.approx(np.arctan(0.33), abs=2e-3)
    assert "18.26 deg" in jam.message
    assert f"{np.degrees(jam.closing_angle):.2f} deg" in jam.message
    # Both tips push into the part, from both sides.
    inward = np.einsum("ck,ck->c", jam.normals, jam.pose[:2] - jam.points)
    assert np.all(inward > 0)


def test_part_pressed_flat_against_a_wall_needs_no_friction_to_jam() -> None:
    wall = Fixture(
        (np.array([[-2000, -900], [-418.5, -900], [-418.5, 900], [-2000, 900]]) * UM,), 0.2
    )
    push = Push.straight(
        vertices=rectangle(),
        poses=np.array([[0.0, 0.0, np.pi / 2]]),
        tips=np.array([[[HALF_SHORT, 0.0]]]),
        travel=np.array([[[-50 * UM, 0.0]]]),
        friction=np.array([0.33]),
        support=Film.ratio(RHO),
        fixture=wall,
        step=1 * UM,
    )
    jam = explain_jam(push, 0)
    assert set(jam.obstacles) == {"probe 0", "fixture 0"}
    assert jam.closing_share == pytest.approx(0.0, abs=1e-6)


def test_only_a_jam_is_explained() -> None:
    with pytest.raises(ValueError, match="COMPLETED; must be a jam"):
        explain_jam(two_sided([930 * UM], 100 * UM, 1 * UM), 0)
