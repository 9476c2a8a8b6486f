"""The campaign in its quick form, and that it would notice."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.live.conductor import Phase
from reports.live.campaign import FAULTY, one_run, page
from reports.live.judging import Result, moved, outside, worst
from reports.live.killing import KILLED, killed_run
from tests.nightly import at_night

GOOD = Result(
    seed=0, outcome="done", why="", in_goal=True, moved_unpushed_um=0.0, outside_um=0.0, landed=False,
    stuck=False, moves=4, replays=True, lifted=True, fault="", first_ms=400.0, later_ms={"5": 98, "60": 1},
)  # fmt: skip
BOX = {"x_um": [0.0, 10.0], "y_um": [0.0, 10.0], "theta_deg": [80.0, 100.0]}


@at_night
def test_runs_within_and_at_a_corner_of_the_box_succeed() -> None:
    for seed in (100, 101):
        found = one_run(seed)
        assert found.succeeded, found
        assert not found.unsound, found


@at_night
def test_an_effect_that_the_task_does_not_know_is_not_called_a_success() -> None:
    """In a flow of 40 um/s the part is never at rest."""
    found = one_run(102, effects={"film_flow": {"x_um_s": 40.0}})
    assert not found.succeeded
    assert found.moves == 0


@at_night
@pytest.mark.skipif(not hasattr(os, "fork"), reason="copies of the process carry the program")
def test_a_killed_program_is_followed_by_one_that_makes_no_unpromised_move() -> None:
    for seed in (KILLED + 1, KILLED + 2):
        found = killed_run(seed)
        assert found.outcome in ("done", "refused")
        assert not found.unsound, found


def test_every_broken_promise_is_one() -> None:
    assert GOOD.succeeded
    assert not GOOD.unsound
    for wrong in (
        replace(GOOD, in_goal=False), replace(GOOD, moved_unpushed_um=0.6), replace(GOOD, outside_um=0.1),
        replace(GOOD, landed=True), replace(GOOD, replays=False), replace(GOOD, lifted=False),
    ):  # fmt: skip
        assert wrong.unsound
    assert not replace(GOOD, outcome="refused").unsound
    assert not replace(GOOD, fault="kicked_at_s = 3.0", moved_unpushed_um=40.0).unsound
    assert replace(GOOD, fault="short_um = 3.0", moved_unpushed_um=40.0).unsound


def test_what_moved_and_what_lay_outside_is_measured() -> None:
    rest, gone = np.array([5.0, 5.0, np.pi / 2]), np.array([5.0, 13.0, np.pi / 2])
    seen = [(Phase.RAISING, rest), (Phase.SEEING, gone)]
    assert moved(seen) == 8.0
    assert worst(seen, [{"expect": BOX}]) == 1.0  # of 3 um, the plant may be soft by 2
    assert outside(gone, BOX) == 3.0
    assert moved([(Phase.PUSHING, rest), (Phase.RAISING, gone)]) == 0.0


def test_the_page_tells_what_failed(tmp_path: Path) -> None:
    lost = replace(GOOD, seed=FAULTY, outcome="fault", fault="lost_from_s = 3.0")
    text = page([GOOD, replace(GOOD, seed=7, outcome="refused", why="not seen"), lost])
    assert "| done, and the part in the goal | 1 |" in text
    assert "- seed 7: refused: not seen" in text
    assert "5 ms (median), 60 ms (99 %), 60 ms (longest); 98.99 % within 50 ms" in text
    assert "| `lost_from_s` | 1 | 0 | 0 | 1 | 0 |" in text
