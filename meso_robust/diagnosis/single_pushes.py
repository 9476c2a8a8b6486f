"""What a single push must keep to: rest without a tip, rest as it leaves, and a tip at the outline."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from meso_robust.diagnosis.runs import FEWEST, Run, from_start, in_frame
from meso_robust.identification.prepared import Prepared
from meso_robust.recordings.contact import gaps
from meso_robust.types import Floats, Ints

_TAIL = 150e-6  # m: last part of a push that its end is extrapolated from
_EXACT = np.array([0.3e-6, 0.3e-6, 0.3e-3])  # of that extrapolation, m and rad
_SETTLED = 20e-6  # m: way after which a tip is taken to be in contact
_STEADY = 3e-6  # m: by how much a gap may vary that is still one contact
_MOSTLY = 0.6  # of the frames

Test = tuple[Floats, Floats]
"""A difference (3,) in m and rad and its standard deviation without a mismatch; zero: no part of it."""


def offered(prepared: Prepared, run: Run, name: str, noise: Floats) -> bool:
    """Whether a push has the frames for a test, and its tip stays in contact where that is asked."""
    if name in ("onset", "metric"):
        frames = _contact(prepared, run)
        return len(frames) > FEWEST and _held(prepared, run, prepared.seen[run.recording], noise)
    return len(run.still if name == "untouched" else run.after) > FEWEST


def _untouched(prepared: Prepared, run: Run, poses: Floats, noise: Floats) -> Test:
    return _drift(prepared, run, poses, noise, run.still)


def _rest(prepared: Prepared, run: Run, poses: Floats, noise: Floats) -> Test:
    return _drift(prepared, run, poses, noise, run.after)


def _drift(prepared: Prepared, run: Run, poses: Floats, noise: Floats, frames: Ints) -> Test:
    """Motion over frames in which no tip pushes: the line fitted to them, from end to end."""
    times = prepared.instants[run.recording, frames]
    away = times - times.mean()
    weights = away * (times[-1] - times[0]) / (away @ away)
    moved = weights @ poses[frames]
    start = np.array([0.0, 0.0, poses[run.still, 2].mean()])
    return np.array([*in_frame(moved[:2], start), moved[2]]), noise * np.linalg.norm(weights)


def _retract(prepared: Prepared, run: Run, poses: Floats, noise: Floats) -> Test:
    """From the end of the push to the mean of what follows."""
    times = prepared.instants[run.recording]
    tail = run.pushed[run.travel_at(times[run.pushed]) >= run.length - _TAIL]
    if len(tail) <= FEWEST:
        tail = run.pushed[-FEWEST - 1 :]
    place = (run.travel_at(times[tail]) - run.length) / _TAIL
    weights = np.linalg.pinv(np.vander(place, 3))[-1]  # a parabola at the end
    before, later = weights @ poses[tail], poses[run.after].mean(axis=0)
    start = poses[run.still].mean(axis=0)
    error = np.sqrt(weights @ weights + 1.0 / len(run.after))
    return from_start(later, start) - from_start(before, start), np.hypot(noise * error, _EXACT)


def _contact(prepared: Prepared, run: Run) -> Ints:
    """Frames in which the tip has been in contact for a while."""
    travel = run.travel_at(prepared.instants[run.recording, run.pushed])
    return run.pushed[travel >= min(_SETTLED, 0.2 * run.length)]


def _gap(prepared: Prepared, run: Run, poses: Floats) -> tuple[Floats, Floats]:
    """Way of the tip (k,) in m, and its gap (k,) to the part as seen, of frames in contact."""
    frames = _contact(prepared, run)
    times = prepared.instants[run.recording, frames]
    clock, way = run.clock, prepared.waypoints[run.recording, :, run.tip]
    tips = np.stack([np.interp(times, clock, column) for column in way.T], axis=1)
    radius = prepared.shapes[run.tip].radius
    gap = gaps(prepared.outline, poses[frames], tips[:, None], radius)[:, 0]
    return run.travel_at(times), gap


def _gap_noise(run: Run, noise: Floats) -> float:
    x, y = run.point
    return float(np.hypot(noise[0], (x * run.normal[1] - y * run.normal[0]) * noise[2]))


def _held(prepared: Prepared, run: Run, poses: Floats, noise: Floats) -> bool:
    """Whether the tip stays at about the same distance: in contact, and not past a corner."""
    gap = _gap(prepared, run, poses)[1]
    near = np.abs(gap - np.median(gap)) <= _STEADY + 4.0 * _gap_noise(run, noise)
    return bool(np.mean(near) >= _MOSTLY)


def _onset(prepared: Prepared, run: Run, poses: Floats, noise: Floats) -> Test:
    gap = _gap(prepared, run, poses)[1]
    along = np.array([1.0, 0.0, 0.0])
    return gap.mean() * along, _gap_noise(run, noise) / np.sqrt(len(gap)) * along


def _metric(prepared: Prepared, run: Run, poses: Floats, noise: Floats) -> Test:
    way, gap = _gap(prepared, run, poses)
    away = way - way.mean()
    weights = away * (way[-1] - way[0]) / (away @ away)
    along = np.array([1.0, 0.0, 0.0])
    return weights @ gap * along, _gap_noise(run, noise) * np.linalg.norm(weights) * along


SINGLES: dict[str, Callable[[Prepared, Run, Floats, Floats], Test]] = {
    "untouched": _untouched,
    "retract": _retract,
    "rest": _rest,
    "onset": _onset,
    "metric": _metric,
}
"""By name, the test of a push with given poses (T, 3) and noise (3,) of a frame."""
