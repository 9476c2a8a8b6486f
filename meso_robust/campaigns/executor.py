"""Executors that run chunks: processes of this machine. See ``cluster.py`` for several machines."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context, parent_process, resource_tracker
from typing import Protocol, TypeVar

Found = TypeVar("Found")


class CrewLostError(Exception):
    """Workers are gone and what they were doing has to be done again; ``renew`` gets new ones."""


class Crew(Protocol):
    """Processes that do chunks."""

    @property
    def name(self) -> str:
        """As the report describes it."""

    @property
    def size(self) -> int:
        """How many chunks are done side by side. Raises InputError if there are no workers."""

    def submit(self, do: Callable[[str, int], Found], part: str, chunk: int) -> Future[Found]:
        """Have a chunk done. Raises CrewLostError."""

    def lost(self, error: BaseException) -> bool:
        """Whether an error of a future says that its worker is gone, and perhaps others with it."""

    def renew(self) -> None:
        """Replace the workers, whatever they are doing. Raises InputError if that cannot be."""

    def close(self) -> None:
        """End all work that is under way."""


class Processes:
    """A crew of processes of this machine, one chunk each at a time."""

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._pool = self._new()

    @property
    def name(self) -> str:
        """As the report describes it."""
        return f"{self._workers} process{'' if self._workers == 1 else 'es'}"

    @property
    def size(self) -> int:
        """How many chunks are done side by side."""
        return self._workers

    def _new(self) -> ProcessPoolExecutor:
        # spawned, so that a worker has nothing of this process but the chunk
        return ProcessPoolExecutor(self._workers, get_context("spawn"), initializer=begin_worker)

    def submit(self, do: Callable[[str, int], Found], part: str, chunk: int) -> Future[Found]:
        """Have a chunk done."""
        try:
            with deaf_to_ctrl_c():
                return self._pool.submit(do, part, chunk)
        except BrokenExecutor as error:
            raise CrewLostError(str(error)) from error

    def lost(self, error: BaseException) -> bool:
        """Whether a process died."""
        return isinstance(error, BrokenExecutor)

    def renew(self) -> None:
        """Kill what is left of the processes and start others."""
        self.close()
        self._pool = self._new()

    def close(self) -> None:
        """End the processes, whatever they are doing."""
        processes = list((self._pool._processes or {}).values())
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.kill()
        for process in processes:
            process.join()


@contextmanager
def deaf_to_ctrl_c() -> Iterator[None]:
    """Within the block Ctrl-C waits, and processes that are started in it never hear it.

    A terminal sends it to every process, and one that has only begun would end with a traceback.
    """
    resource_tracker.ensure_running()  # starting it later would lift the mask
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        with _later():
            yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


@contextmanager
def _later() -> Iterator[None]:
    """The mask is this thread's: what another one hears is told here, and here it has to wait."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heard: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _frame: heard.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if heard:
            signal.raise_signal(signal.SIGINT)


def begin_worker() -> None:
    """Make this process a worker: no Ctrl-C of its own, and an end when its parent ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """A parent that is killed cannot end its workers, and they would wait for work for ever."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
