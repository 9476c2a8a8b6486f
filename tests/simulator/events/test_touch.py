"""Runs in which a tip touches a hair before another contact starts to stick."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.simulation import player_of
from meso_robust.laboratory.witness import read_witness
from meso_robust.planning.reading import read_plan
from meso_robust.primitives.setup import setup_of
from meso_robust.simulator import Outcome
from meso_robust.task import load_task

HERE = Path(__file__).parent
ENGINES: tuple[Engine, ...] = ("events", "stepper")


@pytest.mark.parametrize("run", [1, 2, 3])
def test_a_touch_just_before_another_event_is_not_passed(run: int) -> None:
    """The part was taken 0.1 nm into the tip, which then was no contact any more: a false jam."""
    task = load_task(HERE / "touch_task.toml")
    plan = read_plan(HERE / "touch_plan.json", task)
    player = player_of(plan, setup_of(task))
    assert isinstance(player, Feedback)
    row = read_witness(HERE / f"touch_{run}.json", task, plan, player).row[None]
    events, steps = (replace(player, engine=engine).run(row) for engine in ENGINES)
    assert events.outcomes[0] == steps.outcomes[0] == Outcome.COMPLETED
    assert np.abs(events.final[0] - steps.final[0])[:2].max() < 1e-7  # the stepper's own error
