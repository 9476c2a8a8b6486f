"""Forces and motion of a step with any support law, by tangents of the law until the twist agrees."""

from meso_robust.kernels import part, sealed
from meso_robust.simulator.actuation import bending
from meso_robust.simulator.advance import advance, closes
from meso_robust.simulator.case import (
    FILM,
    FILM_NOW,
    INERTIA,
    LAY,
    OFFSET,
    SURFACE,
    TANGENT,
    TWIST_LAST,
    TWIST_NEW,
    TWIST_NOW,
    WRENCH,
    Case,
    Kind,
    State,
)
from meso_robust.simulator.environment import stage_wrench
from meso_robust.simulator.motion_model import FIRST_ORDER, add_inertia
from meso_robust.simulator.outcome import Outcome
from meso_robust.simulator.residual import residual_wrench
from meso_robust.simulator.rows import write_rows
from meso_robust.simulator.support import (
    add_film,
    add_lay,
    creep_speed,
    factorise,
    film_matrix,
    pressure_slope,
    resist_dry,
    update_forces,
)
from meso_robust.simulator.tables import CONTACTS, MARKS, PART, STEP, Work
from meso_robust.simulator.touch import pull_of_tips
from meso_robust.types import Floats

COMPLETED = int(Outcome.COMPLETED)
OUT_OF_RANGE = int(Outcome.OUT_OF_RANGE)
SOLVER_FAILURE = int(Outcome.SOLVER_FAILURE)

_TWIST = 1e-9  # tip speeds: twists this close agree
_ON_THE_WAY = 0.1  # of the speed that points creep at: the same while the law is smoothed
# of the way between two new twists, how far beyond the last one to go at most, and how far back
_AHEAD, _BACK = 4.0, 0.5
_STEADY = 0.1  # a change this much smaller than the one before foretells the next one
# most of a first try: dry steps need two as a rule, against a lay eight; one may go round in a circle
_FIRST_TANGENTS = 12
_TANGENTS = 60  # most while the law is smoothed
_SECOND_TANGENTS, _LAST_TANGENTS = 30, 360  # and most of the law itself in a second and a third try
_HUNDREDS = 3  # of smoothing, from one tip speed down
_LEVELS = 4  # to a hundred, in a third try; one in the second


@part
def general_step(
    case: Case,
    kind: Kind,
    state: State,
    work: Work,
    count: int,
    pose: Floats,
    dt: float,
    unit: float,
) -> int:
    """Find forces and motion with any support law, by tangents, until the twist agrees."""
    body, twist, last = state.body, state.space[TWIST_NOW], state.space[TWIST_LAST]
    _loads(case, kind, state, work, count, pose)
    if not kind.forced and case.law[INERTIA] == 0.0 and not _must_move(work, count, unit):
        return COMPLETED
    cos, sin, vx, vy = body[PART.cos], body[PART.sin], body[PART.velocity], body[PART.velocity + 1]
    last[0], last[1], last[2] = cos * vx + sin * vy, cos * vy - sin * vx, body[PART.velocity + 2]
    for k in range(3):
        twist[k] = last[k]
    # one call for all tries: each with plain numbers of its own would be compiled once more
    levels, most = 0, _FIRST_TANGENTS
    while True:
        outcome = _from_smooth(case, kind.dry, state, work, count, dt, unit, levels, most)
        again = outcome == SOLVER_FAILURE or (levels == 0 and outcome != COMPLETED)
        if not kind.dry or levels == _LEVELS or not again:
            return outcome
        levels, most = (_LEVELS, _LAST_TANGENTS) if levels > 0 else (1, _SECOND_TANGENTS)
        for k in range(3):
            twist[k] = 0.0
        for i in range(state.dry.shape[0]):
            state.dry[i, 0], state.dry[i, 1] = 0.0, 0.0


@part
def _from_smooth(
    case: Case,
    dry: bool,
    state: State,
    work: Work,
    count: int,
    dt: float,
    unit: float,
    levels: int,
    most: int,
) -> int:
    """Solve with the law smoothed over a tip speed at first, and then less and less.

    There are so many levels of smoothing to a hundred, and at most so many tangents of the law itself.
    """
    outcome = SOLVER_FAILURE
    for level in range(_HUNDREDS * levels, -1, -1):
        smoothing = 100.0 ** (level / max(levels, 1))
        enough = most if level == 0 else _TANGENTS
        outcome = _tangents(case, dry, state, work, count, dt, unit, smoothing, enough)
    return outcome


@part
def _loads(case: Case, kind: Kind, state: State, work: Work, count: int, pose: Floats) -> None:
    """Write the film matrix, the wrench of stage and menisci, and the bending by menisci."""
    film, wrench, contacts = state.space[FILM_NOW], state.space[WRENCH], work.contacts
    if kind.changing:
        law = case.law[FILM : FILM + 6]
        film_matrix(law, case.points, case.effects, pose, state.body[PART.time], film)
        add_lay(case.law[LAY : LAY + 4], state.body[PART.cos], state.body[PART.sin], film)
    for k in range(3):
        wrench[k] = 0.0
    if kind.forced:
        cos, sin, moved = state.body[PART.cos], state.body[PART.sin], PART.velocity
        stage_wrench(case.effects, film, pose, cos, sin, wrench)
        if kind.unnamed:
            velocity = (state.body[moved], state.body[moved + 1], state.body[moved + 2])
            time = state.body[PART.time]
            residual_wrench(case.effects, film, pose, velocity, time, cos, sin, wrench)
    if not kind.pulled:
        return
    probes = case.waypoints.shape[1]
    xx, xy, yy = bending(case.effects, state.body[PART.cos], state.body[PART.sin])
    pull_of_tips(case.effects, probes, state.obstacles, contacts, work.marks, count)
    for c in range(count):
        pull = contacts[c, CONTACTS.pull]
        if pull == 0.0:
            continue
        nx, ny = contacts[c, CONTACTS.nx], contacts[c, CONTACTS.ny]
        wrench[0] += pull * nx
        wrench[1] += pull * ny
        wrench[2] += pull * (contacts[c, CONTACTS.px] * ny - contacts[c, CONTACTS.py] * nx)
        for b in range(count):
            if work.marks[b, MARKS.who] == work.marks[c, MARKS.who]:
                contacts[b, CONTACTS.dx] -= pull * (xx * nx + xy * ny)
                contacts[b, CONTACTS.dy] -= pull * (xy * nx + yy * ny)


@part
def _must_move(work: Work, count: int, unit: float) -> bool:
    """Whether a part at rest is met by a tip; if not, write that it stays."""
    for k in range(3):
        work.step[STEP.shift + k] = 0.0
    if not write_rows(work.contacts, work.step, count, unit):
        return True
    return bool(closes(work.contacts, work.marks, work.step, count))


@sealed
def _tangents(
    case: Case,
    dry: bool,
    state: State,
    work: Work,
    count: int,
    dt: float,
    unit: float,
    smoothing: float,
    most: int,
) -> int:
    """Solve with the tangent at the twist so far, until the twist agrees, if it does so soon enough.

    Dry points are smoothed over that many times the speed that they may creep at.
    """
    space, w, speed = state.space, work.step, unit / dt
    K, offset, twist, new = space[TANGENT], space[OFFSET], space[TWIST_NOW], space[TWIST_NEW]
    points, effects, kind = case.points, case.effects, case.law[INERTIA]
    surface, inertia = case.law[SURFACE : SURFACE + 6], case.law[INERTIA : INERTIA + 5]
    x, y = state.body[PART.place], state.body[PART.place + 1]
    heading = state.body[PART.cos], state.body[PART.sin], x, y
    soft = bending(effects, heading[0], heading[1])
    slope = pressure_slope(points, effects) if dry else (0.0, 0.0, 0.0)
    creep, age = smoothing * creep_speed(speed), state.body[PART.old]
    close, before = _TWIST * speed if smoothing == 1.0 else _ON_THE_WAY * creep, 0.0
    for _ in range(most):
        for k in range(6):
            K[k] = 0.0
        for k in range(3):
            offset[k] = space[WRENCH, k]
        if kind != FIRST_ORDER:
            add_film(space[FILM_NOW], K)
            if dry:
                resist_dry(
                    points,
                    surface,
                    effects,
                    slope,
                    heading,
                    age,
                    creep,
                    twist,
                    state.dry,
                    K,
                    offset,
                )
        if kind != 0.0:
            add_inertia(inertia, space[TWIST_LAST], dt, K, offset)
        outcome = _balance(work, count, K, offset, unit, dt, soft)
        if outcome != COMPLETED or not dry:
            return outcome
        m0, m1, m2 = w[STEP.motion], w[STEP.motion + 1], w[STEP.motion + 2]
        new[0] = speed * (w[STEP.factor] * m0 + w[STEP.factor + 1] * m1 + w[STEP.factor + 3] * m2)
        new[1] = speed * (w[STEP.factor + 2] * m1 + w[STEP.factor + 4] * m2)
        new[2] = speed * w[STEP.factor + 5] * m2
        change = _change(twist, new, case.scene.size)
        _go_on(twist, new, case.scene.size, change < before)
        update_forces(points, twist, new, state.dry)
        for k in range(3):
            twist[k] = new[k]
        # tangents close in on the twist evenly: the next change is to this one as this is to the last
        if change <= close or (change <= _STEADY * before and change * change <= close * before):
            return COMPLETED
        before = change
    return SOLVER_FAILURE


@part
def _balance(
    work: Work,
    count: int,
    K: Floats,
    offset: Floats,
    unit: float,
    dt: float,
    soft: tuple[float, float, float],
) -> int:
    """Solve the contacts against the resistance ``K v − offset``."""
    w = work.step
    if not factorise(K, w):
        return OUT_OF_RANGE
    _shift(w, offset, dt / unit)
    stiff = w[STEP.factor + 6] / dt
    w[STEP.soft], w[STEP.soft + 1], w[STEP.soft + 2] = (
        stiff * soft[0],
        stiff * soft[1],
        stiff * soft[2],
    )
    if not write_rows(work.contacts, w, count, unit):
        return OUT_OF_RANGE
    if closes(work.contacts, work.marks, w, count):
        return advance(work, count)
    return COMPLETED


@part
def _change(twist: Floats, new: Floats, size: float) -> float:
    """By how much two twists differ, as a speed."""
    return float(abs(new[0] - twist[0]) + abs(new[1] - twist[1]) + size * abs(new[2] - twist[2]))


@part
def _go_on(twist: Floats, new: Floats, size: float, falls: bool) -> None:
    """Go on from a twist to where changes that fall evenly lead: Anderson's method of depth one.

    D. G. Anderson 1965, doi:10.1145/321296.321305. The columns behind those of a twist hold what it was before. The
    tangent of a law that is not symmetric, such as that of a lay, is a part of its derivative only: changes
    then fall by the same share each time.
    """
    along, square = 0.0, 0.0
    for k in range(3):
        unit = size * size if k == 2 else 1.0
        change = new[k] - twist[k]
        fall = change - (new[3 + k] - twist[3 + k])
        along, square = along + unit * change * fall, square + unit * fall * fall
    share = min(max(along / square, -_AHEAD), _BACK) if falls and square > 0.0 else 0.0
    for k in range(3):
        step = new[k] - new[3 + k]
        new[3 + k], twist[3 + k] = new[k], twist[k]
        new[k] -= share * step


@part
def _shift(w: Floats, offset: Floats, scale: float) -> None:
    """Write the motion without contact, ``s' = L⁻¹ s dt / (k unit)``."""
    scale /= w[STEP.factor + 6]
    w[STEP.shift] = scale * w[STEP.factor] * offset[0]
    w[STEP.shift + 1] = scale * (w[STEP.factor + 1] * offset[0] + w[STEP.factor + 2] * offset[1])
    w[STEP.shift + 2] = scale * (
        w[STEP.factor + 3] * offset[0]
        + w[STEP.factor + 4] * offset[1]
        + w[STEP.factor + 5] * offset[2]
    )
