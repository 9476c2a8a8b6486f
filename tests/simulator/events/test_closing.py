"""How fast a tip and a part that turns about another tip come closer at most."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from meso_robust.simulator.events import closing
from meso_robust.simulator.events.curve import STICKING
from meso_robust.simulator.events.scene import WORK, Scene
from tests.entry import entry

speed_between = entry(closing.speed_between)

TIPS = np.array(
    [[0.4, -0.7, -0.3, 0.1, 0.02, 0.3], [0.6, 0.8, -0.2, 0.35, 0.01, 0.3]]
)  # the first sticks; both move, the second not as the first does


def turning(kappa: float, psi: float) -> Any:
    """Working space with a part that turns about the first tip, at the angle ``psi`` of the curve."""
    work = np.zeros(1, WORK)[0]
    half = 0.5 * psi + 0.25 * np.pi
    work["curve"][[0, 1, 2, 4, 5]] = STICKING, *TIPS[0, :4]
    work["curve"][8:11] = kappa, np.sin(half), np.cos(half)
    return work


@pytest.mark.parametrize("psi", [-1.4, -0.5, 0.3, 1.2, -2.9])
@pytest.mark.parametrize("kappa", [0.3, 2.0])
def test_no_tip_comes_closer_faster(psi: float, kappa: float) -> None:
    """Against the velocity of the material under the tip, with the turn integrated by SciPy."""
    none = np.zeros((0, 9))
    scene = Scene(
        none, none, np.zeros((1, 2, 4)), TIPS, np.ones(2), np.zeros(2), np.zeros((2, 1), np.bool_)
    )
    work = turning(kappa, psi)
    times = np.linspace(0.0, 2.0, 401)
    turn = solve_ivp(
        lambda _, y: kappa * np.cos(y), (0.0, 2.0), [psi], t_eval=times, rtol=1e-10, atol=1e-12
    )
    omega = kappa * np.cos(turn.y[0])
    offset = (TIPS[1, :2] - TIPS[0, :2]) + times[:, None] * (TIPS[1, 2:4] - TIPS[0, 2:4])
    across = TIPS[1, 2:4] - TIPS[0, 2:4] - omega[:, None] * np.c_[-offset[:, 1], offset[:, 0]]
    true = np.hypot(*across.T)
    for first, last in [(0, 400), (0, 100), (150, 250), (300, 310)]:
        bound = speed_between(scene, work, 1, (times[first], times[last]), 0.0)
        assert true[first : last + 1].max() <= bound * (1.0 + 1e-8)
        # and it is no more than what the parts of it can be at their worst at one time
        worst = np.abs(omega[first : last + 1]).max()
        worst *= np.hypot(*offset[first : last + 1].T).max()
        assert bound <= np.hypot(*(TIPS[1, 2:4] - TIPS[0, 2:4])) + worst * (1.0 + 1e-3)


def test_it_says_nothing_of_other_motions_and_of_corners() -> None:
    none = np.zeros((0, 9))
    scene = Scene(
        none, none, np.zeros((1, 2, 4)), TIPS, np.ones(2), np.zeros(2), np.zeros((2, 1), np.bool_)
    )
    work = turning(1.0, 0.2)
    assert speed_between(scene, work, 2, (0.0, 1.0), 0.0) == np.inf
    work["curve"][0] = 0.0
    assert speed_between(scene, work, 1, (0.0, 1.0), 0.0) == np.inf
