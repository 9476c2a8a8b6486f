"""Frames in which a part is pushed, found from its motion alone, and how tip and part stand then."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from meso_robust.recordings.contact import scatter, size
from meso_robust.recordings.values import Recording, RecordingSet, unwrapped
from meso_robust.types import Flags, Floats, Indices, Ints

_WINDOW_S = (
    0.08  # on either side, for velocities: some frames of any camera, and a corner stays sharp
)
_FAST = 0.3  # of the fastest: certainly moving
_CLEAR = 5.0  # scatters of one frame
_MOST = 40  # frames of a recording that count
_NEAR = 0.05  # of the part's size: a tip further off than the nearest by that does not push


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Moving:
    """One recording as far as part and tips are seen, with velocities.

    Attributes
    ----------
    times, poses, tips
        (T,) s, (T, 3) m and rad, θ continuous, (T, P, 2) m.
    velocities, tip_velocities
        (T, 3) and (T, P, 2) per s, over a window around each frame.
    frames
        Frames in which the part clearly moves.
    """

    times: Floats
    poses: Floats
    tips: Floats
    velocities: Floats
    tip_velocities: Floats
    frames: Indices


def moving(recordings: RecordingSet, recording: Recording) -> Moving:
    """Find when the part moves.

    Parameters
    ----------
    recordings
        The set: the part's size makes a turn a length.
    recording
        One of it.

    Returns
    -------
    Moving
        Whole frames only; ``frames`` may be empty.
    """
    poses = unwrapped(recording).poses
    whole = np.all(np.isfinite(poses), axis=1) & np.all(np.isfinite(recording.probes), axis=(1, 2))
    times, poses, tips = recording.times[whole], poses[whole], recording.probes[whole]
    window = int(np.clip(round(_WINDOW_S * recordings.sensor.frame_rate), 2, 20))
    none = np.zeros(0, dtype=np.intp)
    if len(times) < 2 * window + 3:
        return Moving(times=times, poses=poses, tips=tips, velocities=np.zeros_like(poses),
                      tip_velocities=np.zeros_like(tips), frames=none)  # fmt: skip
    velocities = _slopes(times, poses, window)
    arm = 0.5 * size(recordings.part.outline)
    ways = 2.0 * window * np.median(np.diff(times)) * np.column_stack(
        (np.hypot(velocities[:, 0], velocities[:, 1]), arm * np.abs(velocities[:, 2]))
    )  # fmt: skip
    rough = np.array([scatter(poses[:, :2]), arm * scatter(poses[:, 2:])])
    way = ways.max(axis=1)
    clear = (way > _FAST * np.quantile(way, 0.95)) & np.any(ways > _CLEAR * rough, axis=1)
    inner = np.arange(len(times))
    clear &= (inner >= window) & (inner < len(times) - window)
    return Moving(
        times=times,
        poses=poses,
        tips=tips,
        velocities=velocities,
        tip_velocities=_slopes(times, tips.reshape(len(tips), -1), window).reshape(tips.shape),
        frames=np.flatnonzero(clear),
    )


def _slopes(times: Floats, values: Floats, window: int) -> Floats:
    """(T, n) mean velocity over a window on either side, shorter at the ends."""
    index = np.arange(len(times))
    after = np.minimum(index + window, len(times) - 1)
    before = np.maximum(index - window, 0)
    return np.asarray((values[after] - values[before]) / (times[after] - times[before])[:, None])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contacts:
    """n pairs of a tip and a part that it pushes, from all recordings of a set.

    Attributes
    ----------
    recording, frame
        (n,) numbers of the recording and of the frame among its `Moving.times`.
    gap
        (n,) distance in m from the tip's surface to the outline, negative inside.
    normal
        (n, 2) outward normal of the outline there, body frame.
    tip
        (n, 2) centre of the tip in m, body frame.
    poses, velocities, tip_velocities
        (n, 3), (n, 3) and (n, 2) of `Moving`.
    times
        (n,) s.
    alone
        (n,) whether no other tip is near.
    tip_radius
        m.
    """

    recording: Ints
    frame: Ints
    gap: Floats
    normal: Floats
    tip: Floats
    poses: Floats
    velocities: Floats
    tip_velocities: Floats
    times: Floats
    alone: Flags
    tip_radius: float


def contacts(recordings: RecordingSet, runs: tuple[Moving, ...], late: float = 0.0) -> Contacts:
    """Pairs of tips and the part while it moves, at most 40 frames of a recording.

    Parameters
    ----------
    recordings
        The set.
    runs
        `moving` of each of its recordings.
    late
        Time in s by which the camera is known to lag behind the tips.

    Returns
    -------
    Contacts
        Tips whose median distance while the part moves exceeds that of the nearest by a twentieth of
        the part's size are passed over.
    """
    outline, radius = recordings.part.outline, recordings.tip_radius
    most = _NEAR * size(outline)
    blocks: list[tuple[Any, ...]] = []
    for number, run in enumerate(runs):
        frames = run.frames
        if frames.size > _MOST:
            frames = frames[np.linspace(0, frames.size - 1, _MOST).round().astype(int)]
        if not frames.size or not run.tips.shape[1]:
            continue
        tips = _earlier(run, frames, late)
        pairs = [pair(outline, run.poses[frames], tips[:, p]) for p in range(tips.shape[1])]
        far = [abs(float(np.median(gap)) - radius) for gap, _, _ in pairs]
        near = [each <= min(far) + most for each in far]
        for p, (gap, normal, tip) in enumerate(pairs):
            if near[p]:
                blocks.append((
                    np.full(frames.size, number), frames, gap - radius, normal, tip,
                    run.poses[frames], run.velocities[frames], run.tip_velocities[frames, p],
                    run.times[frames], np.full(frames.size, sum(near) == 1),
                ))  # fmt: skip
    empty = (
        np.zeros(0, dtype=int), np.zeros(0, dtype=int), np.zeros(0), np.zeros((0, 2)),
        np.zeros((0, 2)), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 2)), np.zeros(0), np.zeros(0, dtype=bool),
    )  # fmt: skip
    stacked = [np.concatenate(each) for each in zip(*blocks, strict=True)] if blocks else empty
    return Contacts(
        recording=stacked[0], frame=stacked[1], gap=stacked[2], normal=stacked[3],
        tip=stacked[4], poses=stacked[5], velocities=stacked[6], tip_velocities=stacked[7],
        times=stacked[8], alone=stacked[9], tip_radius=radius,
    )  # fmt: skip


def _earlier(run: Moving, frames: Indices, late: float) -> Floats:
    """(n, P, 2) tips at the instants that the camera shows in some frames."""
    if late == 0.0:
        return run.tips[frames]
    flat = run.tips.reshape(len(run.times), -1)
    at = run.times[frames] - late
    shown = [np.interp(at, run.times, column) for column in flat.T]
    return np.column_stack(shown).reshape(frames.size, -1, 2)


def pair(outline: Floats, poses: Floats, tips: Floats) -> tuple[Floats, Floats, Floats]:
    """Where points are about a part.

    Parameters
    ----------
    outline
        (V, 2) corners, body frame, m.
    poses, tips
        (n, 3) and (n, 2), world frame, m and rad.

    Returns
    -------
    (n,), (n, 2), (n, 2)
        Signed distance from the outline, its outward normal there, and the points, body frame.
    """
    away = tips - poses[:, :2]
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    own = np.stack((cos * away[:, 0] + sin * away[:, 1], cos * away[:, 1] - sin * away[:, 0]), -1)
    following = np.roll(outline, -1, axis=0)
    side = following - outline
    start = own[:, None] - outline
    share = np.clip(np.sum(start * side, axis=2) / np.sum(side**2, axis=1), 0.0, 1.0)
    offset = start - share[..., None] * side
    distance = np.linalg.norm(offset, axis=2)
    nearest = distance.argmin(axis=1)
    rows = np.arange(len(own))
    outward = np.column_stack((side[:, 1], -side[:, 0])) / np.linalg.norm(side, axis=1)[:, None]
    crossing = (outline[:, 1] > own[:, None, 1]) != (following[:, 1] > own[:, None, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        meet = outline[:, 0] + (own[:, None, 1] - outline[:, 1]) * side[:, 0] / side[:, 1]
    inside = np.sum(crossing & (own[:, None, 0] < meet), axis=1) % 2 == 1
    gap = np.where(inside, -1.0, 1.0) * distance[rows, nearest]
    end = (share[rows, nearest] <= 0.0) | (share[rows, nearest] >= 1.0)
    corner = offset[rows, nearest] / np.maximum(distance[rows, nearest], 1e-300)[:, None]
    normal = np.where((end & ~inside)[:, None], corner, outward[nearest])
    return gap, np.asarray(normal), own
