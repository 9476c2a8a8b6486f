"""What a fit cannot do without: frames in which everything is seen, and noise that is known."""

from __future__ import annotations

import numpy as np

from meso_robust.recordings.checks.view import View
from meso_robust.recordings.contact import OVERLAP, gaps
from meso_robust.recordings.document import SET_FILE
from meso_robust.recordings.noise import EstimatedSensor, roughness
from meso_robust.recordings.problem import Problem
from meso_robust.recordings.values import RecordingSet, unwrapped
from meso_robust.wording import counted, do

_FEWEST = 2
_NOISE = 5.0  # standard deviations by which a first pose may overlap a tip and be taken for noise
_NONE = np.zeros(0, dtype=np.intp)


def fitting_problems(view: View, sensor: EstimatedSensor) -> list[Problem]:
    """A recording without frames that show part and probes, or that begins inside a tip."""
    recording = view.recording
    if not recording.probe_names:
        return [
            view.problem(
                "no_probe",
                "error",
                _NONE,
                "no probe",
                "a push needs at least one",
                "leave the recording out, or name its probes in set.toml",
            )
        ]
    tips = np.all(np.isfinite(recording.probes), axis=(1, 2))
    whole = view.seen[tips[view.seen]]
    if whole.size < _FEWEST:
        return [
            view.problem(
                "few_frames",
                "error",
                _NONE,
                f"{counted(whole.size, 'frame')} {do(whole.size, 'show')} the part and all probes at once",
                f"at least {_FEWEST} are needed",
                "leave the recording out or record it again",
            )
        ]
    return _inside(view, sensor, whole[:1])


def _inside(view: View, sensor: EstimatedSensor, first: np.ndarray) -> list[Problem]:
    position, orientation = sensor.info.position_sigma, sensor.info.orientation_sigma
    outline, whole = view.recordings.part.outline, view.recordings
    depth = -gaps(outline, view.poses[first], view.recording.probes[first], whole.tip_radius).min()
    seen = whole.position_source == "camera"
    arm = float(np.hypot(*outline.T).max())
    deep = depth > OVERLAP * arm
    noise = np.inf  # where nobody knows how much it is
    if position and orientation:
        noise = _NOISE * float(np.hypot(np.hypot(position, arm * orientation), position * seen))
    if not (deep or depth > noise):
        return []
    return [
        view.problem(
            "overlap",
            "error" if deep else "warning",
            first,
            f"at the first whole frame a tip is {1e6 * depth:.3g} µm inside the part",
            f"must not exceed {1e6 * OVERLAP * arm:.3g} µm, an eighth of the part"
            if deep
            else f"{_NOISE:g} σ of noise are {1e6 * noise:.3g} µm",
            "check part, tip radius and units, or leave the recording out"
            if deep
            else "a sign of a wrong registration, reference point, yaw, scale or delay: see the direct "
            "tests",
        )
    ]


def noise_known_problems(recordings: RecordingSet, sensor: EstimatedSensor) -> list[Problem]:
    """Noise that is neither stated nor to be seen, where a fit or a test needs it."""
    asked = (
        ("position_sigma_um", sensor.info.position_sigma, slice(0, 2)),
        ("orientation_sigma_deg", sensor.info.orientation_sigma, slice(2, 3)),
    )
    missing = [
        key for key, sigma, columns in asked if not sigma and not _rough(recordings, columns)
    ]
    if recordings.position_source == "camera" and not sensor.info.position_sigma:
        missing = ["position_sigma_um", *missing]
    if not missing:
        return []
    return [
        Problem(
            file=SET_FILE,
            kind="noise_unknown",
            severity="error",
            value=f"{' and '.join(dict.fromkeys(missing))} not stated, and no still frames to estimate "
            "it from",
            rule="must be known to distinguish misfit from noise, and a shaking tip from a noisy one",
            advice="state it in set.toml; identify can do without it where probe positions come from the controller",
        )
    ]


def _rough(recordings: RecordingSet, columns: slice) -> bool:
    """Whether the poses show any noise while the part moves."""
    poses = (unwrapped(one).poses[:, columns] for one in recordings.recordings)
    return any(roughness(one[np.all(np.isfinite(one), axis=1)]) > 0.0 for one in poses)
