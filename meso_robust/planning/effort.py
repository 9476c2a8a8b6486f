"""How long a plan is looked for: a limit on computing time that holds in all of a search.

What is found within it is proved like anything else; the limit only decides when a search gives up. It is
computing time, so that other work on the machine does not change what is found, and time in which kernels are
compiled does not count, so that a first run finds what others find.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

from numba.core.event import TimingListener, register

from meso_robust.copies import shared

_compiling = TimingListener()
register("numba:compile", _compiling)
_T = TypeVar("_T")
_R = TypeVar("_R")


class EffortSpentError(Exception):
    """A search has taken as long as it may."""


_until: ContextVar[float | None] = ContextVar("until", default=None)


def _clock() -> float:
    """Computing time of this process, without that of compiling, s."""
    return time.process_time() - (_compiling.duration if _compiling.done else 0.0)


@contextmanager
def limited(seconds: float | None) -> Iterator[None]:
    """Let searches within the block take so long at most.

    Parameters
    ----------
    seconds
        Of computing, s; None: as long as they take. No longer than a limit around this one.

    Yields
    ------
    None
        Searches end with `EffortSpentError` when they have taken as long.
    """
    around = _until.get()
    ends = [] if around is None else [around]
    ends += [] if seconds is None else [_clock() + seconds]
    token = _until.set(min(ends, default=None))
    try:
        yield
    finally:
        _until.reset(token)


def spend() -> None:
    """Go on to the next thing that is tried in a search.

    Raises
    ------
    EffortSpentError
        The search has taken as long as it may.
    """
    until = _until.get()
    if until is not None and _clock() > until:
        raise EffortSpentError


def each(function: Callable[[_T], _R], items: Iterable[_T]) -> list[_R]:
    """What a search finds for each item, side by side where copies of this process are allowed.

    Parameters
    ----------
    function
        The search; what it finds can be pickled.
    items
        What to search for.

    Returns
    -------
    list
        In the order of the items.

    Raises
    ------
    EffortSpentError
        One of the searches has taken as long as is left here.
    """
    until = _until.get()
    left = None if until is None else until - _clock()

    def within(item: _T) -> tuple[_R] | None:
        try:
            with limited(left):  # the clock of a copy begins anew
                return (function(item),)
        except EffortSpentError:
            return None

    found = shared(within, items)
    if None in found:
        raise EffortSpentError
    return [one[0] for one in found if one is not None]
