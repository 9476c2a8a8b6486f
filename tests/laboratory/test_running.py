"""The laboratory's side of a plan: sensing, commanding, missing."""

from __future__ import annotations

import math

import numpy as np

from meso_robust.laboratory.draws import Draws, draw, nominal
from meso_robust.laboratory.engines import Pushed
from meso_robust.laboratory.running import (
    STARTS_INSIDE,
    Order,
    Which,
    carry_out,
    excess,
    run,
)
from meso_robust.primitives.move import Commands, MoveRule, Point, from_part, in_world
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.simulator import Outcome
from meso_robust.types import Flags, Floats
from tests.conftest import paper_task


def setup() -> Setup:
    return setup_of(paper_task())


def rule(x_um: float = 450.0, end_um: float = 300.0) -> MoveRule:
    """Both tips on the long edge, symmetric: the part must translate."""
    return MoveRule(
        step=4,
        primitive="x_translation",
        action="straighten",
        side=0,
        dual=Point(x=from_part(x_um), y=from_part(0.0)),
        dual_end=from_part(end_um),
    )


def exact(**changes: np.ndarray) -> Draws:
    """One run without errors, changed where named."""
    values = nominal(setup(), 1)
    return Draws(**{name: changes.get(name, getattr(values, name)) for name in Draws.__slots__})


def test_commands_follow_the_sensed_pose_and_probes_miss_by_their_error() -> None:
    sensing, dual = np.zeros((1, 1, 3)), np.zeros((1, 1, 2))
    sensing[0, 0] = [3e-6, -2e-6, 0.0]
    dual[0, 0] = [1e-6, 4e-6]

    done = run([rule()], setup(), exact(sensing=sensing, dual=dual))
    upper, lower = done.moves[0].tips[0] * 1e6

    # sensed (2063.4, -11.2), commanded 450 um ahead, tips 290 um above and below, plus the error
    assert np.allclose(upper, [2060.4 + 3.0 + 450.0 + 1.0, -9.2 - 2.0 + 4.0 + 290.0])
    assert np.allclose(lower, [2514.4, -9.2 - 2.0 + 4.0 - 290.0])
    assert np.allclose(done.moves[0].travel[0] * 1e6, [[-150.0, 0.0]] * 2)


def test_positive_misalignment_puts_the_upper_tip_ahead() -> None:
    done = run([rule()], setup(), exact(misalignment=np.array([math.radians(1.0)])))
    upper, lower = done.moves[0].tips[0]

    assert np.isclose((lower[0] - upper[0]) * 1e6, 580.0 * math.tan(math.radians(1.0)))


def test_symmetric_push_translates_by_travel_minus_gap() -> None:
    done = run([rule(x_um=419.5, end_um=-30.5)], setup(), exact())

    # 450 um of travel, 1 um of air before the edge 418.5 um off the centre
    assert np.allclose(done.final[0] * [1e6, 1e6, 1.0], [2060.4 - 449.0, -9.2, math.pi / 2])


def test_probe_that_starts_inside_the_part_ends_the_run_by_name() -> None:
    done = run([rule(x_um=400.0), rule()], setup(), _two_moves())

    assert done.outcomes[0] == STARTS_INSIDE
    assert done.failed_in[0] == 0
    assert np.array_equal(done.final[0], done.moves[0].before[0])


def test_jam_is_an_outcome_and_stops_the_plan() -> None:
    """857 um (eq. 10) between the tips jams at mu = 0.33; 930 um does not."""

    def turn(separation_um: float) -> MoveRule:
        return MoveRule(
            step=2,
            primitive="rotation",
            action="rotate",
            side=1,
            dual=Point(x=from_part(420.0), y=in_world(-9.2 + separation_um / 2 + 290.0)),
            dual_end=from_part(420.0 - 900.0),
            single=Point(x=from_part(-420.0), y=in_world(-9.2 - separation_um / 2)),
        )

    jammed = run([turn(857.0)], setup(), exact(friction=np.array([0.33])))
    free = run([turn(930.0)], setup(), exact(friction=np.array([0.33])))

    assert jammed.outcomes[0] == Outcome.JAM
    assert not jammed.completed[0]
    assert free.outcomes[0] == Outcome.COMPLETED


def test_first_pose_is_sensed_as_the_task_states_it() -> None:
    draws = draw(setup(), 3, 50, np.random.default_rng(3))

    done = run([rule()], setup(), draws)

    assert np.ptp(draws.start[:, 0]) > 9e-6
    sensed = done.moves[0].sensed * [1e6, 1e6, 180.0 / math.pi]
    assert np.allclose(sensed, [2060.4, -9.2, 90.0], rtol=1e-12)


def test_excess_is_the_distance_outside() -> None:
    goal = setup().goal
    poses = np.array([[80e-6, 0.0, math.pi], [0.0, -77e-6, math.pi + math.radians(6.0)]])

    assert np.allclose(
        excess(poses, goal),
        [[4e-6, 0.0, 0.0], [0.0, 1e-6, math.radians(1.0)]],
        atol=1e-12,
    )


def _two_moves() -> Draws:
    return nominal(setup(), 2)


class Toy:
    """Parts are carried along with the first tip; a part right of x = 10 m jams."""

    def sense(self, k: int, poses: Floats, going: Flags) -> Floats:
        return poses + 0.25

    outlines = 0.1 * np.array([[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]])

    def ways(self, k: int, order: Order) -> Floats:
        tips = order.commands.tips + 0.5
        return np.stack([tips, tips + order.commands.travel], axis=1)

    def radii(self, order: Order) -> Floats:
        return np.zeros((1, len(order.names)))

    def push(
        self, k: int, order: Order, runs: Which, poses: Floats, ways: Floats, record: int
    ) -> Pushed:
        travel = ways[:, -1, 0] - ways[:, 0, 0]
        after = poses + np.append(travel, np.zeros((len(poses), 1)), axis=1)
        jams = after[:, 0] > 10.0
        none = np.zeros((len(poses), 0, 0))
        outcomes = np.where(jams, Outcome.JAM, Outcome.COMPLETED).astype(np.int8)
        phases = np.ones(len(poses), dtype=np.int64)
        return Pushed(poses=after, outcomes=outcomes, path=none, modes=none, phases=phases)  # type: ignore[arg-type]


def test_the_loop_pushes_whom_it_is_told_to_and_a_run_without_an_order_is_over() -> None:
    """Runs 0 and 1 in one group, 2 and 3 in another; then all but 0, but 3 has jammed by then."""
    asked: list[tuple[list[float], list[bool]]] = []

    def order(which: tuple[int, ...], travel: float, probes: int) -> Order:
        shape = (4, probes, 2)
        commands = Commands(tips=np.full(shape, 5.0), travel=np.full(shape, travel))
        names = np.arange(probes)
        return Order(runs=np.isin(np.arange(4), which), commands=commands, names=names)

    def first(sensed: Floats, going: Flags) -> tuple[Order, ...]:
        asked.append((sensed[:, 0].tolist(), going.tolist()))
        return order((0, 1), 1.0, 2), order((2, 3), 3.0, 3)

    def second(sensed: Floats, going: Flags) -> tuple[Order, ...]:
        asked.append((sensed[:, 0].tolist(), going.tolist()))
        return (order((1, 2), 0.5, 2),)

    def third(sensed: Floats, going: Flags) -> tuple[Order, ...]:
        asked.append((sensed[:, 0].tolist(), going.tolist()))
        return ()

    start = np.array([[0.0, 0.0, 0.0], [4.5, 0.0, 0.0], [2.5, 2.5, 0.0], [8.0, 0.0, 0.0]])
    done = carry_out([first, second, third], Toy(), start)

    # the tips start at 5.5 m: run 2 lies there after its first move, and so cannot begin its second
    assert done.outcomes.tolist() == [
        Outcome.COMPLETED,
        Outcome.COMPLETED,
        STARTS_INSIDE,
        Outcome.JAM,
    ]
    assert done.failed_in.tolist() == [3, 3, 2, 1]
    assert done.final[:, 0].tolist() == [1.0, 6.0, 5.5, 11.0]
    assert [len(move.tips[0]) for move in done.moves] == [2, 3, 2]
    assert asked == [
        ([0.25, 4.75, 2.75, 8.25], [True] * 4),
        ([1.25, 5.75, 5.75, 11.25], [True, True, True, False]),
        ([1.25, 6.25, 5.75, 11.25], [False, True, False, False]),
    ]
