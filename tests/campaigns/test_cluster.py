"""A Dask cluster as the crew: the same chunks, the same totals, whoever is killed."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from meso_robust.campaigns import cluster
from meso_robust.campaigns.cluster import Cluster
from meso_robust.campaigns.provenance import code
from meso_robust.campaigns.store import NAME, Store
from meso_robust.campaigns.work import carry_out
from meso_robust.errors import InputError
from tests.campaigns.faults import do
from tests.campaigns.faulty import campaign
from tests.campaigns.test_work import expected, sums

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.filterwarnings("ignore")  # of Dask's own


def dask(*words: str) -> subprocess.Popen[bytes]:
    """A part of a cluster as a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "distributed.cli." + words[0], *words[1:], "--no-dashboard"],
        env=os.environ
        | {"PYTHONPATH": str(ROOT), "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "5s"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def scheduler(port: int) -> subprocess.Popen[bytes]:
    return dask("dask_scheduler", "--host", "127.0.0.1", "--port", str(port))


def worker(address: str) -> subprocess.Popen[bytes]:
    return dask("dask_worker", address, "--nthreads", "1", "--no-nanny")


def end(process: subprocess.Popen[bytes]) -> None:
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextmanager
def running(workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler on this machine and its workers: address and processes, the scheduler first."""
    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    processes = [scheduler(port), *(worker(address) for _ in range(workers))]
    try:
        yield address, processes
    finally:
        for process in processes:
            if process.poll() is None:
                end(process)


def test_a_killed_worker_changes_nothing(tmp_path: Path) -> None:
    asked = campaign(60, {"seconds": 0.05})
    store = Store(tmp_path / NAME, asked.values, code())
    with running(3) as (address, processes):
        crew = Cluster(address)
        until = time.monotonic() + 60.0
        while crew.size < 3 and time.monotonic() < until:
            time.sleep(0.1)
        assert crew.size == 3
        kept = 0
        for step in carry_out(asked, store, crew, do):
            kept += not step.given_up
            if kept == 15:
                end(processes[1])
    assert kept == 60
    assert sums(store) == expected(range(60))
    workers = store._db.execute("SELECT COUNT(DISTINCT worker) FROM result").fetchone()[0]
    assert workers == 3


def test_a_scheduler_that_is_gone_is_told_and_what_was_done_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = campaign(200, {"seconds": 0.05})
    store = Store(tmp_path / NAME, asked.values, code())
    with running(1) as (address, processes):
        steps = carry_out(asked, store, Cluster(address), do)
        monkeypatch.setattr(cluster, "PATIENCE", 1.0)
        monkeypatch.setattr(cluster, "CONNECT", 2.0)
        for _ in range(5):
            next(steps)
        end(processes[0])
        with pytest.raises(InputError, match=r"cannot be reached.*--resume"):
            list(steps)
    kept = sums(store)
    assert 5 <= len(kept) < 200
    assert kept == expected(sorted(kept))


def test_a_scheduler_that_comes_back_is_used_again(tmp_path: Path) -> None:
    asked = campaign(40, {"seconds": 0.05})
    store = Store(tmp_path / NAME, asked.values, code())
    with running(1) as (address, processes):
        kept = 0
        for step in carry_out(asked, store, Cluster(address), do):
            kept += not step.given_up
            if kept == 5:
                end(processes[0])
                processes += [scheduler(int(address.rsplit(":", 1)[1])), worker(address)]
    assert kept == 40
    assert sums(store) == expected(range(40))


def test_an_address_without_a_scheduler_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "CONNECT", 1.0)
    with pytest.raises(InputError, match="cannot be reached"):
        Cluster(f"tcp://127.0.0.1:{free_port()}")
    with pytest.raises(InputError, match="cannot be reached"):
        Cluster("no address")
