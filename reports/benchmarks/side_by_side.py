"""The same push by this package and its peers: accuracy beside time."""

from collections.abc import Callable
from functools import partial

import numpy as np
import numpy.typing as npt

from reports.benchmarks.mujoco_push import SETTINGS, mujoco_push
from reports.benchmarks.one_push import OUTPUTS, Ground, converged, errors, grounds
from reports.benchmarks.own_push import (
    LIMIT,
    RUNS,
    accurate_steps,
    follow_times,
    followed,
    step_times,
    stepped,
)
from reports.benchmarks.pymunk_push import FITTED, pymunk_push, torque_radius
from reports.benchmarks.timing import Clock, number, reached, table

F = npt.NDArray[np.float64]
Row = tuple[str, ...]

_HEADS = (
    "simulator", "steps", "ms (CPU time)", "ms (wall clock)", "x, y (mm)", "θ (deg)",
    "position off by", "rotation off by",
)  # fmt: skip
_FINE = 25_600
_NOTES = [
    "Converged: SciPy's root finding for the sticking contact and Runge-Kutta steps of order 8, which "
    "share nothing with the package. MuJoCo: free joint, elliptic cone, the box on small feet; "
    "quasi-static only as far as inertia and tipping are small, hence the slow and slippery lines. "
    "Pymunk has no support of this kind; its fitted line has a torque limit chosen to give the rotation "
    "on four corners, so that its agreement there is no prediction (see three points).",
    "",
]


def _row(name: str, steps: str, clock: Clock | None, pose: F, exact: F) -> Row:
    """One line of a comparison."""
    times = ("", "") if clock is None else (number(1e3 * clock.cpu), number(1e3 * clock.wall))
    off = [f"{number(value)} %" for value in errors(pose, exact)]
    where = f"{pose[0]:.4f}, {pose[1]:.4f}"
    return name, steps, *times, where, f"{pose[2]:.4f}", *off


def _own(ground: Ground, exact: F) -> tuple[list[Row], tuple[float, float]]:
    """Lines of the time stepper, and its times at the accuracy asked for: one call, in a batch; ms."""
    rows = []
    fewest = accurate_steps(ground, exact)
    for steps in sorted({50, OUTPUTS, fewest}):
        alone, each = step_times(ground, steps)
        pose = stepped(ground, steps)
        mark = f", fewest within {LIMIT} %" if steps == fewest else ""
        rows.append(_row(f"meso-robust, one call{mark}", str(steps), alone, pose, exact))
        rows.append(_row(f"the same, a run of {RUNS}", str(steps), each, pose, exact))
        if steps == fewest:
            times = (1e3 * alone.cpu, 1e3 * each.cpu)
    pose = stepped(ground, _FINE)
    rows.append(_row("meso-robust, very fine", str(_FINE), None, pose, exact))
    return rows, times


def _events(exact: F) -> tuple[list[Row], float]:
    """Lines of the event-driven engine, and its time for a run of a batch without outputs, µs."""
    pose, (alone, each, plain) = followed(), follow_times()
    rows = [
        _row("meso-robust, event-driven, one call", "", alone, pose, exact),
        _row(f"the same, a run of {RUNS}", "", each, pose, exact),
        _row(f"the same without outputs, a run of {RUNS}", "", plain, pose, exact),
    ]
    return rows, 1e6 * plain.cpu


def _peers(ground: Ground, exact: F) -> list[Row]:
    """Lines of MuJoCo and pymunk."""
    tries: list[tuple[str, int, Callable[[], tuple[F, Clock]]]] = [
        (f"MuJoCo, {setting.name}", setting.steps, partial(mujoco_push, ground, setting))
        for setting in SETTINGS
    ]
    own = torque_radius(ground)
    for radius, why in ((own, "the support's"), (FITTED, "fitted")):
        for steps in (OUTPUTS, 10 * OUTPUTS):
            name = f"pymunk, torque radius {radius:.3g} mm, {why}"
            tries.append((name, steps, partial(pymunk_push, radius, steps)))
    rows: list[Row] = []
    for name, steps, work in tries:
        try:
            pose, clock = work()
        except ImportError:
            rows.append((name, "not installed", *[""] * 6))
        else:
            rows.append(_row(name, str(steps), clock, pose, exact))
    return rows


def section(peers: bool) -> list[str]:
    """Lines of this part of the report."""
    lines: list[str] = []
    goals: list[Row] = []
    for ground, limit in zip(grounds(), (None, 1.0, 0.1), strict=True):
        exact = converged(ground)
        rows = [_row("converged (SciPy)", "", None, exact, exact)]
        own, times = _own(ground, exact)
        rows += own
        if limit is not None:
            for time, how in zip(times, ("one call", f"a run of {RUNS}"), strict=True):
                name = f"{ground.name}, time stepper, {how} (ms)"
                goals.append((name, number(time), *reached(time, limit, most=True)))
        if not len(ground.points):
            followed_rows, micros = _events(exact)
            rows += followed_rows
            name = f"film, event-driven, round tip, no outputs, a run of {RUNS} (µs)"
            goals.append((name, number(micros), *reached(micros, 20.0, most=True)))
        elif peers:
            rows += _peers(ground, exact)
        lines += table(f"Push of 1 mm with {OUTPUTS} outputs: {ground.name}", _HEADS, rows)
    heads = ("push of 1 mm, CPU time", "value", "target", "reached")
    lines += table(f"Time at an error of at most {LIMIT} %", heads, goals)
    return lines + _NOTES
