"""Frames in which a part rests, found from its own motion.

Where a tip seems to be is no evidence here: outline, registration or clock may be what is wrong with
a recording, and then pushed frames would count as noise. A part at rest, or one that drifts, is seen
on a straight line in time; a push bends it.
"""

from __future__ import annotations

import numpy as np

from meso_robust.recordings.contact import size
from meso_robust.recordings.values import Recording, RecordingSet, unwrapped
from meso_robust.types import Flags, Floats

_FIRST = 5  # frames that tell where the part is at first
_MOVED = 12.0  # scatters from frame to frame by which a part has certainly moved
_MOVED_SHARE = 0.1  # of its farthest way, likewise: coloured noise wanders farther than its scatter
_STAYS = 3  # frames that it must stay away: one bad pose is no motion
_BEND = 30.0  # χ² by which a bend must be better than a straight line
_EARLIEST = 9.0  # χ² from the best bend within which the earliest one is taken: three deviations
_SET_OUT = 1e-3  # of its farthest way, from where a tip has set out; its noise is allowed for
_ALONG = 4.0  # a part within this factor of the speed of a tip moves along with it


def still(recordings: RecordingSet, recording: Recording) -> Flags:
    """Frames of a recording before the part begins to move.

    A straight line with one bend is fitted to the poses up to where the part has certainly moved; the
    frames before the earliest bend that explains them are still. Where the part moves evenly, and about as
    fast as a tip, from the first frame on, only those are before a tip sets out.

    Parameters
    ----------
    recordings
        The set: the part's size makes turns and shifts comparable.
    recording
        One of it.

    Returns
    -------
    numpy.ndarray
        (T,) whether the part was seen, at rest or drifting.
    """
    poses = unwrapped(recording).poses * [1.0, 1.0, size(recordings.part.outline)]
    whole = np.all(np.isfinite(poses), axis=1)
    frames = np.flatnonzero(whole)
    quiet = np.zeros(len(whole), dtype=bool)
    if len(frames) <= _FIRST:
        quiet[frames] = True
        return quiet
    tips = np.nan_to_num(recording.probes[frames]) if recording.probe_names else np.zeros((0, 0, 2))
    count = _before_motion(recording.times[frames], _without_spikes(poses[frames]), tips)
    quiet[frames[:count]] = True
    return quiet


def _before_motion(times: Floats, path: Floats, tips: Floats) -> int:
    """How many of the frames (K,), (K, 3) come before the part moves; tips (K, P, 2) in m."""
    if len(tips) and not np.any(np.ptp(tips, axis=0)):
        return len(times)  # what moves while no tip does is a drift
    scatter = _scatter(path)
    away = np.linalg.norm((path - np.median(path[:_FIRST], axis=0)) / scatter, axis=1)
    staying = np.min([np.append(away[k:], np.full(k, away[-1])) for k in range(_STAYS)], axis=0)
    moved = staying > max(_MOVED, _MOVED_SHARE * float(staying.max()))
    if not np.any(moved):
        return len(times)
    window = min(int(np.argmax(moved)) + _STAYS, len(times))
    count = _before_bend(times[:window], path[:window] / scatter)
    if not _along(times[:count], path[:count], tips[:count]):
        return count
    return min(count, _before_tips(tips))


def _before_tips(tips: Floats) -> int:
    """Frames before any tip (K, P, 2) sets out: what moves then is a drift, however fast it is."""
    if not tips.size:
        return 0
    away = np.linalg.norm(tips - np.median(tips[:_FIRST], axis=0), axis=2)
    rough = np.median(np.abs(np.diff(tips, n=3, axis=0)), axis=(0, 2))
    out = np.any(away > np.maximum(_MOVED * rough, _SET_OUT * away.max(axis=0)), axis=1)
    return int(np.argmax(out)) if np.any(out) else len(tips)


def _before_bend(times: Floats, path: Floats) -> int:
    """Frames before the earliest bend of a line through paths (K, 3) in scatters; all without one."""
    clock = times - times[0]
    straight = np.linalg.qr(np.column_stack((np.ones(len(clock)), clock)))[0]
    left = path - straight @ (straight.T @ path)
    bends = np.maximum(clock[:, None] - clock[None, 1:-1], 0.0)
    bends = bends - straight @ (straight.T @ bends)
    falls = np.sum((bends.T @ left) ** 2, axis=1) / np.maximum(np.sum(bends**2, axis=0), 1e-300)
    rest = float(np.sum(left**2)) - falls
    best = float(rest.min())
    unit = max(best / left.size, np.finfo(float).tiny)
    if float(falls.max()) < _BEND * unit:
        return len(times)
    # a frame is still if the bend is at it or later
    return 2 + int(np.argmax(rest <= best + _EARLIEST * unit))


def _along(times: Floats, path: Floats, tips: Floats) -> bool:
    """Whether a part moves on a line about as fast as a tip: then it is pushed."""
    if len(times) < _FIRST:
        return False
    clock = times - times.mean()
    spread = float(clock @ clock)
    speed = np.linalg.norm(clock @ path) / spread
    line = path - path.mean(axis=0) - np.outer(clock, clock @ path) / spread
    error = np.sqrt(np.sum(line**2) / len(clock) / spread)
    steps = np.linalg.norm(np.diff(tips, axis=0), axis=2).sum(axis=0) if tips.size else np.zeros(1)
    pace = float(steps.max()) / float(times[-1] - times[0])
    return bool(speed - 2.0 * error > pace / _ALONG and speed < _ALONG * pace)


def _without_spikes(path: Floats) -> Floats:
    """Median of three frames each."""
    inner = np.median(np.stack([path[:-2], path[1:-1], path[2:]]), axis=0)
    return np.concatenate([path[:1], inner, path[-1:]])


def _scatter(path: Floats) -> Floats:
    """(3,) deviation of a frame from what even motion would be; never zero."""
    rough = np.median(np.abs(np.diff(path, n=3, axis=0)), axis=0)
    # a coordinate that repeats exactly, as of rounded files, still has a size to compare with
    return np.maximum(rough, 1e-6 * np.max(np.ptp(path, axis=0)) + np.finfo(float).tiny)
