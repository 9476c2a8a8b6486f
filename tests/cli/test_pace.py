"""What the progress of a campaign says."""

from __future__ import annotations

import pytest

from meso_robust.cli.console import Pace


def test_rate_and_time_left_are_those_of_the_steps_that_were_timed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = [100.0]
    monkeypatch.setattr("meso_robust.cli.console.time.monotonic", lambda: clock[0])
    pace = Pace()
    clock[0] = 40.0  # the workers start and compile for a minute: no part of the rate
    assert pace.told((0, 11), None) == "0 of 11 chunks, begins"
    clock[0] = 100.0
    assert pace.told((1, 11), (50, 0, "executions")) == "1 of 11 chunks, 0 failed"
    clock[0] = 102.0
    assert (
        pace.told((2, 11), (50, 3, "executions"))
        == "2 of 11 chunks, 25 executions/s, 18 s left, 3 failed"
    )
    clock[0] = 300.0
    assert (
        pace.told((3, 11), (50, 0, "executions"))
        == "3 of 11 chunks, 0.5 executions/s, 13 min left, 3 failed"
    )
