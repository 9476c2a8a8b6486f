"""Runs that refute a certificate lie within the bounds of the task, up to the rounding of doubles."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from flint import arb

import meso_robust
from meso_robust.checker.document import Certificate, WitnessDocument
from meso_robust.checker.inputs import given
from meso_robust.checker.outline import outline
from meso_robust.checker.refusal import Refused
from meso_robust.checker.run import Run, number_of
from meso_robust.checker.scene import Scene
from meso_robust.checker.witness import check_witness
from meso_robust.laboratory.draws import Draws, draw
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.witness import more_of
from meso_robust.primitives.setup import setup_of
from meso_robust.task import load_task
from tests.conftest import paper_task
from tests.laboratory.paper import paper_player
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


def real_witness(**changes: str) -> Certificate:
    """Of a task of schema 2, with all that a witness can state."""
    task = real_task()
    setup = setup_of(task)
    draws = draw(setup, MOVES, 2, np.random.default_rng(3))
    player = Feedback(rules=paper_player().rules, setup=setup, engine="events")
    found = witness(draws, 1)
    more = more_of(player, player.rows_of(draws)[1]) | changes
    stated = cast("WitnessDocument", found.witness).model_copy(update={"more": more})
    return cast("Certificate", SimpleNamespace(witness=stated, policy=range(MOVES)))


def test_all_that_a_run_is_made_of_is_known_and_within_its_bounds() -> None:
    found = check_witness(real_witness(), given(real_task()))
    assert len({name.split()[0] for name in found.more}) == 8


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("dtp_top radius_m", 12.6e-6), ("stp radius_m", 2.4e-6), ("tip_spacing_m", 1.1e-6),
        ("edge 2 out_m", 2.1e-6), ("edge 4 turned_rad", -0.0036), ("drag_centre y_m", 21e-6),
        ("drag_anisotropy along", 0.026), ("drag_anisotropy of_stage", 1.1),
        ("move 3 direction_rad", -0.0018), ("move 1 scale", 0.0051),
        ("move 2 wander 1 x_m", 1.1e-6), ("move 4 friction 2 dtp_top", 0.37),
    ],
)  # fmt: skip
def test_more_of_a_run_beyond_its_bounds_is_no_witness(name: str, value: float) -> None:
    assert name in real_witness().witness.more  # type: ignore[union-attr]
    with pytest.raises(Refused, match=name.split()[0]):
        check_witness(real_witness(**{name: value.hex()}), given(real_task()))


@pytest.mark.parametrize(
    "name",
    ["move 5 scale", "move " + "9" * 5000 + " scale", "tip temperature", "move 1 friction 1 thumb"],
    ids=["a move too many", "a long number", "no quantity", "no tip"],
)
def test_a_quantity_that_no_run_has_is_no_witness(name: str) -> None:
    with pytest.raises(Refused, match=r"witness\.more"):
        check_witness(real_witness(**{name: (0.0).hex()}), given(real_task()))


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("name", ["hexagon", "l_shape", "paper"])
def test_an_edge_that_is_held_has_the_number_that_the_simulator_gives_it(
    name: str, *, mirrored: bool
) -> None:
    task = load_task(Path(meso_robust.__file__).parent / "tasks" / f"{name}.toml")
    corners = np.array([[x.mid, y.mid] for x, y in setup_of(task).outline.corners])
    own = outline(task.part).mirrored() if mirrored else outline(task.part)
    for theta in np.linspace(-4.0, 4.0, 41):
        pushed = own.facing(arb(float(theta)))
        scene = SimpleNamespace(frame=SimpleNamespace(mirrored=mirrored), outline=own)
        for edge in (pushed, own.opposite(pushed)[0]):
            first = number_of(cast("Scene", scene), edge) - 1
            p, q = corners[first], corners[(first + 1) % len(corners)]
            along = q - p
            assert (p[0] * along[1] - p[1] * along[0]) / np.hypot(*along) == pytest.approx(
                float(edge.d1)
            )
            heading = np.arctan2(along[1], along[0])
            heading = np.pi - heading if mirrored else heading  # it is run the other way
            assert math.remainder(heading + float(edge.turn), 2.0 * math.pi) == pytest.approx(
                0.0, abs=1e-9
            )


@pytest.mark.parametrize("schema", [1, 2])
def test_a_number_for_all_tips_is_that_of_no_tip_with_a_friction_of_its_own(schema: int) -> None:
    """What is proved with it would be proved of another run."""
    task = TASK if schema == 1 else real_task()
    of = given(task)
    run = Run.of(check_witness(witness(DRAWS, 1), of), of)
    ends = [[float(end) for end in one.friction] for one in (run.given, of)]
    assert (ends[0] == ends[1]) is (schema == 2)
    assert ends[1][0] <= ends[0][0] <= ends[0][1] <= ends[1][1]
