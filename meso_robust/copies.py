"""Work shared with copies of this process, for calls that are mostly interpreted.

Threads make such calls no quicker: one interpreter runs one at a time. A copy begins with all that is
imported and compiled here, which a new process would take seconds for. A copy of a process in which
others run threads may wait for a lock that nobody holds any more, so that only those verbs of the command
line allow it that run no thread but the one that shows progress, of which a copy asks for nothing. Should
a copy wait for ever nevertheless, its work is done here.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Iterable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

from meso_robust.kernels import one_thread, threads

_T = TypeVar("_T")
_R = TypeVar("_R")
PLACE = 4
"""Bytes of an item's place in the pipe that tells which is next."""
PATIENCE = 60.0
"""Seconds for which a copy's last item is waited for at least; as long as this process worked, if that is longer."""
_allowed: list[bool] = []


def allow() -> None:
    """Say that no threads run here of which a copy asks for anything; does nothing where systems do not copy well."""
    if hasattr(os, "fork") and sys.platform != "darwin":
        _allowed.append(True)


def shared(function: Callable[[_T], _R], items: Iterable[_T]) -> list[_R]:
    """What a function says of each item, worked out by this process and copies of it.

    As many as there are threads to take (`meso_robust.kernels.threads`), if copies are allowed; else all
    by this process.

    Parameters
    ----------
    function
        Of one item; what it returns can be pickled.
    items
        At most some thousands, each taken by the process that is free first.

    Returns
    -------
    list
        In the order of the items.
    """
    every = list(items)
    count = min(threads(), len(every)) if _allowed else 1
    if count < 2:
        return [function(item) for item in every]
    waiting, last = os.pipe()
    os.write(last, b"".join(k.to_bytes(PLACE, "big") for k in range(len(every))))
    os.close(last)

    def begun() -> tuple[BaseProcess, Connection]:
        reads, writes = context.Pipe(duplex=False)
        process = context.Process(target=tell, args=(writes,), daemon=True)
        process.start()
        writes.close()
        return process, reads

    def work() -> dict[int, _R]:
        return {k: function(every[k]) for k in iter(lambda: _next(waiting), None)}

    def tell(writes: Connection) -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # who waits for this copy is told, and ends it
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        with one_thread():
            writes.send(work())

    context = get_context("fork")
    copies = [begun() for _ in range(count - 1)]
    try:
        with one_thread():  # as the copies do: what it works at may be shared work itself
            begin = time.monotonic()
            found = work()
        end = time.monotonic() + max(PATIENCE, time.monotonic() - begin)
        for _, reads in copies:
            found.update(_told(reads, end))
    finally:
        os.close(waiting)
        for process, reads in copies:
            reads.close()
            process.kill()
            process.join()
    # what a copy failed at, or never came back from, is worked out here, where it is told why
    return [found[k] if k in found else function(item) for k, item in enumerate(every)]


def _next(waiting: int) -> int | None:
    place = os.read(waiting, PLACE)
    return int.from_bytes(place, "big") if place else None


def _told(reads: Connection, end: float) -> dict[int, Any]:
    try:
        if not reads.poll(max(0.0, end - time.monotonic())):
            return {}
        told: dict[int, Any] = reads.recv()
    except EOFError:  # it failed, or was ended
        return {}
    return told
