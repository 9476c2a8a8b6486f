"""Plans as something to be run: the same runs as elsewhere, and a search that tells the truth."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from meso_robust.laboratory.adversary import badness, search
from meso_robust.laboratory.draws import draw, nominal
from meso_robust.laboratory.endings import ending
from meso_robust.laboratory.geometry import gaps_to
from meso_robust.laboratory.open_loop import OpenLoop
from meso_robust.laboratory.replay import Feedback, limits, miss, nominal_row
from meso_robust.laboratory.running import STARTS_INSIDE, MoveRun, PlanRun, excess, run
from meso_robust.laboratory.simulation import player_of, simulated
from meso_robust.laboratory.trajectories import trajectories
from meso_robust.planning.document import MoveDocument, PlanDocument, ProbeDocument, plan_document
from meso_robust.primitives.move import MoveRule, Point, from_part, in_world
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.simulator import Outcome
from meso_robust.task import load_task
from meso_robust.tasks import SLOT
from tests.conftest import paper_task
from tests.laboratory.paper import paper_player

SCALE = np.array([1e6, 1e6, 180.0 / math.pi])


def push(end: float, *, world: bool = False) -> MoveRule:
    """Both tips on the long edge, symmetric."""
    return MoveRule(
        step=4,
        primitive="x_translation",
        action="straighten",
        side=0,
        dual=Point(x=from_part(450.0), y=from_part(0.0)),
        dual_end=in_world(end) if world else from_part(end),
    )


def turn(separation_um: float) -> MoveRule:
    """Lower active tip and passive tip that far apart in y: jams below w sqrt(1 + mu^2), w = 837."""
    return MoveRule(
        step=2,
        primitive="rotation",
        action="rotate",
        side=1,
        dual=Point(x=from_part(450.0), y=in_world(separation_um / 2 + 290.0)),
        dual_end=from_part(450.0 - 900.0),
        single=Point(x=from_part(-450.0), y=in_world(-separation_um / 2)),
    )


def setup(**changes: Any) -> Setup:
    return setup_of(paper_task(**{"start__y_um": 0.0, **changes}))


def stated(*probes: tuple[str, tuple[float, float], bool], travel: tuple[float, float]) -> OpenLoop:
    """One open-loop move."""
    move = MoveDocument(
        step=1,
        primitive="push",
        probes=tuple(ProbeDocument(name=n, start_um=s, passive=p) for n, s, p in probes),
        travel_um=travel,
        speed_um_s=75.0,
        expect=None,
    )
    return OpenLoop(moves=(move,), setup=setup())


def row_of(player: Feedback | OpenLoop, **changes: float) -> np.ndarray:
    """The nominal row with some columns changed; a blank in a name is written ``__``."""
    row = nominal_row(player)
    names = [column.name for column in player.columns]
    for name, value in changes.items():
        row[0, names.index(name.replace("__", " "))] = value
    return row


def test_samples_are_those_of_the_monte_carlo_runs_bit_for_bit() -> None:
    rules, task = [push(300.0), turn(1000.0)], setup()
    player = Feedback(rules=tuple(rules), setup=task)

    ours = player.run(player.draw(40, np.random.default_rng(7)), record=8)
    theirs = run(rules, task, draw(task, 2, 40, np.random.default_rng(7)), record=8)

    assert np.array_equal(ours.final, theirs.final)
    assert np.array_equal(ours.outcomes, theirs.outcomes)
    for one, other in zip(ours.moves, theirs.moves, strict=True):
        assert np.array_equal(one.tips, other.tips)
        assert np.array_equal(one.sensed, other.sensed)
        assert np.array_equal(one.path, other.path)
    assert len(np.unique(ours.final[:, 0])) == 40


def test_nominal_row_is_the_nominal_run() -> None:
    rules, task = [push(300.0), turn(1000.0)], setup()
    player = Feedback(rules=tuple(rules), setup=task)

    ours = player.run(nominal_row(player))

    assert np.array_equal(ours.final, run(rules, task, nominal(task, 2)).final)


def test_columns_name_what_is_uncertain_with_the_bounds_of_the_task() -> None:
    columns = Feedback(rules=(push(300.0), turn(1000.0)), setup=setup()).columns
    found = {column.name: (column.low, column.high) for column in columns}

    # 6 of the run, 3 of the second sensing, 2 of each probe: two dual-tip, one single-tip
    assert len(columns) == len(found) == 6 + 3 + 2 + 2 + 2
    assert found["move 2 stp y_m"] == pytest.approx((-5e-6, 5e-6), rel=1e-12)
    assert found["friction"] == pytest.approx((0.30, 0.36), rel=1e-12)
    assert found["start x_m"] == pytest.approx((2055.4e-6, 2065.4e-6), rel=1e-12)
    assert found["move 2 sensing theta_rad"][1] == pytest.approx(math.radians(0.3), rel=1e-12)


def test_open_loop_pushes_in_any_direction() -> None:
    """The short edge lies 808 um below the centre: 10 um of air, then both tips carry the part."""
    tips = [("a", (1960.4, -818.0), False), ("b", (2160.4, -818.0), False)]
    player = stated(*tips, ("aside", (0.0, 0.0), True), travel=(0.0, 210.0))

    done = player.run(nominal_row(player), record=4)

    assert done.completed[0]
    assert np.allclose(done.final[0] * SCALE, [2060.4, 200.0, 90.0], atol=1e-6)
    assert np.array_equal(done.moves[0].travel[0, 2], [0.0, 0.0])
    assert done.moves[0].path.shape == (1, 5, 3)
    assert done.moves[0].modes[0, -1].tolist() == [1, 1, 0]  # both stick, the third is aside


def test_open_loop_push_ends_at_the_wall_beside_a_slot() -> None:
    """A part that stands upright is wider than the slot: it stops with half its width to the wall."""
    tips = [("dtp_top", (3830.0, 290.0), False), ("dtp_bottom", (3830.0, -290.0), False)]
    player = replace(stated(*tips, travel=(-4000.0, 0.0)), setup=setup_of(load_task(SLOT)))

    done = player.run(nominal_row(player))

    assert done.outcomes[0] == Outcome.JAM
    assert done.final[0] * SCALE == pytest.approx([300.0 + 418.5, -9.2, 90.0], abs=2.0)


def test_open_loop_probes_miss_by_their_own_errors() -> None:
    tips = [("a", (2500.0, 100.0), False), ("stp", (2600.0, 900.0), True)]
    player = stated(*tips, travel=(-10.0, 5.0))

    done = player.run(row_of(player, move__1__a__x_m=3e-6, move__1__stp__y_m=-2e-6))

    assert np.allclose(done.moves[0].tips[0] * 1e6, [[2503.0, 100.0], [2600.0, 898.0]])
    assert np.allclose(done.moves[0].travel[0] * 1e6, [[-10.0, 5.0], [0.0, 0.0]])


def test_open_loop_tips_of_one_probe_share_its_error_and_are_misaligned() -> None:
    tips = [("dtp_top", (2500.0, 290.0), False), ("dtp_bottom", (2500.0, -290.0), False)]
    player = stated(*tips, travel=(-10.0, 0.0))
    beta = math.radians(0.25)

    done = player.run(row_of(player, move__1__dtp__y_m=4e-6, misalignment_rad=beta))

    ahead = 290.0 * math.tan(beta)
    assert len(player.columns) == 8
    assert np.allclose(
        done.moves[0].tips[0] * 1e6, [[2500.0 - ahead, 294.0], [2500.0 + ahead, -286.0]]
    )


def test_open_loop_run_of_the_stated_moves_is_the_run_they_were_stated_for() -> None:
    task = paper_task()
    rules = [push(300.0), push(-100.0)]
    base = Feedback(rules=tuple(rules), setup=setup_of(task))
    turned = row_of(base, misalignment_rad=math.radians(-0.2), friction=0.31)
    feedback = base.run(turned)
    plan = plan_document(task, rules, [move.sensed[0] for move in feedback.moves], [None, None])
    player = player_of(plan.model_copy(update={"policy": ()}), base.setup)

    again = player.run(row_of(player, misalignment_rad=math.radians(-0.2), friction=0.31))

    assert isinstance(player, OpenLoop)
    # the plan states positions to 0.0001 um
    assert np.allclose(again.final * SCALE, feedback.final * SCALE, atol=2e-4)


def test_open_loop_probe_that_starts_inside_ends_the_run_by_name() -> None:
    player = stated(("a", (2060.4, 0.0), False), travel=(-10.0, 0.0))

    done = player.run(nominal_row(player), record=2)

    assert done.outcomes[0] == STARTS_INSIDE
    assert done.failed_in[0] == 0
    assert ending(player, done, 0).outcome == "starts inside"


def still(poses: np.ndarray) -> MoveRun:
    """A move that ends at these poses."""
    fields: dict[str, Any] = dict.fromkeys(MoveRun.__slots__, poses)
    return MoveRun(**fields)


def test_miss_is_the_largest_distance_in_tolerances() -> None:
    """The goal of the paper: 0, 0, 180 deg within 76 um and 5 deg."""
    poses = np.array(
        [[38e-6, -19e-6, math.pi], [0.0, 0.0, math.pi + math.radians(10.0)], [0, 0, 0]]
    )
    move = still(poses)
    outcomes = np.array([Outcome.COMPLETED, Outcome.COMPLETED, Outcome.JAM], dtype=np.int8)
    runs = PlanRun(moves=(move,), outcomes=outcomes, failed_in=np.array([1, 1, 0]))

    assert np.allclose(miss(runs, setup()), [0.5, 2.0, np.nan], equal_nan=True)


def straight() -> Feedback:
    """Ends 40 um off the goal in x, whatever the start: only the probe's own error adds to it."""
    task = setup(goal__theta_deg=90.0, uncertainty__tip_misalignment_deg=[0.0, 0.0])
    return Feedback(rules=(push(40.0 + 418.5, world=True),), setup=task)


def test_adversary_finds_the_corner_known_in_closed_form() -> None:
    player = straight()

    worst = search(player, nominal_row(player), np.random.default_rng(0))

    assert worst.value == pytest.approx((40.0 + 5.0) / 76.0, abs=1e-3)
    names = [column.name for column in player.columns]
    assert (
        worst.row[names.index("move 1 dtp x_m")] == limits(player)[1][names.index("move 1 dtp x_m")]
    )


def test_adversary_reports_what_a_direct_run_gives_and_stays_in_the_box() -> None:
    player = straight()
    seeds = player.draw(20, np.random.default_rng(2))
    low, high = limits(player)

    worst = search(player, seeds, np.random.default_rng(1))
    direct = run(player.rules, player.setup, player.draws_of(worst.row[None]))

    away = np.abs(direct.final[0] * SCALE - [0.0, 0.0, 90.0]) / [76.0, 76.0, 5.0]
    assert worst.value == pytest.approx(away.max(), rel=1e-9)
    assert worst.value >= badness(player, seeds).max() - 1e-6
    assert ((low <= worst.row) & (worst.row <= high)).all()


def test_adversary_finds_the_jam_of_high_friction() -> None:
    """930 um between the tips jam if mu exceeds sqrt((930/837)^2 - 1) = 0.484, give or take errors."""
    player = Feedback(rules=(turn(930.0),), setup=setup(uncertainty__friction=[0.05, 0.9]))
    safe = row_of(player, friction=0.1)

    worst = search(player, safe, np.random.default_rng(3))
    direct = run(player.rules, player.setup, player.draws_of(worst.row[None]))

    assert badness(player, safe)[0] < np.inf
    assert worst.value == np.inf
    assert direct.outcomes[0] == Outcome.JAM
    assert worst.row[3] > math.sqrt((920.0 / 837.0) ** 2 - 1.0)


def test_failure_of_the_simulator_is_never_the_worst_run(monkeypatch: pytest.MonkeyPatch) -> None:
    player = straight()
    failed = np.array([Outcome.SOLVER_FAILURE, Outcome.JAM, Outcome.OUT_OF_RANGE], dtype=np.int8)
    move = still(np.zeros((3, 3)))
    runs = PlanRun(moves=(move,), outcomes=failed, failed_in=np.zeros(3, dtype=np.int64))
    monkeypatch.setattr(Feedback, "run", lambda *_args, **_kinds: runs)

    assert badness(player, np.zeros((3, 8))).tolist() == [-np.inf, np.inf, -np.inf]


def jammed() -> tuple[Feedback, PlanRun]:
    player = Feedback(rules=(turn(857.0),), setup=setup())
    return player, player.run(row_of(player, friction=0.33), record=96)


def test_jam_names_the_tips_that_hold_the_part_and_stops_them_at_it() -> None:
    player, runs = jammed()

    end = ending(player, runs, 0)

    assert (end.outcome, end.move) == ("jam", 0)
    assert end.touching == ("dtp_bottom", "stp")
    move = runs.moves[0]
    tip = complex(*(move.tips[0, 1] + end.share * move.travel[0, 1]))
    x, y, theta = runs.final[0]
    own = (tip - complex(x, y)) * np.exp(-1j * theta)
    assert 0.0 < end.share < 1.0
    assert abs(own.imag) * 1e6 == pytest.approx(418.5, abs=2.5)  # on the long edge, within a step


def test_gaps_to_a_turned_rectangle() -> None:
    """4 x 2, turned by 90 deg about (10, 0): it reaches from 9 to 11 in x and from -2 to 2 in y."""
    points = np.array([[[12.0, 0.0], [10.0, 5.0], [14.0, 6.0], [10.5, 0.0]]])
    corners = np.array([[[-2.0, -1.0], [2.0, -1.0], [2.0, 1.0], [-2.0, 1.0]]])

    gaps = gaps_to(points, np.array([[10.0, 0.0, math.pi / 2]]), corners, 0.25 * np.ones((1, 4)))

    assert np.allclose(gaps, [[0.75, 2.75, 4.75, -0.75]])


def plan_of(rules: list[MoveRule], player: Feedback) -> PlanDocument:
    sensed = [move.sensed[0] for move in player.run(nominal_row(player)).moves]
    return plan_document(paper_task(start__y_um=0.0), rules, sensed, [None] * len(rules))


def test_trajectories_end_where_the_runs_end() -> None:
    rules = [push(300.0), push(-100.0)]
    player = Feedback(rules=tuple(rules), setup=setup())
    found = simulated(
        paper_task(start__y_um=0.0), plan_of(rules, player), player, samples=3, seed=1
    )

    lines = [line.split(",") for line in trajectories(found).splitlines()]
    last = {line[0]: line for line in lines[1:]}

    assert lines[0][:6] == [
        "run",
        "move",
        "part_of_move",
        "part_x_um",
        "part_y_um",
        "part_theta_deg",
    ]
    assert lines[0][6:] == [f"dtp_{w}_{a}_um" for w in ("top", "bottom") for a in "xy"]
    assert list(last) == ["nominal", "sample 0", "sample 1", "sample 2"]
    for row in range(3):
        line = last[f"sample {row}"]
        assert (line[1], line[2]) == ("2", "1")
        assert np.allclose(
            [float(x) for x in line[3:6]], found.sampled.final[row] * SCALE, atol=6e-5
        )
    # carried to 418.5 um ahead of tips at 2360.4, then the tips go 100 um beyond the centre
    assert float(last["nominal"][6]) == pytest.approx(2360.4 - 418.5 - 100.0, abs=1e-3)


def test_trajectory_of_a_jam_stops_at_it_and_leaves_no_cell_for_an_absent_probe() -> None:
    player = Feedback(rules=(push(448.0), turn(857.0)), setup=setup())
    found = simulated(
        paper_task(start__y_um=0.0),
        plan_of(list(player.rules), player),
        player,
        samples=1,
        seed=0,
    )
    lines = [line.split(",") for line in trajectories(found).splitlines()[1:]]
    nominal_lines = [line for line in lines if line[0] == "nominal"]

    assert all(line[-2:] == ["", ""] for line in nominal_lines if line[1] == "1")
    assert float(nominal_lines[-1][2]) == pytest.approx(
        ending(player, found.nominal.runs, 0).share, abs=1e-5
    )
    assert float(nominal_lines[-1][2]) < 1.0


def test_paper_plan_stays_in_the_goal_under_attack() -> None:
    player = paper_player()

    worst = search(player, player.draw(16, np.random.default_rng(0)), np.random.default_rng(0))
    sampled = player.run(player.draw(300, np.random.default_rng(1)))

    assert miss(sampled, player.setup).max() < worst.value < 1.0
    assert (excess(player.run(worst.row[None]).final, player.setup.goal) == 0.0).all()
