"""What is in a recording set, in numbers, and ``summary.json``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from meso_robust.recordings.contact import SHORTEST
from meso_robust.recordings.direct.document import direct_document, words
from meso_robust.recordings.direct.run import DirectTests
from meso_robust.recordings.loose import Lines
from meso_robust.recordings.noise import (
    EstimatedSensor,
    Noise,
    Spread,
    estimated_noise,
    estimated_sensor,
    position_repeatability,
    systematic,
)
from meso_robust.recordings.phases import Phase, phases
from meso_robust.recordings.problem import Problem, in_brief
from meso_robust.recordings.repair import LEFT_OUT, Repair
from meso_robust.recordings.rules import DEG, UM
from meso_robust.recordings.values import Recording, RecordingSet, unwrapped
from meso_robust.types import Floats
from meso_robust.wording import counted

SCHEMA = "meso-robust/recordings-summary/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class TipSummary:
    """Way of one tip in m, its mean and largest speed in m/s; None where fewer than two places."""

    name: str
    path: float | None
    mean_speed: float | None
    largest_speed: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingSummary:
    """One recording in numbers.

    Attributes
    ----------
    file
        Its name.
    duration
        From the first to the last row, in s.
    frames, seen, lost
        Rows; rows that show the part whole; frames without a pose, rows that are missing included.
    travel, turn
        From the first to the last seen pose: the way of the reference point as the crow flies in m,
        and θ in rad, whole turns counted; None if fewer than two were seen.
    tips, phases
        By probe, and in order of time.
    noise
        What the still frames of this recording alone show.
    """

    file: str
    duration: float
    frames: int
    seen: int
    lost: int
    travel: float | None
    turn: float | None
    tips: tuple[TipSummary, ...]
    phases: tuple[Phase, ...]
    noise: Noise


def summary(recordings: RecordingSet) -> tuple[RecordingSummary, ...]:
    """Every recording of a set in numbers.

    Parameters
    ----------
    recordings
        The set.

    Returns
    -------
    tuple of RecordingSummary
        In the order of the set; SI.
    """
    return tuple(_recording(recordings, one) for one in recordings.recordings)


def _recording(recordings: RecordingSet, recording: Recording) -> RecordingSummary:
    times, poses = recording.times, unwrapped(recording).poses
    seen = np.flatnonzero(~np.any(np.isnan(poses), axis=1))
    duration = float(times[-1] - times[0])
    due = round(duration * recordings.sensor.frame_rate) + 1
    moved = poses[seen[-1]] - poses[seen[0]] if seen.size > 1 else None
    return RecordingSummary(
        file=recording.file,
        duration=duration,
        frames=times.size,
        seen=seen.size,
        lost=max(due, times.size) - seen.size,
        travel=None if moved is None else float(np.hypot(moved[0], moved[1])),
        turn=None if moved is None else float(moved[2]),
        tips=tuple(
            _tip(name, times, recording.probes[:, p])
            for p, name in enumerate(recording.probe_names)
        ),
        phases=phases(recordings, recording),
        noise=estimated_noise(replace(recordings, recordings=(recording,))),
    )


def _tip(name: str, times: Floats, places: Floats) -> TipSummary:
    known = np.flatnonzero(~np.any(np.isnan(places), axis=1))
    if known.size < 2:
        return TipSummary(name=name, path=None, mean_speed=None, largest_speed=None)
    way = np.linalg.norm(np.diff(places[known], axis=0), axis=1)
    steps = np.maximum(np.diff(times[known]), SHORTEST)
    return TipSummary(
        name=name,
        path=float(way.sum()),
        mean_speed=float(way.sum() / steps.sum()),
        largest_speed=float((way / steps).max()),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Checked:
    """A set that was checked, and what came of it.

    Attributes
    ----------
    source, format
        Where the set is from, and how it was read.
    recordings
        The set; the repaired one if it was repaired.
    found
        Problems of the set as it was read, with the lines of its files.
    repairs
        What was done; empty if no repair was asked for.
    remaining
        Problems that are left, with the lines of the repaired files if it was repaired.
    lines
        Line of each row that ``remaining`` counts by, as for `problems`.
    notes
        What an importer assumed and left out, one sentence each.
    barring
        Errors that bar a fit; other errors concern what ``left_out`` tells. None: all errors bar it.
    left_out
        What a fit leaves out, as `usable.usable` says.
    direct
        What tests without a simulation say; None where they were not asked.
    """

    source: str
    format: str
    recordings: RecordingSet
    found: tuple[Problem, ...]
    repairs: tuple[Repair, ...]
    remaining: tuple[Problem, ...]
    lines: Lines | None = None
    notes: tuple[str, ...] = ()
    barring: tuple[Problem, ...] | None = None
    left_out: tuple[Repair, ...] = ()
    direct: DirectTests | None = None

    @property
    def unread(self) -> tuple[Problem, ...]:
        """Problems of what could not be read."""
        return tuple(one for one in self.found if one.kind in LEFT_OUT)

    @property
    def matters(self) -> tuple[Problem, ...]:
        """Remaining errors and warnings."""
        return tuple(one for one in self.remaining if one.severity != "information")

    @property
    def verdict(self) -> str:
        """CLEAN, USABLE WITH CARE (warnings, or errors of what is left out) or NOT USABLE AS IT IS."""
        errors = [one for one in self.remaining if one.severity == "error"]
        if errors if self.barring is None else self.barring:
            return "NOT USABLE AS IT IS"
        return "USABLE WITH CARE" if self.matters else "CLEAN"


def document(checked: Checked) -> dict[str, Any]:
    """Content of ``summary.json``.

    Parameters
    ----------
    checked
        As in `answer`.

    Returns
    -------
    dict
        Plain values, in µm and degrees.
    """
    recordings, sensor = checked.recordings, estimated_sensor(checked.recordings)
    return {
        "schema": SCHEMA,
        "source": checked.source,
        "format": checked.format,
        "verdict": checked.verdict,
        "frame_rate_hz": recordings.sensor.frame_rate,
        "noise": _sensor(sensor),
        "recordings": [_values(one) for one in summary(recordings)],
        "found": [_problem(one) for one in checked.found],
        "repairs": [_repair(one) for one in checked.repairs],
        "remaining": [_problem(one) for one in checked.remaining],
        "left_out": [_repair(one) for one in checked.left_out],
        "direct_tests": None if checked.direct is None else direct_document(checked.direct),
        "notes": list(checked.notes),
    }


def _in(value: float | None, unit: float) -> float | None:
    return None if value is None else float(f"{value / unit:.9g}")


def _sensor(sensor: EstimatedSensor) -> dict[str, Any]:
    position, orientation = position_repeatability(sensor.noise), sensor.noise.theta.sigma
    return {
        "position_sigma_um": _in(sensor.info.position_sigma, UM),
        "position_source": sensor.position_source,
        "orientation_sigma_deg": _in(sensor.info.orientation_sigma, DEG),
        "orientation_source": sensor.orientation_source,
        "position_repeatability_um": _in(position, UM),
        "orientation_repeatability_deg": _in(orientation, DEG),
        "position_systematic_um": _in(systematic(sensor.info.position_sigma, position), UM),
        "orientation_systematic_deg": _in(
            systematic(sensor.info.orientation_sigma, orientation), DEG
        ),
        "still_frames": _noise(sensor.noise),
    }


def _noise(noise: Noise) -> dict[str, Any]:
    return {
        "x": _spread(noise.x, "sigma_um", UM),
        "y": _spread(noise.y, "sigma_um", UM),
        "theta": _spread(noise.theta, "sigma_deg", DEG),
    }


def _spread(spread: Spread, key: str, unit: float) -> dict[str, Any]:
    return {
        key: _in(spread.sigma, unit),
        "lag_1_correlation": _in(spread.correlation, 1.0),
        "degrees_of_freedom": spread.freedom,
        "why_not": spread.reason,
    }


def _values(one: RecordingSummary) -> dict[str, Any]:
    return {
        "file": one.file,
        "duration_s": one.duration,
        "frames": one.frames,
        "seen": one.seen,
        "lost": one.lost,
        "part_travel_um": _in(one.travel, UM),
        "part_turn_deg": _in(one.turn, DEG),
        "tips": [
            {
                "name": tip.name,
                "path_um": _in(tip.path, UM),
                "mean_speed_um_s": _in(tip.mean_speed, UM),
                "largest_speed_um_s": _in(tip.largest_speed, UM),
            }
            for tip in one.tips
        ],
        "phases": [
            {"phase": phase.name, "start_s": phase.start, "end_s": phase.end}
            for phase in one.phases
        ],
        "noise": _noise(one.noise),
    }


def _problem(one: Problem) -> dict[str, Any]:
    return {
        "file": one.file,
        "kind": one.kind,
        "severity": one.severity,
        "rows": list(one.rows),
        "value": one.value,
        "rule": one.rule,
        "advice": one.advice,
    }


def _repair(one: Repair) -> dict[str, Any]:
    return {"file": one.file, "kind": one.kind, "rows": list(one.rows), "done": one.done}


def answer(checked: Checked, most: int = 20) -> str:
    """The verdict, the problems that matter and the repairs, in lines for a terminal.

    Parameters
    ----------
    checked
        The set, its problems and repairs.
    most
        Lines of each kind that are listed.

    Returns
    -------
    str
        Lines.
    """
    frames = sum(one.times.size for one in checked.recordings.recordings)
    lines = [
        f"{checked.verdict}: {counted(len(checked.recordings.recordings), 'recording')}, {counted(frames, 'row')}",
        *_few("repaired: ", checked.repairs, most),
        *left_out_words(checked),
        *_few("", in_brief(checked.matters), most),
    ]
    if checked.direct is not None:
        lines += _few("direct test: ", words(checked.direct), most)
    rest = len(checked.remaining) - len(checked.matters)
    if rest:
        lines.append(f"{rest} informational notes are in the report")
    return "\n".join([*lines, *_few("note: ", checked.notes, most)])


def left_out_words(checked: Checked) -> tuple[str, ...]:
    """What a fit leaves out of a set, counted; no line where it takes all.

    Parameters
    ----------
    checked
        The set.

    Returns
    -------
    tuple of str
        One line at most.
    """
    if not checked.left_out:
        return ()
    files = sorted({one.file for one in checked.left_out if not one.rows})
    rows = sum(len(one.rows) for one in checked.left_out if one.file not in files)
    parts = [f"{counted(rows, 'row or pose', 'rows or poses')}"] if rows else []
    if files:
        parts.append(f"{counted(len(files), 'recording')} ({', '.join(files)})")
    return (f"a fit leaves out {' and '.join(parts)}; everything else can be used",)


def _few(prefix: str, items: Sequence[object], most: int) -> list[str]:
    lines = [f"{prefix}{item}" for item in items[:most]]
    if len(items) > most:
        lines.append(f"{prefix}and {len(items) - most} more, see the report")
    return lines
