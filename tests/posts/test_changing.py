"""Runs whose film changes on the way."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.running import run as run_plainly
from meso_robust.planning.reading import read_plan
from meso_robust.planning.rules import rules_of
from meso_robust.primitives.setup import setup_of
from meso_robust.task import load_task
from reports.posts.__main__ import LEGS, at_tips, varying
from reports.posts.changing import Changing, run

TASK = Path("reports/real_paper/at_38_um/task.toml")
SETUP = setup_of(load_task(TASK))
RULES = rules_of(read_plan(TASK.with_name("plan.json"), load_task(TASK)))[:3]


@pytest.fixture(scope="module")
def draws() -> Changing:
    rng = np.random.default_rng(0)
    drawn = varying(draw(SETUP, len(RULES), 40, rng), SETUP, rng)
    return Changing.of(at_tips(drawn), SETUP, LEGS, rng)


def alike(draws: Changing) -> Changing:
    """The same with the film of the first stretch all the way."""
    lay = np.zeros((len(draws.start), 3))
    lay[:, :2] = draws.lays[:, 0, 0]
    return replace(
        draws,
        film_ratio=draws.ratios[:, 0, 0],
        lay=lay,
        ratios=np.broadcast_to(draws.ratios[:, :1, :1], draws.ratios.shape).copy(),
        lays=np.broadcast_to(draws.lays[:, :1, :1], draws.lays.shape).copy(),
    )


def test_one_film_all_the_way_ends_as_in_one_go(draws: Changing) -> None:
    """Cutting a move into stretches changes nothing, tips that touch between two of them included."""
    same = alike(draws)
    cut, whole = run(RULES, SETUP, same), run_plainly(RULES, SETUP, same, engine="events")
    assert whole.completed.all()
    assert cut.completed.all()
    assert np.abs(cut.final - whole.final).max() < 1e-9


def test_a_film_that_changes_ends_elsewhere(draws: Changing) -> None:
    """Not only from move to move: here each move has the film of its first stretch."""
    shape = draws.ratios.shape
    each = replace(
        draws,
        ratios=np.broadcast_to(draws.ratios[..., :1], shape).copy(),
        lays=np.broadcast_to(draws.lays[..., :1, :], (*shape, 2)).copy(),
    )
    off = run(RULES, SETUP, draws).final - run(RULES, SETUP, each).final
    assert np.median(np.abs(off[:, 0])) > 1e-6


def test_each_stretch_keeps_within_what_is_promised(draws: Changing) -> None:
    u = SETUP.uncertainty
    for leg in (0, LEGS - 1):
        tensor = draws.film(SETUP, 2, leg).drag
        lay = np.hypot(0.5 * (tensor[:, 0, 0] - tensor[:, 1, 1]), tensor[:, 0, 1])
        assert lay.max() < u.drag_anisotropy.hi * (1 + 1e-9)
        assert lay.max() > 0.9 * u.drag_anisotropy.hi
    assert u.film_ratio.lo <= draws.ratios.min() < draws.ratios.max() <= u.film_ratio.hi
    assert (np.ptp(draws.ratios, axis=2) > 0.0).mean() > 0.9
