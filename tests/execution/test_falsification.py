"""Trying to break the paper's certificate, in short; the full form is ``tests.execution.falsify``."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.execution.ascent import Effort, climb, corners, shaken
from meso_robust.execution.attack import (
    Reach,
    all_targets,
    any_motion,
    attack,
    failure_at,
    misses,
    threshold,
)
from meso_robust.execution.claims import (
    CONTACT,
    Accuracy,
    Claims,
    broken,
    claims_of,
    only_motions,
    outside,
    slips,
)
from meso_robust.execution.endings import gaps_to
from meso_robust.execution.engines import Engine, push_all
from meso_robust.execution.falsification import (
    KINDS,
    Chunk,
    Kind,
    Ledger,
    Totals,
    drawn,
    execute,
    identity,
    missing,
    run_chunks,
)
from meso_robust.execution.falsification_report import report
from meso_robust.execution.judging import judge
from meso_robust.execution.meetings import crosses, meets, stick_ratio
from meso_robust.execution.running import MoveRun, PlanRun, rectangle
from meso_robust.execution.replay import Feedback, limits, nominal_row
from meso_robust.execution.targets import needed_friction
from meso_robust.certificates.chain import certify
from meso_robust.job import Planned
from meso_robust.primitives.setup import setup_of
from meso_robust.simulator import Push
from tests.execution.refuted import replayed
from tests.execution.test_replay import paper_plan_document, paper_player
from tests.conftest import paper_task

Floats = npt.NDArray[np.float64]
HALF = np.array([808e-6, 418.5e-6])
JUST_OUTSIDE = """
0x1.0eb752e80460dp-9 -0x1.dc79123a95276p-17 0x1.90c88ff81638bp+0 0x1.70a3d70a3d70bp-2
0x1.a8ed8eaa228c2p-22 -0x1.1df46a2529d3bp-8 0x1.5b860355c43d0p-20 -0x1.4f8b588e368f1p-18
-0x1.4f8b588e368f1p-18 -0x1.4f8b588e368f1p-18 0x1.9aef269a23068p-10 0x1.4f8b588e368f1p-18
-0x1.0c75b579e4448p-19 0x1.51a539a8df6cep-19 0x1.757c555ae2e46p-19 -0x1.1920a7e28b38cp-8
0x1.4f8b588e368f1p-18 0x1.4f8b588e368f1p-18 -0x1.f78aaaec985cfp-19 -0x1.21b8db90fd98dp-18
0x1.d1f7dcfbe27f0p-21 0x1.4f8b588e368f1p-18 -0x1.57254c2c9897ap-8 0x1.881c470b51362p-19
0x1.cb0a5e7062e6ap-19
"""
QUICK = Effort(corners=200, reaches=(1.0,), elite=2, generations=0)


@cache
def paper_claims() -> Claims:
    player = paper_player()
    return claims_of(certify(player.rules, player.setup), player.rules)


def exactly(factor: float = 1.0) -> Feedback:
    """The paper's plan by the event-driven engine, all uncertainties scaled."""
    setup = setup_of(paper_task(), factor)
    return replace(paper_player(), engine="events", setup=setup)


@cache
def reached() -> tuple[Reach, ...]:
    """A small attack on the paper's plan."""
    rng = np.random.default_rng(1)
    return attack(exactly(), all_targets(paper_claims()), rng, QUICK)


def seeds() -> Floats:
    return np.array([one.summit.row for one in reached()])


def broken_names(found: Totals) -> set[str]:
    return {name for name, count in found.broken.items() if count}


# executions


@pytest.mark.parametrize("kind", KINDS)
def test_no_execution_breaks_a_proved_claim(kind: Kind) -> None:
    chunk = Chunk(engine="events", kind=kind, index=0, runs=600)

    found = execute(exactly(), paper_claims(), chunk, seeds())

    assert found.runs == 600
    assert found.unfinished == 0
    assert not broken_names(found)
    # 4 moves x (start, contacts, withdrawal, box, tube), whether it can be carried out, the goal
    assert len(found.broken) == 22


def test_no_execution_by_the_stepper_breaks_a_proved_claim() -> None:
    chunk = Chunk(engine="stepper", kind="corners", index=0, runs=120)

    found = execute(exactly(), paper_claims(), chunk, seeds())

    assert not broken_names(found)
    assert found.repeated > 0  # a step's error leaves the tightest boxes, half a step's less so


def test_an_error_that_does_not_shrink_with_the_first_halving_breaks_nothing() -> None:
    """A stepped run that leaves the first move's tube by 3 nm at 2 um and at 1 um, not at 0.1 um."""
    row = np.array([[float.fromhex(value) for value in JUST_OUTSIDE.split()]])

    judged = judge(paper_player(), paper_claims(), row)

    assert not judged.any_broken.any()
    assert not judge(exactly(), paper_claims(), row).any_broken.any()


def test_both_engines_make_the_same_executions() -> None:
    rows = drawn(
        Chunk(engine="events", kind="mixed", index=3, runs=40), *limits(exactly()), seeds()
    )
    one, other = exactly().run(rows), paper_player().run(rows, step=1e-6)

    for move, same in zip(one.moves, other.moves, strict=True):
        assert np.abs(move.after - same.after)[:, :2].max() < 2e-7
        assert np.abs(move.after - same.after)[:, 2].max() < 1e-5
        assert np.ptp(move.after[:, 0]) > 1e-6
    # free, one contact, both: what the stepper's own record of modes shows as well
    phases = [set() if m.phases is None else {int(n) for n in m.phases} for m in one.moves]
    assert phases == [{2}, {3}, {5}, {3}]
    assert all(move.phases is None for move in other.moves)
    recorded = paper_player().run(rows, record=200).moves[1].modes
    assert {int(k) for k in recorded[:, -1].ravel()} == {1}


def test_the_same_chunk_is_the_same_and_the_next_one_is_not() -> None:
    chunk = Chunk(engine="events", kind="mixed", index=5, runs=30)
    low, high = limits(exactly())

    assert np.array_equal(drawn(chunk, low, high, seeds()), drawn(chunk, low, high, seeds()))
    for other in (replace(chunk, index=6), replace(chunk, seed=1), replace(chunk, kind="uniform")):
        assert not np.array_equal(
            drawn(chunk, low, high, seeds()), drawn(other, low, high, seeds())
        )


def test_draws_fill_the_box_as_they_are_named() -> None:
    low, high = limits(exactly())

    def share(kind: Kind) -> Floats:
        rows = drawn(Chunk(engine="events", kind=kind, index=0, runs=400), low, high, seeds())
        assert (rows >= low).all()
        assert (rows <= high).all()
        return np.asarray(((rows == low) | (rows == high)).mean())

    assert share("corners") == 1.0
    assert share("uniform") == 0.0
    assert 0.45 < share("mixed") < 0.55


# the checks can fail


def shrunk(boxes: Floats, share: float) -> Floats:
    """(..., 2, 3) boxes about their middles."""
    middle = boxes.mean(axis=-2, keepdims=True)
    return np.asarray(middle + share * (boxes - middle))


def found_with(claims: Claims, engine: Engine = "events") -> Totals:
    runs = 80 if engine == "events" else 8  # that many halvings of the step
    chunk = Chunk(engine=engine, kind="corners", index=0, runs=runs)
    return execute(exactly(), claims, chunk, seeds())


@pytest.mark.parametrize("engine", ["events", "stepper"])
def test_boxes_that_are_too_small_are_left(engine: Engine) -> None:
    claims = paper_claims()
    posts = tuple(None if box is None else shrunk(box, 0.3) for box in claims.posts)

    found = found_with(replace(claims, posts=posts), engine)

    assert broken_names(found) == {f"move {k}: ends in its box" for k in (1, 2, 3, 4)}
    assert found.rows


@pytest.mark.parametrize("engine", ["events", "stepper"])
def test_tubes_that_are_too_small_are_left(engine: Engine) -> None:
    claims = paper_claims()
    tubes = tuple(None if tube is None else shrunk(tube, 0.4) for tube in claims.tubes)

    found = found_with(replace(claims, tubes=tubes), engine)

    assert broken_names(found) == {f"move {k}: stays in its tube" for k in (1, 2, 3, 4)}


def test_slices_missing_from_a_tube_are_noticed() -> None:
    claims = paper_claims()
    whole = claims.tubes[2]
    assert whole is not None
    for gone in ([len(whole) - 1], [17, 18, 19]):  # two instants lie less than two slices apart
        tubes = (*claims.tubes[:2], np.delete(whole, gone, axis=0), claims.tubes[3])
        assert "move 3: stays in its tube" in broken_names(found_with(replace(claims, tubes=tubes)))


def test_a_goal_that_is_too_small_is_missed() -> None:
    setup = setup_of(paper_task(goal__position_tolerance_um=15.0))

    found = found_with(replace(paper_claims(), setup=setup))

    assert broken_names(found) == {"the last pose lies in the goal"}


def test_friction_that_is_too_low_slips_and_too_high_jams() -> None:
    player, rows = exactly(), nominal_row(exactly()).repeat(2, axis=0)
    rows[:, 3] = (0.24, 0.6)

    judged = judge(player, paper_claims(), rows)

    assert judged.broken["move 4: contacts are as claimed"].tolist() == [True, False]
    assert judged.broken["every move can be carried out"].tolist() == [False, True]
    assert judged.runs.failed_in.tolist() == [4, 2]


def at_end(**changes: Any) -> PlanRun:
    """The second move of the nominal run of the paper's plan, moved by hand."""
    rows = nominal_row(exactly())
    runs = exactly().run(rows)
    moves = list(runs.moves)
    moves[1] = replace(moves[1], **changes)
    return replace(runs, moves=tuple(moves))


def judged_by_hand(runs: PlanRun) -> set[str]:
    accuracy = Accuracy(slip=1e-9, pose=(np.full((1, 3), 1e-12),) * 4)
    found = broken(runs, only_motions(paper_player().rules, paper_player().setup), accuracy)
    return {name for name, flags in found.items() if flags.any()}


def test_every_contact_claim_is_judged() -> None:
    move = exactly().run(nominal_row(exactly())).moves[1]
    assert judged_by_hand(at_end()) == set()

    off_both = move.after + np.array([-1e-6, 0.0, 0.0])
    assert judged_by_hand(at_end(after=off_both)) == {"move 2: contacts are as claimed"}
    for held, turn in ((0, -1e-5), (1, 1e-5)):  # about one of the tips: the other one is off then
        tip = (move.tips + move.travel)[0, held]
        arm = move.after[0, :2] - tip
        turned = np.array([[*tip + arm + turn * np.array([-arm[1], arm[0]]), 0.0]])
        turned[0, 2] = move.after[0, 2] + turn
        gaps = gaps_to((move.tips + move.travel)[0], turned[0], HALF)
        assert np.abs(gaps).min() < CONTACT < np.abs(gaps).max()
        assert judged_by_hand(at_end(after=turned)) == {"move 2: contacts are as claimed"}
    slipped = move.after + np.array(
        [0.0, 1e-7, 0.0]
    )  # along the upright edge, both tips still on it
    assert judged_by_hand(at_end(after=slipped)) == {"move 2: contacts are as claimed"}
    one_more = np.array([4])
    assert judged_by_hand(at_end(phases=one_more)) == {"move 2: contacts are as claimed"}
    inside = move.tips + np.array([-70e-6, 0.0])
    assert "move 2: starts free of contact" in judged_by_hand(at_end(tips=inside))


def test_a_probe_that_cannot_withdraw_is_noticed() -> None:
    """The tips end on the far side of the part, as if they had gone through it."""
    move = exactly().run(nominal_row(exactly())).moves[1]
    beyond = move.travel + np.array([-2.0 * HALF[1], 0.0])

    assert "move 2: probes withdraw clear of the part" in judged_by_hand(at_end(travel=beyond))


# geometry by hand


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


def _alone(move: MoveRun, friction: float, film_ratio: float) -> MoveRun:
    """The same move with another friction, by the event-driven engine."""
    push = Push.straight(
        vertices=rectangle(exactly().setup),
        poses=move.before,
        tips=move.tips,
        travel=move.travel,
        friction=np.array([friction]),
        film_ratio=np.array([film_ratio]),
        step=1e-6,
    )
    return replace(move, after=push_all(push, "events").poses)


def test_needed_friction_is_what_the_engine_needs() -> None:
    """Just above it nothing slips, just below it the contact does, in the event-driven engine."""
    rows = nominal_row(exactly())
    moves = exactly().run(rows).moves
    for k in (0, 1, 3):
        needed = needed_friction(moves[k], HALF, rows[:, 4])[0]
        # the move by itself: the ones before it may slip as well at this friction
        held = [_alone(moves[k], share * needed, rows[0, 4]) for share in (1.001, 0.999)]
        assert slips(held[0], HALF)[0] < 1e-15
        assert slips(held[1], HALF)[0] > 1e-12


def test_outside_of_all_boxes_and_of_none() -> None:
    boxes = np.array([[[0.0] * 3, [1.0] * 3], [[2.0] * 3, [3.0] * 3]])
    poses = np.array([[0.5] * 3, [2.0] * 3, [1.5] * 3, [0.5, 0.5, 2.5], [0.5, 0.5, 1.05]])
    exact, slack = np.zeros((1, 3)), np.full((1, 3), 0.1)

    assert outside(poses, boxes, exact).tolist() == [False, False, True, True, True]
    assert outside(poses, boxes, slack).tolist() == [False, False, True, True, False]


# the adversary


def test_climbing_finds_ends_and_interior_points() -> None:
    low, high = np.full(4, -1.0), np.full(4, 2.0)
    at = np.array([0.3, -0.7, 1.1, 2.0])
    rng = np.random.default_rng(0)
    pool = corners(low, high, 30, rng)

    def score(rows: Floats) -> Floats:
        own = rows - at
        return np.asarray(-np.sum(own**2, axis=1) - 0.9 * own[:, 0] * own[:, 1])

    found = climb(score, pool, score(pool), (low, high), rng, Effort(generations=40))

    assert found.value > -1e-3
    assert found.row[3] == 2.0
    assert found.evaluations > 100


def test_the_adversary_stays_in_the_box_of_what_is_uncertain() -> None:
    low, high = limits(exactly())
    rows = shaken(seeds(), low, high, 500, np.random.default_rng(3))

    for some in (seeds(), rows):
        assert (some >= low).all()
        assert (some <= high).all()


def test_the_adversary_reaches_the_ends_of_tight_boxes_and_leaves_none() -> None:
    """Orientations after straightening and rotating are kinematic: their boxes have no slack."""
    values = {one.target.name: one.summit.value for one in reached()}

    assert len(values) == 8 + 5 * 6
    assert not any(one.breaks for one in reached() if one.target.unit != "half widths")
    for name, value in values.items():
        assert value <= 1.0 + 1e-9, name
    for k in (2, 3, 4):
        assert values[f"move {k}: box, theta low"] > 0.999
    assert values["move 2: box, y low"] > 0.9
    rows = {one.target.name: one.summit.row for one in reached()}
    ends = [rows[f"move 2: box, y {side}"] for side in ("low", "high")]
    y = exactly().run(np.array(ends)).moves[1].after[:, 1]
    assert y[1] - y[0] > 15e-6


def test_the_adversary_leaves_boxes_that_are_too_small() -> None:
    claims = paper_claims()
    first = claims.posts[0]
    assert first is not None
    small = replace(claims, posts=(shrunk(first, 0.35), None, None, None))
    targets = [t for t in all_targets(small) if t.name.startswith("move 1: box")]

    found = attack(exactly(), targets, np.random.default_rng(0), QUICK)

    assert len(found) == 6
    assert all(one.breaks for one in found)


def test_what_fails_first_beyond_the_certified_margin() -> None:
    """Certified up to 1.20; contacts slip from 1.21 on, the part jams only from 1.35 on."""
    rng = np.random.default_rng(0)
    assert failure_at(exactly(1.2), 1.2, any_motion, rng, QUICK) is None
    slip = failure_at(exactly(1.24), 1.24, any_motion, rng, QUICK)
    assert slip is not None
    assert slip.claims == ("move 4: contacts are as claimed",)
    corners_only = replace(QUICK, corners=400, reaches=())
    assert failure_at(exactly(1.3), 1.3, any_motion, rng, corners_only) is not None
    assert failure_at(exactly(1.3), 1.3, misses, rng, corners_only) is None
    jam = failure_at(exactly(1.45), 1.45, misses, rng, QUICK)
    assert jam is not None
    assert jam.claims == ("every move can be carried out",)
    low, high = limits(exactly(1.45))
    assert (jam.row >= low).all()
    assert (jam.row <= high).all()


def test_threshold_is_bracketed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bisection against a failure that is known: everything fails from 1.37 on."""
    from meso_robust.execution import attack as module

    def fails(player: Feedback, factor: float, *_: object) -> object:
        width = player.setup.uncertainty.friction.width
        assert width == pytest.approx(0.06 * factor)
        failure = module.Failure(factor=factor, claims=("made up",), row=np.zeros(1), runs=1)
        return failure if factor >= 1.37 else None

    monkeypatch.setattr(module, "failure_at", fails)
    found = threshold(exactly(), lambda f: setup_of(paper_task(), f), misses)

    assert found.failure is not None
    assert found.holds < 1.37 <= found.failure.factor <= found.holds * 1.003


# totals


def ledger(folder: Path) -> Ledger:
    return Ledger(path=folder / "totals.jsonl", identity=identity(paper_plan_document()))


def test_a_campaign_goes_on_where_it_was_ended(tmp_path: Path) -> None:
    file, work = ledger(tmp_path), (exactly(), paper_claims(), seeds())
    wanted = [Chunk(engine="events", kind="mixed", index=k, runs=20) for k in range(3)]
    assert [c.index for c in run_chunks(file, work, wanted[:2])] == [0, 1]
    with file.path.open("a") as end:
        end.write('{"what": "chunk", "pl')  # ended while writing

    assert missing(file, wanted) == wanted[2:]
    assert [c.index for c in run_chunks(file, work, wanted)] == [2]

    kept = [found for _, found, _ in file.chunks()]
    alone = [execute(*work[:2], chunk, work[2]) for chunk in wanted]
    assert [replace(one, seconds=0.0) for one in kept] == [replace(a, seconds=0.0) for a in alone]
    whole = kept[0].plus(kept[1]).plus(kept[2])
    assert whole.runs == 60
    ends = np.array([one.after for one in alone])
    assert np.array_equal(np.array(whole.after)[:, 0], ends[:, :, 0].min(axis=0))
    assert np.array_equal(np.array(whole.after)[:, 1], ends[:, :, 1].max(axis=0))


def test_totals_of_another_plan_are_refused(tmp_path: Path) -> None:
    file = ledger(tmp_path)
    file.add("chunk", {})
    other = replace(file, identity="0" * 64)

    with pytest.raises(ValueError, match=r"line 1: plan .* give another file"):
        list(other.lines("chunk"))


def test_identity_is_that_of_the_policy() -> None:
    plan = paper_plan_document()
    rule = plan.policy[0].model_copy(update={"side": -1})

    assert identity(plan) == identity(plan.model_copy(update={"moves": ()}))
    assert identity(plan) != identity(plan.model_copy(update={"policy": (rule, *plan.policy[1:])}))


def test_the_report_tells_what_broke_and_nothing_else(tmp_path: Path) -> None:
    file, claims = ledger(tmp_path), paper_claims()
    posts = tuple(None if box is None else shrunk(box, 0.3) for box in claims.posts)
    chunk = Chunk(engine="events", kind="corners", index=0, runs=40)
    list(run_chunks(file, (exactly(), claims, seeds()), [chunk]))
    clean = report("paper", file, claims, "the command")
    assert "| event-driven | corners | 40 | 0 | 0 |" in clean
    assert "Rows that broke" not in clean

    small, again = replace(claims, posts=posts), replace(chunk, index=1)
    list(run_chunks(file, (exactly(), small, seeds()), [again]))
    bad = report("paper", file, claims, "the command")

    lines = [found for _, found, _ in file.chunks()]
    count = sum(lines[1].broken.values())
    assert count > 0
    assert f"| event-driven | corners | 80 | {count} | 0 |" in bad
    assert f"`{' '.join(lines[1].rows[0])}`" in bad
    assert "40 of the runs were held, run by run, against an earlier state" in bad


# refuted


def test_the_witness_of_a_refuted_certificate_fails_again_by_both_engines(
    wide_friction_plan: Planned, tmp_path: Path
) -> None:
    found = replayed(wide_friction_plan, "wide friction", tmp_path)

    assert found.verdict == "REFUTED"
    assert found.status == 1
    assert found.fails, found


def test_a_witness_that_does_not_fail_is_told(wide_friction_plan: Planned, tmp_path: Path) -> None:
    certificate = wide_friction_plan.certificate
    witness = certificate.witness
    assert witness is not None
    zero = (0.0).hex()
    harmless = witness.model_copy(
        update={
            "friction": (0.33).hex(),
            "start": tuple(float(v).hex() for v in wide_friction_plan.setup.start.mid),
            "sensing": ((zero, zero, zero),) * 4,
            "dual_probe": ((zero, zero),) * 4,
            "single_probe": ((zero, zero),) * 4,
        }
    )
    made_up = certificate.model_copy(update={"witness": harmless})

    found = replayed(replace(wide_friction_plan, certificate=made_up), "made up", tmp_path)

    assert not found.fails
    assert found.stepper.startswith("completed")
    assert found.events.startswith("completed")
