"""Repairs that invent nothing: what is no measurement is taken as not seen or left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.errors import InputError
from meso_robust.recordings.checks.view import unseen
from meso_robust.recordings.problem import KINDS, Problem, lines_text
from meso_robust.recordings.problems import line_numbers
from meso_robust.recordings.values import Recording, RecordingSet, unwrapped
from meso_robust.types import Indices

LEFT_OUT = {
    "unreadable": "the recording was left out",
    "row": "the row was left out",
    "cell": "the cell was taken as not seen, a row without an instant left out",
    "clock": "the row was left out",
}
"""Repairs that reading makes, by kind of problem; see `read_readable`."""
UNSEEN: Mapping[str, str] = {
    "zero_pose": "the poses were taken as not seen",
    "frozen": "the poses were taken as not seen",
    "outlier": "the poses were taken as not seen",
    "late_stamp": "the row was left out",
}
"""Repairs of single rows, by kind of problem."""
_KEPT = {"units", "noise_unknown"}  # another value would be a guess about the data


@dataclass(frozen=True, slots=True, kw_only=True)
class Repair:
    """One repair: file, kind of problem, lines (none: the whole file) and what was done."""

    file: str
    kind: str
    rows: tuple[int, ...] = ()
    done: str

    def __str__(self) -> str:
        """One line."""
        where = f", {lines_text(self.rows)}" if self.rows else ""
        return f"{self.file}{where}: {KINDS[self.kind]}: {self.done}"


def repaired(
    recordings: RecordingSet,
    problems: Sequence[Problem],
    lines: Mapping[str, Sequence[int]] | None = None,
) -> tuple[RecordingSet, tuple[Repair, ...]]:
    """Repair what can be repaired without inventing data.

    Parameters
    ----------
    recordings
        The set, as it was read.
    problems
        What `problems` and `read_loosely` say of it.
    lines
        Line of each row, as for `problems`.

    Returns
    -------
    tuple
        The set and what was done. Poses of zeros, repeats and outliers are not seen any more;
        angles are continuous where they wrapped; recordings that cannot be used are left out. Other
        values stay as they are, and so do units.

    Raises
    ------
    InputError
        If no recording would be left.
    """
    repairs = [
        Repair(file=problem.file, kind=problem.kind, rows=problem.rows, done=LEFT_OUT[problem.kind])
        for problem in problems
        if problem.kind in LEFT_OUT
    ]
    kept: list[Recording] = []
    for recording in recordings.recordings:
        own = [one for one in problems if one.file == recording.file]
        useless = [one for one in own if _useless(one)]
        if useless:
            done = f"the recording was left out: {useless[0].value}"
            repairs.append(Repair(file=recording.file, kind=useless[0].kind, done=done))
            continue
        corrected, done_here = _corrected(recording, own, line_numbers(recording, lines))
        kept.append(corrected)
        repairs += done_here
    if not kept:
        raise InputError(
            f"no recording is usable; the last one, {repairs[-1].file}: {repairs[-1].done}; "
            "record the set again or correct it by hand"
        )
    return replace(recordings, recordings=tuple(kept)), tuple(repairs)


def repairable(problem: Problem) -> bool:
    """Whether `repaired` does something about a problem of a set in memory."""
    return problem.kind in {*UNSEEN, "wrap"} or _useless(problem)


def _useless(problem: Problem) -> bool:
    return problem.severity == "error" and problem.kind not in {*LEFT_OUT, *UNSEEN, *_KEPT}


def _corrected(
    recording: Recording, problems: Sequence[Problem], lines: Sequence[int]
) -> tuple[Recording, list[Repair]]:
    repairs = []
    for problem in problems:
        if problem.kind not in UNSEEN:
            continue
        frames = np.flatnonzero(np.isin(np.asarray(lines), problem.rows))
        recording = unseen(recording, frames)
        if problem.kind == "late_stamp":  # the tips stand at a wrong instant, too
            recording = _tips_unseen(recording, frames)
        repairs.append(_repair(problem, UNSEEN[problem.kind]))
    for problem in problems:
        if problem.kind == "wrap":
            recording = unwrapped(recording)
            repairs.append(_repair(problem, "whole turns were added, so θ is continuous"))
    return recording, repairs


def _tips_unseen(recording: Recording, frames: Indices) -> Recording:
    probes = recording.probes.copy()
    probes[frames] = np.nan
    return replace(recording, probes=probes)


def _repair(problem: Problem, done: str) -> Repair:
    return Repair(file=problem.file, kind=problem.kind, rows=problem.rows, done=done)
