"""What the pictures of a diagnosis are drawn from."""

from __future__ import annotations

import numpy as np

from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.evidence import Evidence
from meso_robust.diagnosis.validation import Errors
from meso_robust.identification.prepared import Prepared
from meso_robust.types import Floats


def evidence(found: Diagnosis) -> Evidence:
    """Recorded and predicted motion of all recordings, those of the fit first."""
    before = [one for one in (found.trained, found.before) if one is not None]
    after = [one for one in (found.retrained, found.after) if one is not None]
    frames = max(one.poses.shape[1] for one in before)
    prepared = [one.prepared for one in before]
    return Evidence(
        files=tuple(file for one in prepared for file in one.files),
        outline=prepared[0].outline,
        tip_radius=found.recordings.tip_radius,
        instants=np.concatenate([_clock(one.instants, frames) for one in prepared]),
        seen=np.concatenate([_padded(one.seen, frames) for one in prepared]),
        tips=np.concatenate([_padded(_tips(one), frames) for one in prepared]),
        baseline=_poses(before, frames),
        extended=_poses(after, frames) if len(after) == len(before) else None,
        sigma=found.noise.sigma,
        held_out=found.before.prepared.files if found.before else (),
        extrapolation=found.extrapolation.files if found.extrapolation else (),
        null_statistics=found.detection.null_statistics,
        statistic=found.detection.statistic,
    )


def _poses(errors: list[Errors], frames: int) -> Floats:
    return np.concatenate([_padded(one.poses, frames) for one in errors])


def _padded(values: Floats, frames: int) -> Floats:
    """(R, frames, …) with NaN after the end of (R, T, …)."""
    wide = np.full((len(values), frames, *values.shape[2:]), np.nan)
    wide[:, : values.shape[1]] = values
    return wide


def _clock(instants: Floats, frames: int) -> Floats:
    """(R, frames) with the end repeated."""
    return np.pad(instants, ((0, 0), (0, frames - instants.shape[1])), mode="edge")


def _tips(prepared: Prepared) -> Floats:
    """(R, T, P, 2) m; NaN for a probe that is parked because a recording has none."""
    count, _, probes, _ = prepared.waypoints.shape
    tips = np.empty((count, prepared.instants.shape[1], probes, 2))
    for r in range(count):
        for p in range(probes):
            for axis in range(2):
                tips[r, :, p, axis] = np.interp(
                    prepared.instants[r], prepared.times[r], prepared.waypoints[r, :, p, axis]
                )
    away = np.all(np.abs(tips + prepared.parked) < 1e-9, axis=-1)
    tips[away] = np.nan
    return tips
