"""One recording of a set with all that the checks ask of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meso_robust.recordings.contact import SHORTEST, margin, nearest_gap, scatter, size
from meso_robust.recordings.noise import Noise
from meso_robust.recordings.problem import Problem, Severity
from meso_robust.recordings.values import Recording, RecordingSet, unwrapped
from meso_robust.types import Flags, Floats, Indices

LATE = 0.15
"""Time in s by which a camera may lag behind the controller."""
_FINEST = 1e-5  # of the part's size, and rad: below it are rounding and the simulator's own error


@dataclass(frozen=True)
class View:
    """A recording as the checks see it.

    Attributes
    ----------
    recordings
        The set.
    recording
        One of its recordings, without the poses that earlier checks took away.
    lines
        T lines of its file.
    noise
        Noise of the set as its still frames show it.
    """

    recordings: RecordingSet
    recording: Recording
    lines: Sequence[int]
    noise: Noise

    def without(self, frames: Indices) -> View:
        """The same with the poses of some frames taken as not seen."""
        return replace(self, recording=unseen(self.recording, frames))

    def problem(
        self,
        kind: str,
        severity: Severity,
        frames: Indices,
        value: str,
        rule: str,
        advice: str,
    ) -> Problem:
        """A problem of these frames."""
        return Problem(
            file=self.recording.file,
            kind=kind,
            severity=severity,
            rows=tuple(self.lines[k] for k in sorted(frames.tolist())),
            value=value,
            rule=rule,
            advice=advice,
        )

    @cached_property
    def times(self) -> Floats:
        """(T,) instants in s."""
        return self.recording.times

    @cached_property
    def poses(self) -> Floats:
        """(T, 3) in m and rad, θ continuous."""
        return unwrapped(self.recording).poses

    @cached_property
    def seen(self) -> Indices:
        """Frames whose pose was seen."""
        return np.flatnonzero(~np.any(np.isnan(self.recording.poses), axis=1))

    @cached_property
    def size(self) -> float:
        """Square root of the part's area in m."""
        return size(self.recordings.part.outline)

    @cached_property
    def gap(self) -> Floats:
        """(T,) distance to the nearest tip in m; see `nearest_gap`."""
        return nearest_gap(self.recordings, self.recording)

    @cached_property
    def margin(self) -> float:
        """Distance in m beyond which a motion of the part is no matter of calibration.

        Twice the `margin` for frames that are still: a false alarm costs more than a lost frame.
        """
        return 2.0 * margin(self.recordings, self.recording)

    @cached_property
    def sigma(self) -> Floats:
        """(2,) noise of a position in m and of θ in rad.

        From still frames; else what is stated, or the scatter from frame to frame if that is more.
        """
        noise, sensor = self.noise, self.recordings.sensor
        position = max((s.sigma or 0.0 for s in (noise.x, noise.y)), default=0.0)
        found = [
            position or max(sensor.position_sigma or 0.0, scatter(self.poses[:, :2])),
            noise.theta.sigma or max(sensor.orientation_sigma or 0.0, scatter(self.poses[:, 2:])),
        ]
        return np.maximum(found, [_FINEST * self.size, _FINEST])

    @cached_property
    def period(self) -> float:
        """Time from frame to frame in s: as stated, or as the clock has it if that differs."""
        if self.on_time:
            return 1.0 / self.recordings.sensor.frame_rate
        return float(np.median(np.diff(self.times)))

    @cached_property
    def on_time(self) -> bool:
        """Whether the clock's steps agree with the stated rate; true of fewer than five steps.

        One of three quantiles must: many lost frames make the median too long, stamps that come in
        bursts make the lower ones too short. Of a clock that is regular they are alike, and must agree closely.
        """
        steps = np.diff(self.times)
        if steps.size < 5:
            return True
        ratios = np.quantile(steps, (0.1, 0.25, 0.5)) * self.recordings.sensor.frame_rate
        off = 0.15 if np.ptp(ratios) < 0.02 * ratios[1] else 0.3
        return bool(np.any(np.abs(ratios - 1.0) < off))

    @cached_property
    def tip_speed(self) -> float:
        """Largest speed of a tip in m/s, without single leaps; 0 if there are no tips."""
        fastest = 0.0
        for tip in self.recording.probes.transpose(1, 0, 2):
            known = np.flatnonzero(~np.any(np.isnan(tip), axis=1))
            way = np.linalg.norm(np.diff(tip[known], axis=0), axis=1)
            speeds = way / np.maximum(np.diff(self.times[known]), SHORTEST)
            if speeds.size >= 5:
                speeds = np.median(np.lib.stride_tricks.sliding_window_view(speeds, 5), axis=1)
            fastest = max(fastest, float(speeds.max(initial=0.0)))
        return fastest

    @property
    def lag(self) -> float:
        """Way of the tips in m while the camera lags behind the controller."""
        return LATE * self.tip_speed


def unseen(recording: Recording, frames: Indices) -> Recording:
    """The recording with the poses of some frames taken as not seen."""
    if not frames.size:
        return recording
    poses = recording.poses.copy()
    poses[frames] = np.nan
    return replace(recording, poses=poses)


def runs(flags: Flags) -> list[Indices]:
    """Indices of each stretch of True."""
    found = np.flatnonzero(flags)
    return [run for run in np.split(found, np.flatnonzero(np.diff(found) > 1) + 1) if run.size]


def turn(angles: Floats) -> Floats:
    """Angles in rad brought to the nearest whole turn, -π … π."""
    return np.asarray(np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi)
