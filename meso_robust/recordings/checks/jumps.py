"""Poses that lie further apart than the tips could have pushed the part."""

from __future__ import annotations

import math

import numpy as np

from meso_robust.recordings.checks.view import View, turn
from meso_robust.recordings.outline import gyration
from meso_robust.recordings.problem import Problem
from meso_robust.types import Flags, Floats, Indices as Integers
from meso_robust.wording import counted

_PUSH = 3.0  # a pushed part is not faster than the tip; twice that again for what is not known
_NOISE = 8.0 * math.sqrt(2.0)  # standard deviations of a difference
_MOST = 4
_SINGLY = 10  # jumps that are listed one by one
_SHAKEN = 0.2  # of the part's radius of gyration: steps up to which it shakes, and beyond which it is lost
_SHORT = 5  # frames of a stretch that may be a mistake of the tracker


def outlying_frames(view: View) -> Integers:
    """Frames off the path that those before and after them share.

    The shortest stretch between two jumps, of five frames at most and less than half of all, is
    taken out if the frames around it then fit together, and so on. Where one frame in four jumps,
    there is no path to be off from.
    """
    kept = view.seen
    if _MOST * _breaks(view, kept).size > kept.size:
        return np.zeros(0, dtype=np.intp)
    while True:
        bounds = np.concatenate(([0], _breaks(view, kept), [kept.size]))
        lengths = np.diff(bounds)
        for k in np.argsort(lengths, kind="stable") if lengths.size > 1 else []:
            stretch = slice(int(bounds[k]), int(bounds[k + 1]))
            if lengths[k] <= _SHORT and 2 * lengths[k] < kept.size and _closes(view, kept, stretch):
                kept = np.delete(kept, stretch)
                break
        else:
            return np.setdiff1d(view.seen, kept)


def outlying_problem(view: View, frames: Integers) -> list[Problem]:
    """Say which frames are off the path."""
    if not frames.size:
        return []
    return [
        view.problem(
            "outlier",
            "error",
            frames,
            f"{frames.size} poses are off the path of the others, further than the tips push",
            f"from frame to frame at most {_allowed_text(view)}",
            "mark these poses as not seen; --repair does",
        )
    ]


def breaks(view: View) -> list[Problem]:
    """Jumps after which the part stays: the rows after them, one problem each if they are few.

    Where one frame in four jumps, and none far, the image shakes: the part is where it is seen on the whole.
    """
    at = _breaks(view, view.seen)
    if _MOST * at.size > view.seen.size:
        step = np.abs(np.diff(view.recording.poses[view.seen], axis=0))
        far, size = np.hypot(step[:, 0], step[:, 1]).max(), gyration(view.recordings.part.outline)
        if max(far, size * turn(step[:, 2]).max()) <= _SHAKEN * size:
            return [_shake(view, at, float(far))]
    pairs = [(view.seen[k - 1], view.seen[k]) for k in at.tolist()]
    if len(pairs) <= _SINGLY:
        return [_break(view, int(a), int(b)) for a, b in pairs]
    return [
        view.problem(
            "jump",
            "error",
            view.seen[at],
            f"the part jumps {counted(len(pairs), 'time')}",
            f"from frame to frame at most {_allowed_text(view)}",
            "check the tracker; leave the recording out",
        )
    ]


def _shake(view: View, at: Integers, far: float) -> Problem:
    return view.problem(
        "shake",
        "warning",
        view.seen[at],
        f"the part is seen to go to and fro in {at.size} of {view.seen.size} frames, by up to {1e6 * far:.3g} µm a frame",
        f"a tip moves it by at most {_allowed_text(view)} a frame",
        "stop what shakes: table, stage or camera; results are as uncertain as the image is",
    )


def _break(view: View, before: int, after: int) -> Problem:
    step = view.recording.poses[after] - view.recording.poses[before]
    far, angle = 1e6 * float(np.hypot(step[0], step[1])), float(np.degrees(turn(step[2:])[0]))
    half = "; the tracker may have turned a symmetric part by 180°" if abs(angle) > 150 else ""
    return view.problem(
        "jump",
        "error",
        np.array([after]),
        f"the part jumps by {far:.3g} µm and {angle:.3g}° and stays there",
        f"from frame to frame at most {_allowed_text(view)}",
        f"cut the recording in two here{half}",
    )


def _breaks(view: View, kept: Integers) -> Integers:
    """Positions in ``kept`` that cannot be reached from the one before."""
    return np.flatnonzero(~_reached(view, kept[:-1], kept[1:])) + 1


def _closes(view: View, kept: Integers, stretch: slice) -> bool:
    """Whether the frames around a stretch fit together; at an end nothing has to."""
    if stretch.start == 0 or stretch.stop == kept.size:
        return True
    ends = kept[[stretch.start - 1]], kept[[stretch.stop]]
    return bool(_reached(view, *ends)[0])


def _reached(view: View, before: Integers, after: Integers) -> Flags:
    """Whether the part could have come from one frame to another."""
    step = view.recording.poses[after] - view.recording.poses[before]
    far, angle = allowed(view, view.times[after] - view.times[before])
    near = np.hypot(step[:, 0], step[:, 1]) <= far
    return np.asarray(near & (np.abs(turn(step[:, 2])) <= angle))


def allowed(view: View, seconds: Floats) -> tuple[Floats, Floats]:
    """How far in m and rad the part may be after so many seconds.

    A tip at speed v that pushes with lever d turns the part at v d / (ρ + d²), at most v / (2 √ρ);
    √ρ is taken as half the radius of gyration about the reference point. Less than a frame counts
    as one: stamps that come in bursts are closer than what they stand for.
    """
    way = _PUSH * view.tip_speed * np.maximum(seconds, view.period)
    position, orientation = view.sigma
    turned = way / gyration(view.recordings.part.outline)
    return way + _NOISE * position, turned + _NOISE * orientation


def _allowed_text(view: View) -> str:
    far, angle = allowed(view, np.array([view.period]))
    return f"{1e6 * float(far[0]):.3g} µm and {float(np.degrees(angle[0])):.3g}°"
