"""A goal that no last push can keep to is told before any rotation is looked for."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from meso_robust.planning import compose
from meso_robust.planning.last_push import TOO_MUCH, leaves_goal, narrowed_first, share_taken
from meso_robust.primitives.frame import HEADINGS, Heading
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task

TASKS = sorted((Path(__file__).parents[2] / "meso_robust" / "tasks").glob("*.toml"))
HALF: dict[Heading, float] = {"-x": 808.0, "+x": 808.0, "-y": 418.5, "+y": 418.5}
"""Of the part in the direction of the push at the goal, um."""


def paper(tolerance_um: float) -> Task:
    values = Task.paper().to_dict()
    values["goal"]["position_tolerance_um"] = tolerance_um
    return Task.from_dict(values)


@pytest.mark.parametrize("heading", HEADINGS)
def test_across_a_push_the_part_is_as_unknown_as_before_and_turns_about_its_edge(
    heading: Heading,
) -> None:
    """By hand: 5 um of either probe, and 0.25 deg that the line of the tips may be off."""
    across = 5.0 + HALF[heading] * math.sin(math.radians(0.25))
    assert share_taken(setup_of(paper(20.0)), heading) == pytest.approx(across / 20.0, rel=0.01)


def test_where_every_last_push_leaves_the_goal_no_rotation_is_tried(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def tried(*args: object, **more: object) -> None:
        raise AssertionError("a rotation was looked for")

    monkeypatch.setattr(compose, "rotate_and_finish", tried)
    assert compose.robust_at(paper(6.0), 1.0) is None
    with pytest.raises(AssertionError, match="looked for"):
        compose.robust_at(paper(76.0), 1.0)


def test_what_the_last_push_hangs_on_most_is_narrowed_first() -> None:
    """Of the probe's 5 um nearly all goes; of those of the senses only what the line's turn leaves."""
    stated = list(setup_of(paper(76.0)).uncertainty.stated)
    assert narrowed_first(paper(6.0), 0.1, HEADINGS)[0] == "probe_position" != stated[0]
    assert narrowed_first(paper(76.0), 0.1, HEADINGS) == stated


@pytest.mark.parametrize(
    "path", [one for one in TASKS if "model" not in one.stem], ids=lambda one: one.stem
)
def test_shipped_goals_leave_room(path: Path) -> None:
    setup = setup_of(Task.load(path))
    assert not leaves_goal(setup, HEADINGS)
    assert min(share_taken(setup, heading) for heading in HEADINGS) < TOO_MUCH / 1.5
