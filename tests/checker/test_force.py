"""Why a premise says that probes are rigid under any force: close to a jam no force bounds theirs."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from flint import arb

from meso_robust.checker.dual import Dual
from meso_robust.checker.grip import Drag, Grip, S, Sides
from meso_robust.checker.ranges import ZERO
from meso_robust.checker.statement import NO_JAM

WIDTH, RATIO, MU = 837e-6, 376900e-12, 0.36  # of the paper's part, at the largest friction
JAM = WIDTH * math.sqrt(1.0 + MU**2)  # the separation at which the two tips close on the part, m


def by_hand(separation: float) -> float:
    """Force at either tip, both slipping outward, over that of the film on a part that travels along.

    When the tips are level in x: no normal speed at the resting tip, and the moment of the film.
    """
    reach = math.sqrt(separation**2 - WIDTH**2)
    turn = 1.0 / separation  # sin(theta)/T, and sin(theta) = T/V
    arm, d1 = -reach / 2.0, WIDTH / 2.0
    moving, resting = arm + reach - MU * d1, arm + MU * d1
    rows = np.array([[-1.0, 1.0], [moving, -resting]])
    return float(np.abs(np.linalg.solve(rows, [turn * arm, RATIO * turn])).max())


def by_the_checker(separation: float) -> float:
    half, none = Dual(arb(WIDTH / 2.0)), Dual(arb(0))
    ahead = Dual(arb(math.sqrt(separation**2 - WIDTH**2) / 2.0))
    grip = Grip.at(Sides(half, half, none, none), none, Dual(arb(separation)), S, ahead)
    found = grip.forces(Drag(arb(RATIO)), arb(-MU), arb(MU))
    return max(float((force / found.divisor).value) for force in (found.moving, found.resting))


@pytest.mark.parametrize("separation_um", [890.0, 900.0, 916.0])
def test_the_force_at_a_tip_is_that_of_the_balance(separation_um: float) -> None:
    separation = 1e-6 * separation_um
    assert by_the_checker(separation) == pytest.approx(by_hand(separation), rel=1e-9)


def test_the_force_grows_without_bound() -> None:
    assert pytest.approx(889.6e-6, abs=0.05e-6) == JAM
    assert by_hand(890e-6) > 200.0  # as the guide says
    nearer = [by_hand(JAM * (1.0 + 10.0**-k)) for k in range(3, 9)]
    assert all(after > 9.0 * before for before, after in itertools.pairwise(nearer))


@pytest.mark.parametrize(("share", "holds"), [(1e-9, True), (-1e-9, False)])
def test_the_condition_against_a_jam_ends_where_the_force_has_no_bound(
    share: float, holds: bool
) -> None:
    numbers = {"V": JAM * (1.0 + share), "width": WIDTH, "radii": 0.0, "mu": MU}
    (margin,) = NO_JAM.of({name: Dual(arb(value)) for name, value in numbers.items()}, ZERO)

    assert bool(margin.value > 0) is holds
    assert bool(margin.value < 0) is not holds
