"""A Dask cluster as the crew: the same chunks, the same totals, whoever is killed."""

from __future__ import annotations

import gc
import time
import weakref
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
from tests.campaigns.local_cluster import end, free_port, running, scheduler, worker
from tests.campaigns.test_work import expected, sums
from tests.nightly import at_night

pytestmark = pytest.mark.filterwarnings("ignore")  # of Dask's own


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


def test_the_client_is_closed_whatever_its_pool_says(monkeypatch: pytest.MonkeyPatch) -> None:
    def gone(**_: object) -> None:
        raise OSError("the scheduler is gone")

    with running(1) as (address, _):
        crew = Cluster(address)
        client = crew._client
        monkeypatch.setattr(crew._pool, "shutdown", gone)
        crew.close()
        assert client.status == "closed"


def test_a_scheduler_that_is_gone_is_told_and_what_was_done_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = campaign(200, {"seconds": 0.05})
    store = Store(tmp_path / NAME, asked.values, code())
    with running(1) as (address, processes):
        Cluster(address).close()  # once it is up, two seconds are enough to reach it
        monkeypatch.setattr(cluster, "CONNECT", 2.0)
        steps = carry_out(asked, store, Cluster(address), do)
        monkeypatch.setattr(cluster, "PATIENCE", 1.0)
        for _ in range(5):
            next(steps)
        end(processes[0])
        with pytest.raises(InputError, match=r"cannot be reached.*--resume"):
            list(steps)
    kept = sums(store)
    assert 5 <= len(kept) < 200
    assert kept == expected(sorted(kept))


@at_night
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


def test_a_client_that_failed_is_gone_before_the_next_starts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    failed: list[weakref.ref[object]] = []

    class Client:
        def __init__(self, *_: object, **__: object) -> None:
            assert all(client() is None for client in failed)
            if not failed:
                self.itself = self  # so that only the collector finds it
                failed.append(weakref.ref(self))
                raise OSError("nobody there")

        def get_executor(self, **_: object) -> None:
            """None is needed."""

    monkeypatch.setattr("distributed.Client", Client)
    gc.disable()
    try:
        Cluster("tcp://127.0.0.1:1")
    finally:
        gc.enable()
    assert failed


def test_a_scheduler_without_workers_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = campaign(3)
    store = Store(tmp_path / NAME, asked.values, code())
    with running(0) as (address, _):
        crew = Cluster(address)
        monkeypatch.setattr(cluster, "PATIENCE", 0.5)
        with pytest.raises(InputError, match=r"has no workers; start some.*--resume"):
            list(carry_out(asked, store, crew, do))
