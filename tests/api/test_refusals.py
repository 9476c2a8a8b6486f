"""What is wrong with what a call was given is said as the command line says it."""

from __future__ import annotations

import inspect
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import meso_robust as mr
from meso_robust.planning.reading import read_plan
from meso_robust.policy.controller import PlanController
from meso_robust.recordings import write_set
from meso_robust.tasks import PAPER
from tests.recordings.planted import clean, planted, poses

PLAN = Path(__file__).parents[2] / "reports" / "paper_task" / "plan.json"


def test_a_task_comes_from_a_file_by_any_path_from_a_dictionary_and_back() -> None:
    task = mr.Task.load(str(PAPER))
    assert task == mr.Task.load(PAPER) == mr.Task.paper()
    values = tomllib.loads(PAPER.read_text(encoding="utf-8"))
    assert task.to_dict() == values
    assert mr.Task.from_dict(values).hash == task.hash


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mr.Task.load("no such.toml"), "no such.toml: cannot be read"),
        (lambda: mr.Task.load(4), "path = 4: must be a text or a path"),  # type: ignore[arg-type]
        (lambda: mr.plan("no such.toml"), "no such.toml: cannot be read"),
        (lambda: mr.plan(mr.Task.paper(), samples=0), "samples = 0: must be at least 1"),
        (lambda: mr.plan(PAPER, samples=1_000_001), "samples = 1000001: must be at most 1,000,000"),
        (lambda: mr.plan(PAPER, samples="20"), "samples = '20': must be a whole number"),  # type: ignore[arg-type]
        (lambda: mr.plan(type("Task", (), {})()), "must be a Task or a text or a path"),
        (lambda: mr.certify(PAPER, PLAN, samples=10**7), "samples = 10000000: must be at most"),
        (lambda: mr.simulate(PAPER, PLAN, samples=10**7), "samples = 10000000: must be at most"),
        (lambda: mr.camera_of(latency_ms=-500.0), "latency_ms = -500.0: must be from 0 to 1000"),
        (lambda: mr.camera_of(latency_ms=1001.0), "latency_ms = 1001.0: must be from 0 to 1000"),
        (lambda: mr.track("x", start=",,0"), "start = ',,0': must be 3 numbers"),  # type: ignore[arg-type]
        (lambda: mr.track("x", start=(0.0, 1.0)), "start = (0.0, 1.0): must be 3 numbers"),  # type: ignore[arg-type]
        (lambda: mr.track("x", probes={"p": (1.0, "a")}), "probes['p'] = (1.0, 'a'): must be 2"),  # type: ignore[dict-item]
        (lambda: mr.campaign("x", workers=1025), "workers = 1025: must be at most 1,024"),
        (lambda: mr.plan(mr.Task.paper(), seed=-1), "seed = -1: must be at least 0"),
        (lambda: mr.plan(PAPER, model="m", maps=True), "model=: cannot be combined with widest="),
        (lambda: mr.plan(PAPER, model="no such model"), "no such model"),
        (lambda: mr.certify(PAPER, "no such plan"), "no such plan: cannot be read"),
        (lambda: mr.check("no such certificate", PAPER), "no such certificate: cannot be read"),
        (lambda: mr.simulate(PAPER, PLAN, samples=0), "samples = 0"),
        (lambda: mr.simulate(PAPER, PLAN, witness="no such"), "no such: cannot be read"),
        (lambda: mr.camera_of(dropout=2.0), "dropout"),
        (lambda: mr.identify("no such set"), "no such set"),
        (lambda: mr.identify(clean(), starts=0), "starts = 0"),
        (lambda: mr.identify(clean(), confidence=1.0), "confidence = 1.0"),
        (
            lambda: mr.identify(clean(), objective="other"),  # type: ignore[arg-type]
            "objective = other: must be likelihood or printed",
        ),
        (
            lambda: mr.identify(clean(), objective="printed", design=1),
            "design=: needs the information of a likelihood; leave objective= out",
        ),
        (lambda: mr.diagnose("no such set"), "no such set"),
        (lambda: mr.read_recordings("no such set"), "no such set: does not exist"),
        (lambda: mr.track([]), "videos: none are given"),
        (lambda: mr.track("no such video", tip_radius_um=1.0), "part"),
        (lambda: mr.track("x", most_lost=2.0), "most_lost = 2.0"),
        (lambda: mr.campaign("no such.toml"), "no such.toml: cannot be read"),
        (
            lambda: mr.campaign("x", workers=1, scheduler="y"),
            "workers=, scheduler=: mutually exclusive",
        ),
        (lambda: mr.drive(PAPER, "no such plan"), "no such plan: cannot be read"),
        (lambda: mr.standard_tests("no such.toml"), "no such.toml: cannot be read"),
    ],
)
def test_what_is_wrong_is_refused(call: Any, message: str) -> None:
    with pytest.raises(mr.InputError) as caught:
        call()
    assert message in str(caught.value)
    assert isinstance(caught.value, ValueError)


CALLS = (
    mr.plan, mr.certify, mr.check, mr.simulate, mr.camera_of, mr.drive, mr.track, mr.read_recordings,
    mr.identify, mr.standard_tests, mr.diagnose, mr.campaign, mr.reproduce,
)  # fmt: skip
ARGUMENTS = [(call, name) for call in CALLS for name in inspect.signature(call).parameters]


@pytest.mark.parametrize(("call", "name"), ARGUMENTS, ids=lambda one: getattr(one, "__name__", one))
@pytest.mark.parametrize("bad", [object(), 2.5j, b"many"], ids=["object", "complex", "bytes"])
def test_an_argument_of_a_wrong_type_is_named(call: Any, name: str, bad: object) -> None:
    needed = {"task": PAPER, "plan": PLAN, "certificate": PLAN.with_name("certificate.json"), "recordings": clean(), "videos": "x", "path": "x", "campaign": "x"}  # fmt: skip
    known = {one: needed[one] for one in inspect.signature(call).parameters if one in needed}
    if call is mr.track:
        known = {"videos": "x"}
    with pytest.raises(mr.InputError) as caught:
        call(**{**known, name: bad})
    assert str(caught.value).startswith(f"{name} = ")
    assert ": must be " in str(caught.value)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mr.plan("x", samples="many"), "samples = 'many': must be a whole number"),  # type: ignore[arg-type]
        (lambda: mr.plan(PAPER, seed=True), "seed = True: must be a whole number"),
        (lambda: mr.plan(PAPER, widest="no"), "widest = 'no': must be True or False"),  # type: ignore[arg-type]
        (lambda: mr.identify(clean(), confidence="0.9"), "confidence = '0.9': must be a number"),  # type: ignore[arg-type]
        (lambda: mr.campaign("x", workers=2.0), "workers = 2.0: must be a whole number or None"),  # type: ignore[arg-type]
        (lambda: mr.track("x", length_um=1.0), "length_um=, width_um=: one is missing"),
        (lambda: mr.track("x"), "give one of task= TASK.toml, set_file= SET.toml"),
        (lambda: mr.standard_tests(PAPER).save(__file__), f"folder= {__file__}"),
        (lambda: mr.plan(PAPER.with_name("hexagon.toml"), policy=True), "policy="),
    ],
)
def test_a_call_speaks_of_its_arguments(call: Any, message: str) -> None:
    with pytest.raises(mr.InputError) as caught:
        call()
    assert message in str(caught.value)
    assert "--" not in str(caught.value)


def test_a_plan_for_another_task_is_refused_by_value_as_by_name() -> None:
    task = mr.Task.paper()
    plan = read_plan(PLAN, task)
    other = mr.Task.from_dict(task.to_dict() | {"name": "another"})
    with pytest.raises(mr.InputError, match="the plan was made for another task"):
        mr.certify(other, plan)
    first = plan.policy[0].model_copy(update={"action": "rotate", "side": 3})
    bad = plan.model_copy(update={"policy": (first, *plan.policy[1:])})
    with pytest.raises(mr.InputError, match="must be one of"):
        mr.certify(task, bad)


def test_a_task_that_no_primitive_can_handle_has_no_plan() -> None:
    values = mr.Task.paper().to_dict()
    values["start"]["theta_deg"] = 45.0
    with pytest.raises(mr.NotApplicableError):
        mr.plan(mr.Task.from_dict(values), samples=3)


def test_results_never_go_over_what_they_come_from(tmp_path: Path) -> None:
    write_set(tmp_path / "recordings", clean())
    before = {path.name: path.read_bytes() for path in (tmp_path / "recordings").iterdir()}
    tests = mr.standard_tests(tmp_path / "recordings")
    with pytest.raises(mr.InputError, match="is the folder of the recordings"):
        tests.save(tmp_path / "recordings")
    repaired = mr.read_recordings(tmp_path / "recordings", repair=True)
    with pytest.raises(mr.InputError, match="must stay as they were made"):
        repaired.save(tmp_path)
    assert {path.name: path.read_bytes() for path in (tmp_path / "recordings").iterdir()} == before


def test_bad_recordings_are_a_value_and_no_ground_for_a_fit() -> None:
    jumping = poses()
    jumping[np.arange(len(jumping)) % 4 > 0] = 0.0
    with pytest.raises(mr.InputError, match="meso-robust recordings"):
        mr.identify(planted(poses=jumping))


def test_a_pose_may_come_from_numpy() -> None:
    driver = mr.drive(PAPER, PLAN)
    seen: list[Any] = [np.float32(2060.4), np.float64(-9.2), np.int64(90)]
    assert driver.answer(*map(float, seen)) == driver.answer(*seen)
    assert driver.answer(*seen)["primitive"] == "y_translation"


def test_all_starts_are_looked_for_before_the_first_pose(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine too, or a pose would be refused that is answered on an idle one."""
    waited: list[float | None] = []

    def settle(_: PlanController, seconds: float | None = None) -> None:
        waited.append(seconds)

    monkeypatch.setattr(PlanController, "settle", settle)
    mr.drive(PAPER, PLAN)
    (seconds,) = waited
    assert seconds is not None
    assert seconds >= 60.0  # twice what the plan for real probes takes


def test_a_misspelt_argument_is_told_with_the_call_it_was_given_to() -> None:
    with pytest.raises(TypeError, match=r"^plan\(\) got an unexpected keyword argument 'sample'"):
        mr.plan(PAPER, sample=3)  # type: ignore[call-arg]
