"""Compiled code: functions inside kernels, and keys for what is kept on disk."""

from __future__ import annotations

import hashlib
import os
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import ParamSpec, TypeVar, cast

_P = ParamSpec("_P")
_R = TypeVar("_R")
_T = TypeVar("_T")

FUSED = frozenset({"contract"})
"""What Numba calls a product and a sum that are rounded once."""


def sealed(function: Callable[_P, _R], fused: bool = False) -> Callable[_P, _R]:
    """Compile a function that only kernels call and that makes no array.

    It counts no references: its arrays outlive it, and counting was measured to take most of the
    time of a simulation step. Numba refuses to compile a function that makes an array this way. It has
    neither an entry from Python, which can take longer to compile than the function, nor machine code
    of its own: see ``callees``.

    Parameters
    ----------
    function
        Written for Numba: numbers and arrays in and out.
    fused
        Whether a product and a sum may be rounded once; never where roundings are counted.

    Returns
    -------
    callable
        For kernels only: a call from Python is a TypeError.
    """
    return _callee(function, error_model="numpy", _nrt=False, fastmath=_fastmath(fused))


def strict(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Compile a function without an entry from Python, in which a division by nought is an error.

    Parameters
    ----------
    function
        Written for Numba: numbers and arrays in and out; it may make arrays.

    Returns
    -------
    callable
        For kernels only: a call from Python is a TypeError.
    """
    return _callee(function)


def inlined(function: Callable[_P, _R], fused: bool = False) -> Callable[_P, _R]:
    """Compile as `sealed` does, and always into the functions that call it.

    For small functions that take or return several numbers: a call hands those on by memory.

    Parameters
    ----------
    function
        Written for Numba: numbers and arrays in and out.
    fused
        As for `sealed`.

    Returns
    -------
    callable
        For kernels only: a call from Python is a TypeError.
    """
    options = {"error_model": "numpy", "_nrt": False, "forceinline": True}
    return _callee(function, **options, fastmath=_fastmath(fused))


def _fastmath(fused: bool) -> object:
    return set(FUSED) if fused else False


def _callee(function: Callable[_P, _R], **options: object) -> Callable[_P, _R]:
    from numba import njit

    from meso_robust.callees import Callees

    compile_ = njit(
        no_cpython_wrapper=True, no_cfunc_wrapper=True, pipeline_class=Callees, **options
    )
    return cast("Callable[_P, _R]", compile_(function))


def part(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Put the body of a function into the one kernel that calls it, before anything is compiled.

    Numba optimises each function with all that it calls: a level less saves as much as the whole takes.
    The caller must be `sealed` wherever references must not be counted.

    Parameters
    ----------
    function
        Written for Numba: numbers and arrays in and out.

    Returns
    -------
    callable
        For kernels only.
    """
    from numba import njit

    compile_ = njit(error_model="numpy", inline="always", no_cpython_wrapper=True)
    return cast("Callable[_P, _R]", compile_(function))


def maker(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Compile a function that only kernels call and that makes arrays.

    Parameters
    ----------
    function
        Written for Numba: numbers and arrays in and out.

    Returns
    -------
    callable
        For kernels only: a call from Python is a TypeError.
    """
    # Said although it is the default: a function compiled on behalf of another inherits its choice.
    return _callee(function, error_model="numpy", _nrt=True)


def fingerprint(*packages: str) -> int:
    """A number that changes with any source of the named packages (folders beside this file).

    Numba keeps compiled code on disk and renews it when the file of the function changes, but not
    when a function that it calls from another file does. What a function encloses is part of its key
    on disk, so a kernel that calls into other files must enclose this number (a stale kernel would
    prove with yesterday's arithmetic), and the functions it calls must not be kept by themselves.

    Parameters
    ----------
    packages
        Folders beside this file.

    Returns
    -------
    int
        56 bits of the SHA-256 of the sources.
    """
    digest = hashlib.sha256()
    for package in packages:
        for source in sorted((Path(__file__).parent / package).glob("*.py")):
            digest.update(source.read_bytes())
    return int.from_bytes(digest.digest()[:7], "big")


_threads: list[int] = []


def threads() -> int:
    """How many threads a batch of runs may take: all cores, unless :func:`one_thread` is in force.

    Returns
    -------
    int
        At least one.
    """
    return _threads[-1] if _threads else os.cpu_count() or 1


def spread(function: Callable[[_T], _R], items: Iterable[_T]) -> list[_R]:
    """What a function says of each item, worked out by as many threads as :func:`threads`.

    Of use where a call is long and mostly in compiled code that lets others run.

    Parameters
    ----------
    function
        Of one item; it changes nothing that another call reads.
    items
        Any number.

    Returns
    -------
    list
        In the order of the items, whichever thread was quicker.
    """
    with ThreadPoolExecutor(threads()) as pool:
        return list(pool.map(function, items))


def share_out(call: Callable[[_T], None], pieces: Iterable[_T], workers: int) -> None:
    """Do pieces of a batch by several threads, of which this one is one.

    A pool takes as long to start as a small batch to finish.

    Parameters
    ----------
    call
        Does a piece, in compiled code that lets others run.
    pieces
        Any number.
    workers
        Threads, at least one.

    Raises
    ------
    BaseException
        What the first call that failed has raised.
    """
    left, failed = iter(list(pieces)), list[BaseException]()

    def work() -> None:
        try:
            for piece in left:  # each is handed to one thread only
                call(piece)
        except BaseException as error:
            failed.append(error)

    others = [threading.Thread(target=work) for _ in range(workers - 1)]
    for other in others:
        other.start()
    work()
    for other in others:
        other.join()
    if failed:
        raise failed[0]


@contextmanager
def one_thread() -> Iterator[None]:
    """Within the block batches take one thread: where each core has a process of its own.

    Returns
    -------
    context manager
        In force until the block ends.
    """
    _threads.append(1)
    try:
        yield
    finally:
        _threads.pop()
