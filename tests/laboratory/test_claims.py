"""Claims judged by plain geometry: what keeps them and what breaks them, by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.laboratory.claim_ids import REACHES_GOAL, Claim, ClaimId
from meso_robust.laboratory.claims import CONTACT, Accuracy, broken, only_motions, outside
from meso_robust.laboratory.geometry import gaps_to
from meso_robust.laboratory.meetings import crosses, meets, stick_ratio
from meso_robust.laboratory.replay import nominal_row
from meso_robust.laboratory.running import PlanRun
from tests.laboratory.paper import exactly, paper_player

Floats = npt.NDArray[np.float64]
HALF = np.array([808e-6, 418.5e-6])


def at_end(**changes: Any) -> PlanRun:
    """The second move of the nominal run of the paper's plan, moved by hand."""
    rows = nominal_row(exactly())
    runs = exactly().run(rows)
    moves = list(runs.moves)
    moves[1] = replace(moves[1], **changes)
    return replace(runs, moves=tuple(moves))


def judged_by_hand(runs: PlanRun) -> set[Claim]:
    accuracy = Accuracy(slip=1e-9, pose=(np.full((1, 3), 1e-12),) * 4)
    found = broken(runs, only_motions(paper_player().rules, paper_player().setup), accuracy)
    return {claim for claim, flags in found.items() if flags.any()}


def test_every_contact_claim_is_judged() -> None:
    move = exactly().run(nominal_row(exactly())).moves[1]
    assert judged_by_hand(at_end()) == set()

    off_both = move.after + np.array([-1e-6, 0.0, 0.0])
    assert judged_by_hand(at_end(after=off_both)) == {Claim(ClaimId.CONTACTS, 2)}
    for held, turn in ((0, -1e-5), (1, 1e-5)):  # about one of the tips: the other one is off then
        tip = (move.tips + move.travel)[0, held]
        arm = move.after[0, :2] - tip
        turned = np.array([[*tip + arm + turn * np.array([-arm[1], arm[0]]), 0.0]])
        turned[0, 2] = move.after[0, 2] + turn
        gaps = gaps_to((move.tips + move.travel)[0], turned[0], HALF)
        assert np.abs(gaps).min() < CONTACT < np.abs(gaps).max()
        assert judged_by_hand(at_end(after=turned)) == {Claim(ClaimId.CONTACTS, 2)}
    slipped = move.after + np.array(
        [0.0, 1e-7, 0.0]
    )  # along the upright edge, both tips still on it
    assert judged_by_hand(at_end(after=slipped)) == {Claim(ClaimId.CONTACTS, 2)}
    one_more = np.array([4])
    assert judged_by_hand(at_end(phases=one_more)) == {Claim(ClaimId.CONTACTS, 2)}
    inside = move.tips + np.array([-70e-6, 0.0])
    assert Claim(ClaimId.STARTS_FREE, 2) in judged_by_hand(at_end(tips=inside))


def test_a_probe_that_cannot_withdraw_is_noticed() -> None:
    """The tips end on the far side of the part, as if they had gone through it."""
    move = exactly().run(nominal_row(exactly())).moves[1]
    beyond = move.travel + np.array([-2.0 * HALF[1], 0.0])

    assert Claim(ClaimId.RETRACTS, 2) in judged_by_hand(at_end(travel=beyond))


def test_a_tip_meets_a_rectangle_where_it_does_by_hand() -> None:
    tip = np.array([[1e-3, 100e-6], [1e-3, 900e-6], [-1e-3, 0.0]])
    way = np.full((3, 2), [-400e-6, 0.0])
    upright = np.zeros((3, 3))

    share, point, normal = meets(tip, way, upright, HALF)

    assert share[0] == pytest.approx(192.0 / 400.0)
    assert np.isinf(share[1:]).all()
    assert point[0] == pytest.approx([808e-6, 100e-6])
    assert normal[0].tolist() == [-1.0, 0.0]
    turned = np.array([[0.0, 0.0, math.pi / 2]])
    share, point, normal = meets(tip[:1], way[:1], turned, HALF)
    # the part's y axis points along -x: the tip meets its lower edge, 100 um along its x axis
    assert share == pytest.approx([581.5 / 400.0])
    assert point[0] == pytest.approx([100e-6, -418.5e-6])
    assert normal[0].tolist() == [0.0, 1.0]


def test_ways_that_cross_and_that_do_not() -> None:
    tip = np.array([[808e-6, 0.0], [808e-6, 0.0], [900e-6, 500e-6], [900e-6, 400e-6]])
    way = np.array([[1e-3, 0.0], [-1e-3, 0.0], [-2e-3, 0.0], [-2e-3, 0.0]])

    assert crosses(tip, way, np.zeros((4, 3)), HALF, 1e-9).tolist() == [False, True, False, True]


def test_stick_ratio_of_the_limits_of_the_film() -> None:
    """A film that turns freely: the force goes through the centre; one that never turns: straight."""
    point, normal = np.array([[418.5e-6, 200e-6]]), np.array([[-1.0, 0.0]])
    way, pose = np.array([[-1.0, 0.0]]), np.zeros((1, 3))

    free = stick_ratio(point, normal, way, pose, np.array([1e-16]))
    stiff = stick_ratio(point, normal, way, pose, np.array([1.0]))

    assert free == pytest.approx([200.0 / 418.5], rel=1e-6)
    assert stiff == pytest.approx([0.0], abs=1e-6)


def test_outside_of_all_boxes_and_of_none() -> None:
    boxes = np.array([[[0.0] * 3, [1.0] * 3], [[2.0] * 3, [3.0] * 3]])
    poses = np.array([[0.5] * 3, [2.0] * 3, [1.5] * 3, [0.5, 0.5, 2.5], [0.5, 0.5, 1.05]])
    exact, slack = np.zeros((1, 3)), np.full((1, 3), 0.1)

    assert outside(poses, boxes, exact).tolist() == [False, False, True, True, True]
    assert outside(poses, boxes, slack).tolist() == [False, False, True, True, False]


def test_a_claim_has_a_key_that_stays_and_words_that_files_hold() -> None:
    box = Claim(ClaimId.ENDS_IN_BOX, 2)

    assert (box.key, box.words) == ("move_2/ends_in_box", "move 2: ends in its box")
    assert (REACHES_GOAL.key, REACHES_GOAL.words) == (
        "reaches_goal",
        "the last pose lies in the goal",
    )
    assert len({Claim(id_).words for id_ in ClaimId}) == len(ClaimId)
