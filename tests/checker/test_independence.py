"""The checker shares no code with what it checks."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import BaseModel

import meso_robust.checker
from meso_robust.task import Film, Goal, Part, PolygonPart, Pose, Probe, Slot, Uncertainty
from tests.test_architecture import imported

FOLDER = Path(meso_robust.checker.__file__).parent
ALLOWED = (
    "meso_robust.checker", "meso_robust.task", "meso_robust.errors", "meso_robust.files", "meso_robust.reading", "flint",
    "numpy", "pydantic",
)  # fmt: skip
STANDARD = {
    "__future__", "collections", "dataclasses", "enum", "fractions", "functools", "hashlib", "heapq",
    "itertools", "json", "math", "pathlib", "re", "typing",
}  # fmt: skip


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.py")), ids=lambda path: path.name)
def test_it_imports_nothing_of_the_planner_or_the_search(path: Path) -> None:
    for name in imported(path):
        assert name.startswith(ALLOWED) or name.split(".")[0] in STANDARD, name


def test_the_checker_knows_every_value_of_a_task() -> None:
    """A new one must be given a place in the proof before it is listed here."""
    made = {"size_tolerance_um", "squareness_deg", "corner_radius_um"}
    known: dict[type[BaseModel], set[str]] = {
        Part: {"length_um", "width_um", *made},
        PolygonPart: {"polygon_um", *made},
        Pose: {"x_um", "y_um", "theta_deg"},
        Goal: {"x_um", "y_um", "theta_deg", "position_tolerance_um", "orientation_tolerance_deg"},
        Probe: {
            "tip_spacing_um", "tip_spacing_tolerance_um", "tip_radius_um", "passive_tip_radius_um",
            "max_force_un", "speed_um_s", "headings",
        },
        Film: {"drag_un_s_per_um"},
        Uncertainty: {
            "sensed_position_um", "sensed_orientation_deg", "probe_position_um", "friction",
            "film_ratio_um2", "film_ratio_percent", "tip_misalignment_deg", "friction_common",
            "travel_direction_deg", "travel_scale_percent", "drag_centre_um", "drag_centre_moves",
            "drag_anisotropy_percent", "probe_wander_um",
        },
        Slot: {  # no wall is touched, so the friction there does not matter
            "mouth_x_um", "mouth_y_um", "opens", "width_um", "depth_um", "wall_um", "friction",
        },
    }  # fmt: skip
    for section, names in known.items():
        assert set(section.model_fields) == names
