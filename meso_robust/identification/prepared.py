"""Recordings arranged once for the simulator: waypoints of the probes, instants and what was seen."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from meso_robust.errors import InputError
from meso_robust.identification.models.model import characteristic_length
from meso_robust.identification.paths import in_steps, smoothed, thinned, with_corners
from meso_robust.identification.touching import distances, freed
from meso_robust.recordings import Recording, RecordingSet, unwrapped
from meso_robust.recordings.contact import OVERLAP, gaps
from meso_robust.recordings.direct.straight import path_sigma
from meso_robust.recordings.noise import estimated_sensor, roughness, scatter
from meso_robust.simulator import Point, Round
from meso_robust.simulator.outline import thickness
from meso_robust.simulator.tips import Tip
from meso_robust.types import Floats, Ints
from meso_robust.wording import counted

Source = Literal["stated", "estimated", "fitted", "unknown"]
"""From ``set.toml``, from still frames, from the residuals of the fit, or none of them."""
FINENESS = 1.0 / 364.0
"""Step over the characteristic length where no model says otherwise: 2.5 µm for a 1.6-mm part."""
EXACT = 1e-9
"""m: commanded positions closer than this to even motion are left out."""
CORNER = 5e-9
"""m: commanded lines that meet this closely between two samples have a corner there."""
_ENDS = 4.0  # variance of the end of a line fitted to n samples, times n over theirs
_FINER = 5.0  # by how much shorter the steps are about the instant of the first contact
_THIN = 0.2  # of the thinnest place of the part, for a longest step
_PAD = 1e-3  # s: what a shorter recording is lengthened by, at rest


@dataclass(frozen=True, slots=True, kw_only=True)
class Sigmas:
    """Standard deviations of a seen coordinate, and where they are from.

    Attributes
    ----------
    position, orientation
        In m and rad; None where unknown, to be estimated with the fit.
    position_source, orientation_source
        Where they are from.
    freedom
        Degrees of freedom of the estimate that is known least well; infinite if none is an estimate.
    """

    position: float | None
    orientation: float | None
    position_source: Source
    orientation_source: Source
    freedom: float = math.inf


def sigmas_of(recordings: RecordingSet) -> Sigmas:
    """The noise as stated, or else as still frames show it; a stated zero is taken as unknown."""
    found = estimated_sensor(recordings)
    position, orientation = found.info.position_sigma, found.info.orientation_sigma
    noise = found.noise
    counts = (
        (found.position_source, noise.x.freedom + noise.y.freedom),
        (found.orientation_source, noise.theta.freedom),
    )
    known = [count for source, count in counts if source == "estimated"]
    return Sigmas(
        position=position or None,
        orientation=orientation or None,
        position_source=found.position_source if position else "unknown",
        orientation_source=found.orientation_source if orientation else "unknown",
        freedom=min(known, default=math.inf),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Note:
    """Something about a recording that was read differently from its file."""

    file: str
    what: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prepared:
    """R recordings ready to be simulated, padded to T instants, W waypoints and P probes.

    Attributes
    ----------
    files
        R names.
    outline, shapes
        Corners (V, 2) of the part in m, and the tips.
    waypoints, times
        (R, W, P, 2) in m and (R, W) in s; every leg is one step. A probe that a recording does not
        have is parked far away.
    instants, seen
        (R, T) in s and (R, T, 3) in m and rad, θ unwrapped; NaN where not seen, and after the end.
    starts
        (R, 3) the first pose seen, moved out of the tips where it overlapped them.
    correction
        (R, T, 3) what predictions are corrected by for the length of the steps, see `corrected`;
        zero at first.
    step, time_step
        Longest displacement of a tip (m) and duration (s) of one step.
    length
        Characteristic length of the part, m.
    sigmas
        What is known of the noise.
    tips_seen
        Whether the waypoints are what the camera showed, not what was commanded.
    tip_offset
        σ in m by which the first and the last position of a tip may be off, in the direction in which it is known
        least; zero if commanded and nothing is stated of it.
    lean
        (R, P, 2, 2) what an offset is multiplied by: less across that direction than along it. Offsets of fits
        are those before that, of one σ in all directions.
    parked
        (2,) a place far from everything, m.
    notes
        What was left out, interpolated or shifted, by file.
    weights
        (R, T) by which residuals are multiplied before they are squared; None: all alike.
    """

    files: tuple[str, ...]
    outline: Floats
    shapes: tuple[Tip, ...]
    waypoints: Floats
    times: Floats
    instants: Floats
    seen: Floats
    starts: Floats
    correction: Floats
    step: float
    time_step: float
    length: float
    sigmas: Sigmas
    tips_seen: bool
    tip_offset: float
    lean: Floats
    parked: Floats
    notes: tuple[Note, ...]
    weights: Floats | None = None

    @property
    def tip_radius(self) -> float:
        """Stated radius of the tips, m."""
        return min(shape.radius for shape in self.shapes)

    @property
    def legs(self) -> Ints:
        """(R,) legs of each recording, without those that lengthen it at rest."""
        at_end = np.all(self.waypoints == self.waypoints[:, -1:], axis=(2, 3))
        at_end &= self.times >= self.times[:, -1:] - (1.0 + EXACT) * _PAD
        return np.asarray(np.maximum(np.argmax(at_end, axis=1), 1))

    @property
    def counts(self) -> Ints:
        """(R, 3) number of seen x, y and θ."""
        return np.asarray(np.sum(np.isfinite(self.seen), axis=1))


@dataclass(frozen=True, slots=True, eq=False)
class _One:
    """One recording before padding."""

    file: str
    times: Floats
    path: Floats
    instants: Floats
    seen: Floats
    start: Floats


def some_of(prepared: Prepared, rows: Ints) -> Prepared:
    """Some of the recordings.

    Parameters
    ----------
    prepared
        R recordings.
    rows
        (r,) which of them, in the order wanted.

    Returns
    -------
    Prepared
        r recordings, padded as they were.
    """
    named = {name: getattr(prepared, name)[rows] for name in _BY_RECORDING}
    weights = None if prepared.weights is None else prepared.weights[rows]
    files = tuple(prepared.files[row] for row in rows.tolist())
    return replace(prepared, files=files, weights=weights, **named)


_BY_RECORDING = ("waypoints", "times", "instants", "seen", "starts", "correction", "lean")


def prepare(
    recordings: RecordingSet, *, step: float | None = None, most_frames: int | None = None
) -> Prepared:
    """Arrange a recording set for `forward.predicted`.

    Positions of the probes are exact if they are the controller's and its log has no noise, and then
    thinned without loss; a log with noise (as stated or as even travel shows) is smoothed
    (`paths.smoothed`), as a tip that shook along the face would seem to have more friction. If they were
    seen, their scatter from frame to frame is taken out likewise, and the error that stays is as stated, or
    what the σ of positions has beyond that scatter (`Prepared.tip_offset`). Frames before the first in which
    everything is seen, and after the last with all probes, are left out; `notes` says so.

    Parameters
    ----------
    recordings
        As read.
    step
        Longest displacement of a tip in one step, m; by default `FINENESS` of the part.
    most_frames
        Most frames of each recording to compare with, evenly chosen; all by default.

    Returns
    -------
    Prepared
        R recordings in SI, padded to the longest.

    Raises
    ------
    InputError
        If a recording has no probe, too few frames, an overlap that noise does not explain, or a tip
        whose noise is not known although it was seen by the camera.
    """
    outline = np.array(recordings.part.outline)
    length = characteristic_length(outline)
    step = min(FINENESS * length if step is None else step, _THIN * thickness(outline))
    sigmas = sigmas_of(recordings)
    notes: list[Note] = []
    seen_by_camera = recordings.position_source == "camera"
    shaking = 0.0 if seen_by_camera else path_sigma(recordings)
    ones = [
        _one(unwrapped(recording), recordings, sigmas, step, shaking, notes)
        for recording in recordings.recordings
    ]
    if most_frames is not None:
        ones = [_fewer(one, most_frames) for one in ones]
    parked = 10.0 * np.max([np.abs(one.path).max() + length for one in ones]) * np.ones(2)
    probes = max(one.path.shape[1] for one in ones)
    tip = Round(recordings.tip_radius) if recordings.tip_radius > 0.0 else Point()
    legs = 1 + max(len(one.times) for one in ones)
    frames = max(len(one.instants) for one in ones)
    along, across = _tip_offsets(recordings, sigmas)
    return Prepared(
        files=tuple(one.file for one in ones),
        outline=outline,
        shapes=(tip,) * probes,
        waypoints=np.stack([_padded_path(one.path, legs, probes, parked) for one in ones]),
        times=np.stack([_padded_clock(one.times, legs) for one in ones]),
        instants=np.stack([_padded_clock(one.instants, frames) for one in ones]),
        seen=np.stack([_padded_poses(one.seen, frames) for one in ones]),
        starts=np.stack([one.start for one in ones]),
        correction=np.zeros((len(ones), frames, 3)),
        step=step * (1.0 + 1e-6),  # so that rounding does not cut a leg of one step into two
        time_step=max(0.02, 1.0 / recordings.sensor.frame_rate),
        length=length,
        sigmas=sigmas,
        tips_seen=seen_by_camera,
        tip_offset=along,
        lean=_lean(recordings, across / along if along else 1.0, probes),
        parked=parked,
        notes=tuple(notes),
    )


def _one(
    recording: Recording,
    whole: RecordingSet,
    sigmas: Sigmas,
    step: float,
    shaking: float,
    notes: list[Note],
) -> _One:
    recording = _trimmed(recording, notes)
    times, path = _motion(recording, whole, sigmas, shaking, notes)
    start = _start(recording, whole, path[0], notes)
    margin = min(5.0 * _gap_sigma(whole, sigmas), 10.0 * step)
    times, path = in_steps(times, path, np.full(len(times) - 1, step))
    steps = _steps(path, start, whole, max(margin, step), step)
    times, path = in_steps(times, path, steps)
    return _One(recording.file, times, path, recording.times, recording.poses, start)


def _trimmed(recording: Recording, notes: list[Note]) -> Recording:
    """The recording from its first whole frame to the last with all probes."""
    if not recording.probe_names:
        raise InputError(
            f"{recording.file}: no probe; a push needs at least one; leave the recording out"
        )
    probes = np.all(np.isfinite(recording.probes), axis=(1, 2))
    whole = probes & np.all(np.isfinite(recording.poses), axis=1)
    if whole.sum() < 2:
        raise InputError(
            f"{recording.file}: {counted(int(whole.sum()), 'frame')} in which part and probes are all seen; must be "
            "at least 2; leave the recording out"
        )
    first, last = int(np.argmax(whole)), len(whole) - 1 - int(np.argmax(probes[::-1]))
    if first:
        notes.append(
            Note(file=recording.file, what=f"{counted(first, 'frame')} before the first whole one")
        )
    if last < len(whole) - 1:
        left = len(whole) - 1 - last
        notes.append(
            Note(file=recording.file, what=f"{counted(left, 'frame')} after the last with probes")
        )
    kept = slice(first, last + 1)
    return Recording(
        file=recording.file,
        probe_names=recording.probe_names,
        times=recording.times[kept],
        poses=recording.poses[kept],
        probes=recording.probes[kept],
    )


def _motion(
    recording: Recording, whole: RecordingSet, sigmas: Sigmas, shaking: float, notes: list[Note]
) -> tuple[Floats, Floats]:
    """Corners of the path of the probes: (W,) s and (W, P, 2) m."""
    flat = recording.probes.reshape(len(recording.times), -1)
    seen = np.all(np.isfinite(flat), axis=1)
    if not np.all(seen):
        count = int(np.sum(~seen))
        notes.append(
            Note(file=recording.file, what=f"probes interpolated in {counted(count, 'frame')}")
        )
    times, flat = recording.times[seen], flat[seen]
    seen_by_camera = whole.position_source == "camera"
    if seen_by_camera and sigmas.position is None:
        raise InputError(
            f"{recording.file}: probes seen by a camera of unknown noise; must be known to distinguish a "
            "shaking tip from a noisy one; state sensor.position_sigma_um in set.toml"
        )
    if seen_by_camera:
        times, flat = _smoothed_as_seen(times, flat)
    elif shaking > CORNER:
        times, flat = smoothed(times, flat, shaking)
    else:
        times, flat = with_corners(times, flat, CORNER)
        kept = thinned(times, flat, EXACT)
        times, flat = times[kept], flat[kept]
    return times, flat.reshape(len(times), -1, 2)


def _smoothed_as_seen(times: Floats, flat: Floats) -> tuple[Floats, Floats]:
    """Corners of seen paths (S, 2 P) m, each weighed by its own scatter, which is largest along the needle."""
    paths = flat.reshape(len(flat), -1, 2).transpose(1, 0, 2)
    axes = np.array([scatter(path, EXACT) for path in paths])
    white = np.concatenate(list(paths @ np.linalg.inv(axes)), axis=1)
    times, white = smoothed(times, white, 1.0)
    return times, np.concatenate(list(np.array(np.split(white, len(axes), axis=1)) @ axes), axis=1)


def _tip_offsets(recordings: RecordingSet, sigmas: Sigmas) -> tuple[float, float]:
    """σ of the ends of a tip's path, along its needle and across: as stated.

    Of a seen one with what smoothing leaves of its scatter. One of which nothing is stated is off as the part
    is, by what of σ is no scatter.
    """
    sensor = recordings.sensor
    along = sensor.tip_offset
    across = along if sensor.tip_offset_across is None else sensor.tip_offset_across
    if recordings.position_source != "camera":
        return along or 0.0, across or 0.0
    paths = [one.probes.reshape(len(one.times), -1) for one in recordings.recordings]
    seen = [path[np.all(np.isfinite(path), axis=1)] for path in paths]
    white = float(np.mean([roughness(path) ** 2 for path in seen]))
    frames = float(np.median([len(path) for path in seen]))
    stays = max((sigmas.position or 0.0) ** 2 - white, 0.0)
    one, other = (
        float(np.sqrt((stays if told is None else told**2) + _ENDS * white / frames))
        for told in (along, across)
    )
    return one, other


def _lean(recordings: RecordingSet, ratio: float, probes: int) -> Floats:
    """(R, P, 2, 2) of offsets across a tip's direction over those along it; of no direction where none is told."""
    lean = np.tile(np.eye(2), (len(recordings.recordings), probes, 1, 1))
    for of, recording in zip(lean, recordings.recordings, strict=True):
        for p, angle in enumerate(recording.tip_directions or ()):
            way = np.array([np.cos(angle), np.sin(angle)])
            of[p] = ratio * np.eye(2) + (1.0 - ratio) * np.outer(way, way)
    return lean


def _gap_sigma(whole: RecordingSet, sigmas: Sigmas) -> float:
    """Standard deviation of the seen distance between a tip and the farthest edge, m."""
    position = sigmas.position or 0.0
    arm = characteristic_length(np.array(whole.part.outline)) * (sigmas.orientation or 0.0)
    tip = position if whole.position_source == "camera" else 0.0
    return float(np.sqrt(position**2 + arm**2 + tip**2))


def _start(recording: Recording, whole: RecordingSet, tips: Floats, notes: list[Note]) -> Floats:
    """The first pose, out of the tips that it seems to overlap."""
    start = recording.poses[0].copy()
    radii = np.full((1, len(tips)), whole.tip_radius)
    shift, left = freed(start[None], tips[None], np.array(whole.part.outline)[None], radii)
    size = float(np.hypot(*shift[0]))
    # judged by the tip, as `recordings` does: the way out of two of them is longer, and smoothing moves them
    seen = recording.probes[:1]
    depth = -float(gaps(np.array(whole.part.outline), start[None], seen, whole.tip_radius).min())
    most = OVERLAP * characteristic_length(np.array(whole.part.outline))
    if left[0] > EXACT or depth > most:
        raise InputError(
            f"{recording.file}: at the first whole frame a tip is {1e6 * depth:.3g} µm inside the "
            f"part; must not exceed {OVERLAP:g} of its size = {1e6 * most:.3g} µm; check "
            "part, tip radius, units and the sign of y, or leave the recording out"
        )
    if size > 0.0:
        what = f"first pose moved by {1e6 * size:.3g} µm out of a tip that it overlapped"
        notes.append(Note(file=recording.file, what=what))
    start[:2] += shift[0]
    return start


def _steps(path: Floats, start: Floats, whole: RecordingSet, margin: float, step: float) -> Floats:
    """(W − 1,) steps for the legs of a path: short about the first contact with the part at rest."""
    outline = np.array(whole.part.outline)[None]
    cos, sin = np.cos(start[2]), np.sin(start[2])
    offset = path - start[:2]
    own = np.stack(
        [
            cos * offset[..., 0] + sin * offset[..., 1],
            cos * offset[..., 1] - sin * offset[..., 0],
        ],
        axis=-1,
    )
    gap = distances(outline, own.reshape(-1, 2))[0].reshape(own.shape[:2]) - whole.tip_radius
    near = np.abs(gap) <= margin
    touched = np.logical_or.accumulate(gap < -margin, axis=0)
    close = np.any(near & ~touched, axis=1)
    return np.where(close[:-1] | close[1:], step / _FINER, step)


def _fewer(one: _One, most: int) -> _One:
    """The recording with evenly chosen frames."""
    if len(one.instants) <= most:
        return one
    kept = np.unique(np.linspace(0, len(one.instants) - 1, most).round().astype(int))
    return _One(one.file, one.times, one.path, one.instants[kept], one.seen[kept], one.start)


def _padded_clock(times: Floats, count: int) -> Floats:
    more = count - len(times)
    return np.append(times, times[-1] + _PAD * np.arange(1, more + 1) / max(more, 1))


def _padded_path(path: Floats, count: int, probes: int, parked: Floats) -> Floats:
    away = np.tile(-parked, (len(path), probes - path.shape[1], 1))
    wide = np.concatenate([path, away], axis=1)
    return np.concatenate([wide, np.repeat(wide[-1:], count - len(wide), axis=0)])


def _padded_poses(poses: Floats, count: int) -> Floats:
    return np.vstack([poses, np.full((count - len(poses), 3), np.nan)])
