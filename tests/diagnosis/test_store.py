"""What is kept on disk, and what is never taken up."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.diagnosis.store import Store

Array = npt.NDArray[np.float64]


class Maker:
    """Makes arrays, and counts how often."""

    def __init__(self) -> None:
        self.made = 0

    def __call__(self) -> Mapping[str, Array]:
        self.made += 1
        return {"rows": np.array([1.0, np.nan, self.made]), "more": np.zeros((2, 0))}


def test_what_was_made_is_not_made_again(tmp_path: Path) -> None:
    make = Maker()
    store = Store(tmp_path / "new" / "folder", "one")
    first = store.kept("nulls", make)
    again = Store(store.folder, "one").kept("nulls", make)
    assert make.made == 1
    assert set(again) == {"rows", "more"}
    np.testing.assert_array_equal(again["rows"], first["rows"])
    np.testing.assert_array_equal(again["more"], first["more"])


def test_results_of_another_diagnosis_or_name_are_not_taken_up(tmp_path: Path) -> None:
    make = Maker()
    for identity, name in (("one", "nulls"), ("two", "nulls"), ("one", "fits"), ("one", "nulls")):
        Store(tmp_path, identity).kept(name, make)
    assert make.made == 3


@pytest.mark.parametrize("rest", [0, 40, -1])
def test_a_broken_file_is_made_again(tmp_path: Path, rest: int) -> None:
    make, store = Maker(), Store(tmp_path, "one")
    store.kept("nulls", make)
    (file,) = tmp_path.iterdir()
    file.write_bytes(file.read_bytes()[:rest])
    assert store.kept("nulls", make)["rows"][2] == 2.0
    assert store.kept("nulls", make)["rows"][2] == 2.0
    assert make.made == 2


def test_an_interrupted_step_leaves_nothing(tmp_path: Path) -> None:
    def interrupted() -> Mapping[str, Array]:
        raise KeyboardInterrupt

    store = Store(tmp_path / "state", "one")
    with pytest.raises(KeyboardInterrupt):
        store.kept("nulls", interrupted)
    assert not list(tmp_path.iterdir())
    store.kept("nulls", Maker())
    assert [one.suffixes for one in (tmp_path / "state").iterdir()] == [[".npz"]]


def test_without_a_folder_nothing_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    make, store = Maker(), Store(None, "one")
    store.kept("nulls", make)
    store.kept("nulls", make)
    store.clear()
    assert make.made == 2
    assert not list(tmp_path.iterdir())


def test_cleared_is_gone(tmp_path: Path) -> None:
    store = Store(tmp_path / "state", "one")
    store.kept("nulls", Maker())
    store.clear()
    assert not list(tmp_path.iterdir())
    store.clear()


@pytest.mark.parametrize("there", [True, False])
def test_what_is_made_ahead_is_there_once_when_it_is_asked_for(tmp_path: Path, there: bool) -> None:
    makers = {"a": Maker(), "b": Maker()}

    def fails() -> Mapping[str, Array]:
        raise ValueError("its search leaves what can be simulated")

    store = Store(tmp_path if there else None, "one")
    store.ahead({**makers, "c": fails})
    assert [make.made for make in makers.values()] == [1, 1]
    for name, make in makers.items():
        assert store.kept(name, fails)["rows"][2] == make.made == 1.0
    assert store.ready == {}
    with pytest.raises(ValueError, match="its search leaves"):
        store.kept("c", fails)
    # asked for again it is made again, unless it is on disk
    assert store.kept("a", makers["a"])["rows"][2] == (1.0 if there else 2.0)
