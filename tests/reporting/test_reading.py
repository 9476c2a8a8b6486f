"""What the report reads out of a result."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meso_robust.bounds import Proof, Verdict
from meso_robust.pipeline import Planned
from meso_robust.reporting.reading import Standing, endings, standings, thinned


def test_thinning_keeps_the_extreme_poses() -> None:
    poses = np.random.default_rng(0).normal(size=(5000, 3))
    kept = thinned(poses, 200)
    assert 200 <= len(kept) <= 206
    np.testing.assert_array_equal(kept.min(axis=0), poses.min(axis=0))
    np.testing.assert_array_equal(kept.max(axis=0), poses.max(axis=0))


def test_few_poses_are_all_kept() -> None:
    poses = np.ones((30, 3))
    assert thinned(poses, 30) is poses


def test_every_move_of_a_proved_plan_is_certified(proved: Planned) -> None:
    assert standings(proved.chain, 4) == (Standing.CERTIFIED,) * 4


def test_a_proof_after_an_open_step_counts_only_conditionally(proved: Planned) -> None:
    steps = list(proved.chain.steps)
    first = steps[1].obligations[0]
    open_ = Proof(verdict=Verdict.UNKNOWN, lower=-np.inf, boxes=1, box=first.proof.box)
    steps[1] = replace(steps[1], obligations=(replace(first, proof=open_),))
    chain = replace(proved.chain, steps=tuple(steps[:3]), complete=False)
    wanted = (Standing.CERTIFIED, Standing.OPEN, Standing.CONDITIONAL, Standing.NOT_REACHED)
    assert standings(chain, 4) == wanted


def test_endings_count_every_run_that_fails(refuted: Planned, proved: Planned) -> None:
    counts = [count for _, _, count in endings(refuted.check)]
    assert sum(counts) == int((~refuted.check.in_goal).sum()) > 0
    assert counts == sorted(counts, reverse=True)
    assert endings(proved.check) == ()
