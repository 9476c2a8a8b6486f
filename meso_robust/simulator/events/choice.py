r"""Choice of the mode after an event: all combinations of modes of the contacts that touch.

A combination holds if its forces, slips and opening speeds have the right signs. At an event one
of them is zero as a rule; then a short way ahead in that mode decides, which is the sign of the
derivative and keeps the run from going back and forth. Combinations that hold with different
velocities make the motion not unique; none at all is a jam.
"""

import numpy as np

from meso_robust.kernels import part
from meso_robust.simulator.events.balance import (
    LARGEST,
    dot,
    fill_all,
    pick,
    solve_forces,
    solve_twist,
    speed,
    watch,
)
from meso_robust.simulator.events.contact import Place, friction
from meso_robust.simulator.events.fused import inlined
from meso_robust.simulator.events.scene import (
    BANNED,
    CLOSED,
    FIRST,
    GROUP,
    HELD,
    KIND,
    MOST,
    POINT,
    ROOM,
    SEPARATE,
    SLIP_MINUS,
    STICK,
    TOUCHING,
    Scene,
    Work,
)
from meso_robust.types import Ints

FOUND, JAM, NOT_UNIQUE, TOO_MANY = range(4)

_MANY = 8  # contacts; there are four to this power of combinations
_ZERO = 1e-9  # speeds and forces below are a tie
_AHEAD = (1e-5, 1e-7)  # of the clock; the second for modes that are short
_ZERO_AHEAD = (1e-9, 1e-11)  # what counts as zero there
_DIFFERENT = 1e-6  # of velocities
_INDEPENDENT = 1e-9  # part of a constraint that the others do not have
_BETTER = 1e-8  # a later mode must be better by this
_NO_FORCES, _NO_MOTION = -1.0, -2.0  # what fails


@part
def choose(scene: Scene, work: Work, place: Place, clock: float) -> int:
    """Choose the modes of the listed contacts at the present pose, which is `place`.

    Writes the modes and the basis of the motion that goes on.

    Returns
    -------
    int
        FOUND, JAM, NOT_UNIQUE, or TOO_MANY contacts.
    """
    touching = work.count[TOUCHING]
    if touching > _MANY:
        return TOO_MANY
    for attempt in range(2):
        count = _all_modes(scene, work, (place, clock), attempt)
        if count > 0:
            return _take_best(work, count)
    return JAM


@part
def _all_modes(scene: Scene, work: Work, now: tuple[Place, float], attempt: int) -> int:
    """Try all combinations; return how many hold (at most as many as there is room for)."""
    touching = work.count[TOUCHING]
    fill_all(scene, work, now[0], now[1], False)
    count = 0
    for code in range(4**touching):
        if _is_banned(work, code) or not _decode(scene, work, code):
            continue
        count = _try_bases(scene, work, now, (attempt, count))
    return count


@inlined
def _is_banned(work: Work, code: int) -> bool:
    """Whether the mode was tried here already and ended at once."""
    banned = False
    for k in range(work.count[BANNED]):
        banned |= work.ban[k] == code
    return bool(banned)


@inlined
def code_of(work: Work) -> int:
    """Number of the present combination of modes."""
    code = 0
    for c in range(work.count[TOUCHING] - 1, -1, -1):
        code = 4 * code + work.mode[c]
    return code


@inlined
def _decode(scene: Scene, work: Work, code: int) -> bool:
    """Write the modes of a combination; tell whether it can be one."""
    work.count[CLOSED] = 0
    for c in range(work.count[TOUCHING]):
        mode = (code >> (2 * c)) & 3
        work.mode[c] = mode
        if mode == SEPARATE:
            continue
        work.count[CLOSED] += 1
        kind = work.contact[c, KIND]
        if kind == POINT:
            if mode != STICK:
                return False
        elif (
            mode in (STICK, SLIP_MINUS)
            and friction(scene, work, kind, work.contact[c, FIRST]) == 0.0
        ):
            return False
        group = work.contact[c, GROUP]
        for other in range(c):
            if group >= 0 and work.contact[other, GROUP] == group and work.mode[other] > 0:
                return False
    return True


@inlined
def _try_bases(scene: Scene, work: Work, now: tuple[Place, float], tally: tuple[int, int]) -> int:
    """Try all bases of the present combination; `tally` is the attempt and how many hold."""
    attempt, count = tally
    pushes, picked = work.pushes, work.picked
    wrenches = _collect(work, pushes)
    rank = work.count[HELD]
    for k in range(4):
        picked[k] = k
    while picked[max(rank - 1, 0)] < max(wrenches, 1):
        for k in range(rank):
            work.basis[3 + k] = pushes[picked[k]]
        merit = _merit(scene, work, now, (attempt, wrenches > rank))
        if merit >= 0.0 and count < ROOM:
            _keep(work, count, merit)
            count += 1
        if rank == 3 and merit == _NO_MOTION:  # three constraints say it all, whatever the wrenches
            break
        if rank == wrenches or not _next_subset(picked, rank, wrenches):
            break
    return count


@inlined
def _next_subset(picked: Ints, rank: int, total: int) -> bool:
    """Step to the next choice of `rank` out of `total` numbers in rising order."""
    k = rank - 1
    while k >= 0 and picked[k] == total - rank + k:
        k -= 1
    if k < 0:
        return False
    picked[k] += 1
    for later in range(k + 1, rank):
        picked[later] = picked[later - 1] + 1
    return True


@inlined
def _collect(work: Work, pushes: Ints) -> int:
    """List the wrenches of the combination and write its independent constraints."""
    wrenches = 0
    work.count[HELD] = 0
    for c in range(work.count[TOUCHING]):
        mode = work.mode[c]
        if mode == SEPARATE:
            continue
        add_row(work, 2 * c)
        if mode == STICK:
            add_row(work, 2 * c + 1)
        if mode != SLIP_MINUS and mode != STICK:
            pushes[wrenches] = 2 * c + 1
            wrenches += 1
        else:
            pushes[wrenches] = 2 * c
            wrenches += 1
            if mode == STICK:
                pushes[wrenches] = 2 * c + 1
                wrenches += 1
    return wrenches


@inlined
def add_row(work: Work, row: int) -> None:
    """Add a constraint to the basis unless it depends on those there or there are three."""
    held = work.count[HELD]
    if held >= 3:
        return
    apart, x = work.apart, pick(work.row, row)
    whole = dot(x, x)
    for sweep in range(2 * held):
        k = sweep if sweep < held else sweep - held
        other = pick(apart, k)
        shared = dot(x, other) * apart[k, 3]
        x = (x[0] - shared * other[0], x[1] - shared * other[1], x[2] - shared * other[2])
    added = dot(x, x)
    if added < _INDEPENDENT * _INDEPENDENT * whole:
        return
    apart[held, 0], apart[held, 1], apart[held, 2] = x
    apart[held, 3] = 1.0 / added
    work.basis[held] = row
    work.count[HELD] = held + 1


@inlined
def _merit(scene: Scene, work: Work, now: tuple[Place, float], trial: tuple[int, bool]) -> float:
    """Least of what must not be negative, a short way ahead if it is zero here; below if it fails.

    Constraints that depend on each other may agree only for an instant; `trial` is the number of
    the attempt and whether there are such.
    """
    attempt, redundant = trial
    place, clock = now
    here = _least(scene, work)
    if not here >= -_ZERO:
        return here
    if here > _ZERO and not redundant:
        return here
    step, limit = _AHEAD[attempt], _ZERO_AHEAD[attempt]
    vx, vy, omega = work.twist[0], work.twist[1], work.twist[2]
    theta = work.pose[2] + step * omega
    cos, sin = np.cos(theta - 0.5 * step * omega), np.sin(theta - 0.5 * step * omega)
    x = place[0] + step * (cos * vx - sin * vy)
    y = place[1] + step * (sin * vx + cos * vy)
    after = (x, y, np.cos(theta), np.sin(theta))
    fill_all(scene, work, after, clock + step, False)
    ahead = _least(scene, work)
    fill_all(scene, work, place, clock, False)
    work.twist[0], work.twist[1], work.twist[2] = vx, vy, omega
    return ahead + limit if ahead >= -limit else _NO_FORCES


@inlined
def _least(scene: Scene, work: Work) -> float:
    """Least of what must not be negative, for rows as they were written last; or what fails."""
    solve_twist(work)
    least = np.inf
    for c in range(work.count[TOUCHING]):
        if work.mode[c] == SEPARATE:
            least = min(least, _opening(work, c))
        elif not _moves(scene, work, c):
            return _NO_MOTION
    if least < -_ZERO:
        return _NO_MOTION
    solve_forces(work)
    for k in range(work.count[HELD]):
        if not -_ZERO <= work.force[k] < LARGEST:
            return _NO_FORCES
    for k in range(watch(scene, work)):
        least = min(least, work.slack[k])
    return least if least >= -_ZERO else _NO_FORCES


@inlined
def _moves(scene: Scene, work: Work, c: int) -> bool:
    """Whether a closed contact stays closed, and sticks or slips as its mode says."""
    mode, slip = work.mode[c], speed(work, 2 * c + 1)
    if not abs(speed(work, 2 * c)) <= _ZERO:
        return False
    if mode == STICK:
        return bool(abs(slip) <= _ZERO)
    if friction(scene, work, work.contact[c, KIND], work.contact[c, FIRST]) == 0.0:
        return True
    return bool((-slip if mode == SLIP_MINUS else slip) >= -_ZERO)


@inlined
def _opening(work: Work, c: int) -> float:
    """Opening speed at a separate contact; at a corner any of its edges may open."""
    group = work.contact[c, GROUP]
    if work.contact[c, KIND] == POINT:
        return np.inf
    best = speed(work, 2 * c)
    for other in range(work.count[TOUCHING] if group >= 0 else 0):
        if work.contact[other, GROUP] == group and work.contact[other, KIND] != POINT:
            best = max(best, speed(work, 2 * other))
        if work.contact[other, GROUP] == group and work.mode[other] != SEPARATE:
            return np.inf
    return best


@inlined
def _keep(work: Work, k: int, merit: float) -> None:
    """Note a combination that holds."""
    for c in range(work.count[TOUCHING]):
        work.found[k, c] = work.mode[c]
    for m in range(6):
        work.found[k, MOST + m] = work.basis[m]
    work.found[k, MOST + 6] = work.count[HELD]
    for m in range(3):
        work.merit[k, m] = work.twist[m]
    work.merit[k, 3] = merit


@inlined
def _take_best(work: Work, count: int) -> int:
    """Write back the best of the combinations that hold, if they move the part alike."""
    best = 0
    for k in range(1, count):
        scale = 1.0
        far = 0.0
        for m in range(3):
            far = max(far, abs(work.merit[k, m] - work.merit[0, m]))
            scale = max(scale, abs(work.merit[0, m]))
        if far > _DIFFERENT * scale:
            return NOT_UNIQUE
        if work.merit[k, 3] > work.merit[best, 3] + _BETTER:
            best = k
    work.count[CLOSED] = 0
    for c in range(work.count[TOUCHING]):
        work.mode[c] = work.found[best, c]
        work.count[CLOSED] += work.mode[c] != SEPARATE
    for m in range(6):
        work.basis[m] = work.found[best, MOST + m]
    work.count[HELD] = work.found[best, MOST + 6]
    return FOUND
