"""Forces that are not zero at rest, and noise that is not what the set states."""

from __future__ import annotations

import numpy as np

from meso_robust.recordings.checks.view import View
from meso_robust.recordings.contact import gaps
from meso_robust.recordings.document import SET_FILE
from meso_robust.recordings.noise import Noise, Spread
from meso_robust.recordings.problem import Problem
from meso_robust.recordings.rules import DEG, UM
from meso_robust.recordings.values import RecordingSet

_FEWEST = 5
_SURE = 6.0  # standard errors of the mean
_SHARE = 0.02  # of the largest force
_RATIO = 3.0  # between stated and estimated noise


def force_problems(view: View) -> list[Problem]:
    """Offsets of forces while the tip that feels them is free."""
    forces, recording = view.recording.forces, view.recording
    if forces is None:
        return []
    gap = gaps(
        view.recordings.part.outline, recording.poses, recording.probes, view.recordings.tip_radius
    )
    problems = []
    for p, name in enumerate(recording.probe_names):
        known = ~np.any(np.isnan(forces[:, p]), axis=1)
        rest = forces[known & (gap[:, p] > view.margin), p]
        if len(rest) < _FEWEST:
            continue
        offset = np.median(rest, axis=0)
        error = 1.2533 * 1.4826 * np.median(np.abs(rest - offset), axis=0) / np.sqrt(len(rest))
        largest = np.quantile(np.linalg.norm(forces[known, p] - offset, axis=1), 0.98)
        if np.any(np.abs(offset) > np.maximum(_SURE * error, _SHARE * largest)):
            x, y = offset / UM
            problems.append(
                view.problem(
                    "force_offset",
                    "warning",
                    np.zeros(0, dtype=np.intp),
                    f"{name} reads ({x:.4g}, {y:.4g}) µN while it is free, median of {len(rest)} "
                    "rows",
                    f"must be zero within {100 * _SHARE:.0f} % of the largest force and its noise",
                    "subtract the offset from the columns",
                )
            )
    return problems


def noise_problems(recordings: RecordingSet, noise: Noise) -> list[Problem]:
    """Stated deviations that differ from the estimated ones by more than a factor of three.

    Less scatter than stated is for information only: what a tracker states holds errors that stay
    from frame to frame, too.
    """
    sensor = recordings.sensor
    both = [spread for spread in (noise.x, noise.y) if spread.sigma is not None]
    position = max(both, key=lambda one: one.sigma or 0.0) if len(both) == 2 else None
    asked = (
        ("position_sigma_um", sensor.position_sigma, position, UM),
        ("orientation_sigma_deg", sensor.orientation_sigma, noise.theta, DEG),
    )
    return [
        problem
        for key, stated, found, unit in asked
        if stated is not None and found is not None
        for problem in _differs(key, stated, found, unit)
    ]


def _differs(key: str, stated: float, found: Spread, unit: float) -> list[Problem]:
    if found.sigma is None:
        return []
    floor = 1e-3 * unit  # beyond what the format and any camera resolve
    ratio = max(found.sigma, floor) / max(stated, floor)
    if 1.0 / _RATIO < ratio < _RATIO:
        return []
    return [
        Problem(
            file=SET_FILE,
            kind="noise",
            severity="warning" if ratio > 1.0 else "information",
            value=f"{key} = {stated / unit:.4g}; repeatability in still frames "
            f"{found.sigma / unit:.4g} ({found.freedom} degrees of freedom)",
            rule=f"the repeatability is a part of it, so it cannot be {_RATIO:.0f} times as large"
            if ratio > 1.0
            else "the rest must be systematic error, which stays from frame to frame",
            advice="fix the key, or leave it out to have the repeatability taken"
            if ratio > 1.0
            else "none if there is such an error, else fix the key",
        )
    ]
