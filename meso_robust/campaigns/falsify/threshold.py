"""The factor of all uncertainties at which an adversary first breaks a claim."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.campaigns.falsify.section import Wanted
from meso_robust.campaigns.falsify.targets import Target, all_targets, failing
from meso_robust.laboratory.ascent import Effort, Summit, climb, corners, shaken
from meso_robust.laboratory.claim_ids import Claim
from meso_robust.laboratory.claims import only_motions
from meso_robust.laboratory.judging import judge
from meso_robust.laboratory.replay import Feedback, limits
from meso_robust.primitives.setup import Setup
from meso_robust.types import Floats

# what fails first fails at corners
STEPS = Effort(corners=1500, reaches=(1.0, 1.0, 0.3), elite=3, generations=0)

LARGEST = 3.0  # factor at which a bisection begins


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reach:
    """How far an attack got towards one target."""

    target: Target
    summit: Summit


def attack(
    player: Feedback, targets: Sequence[Target], rng: np.random.Generator, effort: Effort
) -> tuple[Reach, ...]:
    """Raise every target by itself, from random corners and from what other targets found.

    The targets are those that look at no path.
    """
    box = limits(player)
    pool = corners(*box, effort.corners, rng)
    runs = player.run(pool)
    known = pool[:0]
    found = []
    for target in targets:

        def score(rows: Floats, target: Target = target) -> Floats:
            ran = player.run(rows)
            return failing(ran, target.measure(ran, player.draws_of(rows)))

        values = failing(runs, target.measure(runs, player.draws_of(pool)))
        rows = np.concatenate([pool, known])
        values = np.concatenate([values, score(known)]) if len(known) else values
        summit = climb(score, rows, values, box, rng, effort)
        known = np.concatenate([known, summit.row[None]])
        found.append(Reach(target=target, summit=summit))
    return tuple(found)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Breaking:
    """A run that breaks a claim at some factor."""

    factor: float
    claims: tuple[Claim, ...]
    row: Floats
    """(D,)"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Threshold:
    """The factor of all uncertainties at which an adversary first breaks a claim."""

    holds: float
    """Largest factor tried at which it found nothing."""
    breaking: Breaking | None
    """What it found at the smallest factor at which it found something; None if at none."""
    executions: int


def breaking_at(
    player: Feedback, factor: float, wanted: Wanted, rng: np.random.Generator, effort: Effort
) -> tuple[Breaking | None, int]:
    """Attack the plan with ``player``'s uncertainties.

    Returns
    -------
    tuple
        The first row that breaks a wanted claim, and the number of executions.
    """
    claims = only_motions(player.rules, player.setup)
    reached = attack(player, all_targets(claims), rng, effort)
    worst = np.array([reach.summit.row for reach in reached])
    low, high = limits(player)
    around = shaken(worst, low, high, effort.corners, rng)
    rows = np.concatenate([worst, around, corners(low, high, effort.corners, rng)])
    count = effort.corners + sum(reach.summit.evaluations for reach in reached) + len(rows)
    judged = judge(player, claims, rows)
    flags = {claim: f for claim, f in judged.broken.items() if wanted.counts(claim)}
    hit = np.flatnonzero(np.logical_or.reduce(list(flags.values())))
    if not hit.size:
        return None, count
    row = int(hit[0])
    broken = tuple(claim for claim, f in flags.items() if f[row])
    return Breaking(factor=factor, claims=broken, row=rows[row]), count


def threshold(
    player: Feedback,
    scaled: Callable[[float], Setup],
    wanted: Wanted,
    *,
    seed: int = 0,
    largest: float = LARGEST,
    resolution: float = 0.002,
    effort: Effort = STEPS,
) -> Threshold:
    """Bisect the factor of all uncertainties at which the adversary first breaks a wanted claim.

    Parameters
    ----------
    player
        The plan.
    scaled
        The task with its uncertainties scaled by a factor.
    wanted
        Which claims count.
    seed, effort
        Of the adversary.
    largest, resolution
        Where the search begins and where it ends.
    """

    def at(factor: float) -> tuple[Breaking | None, int]:
        stressed = replace(player, setup=scaled(factor))
        return breaking_at(stressed, factor, wanted, np.random.default_rng(seed), effort)

    good, bad = 0.0, largest
    breaking, executions = at(largest)
    if breaking is None:
        return Threshold(holds=largest, breaking=None, executions=executions)
    while bad - good > resolution * bad:
        trial = 0.5 * (good + bad)
        found, count = at(trial)
        executions += count
        if found is None:
            good = trial
        else:
            bad, breaking = trial, found
    return Threshold(holds=good, breaking=breaking, executions=executions)
