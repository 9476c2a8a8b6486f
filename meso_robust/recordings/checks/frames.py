"""Clock, missing frames and wrapped angles."""

from __future__ import annotations

import numpy as np

from meso_robust.recordings.checks.view import View, turn
from meso_robust.recordings.direct.clocks import regular_clock
from meso_robust.recordings.problem import Problem
from meso_robust.wording import counted

FEWEST, FEW = 2, 10
"""Seen poses below which a recording cannot be used, and below which it tells little."""
_LONG = 10  # lost frames in a row: a third of a second at 30 Hz, in which contact may change
_MANY = 0.5  # share of lost frames
_CLOCK = 20  # rows from which a clock is seen to be regular
_SINGLE, _SHARE = 8.0, 0.25  # deviations, and share of a frame, beyond which a stamp is late
_REGULAR, _RARE = 0.05, 0.05  # jitter over a frame, and share of late stamps, of a regular clock


def frame_problems(view: View) -> list[Problem]:
    """Wrong rate; late stamps; too few frames, or else missing frames."""
    return [*_rate(view), *_late(view), *(_few(view) or _gaps(view))]


def wraps(view: View) -> list[Problem]:
    """Rows at which θ leaps by about a whole turn because it is kept within one."""
    steps = np.diff(view.recording.poses[view.seen, 2])
    # half a turn is no wrap but a tracker that takes one end of the part for the other
    at = view.seen[1:][(np.abs(steps) > np.pi) & (np.abs(turn(steps)) < 0.5 * np.pi)]
    if not at.size:
        return []
    return [
        view.problem(
            "wrap",
            "information",
            at,
            f"θ leaps by a whole turn {at.size} times",
            "angles may wrap",
            "none needed; --repair makes θ continuous",
        )
    ]


def _rate(view: View) -> list[Problem]:
    if view.on_time:
        return []
    stated = view.recordings.sensor.frame_rate
    step = float(np.median(np.diff(view.times)))
    in_ms = 700.0 < step * stated < 1300.0
    return [
        view.problem(
            "frame_rate",
            "error" if in_ms else "warning",
            np.zeros(0, dtype=np.intp),
            f"steps of {step:.6g} s, that is {1.0 / step:.4g} Hz",
            f"set.toml states {stated:.6g} Hz",
            "the clock is in ms: divide it by 1000"
            if in_ms
            else "correct frame_rate_hz or the clock",
        )
    ]


def _late(view: View) -> list[Problem]:
    """Single rows whose stamp is off a clock that is regular otherwise."""
    seen = ~np.any(np.isnan(view.recording.poses), axis=1)
    seen |= np.any(np.isfinite(view.recording.probes), axis=(1, 2))
    rows = np.flatnonzero(seen)  # a row that shows nothing says nothing wrong
    if rows.size < _CLOCK:
        return []
    counts, regular = regular_clock(view.times[rows])
    off = view.times[rows] - regular
    jitter = 1.4826 * float(np.median(np.abs(off)))
    period = float(np.median(np.diff(regular) / np.diff(counts)))
    late = np.flatnonzero(np.abs(off) > max(_SINGLE * jitter, _SHARE * period))
    if not late.size or jitter > _REGULAR * period or late.size > _RARE * rows.size:
        return []
    return [
        view.problem(
            "late_stamp",
            "error",
            rows[late],
            f"{counted(late.size, 'stamp')} up to {1e3 * np.abs(off[late]).max():.3g} ms off a clock "
            f"that is regular to {1e3 * jitter:.2g} ms",
            f"must be within {100 * _SHARE:.0f} % of a frame",
            "none needed: the rows are left out",
        )
    ]


def _few(view: View) -> list[Problem]:
    count = view.seen.size
    if count >= FEW:
        return []
    return [
        view.problem(
            "few_frames",
            "error" if count < FEWEST else "warning",
            np.zeros(0, dtype=np.intp),
            f"{counted(count, 'frame')} show{'s' * (count == 1)} the part",
            f"at least {FEWEST} are needed, {FEW} to be informative",
            "leave the recording out or record it again",
        )
    ]


def _gaps(view: View) -> list[Problem]:
    """Missing rows and rows without a pose, between the first and the last seen frame."""
    steps = np.diff(view.times[view.seen])
    lost = np.maximum(np.rint(steps / view.period) - 1.0, 0.0)
    gaps = np.flatnonzero(lost)
    total, longest = float(lost.sum()), float(lost.max(initial=0.0))
    if not total:
        return []
    share = total / (total + view.seen.size)
    bad = share > _MANY or longest > _LONG
    return [
        view.problem(
            "gap",
            "warning" if bad else "information",
            np.union1d(view.seen[gaps], view.seen[gaps + 1]),
            f"{counted(int(total), 'frame')} without a pose in {counted(gaps.size, 'gap')}, "
            f"the longest of {longest:.0f}, "
            f"{100.0 * share:.0f} % of all",
            f"single frames may be lost, at most {_LONG} in a row and {100.0 * _MANY:.0f} %",
            "check lighting and tracker; contact may change in a long gap"
            if bad
            else "none needed",
        )
    ]
