"""The tolerance of Section IX-E read both ways: ε_p as a half side of the goal, and as its whole side.

Steps 1, 3 and 4 ask for Y within ±ε_p/2 and for a box narrower than ε_p, so ε_p is a whole side there;
the shipped task takes it as a half side.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import Chain, certify
from meso_robust.laboratory.adversary import search
from meso_robust.laboratory.replay import Feedback, limits
from meso_robust.laboratory.running import PlanRun
from meso_robust.laboratory.simulation import in_goal
from meso_robust.planning.compose import compose
from meso_robust.primitives.frame import HEADINGS, Heading
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.reproduction.certified import CertifiedPlan, trials
from meso_robust.reproduction.item import Row, Setting, success
from meso_robust.task import Task
from meso_robust.units import UM

READINGS = {76.0: "ε_p a half side, as in the shipped task", 38.0: "ε_p/2, as in Steps 1 and 3"}
"""Half side of the goal in µm, and how the print is read for it."""
SEARCHES = {True: 1, False: 10}
"""Searches of the worst run, from as many seeds."""


def rows(plan: CertifiedPlan, sampled: PlanRun, setting: Setting) -> tuple[Row, ...]:
    """Both readings for the shipped plan, and plans that are made for the narrower one.

    Parameters
    ----------
    plan, sampled
        The shipped plan, and its runs.
    setting
        Seed and size.
    """
    setting.told("reading the tolerance both ways", 0, 1)
    worst = _worst_found(plan, setting)
    return (
        *(_shipped(plan, sampled, worst, half, words) for half, words in READINGS.items()),
        _made_for_half(plan, (plan.rules[0].frame.heading,), len(sampled.outcomes), setting),
        _made_for_half(plan, HEADINGS, len(sampled.outcomes), setting),
    )


def with_half_side(task: Task, half: float) -> Task:
    """The task with another half side of the goal, in µm."""
    goal = task.goal.model_copy(update={"position_tolerance_um": half})
    return task.model_copy(update={"goal": goal})


def _worst_found(plan: CertifiedPlan, setting: Setting) -> np.ndarray:
    """(K,) largest distance of an end from the goal in x or y, µm, that each search finds."""
    player = Feedback(rules=plan.rules, setup=plan.setup, engine="events")
    none = np.empty((0, len(limits(player)[0])))
    count = SEARCHES[setting.quick]
    found = [search(player, none, np.random.default_rng(setting.seed + k)) for k in range(count)]
    ends = [player.run(one.row[None]).final[0, :2] for one in found]
    return np.abs(np.array(ends)).max(axis=1) / UM


def _shipped(
    plan: CertifiedPlan, sampled: PlanRun, worst: np.ndarray, half: float, words: str
) -> Row:
    setup = setup_of(with_half_side(plan.task, half))
    hits, count = int(in_goal(sampled, setup).sum()), len(sampled.outcomes)
    proved = _proved(plan.chain, setup)
    return Row(
        quantity=f"shipped plan, goal ± {half:g} um ({words}): probability of success",
        unit="%",
        ours=success(hits, count),
        why=f"{proved}. {hits} of {count} runs, exact 95 % interval; the worst end that {len(worst)} "
        f"searches of the uncertainties find is {worst.max():.1f} um off, outside in "
        f"{int(np.sum(worst > half))} of them",
    )


def _proved(chain: Chain, setup: Setup) -> str:
    """Whether the certified end lies in the goal, and how far it reaches."""
    end = chain.end
    if end is None:
        return "Not proved: a move of it is not"
    reach = max(abs(bound) for axis in (end.x, end.y) for bound in (axis.lo, axis.hi)) / UM
    inside = "PROVED" if end.within(setup.goal) else "Not proved, nor refuted"
    return f"{inside}: the certified end reaches {np.ceil(10.0 * reach) / 10.0:.1f} um"


def _made_for_half(
    plan: CertifiedPlan, headings: Sequence[Heading], count: int, setting: Setting
) -> Row:
    """What the planner makes of the narrower goal with probes that push in these headings."""
    task = with_half_side(plan.task, min(READINGS))
    probe = task.probe.model_copy(update={"headings": tuple(headings)})
    task = task.model_copy(update={"probe": probe})
    rules, setup = compose(task).rules, setup_of(task)
    hits = int(in_goal(trials(rules, setup, count, setting.seed), setup).sum())
    proved = certify(rules, setup).verdict is Verdict.PROVED
    used = ", ".join(dict.fromkeys(rule.frame.heading for rule in rules))
    return Row(
        quantity=f"a plan made for ± {min(READINGS):g} um, pushing along {' or '.join(headings)}: "
        "probability of success",
        unit="%",
        ours=success(hits, count),
        why=f"{'PROVED' if proved else 'The planner proves none; its best'}: {len(rules)} moves, along "
        f"{used}; {hits} of {count} runs, exact 95 % interval",
    )
