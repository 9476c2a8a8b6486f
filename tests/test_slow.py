"""The table of slow tests names what exists, and a change of code brings its slow tests back."""

from __future__ import annotations

from tests.slow import ROOT, SLOW, is_slow


def test_every_path_of_the_table_exists() -> None:
    for test, code in SLOW.items():
        for path in (test, *code):
            assert (ROOT / path).exists(), path


def test_slow_tests_run_where_their_code_has_changed() -> None:
    test = "tests/derivations/test_derive.py"

    assert is_slow(test, ())
    assert is_slow(test, ("meso_robust/task.py", "derivations_of_mine.md"))
    assert not is_slow(test, ("derivations/t2_motion.py",))
    assert not is_slow(test, (test,))
    assert not is_slow("tests/planning/test_compose.py", ())


def test_no_quick_room_is_in_the_table() -> None:
    """The proof, its checker and both engines are tested with every change."""
    for room in ("bounds", "checker", "motion", "primitives", "quality", "simulator", "diagnosis"):
        assert not is_slow(f"tests/{room}/test_anything.py", ())
