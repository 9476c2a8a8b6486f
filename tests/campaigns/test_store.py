"""The store: what it refuses, and that it keeps every bit."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from meso_robust.campaigns.encoding import digest, first_difference, result_text
from meso_robust.campaigns.kind import Failure, Result
from meso_robust.campaigns.store import NAME, Session, Store
from meso_robust.errors import InputError
from tests.campaigns.faulty import campaign

CODE = "c" * 64
VALUES = campaign().values


def opened(folder: Path) -> Store:
    return Store(folder / NAME, VALUES, CODE)


def result(number: float) -> Result:
    failure = Failure(what="it broke", detail="a 'quoted' <line>", files={"a.txt": "ä\n"})
    return Result(runs=3, failed=1, failures=(failure,), values={"sum": number, "none": None})


def filled(folder: Path, chunks: int = 5) -> None:
    store = opened(folder)
    for chunk in range(chunks):
        store.add("work", chunk, result_text(result(0.1 * chunk)), 1.5, "here")
    store.close()


def test_results_come_back_to_the_last_bit_and_in_order(tmp_path: Path) -> None:
    store = opened(tmp_path)
    for chunk in (3, 0, 10, 2):
        assert store.add("work", chunk, result_text(result(chunk / 3)), 1.5, "here")
    store.close()

    again = opened(tmp_path)

    assert [chunk for chunk, _ in again.results("work")] == [0, 2, 3, 10]
    assert all(one == result(chunk / 3) for chunk, one in again.results("work"))
    assert again.done("work") == {0, 2, 3, 10}
    assert again.done("other") == set()
    assert again.seconds("work") == 6.0


def test_a_chunk_is_counted_once_and_must_not_change(tmp_path: Path) -> None:
    filled(tmp_path)
    store = opened(tmp_path)
    assert not store.add("work", 2, result_text(result(0.2)), 9.0, "elsewhere")
    assert len(list(store.results("work"))) == 5
    with pytest.raises(RuntimeError, match="chunk 2: done twice with different results"):
        store.add("work", 2, result_text(result(0.3)), 9.0, "elsewhere")


def test_another_campaign_is_refused_with_the_key_that_differs(tmp_path: Path) -> None:
    filled(tmp_path)
    other = campaign(13).values
    with pytest.raises(InputError, match=r"another campaign.*parts\.0\.asked\.executions"):
        Store(tmp_path / NAME, other, CODE)


def test_other_code_is_refused(tmp_path: Path) -> None:
    filled(tmp_path)
    with pytest.raises(InputError, match="started by different code"):
        Store(tmp_path / NAME, VALUES, "d" * 64)


def test_another_version_of_the_store_is_refused(tmp_path: Path) -> None:
    filled(tmp_path)
    with sqlite3.connect(tmp_path / NAME) as db:
        db.execute("PRAGMA user_version = 2")
    db.close()
    with pytest.raises(InputError, match="store of version 2; this program writes version 1"):
        opened(tmp_path)


def test_another_file_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / NAME
    with sqlite3.connect(path) as db:
        db.execute("CREATE TABLE mine (value TEXT)")
    db.close()
    before = path.read_bytes()
    with pytest.raises(InputError, match="is not a campaign store"):
        opened(tmp_path)
    assert path.read_bytes() == before
    path.write_text("not a database " * 100, encoding="utf-8")
    with pytest.raises(InputError, match="is damaged or not a campaign store"):
        opened(tmp_path)


def test_a_damaged_page_is_noticed(tmp_path: Path) -> None:
    filled(tmp_path, 200)
    path = tmp_path / NAME
    content = bytearray(path.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 300] = bytes(300)
    path.write_bytes(content)
    with pytest.raises(InputError, match="damaged"):
        _read_all(tmp_path)


def _read_all(folder: Path) -> None:
    list(opened(folder).results("work"))


def test_a_cut_file_is_noticed(tmp_path: Path) -> None:
    filled(tmp_path, 200)
    path = tmp_path / NAME
    path.write_bytes(path.read_bytes()[:-5000])
    with pytest.raises(InputError, match="damaged"):
        opened(tmp_path)


def test_a_changed_result_is_noticed(tmp_path: Path) -> None:
    filled(tmp_path)
    with sqlite3.connect(tmp_path / NAME) as db:
        db.execute("UPDATE result SET result = replace(result, '\"failed\":1', '\"failed\":0')")
    db.close()
    store = opened(tmp_path)
    with pytest.raises(InputError, match="chunk 0: damaged, its digest differs"):
        list(store.results("work"))


def test_a_store_in_use_is_refused(tmp_path: Path) -> None:
    store = opened(tmp_path)
    store.begin(Session(began="now", ended=None, crew="1", machine="this", runs=0, seconds=0.0))
    with pytest.raises(InputError, match="in use by another campaign"):
        opened(tmp_path)
    store.close()
    opened(tmp_path).close()


def test_a_folder_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be opened"):
        Store(tmp_path / "no" / "such" / NAME, VALUES, CODE)


FULL = """
import resource, sys
from pathlib import Path
from tests.campaigns.test_store import filled, opened, result
from meso_robust.campaigns.encoding import result_text
folder = Path(sys.argv[1])
store = opened(folder)
# no file of this process may become longer: what a full disk does
resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))
for chunk in range(5000):
    store.add("work", chunk, result_text(result(0.1 * chunk)), 1.5, "here")
    print(chunk, flush=True)
"""


def test_a_full_disk_is_told_and_loses_nothing(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FULL, str(tmp_path)],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])},
        check=False,
    )
    said = [int(line) for line in done.stdout.split()]
    assert 10 < len(said) < 5000
    assert "InputError" in done.stderr
    assert "nothing that was done is lost" in done.stderr
    store = opened(tmp_path)
    kept = dict(store.results("work"))
    assert set(said) <= set(kept)
    assert all(kept[chunk] == result(0.1 * chunk) for chunk in kept)
    # and with space again it goes on
    assert store.add("work", 5000, result_text(result(1.0)), 1.5, "here")


def test_the_first_difference_is_named() -> None:
    one = {"a": 1, "parts": [{"x": {"y": 2, "z": [1, 2]}}]}
    assert first_difference(one, one) == ""
    assert first_difference(one, one | {"a": 2}) == "a"
    assert (
        first_difference(one, {"a": 1, "parts": [{"x": {"y": 2, "z": [1, 3]}}]}) == "parts.0.x.z.1"
    )
    assert first_difference(one, {"a": 1, "parts": []}) == "parts"


def test_digest_is_sha256() -> None:
    # of "abc", FIPS 180-2
    assert digest("abc").startswith("ba7816bf8f01cfea414140de5dae2223b00361a3")
