"""The seven-step plan of Table II and its like: lengths of the moves, and a search for them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from meso_robust.reproduction import printed
from meso_robust.reproduction.baselines import ALL, ON_FILM, REPORTED, Errors, drawn, successes
from meso_robust.reproduction.bench import TIP_START, Followed, Place, Plan, Runs, follow
from meso_robust.reproduction.item import Setting
from meso_robust.reproduction.rrt import distance
from meso_robust.simulator import Outcome
from meso_robust.types import Floats
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
NEAR = 0.3e-3
"""m from the goal that count for half a miss."""
SUPPORTS = ("p1*", "film")
"""On which the lengths are searched."""
POPULATION, GENERATIONS, RESTARTS, STARTS = 10, 30, 2, 6
QUICK_GENERATIONS, QUICK_STARTS = 1, 1
"""Size of the search: the starts of each population are redrawn."""
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


def from_goal(done: Followed, place: Place) -> Floats:
    """(N,) distance of the last poses from where the last push brings the peg, m; see `JAMMED`."""
    goal = np.array(
        [PRINTED[0][7, 0] - printed.TIP_RADIUS - 0.5 * printed.PART.length, place.axis, np.pi]
    )
    return distance(done.poses, goal) + JAMMED * (done.outcomes != Outcome.COMPLETED)


def mean_cost(lengths: Floats, among: Runs, place: Place) -> Floats:
    """(N,) from 0 to 1: how far (N, 4) lengths leave the peg on average over some runs with errors.

    A distance l counts as l / (l + `NEAR`): a run that misses counts hardly more for missing far.
    """
    count, each = len(lengths), len(among)
    runs = among.where(np.tile(np.arange(each), count))
    done = follow((with_lengths(np.repeat(lengths, each, axis=0)),), runs, place, step=STEP)
    left = from_goal(done, place)
    return np.asarray((left / (left + NEAR)).reshape(count, each).mean(axis=1))


def tuned(place: Place, setting: Setting) -> tuple[Plan, str]:
    """The seven-step plan with lengths found by differential evolution, and the support it is for.

    On each support the lengths are searched from several populations for the least mean distance from
    the goal over starts as varied as those reported; of the best of each, the plan that most often
    succeeds with all errors of `baselines.ALL` and `baselines.ON_FILM` is kept. Found once a process.

    Parameters
    ----------
    place
        The slot.
    setting
        Seed and size.
    """
    setting.told("optimising the lengths of the seven moves", 0, 1)
    return _tuned(place, setting.quick, setting.seed)


@cache
def _tuned(place: Place, quick: bool, seed: int) -> tuple[Plan, str]:
    candidates = [
        ((with_lengths(lengths[None])[0],), support)
        for support in SUPPORTS
        for lengths in _evolved(support, place, quick, seed)
    ]
    runs = QUICK_TRIALS if quick else TRIALS
    scores = [
        sum(
            int(np.sum(successes(plan, runs, errors, np.random.default_rng(seed), place=place)))
            for errors in (ALL, ON_FILM)
        )
        for plan, _ in candidates
    ]
    return candidates[int(np.argmax(scores))]


def _evolved(support: str, place: Place, quick: bool, seed: int) -> list[Floats]:
    from scipy.optimize import differential_evolution

    found = []
    for restart in range(1 if quick else RESTARTS):
        rng = np.random.default_rng([seed, restart])
        among = drawn(_varied(support), QUICK_STARTS if quick else STARTS, rng, place)
        best = differential_evolution(
            lambda columns, among=among: mean_cost(columns.T, among, place),
            LIMITS,
            vectorized=True,
            updating="deferred",
            polish=False,
            popsize=POPULATION,
            maxiter=QUICK_GENERATIONS if quick else GENERATIONS,
            seed=seed + restart,
        )
        found.append(np.asarray(best.x))
    return found


def _varied(support: str) -> Errors:
    """Starts as varied as those reported, on one support known exactly."""
    if support == "film":
        middle = float(np.mean(printed.FRICTION))
        film = (printed.FILM_RATIO, printed.FILM_RATIO)
        return replace(REPORTED, friction=(middle, middle), film_ratio=film)
    return replace(REPORTED, friction=(printed.TIP_FRICTION[support],) * 2)
