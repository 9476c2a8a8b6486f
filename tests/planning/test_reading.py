"""Plans read back: the same rules, and a refusal that says what is wrong."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.planning.document import plan_document
from meso_robust.planning.reading import read_plan
from meso_robust.planning.rules import rules_of
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.move import MoveRule, Point, from_part, in_world
from tests.conftest import paper_task

Values = dict[str, Any]
TASK = paper_task()
PUSH = MoveRule(
    step=1,
    primitive="y_translation",
    action="tilt",
    side=-1,
    dual=Point(x=from_part(443.9), y=from_part(-626.8)),
    dual_end=from_part(261.7),
)
TURN = MoveRule(
    step=2,
    primitive="rotation",
    action="rotate",
    side=1,
    dual=Point(x=from_part(444.6), y=in_world(925.3)),
    dual_end=from_part(-900.0),
    single=Point(x=from_part(-438.0), y=in_world(-270.7)),
    frame=Frame(heading="+y", mirrored=True),
)


def values() -> Values:
    """A plan of two moves as JSON values."""
    sensed = [np.array([2060.4e-6, -9.2e-6, 1.5]), np.array([1900e-6, 0.0, 1.6])]
    plan = plan_document(TASK, [PUSH, TURN], sensed, [None, None])
    loaded: Values = json.loads(plan.model_dump_json(by_alias=True))
    return loaded


def written(folder: Path, plan: Any) -> Path:
    path = folder / "plan.json"
    path.write_text(json.dumps(plan), encoding="utf-8")
    return path


def test_rules_survive_writing_and_reading(tmp_path: Path) -> None:
    assert rules_of(read_plan(written(tmp_path, values()), TASK)) == (PUSH, TURN)


def test_open_loop_plan_has_moves_and_no_rules(tmp_path: Path) -> None:
    plan = read_plan(written(tmp_path, {**values(), "policy": []}), TASK)

    assert rules_of(plan) == ()
    assert [probe.passive for probe in plan.moves[1].probes] == [False, False, True]
    # 2060.4 + 443.9, -9.2 - 626.8 + 290
    assert plan.moves[0].probes[0].start_um == pytest.approx((2504.3, -346.0))


def edit(*keys: str | int, to: Any) -> Callable[[Values], None]:
    """Put a value at a place of the plan."""

    def change(plan: Any) -> None:
        for key in keys[:-1]:
            plan = plan[key]
        plan[keys[-1]] = to

    return change


def drop(*keys: str | int) -> Callable[[Values], None]:
    def change(plan: Any) -> None:
        for key in keys[:-1]:
            plan = plan[key]
        del plan[keys[-1]]

    return change


PROBE = ("moves", 1, "probes", 1)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (edit("speed", to=1), ("speed", "unknown")),
        (edit("moves", 0, "note", to=""), ("moves.0.note", "unknown")),
        (drop("schema"), ("schema", "missing")),
        (edit("schema", to="meso-robust/plan/2"), ("schema", "plan/2", "plan/1")),
        (drop("policy", 1, "side"), ("policy.1.side", "missing")),
        (edit("policy", 0, "dual_x", "offset_um", to="443.9"), ("dual_x.offset_um", "'443.9'")),
        (edit("policy", 0, "dual_x", "relative_to", to="moon"), ("relative_to", "'moon'")),
        (edit("policy", 0, "step", to=1.5), ("policy.0.step", "1.5", "integer")),
        (edit("policy", 0, "side", to=2), ("policy.0.side", "2", "[-1, 1]")),
        (edit("policy", 1, "single_x", to=None), ("policy.1.single_x", "both")),
        (
            edit("moves", 0, "travel_um", 1, to=float("nan")),
            ("moves.0.travel_um.1", "nan", "finite"),
        ),
        (edit("moves", 0, "speed_um_s", to=float("inf")), ("speed_um_s", "inf", "finite")),
        (edit("moves", 0, "speed_um_s", to=0.0), ("moves.0.speed_um_s", "0.0", "positive")),
        (edit(*PROBE, "start_um", to=[0, -2e6]), ("start_um.1", "-2000000.0", "1e+06")),
        (edit(*PROBE, "name", to="stp"), ("moves.1.probes", "stp", "its own name")),
        (edit(*PROBE, "name", to=""), ("moves.1.probes", "its own name")),
        (edit("moves", 1, "probes", to=[]), ("moves.1.probes", "0 probes", "1 to 6")),
        (edit("moves", 0, "travel_um", to=[1.0]), ("moves.0.travel_um", "missing")),
        (drop("moves", 1), ("moves", "1 move;", "2")),
        (
            edit("moves", 0, "expect", to={"x_um": [1, 0], "y_um": [0, 0], "theta_deg": [0, 0]}),
            ("moves.0.expect.x_um", "[1.0, 0.0]", "lower end"),
        ),
        (edit("task_hash", to="0" * 64), ("task_hash", "0" * 64, "another task", TASK.hash)),
    ],
)
def test_refusal_names_file_key_value_and_rule(
    tmp_path: Path, change: Callable[[Values], None], words: tuple[str, ...]
) -> None:
    plan = values()
    change(plan)
    path = written(tmp_path, plan)

    with pytest.raises(InputError) as refused:
        read_plan(path, TASK)
    message = str(refused.value)
    assert message.startswith(str(path))
    assert "\n" not in message
    assert all(word in message for word in words), message


def test_move_that_moves_nothing_is_refused(tmp_path: Path) -> None:
    plan = values()
    for probe in plan["moves"][0]["probes"]:
        probe["passive"] = True

    with pytest.raises(InputError, match=r"moves\.0\.probes: all are passive"):
        read_plan(written(tmp_path, plan), TASK)


def test_empty_plan_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"moves = \[\]"):
        read_plan(written(tmp_path, {**values(), "policy": [], "moves": []}), TASK)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"{", "not a JSON file"),
        (b'{"task": "\xff"}', "not a JSON file"),
        (b'{"task": "a", "task": "b"}', "task is given twice"),
        (b"[" * 100_000, "not a JSON file"),
        (b"[]", "plan"),
        (b"3", "plan"),
    ],
)
def test_what_is_no_plan_at_all_is_refused(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "plan.json"
    path.write_bytes(content)

    with pytest.raises(InputError, match=words):
        read_plan(path, TASK)


def test_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no\.json: cannot be read"):
        read_plan(tmp_path / "no.json", TASK)


def test_a_plan_that_pushes_where_the_task_has_no_probe_is_refused(tmp_path: Path) -> None:
    """The first move pushes along -x, the second one along +y."""
    path = tmp_path / "plan.json"
    for headings, wrong in ((["-x", "+x"], "policy.1.heading = '+y'"), (["-x", "+y"], "")):
        task = paper_task(probe__headings=headings)
        path.write_text(json.dumps({**values(), "task_hash": task.hash}), encoding="utf-8")
        if wrong:
            with pytest.raises(InputError, match=re.escape(wrong)):
                read_plan(path, task)
        else:
            assert len(read_plan(path, task).policy) == 2
