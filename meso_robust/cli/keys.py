"""What is typed while a run goes on: the answer to a question, or a stop."""

from __future__ import annotations

import io
import os
import select
import sys
import threading
from types import TracebackType
from typing import Self

from meso_robust.live.loop import Words

_POLL = 0.2  # s after which a reader looks whether it is still needed


class Keys:
    """Reads lines while a block runs.

    Parameters
    ----------
    stops
        Whether a line that answers no question, such as the Enter key alone, stops the run. It does so at a
        terminal only: answers in a file or pipe are there before they are asked for.
    """

    def __init__(self, *, stops: bool) -> None:
        self.words = Words()
        self._asked, self._done = threading.Event(), threading.Event()
        self._terminal = stops and sys.stdin is not None and sys.stdin.isatty()
        self._thread: threading.Thread | None = None
        self._begun = b""

    def __enter__(self) -> Self:
        """Begin to read at a terminal; elsewhere the first question does."""
        if self._terminal:
            self._read()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        raised: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        """Read no more."""
        self._done.set()
        if self._thread is not None:
            self._thread.join()

    def ask(self, move: str, words: Words) -> None:
        """Ask about a move; the loop goes on watching meanwhile."""
        print(f"{move}\nmake this move? [y/N] ", end="", file=sys.stderr, flush=True)
        self._asked.set()
        self._read()

    def _read(self) -> None:
        if self._thread is None:
            self._thread = threading.Thread(target=self._follow, daemon=True)
            self._thread.start()

    def _follow(self) -> None:
        while not self._done.is_set():
            if not self._terminal and not self._asked.wait(_POLL):
                continue
            line = self._line()
            if line is None:
                continue
            if self._asked.is_set():
                self._asked.clear()
                self.words.say("yes" if line.strip().lower() in (b"y", b"yes") else "no")
            elif line:
                self.words.say("stop")
            else:
                return  # the terminal is gone: there is nobody to stop it by a key

    def _line(self) -> bytes | None:
        """A line; empty at the end of the input; None if there is none yet."""
        # not by sys.stdin: a thread that waits within it cannot be ended
        while b"\n" not in self._begun:
            try:
                source = sys.stdin.fileno()
                if not select.select([source], [], [], _POLL)[0]:
                    return None
                more = os.read(source, 4096)
            except (OSError, ValueError, AttributeError, io.UnsupportedOperation):
                more = b""
            if not more:
                return b""
            self._begun += more
        line, _, self._begun = self._begun.partition(b"\n")
        return line + b"\n"
