"""What can be wrong with a recording set, as a value."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from meso_robust.wording import counted

Severity = Literal["error", "warning", "information"]
"""Cannot be used; usable with care; only to be known."""

KINDS: Mapping[str, str] = {
    "unreadable": "file cannot be read",
    "row": "row of the wrong length",
    "cell": "cell that is not a number",
    "clock": "clock that repeats or runs backwards",
    "late_stamp": "late stamp",
    "frame_rate": "frames come at another rate than stated",
    "few_frames": "too few frames",
    "gap": "missing frames",
    "wrap": "angle wraps",
    "zero_pose": "pose of zeros: not found",
    "frozen": "frozen pose",
    "outlier": "poses off the path",
    "jump": "jump",
    "shake": "image that shakes",
    "copy": "the same push twice",
    "alike": "ambiguous orientation",
    "units": "units that look wrong",
    "frames": "frames or clocks that disagree",
    "overlap": "tip deep inside the part",
    "untouched": "part moves untouched",
    "never_touched": "never touched",
    "nothing_moves": "nothing moves",
    "still_probe": "probe that never moves",
    "unseen_probe": "probe that is never seen",
    "tip_radius": "tips touch elsewhere than their radius says",
    "force_offset": "force offset at rest",
    "no_probe": "no probe",
    "noise_unknown": "unknown noise",
    "noise": "noise differs from what is stated",
}
"""Kinds of problems in words."""
_LISTED = 4  # of one kind, in a terminal


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """One thing that is wrong.

    Attributes
    ----------
    file
        Name of the file in the folder of the set.
    kind
        One of `KINDS`.
    severity
        How much it matters.
    rows
        Lines of the CSV file (the header is line 1), ascending; none if it concerns the whole file.
    value
        What was found.
    rule
        What it should be.
    advice
        What to do next.
    """

    file: str
    kind: str
    severity: Severity
    rows: tuple[int, ...] = ()
    value: str
    rule: str
    advice: str

    def __str__(self) -> str:
        """One line: file, lines, kind, value; rule; advice."""
        where = f", {lines_text(self.rows)}" if self.rows else ""
        return (
            f"{self.severity}: {self.file}{where}: {KINDS[self.kind]}: {self.value}; {self.rule}; "
            f"{self.advice}"
        )


def in_brief(problems: Sequence[Problem]) -> tuple[str, ...]:
    """A line for each problem; where many are of one kind, for the first ones, and one for the others.

    Parameters
    ----------
    problems
        In their order.

    Returns
    -------
    tuple of str
        Lines.
    """
    kinds: dict[tuple[Severity, str], list[Problem]] = {}
    for one in problems:
        kinds.setdefault((one.severity, one.kind), []).append(one)
    lines: list[str] = []
    for (severity, kind), own in kinds.items():
        most = len(own) if len(own) <= _LISTED + 1 else _LISTED
        lines += map(str, own[:most])
        if others := own[most:]:
            files = counted(len({one.file for one in others}), "file")
            more = f"{len(others)} times more, in {files}"
            lines.append(
                f"{severity}: {KINDS[kind]}: {more}; the report on the recordings lists all"
            )
    return tuple(lines)


def lines_text(rows: Sequence[int], most: int = 8) -> str:
    """Lines as "line 3" or "lines 3-5, 9"; beyond ``most`` ranges only their number.

    Parameters
    ----------
    rows
        Numbers of lines, at least one, ascending.
    most
        Ranges that are listed.

    Returns
    -------
    str
        Words.
    """
    ranges = list(_ranges(rows))
    shown = ", ".join(f"{a}" if a == b else f"{a}-{b}" for a, b in ranges[:most])
    more = f" and {counted(len(ranges) - most, 'more place')}" if len(ranges) > most else ""
    return f"line{'s' if len(rows) > 1 else ''} {shown}{more}"


def _ranges(rows: Sequence[int]) -> Iterable[tuple[int, int]]:
    """First and last of each run of neighbouring lines."""
    if not rows:
        return
    first = rows[0]
    for row, following in pairwise([*rows, rows[-1] + 2]):
        if following != row + 1:
            yield first, row
            first = following
