"""Mechanics by hand in exact rationals: nothing here comes from ``derivations``."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from types import SimpleNamespace

Vector = tuple[Fraction, Fraction]


def solve(rows: Sequence[Sequence[Fraction]], right: Sequence[Fraction]) -> list[Fraction]:
    """Gauss-Jordan elimination."""
    work = [[*map(Fraction, row), Fraction(b)] for row, b in zip(rows, right, strict=True)]
    size = len(work)
    for k in range(size):
        pivot = next(r for r in range(k, size) if work[r][k] != 0)
        work[k], work[pivot] = work[pivot], work[k]
        work[k] = [value / work[k][k] for value in work[k]]
        for r in range(size):
            if r != k:
                work[r] = [a - work[r][k] * b for a, b in zip(work[r], work[k], strict=True)]
    return [row[size] for row in work]


def root(value: Fraction) -> Fraction:
    """The rational square root; fails if there is none."""
    found = Fraction(round(value.numerator**0.5), round(value.denominator**0.5))
    assert found * found == value
    return found


def arithmetic(cos: Fraction, sin: Fraction) -> SimpleNamespace:
    """What generated functions take as ``ops``, for one angle with rational cosine and sine."""
    return SimpleNamespace(cos=lambda _: cos, sin=lambda _: sin, sqrt=root)


def plus(*terms: tuple[Fraction, Vector]) -> Vector:
    """Linear combination."""
    return (
        sum((k * v[0] for k, v in terms), Fraction(0)),
        sum((k * v[1] for k, v in terms), Fraction(0)),
    )


def dot(p: Vector, q: Vector) -> Fraction:
    """Scalar product."""
    return p[0] * q[0] + p[1] * q[1]


def moment(arm: Vector, force: Vector) -> Fraction:
    """Moment of ``force`` at ``arm`` about the centre, counter-clockwise positive."""
    return arm[0] * force[1] - arm[1] * force[0]


def velocity_row(arm: Vector, along: Vector) -> list[Fraction]:
    """Coefficients of (v_x, v_y, omega) in the velocity of the point at ``arm``, along ``along``."""
    return [along[0], along[1], -arm[1] * along[0] + arm[0] * along[1]]


def force_column(arm: Vector, force: Vector) -> list[Fraction]:
    """Wrench of a force, (f_x, f_y, m)."""
    return [force[0], force[1], moment(arm, force)]


def balance_rows(
    e_x: Fraction, rho: Fraction, wrenches: list[list[Fraction]]
) -> list[list[Fraction]]:
    """Rows of: drag - pushes = 0, in the unknowns (v_x, v_y, omega, forces...)."""
    drag = [e_x, e_x, rho * e_x]
    return [
        [drag[k] if j == k else Fraction(0) for j in range(3)] + [-w[k] for w in wrenches]
        for k in range(3)
    ]
