"""What the verbs share: where words go, and how a run ends."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import TYPE_CHECKING, NoReturn

import typer

from meso_robust.api.progress import Rated, Step, Told
from meso_robust.errors import ArgumentError

if TYPE_CHECKING:  # a tenth of the time to the first word, and only a terminal needs it
    from rich.console import Console

NEGATIVE, BAD_INPUT = 1, 2
INTERRUPTED = 130
"""What shells give for a run that was ended by Ctrl-C."""

LINE_EVERY = 10.0  # s: a log of a campaign of a day then has some thousand lines a part


class Reporter:
    """Says on stderr what is going on: a spinner on a terminal, plain lines elsewhere."""

    def __init__(self, quiet: bool = False) -> None:
        self._quiet = quiet

    @cached_property
    def _console(self) -> Console | None:
        """Of a terminal that is to show something."""
        if self._quiet or not sys.stderr.isatty():
            return None
        from rich.console import Console

        return Console(stderr=True)

    def _line(self, text: str) -> None:
        if not self._quiet:
            print(text, file=sys.stderr, flush=True)

    @contextmanager
    def doing(self, what: str) -> Iterator[None]:
        """Show ``what`` while the block runs."""
        if self._console is None:
            self._line(f"{what} ...")
            yield
            return
        from rich.markup import escape

        with self._console.status(escape(what)):
            yield

    @contextmanager
    def counting(self, what: str, total: int | None) -> Iterator[Callable[[], object]]:
        """Show ``what`` and a bar while the block runs; it calls what it is given after each step."""
        if self._console is None:
            self._line(f"{what} ...")
            yield lambda: None
            return
        from rich.markup import escape
        from rich.progress import Progress

        with Progress(console=self._console, transient=True) as progress:
            task = progress.add_task(escape(what), total=total)
            yield lambda: progress.advance(task)

    @contextmanager
    def following(self) -> Iterator[Told]:
        """Show a bar for every stage that the block tells of by calling what it is given.

        Stages come one after the other: the next one ends those before it.
        """
        if self._console is None:
            said: set[str] = set()

            def line(stage: str, *_: int) -> None:
                if stage not in said:
                    said.add(stage)
                    self._line(f"{stage} ...")

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

    @contextmanager
    def rating(self) -> Iterator[Rated]:
        """Show how much of a part is done, at what rate, how long it will take, and what broke.

        On a terminal as a bar, elsewhere as a line every ten seconds.
        """
        paces: dict[str, Pace] = {}
        if self._console is None:
            last = [time.monotonic()]

            def line(part: str, chunks: tuple[int, int], step: Step | None) -> None:
                text = paces.setdefault(part, Pace()).told(chunks, step)
                if (
                    step is None
                    or chunks[0] == chunks[1]
                    or time.monotonic() - last[0] > LINE_EVERY
                ):
                    last[0] = time.monotonic()
                    self._line(f"{part}: {text}")

            yield line
            return
        from rich.markup import escape
        from rich.progress import Progress, TaskID

        with Progress(console=self._console, transient=True) as progress:
            bars: dict[str, TaskID] = {}

            def bar(part: str, chunks: tuple[int, int], step: Step | None) -> None:
                text = paces.setdefault(part, Pace()).told(chunks, step)
                if part not in bars:
                    bars[part] = progress.add_task(escape(part), total=chunks[1])
                shown = escape(f"{part}: {text}")
                progress.update(bars[part], completed=chunks[0], description=shown)

            yield bar


class Pace:
    """How fast a part of a campaign goes, from its first step on."""

    def __init__(self) -> None:
        self._begun = time.monotonic()
        self._steps = self._runs = self._failed = 0

    def told(self, chunks: tuple[int, int], step: Step | None) -> str:
        """The state in a line before the first step, or after a further one.

        Parameters
        ----------
        chunks
            Done and planned, of the part.
        step
            Runs of the step, how many of them failed, and what a run is called; None before the first.
        """
        if step is None:
            return f"{chunks[0]:,} of {chunks[1]:,} chunks, begins"
        if self._steps == 0:
            self._begun = time.monotonic()
        self._steps += 1
        self._runs += step[0]
        self._failed += step[1]
        text = f"{chunks[0]:,} of {chunks[1]:,} chunks"
        seconds = time.monotonic() - self._begun
        if self._steps > 1 and seconds > 0.0:
            # the first step waited for workers and kernels: neither it nor its runs are counted
            each = seconds / (self._steps - 1)
            rate = self._runs * (self._steps - 1) / self._steps / seconds
            shown = f"{rate:,.0f}" if rate >= 10.0 else f"{rate:.2g}"
            text += f", {shown} {step[2]}/s, {_duration(each * (chunks[1] - chunks[0]))} left"
        return f"{text}, {self._failed:,} failed"


def _duration(seconds: float) -> str:
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"


def note(message: object) -> None:
    """Say what is no fault, but should be known; not on stdout, which is for the answer."""
    print(f"meso-robust: note: {one_line(message)}", file=sys.stderr)


def refuse(message: object) -> NoReturn:
    """End with exit status 2 and one message."""
    said = message.__cause__ if isinstance(message, ArgumentError) else message
    print(f"meso-robust: {one_line(said)}", file=sys.stderr)
    raise typer.Exit(BAD_INPUT)


def negative(message: object) -> NoReturn:
    """End with exit status 1 and one message."""
    print(f"meso-robust: {one_line(message)}", file=sys.stderr)
    raise typer.Exit(NEGATIVE)


def one_line(message: object) -> str:
    """A message without line ends, and without what would command the terminal: files can hold both."""
    return "".join(
        letter if letter.isprintable() else repr(letter)[1:-1]
        for letter in str(message).replace("\n", " ")
    )
