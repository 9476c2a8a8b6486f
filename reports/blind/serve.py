"""Asking the diagnoser: a process that is given the path of a folder, and nothing else.

``python -m reports.blind.serve MODULE:FUNCTION`` is the far side, which answers a JSON line for each
it reads and so pays for its imports once; `Service` is the near side of it. `Command` starts a
process of its own for every folder.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import selectors
import signal
import subprocess
import sys
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, Protocol

Document = dict[str, Any]

ROOT = Path(__file__).resolve().parents[2]
DIAGNOSER = "meso_robust.diagnosis.answer:diagnosed"
ONE_THREAD = ("OMP", "OPENBLAS", "MKL", "NUMBA")
LONGEST = 1800.0  # s, after which a folder counts as not answered
GRACE = 5.0  # s between the end of a process's output and its own
KEPT = 2000  # characters kept of what a failing process said


class NoAnswerError(Exception):
    """The diagnoser failed, died or took too long; the message says how."""


class Diagnoser(Protocol):
    """Whatever turns a folder into a ``diagnosis.json`` document."""

    def ask(self, folder: Path, *, quick: bool, seed: int) -> Document:
        """The document for a recording set; raises `NoAnswerError`."""

    def stop(self) -> None:
        """End the process and answer no more; from any thread."""

    def close(self) -> None:
        """The same, and let go of everything; from the thread that asks."""


def _environment(path: Sequence[Path]) -> Mapping[str, str]:
    """One thread a process, and imports from ``path`` before anything installed."""
    threads = {f"{name}_NUM_THREADS": "1" for name in ONE_THREAD}
    return {**os.environ, **threads, "PYTHONPATH": os.pathsep.join(map(str, path))}


def _end(process: subprocess.Popen[str]) -> None:
    """End a process and whatever it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _let_go(process: subprocess.Popen[str]) -> None:
    _end(process)
    for stream in (process.stdin, process.stdout, process.stderr):
        if stream is not None:
            with contextlib.suppress(BrokenPipeError):
                stream.close()


@dataclass(slots=True)
class Service:
    """One long-lived process; started when first asked and again after it has died."""

    target: str = DIAGNOSER
    path: Sequence[Path] = (ROOT,)
    longest: float = LONGEST
    _process: subprocess.Popen[str] | None = field(default=None, init=False)
    _closed: bool = field(default=False, init=False)

    def ask(self, folder: Path, *, quick: bool, seed: int) -> Document:
        """The document for a recording set; raises `NoAnswerError`."""
        if self._closed:
            raise NoAnswerError("the diagnoser has been closed")
        process = self._started()
        assert process.stdin is not None
        assert process.stdout is not None
        asked = {"folder": str(folder), "quick": quick, "seed": seed}
        try:
            process.stdin.write(json.dumps(asked) + "\n")
            process.stdin.flush()
        except BrokenPipeError:
            pass  # it has ended; the line that does not come says so
        try:
            line = _line(process.stdout, self.longest)
        except TimeoutError:
            _let_go(process)
            raise NoAnswerError(f"the diagnoser took more than {self.longest:g} s") from None
        if not line.endswith("\n"):
            status = _status(process)
            _let_go(process)
            raise NoAnswerError(f"the diagnoser ended by {status}")
        answer = json.loads(line)
        if "error" in answer:
            raise NoAnswerError(answer["error"])
        return dict(answer["document"])

    def stop(self) -> None:
        """End the process for good; from any thread."""
        self._closed = True
        if self._process is not None:
            _end(self._process)

    def close(self) -> None:
        """The same, and let go of its pipes; from the thread that asks."""
        self.stop()
        if self._process is not None:
            _let_go(self._process)

    def _started(self) -> subprocess.Popen[str]:
        if self._process is None or self._process.poll() is not None:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "reports.blind.serve", self.target],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                env=_environment(self.path),
                start_new_session=True,  # an interrupt is for the campaign to handle
            )
        return self._process


def _line(stream: IO[str], longest: float) -> str:
    """The next line, cut short if the stream ends; raises `TimeoutError` after ``longest`` s."""
    with selectors.DefaultSelector() as selector:
        selector.register(stream, selectors.EVENT_READ)
        if not selector.select(longest):
            raise TimeoutError
        return stream.readline()


def _status(process: subprocess.Popen[str]) -> int | None:
    """Exit status of a process whose output has ended."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        return process.wait(GRACE)
    return None


@dataclass(slots=True)
class Command:
    """A new process for every folder; its standard output is the document.

    ``{folder}`` and ``{seed}`` in the words of the template are filled in; ``--quick`` is added if
    asked. An exit status of 0 or 1 is an answer, as the command line has it.
    """

    template: Sequence[str]
    path: Sequence[Path] = (ROOT,)
    longest: float = LONGEST
    _process: subprocess.Popen[str] | None = field(default=None, init=False)

    def ask(self, folder: Path, *, quick: bool, seed: int) -> Document:
        """The document for a recording set; raises `NoAnswerError`."""
        words = [word.format(folder=folder, seed=seed) for word in self.template]
        self._process = process = subprocess.Popen(
            [*words, "--quick"] if quick else words,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=_environment(self.path),
            start_new_session=True,
        )
        try:
            out, said = process.communicate(timeout=self.longest)
        except subprocess.TimeoutExpired:
            _let_go(process)
            raise NoAnswerError(f"the diagnoser took more than {self.longest:g} s") from None
        if process.returncode not in (0, 1):
            raise NoAnswerError(f"exit status {process.returncode}: {said[-KEPT:]}")
        try:
            return dict(json.loads(out))
        except ValueError:
            raise NoAnswerError(f"no document but {out[:KEPT]!r}") from None

    def stop(self) -> None:
        """End the process that runs; from any thread."""
        if self._process is not None:
            _end(self._process)

    def close(self) -> None:
        """Nothing is kept between two folders."""
        self.stop()


def main() -> None:
    """Answer every line of the standard input, until it ends."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # whatever is printed must not be taken for an answer
    for line in sys.stdin:
        answers.write(json.dumps(answered(sys.argv[1], json.loads(line))) + "\n")
        answers.flush()


def answered(target: str, asked: Mapping[str, Any]) -> Mapping[str, Any]:
    """What ``MODULE:FUNCTION`` makes of a folder, or how it failed."""
    module, _, function = target.partition(":")
    try:
        diagnose = getattr(importlib.import_module(module), function)
        folder = Path(asked["folder"])
        return {"document": diagnose(folder, quick=asked["quick"], seed=asked["seed"])}
    except Exception:
        return {"error": traceback.format_exc()[-KEPT:]}


if __name__ == "__main__":
    main()
