"""Recordings cut into short windows by contact phase, each a recording of its own for the simulator."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.diagnosis.document import PhaseName
from meso_robust.identification.prepared import Prepared
from meso_robust.recordings import RecordingSet, unwrapped
from meso_robust.recordings.contact import gaps, margin
from meso_robust.recordings.phases import phases
from meso_robust.types import Floats, Ints

FEWEST = 5
"""Frames with a whole pose that a window must have: a start and a drift take two of them."""
_PIECE = 15  # frames of a piece of a contact, where there are enough
_MOST = 5  # pieces of a contact
_PAD = 1e-3  # s: what a shorter window is lengthened by, at rest


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """A window of a recording.

    Attributes
    ----------
    recording
        Index of the recording in the set.
    first, last
        Index of its first frame among the prepared instants, and of the first frame after it.
    start_s, end_s
        Instants of its first and of its last frame.
    phase
        What the tips did.
    """

    recording: int
    first: int
    last: int
    start_s: float
    end_s: float
    phase: PhaseName


def cuts_of(recordings: RecordingSet, prepared: Prepared) -> tuple[Cut, ...]:
    """Cut every recording by its phases, and contacts into pieces.

    Windows with fewer than `FEWEST` whole frames are left out.

    Parameters
    ----------
    recordings, prepared
        The same recordings as read and as prepared.
    """
    return tuple(cut for r in range(len(prepared.files)) for cut in _cut(recordings, prepared, r))


def _cut(recordings: RecordingSet, prepared: Prepared, r: int) -> list[Cut]:
    recording = unwrapped(recordings.recordings[r])
    instants = prepared.instants[r, : frames_of(prepared)[r]]
    gap = gaps(recordings.part.outline, recording.poses, recording.probes, recordings.tip_radius)
    with np.errstate(invalid="ignore"):
        touching = np.sum(gap <= margin(recordings, recording), axis=1)
    two = np.interp(instants, recording.times, touching > 1) > 0.5
    found: list[Cut] = []
    for phase in phases(recordings, recording):
        end = np.inf if phase.end == recording.times[-1] else phase.end
        inside = np.flatnonzero((instants >= phase.start) & (instants < end))
        for piece in _pieces(inside, two) if phase.name == "contact" else [inside]:
            name: PhaseName = "approach"
            if phase.name == "contact":
                name = "two_point" if two[piece[0]] else "one_point"
            elif phase.name != "unknown":
                name = phase.name
            found += _whole(prepared, r, piece, name)
    return found


def _pieces(inside: Ints, two: npt.NDArray[np.bool_]) -> list[Ints]:
    """Frames of a contact cut where a second tip comes or goes, and into equal pieces."""
    changes = 1 + np.flatnonzero(np.diff(two[inside]))
    parts = [part for part in np.split(inside, changes) if len(part)]
    return [
        piece
        for part in parts
        for piece in np.array_split(part, int(np.clip(len(part) // _PIECE, 1, _MOST)))
    ]


def _whole(prepared: Prepared, r: int, piece: Ints, phase: PhaseName) -> list[Cut]:
    """The window from its first whole frame, if enough of them are left."""
    whole = piece[np.all(np.isfinite(prepared.seen[r, piece]), axis=1)]
    if len(whole) < FEWEST:
        return []
    times = prepared.instants[r]
    return [
        Cut(
            recording=r,
            first=int(whole[0]),
            last=int(piece[-1]) + 1,
            start_s=float(times[whole[0]]),
            end_s=float(times[piece[-1]]),
            phase=phase,
        )
    ]


def frames_of(prepared: Prepared) -> Ints:
    """(R,) number of frames of each recording, without the padding."""
    seen = np.any(np.isfinite(prepared.seen), axis=2)
    return np.asarray(seen.shape[1] - np.argmax(seen[:, ::-1], axis=1))


def tips_of(prepared: Prepared) -> Floats:
    """(R, T, P, 2) positions of the probes at the prepared instants, m."""
    flat = prepared.waypoints.reshape(*prepared.waypoints.shape[:2], -1)
    tips = [
        np.stack([np.interp(t, clock, column) for column in path.T], axis=1)
        for t, clock, path in zip(prepared.instants, prepared.times, flat, strict=True)
    ]
    return np.stack(tips).reshape(*prepared.instants.shape, -1, 2)


def sliced(prepared: Prepared, cuts: tuple[Cut, ...]) -> Prepared:
    """W windows as recordings of their own, on the clock of the recording, starts as first seen.

    A start may overlap a tip: a misfit does that, and the simulator shifts it.
    """
    legs = [_legs(prepared, cut) for cut in cuts]
    wide = 1 + max(len(times) for times, _ in legs)
    frames = max(cut.last - cut.first for cut in cuts)
    clocks = [prepared.instants[cut.recording, cut.first : cut.last] for cut in cuts]
    paths = [np.concatenate([path, np.repeat(path[-1:], wide - len(path), 0)]) for _, path in legs]
    return replace(
        prepared,
        files=tuple(prepared.files[cut.recording] for cut in cuts),
        waypoints=np.stack(paths),
        times=np.stack([_padded(times, wide) for times, _ in legs]),
        instants=np.stack([_padded(clock, frames) for clock in clocks]),
        seen=_sliced_poses(prepared.seen, cuts),
        starts=np.stack([prepared.seen[cut.recording, cut.first] for cut in cuts]),
        correction=np.zeros((len(cuts), frames, 3)),
        notes=(),
    )


def _sliced_poses(poses: Floats, cuts: tuple[Cut, ...]) -> Floats:
    """(W, T', 3) poses (R, T, 3) of the windows, padded with NaN."""
    frames = max(cut.last - cut.first for cut in cuts)
    pieces = np.full((len(cuts), frames, 3), np.nan)
    for row, cut in zip(pieces, cuts, strict=True):
        row[: cut.last - cut.first] = poses[cut.recording, cut.first : cut.last]
    return pieces


def _legs(prepared: Prepared, cut: Cut) -> tuple[Floats, Floats]:
    """(L,) s and (L, P, 2) m: the path of the probes from the first to the last frame."""
    clock, path = prepared.times[cut.recording], prepared.waypoints[cut.recording]
    inside = (clock > cut.start_s) & (clock < cut.end_s)
    times = np.array([cut.start_s, *clock[inside], cut.end_s])
    flat = path.reshape(len(path), -1)
    way = np.stack([np.interp(times, clock, column) for column in flat.T], axis=1)
    return times, way.reshape(len(times), -1, 2)


def _padded(times: Floats, count: int) -> Floats:
    more = count - len(times)
    return np.append(times, times[-1] + _PAD * np.arange(1, more + 1) / max(more, 1))
