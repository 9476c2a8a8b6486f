"""One phase of a run: the motion in one mode up to the next event or the end of the move."""

import numpy as np

from meso_robust.kernels import part
from meso_robust.simulator.events.balance import (
    cross,
    fill,
    is_even,
    monitor,
    pick,
    solve_three,
    velocity,
)
from meso_robust.simulator.events.channel import in_channel, start_channel
from meso_robust.simulator.events.closing import bound_in_step, bound_on_curve
from meso_robust.simulator.events.contact import Place, gap
from meso_robust.simulator.events.curve import (
    CUBIC,
    fastest_turn,
    guided_reach,
    pose_at,
    start_cubic,
    start_guided,
    start_sticking,
    start_straight,
)
from meso_robust.simulator.events.fused import sealed
from meso_robust.simulator.events.samples import sample_curve, sample_step
from meso_robust.simulator.events.scene import (
    CLOSED,
    EDGE,
    FIRST,
    HELD,
    KIND,
    SECOND,
    SEPARATE,
    STICK,
    TOUCHING,
    Scene,
    Work,
)
from meso_robust.simulator.events.search import NEGATIVE, event_value, next_contact, root
from meso_robust.simulator.events.stride import error_of, stride
from meso_robust.types import Floats

_STILL = 1e-14  # turn on the whole move below which the part only translates
_LARGEST_STEP = 0.4  # of the clock, which is the way of the fastest tip over the part's size
_SMALLEST_STEP = 1e-12  # of the clock; what needs less cannot be integrated
_FIRST_STEP = 0.1  # of the clock; the control of the error goes on from it
_ROOM = 0.02  # that a quantity must have at both ends of a step not to be looked at half-way
_SWEEPS = 4  # over the quantities, for the first of them that is negative
_TURN = 0.2  # rad, of an exact step; events are looked for at its middle and its end


@part
def advance(scene: Scene, work: Work, path: Floats, place: Place, clock: float) -> float:
    """Move the part through one phase.

    Parameters
    ----------
    scene, work
        The run, with the modes chosen.
    path
        (S + 1, 3) receives the poses at evenly spaced instants; may have no rows.
    place
        The present pose.
    clock
        The clock now.

    Returns
    -------
    float
        The clock at the event or the end of the move; if no step is small enough, minus one minus
        the clock there.
    """
    rest = work.span - clock
    work.channel[0] = 0.0
    if work.count[CLOSED] == 0:
        for k in range(3):
            work.twist[k] = 0.0
        start_straight(work, place)
        return _follow(scene, work, path, clock, rest)
    slopes = velocity(scene, work, place, clock)
    pivot, slider = _guides(scene, work)
    if pivot >= 0 and work.count[CLOSED] == 1 and is_even(work):
        rest = min(rest, start_sticking(scene, work, pivot, place, clock))
        return _follow(scene, work, path, clock, rest)
    if _translates(scene, work, rest):
        start_straight(work, place)
        return _follow(scene, work, path, clock, rest)
    channel = in_channel(scene, work)
    if slider < 0 or work.count[CLOSED] != 2 or work.count[HELD] != 3:
        pivot = -1
    work.slope[0, 0], work.slope[0, 1], work.slope[0, 2] = slopes
    return _integrate(scene, work, path, clock, (pivot, slider, channel))


@sealed
def _guides(scene: Scene, work: Work) -> tuple[int, int]:
    """Contacts of a point tip that sticks on an edge and of a tip that slips on one, or -1."""
    pivot, slider = -1, -1
    for c in range(work.count[TOUCHING]):
        if work.mode[c] == SEPARATE or work.contact[c, KIND] != EDGE:
            continue
        if work.mode[c] != STICK:
            slider = c
        elif scene.tips[work.contact[c, FIRST], 4] == 0.0:
            pivot = c
    return pivot, slider


@sealed
def _translates(scene: Scene, work: Work, rest: float) -> bool:
    """Whether all closed contacts stick and the part does not turn, so that nothing changes."""
    if abs(work.twist[2]) * rest > _STILL or work.count[HELD] < 3:
        return False
    sliding = False
    for c in range(work.count[TOUCHING]):
        sliding |= work.mode[c] not in (SEPARATE, STICK)
    return not sliding


@sealed
def _follow(scene: Scene, work: Work, path: Floats, clock: float, rest: float) -> float:
    """Go along a curve of closed form."""
    curve = work.curve
    bound = (curve[1], curve[2], curve[4], curve[5], fastest_turn(work))
    bound_on_curve(scene, work, bound, rest, clock)
    time, _ = next_contact(scene, work, rest, clock)
    sample_curve(work, path, clock, time)
    work.pose[0], work.pose[1], work.pose[2] = pose_at(work, time)
    return clock + time if clock + time < work.span - 1e-15 else work.span


@part
def _integrate(
    scene: Scene, work: Work, path: Floats, clock: float, ways: tuple[int, int, bool]
) -> float:
    """Take the motion step by step to the next event or the end of the move.

    The first slope must be there. The steps of a part that two tips guide, the numbers of whose contacts
    are given, are exact; so is the turn of one in a channel.
    """
    guides, channel = (ways[0], ways[1]), ways[2]
    slope, pose = work.slope, work.pose
    step = _FIRST_STEP
    work.before[0] = 0.0
    while clock < work.span:
        step = min(step, _LARGEST_STEP, work.span - clock)
        reach = np.inf
        if guides[0] >= 0:
            start_guided(scene, work, work.curve, guides, clock)
            reach = guided_reach(scene, work, guides)
            step = min(step, _TURN / abs(slope[0, 2]), reach)
        if channel:
            start_channel(scene, work, clock)
            step = min(step, _TURN / abs(slope[0, 2]))
        error = _try(scene, work, clock, step, guides[0] >= 0)
        if not error <= 1.0:
            step *= max(0.2, 0.9 * error**-0.125) if error < np.inf else 0.2
            if step < _SMALLEST_STEP:
                return -1.0 - clock
            continue
        time, event, slopes = _inspect(scene, work, clock, step)
        if time < step:
            return _end_at(scene, work, path, clock, (time, event))
        done, new = step, (work.trial[0], work.trial[1], work.trial[2])
        sample_step(scene, work, path, clock, step)
        pose[0], pose[1], pose[2] = new
        clock = clock + step if step < work.span - clock else work.span
        project(scene, work, clock)
        slope[0, 0], slope[0, 1], slope[0, 2] = slopes
        step *= min(6.0, 0.9 * max(error, 1e-10) ** -0.125)
        if event != 0 or done >= reach:
            return clock
    return clock


@sealed
def _try(scene: Scene, work: Work, clock: float, step: float, guided: bool) -> float:
    """Write the trial pose of a step; return its error in units of the tolerance."""
    if not guided:
        work.curve[0] = CUBIC
        stride(scene, work, clock, step)
        return error_of(work, step)
    x, y, theta = pose_at(work, step)
    work.trial[0], work.trial[1], work.trial[2] = x, y, theta
    return 0.0 if abs(theta) < np.inf else np.inf


@part
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
    if work.curve[0] == CUBIC:
        start_cubic(work, step, slopes)
    first, event = _first_negative(scene, work, count, (step, -1), clock)
    even = _change_evenly(work, count)
    if first > 0.5 * step and not even:
        event_value(scene, work, 0, 0.5 * step, clock)  # for the quantities half-way
        earlier, other = _first_negative(scene, work, count, (0.5 * step, -1), clock)
        if other >= 0:
            first, event = earlier, other
    bound_in_step(scene, work, step, slopes, clock)
    first, closing = next_contact(scene, work, first, clock)
    event = closing if closing < 0 else event + 1
    return first, event, slopes


@sealed
def _change_evenly(work: Work, count: int) -> bool:
    """Whether no quantity can turn negative between the ends of a step, and note those at its end.

    One that is `a` and `b` at the ends has two zeros between them only if its line sags by a quarter of
    (√a + √b)² half-way: by the room, or by two thirds of the change if that is four times as much.
    Lines of order one sag by 0.003 while the part turns by 0.15 rad.
    """
    even = work.before[0] > 0.0
    for k in range(count):
        start, end = work.before[1 + k], work.slack[k]
        even &= min(start, end) > _ROOM + 0.25 * abs(end - start)
        work.before[1 + k] = end
    work.before[0] = 1.0
    return bool(even)


@sealed
def _first_negative(
    scene: Scene, work: Work, count: int, found: tuple[float, int], clock: float
) -> tuple[float, int]:
    """First instant at which a quantity that is negative at the end became so, and its number.

    `found` is the end and −1. A quantity may be negative at the instant of another event although
    it is not at the end, hence all are looked at again at each earlier instant.
    """
    first, event = found
    for _ in range(_SWEEPS):
        before = first
        for k in range(count):
            if k != event and work.slack[k] < NEGATIVE:
                first = root(scene, work, k, (0.0, first), clock)
                event = k
                event_value(scene, work, k, first, clock)
        if first == before:
            break
    return first, event


@part
def _end_at(
    scene: Scene, work: Work, path: Floats, clock: float, where: tuple[float, int]
) -> float:
    """Step again up to an event, correct its instant, and move the part there."""
    time, event = where
    quantity = event if event < 0 else event - 1
    if work.curve[0] != CUBIC:
        sample_curve(work, path, clock, time)
        work.pose[0], work.pose[1], work.pose[2] = pose_at(work, time)
    elif time > 0.0:
        found = pose_at(work, time)
        stride(scene, work, clock, time)
        x, y, theta = work.trial[0], work.trial[1], work.trial[2]
        slopes = velocity(scene, work, (x, y, np.cos(theta), np.sin(theta)), clock + time)
        if abs(slopes[0]) + abs(slopes[1]) + abs(slopes[2]) < np.inf:
            start_cubic(work, time, slopes)
            time = _polish(scene, work, quantity, time, clock)
            for body in range(scene.clear.shape[0]):
                # the curve on which events were looked for is less exact than this one: a touch a
                # hair before this event may have been passed
                if event_value(scene, work, -1 - body, time, clock) < NEGATIVE:
                    time = _polish(scene, work, -1 - body, time, clock)
            found = pose_at(work, time)
            sample_step(scene, work, path, clock, time)
        else:
            # two forces on one line to the last bit: there is no velocity, and no step that ends here
            sample_curve(work, path, clock, time)
        work.pose[0], work.pose[1], work.pose[2] = found
    clock = min(clock + time, work.span)
    project(scene, work, clock)
    return clock


@sealed
def _polish(scene: Scene, work: Work, event: int, time: float, clock: float) -> float:
    """Correct the instant of an event by secants near the end of the curve, where it is exact."""
    other = time * (1.0 - 1e-4)
    f_other = event_value(scene, work, event, other, clock)
    now = time
    f = event_value(scene, work, event, now, clock)
    for _ in range(4):
        if f == f_other:
            break
        better = now - f * (now - other) / (f - f_other)
        if not abs(better - time) <= 0.01 * time:
            return time
        f_better = event_value(scene, work, event, better, clock)
        if not abs(f_better) < abs(f):  # two values that differ by rounding have no slope
            break
        other, f_other = now, f
        now, f = better, f_better
    return now


@sealed
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
