"""Claims judged by plain geometry: what keeps them and what breaks them, by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.laboratory.claim_ids import REACHES_GOAL, Claim, ClaimId
from meso_robust.laboratory.claims import (
    CONTACT,
    Accuracy,
    broken,
    only_motions,
    outside,
    slips,
)
from meso_robust.laboratory.geometry import gaps_to
from meso_robust.laboratory.meetings import CORNER, crosses, meets, stick_ratio
from meso_robust.laboratory.replay import nominal_row
from meso_robust.laboratory.running import MoveRun, PlanRun
from tests.laboratory.paper import exactly, paper_player

Floats = npt.NDArray[np.float64]
HALF = np.array([808e-6, 418.5e-6])


def plates(count: int) -> Floats:
    """(N, 4, 2) the paper's part."""
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * HALF
    return np.broadcast_to(corners, (count, 4, 2))


def at_end(**changes: Any) -> PlanRun:
    """The second move of the nominal run of the paper's plan, moved by hand."""
    rows = nominal_row(exactly())
    runs = exactly().run(rows)
    moves = list(runs.moves)
    moves[1] = replace(moves[1], **changes)
    return replace(runs, moves=tuple(moves))


def judged_by_hand(runs: PlanRun, creep: float = 0.0) -> set[Claim]:
    accuracy = Accuracy(slip=1e-9, pose=(np.full((1, 3), 1e-12),) * 4)
    claims = only_motions(paper_player().rules, paper_player().setup)
    claims = replace(claims, creeps=(0.0, creep, 0.0, 0.0))
    found = broken(runs, claims, accuracy)
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
        gaps = gaps_to(move.ends, turned, move.outlines, move.radii)
        assert np.abs(gaps).min() < CONTACT < np.abs(gaps).max()
        assert judged_by_hand(at_end(after=turned)) == {Claim(ClaimId.CONTACTS, 2)}
    slipped = move.after + np.array(
        [0.0, 1e-7, 0.0]
    )  # along the upright edge, both tips still on it
    assert judged_by_hand(at_end(after=slipped)) == {Claim(ClaimId.CONTACTS, 2)}
    # unless it may slip so far at this lean
    lean = abs(float(move.after[0, 2] - move.before[0, 2])) + 0.05
    enough = 1e-7 / math.sin(lean) ** 3
    assert judged_by_hand(at_end(after=slipped), 1.01 * enough) == set()
    assert judged_by_hand(at_end(after=slipped), 0.9 * enough) == {Claim(ClaimId.CONTACTS, 2)}
    one_more = np.array([4])
    assert judged_by_hand(at_end(phases=one_more)) == {Claim(ClaimId.CONTACTS, 2)}
    inside = move.ways + np.array([-70e-6, 0.0])
    assert Claim(ClaimId.STARTS_FREE, 2) in judged_by_hand(at_end(ways=inside))


def test_a_probe_that_cannot_withdraw_is_noticed() -> None:
    """The tips end on the far side of the part, as if they had gone through it."""
    move = exactly().run(nominal_row(exactly())).moves[1]
    beyond = move.ways.copy()
    beyond[:, -1] += np.array([-2.0 * HALF[1], 0.0])

    assert Claim(ClaimId.RETRACTS, 2) in judged_by_hand(at_end(ways=beyond))


def test_a_tip_meets_a_rectangle_where_it_does_by_hand() -> None:
    tip = np.array([[1e-3, 100e-6], [1e-3, 900e-6], [-1e-3, 0.0]])[:, None]
    ways = np.stack([tip, tip + np.array([-200e-6, 0.0]), tip + np.array([-400e-6, 0.0])], axis=1)
    upright, points = np.zeros((3, 3)), np.zeros((3, 1))

    met = meets(ways, points, upright, plates(3))

    assert met.share[0, 0] == pytest.approx(192.0 / 200.0)
    assert np.isinf(met.share[1:]).all()
    assert (met.edge[0, 0], met.along[0, 0]) == (1, pytest.approx((418.5 + 100.0) * 1e-6))
    turned = np.array([[0.0, 0.0, math.pi / 2]])
    met = meets(ways[:1] + np.array([-350e-6, 0.0]), points[:1], turned, plates(1))
    # the part's y axis points along -x: the tip meets its lower edge, 100 um along its x axis
    assert met.share[0, 0] == pytest.approx(231.5 / 200.0)
    assert (met.edge[0, 0], met.along[0, 0]) == (0, pytest.approx((808.0 + 100.0) * 1e-6))


def test_a_disc_meets_an_edge_earlier_and_a_corner_by_its_circle() -> None:
    """10 um across the corner's height: sqrt(12.5^2 - 10^2) = 7.5 um before it."""
    tip = np.array([[1e-3, 100e-6], [1e-3, 428.5e-6], [1e-3, 440e-6]])[:, None]
    ways = np.stack([tip, tip + np.array([-400e-6, 0.0])], axis=1)

    met = meets(ways, np.full((3, 1), 12.5e-6), np.zeros((3, 3)), plates(3))

    assert met.share[:2, 0] == pytest.approx([(192.0 - 12.5) / 400.0, (192.0 - 7.5) / 400.0])
    assert np.isinf(met.share[2, 0])
    assert met.edge[:, 0].tolist() == [1, CORNER, CORNER]


def test_ways_that_cross_and_that_do_not() -> None:
    tip = np.array([[808e-6, 0.0], [808e-6, 0.0], [900e-6, 500e-6], [900e-6, 400e-6]])[:, None]
    way = np.array([[1e-3, 0.0], [-1e-3, 0.0], [-2e-3, 0.0], [-2e-3, 0.0]])[:, None]
    upright, parts = np.zeros((4, 3)), plates(4)

    points = crosses(tip, way, np.zeros((4, 1)), upright, parts, 1e-9)
    discs = crosses(tip + np.array([1e-4, 0.0]), way, np.full((4, 1), 1e-4), upright, parts, 1e-9)

    assert points.tolist() == [False, True, False, True]
    assert discs.tolist() == [False, True, True, True]  # 81.5 um above the edge, less than 100


def test_slip_is_what_a_disc_has_not_rolled() -> None:
    """The part turns by 0.1 rad about a disc of 10 um that stays: rolled 1 um back along its edge."""
    tip, turn, radius = np.array([818e-6, 50e-6]), 0.1, 10e-6
    legs = [[100e-6, 0.0], [-1e-6, 0.0], [0.0, 0.0]]  # a little too far, and back
    ways = (tip + np.array(legs))[None, :, None]
    way = np.repeat(ways, 2, axis=2)
    way[..., 1, 1] += 600e-6  # the other tip passes the part
    for rolled, slipped in ((radius * turn, 0.0), (0.0, radius * turn)):
        c, s = math.cos(turn), math.sin(turn)
        # the edge x = 808 um of the turned part, its point at 50 um - rolled against the disc
        point = np.array([808e-6 + radius, 50e-6 - rolled])
        where = tip - [c * point[0] - s * point[1], s * point[0] + c * point[1]]
        move = MoveRun(
            before=np.zeros((1, 3)), sensed=np.zeros((1, 3)), ways=way,
            radii=np.full((1, 2), radius), outlines=plates(1), path=np.zeros((1, 1, 3)),
            modes=np.zeros((1, 1, 2), dtype=np.int8), phases=np.ones(1, dtype=np.int64),
            after=np.array([[*where, turn]]),
        )  # fmt: skip

        assert slips(move) == pytest.approx([slipped], abs=1e-15)


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
