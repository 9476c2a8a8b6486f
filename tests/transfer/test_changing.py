"""The task as the model says it is: outward, and nothing lost."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, strategies as st

from meso_robust.errors import InputError
from meso_robust.identification.models.model import centroid
from meso_robust.simulator import Effects
from meso_robust.simulator.geometry import outlines
from meso_robust.task import Part, load_task, parse_task
from meso_robust.toml_files import read_toml, toml_of
from meso_robust.transfer.assumption_check import standings
from meso_robust.transfer.changing import Changed, about_middle, changed, check_part
from meso_robust.transfer.promise import _rectangle
from tests.conftest import paper_task
from tests.strategies import REPEATABLE
from tests.transfer.models import budget, model

BUDGET = budget(radius_um=2000.0, seconds=100.0)


def made(*args: object, **rest: object) -> Changed:
    document = model(*args, **rest)
    return changed(paper_task(), document, standings(document, BUDGET))


@REPEATABLE
@given(st.floats(1e3, 1e7), st.floats(0.0, 0.9))
def test_middle_and_percentage_hold_both_ends(high: float, share: float) -> None:
    low = high * (1.0 - share)

    middle, percent = (Fraction(repr(value)) for value in about_middle(low, high))

    assert middle * (1 - percent / 100) <= Fraction(repr(low))
    assert Fraction(repr(high)) <= middle * (1 + percent / 100)
    assert percent / 100 * middle < Fraction((high - low) / 2 + 0.1 + 1e-7 * high)


def test_the_model_s_intervals_replace_the_task_s_ranges() -> None:
    found = made(base={"rho_um2": (360_000.0, 370_000.0), "mu": (0.3123456789, 0.3222222222)})
    u = found.task.uncertainty

    assert u.friction == (0.312345, 0.322223)
    assert u.film_ratio_um2 == 365_000.0
    assert u.film_ratio_percent == pytest.approx(100 * 5 / 365, abs=1e-5)
    assert [one.key for one in found.changes] == [
        "uncertainty.friction",
        "uncertainty.film_ratio_um2",
        "uncertainty.film_ratio_percent",
    ]
    assert found.changes[0].before == "0.3 … 0.36"
    assert (found.task.part, found.task.start, found.task.goal) == (
        paper_task().part,
        paper_task().start,
        paper_task().goal,
    )
    assert not found.wider


def test_a_range_that_is_not_identified_stays_and_the_other_is_replaced() -> None:
    found = made(open_=("mu",))

    assert found.task.uncertainty.friction == (0.3, 0.36)
    assert found.task.uncertainty.film_ratio_um2 == 376_500.0


def test_errors_of_several_effects_add_up() -> None:
    found = made(
        {
            "reference_offset.x_um": (0.0, 3.0),
            "reference_offset.y_um": (-4.0, 0.0),  # with it 5 um off, at most
            "camera_rotation.angle_deg": (-0.1, 0.0),  # 3.4907 um at 2 mm
            "backlash.width_um": (1.0, 5.0),
        }
    )
    u = found.task.uncertainty

    assert u.sensed_position_um == pytest.approx(5.0 + 5.0 + 3.50, abs=0.02)
    assert u.sensed_orientation_deg == pytest.approx(0.3 + 0.1, abs=0.011)
    assert u.probe_position_um == 7.5
    because = {one.key: one.because for one in found.changes}
    assert because["uncertainty.sensed_position_um"] == "reference_offset, camera_rotation"
    assert because["uncertainty.probe_position_um"] == "backlash"


def test_sides_of_the_part_keep_their_interval() -> None:
    """1616 + 2 (2 … 4) and 837 + 2 (-1 … 0.5) um: 1620 … 1624 and 835 … 838, and the larger half."""
    found = made({"part_geometry.x_um": (2.0, 4.0), "part_geometry.y_um": (-1.0, 0.5)})

    assert found.task.part == Part(length_um=1622.0, width_um=836.5, size_tolerance_um=2.0)
    assert not found.wider
    assert found.setup().uncertainty.size.hi == pytest.approx(1e-6)


@pytest.mark.parametrize("form", [0.0, 1.0, 2.0])
def test_edges_of_a_part_out_of_square_lie_within_the_tolerances(form: float) -> None:
    """Measured at the parts that the simulator makes of the task's, longer by an interval as well."""
    ends = {"part_skew.angle_deg": (-0.4, 1.2), "part_geometry.x_um": (2.0, 4.0)}
    after = made(ends, held={"part_skew.form": form}).task
    part = after.part
    assert isinstance(part, Part)
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    stated = 1e-6 * corners * [808.0, 418.5]
    sides = 1e-6 * np.array([part.width_um, part.length_um, part.width_um, part.length_um])
    worst = np.zeros(2)
    for angle, out in itertools.product((-0.4, 0.3, 1.2), (2.0, 4.0)):
        of = {"part_skew": {"angle_deg": angle, "form": form}, "part_geometry": {"x_um": out}}
        found = outlines(stated, Effects(of).table)[0]
        ways = np.roll(found, -1, axis=0) - found
        lengths = np.hypot(*ways.T)
        far = (found[:, 0] * ways[:, 1] - found[:, 1] * ways[:, 0]) / lengths
        turned = np.degrees(np.angle(ways @ [1.0, 1j] * np.array([1.0, -1j, -1.0, 1j])))
        worst = np.maximum(worst, [np.abs(far - 0.5 * sides).max(), np.abs(turned).max()])
    size, square = part.size_tolerance_um, part.squareness_deg
    assert size is not None
    assert square is not None
    assert worst[0] <= 0.5e-6 * size <= worst[0] + 0.4e-6
    assert worst[1] <= square + 1e-9  # of the double that was measured
    assert square == pytest.approx(1.2)
    assert [one.because for one in made(ends).changes if "squareness" in one.key] == [
        "part_geometry, part_skew"
    ]


@pytest.mark.parametrize("form", [3.0, 4.0])
def test_a_part_that_narrows_breaks_a_premise(form: float) -> None:
    """By 1 degree, the centroid of the drawing's rectangle moves by 9 um along it: tan κ a² / (3 b)."""
    corners = 1e-6 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [808.0, 418.5]
    table = Effects({"part_skew": {"angle_deg": 1.0, "form": 3.0}}).table
    moved = centroid(outlines(corners, table)[0])[0]
    assert abs(moved) == pytest.approx(np.tan(np.radians(1.0)) * 808e-6**2 / (3 * 418.5e-6))
    document = model({"part_skew.angle_deg": (0.1, 0.2)}, held={"part_skew.form": form})
    assert standings(document, BUDGET)[-1].word == "breaks a premise"


def test_a_bound_of_the_film_under_a_rectangle_is_not_of_a_part_out_of_square() -> None:
    skew, thick = {"part_skew.angle_deg": (0.1, 0.2)}, {"drag_gradient.x_per_mm": (0.01, 0.02)}
    assert _rectangle(paper_task(), model(skew))
    assert _rectangle(paper_task(), model(thick))
    assert not _rectangle(paper_task(), model({**skew, **thick}))


def test_a_clock_of_another_rate_asks_for_rest() -> None:
    found = standings(model({"clock_rate.percent": (-0.5, 1.9)}), BUDGET)[-1]
    assert found.survives
    assert found.absorbed is not None
    assert found.absorbed.condition.count("for 2 s before") == 1  # 1.9 % of 100 s


def real(effects: dict[str, tuple[float, float]], **rest: object) -> Changed:
    found = made(effects, **rest)
    assert found.task.schema_ == "meso-robust/task/2"
    return found


def test_a_measured_radius_is_that_of_the_recordings_and_its_error() -> None:
    found = real({"tip_radius.excess_um": (-0.456, 0.2)}, probe={"tip_radius_um": 12.5})

    assert found.task.probe.tip_radius_um == (12.04, 12.7)
    assert found.task.probe.passive_tip_radius_um is None
    assert found.task.uncertainty.friction_common is True  # as in schema 1
    assert found.task.tips == "round tips, radius 12.04 to 12.7 um"
    changes = {one.key: one for one in found.changes}
    assert changes["probe.tip_radius_um"].before == "exact"
    assert changes["probe.tip_radius_um"].because == "round tips, tip_radius"
    assert "uncertainty.friction_common" not in changes


def test_recordings_with_round_tips_are_about_round_tips() -> None:
    assert real({}, probe={"tip_radius_um": 12.5}).task.probe.tip_radius_um == (12.5, 12.5)


@pytest.mark.parametrize(
    ("stated", "proved"),
    [(12.5, (12.0, 13.0)), (12.0, (12.0, 13.0)), (13.0, (12.0, 13.0)), (11.9, (11.9, 11.9))],
)
def test_a_radius_that_recordings_restate_does_not_narrow_that_of_the_task(
    stated: float, proved: tuple[float, float]
) -> None:
    values = paper_task().to_dict()
    values["schema"] = "meso-robust/task/2"
    values["probe"] |= {"tip_radius_um": [12.0, 13.0]}
    document = model({}, probe={"tip_radius_um": stated})
    found = changed(parse_task(values, "real"), document, standings(document, BUDGET))
    assert found.task.probe.tip_radius_um == proved


def test_a_task_of_round_tips_keeps_what_it_says_unless_the_model_says_more() -> None:
    """A stated passive tip is larger by the same as the others."""
    values = paper_task().to_dict()
    values["schema"] = "meso-robust/task/2"
    values["probe"] |= {"tip_radius_um": [2.5, 12.5], "passive_tip_radius_um": [1.0, 2.0]}
    task = parse_task(values, "real")
    plain, wider = model({}), model({"tip_radius.excess_um": (0.0, 1.0)})
    probes = [changed(task, one, standings(one, BUDGET)).task.probe for one in (plain, wider)]

    assert (probes[0].tip_radius_um, probes[0].passive_tip_radius_um) == ((2.5, 12.5), (1.0, 2.0))
    assert (probes[1].tip_radius_um, probes[1].passive_tip_radius_um) == ((2.5, 13.5), (1.0, 3.0))


def test_the_film_s_unevenness_is_written_into_the_task() -> None:
    """By hand: hypot(3, 4) = 5; 200 x 0.7 %; and ρ ± 5 % of an anisotropy of 0.7 % more."""
    centre = real({"drag_centre_offset.x_um": (-3.0, 1.0), "drag_centre_offset.y_um": (2.0, 4.0)})
    fraction = {"anisotropic_drag.fraction": (0.002, 0.007)}
    lay = real(fraction, base={"rho_um2": (361_000.0, 399_000.0), "mu": (0.32, 0.34)}).task

    assert centre.task.uncertainty.drag_centre_um == pytest.approx(5.0, abs=0.011)  # outward
    assert lay.uncertainty.drag_anisotropy_percent == pytest.approx(1.4, abs=0.011)
    assert lay.uncertainty.film_ratio_um2 == 380_000.0
    assert 5.735 <= lay.uncertainty.film_ratio_percent <= 5.75
    assert real({"part_anisotropic_drag.fraction": (-0.01, 0.0)}).task.uncertainty == (
        real({"anisotropic_drag.fraction": (0.0, 0.01)}).task.uncertainty
    )


def test_an_edge_of_its_own_friction_gives_each_tip_its_own() -> None:
    """By hand: 0.32 x 0.9 and 0.34 x 1, each tip in between."""
    u = real({"edge_dependent_friction.change": (-0.1, -0.05)}).task.uncertainty

    assert u.friction == pytest.approx((0.288, 0.34), abs=1.1e-6)
    assert u.friction_common is False


def test_a_drift_of_the_probes_bends_and_stretches_their_travel() -> None:
    """By hand: 0.06 and 0.08 um/s are 0.1 of 75 um/s, so 0.0764 deg and 0.1334 %; 10 um in 100 s."""
    u = real(
        {"probe_drift.x_um_s": (0.0, 0.06), "probe_drift.y_um_s": (-0.08, 0.0)}
    ).task.uncertainty

    assert u.travel_direction_deg == (-0.08, 0.08)
    assert u.travel_scale_percent == 0.14
    assert u.probe_position_um == pytest.approx(15.0, abs=0.011)


SCREW = {
    "leadscrew_error.x_sine_um": (0.0, 3.0),
    "leadscrew_error.x_cosine_um": (-4.0, 0.0),
    "leadscrew_error.y_sine_um": (0.0, 0.0),
    "leadscrew_error.y_cosine_um": (1.0, 2.0),
}


@pytest.mark.parametrize(("period", "stray"), [(1000.0, 5.0), (500.0, 6.705), (100.0, 45.806)])
def test_a_screw_out_of_true_lets_a_probe_stray(period: float, stray: float) -> None:
    """By hand: 3 and 4 um are a wave of 5, whose slope g is 2 pi 5 over the period; 100 g / (1 - g) um in 100 um."""
    u = real({**SCREW, "leadscrew_error.period_um": (period, 1.1 * period)}).task.uncertainty

    assert u.probe_position_um == pytest.approx(10.0, abs=0.011)
    assert u.probe_wander_um == pytest.approx(stray, abs=0.011)
    assert (u.probe_wander_um or 0.0) >= stray - 1e-3


@pytest.mark.parametrize(
    ("given", "held", "word"),
    [
        ({"leadscrew_error.period_um": (60.0, 70.0)}, {}, "breaks a premise"),  # a slope of 0.52
        ({"leadscrew_error.period_um": (-50.0, 101.0)}, {}, "breaks a premise"),
        ({}, {}, "not identified"),  # nobody looked for the period
        ({}, {"leadscrew_error.period_um": 500.0}, "not identified"),
    ],
)
def test_a_screw_whose_wave_may_be_steep_or_of_any_period_is_not_absorbed(
    given: dict[str, tuple[float, float]], held: dict[str, float], word: str
) -> None:
    standing = standings(model({**SCREW, **given}, held=held), BUDGET)[-1]

    assert (standing.name, standing.word) == ("leadscrew_error", word)
    assert standing.absorbed is None


@pytest.mark.parametrize("form", [0.0, 1.0, 2.0])
def test_waves_of_angle_and_place_are_errors_of_a_pose(form: float) -> None:
    """By hand: 0.3 and 0.4 deg are 0.5; 3 and 4 um along x and 12 along y are 13 in all."""
    waves = {
        "angle_error.sine_deg": (0.2, 0.3),
        "angle_error.cosine_deg": (-0.4, -0.3),
        "pixel_locking.x_sine_um": (0.0, 3.0),
        "pixel_locking.x_cosine_um": (0.0, 4.0),
        "pixel_locking.y_sine_um": (-12.0, 0.0),
        "pixel_locking.y_cosine_um": (0.0, 0.0),
        "pixel_locking.pitch_um": (40.0, 41.0),
    }
    u = made(waves, held={"angle_error.form": form}).task.uncertainty

    assert u.sensed_orientation_deg == pytest.approx(0.3 + 0.5, abs=0.011)
    assert u.sensed_position_um == pytest.approx(5.0 + 13.0, abs=0.011)


def test_an_interval_counts_as_far_as_it_reaches() -> None:
    """The catalogue's values end at 10 deg: that is no bound of what a laboratory may have."""
    waves = {"angle_error.sine_deg": (9.0, 11.0), "angle_error.cosine_deg": (0.0, 0.0)}
    assert made(waves).task.uncertainty.sensed_orientation_deg == pytest.approx(11.3, abs=0.011)


def test_a_post_becomes_a_wall_as_large_as_it_can_be() -> None:
    post = {
        "unmodelled_wall.radius_um": (10.0, 20.0),
        "unmodelled_wall.x_um": (-500.0, -490.0),
        "unmodelled_wall.y_um": (700.0, 705.0),
    }
    (block,) = made(post).setup().blocks

    assert block.x.lo == pytest.approx(-520e-6, rel=1e-12)
    assert block.x.hi == pytest.approx(-470e-6, rel=1e-12)
    assert block.y.lo == pytest.approx(680e-6, rel=1e-12)
    assert block.y.hi == pytest.approx(725e-6, rel=1e-12)


def test_the_changed_task_is_read_back_from_its_file(tmp_path) -> None:  # type: ignore[no-untyped-def]
    task = made({"part_geometry.x_um": (2.0, 4.1)}).task
    path = tmp_path / "task.toml"
    path.write_text(toml_of(task), encoding="utf-8")

    assert load_task(path) == task
    assert load_task(path).hash == task.hash != paper_task().hash
    assert parse_task(read_toml(path, ""), "").hash == task.hash


@pytest.mark.parametrize(
    "part",
    [
        {"length_um": 1616.0, "width_um": 838.0},
        {"polygon_um": [[-808.0, -418.5], [808.0, -418.5], [808.0, 400.0], [-808.0, 418.5]]},
        {"polygon_um": [[0.0, 0.0], [1616.0, 0.0], [1616.0, 837.0], [0.0, 837.0]]},
    ],
)
def test_a_model_of_another_part_is_refused(part: dict[str, object]) -> None:
    with pytest.raises(InputError, match=r"here: key part.*1616 x 837 um"):
        check_part(paper_task(), model(part=part), "here")


def test_the_same_part_by_its_corners_is_taken() -> None:
    corners = [[-808.0, -418.5], [808.0, -418.5], [808.0, 418.5], [-808.0, 418.5]]

    check_part(paper_task(), model(part={"polygon_um": corners}), "here")


def test_friction_is_rounded_outward_where_the_product_of_doubles_rounds_inward() -> None:
    low = 0.30001099999999997
    assert low * 1e6 == 300011.0  # although low is less
    found = made(base={"rho_um2": (372_000.0, 381_000.0), "mu": (low, 0.34)})
    assert found.task.uncertainty.friction[0] == 0.30001
