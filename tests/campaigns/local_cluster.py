"""A Dask cluster on this machine, each part a process of its own that can be killed."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]


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
