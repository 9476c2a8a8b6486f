"""How long work shows which of its stages it is in."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext

Doing = Callable[[str], AbstractContextManager[None]]
"""Shows what is being done while a stage runs."""


def quietly(_: str) -> AbstractContextManager[None]:
    """Show nothing.

    Parameters
    ----------
    _
        Name of the stage.

    Returns
    -------
    context manager
        That does nothing.
    """
    return nullcontext()
