"""Recording sets made of simulated motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meso_robust.recordings.outline import Polygon, Rectangle
from meso_robust.recordings.values import PositionSource, Recording, RecordingSet, SensorInfo
from meso_robust.types import Floats


def from_simulation(
    times: Floats,
    poses: Floats,
    probes: Floats,
    *,
    part: Rectangle | Polygon,
    tip_radius: float,
    position_source: PositionSource,
    sensor: SensorInfo,
    probe_names: Sequence[str] = (),
) -> RecordingSet:
    """Make one recording of each run, ``push_00.csv`` and so on.

    Parameters
    ----------
    times
        (T,) instants in s, strictly increasing.
    poses
        (N, T, 3) x, y in m and θ in rad, world frame.
    probes
        (N, T, P, 2) centres of the tips in m, world frame. A row in which neither the part nor a
        probe is seen (NaN) is a lost frame and left out.
    part, tip_radius, position_source, sensor
        As in `RecordingSet`.
    probe_names
        P names; probe1, probe2 … if none are given.

    Returns
    -------
    RecordingSet
        N recordings.

    Raises
    ------
    ValueError
        If a shape or value is wrong, there is no run, or a run has lost all frames.
    """
    times, poses, probes = (np.asarray(a, dtype=np.float64) for a in (times, poses, probes))
    if poses.ndim != 3 or probes.ndim != 4 or len(poses) != len(probes):
        raise ValueError(
            f"poses, probes: shapes {poses.shape} and {probes.shape}; must be (N, T, 3) and "
            "(N, T, P, 2); reshape them"
        )
    names = tuple(probe_names) or tuple(f"probe{k + 1}" for k in range(probes.shape[2]))
    digits = max(2, len(str(len(poses) - 1)))
    recordings = tuple(
        _recording(f"push_{run:0{digits}d}.csv", names, times, poses[run], probes[run])
        for run in range(len(poses))
    )
    return RecordingSet(
        part=part,
        tip_radius=tip_radius,
        position_source=position_source,
        sensor=sensor,
        recordings=recordings,
    )


def _recording(
    file: str, names: tuple[str, ...], times: Floats, poses: Floats, probes: Floats
) -> Recording:
    whole = Recording(file=file, probe_names=names, times=times, poses=poses, probes=probes)
    row = np.concatenate((poses, probes.reshape(len(times), -1)), axis=1)
    kept = ~np.all(np.isnan(row), axis=1)
    if np.all(kept):
        return whole
    return Recording(
        file=file, probe_names=names, times=times[kept], poses=poses[kept], probes=probes[kept]
    )
