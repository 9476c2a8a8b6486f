"""Whether a run that ended in a jam has no motion left, by plain NumPy."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import Push, PushResult
from tests.simulator.oracle import motions, turned
from tests.simulator.problems import contacts_at

F = npt.NDArray[np.float64]

MOST = 5  # contacts; 4^k modes are too many beyond


def rows_at_end(push: Push, result: PushResult, reach: float = 16.0) -> tuple[F, F]:
    """Rows (k, 8) and frictions of the step that was not taken; one segment, film diag(1, 1, ρ).

    Contacts are those of the simulator, which have their own tests; the rows are made here.
    """
    path = result.path[0]
    moved = np.flatnonzero(np.any(result.tips[0] != result.tips[0, -1], axis=(1, 2)))
    done = int(moved[-1]) + 1 if len(moved) else 0  # steps taken
    pose, unit = path[done], float(np.max(np.hypot(*_way(push).T)))
    last = np.zeros(3)
    if done:
        before = path[done - 1]
        last[:2] = turned(-before[2]) @ (pose[:2] - before[:2])
        last[2] = pose[2] - before[2]
    way = _way(push)
    found, who = contacts_at(push, pose, result.tips[0, done], way, last=last, reach=reach * unit)
    gap, n, p, d = found[:, 0], found[:, 1:3], found[:, 3:5], found[:, 5:7]
    arm = np.sqrt(push.support.tables().film[0, 5])
    m = -n
    t = np.column_stack([-m[:, 1], m[:, 0]])
    rows = np.column_stack(
        [
            (gap - np.sum(m * d, axis=1)) / unit, -np.sum(t * d, axis=1) / unit,
            m, (p[:, 0] * m[:, 1] - p[:, 1] * m[:, 0]) / arm,
            t, (p[:, 0] * t[:, 1] - p[:, 1] * t[:, 0]) / arm,
        ]
    )  # fmt: skip
    friction = np.append(push.friction[0], push.fixture.friction)
    return rows, friction[np.minimum(who, len(push.shapes))]


def _way(push: Push) -> F:
    return np.asarray((push.waypoints[0, -1] - push.waypoints[0, 0]) / push.steps)


def jam_is_real(push: Push, result: PushResult) -> str:
    """Tell whether no motion is found either, by all modes: real, false, close or too many."""
    rows, friction = rows_at_end(push, result)
    if len(rows) > MOST:
        near = rows[:, 0] < 4.0
        if np.sum(near) > MOST:
            return "too many contacts to try"
        rows, friction = rows[near], friction[near]
        found, least = motions(rows, friction)
        return "real" if not found and least > 1e-8 else "undecided: far contacts"
    found, least = motions(rows, friction)
    if found:
        return "FALSE"
    return "real" if least > 1e-8 else "close"
