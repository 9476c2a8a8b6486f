"""The eight pushes of Fig. 3 in the simulator, on the film and on both columns of Table I."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from meso_robust.identification.experiment import Bench, PlannedPush, standard_tests
from meso_robust.reproduction.printed import (
    FRICTION,
    PART,
    POINTS,
    SPEED,
    TIP_FRICTION,
    TIP_RADIUS,
    film,
    three_points,
)
from meso_robust.simulator import Flat, Push, PushResult, Round, simulate
from meso_robust.simulator.support_models import Support
from meso_robust.types import Floats

TESTS = tuple("ABCDEFGH")
SUPPORTS = ("film", *POINTS)
BENCH = Bench(tip_radius=TIP_RADIUS, speed=SPEED)
STEP = 2e-6
"""m, of the tip."""
RECORD = 150
"""Intervals of a recorded push: 5 um each."""


def planned(margin: float | None = None, length: float | None = None) -> Mapping[str, PlannedPush]:
    """The tests by name.

    Parameters
    ----------
    margin
        Distance from the corner at which A, E, F and H push, m; by default the bench's.
    length
        Of a push from first contact on, m; by default the paper's 700 um.
    """
    bench = replace(
        BENCH,
        corner_margin=BENCH.corner_margin if margin is None else margin,
        length=BENCH.length if length is None else length,
    )
    return {push.name: push for push in standard_tests(PART, bench).pushes}


def friction(support: str) -> float:
    """μ between tip and part: of Table I, or the middle of what Section X-A prints for the film."""
    return TIP_FRICTION.get(support, sum(FRICTION) / 2.0)


def resting_on(support: str) -> Support:
    """The support of this name."""
    return film() if support == "film" else three_points(support)


def push_of(
    pushes: Sequence[PlannedPush],
    support: str,
    *,
    errors: Floats | None = None,
    flat: bool = False,
    on: Support | None = None,
) -> Push:
    """N tests as one move for the simulator.

    Parameters
    ----------
    pushes
        N tests of the same length.
    support
        One of `SUPPORTS`, whose friction the tips have.
    errors
        (N, 5) by how much part (x, y, θ) and tip (x, y) start elsewhere, m and rad; none by default.
    flat
        Whether the tip ends in a flat side of the same width; else it is round.
    on
        What the part rests on in place of `support`.
    """
    off = np.zeros((len(pushes), 5)) if errors is None else errors
    tips = np.array([push.tip for push in pushes]) + off[:, 3:]
    if flat:  # a tip is placed by the middle of its side, not by its centre
        tips = tips - np.array([TIP_RADIUS, 0.0])
    return Push.straight(
        vertices=PART.outline,
        poses=np.array([push.start for push in pushes]) + off[:, :3],
        tips=tips[:, None],
        travel=np.array([push.travel for push in pushes])[:, None],
        support=resting_on(support) if on is None else on,
        friction=np.full(len(pushes), friction(support)),
        shapes=(Flat(np.pi, 2.0 * TIP_RADIUS) if flat else Round(TIP_RADIUS),),
        speed=SPEED,
        step=STEP,
    )


def pushed(pushes: Sequence[PlannedPush], support: str, errors: Floats | None = None) -> PushResult:
    """What becomes of N tests, recorded every 5 um; arguments as in `push_of`."""
    return simulate(push_of(pushes, support, errors=errors), record=RECORD)
