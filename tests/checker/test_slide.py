"""Barriers: what is no barrier is refused, and motions by the planner's formula stay between them."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from flint import arb

from meso_robust.checker.dual import Dual
from meso_robust.checker.ranges import Box, Side
from meso_robust.checker.slide import Cubic, Piece, _is_barrier, enclose
from meso_robust.conditions import values


def side(low: float, high: float) -> Side:
    return arb(low), arb(high)


D1 = arb(418.5e-6)
BOX: Box = {
    "V": side(900e-6, 912e-6),
    "rho": side(3.6e-7, 3.9e-7),
    "mu": side(0.30, 0.36),
    "d1": (D1, D1),
}
H, SIGMA, H_END = side(770e-6, 820e-6), side(-220e-6, -190e-6), side(-420e-6, -400e-6)


@pytest.fixture(scope="module")
def pieces() -> tuple[Piece, ...]:
    return enclose(BOX, H, SIGMA, H_END)


def rate(h: float, V: float, sigma: float, rho: float, mu: float) -> float:
    """The slide rate: the corner of both cones whose slips fit, else that of the tip that sticks."""
    *slips, stuck = (
        float(value)
        for value in values("two_sided_rotation", "slide_rates")(
            h=h, V=V, d1=418.5e-6, sigma=sigma, rho=rho, mu=mu
        )
    )
    for (k_D, k_S), speed in zip(itertools.product((-1, 1), repeat=2), slips, strict=True):
        if (stuck - speed) * k_D > 0 and (-stuck - speed) * k_S > 0:
            return speed
    low, high = sorted((stuck, -stuck))
    between = slips[2] if stuck > 0 else slips[1]  # the tips slip apart or together
    return low if between < low else high


def test_motions_stay_between_the_barriers(pieces: tuple[Piece, ...]) -> None:
    rng = np.random.default_rng(0)
    for V, rho, mu in itertools.product(*([float(e) for e in BOX[n]] for n in ("V", "rho", "mu"))):
        h = rng.uniform(770e-6, 820e-6)
        sigma = float(rng.choice([-220e-6, -190e-6]))
        for piece in pieces:
            while piece.last < h <= piece.first:
                done = piece.done(Dual(arb(h)))
                low, high = float(piece.lower(done).value), float(piece.upper(done).value)
                assert low - 1e-8 <= sigma <= high + 1e-8
                sigma += 2e-6 * rate(h, V, sigma, rho, mu)
                h -= 2e-6


def test_the_tube_is_not_much_wider_than_it_was(pieces: tuple[Piece, ...]) -> None:
    last = pieces[-1]
    assert last.upper.end - last.lower.end < 80e-6


@pytest.mark.parametrize("which", [-1, 1])
def test_a_curve_that_motions_overtake_is_no_barrier(which: int) -> None:
    ends, start = (500e-6, 480e-6), -250e-6
    # motions go at about -0.25 there
    far, near = -0.25 + 0.1 * which, -0.25 - 0.1 * which
    assert _is_barrier(Cubic((start, far * 20e-6, 0.0, 0.0)), BOX, ends, which)
    assert not _is_barrier(Cubic((start, near * 20e-6, 0.0, 0.0)), BOX, ends, which)
