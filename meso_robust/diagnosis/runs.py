"""Recordings as pushes about the part: where a tip met it, along which path, and until when.

Everything is from the commanded path and the part's seen pose before the contact: no simulator.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.diagnosis.cuts import frames_of
from meso_robust.identification.prepared import Prepared
from meso_robust.identification.touching import distances
from meso_robust.types import Floats, Ints

FEWEST = 5
"""Frames that an estimate takes at least."""
_FREE = 4.0  # standard deviations of a gap that is certainly open


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
    legs = np.diff(way[:, tip], axis=0)
    along = np.append(0.0, np.cumsum(np.hypot(*legs.T)))
    travel = along - np.interp(contact, clock, along)
    turns = clock[1:-1][np.sum(legs[1:] * legs[:-1], axis=1) < 0.0]
    later = turns[turns > contact]
    end = float(later[0]) if len(later) else _stop(clock, travel, instants[-1])
    pushed = np.flatnonzero(whole & (instants >= contact) & (instants <= end))
    length = float(np.interp(end, clock, travel))
    if len(pushed) < FEWEST or length <= 0.0:
        return None
    return Run(
        recording=r,
        file=prepared.files[r],
        start=start,
        start_sigma=sigma * np.sqrt(longer(correlation) / len(still)),
        still=still,
        pushed=pushed,
        after=np.flatnonzero(whole & (instants > end)),
        clock=clock,
        travel=travel,
        way=own,
        tip=tip,
        point=own[k - 1, tip] + share * (own[k, tip] - own[k - 1, tip]),
        normal=normals[k, tip],
        contact_s=float(contact),
        end_s=end,
        length=length,
        speed=length / max(end - float(contact), 1e-9),
        reversals=int(np.sum(turns < contact)),
    )


def _stop(clock: Floats, travel: Floats, last: float) -> float:
    """Instant from which on the tip rests."""
    return float(min(clock[int(np.argmax(travel >= travel[-1] - 1e-9))], last))
