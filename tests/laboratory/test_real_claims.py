"""What is proved of real parts and probes, held against runs of the whole box."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from meso_robust.bounds import Verdict
from meso_robust.campaigns.falsify.targets import box_targets
from meso_robust.campaigns.falsify.threshold import STEPS, attack
from meso_robust.certificates.chain import Chain, certify
from meso_robust.laboratory.claims import Claims, claims_of
from meso_robust.laboratory.judging import judge
from meso_robust.laboratory.replay import Feedback
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import setup_of
from tests.laboratory.paper import paper_player, shrunk
from tests.laboratory.test_box import real_task

STATED = {
    "part": {"size_tolerance_um": 2.0, "squareness_deg": 0.1},
    "uncertainty": {
        "friction": [0.42, 0.48],
        "travel_direction_deg": [-0.1, 0.1],
        "travel_scale_percent": 0.1,
        "probe_wander_um": 0.5,
    },
}


def farther(rule: MoveRule, start: float, end: float) -> MoveRule:
    """The rule with other places (um more) where the push starts and ends."""
    x = replace(rule.dual.x, offset_um=rule.dual.x.offset_um + start)
    last = replace(rule.dual_end, offset_um=rule.dual_end.offset_um + end)
    return replace(rule, dual=replace(rule.dual, x=x), dual_end=last)


@cache
def proved() -> Chain:
    """The paper's tilt and straightening with room for round tips and parts out of true."""
    tilt, straighten = paper_player().rules[:2]
    rules = (farther(tilt, 60.0, 30.0), farther(straighten, 60.0, -160.0))
    return certify(rules, setup_of(real_task(**STATED)))


def player_and_claims() -> tuple[Feedback, Claims]:
    rules = tuple(step.rule for step in proved().steps)
    player = Feedback(rules=rules, setup=proved().setup, engine="events")
    return player, claims_of(proved(), rules)


def test_no_run_of_the_box_breaks_a_claim_about_the_moves() -> None:
    player, claims = player_and_claims()
    assert [step.verdict for step in proved().steps] == [Verdict.PROVED] * 2
    found = judge(player, claims, player.draw(3000, np.random.default_rng(1)))

    assert not found.unfinished.any()
    about_moves = {claim.words for claim, flags in found.broken.items() if flags.any()}
    assert about_moves == {"the last pose lies in the goal"}  # two moves do not reach it


def test_an_adversary_comes_near_the_boxes_and_does_not_leave_them() -> None:
    player, claims = player_and_claims()
    effort = replace(STEPS, corners=300, reaches=(1.0, 0.3), elite=1)
    sides = [target for target in box_targets(claims) if target.name.startswith("move")]
    reached = attack(player, sides, np.random.default_rng(2), effort)

    values = [reach.summit.value for reach in reached]
    assert max(values) < 1.0
    assert min(values) > 0.55


def test_boxes_that_are_too_small_are_left() -> None:
    player, claims = player_and_claims()
    posts = tuple(None if post is None else shrunk(post, 0.5) for post in claims.posts)
    found = judge(player, replace(claims, posts=posts), player.draw(300, np.random.default_rng(3)))

    broken = {claim.key for claim, flags in found.broken.items() if flags.any()}
    assert {"move_1/ends_in_box", "move_2/ends_in_box"} <= broken
