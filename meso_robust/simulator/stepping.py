r"""One run of the simulator: semi-implicit steps along the paths of the tips.

The path of all tips is cut into steps, equal between two waypoints. In each step the gaps and normals
are taken at its start, the complementarity problem of `rows` is solved for the displacement of the
part, and the pose is updated. The turn of the part is not linear, so a step of length h leaves gaps
of order h², which the gap term of the next step takes back.

Displacements of tips and part are turned between world and body at an angle that is ahead of the
start by half the turn of the last step, about the middle of this one: a point that sticks then goes
where the tip goes to the third order of the step, and smooth motion is integrated to the second. With
the angle at the start, eq. (2) as printed, it is the first.

On a viscous film, without forces but those of the tips, the balance is solved in displacements:
nothing depends on the speed. A support law that is not linear is solved by its tangent (`support`)
until the twist agrees.

A step without a solution is a jam only if no contact mode solves it (`modes`), not even one that
leaves a penetration of the steps before as it is. If Lemke's method ends on a ray although a mode
holds, the solution of that mode is taken.
"""

import numpy as np

from meso_robust.kernels import part, sealed
from meso_robust.simulator.actuation import (
    COMPLIANCE,
    bending,
    crept,
    drifted,
    drive,
    lateness,
    screwed,
)
from meso_robust.simulator.advance import advance, closes, is_ambiguous
from meso_robust.simulator.case import (
    AHEAD,
    BEFORE,
    FILM,
    IDLE,
    UNIQUE,
    Case,
    Kind,
    State,
    kind_of,
)
from meso_robust.simulator.guess import forget_modes, keep_modes, recall_modes
from meso_robust.simulator.outcome import Outcome
from meso_robust.simulator.record import on_part, record_rest, record_step
from meso_robust.simulator.resistance import general_step
from meso_robust.simulator.rows import write_rows
from meso_robust.simulator.scene import find_contacts, smallest_gap
from meso_robust.simulator.support import AGE, factorise, older
from meso_robust.simulator.tables import CONTACTS, MARKS, OBSTACLES, PART, STEP, Work
from meso_robust.simulator.touch import SLOWNESS, attraction_reach, friction_of_contacts
from meso_robust.types import Floats

COMPLETED = int(Outcome.COMPLETED)
JAM = int(Outcome.JAM)
OUT_OF_RANGE = int(Outcome.OUT_OF_RANGE)
NON_UNIQUE = int(Outcome.NON_UNIQUE)

_REACH = 16.0  # units: contacts farther off are first not looked for
_HARDLY = 1e-3  # steps: tips that move less are taken as at rest when lengths are scaled
_DEEPEST = 8.0  # units: deeper than this the steps are too long for the contact
MAX_TURN = 0.05
"""Largest turn of the part in one step, rad; beyond it contact is no longer linear."""


@sealed
def run(case: Case, state: State, work: Work, pose: Floats, record: Floats) -> tuple[int, float]:
    """Push the part through one move.

    Parameters
    ----------
    case
        The run.
    state
        Its start, from `new_state`.
    work
        Workspace, from `tables.workspace`.
    pose
        (3,) x, y in m and θ in rad; the start on entry, the end on return.
    record
        (R, 5 + 5 P) table of `record`.

    Returns
    -------
    tuple
        The outcome as an integer and the deepest penetration in m.
    """
    kind = kind_of(case)
    before = state.space[BEFORE]
    outcome, deepest = COMPLETED, 0.0
    sample = int(np.int64(0))  # of a fixed type, not to compile for a literal
    forget_modes(work.marks)
    for k in range(3):
        work.step[STEP.shift + k], work.step[STEP.soft + k] = 0.0, 0.0
    if kind.plain and not factorise(case.law[FILM : FILM + 6], work.step):
        return OUT_OF_RANGE, 0.0
    for leg in range(case.legs.shape[0] - 1):
        n = int(case.legs[leg, 1])
        _start_leg(case, state, leg)
        dt = (case.legs[leg + 1, 0] - case.legs[leg, 0]) / n
        for step in range(n):
            unit = _drive(case, kind.driven, state, leg, step, n, dt)
            for k in range(3):
                before[k] = pose[k]
            outcome, gap, count = _step(case, kind, state, work, pose, dt, unit)
            deepest = max(deepest, -gap)
            if outcome != COMPLETED:
                break
            _arrive(case, state, work, count, unit, dt)
            if sample < record.shape[0]:
                end = case.legs[leg, 0] + dt * (step + 1)
                sample = record_step(
                    record, sample, end, dt, unit, before, pose, state.body, state.obstacles,
                    work.contacts, work.marks, work.step, count,
                )  # fmt: skip
        if outcome != COMPLETED:
            break
    record_rest(record, sample, pose, state.obstacles)
    if outcome == COMPLETED:
        count = find_contacts(
            case.scene, state.obstacles, pose, state.body, 0.0, work.contacts, work.marks
        )
        deepest = max(deepest, -smallest_gap(work.contacts, min(count, work.contacts.shape[0])))
    return outcome, deepest


@part
def _start_leg(case: Case, state: State, leg: int) -> None:
    """Write the friction of a leg, if it changes."""
    if case.waypoints.shape[2] > 2:
        for p in range(case.waypoints.shape[1]):
            state.obstacles[p, OBSTACLES.friction] = case.waypoints[leg, p, 2]


@sealed
def _commanded(case: Case, leg: int, p: int, within: bool, share: float) -> tuple[float, float]:
    """Command of a probe at a share of a leg, or at its end, m."""
    before, after = case.waypoints[leg, p], case.waypoints[leg + 1, p]
    if not within:
        return after[0], after[1]
    x = before[0] + (after[0] - before[0]) * share
    return x, before[1] + (after[1] - before[1]) * share


@sealed
def _before(case: Case, leg: int, p: int, time: float) -> tuple[float, float]:
    """Command of a probe at an instant that is not after a leg, or its first one, m."""
    while leg > 0 and case.legs[leg, 0] > time:
        leg -= 1
    if case.legs[leg, 0] >= time:
        return case.waypoints[0, p, 0], case.waypoints[0, p, 1]
    lasts = case.legs[leg + 1, 0] - case.legs[leg, 0]
    return _commanded(case, leg, p, True, (time - case.legs[leg, 0]) / lasts)


@part
def _drive(case: Case, driven: bool, state: State, leg: int, step: int, n: int, dt: float) -> float:
    """Write the displacements of the tips in the next step; return the unit of length."""
    square = 0.0
    share = (step + 1) / n
    obstacles = state.obstacles
    time = case.legs[leg, 0] - case.legs[0, 0] + dt * (step + 1)
    for p in range(case.waypoints.shape[1]):
        length = 0.0
        x, y = _commanded(case, leg, p, step + 1 < n, share)
        if driven:
            late = lateness(case.effects, p)
            if late > 0.0:
                x, y = _before(case, leg, p, time + case.legs[0, 0] - late)
            mount = int(obstacles[p, OBSTACLES.mount])
            mount_x, mount_y = _commanded(case, leg, mount, step + 1 < n, share)
            x = crept(case.effects, x, obstacles[p, OBSTACLES.command_x : OBSTACLES.command_y], dt)
            y = crept(case.effects, y, obstacles[p, OBSTACLES.command_y :], dt)
            played = obstacles[p, OBSTACLES.played_x : OBSTACLES.played_x + 2]
            drive(case.effects, x, y, played)
            x = played[0] + drifted(case.effects, 0, time) + screwed(case.effects, 0, mount_x)
            y = played[1] + drifted(case.effects, 1, time) + screwed(case.effects, 1, mount_y)
        for a in range(2):
            move = (x if a == 0 else y) - obstacles[p, OBSTACLES.x + a]
            obstacles[p, OBSTACLES.move_x + a] = move
            length += move * move
        square = max(square, length)
    longest, idle = np.sqrt(square), case.law[IDLE]
    # Tips that hardly move are no measure: what else moves the part goes on without them.
    return float(longest if longest > _HARDLY * idle else idle)


@part
def _step(
    case: Case, kind: Kind, state: State, work: Work, pose: Floats, dt: float, unit: float
) -> tuple[int, float, int]:
    """Take one step; return the outcome, the smallest gap at its start and the contacts."""
    reach = _REACH * unit
    if kind.pulled:
        reach += attraction_reach(case.effects)
    angle = pose[2] + case.law[AHEAD] * state.body[PART.moved + 2]
    state.body[PART.cos], state.body[PART.sin] = np.cos(angle), np.sin(angle)
    state.body[PART.place], state.body[PART.place + 1] = pose[0], pose[1]
    moved = np.inf
    while moved > reach:
        outcome, gap, count = _contacts(case, state, work, pose, reach, unit)
        if outcome == COMPLETED:
            outcome = _forces(case, kind, state, work, count, pose, dt, unit)
        if outcome == JAM and gap < 0.0:
            _let_be(work, count)
            outcome = _forces(case, kind, state, work, count, pose, dt, unit)
        if outcome != COMPLETED:
            return outcome, gap, count
        moved = _displacement(state.body, work.step, unit, case.scene.size)
        if not moved < np.inf:
            return OUT_OF_RANGE, gap, count
        if moved > reach:
            reach, moved = 2.0 * moved, np.inf
    if case.law[UNIQUE] != 0.0 and is_ambiguous(work, count):
        return NON_UNIQUE, gap, count
    keep_modes(work.marks, count)
    _displace(case, kind.plain, state.body, pose, dt)
    return COMPLETED, gap, count


@part
def _contacts(
    case: Case, state: State, work: Work, pose: Floats, reach: float, unit: float
) -> tuple[int, float, int]:
    """Find the contacts within reach, with their friction and the modes of the last step."""
    contacts, marks = work.contacts, work.marks
    count = find_contacts(case.scene, state.obstacles, pose, state.body, reach, contacts, marks)
    if count > contacts.shape[0]:
        return OUT_OF_RANGE, 0.0, 0
    work.step[STEP.contacts] = count
    gap = smallest_gap(contacts, count)
    if gap < -_DEEPEST * max(unit, case.law[IDLE]):
        return OUT_OF_RANGE, gap, count
    time, probes = state.body[PART.time], case.waypoints.shape[1]
    friction_of_contacts(case.effects, time, probes, state.obstacles, contacts, marks, count)
    recall_modes(marks, count)
    return COMPLETED, gap, count


@sealed
def _let_be(work: Work, count: int) -> None:
    """Take penetrations for touching.

    Two tips that hold the part between their friction cones cannot give back even the rounding of
    the step before; that is no jam as long as the part need not go deeper.
    """
    for c in range(count):
        work.contacts[c, CONTACTS.gap] = max(work.contacts[c, CONTACTS.gap], 0.0)
    recall_modes(work.marks, count)


@sealed
def _forces(
    case: Case,
    kind: Kind,
    state: State,
    work: Work,
    count: int,
    pose: Floats,
    dt: float,
    unit: float,
) -> int:
    """Find forces and motion of the step."""
    if not kind.plain:
        return general_step(case, kind, state, work, count, pose, dt, unit)
    if not write_rows(work.contacts, work.step, count, unit):
        return OUT_OF_RANGE
    if closes(work.contacts, work.marks, work.step, count):
        return advance(work, count)
    return COMPLETED


@sealed
def _displacement(body: Floats, w: Floats, unit: float, size: float) -> float:
    """Write the displacement of the part; return how far any point of it or a tip moves.

    Infinite if the part turns too far.
    """
    m0, m1, m2 = w[STEP.motion], w[STEP.motion + 1], w[STEP.motion + 2]
    x = unit * (w[STEP.factor] * m0 + w[STEP.factor + 1] * m1 + w[STEP.factor + 3] * m2)
    y = unit * (w[STEP.factor + 2] * m1 + w[STEP.factor + 4] * m2)
    turn = unit * w[STEP.factor + 5] * m2
    body[PART.next], body[PART.next + 1], body[PART.next + 2] = x, y, turn
    if not abs(turn) <= MAX_TURN:
        return np.inf
    return float(abs(x) + abs(y) + abs(turn) * size + unit)


@part
def _displace(case: Case, plain: bool, body: Floats, pose: Floats, dt: float) -> None:
    """Move the part."""
    cos, sin, x, y, turn = (
        body[PART.cos],
        body[PART.sin],
        body[PART.next],
        body[PART.next + 1],
        body[PART.next + 2],
    )
    body[PART.moved], body[PART.moved + 1], body[PART.moved + 2] = x, y, turn
    pose[0] += cos * x - sin * y
    pose[1] += sin * x + cos * y
    pose[2] += turn
    body[PART.time] += dt
    if plain:
        return
    body[PART.velocity] = (cos * x - sin * y) / dt
    body[PART.velocity + 1] = (sin * x + cos * y) / dt
    body[PART.velocity + 2] = turn / dt
    if case.effects[AGE] != 0.0:
        # The mean square of the slip over the area, by the film's ratio of drags.
        slip = np.sqrt(x * x + y * y + case.law[FILM + 5] * turn * turn)
        body[PART.old] = older(body[PART.old], slip, dt, case.effects)


@part
def _keep_slips(state: State, work: Work, count: int, probes: int, dt: float) -> None:
    """Keep the speeds at which tips that touch slipped along the part."""
    contacts, body = work.contacts, state.body
    x, y, turn = body[PART.moved], body[PART.moved + 1], body[PART.moved + 2]
    for p in range(probes):
        state.obstacles[p, OBSTACLES.slip] = 0.0
    for c in range(count):
        p = work.marks[c, MARKS.who]
        if p < probes and contacts[c, CONTACTS.ln] > 0.0:
            along_x = contacts[c, CONTACTS.dx] - x + turn * contacts[c, CONTACTS.py]
            along_y = contacts[c, CONTACTS.dy] - y - turn * contacts[c, CONTACTS.px]
            slid = contacts[c, CONTACTS.nx] * along_y - contacts[c, CONTACTS.ny] * along_x
            state.obstacles[p, OBSTACLES.slip] = abs(slid) / dt


@part
def _arrive(case: Case, state: State, work: Work, count: int, unit: float, dt: float) -> None:
    """Put the tips where they are at the end of the step, bent by the forces on them.

    The contacts are in the body frame at the start of the step.
    """
    probes, obstacles = case.waypoints.shape[1], state.obstacles
    for p in range(probes):
        obstacles[p, OBSTACLES.from_x], obstacles[p, OBSTACLES.from_y] = (
            obstacles[p, OBSTACLES.x],
            obstacles[p, OBSTACLES.y],
        )
        obstacles[p, OBSTACLES.x] += obstacles[p, OBSTACLES.move_x]
        obstacles[p, OBSTACLES.y] += obstacles[p, OBSTACLES.move_y]
    if case.effects[SLOWNESS] != 0.0:
        _keep_slips(state, work, count, probes, dt)
    if case.effects[COMPLIANCE] == 0.0:
        return
    cos, sin, step = state.body[PART.cos], state.body[PART.sin], work.step
    xx, xy, yy = bending(case.effects, cos, sin)
    for c in range(count):
        p = work.marks[c, MARKS.who]
        if p < probes:
            fx, fy = on_part(work.contacts, c, step[STEP.factor + 6] * unit / dt, 1.0)
            bx, by = xx * fx + xy * fy, xy * fx + yy * fy
            obstacles[p, OBSTACLES.x] -= cos * bx - sin * by
            obstacles[p, OBSTACLES.y] -= sin * bx + cos * by
