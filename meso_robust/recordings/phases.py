"""Phases of a recording: approach, contact, retract, rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meso_robust.recordings.contact import margin, nearest_gap
from meso_robust.recordings.values import Recording, RecordingSet
from meso_robust.types import Floats, Ints

PhaseName = Literal["approach", "contact", "retract", "rest", "unknown"]
_NAMES: tuple[PhaseName, ...] = ("approach", "contact", "retract", "rest", "unknown")
_APPROACH, _CONTACT, _RETRACT, _REST, _UNKNOWN = range(5)
_WINDOW = 3  # frames on either side that a speed is taken over
_SLOW = 0.1  # of the fastest tip motion: rest
_SHORT = 3  # frames; a shorter phase belongs to the one before it


@dataclass(frozen=True, slots=True)
class Phase:
    """One phase, from its first frame to the first of the next, in s."""

    name: PhaseName
    start: float
    end: float


def phases(recordings: RecordingSet, recording: Recording) -> tuple[Phase, ...]:
    """Split a recording into phases.

    Contact: a tip is within `margin` of the outline. Otherwise the tips rest, or the gap shrinks
    (approach) or grows (retract). Unknown: part or tips were not seen from the start on; later
    such frames belong to the phase before them.

    Parameters
    ----------
    recordings
        The set: part, tips and noise.
    recording
        One of it.

    Returns
    -------
    tuple of Phase
        In the order of time, without gaps.
    """
    codes = _merged(_codes(recordings, recording))
    starts = np.flatnonzero(np.append(True, np.diff(codes) != 0))
    ends = [*recording.times[starts[1:]], recording.times[-1]]
    return tuple(
        Phase(_NAMES[codes[k]], float(recording.times[k]), float(end))
        for k, end in zip(starts.tolist(), ends, strict=True)
    )


def _codes(recordings: RecordingSet, recording: Recording) -> Ints:
    gap = nearest_gap(recordings, recording)
    way = np.zeros(gap.size)
    for tip in recording.probes.transpose(1, 0, 2):
        way = np.fmax(way, np.linalg.norm(_change(tip), axis=1))
    codes = np.where(_change(gap[:, None])[:, 0] <= 0.0, _APPROACH, _RETRACT)
    codes[way <= _SLOW * way.max(initial=0.0)] = _REST
    codes[gap <= margin(recordings, recording)] = _CONTACT
    codes[np.isnan(gap)] = _UNKNOWN
    return codes


def _change(values: Floats) -> Floats:
    """(T, n) change of values over the window around each frame, shorter at the ends."""
    index = np.arange(len(values))
    last = len(values) - 1
    after, before = np.minimum(index + _WINDOW, last), np.maximum(index - _WINDOW, 0)
    with np.errstate(invalid="ignore"):  # infinite gaps where there is no tip
        return np.asarray(values[after] - values[before])


def _merged(codes: Ints) -> Ints:
    """Codes without unknown frames after the first known one and without short phases."""
    merged = codes.copy()
    for k in range(1, merged.size):
        if merged[k] == _UNKNOWN:
            merged[k] = merged[k - 1]
    starts = np.flatnonzero(np.append(True, np.diff(merged) != 0))
    for start, end in zip(starts, [*starts[1:], merged.size], strict=True):
        if start and end - start < _SHORT:
            merged[start:end] = merged[start - 1]
    return merged
