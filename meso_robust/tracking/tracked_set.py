"""Tracks to a recording set, with the covariances that its columns have no place for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from meso_robust.recordings import Polygon, Recording, RecordingSet, Rectangle, SensorInfo
from meso_robust.recordings.rules import DEG, UM
from meso_robust.tracking.commands import Commands
from meso_robust.types import Floats

if TYPE_CHECKING:
    from meso_robust.tracking.track import Track

_CLOCK = 6  # decimals of a second that two clocks are compared to

_PART = ("xx_um2", "xy_um2", "xt_um_deg", "yy_um2", "yt_um_deg", "tt_deg2")
_UPPER = np.triu_indices(3)


def recording_of(track: Track, file: str, commands: Commands | None = None) -> Recording:
    """One recording of a track.

    Parameters
    ----------
    track
        What was seen.
    file
        Name of its CSV file.
    commands
        The controller's positions; they keep their clock: each gets a row of its own, in which the
        part is not seen, unless a frame has the very same instant. None: the probes as seen.
    """
    if commands is None:
        return Recording(
            file=file,
            probe_names=track.names,
            times=track.times,
            poses=track.poses,
            probes=track.tips,
            alike_orientations=track.turns,
            tip_directions=_tip_directions(track),
        )
    frames, told = np.round(track.times, _CLOCK), np.round(commands.times, _CLOCK)
    times = np.union1d(frames, told)
    poses = np.full((len(times), 3), math.nan)
    tips = np.full((len(times), len(commands.names), 2), math.nan)
    poses[np.searchsorted(times, frames)] = track.poses
    tips[np.searchsorted(times, told)] = commands.tips
    return Recording(
        file=file,
        probe_names=commands.names,
        times=times,
        poses=poses,
        probes=tips,
        alike_orientations=track.turns,
    )


def sensor_of(tracks: Sequence[Track], *, tips_seen: bool) -> SensorInfo:
    """Frame rate of the first video, and the root mean square of the standard deviations of all.

    Parameters
    ----------
    tracks
        What was seen.
    tips_seen
        Whether the tips are where they were seen, so that what their places are off by is the tracker's.
    """
    covariances = np.concatenate([track.covariances[track.found] for track in tracks])
    known = len(covariances) > 0
    place = np.trace(covariances[:, :2, :2], axis1=1, axis2=2) / 2.0
    tips = _tip_spread(tracks) if tips_seen else None
    return SensorInfo(
        frame_rate=tracks[0].frames.rate,
        position_sigma=float(np.sqrt(place.mean())) if known else None,
        orientation_sigma=float(np.sqrt(covariances[:, 2, 2].mean())) if known else None,
        tip_offset=None if tips is None else tips[0],
        tip_offset_across=None if tips is None else tips[1],
    )


def _tip_spread(tracks: Sequence[Track]) -> tuple[float, float] | None:
    """σ of seen tips in the direction in which each is known least, and across it, m; None if none was seen.

    The first is along its needle, and nearly all of it is the same in every frame of a video: what the end of the
    needle looks like.
    """
    known = [_known(track, p) for track in tracks for p in range(len(track.names))]
    each = [np.median(np.linalg.eigvalsh(one), axis=0) for one in known if len(one)]
    if not each:
        return None
    across, along = np.sqrt(np.maximum(np.mean(each, axis=0), 0.0))
    return float(along), float(across)


def _tip_directions(track: Track) -> tuple[float, ...]:
    """Directions in which the seen tips are known least, rad, world frame; 0 of one that was never seen."""
    found = []
    for p in range(len(track.names)):
        known = _known(track, p)
        # of the frame in the middle by size: one in doubt does not count
        order = np.argsort(np.trace(known, axis1=1, axis2=2))
        middle = known[order[len(order) // 2]] if len(known) else np.zeros((2, 2))
        way = np.linalg.eigh(middle)[1][:, -1]
        found.append(math.atan2(way[1], way[0]) % math.pi)
    return tuple(found)


def _known(track: Track, probe: int) -> Floats:
    """(T, 2, 2) m², covariances of a tip where it was seen."""
    covariances = track.tip_covariances[:, probe]
    return covariances[np.isfinite(covariances).all(axis=(1, 2))]


def set_of(
    tracks: Sequence[Track],
    files: Sequence[str],
    part: Rectangle | Polygon,
    tip_radius: float,
    commands: Sequence[Commands] | None = None,
) -> RecordingSet:
    """Recording set of some tracks, one file each, and one table of commands each, if there are any."""
    return RecordingSet(
        part=part,
        tip_radius=tip_radius,
        position_source="camera" if commands is None else "controller",
        sensor=sensor_of(tracks, tips_seen=commands is None),
        recordings=tuple(
            recording_of(track, file, None if commands is None else commands[k])
            for k, (track, file) in enumerate(zip(tracks, files, strict=True))
        ),
    )


def covariance_text(track: Track) -> str:
    """CSV of a track's covariances, in um and deg; a row each frame, empty where nothing was seen.

    Columns: time_s, state; of the part's x, y, θ the upper triangle, row by row; of each probe as seen
    its place and the upper triangle of its covariance.
    """
    header = ["time_s", "state", *(f"part_{name}" for name in _PART)]
    for name in track.names:
        header += [f"{name}_{column}" for column in ("x_um", "y_um", "xx_um2", "xy_um2", "yy_um2")]
    units = np.array([UM, UM, DEG])
    part = (track.covariances / np.outer(units, units))[:, _UPPER[0], _UPPER[1]]
    spread = track.tip_covariances / UM**2
    tips = np.concatenate(
        (track.tips / UM, spread[..., 0, :], spread[..., 1, 1:]), axis=-1
    ).reshape(len(track.times), -1)
    rows = [",".join(header)]
    for k, time in enumerate(track.times.tolist()):
        cells = [repr(time), track.states[k], *map(_cell, part[k]), *map(_cell, tips[k])]
        rows.append(",".join(cells))
    return "\n".join(rows) + "\n"


def covariance_file(file: str) -> str:
    """Name of the file beside a recording's."""
    return f"{file.removesuffix('.csv')}_covariance.csv"


def _cell(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.6g}"
