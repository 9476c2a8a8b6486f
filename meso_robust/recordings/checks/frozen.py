"""Poses that the tracker made up: zeros for "not found", the last pose over and over."""

from __future__ import annotations

import math

import numpy as np

from meso_robust.recordings.checks.view import View, runs, turn
from meso_robust.recordings.contact import margin
from meso_robust.recordings.problem import Problem
from meso_robust.recordings.values import Recording, RecordingSet
from meso_robust.types import Floats, Indices as Integers

_TURN = math.radians(2.0)
_CHANCE = 1e-3  # of a recording to hold such a run of equal frames by chance
_FORMAT = np.array([1e-12, 1e-12, math.radians(1e-6)])  # six decimals of um and deg


def zero_frames(recordings: RecordingSet, recording: Recording) -> Integers:
    """Frames in which x, y and θ are zero and the part was last seen elsewhere.

    A recording of nothing but zeros counts if its noise should show.
    """
    poses = recording.poses
    zero = np.all(poses == 0.0, axis=1)
    others = np.flatnonzero(~zero & ~np.any(np.isnan(poses), axis=1))
    if not others.size:
        noisy = bool(recordings.sensor.position_sigma or recordings.sensor.orientation_sigma)
        return np.flatnonzero(zero) if noisy else np.zeros(0, dtype=np.intp)
    far = margin(recordings, recording)
    found: list[Integers] = []
    for run in runs(zero):
        sides = others[[max(int(np.searchsorted(others, run[0])) - 1, 0)]]
        after = int(np.searchsorted(others, run[0]))
        sides = np.append(sides, others[min(after, others.size - 1)])
        off = np.abs(poses[sides])
        if np.all((np.hypot(off[:, 0], off[:, 1]) > far) | (np.abs(turn(off[:, 2])) > _TURN)):
            found.append(run)
    return np.concatenate([np.zeros(0, dtype=np.intp), *found])


def zero_problem(view: View, frames: Integers) -> list[Problem]:
    """Say which frames are zeros."""
    if not frames.size:
        return []
    return [
        view.problem(
            "zero_pose",
            "error",
            frames,
            f"x, y and θ are all zero in {_rows(frames)}, while the part is elsewhere",
            "an empty cell means not seen",
            "empty these cells; --repair does",
        )
    ]


def frozen_frames(view: View) -> Integers:
    """Frames that repeat the pose of the one before where the camera should show noise.

    A run of r repeats counts if T p^r is below 1/1000, where p, the chance of two equal frames,
    follows from noise and resolution of each coordinate. Without noise it counts if a tip moves
    into the part, deeper than a lag of the camera explains.
    """
    poses = view.recording.poses[view.seen]
    equal = np.zeros(view.seen.size, dtype=bool)
    equal[1:] = np.all(np.diff(poses, axis=0) == 0.0, axis=1)
    sigma = _camera_noise(view)
    if sigma is None:
        gap = np.minimum(view.gap[view.seen], np.finfo(float).max)  # infinite where there is no tip
        deeper = np.append(False, np.diff(gap) < 0.0) & (gap < -view.margin - view.lag)
        return np.asarray(view.seen[equal & deeper])
    chance = float(np.prod(np.minimum(_resolution(poses) / (2.0 * math.sqrt(np.pi) * sigma), 1.0)))
    found = [run for run in runs(equal) if view.seen.size * chance ** len(run) < _CHANCE]
    return view.seen[np.concatenate([np.zeros(0, dtype=np.intp), *found])]


def frozen_problem(view: View, frames: Integers) -> list[Problem]:
    """Say which frames repeat."""
    if not frames.size:
        return []
    longest = max(len(run) for run in runs(np.isin(np.arange(view.times.size), frames)))
    return [
        view.problem(
            "frozen",
            "error",
            frames,
            f"{_rows(frames)} repeating the previous pose bit for bit, up to {longest} in a row",
            "every frame has its own noise",
            "mark these poses as not seen; --repair does",
        )
    ]


def _rows(frames: Integers) -> str:
    return f"{frames.size} row{'s' * (frames.size > 1)}"


def _camera_noise(view: View) -> Floats | None:
    """(3,) noise that frames must show, m and rad; None if there is none or it is unknown."""
    sensor, noise = view.recordings.sensor, view.noise
    stated = (sensor.position_sigma, sensor.position_sigma, sensor.orientation_sigma)
    found = (noise.x.sigma, noise.y.sigma, noise.theta.sigma)
    sigma = [f if s is None else s for s, f in zip(stated, found, strict=True)]
    return np.array(sigma, dtype=np.float64) if all(sigma) else None


def _resolution(poses: Floats) -> Floats:
    """(3,) smallest difference between two values of a coordinate; that of the format if none."""
    steps = [np.diff(np.unique(column)) for column in poses.T]
    return np.array(
        [step.min() if step.size else least for step, least in zip(steps, _FORMAT, strict=True)]
    )
