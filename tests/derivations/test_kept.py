"""Kept derivations: taken only where nothing that they follow from has changed."""

from __future__ import annotations

import shutil
from importlib.metadata import version
from pathlib import Path

import pytest

from derivations import _kept, generate
from derivations._derivation import Derivation
from derivations._statement import DerivationError
from tests.nightly import at_night

NAME = "dry_sticking"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of the derivations."""
    shutil.copytree(_kept.FOLDER, tmp_path / "derivations")
    return tmp_path / "derivations"


@pytest.mark.parametrize("changed", [NAME, "mechanics", "_smt", "_statement", "generate"])
def test_a_change_to_what_states_or_proves_changes_the_key(folder: Path, changed: str) -> None:
    before = _kept.key(NAME, folder)
    with (folder / f"{changed}.py").open("a") as file:
        file.write("# another\n")
    assert _kept.key(NAME, folder) != before


def test_a_change_to_a_file_that_it_does_not_use_does_not(folder: Path) -> None:
    before = _kept.key(NAME, folder)
    (folder / "final_pose.py").write_text("another = 1\n")
    assert _kept.key(NAME, folder) == before
    (folder / "symmetries.py").write_text("another = 1\n")
    assert _kept.key(NAME, folder) == before


def test_imports_of_imports_count(folder: Path) -> None:
    before = _kept.key("contact_forces", folder)
    with (folder / "one_point_sticking.py").open("a") as file:  # through drag_tensor
        file.write("# another\n")
    assert _kept.key("contact_forces", folder) != before


@pytest.mark.parametrize("package", ["sympy", "z3-solver", "mpmath"])
def test_another_version_of_a_prover_changes_the_key(
    monkeypatch: pytest.MonkeyPatch, package: str
) -> None:
    before = _kept.key(NAME)
    monkeypatch.setattr(_kept, "version", lambda of: "0" if of == package else version(of))
    assert _kept.key(NAME) != before


@at_night
def test_what_was_kept_comes_back_and_gives_the_same_code(tmp_path: Path) -> None:
    derived = generate.derive_one(NAME)
    assert _kept.load(NAME, tmp_path) is None
    _kept.keep(derived, _kept.key(NAME), tmp_path)
    found = _kept.load(NAME, tmp_path)
    assert found is not None
    assert found.claims == derived.claims
    assert generate.code((found,)) == generate.code((derived,))
    assert [path.name for path in tmp_path.iterdir()] == [f"{NAME}.proof"]


def test_one_of_another_state_or_cut_short_is_not_taken(tmp_path: Path) -> None:
    derived = generate.derive_one(NAME)
    _kept.keep(derived, "0" * 64, tmp_path)
    assert _kept.load(NAME, tmp_path) is None
    _kept.keep(derived, _kept.key(NAME), tmp_path)
    whole = (tmp_path / f"{NAME}.proof").read_bytes()
    (tmp_path / f"{NAME}.proof").write_bytes(whole[:-100])
    assert _kept.load(NAME, tmp_path) is None


def test_only_what_changed_is_derived_again(
    monkeypatch: pytest.MonkeyPatch, derived: tuple[Derivation, ...]
) -> None:
    asked: list[str] = []
    load = _kept.load
    monkeypatch.setattr(_kept, "load", lambda name: None if name == NAME else load(name))

    def derive(names: list[str]) -> tuple[object, ...]:
        asked.extend(names)
        return tuple(map(generate.derive_one, names))

    monkeypatch.setattr(generate, "_on_all_cores", derive)
    assert [d.name for d in generate.derive_all()] == [d.name for d in derived]
    assert asked == [NAME]


def test_a_step_that_does_not_hold_keeps_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    kept: list[str] = []
    monkeypatch.setattr(_kept, "load", lambda _: None)
    monkeypatch.setattr(_kept, "keep", lambda derivation, _: kept.append(derivation.name))

    def fail(_: object) -> tuple[object, ...]:
        raise DerivationError("a step")

    monkeypatch.setattr(generate, "_on_all_cores", fail)
    with pytest.raises(DerivationError):
        generate.derive_all()
    assert kept == []
