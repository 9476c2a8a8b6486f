"""What part and tips do to each other: contacts that cannot be, and motion without contact."""

from __future__ import annotations

import numpy as np

from meso_robust.recordings.checks.view import LATE, View
from meso_robust.recordings.contact import gaps
from meso_robust.recordings.problem import Problem
from meso_robust.types import Floats, Indices as Integers

_DEEP = 0.05  # of the part's size: no calibration of the probes is so bad
_WRONG = 0.25  # of it: nor is that of the camera; the tip is not where the file says
_FEWEST = 6  # frames of a stretch in which motion can be told from noise
_MOVED = 6.0  # standard deviations of one frame
_LEAST = 1e-3  # of the part's size, and rad: less is not worth a word
_NONE = np.zeros(0, dtype=np.intp)


def contact_problems(view: View) -> list[Problem]:
    """Tips inside the part, motion untouched, nothing touched, nothing moved, probes that rest."""
    return [*_overlap(view), *_untouched(view), *_idle(view), *_probes(view)]


def _overlap(view: View) -> list[Problem]:
    poses, probes = view.recording.poses, view.recording.probes
    if not probes.shape[1]:
        return []
    # of the centre: a round tip may overlap by its radius where it is commanded into the part
    depth = -gaps(view.recordings.part.outline, poses, probes, 0.0)
    limit = max(_DEEP * view.size, _MOVED * view.sigma[0]) + view.lag
    deep = np.where(np.isnan(depth), -np.inf, depth).max(axis=1)
    frames = np.flatnonzero(deep > limit)
    if not frames.size:
        return []
    return [
        view.problem(
            "overlap",
            "error" if deep.max() > _WRONG * view.size else "warning",
            frames,
            f"the centre of a tip is up to {1e6 * deep.max():.4g} µm inside the part",
            f"must be less than {1e6 * limit:.4g} µm",
            "check outline, reference point and the frame of the probes, or a tip lifted over it",
        )
    ]


def _untouched(view: View) -> list[Problem]:
    problems = []
    for stretch in _free_stretches(view):
        moved = _moved(view, stretch)
        if np.all(moved <= 1.0):
            continue
        step = _between_thirds(view.poses[stretch])
        far, angle = 1e6 * np.hypot(step[0], step[1]), np.degrees(step[2])
        problems.append(
            view.problem(
                "untouched",
                "warning",
                stretch,
                f"the part moves by {far:.3g} µm and {angle:.3g}° while all tips are at least "
                f"{1e6 * np.min(view.gap[stretch]):.4g} µm away",
                "a part that no tip touches must not move",
                "check clock, outline and frames; else something unseen pushes it",
            )
        )
    return problems


def _free_stretches(view: View) -> list[Integers]:
    """Frames in which no tip can have touched the part, from a camera's lag after the last touch.

    Lost frames end a stretch if a tip could have come to the part and back in them.
    """
    free = view.gap > view.margin
    frames = view.seen[free[view.seen]]
    if not frames.size:
        return []
    steps, gap = np.diff(view.times[frames]), np.minimum(view.gap[frames], 1e3)
    away = steps * view.tip_speed >= gap[1:] + gap[:-1]
    unsure = np.cumsum(~free[view.seen])[free[view.seen]]  # touched or not known in between
    cut = np.flatnonzero((away & (steps > 1.5 * view.period)) | (np.diff(unsure) > 0)) + 1
    stretches = []
    for stretch in np.split(frames, cut):
        first = stretch[0] == view.seen[0]
        late = view.times[stretch] > view.times[stretch[0]] + (0.0 if first else LATE)
        kept = stretch if first else stretch[late]
        if kept.size >= _FEWEST:
            stretches.append(kept)
    return stretches


def _between_thirds(values: Floats) -> Floats:
    """From the median of the first third of the rows to that of the last."""
    third = len(values) // 3
    return np.asarray(np.median(values[-third:], axis=0) - np.median(values[:third], axis=0))


def _moved(view: View, frames: Integers) -> Floats:
    """(3,) motion from the first to the last third of some frames, 1: more than noise makes."""
    position, orientation = view.sigma
    limit = np.maximum(
        _MOVED * np.array([position, position, orientation]),
        _LEAST * np.array([view.size, view.size, 1.0]),
    )
    # the median of few frames scatters by 1.25 / √n of one
    limit = limit * max(1.0, 1.8 / np.sqrt(len(frames) // 3))
    return np.asarray(np.abs(_between_thirds(view.poses[frames])) / limit)


def _idle(view: View) -> list[Problem]:
    """Never touched, or touched and not moved."""
    gap = view.gap[np.isfinite(view.gap)]
    if gap.size < _FEWEST or np.any(_moved(view, view.seen) > 1.0):
        return []
    if np.min(gap) > view.margin:
        return [
            view.problem(
                "never_touched",
                "warning",
                _NONE,
                f"no tip comes nearer than {1e6 * np.min(gap):.4g} µm",
                "a push touches the part",
                "use the recording for noise only, or check outline and frame of the probes",
            )
        ]
    position, orientation = view.sigma
    off = np.abs(view.poses[view.seen] - np.median(view.poses[view.seen], axis=0)).max(axis=0)
    limit = np.maximum(
        _MOVED * np.array([position, position, orientation]),
        _LEAST * np.array([view.size, view.size, 1.0]),
    )
    if np.any(off > limit):
        return []
    return [
        view.problem(
            "nothing_moves",
            "warning",
            _NONE,
            "a tip touches the part, and the part does not move by more than its noise",
            "a push moves the part",
            "check that the tip keeps pushing and that the part is not stuck",
        )
    ]


def _probes(view: View) -> list[Problem]:
    """Probes that are never seen or never move."""
    places = view.recording.probes
    known = ~np.any(np.isnan(places), axis=2)
    limit = max(_MOVED * view.sigma[0], _LEAST * view.size)
    rests = [
        bool(known[:, p].any()) and float(np.ptp(places[known[:, p], p], axis=0).max()) <= limit
        for p in range(places.shape[1])
    ]
    problems = []
    for p, name in enumerate(view.recording.probe_names):
        if not known[:, p].any():
            problems.append(
                view.problem(
                    "unseen_probe",
                    "error",
                    _NONE,
                    f"{name} has no position in any row",
                    "every probe of set.toml is seen",
                    "leave it out of probes, or add its positions",
                )
            )
        elif rests[p] and len(view.times) > 1:
            problems.append(_rests(view, name, all(rests)))
    return problems


def _rests(view: View, name: str, every: bool) -> Problem:
    return view.problem(
        "still_probe",
        "warning" if every else "information",
        _NONE,
        f"{name} does not move",
        "a probe that pushes moves",
        "check its columns; the recording only shows noise"
        if every
        else "none needed if it only holds",
    )
