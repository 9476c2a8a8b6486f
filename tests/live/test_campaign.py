"""The campaign in its quick form, and that it would notice."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from meso_robust.live.conductor import Phase
from reports.live.campaign import Result, _moved, _outside, _worst, one_run, page

GOOD = Result(
    seed=0, outcome="done", why="", in_goal=True, moved_unpushed_um=0.0, outside_um=0.0, landed=False,
    stuck=False, moves=4, frames=100, quick=99, median_ms=5.0, longest_ms=60.0,
)  # fmt: skip
BOX = {"x_um": [0.0, 10.0], "y_um": [0.0, 10.0], "theta_deg": [80.0, 100.0]}


def test_runs_within_and_at_a_corner_of_the_box_succeed() -> None:
    for seed in (100, 101):
        found = one_run(seed)
        assert found.succeeded, found
        assert not found.unsound, found


def test_an_effect_that_the_task_does_not_know_is_not_called_a_success() -> None:
    """In a flow of 40 um/s the part is never at rest."""
    found = one_run(102, effects={"film_flow": {"x_um_s": 40.0}})
    assert not found.succeeded
    assert found.moves == 0


def test_every_broken_promise_is_one() -> None:
    assert GOOD.succeeded
    assert not GOOD.unsound
    for wrong in (
        replace(GOOD, in_goal=False), replace(GOOD, moved_unpushed_um=0.5), replace(GOOD, outside_um=0.1),
        replace(GOOD, landed=True),
    ):  # fmt: skip
        assert wrong.unsound
    assert not replace(GOOD, outcome="refused").unsound


def test_what_moved_and_what_lay_outside_is_measured() -> None:
    rest, gone = np.array([5.0, 5.0, np.pi / 2]), np.array([5.0, 13.0, np.pi / 2])
    seen = [(Phase.RAISING, rest, 0.0), (Phase.SEEING, gone, 0.0)]
    assert _moved(seen) == 8.0
    assert _worst(seen, [{"expect": BOX}]) == 1.0  # of 3 um, the plant may be soft by 2
    assert _outside(gone, BOX) == 3.0
    assert _moved([(Phase.PUSHING, rest, 0.0), (Phase.RAISING, gone, 0.0)]) == 0.0


def test_the_page_tells_what_failed(tmp_path: Path) -> None:
    text = page([GOOD, replace(GOOD, seed=7, outcome="refused", why="not seen")])
    assert "| done, and the part in the goal | 1 |" in text
    assert "- seed 7: refused: not seen" in text
