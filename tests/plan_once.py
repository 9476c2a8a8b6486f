"""Plans and margins of a test run, made once for the same task whatever the worker."""

from __future__ import annotations

import fcntl
import hashlib
import os
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from meso_robust.task import Task


def once(of: Callable[..., Any], folder: Path) -> Callable[..., Any]:
    """A pure function of a task (and of what pickles alike) whose values are kept in a folder.

    Of two workers that ask at the same time one computes it, and the other waits.
    """

    def kept(*args: Any) -> Any:
        path = folder / f"{of.__name__}-{_key(args)}"
        with one_at_a_time(path.with_suffix(".lock")):
            if not path.exists():
                value = of(*args)  # what raises is asked for again
                draft = path.with_suffix(f".{os.getpid()}")
                draft.write_bytes(pickle.dumps(value))
                draft.replace(path)
        return pickle.loads(path.read_bytes())

    return kept


@contextmanager
def one_at_a_time(lock: Path) -> Iterator[None]:
    """Within the block no other worker is in one with the same lock; it goes with its process."""
    with lock.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def _key(args: tuple[object, ...]) -> str:
    told = [one.model_dump_json() if isinstance(one, Task) else repr(one) for one in args]
    return hashlib.sha256("\n".join(told).encode()).hexdigest()
