"""Proofs that a combination of modes has no solution anywhere on a box.

A mode that slips or opens has a strictly positive relative speed; forces may be zero. Four tests,
each sufficient:

1. relative motion against one solid: the speeds that must vanish leave no motion, or one line of
   motions on which two of the speeds that must be positive have opposite signs;
2. four speeds that must vanish have right sides that contradict each other;
3. the linear system is regular and one of its unknowns has the wrong sign;
4. more than three speeds must vanish, so the twist is known: another contact would have to move the
   other way, or the drag lies beyond a facet of the cone of the forces (Farkas).
"""

from __future__ import annotations

import numpy as np

from meso_robust.basis.enclosure import Tapes, Work, solve
from meso_robust.basis.layout import FORCE, MOTION, Layout
from meso_robust.basis.linear import cross, dot
from meso_robust.basis.problem import (
    CARRY,
    DRAG,
    MINUS,
    NORMAL,
    PER_CONTACT,
    PLUS,
    SPEED,
    TANGENT,
)
from meso_robust.bounds.arithmetic import Pair, add, div, mul, sub
from meso_robust.kernels import inner, maker
from meso_robust.types import Floats


@maker
def excluded(tapes: Tapes, of: Layout, m: int, work: Work) -> bool:
    """Whether combination ``m`` is proved to have no solution on the box visited last."""
    if _no_relative_motion(of, m, work) or _contradiction(of, m, work):
        return True
    if _vanishing_speeds(of, m) > 3:
        return _known_twist_fails(of, m, work)
    return solve(tapes, of, m, work) and wrong_sign(of, m, work)


@inner
def wrong_sign(of: Layout, m: int, work: Work) -> bool:
    """Whether an unknown of the solution has the wrong sign all over the box."""
    for i in range(of.kind.shape[1]):
        most = work.right[i, 0, 1]
        if (of.kind[m, i] == FORCE and most < 0.0) or (of.kind[m, i] == MOTION and most <= 0.0):
            return True
    return False


@inner
def _row(work: Work, contact: int, piece: int, out: Floats) -> None:
    """Copy three pieces of a contact over the box, (3, 2)."""
    start = DRAG + PER_CONTACT * contact + piece
    for a in range(3):
        out[a, 0], out[a, 1] = work.value[start + a, 0], work.value[start + a, 1]


@inner
def _speed_rows(of: Layout, m: int, work: Work, solid: int, zero: Floats, positive: Floats) -> int:
    """Fill the rows of speeds against a solid that vanish, and that are positive.

    Returns their numbers as ``1000 zero + positive``.
    """
    zeros, positives = 0, 0
    for i in range(of.movers.shape[0]):
        if of.movers[i] != solid:
            continue
        mode = of.modes[m, i]
        if mode == 0:
            _row(work, i, NORMAL, positive[positives])
            positives += 1
            continue
        _row(work, i, NORMAL, zero[zeros])
        zeros += 1
        if mode == 1:
            _row(work, i, TANGENT, zero[zeros])
            zeros += 1
            continue
        _row(work, i, TANGENT, positive[positives])
        if mode == 2:
            for a in range(3):
                lo, hi = positive[positives, a, 0], positive[positives, a, 1]
                positive[positives, a, 0], positive[positives, a, 1] = -hi, -lo
        positives += 1
    return 1000 * zeros + positives


@maker
def _no_relative_motion(of: Layout, m: int, work: Work) -> bool:
    """Test 1, for every solid."""
    most = 2 * of.movers.shape[0]
    zero, positive = np.empty((most, 3, 2)), np.empty((most, 3, 2))
    line = np.empty((3, 2))
    for solid in range(np.max(of.movers) + 1):
        counts = _speed_rows(of, m, work, solid, zero, positive)
        zeros, positives = counts // 1000, counts % 1000
        if positives == 0:
            continue
        for a in range(zeros):
            for b in range(a):
                cross(zero[a], zero[b], line)
                for c in range(b):
                    if _has_sign(dot(zero[c], line)) != 0:
                        return True
                seen_up, seen_down = False, False
                for c in range(positives):
                    sign = _has_sign(dot(positive[c], line))
                    seen_up, seen_down = seen_up or sign > 0, seen_down or sign < 0
                if seen_up and seen_down:
                    return True
    return False


@inner
def _has_sign(pair: Pair) -> int:
    """1, -1, or 0 if the interval does not tell."""
    return 1 if pair[0] > 0.0 else (-1 if pair[1] < 0.0 else 0)


@inner
def _vanishing_speeds(of: Layout, m: int) -> int:
    """Number of speeds that must vanish."""
    count = 0
    for i in range(of.movers.shape[0]):
        mode = of.modes[m, i]
        count += 0 if mode == 0 else (2 if mode == 1 else 1)
    return count


@inner
def _vanishing(of: Layout, m: int, work: Work, rows: Floats) -> int:
    """Fill the rows (J, u) of speeds that must vanish, (., 4, 2); return their number."""
    count = 0
    for i in range(of.movers.shape[0]):
        mode = of.modes[m, i]
        for which in range(0 if mode == 0 else (2 if mode == 1 else 1)):
            _row(work, i, NORMAL if which == 0 else TANGENT, rows[count, :3])
            u = DRAG + PER_CONTACT * i + SPEED + which
            rows[count, 3, 0], rows[count, 3, 1] = work.value[u, 0], work.value[u, 1]
            count += 1
    return count


@maker
def _contradiction(of: Layout, m: int, work: Work) -> bool:
    """Test 2: the determinant of four rows (J, u) of speeds that vanish is not zero."""
    rows = np.empty((2 * of.movers.shape[0], 4, 2))
    count = _vanishing(of, m, work, rows)
    for a in range(count):
        for b in range(a):
            for c in range(b):
                for d in range(c):
                    if _has_sign(_determinant(rows[a], rows[b], rows[c], rows[d])) != 0:
                        return True
    return False


@inner
def _determinant(a: Floats, b: Floats, c: Floats, d: Floats) -> Pair:
    """Determinant of four rows (4, 2), by minors of the first two and the last two rows."""
    lo, hi = 0.0, 0.0
    for i in range(4):
        for j in range(i + 1, 4):
            k = 0 if i > 0 else (1 if j > 1 else 2)
            p_lo, p_hi = _minor(a, b, i, j)
            q_lo, q_hi = _minor(c, d, k, 6 - i - j - k)
            r_lo, r_hi = mul(p_lo, p_hi, q_lo, q_hi)
            if (i + j) % 2 == 1:
                lo, hi = add(lo, hi, r_lo, r_hi)
            else:
                lo, hi = sub(lo, hi, r_lo, r_hi)
    return lo, hi


@inner
def _minor(a: Floats, b: Floats, i: int, j: int) -> Pair:
    p_lo, p_hi = mul(a[i, 0], a[i, 1], b[j, 0], b[j, 1])
    q_lo, q_hi = mul(a[j, 0], a[j, 1], b[i, 0], b[i, 1])
    return sub(p_lo, p_hi, q_lo, q_hi)


@maker
def fixes_turning(of: Layout, m: int, work: Work) -> bool:
    """Whether the two contacts of a redundant pair are proved to lie apart: the twist is unique."""
    rows, line = np.empty((4, 3, 2)), np.empty((3, 2))
    for k in range(4):
        _row(work, of.pair[m, k // 2], NORMAL if k % 2 == 0 else TANGENT, rows[k])
    cross(rows[0], rows[1], line)
    return _has_sign(dot(rows[2], line)) != 0 or _has_sign(dot(rows[3], line)) != 0


@maker
def _known_twist_fails(of: Layout, m: int, work: Work) -> bool:
    """Test 4: speeds that vanish leave one twist, with which the other conditions disagree."""
    twist, row = np.empty((3, 2)), np.empty((3, 2))
    if not _known_twist(of, m, work, twist):
        return False
    for i in range(of.movers.shape[0]):
        mode = of.modes[m, i]
        if mode == 1:
            continue
        _row(work, i, NORMAL if mode == 0 else TANGENT, row)
        lo, hi = dot(row, twist)
        u = DRAG + PER_CONTACT * i + SPEED + (0 if mode == 0 else 1)
        lo, hi = sub(lo, hi, work.value[u, 0], work.value[u, 1])
        if (mode != 2 and hi <= 0.0) or (mode == 2 and lo >= 0.0):
            return True
    return _beyond_a_facet(of, m, work, twist)


@maker
def _known_twist(of: Layout, m: int, work: Work, twist: Floats) -> bool:
    """Enclose the only twist that speeds which vanish leave, (3, 2); False if they leave more."""
    if of.pair[m, 0] >= 0:
        _row(work, of.pair[m, 0], CARRY, twist)
        return fixes_turning(of, m, work)
    rows = np.empty((2 * of.movers.shape[0], 4, 2))
    count, line = _vanishing(of, m, work, rows), np.empty((3, 2))
    for a in range(count):
        for b in range(a):
            cross(rows[a, :3], rows[b, :3], line)
            for c in range(b):
                lo, hi = dot(rows[c, :3], line)
                if _has_sign((lo, hi)) != 0:
                    _cramer(rows[a], rows[b], rows[c], lo, hi, twist)
                    return True
    return False


@maker
def _cramer(a: Floats, b: Floats, c: Floats, lo: float, hi: float, twist: Floats) -> None:
    """Solve three rows (J, u) with determinant [lo, hi]: sum of u times a cross product, over it."""
    part = np.empty((3, 2))
    twist[:] = 0.0
    for one, two, three in ((a, b, c), (b, c, a), (c, a, b)):
        cross(one[:3], two[:3], part)
        for i in range(3):
            p_lo, p_hi = mul(part[i, 0], part[i, 1], three[3, 0], three[3, 1])
            twist[i, 0], twist[i, 1] = add(twist[i, 0], twist[i, 1], p_lo, p_hi)
    for i in range(3):
        twist[i, 0], twist[i, 1] = div(twist[i, 0], twist[i, 1], lo, hi)


@maker
def _beyond_a_facet(of: Layout, m: int, work: Work, twist: Floats) -> bool:
    """Whether the drag of a known twist lies strictly outside the cone of the forces.

    Facets contain two of the cone's edges, so that these two need no check.
    """
    edges = np.empty((2 * of.movers.shape[0], 3, 2))
    count = _cone(of, m, work, edges)
    load, drag, facet = np.empty((3, 2)), np.empty((3, 2)), np.empty((3, 2))
    for i in range(3):
        for j in range(3):
            low, high = min(i, j), max(i, j)
            entry = low * (5 - low) // 2 + high
            drag[j, 0], drag[j, 1] = work.value[entry, 0], work.value[entry, 1]
        load[i, 0], load[i, 1] = dot(drag, twist)
    for a in range(count):
        for b in range(count):
            if a == b:
                continue
            cross(edges[a], edges[b], facet)
            if dot(load, facet)[1] < 0.0 and _on_one_side(edges, count, a, b, facet):
                return True
    return False


@inner
def _cone(of: Layout, m: int, work: Work, edges: Floats) -> int:
    """Fill the wrenches (., 3, 2) that forces of the modes are made of; return their number."""
    count = 0
    for i in range(of.movers.shape[0]):
        mode = of.modes[m, i]
        if mode == 1 or mode == 2:
            _row(work, i, PLUS, edges[count])
            count += 1
        if mode == 1 or mode == 3:
            _row(work, i, MINUS, edges[count])
            count += 1
    return count


@inner
def _on_one_side(edges: Floats, count: int, a: int, b: int, facet: Floats) -> bool:
    """Whether all wrenches but a and b, which span the facet, lie on its positive side."""
    below = 0
    for c in range(count):
        if c != a and c != b and not dot(edges[c], facet)[0] >= 0.0:
            below += 1
    return below == 0
