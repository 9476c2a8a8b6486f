"""Runs that refute a certificate lie within the bounds of the task, up to the rounding of doubles."""

from __future__ import annotations

from dataclasses import fields, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from meso_robust.checker.document import Certificate, WitnessDocument
from meso_robust.checker.inputs import given
from meso_robust.checker.refusal import Refused
from meso_robust.checker.replay import _Run
from meso_robust.checker.witness import check_witness
from meso_robust.laboratory.draws import Draws, draw
from meso_robust.primitives.setup import setup_of
from tests.conftest import paper_task
from tests.laboratory.test_box import real_task

MOVES, RUNS = 4, 200  # half of them at corners
TASK = paper_task()
DRAWS = draw(setup_of(TASK), MOVES, RUNS, np.random.default_rng(3))


def witness(draws: Draws, row: int) -> Certificate:
    """What a certificate would state of one of the runs."""
    values = {field.name: getattr(draws, field.name) for field in fields(draws)}
    run = {name: value[row] for name, value in values.items() if value is not None}

    def told(values: Any) -> Any:
        if np.ndim(values) == 0:
            return float(values).hex()
        return tuple(told(value) for value in values)

    stated = WitnessDocument(
        outcome="jam",
        move=MOVES,
        start=told(run["start"]),
        friction=told(run["friction"]),
        film_ratio_m2=told(run["film_ratio"]),
        misalignment_rad=told(run["misalignment"]),
        sensing=told(run["sensing"]),
        dual_probe=told(run["dual"]),
        single_probe=told(run["single"]),
    )
    return cast("Certificate", SimpleNamespace(witness=stated, policy=range(MOVES)))


def test_every_run_that_is_drawn_can_be_a_witness() -> None:
    for row in range(RUNS):
        check_witness(witness(DRAWS, row), given(TASK))


@pytest.mark.parametrize("name", ["start", "sensing", "dual", "friction"])
def test_a_run_beyond_a_bound_by_a_billionth_is_none(name: str) -> None:
    last = RUNS - 1
    value = np.array(getattr(DRAWS, name))
    value[last] *= 1.0 + 1e-9
    with pytest.raises(Refused, match="witness"):
        check_witness(witness(replace(DRAWS, **{name: value}), last), given(TASK))


@pytest.mark.parametrize("schema", [1, 2])
def test_a_number_for_all_tips_is_that_of_no_tip_with_a_friction_of_its_own(schema: int) -> None:
    """What is proved with it would be proved of another run."""
    task = TASK if schema == 1 else real_task()
    of = given(task)
    run = _Run.of(check_witness(witness(DRAWS, 1), of), of)
    ends = [[float(end) for end in one.friction] for one in (run.given, of)]
    assert (ends[0] == ends[1]) is (schema == 2)
    assert ends[1][0] <= ends[0][0] <= ends[0][1] <= ends[1][1]
