"""What no plan for a task gets past, and what is said to give one."""

from __future__ import annotations

from typing import Any

import pytest

from meso_robust.errors import NotApplicableError
from meso_robust.planning.compose import compose, robust_at
from meso_robust.task import Task, parse_task
from tests.nightly import at_night

SHORT: dict[str, Any] = {
    "schema": "meso-robust/task/2",
    "name": "short",
    "part": {"length_um": 1200.0, "width_um": 700.0},
    "start": {"x_um": 4000.0, "y_um": 0.0, "theta_deg": 93.0},
    "goal": {
        "x_um": 0.0,
        "y_um": 0.0,
        "theta_deg": 90.0,
        "position_tolerance_um": 300.0,
        "orientation_tolerance_deg": 4.0,
    },
    "probe": {"speed_um_s": 75.0, "tip_spacing_um": 440.0, "tip_radius_um": [10.0, 12.0]},
    "plan": {"least_y_translations": 0},
    "uncertainty": {
        "sensed_position_um": 2.0,
        "sensed_orientation_deg": 0.15,
        "probe_position_um": 2.0,
        "friction": [0.0, 0.05],
        "film_ratio_percent": 4.0,
        "tip_misalignment_deg": [-0.1, 0.1],
        "film_ratio_um2": 190000.0,
    },
}
"""Three degrees are straightened by a tip that holds, which one of little friction does not."""
SQUARE: dict[str, Any] = {
    **SHORT,
    "part": {"length_um": 1000.0, "width_um": 700.0},
    "start": {"x_um": 3000.0, "y_um": 0.0, "theta_deg": 90.0},
    "goal": {**SHORT["goal"], "theta_deg": 180.0, "position_tolerance_um": 90.0},
    "probe": {**SHORT["probe"], "tip_spacing_um": 434.0, "tip_radius_um": [5.0, 6.0], "headings": ["-x"]},
    "uncertainty": {**SHORT["uncertainty"], "friction": [0.32, 0.34], "film_ratio_um2": 124000.0},
}  # fmt: skip
"""Nearly as wide as long: tips that cannot jam stand nearly as far apart as its edges reach."""


def asked(values: dict[str, Any], **changes: dict[str, Any]) -> Task:
    changed = {key: {**values[key], **of} for key, of in changes.items()}
    return parse_task({**values, **changed}, "task")


@pytest.mark.parametrize(
    ("values", "stuck", "helps", "change"),
    [
        (SHORT, "no push straightens", r"friction of 0\.1 ", {"uncertainty": {"friction": [0.097, 0.103]}}),
        (SQUARE, "no turn of the part", r"tips of 1 um ", {"probe": {"tip_radius_um": [1.0, 1.0]}}),
        (
            SQUARE | {"part": {"length_um": 1000.0, "width_um": 1000.0}},
            "no turn of the part",
            "a part 500 um wide",
            {"part": {"width_um": 500.0}, "uncertainty": {"film_ratio_um2": 77500.0}},
        ),
    ],
)  # fmt: skip
def test_what_is_said_to_give_a_plan_gives_one(
    values: dict[str, Any], stuck: str, helps: str, change: dict[str, Any]
) -> None:
    with pytest.raises(
        NotApplicableError,
        match=f"{stuck}.*with uncertainties as small, one was found with .*{helps}",
    ):
        compose(asked(values), 30.0)
    assert robust_at(asked(values, **change), 0.03) is not None


def test_nobody_waits_for_what_nobody_asked() -> None:
    with pytest.raises(NotApplicableError, match=r"further from the goal, or widen the goal$"):
        compose(asked(SHORT))


def test_what_is_in_the_way_is_told_of_the_stated_probes() -> None:
    """With a probe on the side that cannot straighten it the part is not straightened."""
    aside = asked(
        SHORT,
        start={"x_um": 0.0, "y_um": 4000.0},
        probe={"headings": ["-y"]},
        uncertainty={"friction": [0.07, 0.09]},
    )
    with pytest.raises(NotApplicableError, match="no push straightens"):
        compose(aside, 30.0)


def test_a_cap_on_forces_is_one_of_the_things_that_may_be_in_the_way() -> None:
    """Where without it a plan is found for smaller uncertainties only, no cap is high enough."""
    capped = asked(
        {**SHORT, "film": {"drag_un_s_per_um": 1.0}},
        probe={"max_force_un": 0.5},
        uncertainty={
            "friction": [0.09, 0.11],
            "sensed_orientation_deg": 4.0,
            "sensed_position_um": 60.0,
            "probe_position_um": 40.0,
        },
    )
    with pytest.raises(NotApplicableError, match="one was found with no cap on forces"):
        compose(capped, 30.0)


@at_night
def test_where_nothing_helps_it_is_said_what_was_tried() -> None:
    wide = asked(
        SQUARE, part={"length_um": 1000.0, "width_um": 860.0}, probe={"tip_spacing_um": 533.0}
    )
    with pytest.raises(NotApplicableError, match=r"no change of .*the tips, friction.* by itself"):
        compose(wide, 30.0)
