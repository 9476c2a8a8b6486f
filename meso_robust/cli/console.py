"""What the verbs share: where words go, and how a run ends."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NoReturn

import typer

POSITIVE, NEGATIVE, BAD_INPUT = 0, 1, 2


class Reporter:
    """Says on stderr what is going on: a spinner on a terminal, plain lines elsewhere."""

    def __init__(self, quiet: bool) -> None:
        from rich.console import Console

        self._console = Console(stderr=True, quiet=quiet)

    @contextmanager
    def doing(self, what: str) -> Iterator[None]:
        """Show ``what`` while the block runs."""
        if not self._console.is_terminal:
            self._console.print(f"{what} ...", markup=False, highlight=False)
            yield
            return
        with self._console.status(what):
            yield

    @contextmanager
    def counting(self, what: str, total: int | None) -> Iterator[Callable[[], object]]:
        """Show ``what`` and a bar while the block runs; it calls what it is given after each step."""
        if not self._console.is_terminal:
            self._console.print(f"{what} ...", markup=False, highlight=False)
            yield lambda: None
            return
        from rich.progress import Progress

        with Progress(console=self._console, transient=True) as progress:
            task = progress.add_task(what, total=total)
            yield lambda: progress.advance(task)


def refuse(message: object) -> NoReturn:
    """End with exit status 2 and one message."""
    print(f"meso-robust: {message}", file=sys.stderr)
    raise typer.Exit(BAD_INPUT)


def negative(message: object) -> NoReturn:
    """End with exit status 1 and one message."""
    print(f"meso-robust: {message}", file=sys.stderr)
    raise typer.Exit(NEGATIVE)
