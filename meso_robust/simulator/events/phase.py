"""One phase of a run: the motion in one mode up to the next event or the end of the move."""

import numpy as np
import numpy.typing as npt

from meso_robust.kernels import sealed as inner
from meso_robust.simulator.events.balance import cross, fill, monitor, pick, solve_three, velocity
from meso_robust.simulator.events.contact import gap
from meso_robust.simulator.events.curve import (
    pose_at,
    start_cubic,
    start_sticking,
    start_straight,
)
from meso_robust.simulator.events.scene import (
    CLOSED,
    EDGE,
    FIRST,
    HELD,
    KIND,
    SAMPLE,
    SECOND,
    SEPARATE,
    STICK,
    TOUCHING,
    Scene,
    Work,
)
from meso_robust.simulator.events.search import NEGATIVE, event_value, next_contact, root
from meso_robust.simulator.events.stride import error_of, stride

_F = npt.NDArray[np.float64]

_STILL = 1e-14  # turn on the whole move below which the part only translates
_LARGEST_STEP = 0.4
_SMALLEST_STEP = 1e-12
_FIRST_STEP = 0.1


@inner
def advance(scene: Scene, work: Work, path: _F, clock: float) -> float:
    """Move the part through one phase.

    Parameters
    ----------
    scene, work
        The run, with the modes chosen.
    path
        (S + 1, 3) receives the poses at evenly spaced instants; may have no rows.
    clock
        The clock now.

    Returns
    -------
    float
        The clock at the event or the end of the move; if no step is small enough, minus one minus
        the clock there.
    """
    place = (work.pose[0], work.pose[1], np.cos(work.pose[2]), np.sin(work.pose[2]))
    rest = work.span - clock
    if work.count[CLOSED] == 0:
        for k in range(3):
            work.twist[k] = 0.0
        start_straight(work)
        return _follow(scene, work, path, clock, rest)
    velocity(scene, work, place, clock)
    pivot = _lone_pivot(scene, work)
    if pivot >= 0:
        rest = min(rest, start_sticking(scene, work, pivot, clock))
        return _follow(scene, work, path, clock, rest)
    if _translates(scene, work, rest):
        start_straight(work)
        return _follow(scene, work, path, clock, rest)
    return _integrate(scene, work, path, clock)


@inner
def _lone_pivot(scene: Scene, work: Work) -> int:
    """Number of the point tip that sticks on an edge as the only closed contact, or -1."""
    if work.count[CLOSED] != 1:
        return -1
    for c in range(work.count[TOUCHING]):
        if work.mode[c] == STICK and work.contact[c, KIND] == EDGE:
            return c if scene.tips[work.contact[c, FIRST], 4] == 0.0 else -1
    return -1


@inner
def _translates(scene: Scene, work: Work, rest: float) -> bool:
    """Whether all closed contacts stick and the part does not turn, so that nothing changes."""
    if abs(work.twist[2]) * rest > _STILL or work.count[HELD] < 3:
        return False
    sliding = False
    for c in range(work.count[TOUCHING]):
        sliding |= work.mode[c] not in (SEPARATE, STICK)
    return not sliding


@inner
def _follow(scene: Scene, work: Work, path: _F, clock: float, rest: float) -> float:
    """Go along a curve of closed form."""
    speed = 0.0
    if work.curve[0] > 0.0:
        speed = np.hypot(work.curve[4], work.curve[5]) + 2.0 * work.reach * work.curve[8]
    elif work.count[CLOSED] > 0:
        speed = np.hypot(work.curve[4], work.curve[5])
    time, _ = next_contact(scene, work, rest, speed, clock)
    _sample_curve(scene, work, path, clock, time)
    work.pose[0], work.pose[1], work.pose[2] = pose_at(work, time)
    return clock + time if clock + time < work.span - 1e-15 else work.span


@inner
def _instant(work: Work, path: _F, sample: int) -> float:
    """The clock at a sample of the path."""
    return float(work.span * sample / (path.shape[0] - 1))


@inner
def _sample_curve(scene: Scene, work: Work, path: _F, clock: float, length: float) -> None:
    """Write the samples that fall on a curve of closed form."""
    while work.count[SAMPLE] < path.shape[0]:
        sample = work.count[SAMPLE]
        time = _instant(work, path, sample) - clock
        if time > length:
            break
        path[sample, 0], path[sample, 1], path[sample, 2] = pose_at(work, time)
        work.count[SAMPLE] = sample + 1


@inner
def _sample_stride(scene: Scene, work: Work, path: _F, clock: float, length: float) -> None:
    """Write the samples that fall in a Runge-Kutta step, each with a shorter step of its own."""
    while work.count[SAMPLE] < path.shape[0]:
        sample = work.count[SAMPLE]
        time = _instant(work, path, sample) - clock
        if time > length:
            break
        stride(scene, work, clock, time)
        for m in range(3):
            path[sample, m] = work.trial[m]
        work.count[SAMPLE] = sample + 1


@inner
def _integrate(scene: Scene, work: Work, path: _F, clock: float) -> float:
    """Integrate the motion to the next event or the end of the move."""
    slope, pose = work.slope, work.pose
    place = (pose[0], pose[1], np.cos(pose[2]), np.sin(pose[2]))
    slope[0, 0], slope[0, 1], slope[0, 2] = velocity(scene, work, place, clock)
    step = _FIRST_STEP
    while clock < work.span:
        step = min(step, _LARGEST_STEP, work.span - clock)
        stride(scene, work, clock, step)
        error = error_of(work, step)
        if not error <= 1.0:
            step *= max(0.2, 0.9 * error**-0.125) if error < np.inf else 0.2
            if step < _SMALLEST_STEP:
                return -1.0 - clock
            continue
        time, event, slopes = _inspect(scene, work, clock, step)
        if time < step:
            return _end_at(scene, work, path, clock, (time, event))
        new = (work.trial[0], work.trial[1], work.trial[2])
        _sample_stride(scene, work, path, clock, step)
        pose[0], pose[1], pose[2] = new
        clock = clock + step if step < work.span - clock else work.span
        project(scene, work, clock)
        slope[0, 0], slope[0, 1], slope[0, 2] = slopes
        step *= min(6.0, 0.9 * max(error, 1e-10) ** -0.125)
        if event != 0:
            return clock
    return clock


@inner
def _inspect(
    scene: Scene, work: Work, clock: float, step: float
) -> tuple[float, int, tuple[float, float, float]]:
    """Look for events in a step that is accurate.

    Returns the instant and the number of the first (the step and 0 if none) and the slopes at the
    end of the step.
    """
    x, y, theta = work.trial[0], work.trial[1], work.trial[2]
    place = (x, y, np.cos(theta), np.sin(theta))
    slopes = velocity(scene, work, place, clock + step)
    count = monitor(scene, work, place, clock + step)
    start_cubic(work, step, slopes)
    first, event = _first_negative(scene, work, count, (0.0, step), clock)
    if event < 0:
        event_value(scene, work, 0, 0.5 * step, clock)  # for the quantities half-way
        first, event = _first_negative(scene, work, count, (0.0, 0.5 * step), clock)
        first = step if event < 0 else first
    speed = _fastest(scene, work, slopes)
    first, closing = next_contact(scene, work, first, speed, clock)
    event = closing if closing < 0 else event + 1
    return first, event, slopes


@inner
def _fastest(scene: Scene, work: Work, slopes: tuple[float, float, float]) -> float:
    """Bound of the speed of the points of the part in a step, from those at its ends.

    A step is accurate only if it is short against the changes of speed, hence a small margin.
    """
    here = np.hypot(work.slope[0, 0], work.slope[0, 1]) + work.reach * abs(work.slope[0, 2])
    there = np.hypot(slopes[0], slopes[1]) + work.reach * abs(slopes[2])
    return float(1.5 * max(here, there))


@inner
def _first_negative(
    scene: Scene, work: Work, count: int, bracket: tuple[float, float], clock: float
) -> tuple[float, int]:
    """First instant in the bracket at which a quantity that is negative at its end became so."""
    low, high = bracket
    event = -1
    for k in range(count):
        if work.slack[k] < NEGATIVE:
            high = root(scene, work, k, (low, high), clock)
            event = k
            event_value(scene, work, k, high, clock)
    return high, event


@inner
def _end_at(scene: Scene, work: Work, path: _F, clock: float, where: tuple[float, int]) -> float:
    """Step again up to an event, correct its instant, and move the part there."""
    time, event = where
    quantity = event if event < 0 else event - 1
    if time > 0.0:
        stride(scene, work, clock, time)
        place = (work.trial[0], work.trial[1], np.cos(work.trial[2]), np.sin(work.trial[2]))
        slopes = velocity(scene, work, place, clock + time)
        start_cubic(work, time, slopes)
        time = _polish(scene, work, quantity, time, clock)
        ended = pose_at(work, time)
        _sample_stride(scene, work, path, clock, time)
        work.pose[0], work.pose[1], work.pose[2] = ended
    clock = min(clock + time, work.span)
    project(scene, work, clock)
    return clock


@inner
def _polish(scene: Scene, work: Work, event: int, time: float, clock: float) -> float:
    """Correct the instant of an event by secants near the end of the curve, where it is exact."""
    other = time * (1.0 - 1e-4)
    f_other = event_value(scene, work, event, other, clock)
    now = time
    f = event_value(scene, work, event, now, clock)
    for _ in range(4):
        if f == f_other or abs(f) < 1e-16:
            break
        better = now - f * (now - other) / (f - f_other)
        if not abs(better - time) <= 0.01 * time:
            return time
        other, f_other = now, f
        now = better
        f = event_value(scene, work, event, now, clock)
    return now


@inner
def project(scene: Scene, work: Work, clock: float) -> None:
    """Take the part back to the closed contacts by the shortest way."""
    pose = work.pose
    place = (pose[0], pose[1], np.cos(pose[2]), np.sin(pose[2]))
    picked, wanted = work.picked, work.force
    held = 0
    for k in range(work.count[HELD]):
        if work.basis[k] % 2 == 0:
            c = work.basis[k] // 2
            fill(scene, work, c, place, clock)
            kind, i, j = work.contact[c, KIND], work.contact[c, FIRST], work.contact[c, SECOND]
            picked[held] = work.basis[k]
            wanted[held] = -gap(scene, kind, i, j, place, clock)
            held += 1
    if held == 0:
        return
    a = pick(work.row, picked[0])
    if held == 1:
        part = wanted[0] / (a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
        d = (part * a[0], part * a[1], part * a[2])
    else:
        b = pick(work.row, picked[1])
        last = cross(a, b) if held == 2 else pick(work.row, picked[2])
        wanted[2] = 0.0 if held == 2 else wanted[2]
        d = solve_three(a, b, last, (wanted[0], wanted[1], wanted[2]))
    pose[0] += place[2] * d[0] - place[3] * d[1]
    pose[1] += place[3] * d[0] + place[2] * d[1]
    pose[2] += d[2]
