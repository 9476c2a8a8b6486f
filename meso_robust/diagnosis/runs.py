"""Recordings as pushes about the part: where a tip met it, along which path, and until when.

Everything is from the commanded path and the part's seen pose before the contact: no simulator.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from meso_robust.diagnosis.windows import frames_of
from meso_robust.identification.prepared import Prepared
from meso_robust.identification.touching import distances
from meso_robust.recordings.contact import gaps
from meso_robust.types import Floats, Ints

FEWEST = 5
"""Frames that an estimate takes at least."""
_FREE = 4.0  # standard deviations of a gap that is certainly open
_TAIL = 150e-6  # m: last part of a push that its end is extrapolated from
_EXACT = np.array([0.3e-6, 0.3e-6, 0.3e-3])  # of that extrapolation, m and rad
_SETTLED = 20e-6  # m: way after which a tip is taken to be in contact
_STEADY = 3e-6  # m: by how much a gap may vary that is still one contact
_LITTLE = 2e-3  # of the field of its way, that a tip goes on by where it moves
_MOSTLY = 0.6  # of the frames


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """One push.

    Attributes
    ----------
    recording, file
        Which one.
    start, start_sigma
        (3,) pose before the contact, m and rad, and its standard errors.
    still, pushed, after
        Frames before any tip is near, from the first contact to the end of the push, and after it.
    clock, travel
        (W,) s and m: way of the tip that meets the part, zero at the contact.
    way
        (W, P, 2) centres of the tips in the frame of the part at its start, m.
    tip, point, normal
        Index of the tip; (2,) its centre at the contact and (2,) outward normal there, in that frame.
    contact_s, end_s, length
        Instants of the contact and of the end of the push (the tip turns back), and the way between.
    speed
        Of the tip on that way, m/s.
    reversals
        How often the tip turned back before the contact.
    """

    recording: int
    file: str
    start: Floats
    start_sigma: Floats
    still: Ints
    pushed: Ints
    after: Ints
    clock: Floats
    travel: Floats
    way: Floats
    tip: int
    point: Floats
    normal: Floats
    contact_s: float
    end_s: float
    length: float
    speed: float
    reversals: int

    def travel_at(self, instants: Floats) -> Floats:
        """Way of the tip in m at instants (k,)."""
        return np.interp(instants, self.clock, self.travel)

    def tips_at(self, travel: Floats) -> Floats:
        """(k, P, 2) centres of the tips on their way through the push, frame of the start."""
        inside = (self.travel >= 0.0) & (self.clock <= self.end_s)
        flat = self.way[inside].reshape(int(inside.sum()), -1)
        known = self.travel[inside]
        columns = [np.interp(travel, known, column) for column in flat.T]
        return np.stack(columns, axis=1).reshape(len(travel), -1, 2)


def runs_of(prepared: Prepared, sigma: Floats, correlation: float) -> tuple[Run, ...]:
    """The recordings in which a tip meets the part after it was seen untouched.

    Parameters
    ----------
    prepared
        R recordings.
    sigma, correlation
        (3,) standard deviations of x, y (m) and θ (rad), and φ of the noise.
    """
    found = [_run(prepared, r, sigma, correlation) for r in range(len(prepared.files))]
    return tuple(run for run in found if run is not None)


def longer(correlation: float) -> float:
    """By how much the variance of a mean grows with the colour of the noise: (1 + φ)/(1 − φ)."""
    return (1.0 + correlation) / (1.0 - correlation)


def in_frame(points: Floats, pose: Floats) -> Floats:
    """Points (…, 2) of the world in the frame of a pose (3,)."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    x, y = np.moveaxis(points - pose[:2], -1, 0)
    return np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)


def from_start(pose: Floats, start: Floats) -> Floats:
    """A pose (3,) in the frame of another."""
    return np.array([*in_frame(pose[:2], start), pose[2] - start[2]])


def gaps_of(prepared: Prepared, tips: Floats, pose: Floats) -> tuple[Floats, Floats]:
    """(k, P) gaps in m between tips (k, P, 2) and the part at a pose (3,), and their normals."""
    own = in_frame(tips, pose)
    radii = np.array([shape.radius for shape in prepared.shapes])
    away, normal = distances(prepared.outline[None], own.reshape(-1, 2))
    return away.reshape(own.shape[:2]) - radii, normal.reshape(own.shape)


def _run(prepared: Prepared, r: int, sigma: Floats, correlation: float) -> Run | None:
    clock, way = prepared.times[r], prepared.waypoints[r]
    frames = int(frames_of(prepared)[r])
    instants, seen = prepared.instants[r, :frames], prepared.seen[r, :frames]
    whole = np.all(np.isfinite(seen), axis=1)
    start = seen[int(np.argmax(whole))]
    far = _FREE * float(np.hypot(sigma[0], prepared.length * sigma[2]))
    still = np.zeros(0, dtype=np.int64)
    for _ in range(2):  # with the first pose, then with the mean of the still ones
        gap, normals = gaps_of(prepared, way, start)
        near = gap.min(axis=1) <= far
        last = clock[int(np.argmax(near))] if np.any(near) else instants[-1]
        still = np.flatnonzero(whole & (instants < last))
        if len(still) < FEWEST:
            return None
        start = seen[still].mean(axis=0)
    gap, normals = gaps_of(prepared, way, start)
    met = np.flatnonzero(gap.min(axis=1) <= 0.0)
    if not len(met) or not met[0]:
        return None
    k, tip = int(met[0]), int(np.argmin(gap[met[0]]))
    share = gap[k - 1, tip] / (gap[k - 1, tip] - gap[k, tip])
    contact = clock[k - 1] + share * (clock[k] - clock[k - 1])
    own = in_frame(way, start)
    little = _LITTLE * float(np.hypot(*np.ptp(way[:, tip], axis=0)))
    corners = _corners(way[:, tip], little)
    legs = np.diff(way[corners, tip], axis=0)
    along = np.append(0.0, np.cumsum(np.hypot(*legs.T)))
    along = np.interp(clock, clock[corners], along)
    travel = along - np.interp(contact, clock, along)
    turns = clock[corners][1:-1][np.sum(legs[1:] * legs[:-1], axis=1) < 0.0]
    later = turns[turns > contact]
    # what follows is followed until the tip comes again
    again = float(later[1]) if len(later) > 1 else np.inf
    end = float(later[0]) if len(later) else _stop(clock, travel, instants[-1])
    pushed = np.flatnonzero(whole & (instants >= contact) & (instants <= end))
    length = float(np.interp(end, clock, travel))
    if len(pushed) < FEWEST or length <= 0.0:
        return None
    speed = length / max(end - float(contact), 1e-9)
    return Run(
        recording=r,
        file=prepared.files[r],
        start=start,
        start_sigma=sigma * np.sqrt(longer(correlation) / len(still)),
        still=still,
        pushed=pushed,
        after=np.flatnonzero(whole & (instants > end + little / speed) & (instants <= again)),
        clock=clock,
        travel=travel,
        way=own,
        tip=tip,
        point=own[k - 1, tip] + share * (own[k, tip] - own[k - 1, tip]),
        normal=normals[k, tip],
        contact_s=float(contact),
        end_s=end,
        length=length,
        speed=speed,
        reversals=int(np.sum(turns < contact)),
    )


def _corners(way: Floats, little: float) -> Ints:
    """Waypoints (W, 2) at which a tip has gone on since the last one of them by more than a little, m.

    In a log that is read from an encoder or an image a tip that rests goes back and forth by a little.
    """
    kept = [0]
    for k in range(1, len(way)):
        if np.hypot(*(way[k] - way[kept[-1]])) > little:
            kept.append(k)
    return np.array(kept)


def _stop(clock: Floats, travel: Floats, last: float) -> float:
    """Instant from which on the tip rests."""
    return float(min(clock[int(np.argmax(travel >= travel[-1] - 1e-9))], last))


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
