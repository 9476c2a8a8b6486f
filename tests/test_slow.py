"""The table of slow tests names what exists, and a change of code brings its slow tests back."""

from __future__ import annotations

import json

import pytest

from tests.slow import MOST, ONE_IN, ROOT, SLOW, changed, is_slow, last_commit


def test_every_path_of_the_table_exists() -> None:
    for test, code in SLOW.items():
        file, _, name = test.partition("::")
        for path in (file, *code):
            assert (ROOT / path).exists(), path
        if name:
            assert f"def {name}(" in (ROOT / file).read_text(encoding="utf-8"), test


def test_slow_tests_run_where_their_code_has_changed() -> None:
    test = "tests/derivations/test_derive.py"

    assert is_slow(test, ())
    assert is_slow(test, ("meso_robust/task.py", "derivations_of_mine.md"))
    assert not is_slow(test, ("derivations/t2_motion.py",))
    assert not is_slow(test, (test,))
    assert not is_slow("tests/planning/test_compose.py", ())


def test_a_single_test_may_be_slow() -> None:
    test = "tests/planning/test_headings.py::test_the_sweep_tells_what_one_start_needs"

    assert is_slow(test, ())
    assert not is_slow(test, ("meso_robust/planning/compose.py",))
    assert not is_slow(test, ("tests/planning/test_headings.py",))
    assert not is_slow("tests/planning/test_headings.py", ())
    assert not is_slow(
        "tests/planning/test_headings.py::test_a_plan_keeps_to_the_stated_headings", ()
    )


def test_every_slow_test_has_its_turn() -> None:
    """Otherwise CI would never run it until its code changes."""
    for test in SLOW:
        turns = [not is_slow(test, (), str(turn)) for turn in range(400)]
        assert 0.5 < ONE_IN * sum(turns) / len(turns) < 2.0, test


def test_where_much_has_changed_some_are_drawn() -> None:
    """A change of the whole package would take half an hour; nights run all."""
    everything = (
        "meso_robust/checker/tilt.py",
        "meso_robust/motion/tube.py",
        "tests/conftest_of_mine.py",
    )
    lines = [
        one
        for one, code in SLOW.items()
        if "meso_robust/checker" in code or "meso_robust/motion" in code
    ]
    assert not any(is_slow(test, everything) for test in lines)
    if len(lines) <= MOST:
        assert not any(is_slow(test, everything, "a") for test in lines)
    all_code = tuple(f"{path}/x.py" for code in SLOW.values() for path in code)
    run = [sum(not is_slow(test, all_code, str(turn)) for test in SLOW) for turn in range(100)]
    assert 0.8 * MOST < sum(run) / len(run) < 1.2 * MOST


def test_a_file_and_its_tests_have_one_turn() -> None:
    for file in ("tests/derivations/test_derive.py", "tests/reproduction/test_table.py"):
        for turn in map(str, range(40)):
            assert is_slow(file, (), turn) == is_slow(f"{file}::test_anything", (), turn)


def test_nothing_waits_where_what_all_rests_on_has_changed() -> None:
    assert is_slow("tests/derivations/test_derive.py", ("README.md",))
    assert not is_slow("tests/derivations/test_derive.py", ("requirements.lock",))


def test_without_git_everything_counts_as_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GIT_DIR", "/nowhere")
    assert (changed(recent=True), last_commit()) == ((), "")


def test_no_quick_room_is_in_the_table() -> None:
    """Of the proof, its checker and both engines some tests are run with every change, whatever it is."""
    for room in ("bounds", "checker", "motion", "primitives", "quality", "simulator", "diagnosis"):
        assert not is_slow(f"tests/{room}/test_anything.py", ())


def test_no_planted_break_is_noticed_by_a_slow_test_only() -> None:
    results = json.loads((ROOT / "reports/planted_breaks/noticed.json").read_text(encoding="utf-8"))

    assert [r["noticed_by"] for r in results.values() if is_slow(r["noticed_by"], ())] == []
