"""How long a plan is looked for: a limit on computing time that holds in all of a search.

What is found within it is proved like anything else; the limit only decides when a search gives up. It is
computing time, so that other work on the machine does not change what is found.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar


class EffortSpentError(Exception):
    """A search has taken as long as it may."""


_until: ContextVar[float | None] = ContextVar("until", default=None)


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
    ends += [] if seconds is None else [time.process_time() + seconds]
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
    if until is not None and time.process_time() > until:
        raise EffortSpentError
