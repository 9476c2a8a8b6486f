"""What of a set can be fitted: a few bad rows, poses or files are left out, told and counted.

`recordings` calls a set usable where this leaves enough of it, and fits take what it leaves; so both
judge alike. Nothing is invented: what is left out is what ``--repair`` leaves out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from meso_robust.errors import InputError
from meso_robust.recordings.direct.causes import likely_cause
from meso_robust.recordings.document import SET_FILE
from meso_robust.recordings.problem import Problem, in_brief
from meso_robust.recordings.problems import problems
from meso_robust.recordings.repair import LEFT_OUT, UNSEEN, Repair, repairable, repaired
from meso_robust.recordings.values import RecordingSet
from meso_robust.wording import counted

MOST_FILES = 0.25
"""Share of the recordings that may be left out: beyond it something is wrong with all of them."""
MOST_ROWS = 0.5
"""Share of a recording's rows that may be no measurement; with more it is left out whole."""
_PASSES = 5  # the noise of what is left may bring out more


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Usable:
    """What is left of a set.

    Attributes
    ----------
    recordings
        The set without what was left out.
    left_out
        Rows, poses and files, with the reason of each.
    remaining
        Problems of what is left.
    barring
        Those that bar a fit, if any.
    """

    recordings: RecordingSet
    left_out: tuple[Repair, ...]
    remaining: tuple[Problem, ...]
    barring: tuple[Problem, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was left out and what to keep in mind, a line each."""
        kept = {one.file for one in self.recordings.recordings}
        files = sorted({one.file for one in self.left_out} - kept)
        total = counted(len(kept) + len(files), "recording")
        return (
            *([f"{len(files)} of {total} left out: {', '.join(files)}"] if files else []),
            *(f"left out: {one}" for one in self.left_out),
            *in_brief([one for one in self.remaining if one.severity != "information"]),
        )


def usable(
    recordings: RecordingSet,
    found: Sequence[Problem],
    lines: Mapping[str, Sequence[int]] | None = None,
    allowed: frozenset[str] = frozenset(),
) -> Usable:
    """Leave out what little of a set cannot be fitted.

    Parameters
    ----------
    recordings
        The set, as it was read.
    found
        What reading and `problems` say of it.
    lines
        Line of each row, as for `problems`.
    allowed
        Kinds of errors that the fit can do with.

    Returns
    -------
    Usable
        With ``barring`` where too much would be left out, or what is wrong concerns all recordings.
    """
    errors = tuple(one for one in found if one.severity == "error" and one.kind not in allowed)
    as_read = Usable(recordings=recordings, left_out=(), remaining=tuple(found), barring=errors)
    if not errors or any(one.file == SET_FILE for one in errors):
        return as_read
    files = {one.file for one in recordings.recordings} | {one.file for one in errors}
    bad = _mostly_bad(recordings, errors)
    try:
        left, left_out = _without(recordings, bad)
        left, done = repaired(left, [one for one in errors if one.file not in bad], lines)
        remaining = problems(left)
        for _ in range(_PASSES):
            more = [one for one in remaining if one.severity == "error" and repairable(one)]
            if not more:
                break
            left, further = repaired(left, more)
            done, remaining = (*done, *further), problems(left)
        still = {one.file: one for one in remaining if one.severity == "error"}
        left, gone = _without(left, {file: one for file, one in still.items() if file != SET_FILE})
    except InputError:  # nothing is left
        return as_read
    if len(files) - len(left.recordings) > MOST_FILES * len(files):
        return as_read
    remaining = problems(left) if gone else remaining
    barring = tuple(p for p in remaining if p.severity == "error" and p.kind not in allowed)
    return Usable(
        recordings=left, left_out=(*left_out, *done, *gone), remaining=remaining, barring=barring
    )


def usable_set(
    recordings: RecordingSet,
    read: Sequence[Problem] = (),
    lines: Mapping[str, Sequence[int]] | None = None,
    allowed: frozenset[str] = frozenset(),
) -> Usable:
    """What of a set a fit takes.

    Parameters
    ----------
    recordings
        The set, as it was read.
    read
        What could not be read of it.
    lines, allowed
        As for `usable`.

    Returns
    -------
    Usable
        Nothing bars it.

    Raises
    ------
    InputError
        Something about the set makes a fit meaningless; the message says what, and where one is
        seen, the likely cause.
    """
    result = usable(recordings, (*read, *problems(recordings, lines)), lines, allowed)
    if not result.barring:
        return result
    first, count = result.barring[0], len(result.barring)
    more = f" (and {count - 1} more)" if count > 1 else ""
    cause = likely_cause(recordings)
    likely = f"; likely cause: {cause.words}; {cause.advice}" if cause else ""
    raise InputError(
        f"{first}{more}{likely}; list them with `meso-robust recordings`, which with --repair marks "
        "bad poses as not seen"
    )


def _mostly_bad(recordings: RecordingSet, errors: Sequence[Problem]) -> dict[str, Problem]:
    """Recordings of which more than a few rows are no measurement, each with its first error."""
    counts = {one.file: one.times.size for one in recordings.recordings}
    first: dict[str, Problem] = {}
    bad: dict[str, int] = {}
    for one in errors:
        if one.file in counts and one.kind in {*UNSEEN, *LEFT_OUT}:
            first.setdefault(one.file, one)
            bad[one.file] = bad.get(one.file, 0) + len(one.rows)
    return {file: first[file] for file, rows in bad.items() if rows > MOST_ROWS * counts[file]}


def _without(
    recordings: RecordingSet, bad: Mapping[str, Problem]
) -> tuple[RecordingSet, tuple[Repair, ...]]:
    """The set without some of its recordings, and what was done.

    Raises
    ------
    InputError
        None would be left.
    """
    kept = tuple(one for one in recordings.recordings if one.file not in bad)
    if not kept:
        raise InputError("no recording is usable; all have errors; record the set again")
    done = tuple(
        Repair(file=file, kind=one.kind, done=f"the recording was left out: {one.value}")
        for file, one in bad.items()
    )
    return (replace(recordings, recordings=kept), done) if bad else (recordings, ())
