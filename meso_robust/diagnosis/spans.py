"""Spans of the prepared recordings: phases, and pieces of the contact."""

from __future__ import annotations

import itertools

import numpy as np

from meso_robust.diagnosis.detect import Span
from meso_robust.identification.prepared import Prepared
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.phases import phases

_PIECES = 3  # of a contact
_FEWEST = 3  # frames of a span


def spans_of(recordings: RecordingSet, prepared: Prepared) -> tuple[Span, ...]:
    """Spans of all recordings, in order; the contact is cut into three.

    Parameters
    ----------
    recordings, prepared
        The same recordings.
    """
    found = []
    for row, recording in enumerate(recordings.recordings):
        frames = int(np.max(np.flatnonzero(np.isfinite(prepared.seen[row]).any(axis=1)))) + 1
        clock = prepared.instants[row, :frames]
        for phase in phases(recordings, recording):
            pieces = _PIECES if phase.name == "contact" else 1
            ends = np.linspace(phase.start, phase.end, pieces + 1)
            cuts = np.searchsorted(clock, ends - 1e-9)
            if phase.end >= clock[-1]:
                cuts[-1] = frames
            found += [
                Span(
                    recording=row,
                    phase=phase.name,
                    first=int(first),
                    last=int(last),
                    start=float(clock[first]),
                    end=float(clock[last - 1]),
                )
                for first, last in itertools.pairwise(cuts)
                if last - first >= _FEWEST
            ]
    return tuple(found)
