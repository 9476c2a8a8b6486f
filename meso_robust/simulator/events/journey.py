"""A whole run: choose a mode, move to its end, choose again.

A run that comes back to the same event is kept from the modes it tried there; one that still does
not get on has failed.
"""

from typing import NamedTuple

import numpy as np

from meso_robust.kernels import part
from meso_robust.simulator.events.choice import FOUND, JAM, NOT_UNIQUE, choose, code_of
from meso_robust.simulator.events.contact import list_touching, place_of
from meso_robust.simulator.events.fused import sealed
from meso_robust.simulator.events.outline import BEFORE, leave_out
from meso_robust.simulator.events.phase import advance
from meso_robust.simulator.events.scene import (
    BANNED,
    BUSY,
    CORNER,
    EVENTS,
    FIRST,
    KIND,
    LOGGED,
    POINT,
    SAMPLE,
    SECOND,
    SEPARATE,
    STUCK,
    TOUCHING,
    WALL,
    Scene,
    Work,
)
from meso_robust.simulator.events.start import settle
from meso_robust.simulator.outcome import Outcome
from meso_robust.types import Floats, Ints

_COMPLETED = int(Outcome.COMPLETED)
_JAM = int(Outcome.JAM)
_FAILURE = int(Outcome.SOLVER_FAILURE)
_OUT_OF_RANGE = int(Outcome.OUT_OF_RANGE)
_NOT_UNIQUE = int(Outcome.NON_UNIQUE)

_NEAR = 1e-10  # gaps of contacts that touch
_MOST_PHASES = 1000  # of a run; more is taken for a fault
_MOST_STUCK = 12  # events in a row without progress
_PROGRESS = 1e-12  # of the clock: less is rounding, and the run stands still
_SNAP = 1e3  # speed, in units of that of the tips


class Log(NamedTuple):
    """What a run writes beside its pose."""

    path: Floats
    """(S + 1, 3) poses at evenly spaced instants, scaled; or no rows."""
    starts: Floats
    """(L, 4) clock and pose at the start of each phase; or no rows."""
    contacts: Ints
    """(L, MOST, 4) kind, tip or corner, edge or corner, and mode of each contact; −1 for none."""


@part
def run(scene: Scene, work: Work, log: Log) -> tuple[int, float]:
    """Take the part, at the pose in `work`, through the move.

    Returns
    -------
    tuple
        The outcome as an integer and the clock at the end.
    """
    for k in range(8):
        work.count[k] = 0
    clock, leg, last = 0.0, 0, -1
    start_leg(scene, work, leg, clock)
    outcome = _COMPLETED if settle(scene, work) else _OUT_OF_RANGE
    while outcome == _COMPLETED and clock < work.whole:
        if clock >= work.span:
            leg += 1
            start_leg(scene, work, leg, clock)
            continue
        place = place_of(work)
        list_touching(scene, work, place, clock, (_NEAR, _NEAR))
        outcome = _outcome_of(choose(scene, work, place, clock))
        if outcome != _COMPLETED:
            break
        last = _note(work, log, clock, last)
        _forget_distances(scene, work)
        after = advance(scene, work, log.path, place, clock)
        outcome = _check(work, clock, after)
        clock = after if after >= 0.0 else -1.0 - after
        if outcome != _COMPLETED:
            break
    for sample in range(work.count[SAMPLE], log.path.shape[0]):
        for m in range(3):
            log.path[sample, m] = work.pose[m]
    return outcome, clock


@sealed
def start_leg(scene: Scene, work: Work, leg: int, clock: float) -> None:
    """Let the tips go on from where they are as they do in a leg."""
    work.span = work.whole
    for p in range(work.movers):
        tip = scene.tips[p]
        for k in range(2):
            tip[k] += (tip[2 + k] - scene.legs[leg, p, k]) * clock
            tip[2 + k] = scene.legs[leg, p, k]
        tip[5] = scene.legs[leg, p, 2]
        work.span = scene.legs[leg, p, 3]
    # modes that ended at once in the last leg may hold in this one
    work.count[STUCK], work.count[BANNED] = 0, 0


@sealed
def _outcome_of(choice: int) -> int:
    """Outcome that a choice of modes means for the run."""
    if choice == FOUND:
        return _COMPLETED
    if choice == JAM:
        return _JAM
    return _NOT_UNIQUE if choice == NOT_UNIQUE else _FAILURE


@sealed
def _speed(work: Work) -> float:
    """Speed of the part in units of that of the fastest tip."""
    return float(abs(work.twist[0]) + abs(work.twist[1]) + abs(work.twist[2]))


@sealed
def _check(work: Work, before: float, after: float) -> int:
    """Stop a run that does not get on; keep it from choosing the mode that ended at once."""
    if after < 0.0:
        # The step fell to nothing: the speed of the part grows without bound up to this pose, and
        # no motion goes on from it.
        return _JAM if _speed(work) > _SNAP else _FAILURE
    if not before <= after < np.inf:
        return _OUT_OF_RANGE
    if not abs(work.pose[0]) + abs(work.pose[1]) + abs(work.pose[2]) < np.inf:
        return _OUT_OF_RANGE
    if after - before > _PROGRESS:
        work.count[STUCK] = 0
        work.count[BANNED] = 0
        return _COMPLETED if work.count[EVENTS] < _MOST_PHASES else _FAILURE
    work.count[STUCK] += 1
    if work.count[BANNED] < 16:
        work.ban[work.count[BANNED]] = code_of(work)
        work.count[BANNED] += 1
    return _COMPLETED if work.count[STUCK] <= _MOST_STUCK else _FAILURE


@sealed
def _note(work: Work, log: Log, clock: float, last: int) -> int:
    """Count a phase, and log it if there is room; phases of one mode count as one."""
    label = 0
    for c in range(work.count[TOUCHING]):
        if work.mode[c] != SEPARATE:
            kind, i, j = work.contact[c, KIND], work.contact[c, FIRST], work.contact[c, SECOND]
            label = label * 1000003 + ((kind * 4 + work.mode[c]) * 4096 + i) * 4096 + j + 1
    if label == last:
        return label
    k = work.count[EVENTS]
    work.count[EVENTS] = k + 1
    if k < log.starts.shape[0]:
        work.count[LOGGED] = k + 1
        log.starts[k, 0] = clock
        for m in range(3):
            log.starts[k, 1 + m] = work.pose[m]
        for c in range(log.contacts.shape[1]):
            for m in range(3):
                log.contacts[k, c, m] = work.contact[c, m] if c < work.count[TOUCHING] else -1
            log.contacts[k, c, 3] = work.mode[c] if c < work.count[TOUCHING] else 0
    return label


@sealed
def _forget_distances(scene: Scene, work: Work) -> None:
    """Measure tips and corners anew, without what they touch in closed contacts."""
    tips = scene.tips.shape[0]
    scene.clear[:] = 0.0
    scene.left_out[:] = False
    for c in range(work.count[TOUCHING]):
        if work.mode[c] == SEPARATE:
            continue
        kind, i, j = work.contact[c, KIND], work.contact[c, FIRST], work.contact[c, SECOND]
        body = tips + i if kind == WALL else i
        scene.left_out[body, BUSY] = True
        if kind == WALL:
            leave_out(scene.walls, scene.left_out[body], j)
        else:
            leave_out(scene.edges, scene.left_out[body], j)
            if kind in (CORNER, POINT):
                leave_out(scene.edges, scene.left_out[body], int(scene.edges[j, BEFORE]))
