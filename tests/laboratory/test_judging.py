"""Runs of the paper's plan held against what is claimed of it, and against less."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.bounds import Interval
from meso_robust.laboratory.ascent import corners
from meso_robust.laboratory.claim_ids import CARRIED_OUT, REACHES_GOAL, Claim, ClaimId
from meso_robust.laboratory.claims import Claims
from meso_robust.laboratory.engines import NOT_RECORDED, Engine
from meso_robust.laboratory.judging import Judged, judge
from meso_robust.laboratory.replay import Feedback, limits, nominal_row
from meso_robust.laboratory.running import STEP, PlanRun
from meso_robust.primitives.setup import setup_of
from meso_robust.simulator import Outcome
from tests.conftest import paper_task
from tests.laboratory.paper import exactly, paper_claims, paper_player, shrunk

Floats = npt.NDArray[np.float64]
JUST_OUTSIDE = """
0x1.0eb752e80460dp-9 -0x1.dc79123a95276p-17 0x1.90c88ff81638bp+0 0x1.70a3d70a3d70bp-2
0x1.a8ed8eaa228c2p-22 -0x1.1df46a2529d3bp-8 0x1.5b860355c43d0p-20 -0x1.4f8b588e368f1p-18
-0x1.4f8b588e368f1p-18 -0x1.4f8b588e368f1p-18 0x1.9aef269a23068p-10 0x1.4f8b588e368f1p-18
-0x1.0c75b579e4448p-19 0x1.51a539a8df6cep-19 0x1.757c555ae2e46p-19 -0x1.1920a7e28b38cp-8
0x1.4f8b588e368f1p-18 0x1.4f8b588e368f1p-18 -0x1.f78aaaec985cfp-19 -0x1.21b8db90fd98dp-18
0x1.d1f7dcfbe27f0p-21 0x1.4f8b588e368f1p-18 -0x1.57254c2c9897ap-8 0x1.881c470b51362p-19
0x1.cb0a5e7062e6ap-19
"""


def broken_claims(found: Judged) -> set[Claim]:
    return {claim for claim, flags in found.broken.items() if flags.any()}


def found_with(claims: Claims, engine: Engine = "events") -> Judged:
    runs = 80 if engine == "events" else 8  # that many halvings of the step
    rows = corners(*limits(exactly()), runs, np.random.default_rng(0))
    return judge(replace(exactly(), engine=engine), claims, rows)


def test_no_corner_breaks_a_proved_claim_by_the_stepper() -> None:
    rows = corners(*limits(exactly()), 120, np.random.default_rng(0))

    found = judge(paper_player(), paper_claims(), rows)

    assert not broken_claims(found)
    assert found.repeated > 0  # a step's error leaves the tightest boxes, half a step's less so


def test_an_error_that_does_not_shrink_with_the_first_halving_breaks_nothing() -> None:
    """A stepped run that leaves the first move's tube by 3 nm at 2 um and at 1 um, not at 0.1 um."""
    row = np.array([[float.fromhex(value) for value in JUST_OUTSIDE.split()]])

    judged = judge(paper_player(), paper_claims(), row)

    assert not judged.any_broken.any()
    assert not judge(exactly(), paper_claims(), row).any_broken.any()


def test_both_engines_make_the_same_executions() -> None:
    low, high = limits(exactly())
    rows = low + np.random.default_rng(3).random((40, len(low))) * (high - low)
    one, other = exactly().run(rows), paper_player().run(rows, step=1e-6)

    for move, same in zip(one.moves, other.moves, strict=True):
        assert np.abs(move.after - same.after)[:, :2].max() < 2e-7
        assert np.abs(move.after - same.after)[:, 2].max() < 1e-5
        assert np.ptp(move.after[:, 0]) > 1e-6
    # free, one contact, both: what the stepper's own record of modes shows as well
    phases = [{int(n) for n in move.phases} for move in one.moves]
    assert phases == [{2}, {3}, {5}, {3}]
    assert all((move.phases == NOT_RECORDED).all() for move in other.moves)
    recorded = paper_player().run(rows, record=200).moves[1].modes
    assert {int(k) for k in recorded[:, -1].ravel()} == {1}


# the checks can fail


@pytest.mark.parametrize("engine", ["events", "stepper"])
def test_boxes_that_are_too_small_are_left(engine: Engine) -> None:
    claims = paper_claims()
    posts = tuple(None if box is None else shrunk(box, 0.3) for box in claims.posts)

    found = found_with(replace(claims, posts=posts), engine)

    assert broken_claims(found) == {Claim(ClaimId.ENDS_IN_BOX, k) for k in (1, 2, 3, 4)}


@pytest.mark.parametrize("engine", ["events", "stepper"])
def test_tubes_that_are_too_small_are_left(engine: Engine) -> None:
    claims = paper_claims()
    tubes = tuple(None if tube is None else shrunk(tube, 0.4) for tube in claims.tubes)

    found = found_with(replace(claims, tubes=tubes), engine)

    assert broken_claims(found) == {Claim(ClaimId.STAYS_IN_TUBE, k) for k in (1, 2, 3, 4)}


def test_slices_missing_from_a_tube_are_noticed() -> None:
    claims = paper_claims()
    whole = claims.tubes[2]
    assert whole is not None
    for gone in ([len(whole) - 1], [17, 18, 19]):  # two instants lie less than two slices apart
        tubes = (*claims.tubes[:2], np.delete(whole, gone, axis=0), claims.tubes[3])
        assert Claim(ClaimId.STAYS_IN_TUBE, 3) in broken_claims(
            found_with(replace(claims, tubes=tubes))
        )


def test_a_goal_that_is_too_small_is_missed() -> None:
    setup = setup_of(paper_task(goal__position_tolerance_um=15.0))

    found = found_with(replace(paper_claims(), setup=setup))

    assert broken_claims(found) == {REACHES_GOAL}


@pytest.mark.parametrize(("cap_un", "moves"), [(16.0, {3}), (12.0, {1, 2, 3, 4})])
def test_a_tip_that_presses_harder_than_the_cap_is_noticed(cap_un: float, moves: set[int]) -> None:
    """One that carries the part along presses with drag and speed: 15 uN here."""
    cap, drag, speed = (Interval.point(value) for value in (1e-6 * cap_un, 0.2, 75e-6))
    setup = replace(paper_claims().setup, largest_force=cap, drag=drag, speed=speed)
    claims = replace(paper_claims(), setup=setup)

    found = broken_claims(found_with(claims, "stepper"))

    assert found == {Claim(ClaimId.FORCES_BELOW_CAP, k) for k in moves}
    assert not broken_claims(found_with(claims, "events"))  # which keeps no forces


def test_friction_that_is_too_low_slips_and_too_high_jams() -> None:
    player, rows = exactly(), nominal_row(exactly()).repeat(2, axis=0)
    rows[:, 3] = (0.24, 0.6)

    judged = judge(player, paper_claims(), rows)

    assert judged.broken[Claim(ClaimId.CONTACTS, 4)].tolist() == [True, False]
    assert judged.broken[CARRIED_OUT].tolist() == [False, True]
    assert judged.runs.failed_in.tolist() == [4, 2]


@dataclass(frozen=True, slots=True, eq=False)
class Failing(Feedback):
    """Cannot finish a run at steps below the usual one."""

    def run(self, rows: Floats, *, record: int = 0, step: float = STEP) -> PlanRun:
        found = Feedback.run(self, rows, record=record, step=step)
        if step == STEP:
            return found
        outcomes = np.full(len(rows), Outcome.SOLVER_FAILURE, dtype=np.int8)
        return replace(found, outcomes=outcomes, failed_in=np.zeros(len(rows), dtype=np.int64))


def test_a_suspect_that_cannot_be_finished_at_a_finer_step_is_not_acquitted() -> None:
    player = paper_player()
    rows = corners(*limits(player), 40, np.random.default_rng(0))
    finished = judge(player, paper_claims(), rows)
    assert finished.repeated > 0
    assert not finished.unfinished.any()

    failing = Failing(rules=player.rules, setup=player.setup)
    judged = judge(failing, paper_claims(), rows)

    assert int(judged.unfinished.sum()) == judged.repeated == finished.repeated
    assert not (judged.unfinished & judged.any_broken).any()
