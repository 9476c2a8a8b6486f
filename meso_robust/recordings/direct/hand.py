"""A part that two tips push stands still in their frame, unless the camera is late, turned or out of scale.

With the hand at h(t), turned by φ(t), a part that it carries is at h + R(φ) b with heading φ + β, the
same b and β throughout a push. A camera that is late by τ, turned by ψ and stretches lengths by D shows it at
(1 + D + ψ J) (h + R b) of t - τ. All follow from least squares, b and β of every push free.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from meso_robust.recordings.contact import size
from meso_robust.recordings.direct.finding import Finding, possible
from meso_robust.recordings.direct.pushing import Moving
from meso_robust.recordings.direct.selection import Columns, Comparison, fitted, selected
from meso_robust.recordings.rules import DEG, UM
from meso_robust.recordings.values import RecordingSet
from meso_robust.types import Floats, Ints

_ENDS = 0.2  # of a push at either end: the second tip comes to the part, or leaves it
_FEWEST = 8  # frames of a push
_MOST = 80
_RIGID = 0.02  # of the tips' distance, by which a hand may change it
_LATEST = 1.0  # s
_STEP_S = 0.05  # s on either side that the hand's velocity is taken over
_LATENCY = "camera_latency"
_PASSES = 4
_MS, _PERCENT = 1e-3, 1e-2

_Rows: TypeAlias = Callable[[float], tuple[Floats, dict[str, Columns]]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HandTest(Comparison):
    """Where the part stands in the hand's frame, less its mean in every push.

    Its rows are x, y and θ times half the part's size.
    """


@dataclass(frozen=True, slots=True, eq=False)
class _Push:
    """Frames of one push: (n,) s, (n, 3) seen poses, and the hand's whole (T,) s and (T, 3) way."""

    number: int
    times: Floats
    poses: Floats
    clock: Floats
    hand: Floats


def hand_test(recordings: RecordingSet, runs: tuple[Moving, ...]) -> HandTest | None:
    """Explain how a part wanders in the frame of a hand of two tips.

    Parameters
    ----------
    recordings
        The set.
    runs
        `moving` of each of its recordings.

    Returns
    -------
    HandTest or None
        None where no two tips at a constant distance move the part together, or the camera sees them.
    """
    whole = size(recordings.part.outline)
    pushes = [push for k, run in enumerate(runs) if (push := _push(k, run, whole))]
    if not pushes or recordings.position_source == "camera":
        return None
    # nobody turns a camera about the origin of a robot that stands beside what it shows
    places = np.concatenate([push.poses[:, :2] for push in pushes])
    middle = 0.5 * (places.min(axis=0) + places.max(axis=0))
    numbers = np.concatenate([np.full(3 * len(push.times), push.number) for push in pushes])
    groups = np.unique(numbers, return_inverse=True)[1]

    def rows(late: float) -> tuple[Floats, dict[str, Columns]]:
        blocks = [_rows(push, late, 0.5 * whole, middle) for push in pushes]
        values = np.concatenate([block[0] for block in blocks])
        return values, _named(np.concatenate([block[1] for block in blocks]))

    def allowed(effect: str, key: str, value: float) -> bool:
        return possible(effect, key, value, whole / UM)

    def allowed_beside(effect: str, key: str, value: float) -> bool:
        return effect == _LATENCY or allowed(effect, key, value)  # what is left of it may be less

    before, candidates = rows(0.0)
    first = selected(before, groups, candidates, allowed)
    names = tuple(step.effect for step in first.steps)
    late = 0.0
    if _LATENCY in names:  # it enters by the hand's place, which is no straight line in time
        late = _converged(rows, groups, names, late)
        values, candidates = rows(late)
        again = selected(values, groups, candidates, allowed_beside, fixed=(_LATENCY,))
        steps = tuple(step for step in first.steps if step.effect == _LATENCY) + again.steps
        names = tuple(step.effect for step in steps)
        late = _converged(rows, groups, names, late)
    else:
        steps = first.steps
    values, candidates = rows(late)
    estimates, residual = fitted(values, groups, {name: candidates[name] for name in names})
    shift = {_LATENCY: late / _MS}
    findings = tuple(
        Finding(
            test="hand",
            effect=step.effect,
            estimates=tuple(
                replace(
                    one,
                    value=one.value + shift.get(step.effect, 0.0),
                    low=one.low + shift.get(step.effect, 0.0),
                    high=one.high + shift.get(step.effect, 0.0),
                )
                for one in estimates[step.effect]
            ),
            before=step.before,
            after=step.after,
            p_value=step.p_value,
            alike=step.alike,
        )
        for step in steps
    )
    return HandTest(recording=numbers, before=before, after=residual, findings=findings)


def _converged(rows: _Rows, groups: Ints, names: tuple[str, ...], late: float) -> float:
    """The latency in s that leaves nothing of itself to a linear fit of all that was found."""
    for _ in range(_PASSES):
        values, candidates = rows(late)
        estimates, _ = fitted(values, groups, {name: candidates[name] for name in names})
        late = float(np.clip(late + _MS * estimates[_LATENCY][0].value, 0.0, _LATEST))
    return late


def _named(columns: Floats) -> dict[str, Columns]:
    return {
        _LATENCY: Columns(("time_ms",), columns[:, :1]),
        "camera_anisotropy": Columns(("x_percent", "y_percent"), columns[:, 1:3]),
        "camera_scale": Columns(("percent",), columns[:, 1:3].sum(axis=1, keepdims=True)),
        "registration_shift": Columns(("x_um", "y_um"), columns[:, 3:5]),
        "camera_rotation": Columns(("angle_deg",), columns[:, 5:]),
    }


def _push(number: int, run: Moving, whole: float) -> _Push | None:
    """The frames in which both tips carry the part, without its beginning and end."""
    if run.tips.shape[1] != 2 or run.frames.size < _FEWEST:
        return None
    across = run.tips[:, 0] - run.tips[:, 1]
    apart = np.hypot(across[:, 0], across[:, 1])
    if np.ptp(apart) > _RIGID * np.median(apart) or not np.median(apart) > 0.0:
        return None
    centre = 0.5 * (run.tips[:, 0] + run.tips[:, 1])
    first, last = run.times[run.frames[[0, -1]]]
    skipped = _ENDS * (last - first)
    times = run.times[run.frames]
    frames = run.frames[(times >= first + skipped) & (times <= last - skipped)]
    if frames.size < _FEWEST:
        return None
    frames = frames[np.linspace(0, frames.size - 1, min(frames.size, _MOST)).round().astype(int)]
    hand = np.column_stack((centre, np.unwrap(np.arctan2(across[:, 1], across[:, 0]))))
    return _Push(number, run.times[frames], run.poses[frames], run.times, hand)


def _rows(push: _Push, late: float, arm: float, middle: Floats) -> tuple[Floats, Floats]:
    """The part in the hand's frame, (3 n,) m, and (3 n, 6) its change by latency, stretches, shift, rotation.

    The latter is about a middle (2,), m, the stretches about the world's origin.
    """
    at = push.times - late
    hand = np.column_stack([np.interp(at, push.clock, each) for each in push.hand.T])
    step = _STEP_S
    ahead, behind = (
        np.column_stack([np.interp(at + sign * step, push.clock, each) for each in push.hand.T])
        for sign in (1.0, -1.0)
    )
    speed = (ahead - behind) / (2.0 * step)
    away = push.poses[:, :2] - hand[:, :2]
    carried = speed[:, :2] + speed[:, 2:] * np.column_stack((-away[:, 1], away[:, 0]))
    x, y = push.poses[:, :2].T
    zero, one = np.zeros(len(at)), np.ones(len(at))
    position = _turned(away, hand[:, 2])
    shifts = np.stack(
        (
            -_MS * _turned(carried, hand[:, 2]),
            _PERCENT * _turned(np.column_stack((x, zero)), hand[:, 2]),
            _PERCENT * _turned(np.column_stack((zero, y)), hand[:, 2]),
            UM * _turned(np.column_stack((one, zero)), hand[:, 2]),
            UM * _turned(np.column_stack((zero, one)), hand[:, 2]),
            # the heading's turn is constant
            DEG * _turned(np.column_stack((middle[1] - y, x - middle[0])), hand[:, 2]),
        ),
        axis=-1,
    )
    heading = arm * np.unwrap(push.poses[:, 2] - hand[:, 2])
    turns = np.column_stack((-_MS * arm * speed[:, 2], zero, zero, zero, zero, zero))
    values = np.column_stack((position, heading))
    columns = np.concatenate((shifts, turns[:, None]), axis=1)
    values, columns = values - values.mean(axis=0), columns - columns.mean(axis=0)
    return values.ravel(), columns.reshape(-1, 6)


def _turned(vectors: Floats, angles: Floats) -> Floats:
    """(n, 2) vectors of the world in frames at angles."""
    cos, sin = np.cos(angles), np.sin(angles)
    x, y = vectors.T
    return np.column_stack((cos * x + sin * y, cos * y - sin * x))
