"""Chunks that are no work but go wrong on demand, for the tests of the executor.

A part's ``given`` says what goes wrong: ``{"crash": [3], "raise": [4], "hang": [5], "folder": "..."}``;
with a folder each goes wrong only as often as ``"times"`` says.
"""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

from meso_robust.campaigns.encoding import part_of, result_text
from meso_robust.campaigns.kind import Done, Part, Result
from meso_robust.campaigns.provenance import code

SIZE = 1000


def do(text: str, chunk: int) -> Done:
    """Sum some random numbers, unless this chunk is one that goes wrong."""
    part = part_of(text)
    for fault, act in FAULTS.items():
        if chunk in part.given.get(fault, ()) and _still(part, chunk):
            act()
    time.sleep(float(part.given.get("seconds", 0.0)))
    numbers = part.rng(chunk).random(SIZE)
    values = {"sum": float(numbers.sum()).hex(), "first": float(numbers[0])}
    result = Result(runs=SIZE, failed=int((numbers > 0.999).sum()), failures=(), values=values)
    return Done(
        text=result_text(result),
        seconds=0.0,
        worker=str(os.getpid()),
        code=part.given.get("code", code()),
    )


def _still(part: Part, chunk: int) -> bool:
    """Whether it goes wrong once more; every time without a folder to count in."""
    if "folder" not in part.given:
        return True
    mark = Path(part.given["folder"]) / f"{chunk}"
    times = len(mark.read_text()) if mark.exists() else 0
    mark.write_text("x" * (times + 1))
    return times < int(part.given.get("times", 1))


def _crash() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def _raise() -> None:
    raise ArithmeticError("no such luck")


def _hang() -> None:
    time.sleep(600.0)


FAULTS = {"crash": _crash, "raise": _raise, "hang": _hang}
