"""What the verbs share: where words go, and how a run ends."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NoReturn, TypeAlias

import typer

POSITIVE, NEGATIVE, BAD_INPUT = 0, 1, 2
INTERRUPTED = 130
"""What shells give for a run that was ended by Ctrl-C."""

Told: TypeAlias = Callable[[str, int, int], None]
"""Called with a stage of the work, how much of it is done, and how much there is."""


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

    @contextmanager
    def following(self) -> Iterator[Told]:
        """Show a bar for every stage that the block tells of by calling what it is given.

        Stages come one after the other: the next one ends those before it.
        """
        if not self._console.is_terminal:
            said: set[str] = set()

            def line(stage: str, *_: int) -> None:
                if stage not in said:
                    said.add(stage)
                    self._console.print(f"{stage} ...", markup=False, highlight=False)

            yield line
            return
        from rich.markup import escape
        from rich.progress import Progress, TaskID

        with Progress(console=self._console, transient=True) as progress:
            bars: dict[str, TaskID] = {}

            def bar(stage: str, done: int, total: int) -> None:
                if stage not in bars:
                    for ended in progress.tasks:
                        progress.update(ended.id, total=1, completed=1)
                    bars[stage] = progress.add_task(escape(stage), total=None)
                # one step tells nothing on the way: its bar only shows that work goes on
                known = total if total > 1 or done else None
                progress.update(bars[stage], completed=done, total=known)

            yield bar


def refuse(message: object) -> NoReturn:
    """End with exit status 2 and one message."""
    print(f"meso-robust: {message}", file=sys.stderr)
    raise typer.Exit(BAD_INPUT)


def negative(message: object) -> NoReturn:
    """End with exit status 1 and one message."""
    print(f"meso-robust: {message}", file=sys.stderr)
    raise typer.Exit(NEGATIVE)
