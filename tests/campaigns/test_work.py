"""The executor: every chunk once, whoever dies on the way."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.campaigns.document import Campaign
from meso_robust.campaigns.executor import Processes
from meso_robust.campaigns.provenance import code
from meso_robust.campaigns.store import NAME, Store
from meso_robust.campaigns.work import ATTEMPTS, Step, carry_out, missing
from meso_robust.errors import InputError
from tests.campaigns.faults import SIZE, do
from tests.campaigns.faulty import campaign
from tests.nightly import at_night

Sums = dict[int, str]


def worked(folder: Path, asked: Campaign, workers: int = 2) -> tuple[list[Step], Store]:
    store = Store(folder / NAME, asked.values, code())
    return list(carry_out(asked, store, Processes(workers), do)), store


def sums(store: Store) -> Sums:
    return {chunk: result.values["sum"] for chunk, result in store.results("work")}


def expected(chunks: Sequence[int]) -> Sums:
    """Straight from the seed."""
    return {k: float(np.random.default_rng([7, k]).random(SIZE).sum()).hex() for k in chunks}


def test_every_chunk_is_done_once_in_any_number_of_processes(tmp_path: Path) -> None:
    for workers in (1, 3):
        folder = tmp_path / str(workers)
        folder.mkdir()
        steps, store = worked(folder, campaign(), workers)
        assert Counter(step.chunk for step in steps) == Counter(range(12))
        assert sums(store) == expected(range(12))
        assert list(sums(store)) == list(range(12))
        assert not store.troubles()
        (session,) = store.sessions()
        assert session.runs == 12 * SIZE
        assert session.ended is not None
        store.close()


@pytest.mark.parametrize("fault", ["crash", "raise"])
def test_a_chunk_that_goes_wrong_once_is_done_again(tmp_path: Path, fault: str) -> None:
    marks = tmp_path / "marks"
    marks.mkdir()
    steps, store = worked(
        tmp_path, campaign(given={"folder": str(marks), "times": 1, fault: [4, 9]})
    )
    assert sums(store) == expected(range(12))
    assert not any(step.given_up for step in steps)
    assert {t.chunk for t in store.troubles()} >= {4, 9}
    assert not any(t.given_up for t in store.troubles())


@pytest.mark.parametrize("fault", ["crash", "raise"])
def test_a_poisoned_chunk_is_given_up_and_reported_and_the_rest_is_done(
    tmp_path: Path, fault: str
) -> None:
    steps, store = worked(tmp_path, campaign(given={fault: [0, 7]}))
    assert sums(store) == expected([k for k in range(12) if k not in (0, 7)])
    assert sorted(step.chunk for step in steps if step.given_up) == [0, 7]
    given_up = [t for t in store.troubles() if t.given_up]
    assert sorted(t.chunk for t in given_up) == [0, 7]
    assert all(t.attempt == ATTEMPTS for t in given_up)
    words = "died" if fault == "crash" else "no such luck"
    assert all(words in t.what for t in given_up)
    assert [ticket.chunk for ticket in missing(campaign(given={fault: [0, 7]}), store)] == [0, 7]


@at_night
def test_a_chunk_that_hangs_is_ended(tmp_path: Path) -> None:
    marks = tmp_path / "marks"
    marks.mkdir()
    # the limit leaves a fresh process time to import what it needs
    steps, store = worked(
        tmp_path, campaign(6, {"hang": [2], "folder": str(marks), "times": 1}, 8.0)
    )
    assert sums(store) == expected(range(6))
    (trouble,) = store.troubles()
    assert trouble.chunk == 2
    assert "chunk_limit_s" in trouble.what
    assert not any(step.given_up for step in steps)


def test_a_worker_with_other_code_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="runs different code"):
        worked(tmp_path, campaign(2, {"code": "0" * 64}), 1)


def test_what_was_given_up_is_tried_again_by_the_next_session(tmp_path: Path) -> None:
    marks = tmp_path / "marks"
    marks.mkdir()
    asked = campaign(4, {"folder": str(marks), "times": ATTEMPTS, "raise": [1]})
    steps, store = worked(tmp_path, asked, 1)
    assert [step.chunk for step in steps if step.given_up] == [1]
    again = list(carry_out(asked, store, Processes(1), do))
    assert [(step.chunk, step.given_up) for step in again] == [(1, False)]
    assert sums(store) == expected(range(4))


def started(folder: Path, chunks: int) -> subprocess.Popen[str]:
    code = "from tests.campaigns.faulty import main; main()"
    command = [sys.executable, "-c", code, str(folder), str(chunks)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def workers_of(pid: int) -> list[int]:
    """Processes below a process, spawned workers and the like."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == pid:
            found.append(int(folder.name))
    return found


def killed(folder: Path, chunks: int, rng: random.Random) -> tuple[list[int], bool]:
    """Go on until killed some time after the first chunk, or done; the chunks it said it kept."""
    with started(folder, chunks) as process:
        assert process.stdout is not None
        first = process.stdout.readline()
        try:
            out, errors = process.communicate(timeout=0.3 * rng.random())
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            out, errors = process.communicate()
    assert process.returncode in (0, -signal.SIGKILL), errors
    # a line cut short was not said
    said = [int(line) for line in (first + out).split("\n")[:-1]]
    return said, process.returncode == 0


@at_night
def test_killed_at_random_times_nothing_is_lost_and_nothing_counted_twice(tmp_path: Path) -> None:
    rng, chunks, kills = random.Random(11), 80, 0
    said: Counter[int] = Counter()
    for seconds in (0.3, 0.7):  # before it has done anything
        with started(tmp_path, chunks) as early:
            time.sleep(seconds)
            early.kill()
            said.update(int(line) for line in early.communicate()[0].split("\n")[:-1])
    done = False
    while not done:
        some, done = killed(tmp_path, chunks, rng)
        said.update(some)
        kills += not done
    store = Store(tmp_path / NAME, campaign(chunks, {"seconds": 0.02}).values, code())
    assert kills >= 2
    assert sums(store) == expected(range(chunks))
    assert not store.troubles()
    # what was said to be kept was on the disk, so it was never done again
    assert max(said.values()) == 1
    assert len(store.sessions()) <= kills + 3
    assert sum(one.runs for one in store.sessions()) <= chunks * SIZE


def test_workers_end_with_a_campaign_that_is_killed(tmp_path: Path) -> None:
    with started(tmp_path, 400) as process:
        assert process.stdout is not None
        process.stdout.readline()
        children = workers_of(process.pid)
        process.kill()
    assert len(children) >= 2
    until = time.monotonic() + 10.0
    while any(_lives(pid) for pid in children) and time.monotonic() < until:
        time.sleep(0.05)
    assert not any(_lives(pid) for pid in children)


def _lives(pid: int) -> bool:
    try:
        state: Any = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
        os.kill(pid, 0)
    except (OSError, IndexError):
        return False
    return state != "Z"
