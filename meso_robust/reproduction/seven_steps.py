"""The seven-step plan of Table II and its like: lengths of the moves, and a search for them."""

from __future__ import annotations

import numpy as np

from meso_robust.reproduction import given
from meso_robust.reproduction.baselines import ALL, ON_FILM, successes
from meso_robust.reproduction.bench import TIP_START, Floats, Place, Plan, follow, nominal
from meso_robust.reproduction.item import Setting
from meso_robust.reproduction.rrt import distance
from meso_robust.simulator import Outcome
from meso_robust.units import UM

MOVES = UM * np.array(
    [[0, 600], [-1500, 0], [0, -50], [0, 50], [1550, 0], [0, -775], [-2550, 0]], dtype=np.float64
)
"""(7, 2) moves of the tip, Table II; m, y up."""
PRINTED: Plan = (TIP_START + np.concatenate([np.zeros((1, 2)), np.cumsum(MOVES, axis=0)]),)
"""The printed plan: one stroke, the tip is never lifted."""
LIMITS = ((0.2e-3, 0.75e-3), (0.5e-3, 2.2e-3), (0.0, 0.9e-3), (0.3e-3, 1.2e-3))
"""m, of the free lengths: up, left, down, and down again to the line of the last push."""
STEP = 3e-6
"""m a step during the optimisation."""
JAMMED = 0.2e-3
"""m added to the distance from the goal of a run that is not completed."""
POPULATION, GENERATIONS, RESTARTS = 10, 25, 2
QUICK_GENERATIONS = 1
TRIALS, QUICK_TRIALS = 40, 5
"""Runs by which the plans found are told apart."""


def lengths_of(plan: Plan) -> Floats:
    """(4,) free lengths of a seven-step plan, m; see `LIMITS`."""
    up, left, down, _, _, last, _ = np.abs(np.diff(plan[0], axis=0)).max(axis=1)
    return np.array([up, left, down, last])


def with_lengths(lengths: Floats) -> Floats:
    """(N, 8, 2) waypoints of seven-step plans of (N, 4) free lengths, m.

    The others follow as in Table II: down and up again, right to 50 um beyond the start, and left to
    x = 0.55 mm.
    """
    up, left, down, last = np.asarray(lengths).T
    x, y = TIP_START
    far, end = PRINTED[0][5, 0], PRINTED[0][7, 0]
    zero = np.zeros_like(up)
    xs = (x + zero, x + zero, x - left, x - left, x - left, far + zero, far + zero, end + zero)
    high = y + up
    ys = (y + zero, high, high, high - down, high, high, high - last, high - last)
    return np.stack([np.stack(xs, axis=1), np.stack(ys, axis=1)], axis=2)


def cost(lengths: Floats, support: str, place: Place) -> Floats:
    """(N,) how far from the goal (N, 4) lengths leave the peg, m, without errors."""
    goal = np.array(
        [PRINTED[0][7, 0] - given.TIP_RADIUS - 0.5 * given.PART.length, place.axis, np.pi]
    )
    done = follow((with_lengths(lengths),), nominal(support, len(lengths)), place, step=STEP)
    return distance(done.poses, goal) + JAMMED * (done.outcomes != Outcome.COMPLETED)


def tuned(place: Place, setting: Setting) -> tuple[Plan, str]:
    """The seven-step plan with lengths found by differential evolution, and the support it is for.

    On each support the lengths are searched from several populations; of the best of each, the plan
    that most often succeeds with all errors of `baselines.ALL` and `baselines.ON_FILM` is kept.

    Parameters
    ----------
    place
        The slot.
    setting
        Seed and size.
    """
    candidates = [
        ((with_lengths(lengths[None])[0],), support)
        for support in ("p1*", "film")
        for lengths in _evolved(support, place, setting)
    ]
    runs = QUICK_TRIALS if setting.quick else TRIALS
    scores = [
        sum(
            int(
                successes(
                    plan, runs, errors, np.random.default_rng(setting.seed), place=place
                ).sum()
            )
            for errors in (ALL, ON_FILM)
        )
        for plan, _ in candidates
    ]
    return candidates[int(np.argmax(scores))]


def _evolved(support: str, place: Place, setting: Setting) -> list[Floats]:
    from scipy.optimize import differential_evolution

    restarts = 1 if setting.quick else RESTARTS
    found = []
    for restart in range(restarts):
        setting.told(f"lengths of the moves on {support}", restart, restarts)
        best = differential_evolution(
            lambda columns: cost(columns.T, support, place),
            LIMITS,
            vectorized=True,
            updating="deferred",
            polish=False,
            popsize=POPULATION,
            maxiter=QUICK_GENERATIONS if setting.quick else GENERATIONS,
            seed=setting.seed + restart,
        )
        found.append(np.asarray(best.x))
    return found
