"""What is certified is kept by every run, and what fails in a run is not certified."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st

from meso_robust.bounds import Verdict as Proved
from meso_robust.campaigns.property.law import Breach, Cost, Property, Silence, Verdict
from meso_robust.campaigns.property.laws.variants import (
    Rules,
    Variant,
    paper_rules,
    plan_of,
    variants,
)
from meso_robust.certificates.chain import Chain, certify
from meso_robust.errors import NotApplicableError
from meso_robust.laboratory.ascent import corners, shaken
from meso_robust.laboratory.claim_ids import OUTCOME, Claim
from meso_robust.laboratory.claims import claims_of, only_motions
from meso_robust.laboratory.judging import Judged, judge
from meso_robust.laboratory.replay import Feedback, limits
from meso_robust.laboratory.simulation import order
from meso_robust.laboratory.witness_file import replay_files
from meso_robust.planning.compose import robust_at
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task
from meso_robust.types import Floats

ROWS = 96
"""Runs of a batch: half of them uniform, half at corners; as many again around the worst of them."""
WORST = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch:
    """A variant of the task, and the seed of the runs that are made of it."""

    variant: Variant
    seed: int


_seeds = st.integers(0, 2**32 - 1)


def _player(task: Task, rules: Rules) -> Feedback:
    return Feedback(rules=rules, setup=setup_of(task), engine="events")


def _worst(player: Feedback, seed: int) -> Floats:
    """(2 * ROWS, D) rows: uniform, at corners, and the worst of them shaken."""
    rng = np.random.default_rng(seed)
    rows = player.draw(ROWS, rng)
    seeds = rows[order(player.run(rows), player.setup)[:WORST]]
    return np.concatenate([rows, shaken(seeds, *limits(player), ROWS, rng)])


def _kept(task: Task, rules: Rules, chain: Chain, seed: int) -> Verdict:
    """Whether runs break anything that is proved; a step counts if all before it are proved too."""
    claims = claims_of(chain, rules)
    proved = sum(post is not None for post in claims.posts)
    if proved == 0:
        return Silence("the first step is not certified")
    player = _player(task, rules)
    rows = _worst(player, seed)
    judged = judge(player, claims, rows)
    wanted = list(judged.broken)
    if chain.verdict is not Proved.PROVED:
        wanted = [claim for claim in wanted if claim.move is not None and claim.move <= proved]
    return _breach(task, player, rows, judged, wanted)


def _breach(
    task: Task, player: Feedback, rows: Floats, judged: Judged, wanted: Sequence[Claim]
) -> Verdict:
    """The first row that breaks a wanted claim, with the files that replay it."""
    hit = [claim for claim in wanted if judged.broken[claim].any()]
    if not hit:
        return Silence("a run could not be finished") if judged.unfinished.any() else None
    row = int(np.flatnonzero(judged.broken[hit[0]])[0])
    breaks = tuple(claim.words for claim in wanted if judged.broken[claim][row])
    return Breach(
        what=f"certified, but broken by a run: {breaks[0]}",
        detail=f"the run breaks {', '.join(breaks)}",
        files=replay_files(
            task,
            plan_of(task, player.rules),
            player,
            rows[row],
            factor=1.0,
            engine="events",
            breaks=breaks,
        ),
    )


def _certified(batch: Batch) -> Verdict:
    task, rules = batch.variant.task(), paper_rules()
    return _kept(task, rules, certify(rules, setup_of(task)), batch.seed)


def _failing(batch: Batch) -> Verdict:
    """Make the plan fail first, then ask for a certificate."""
    task, rules = batch.variant.task(), paper_rules()
    player = _player(task, rules)
    rng = np.random.default_rng(batch.seed)
    rows = np.concatenate([corners(*limits(player), ROWS, rng), _worst(player, batch.seed)])
    judged = judge(player, only_motions(rules, player.setup), rows)
    if not any(judged.broken[claim].any() for claim in OUTCOME):
        return Silence("no run fails")
    if certify(rules, player.setup).verdict is not Proved.PROVED:
        return None
    return _breach(task, player, rows, judged, OUTCOME)


def _planned(batch: Batch) -> Verdict:
    task = batch.variant.task()
    try:
        rules = robust_at(task, 1.0)
    except NotApplicableError:
        rules = None
    if rules is None:
        return Silence("no robust plan is found")
    return _kept(task, rules, certify(rules, setup_of(task)), batch.seed)


CERTIFIED = Property(
    name="certified-is-kept",
    statement=(
        "The paper's plan at other uncertainties, starts and goals: runs by the event-driven engine "
        "(uniform, at corners, and around the worst) break nothing that its certificate proves: boxes, "
        "tubes, contacts, the goal."
    ),
    agreement="poses to 1e-12 m and rad, the accuracy of the event-driven engine",
    examples=st.builds(Batch, variant=variants(1.5), seed=_seeds),
    check=_certified,
    cost=Cost.MODERATE,
)
FAILING = Property(
    name="failing-is-not-certified",
    statement=(
        "The paper's plan at larger uncertainties, at which a run by the event-driven engine jams, "
        "cannot start, or misses the goal: the plan is not certified."
    ),
    agreement="poses to 1e-12 m and rad, the accuracy of the event-driven engine",
    examples=st.builds(Batch, variant=variants(2.5), seed=_seeds),
    check=_failing,
    cost=Cost.MODERATE,
)
PLANNED = Property(
    name="planned-is-kept",
    statement=(
        "Other parts, tips, starts, goals and uncertainties, each planned separately: runs break nothing that the "
        "certificate proves."
    ),
    agreement="poses to 1e-12 m and rad, the accuracy of the event-driven engine",
    examples=st.builds(Batch, variant=variants(1.0, shapes=True), seed=_seeds),
    check=_planned,
    cost=Cost.COSTLY,
)
