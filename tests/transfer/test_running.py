"""Runs under the model's own physics: the laboratory that they stand for, held against other routes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.running import STARTS_INSIDE, by_rules, run
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import setup_of
from meso_robust.transfer import running
from meso_robust.transfer.envelope import enough, needed, roomier
from meso_robust.transfer.running import evidence
from tests.conftest import paper_task
from tests.strategies import paper_chain
from tests.transfer.models import model

EXACT = (0.0, 0.0, 0.0)
RUNS = 6


def rules() -> tuple[MoveRule, ...]:
    return tuple(step.rule for step in paper_chain().steps)


def laboratory(document, runs: int = RUNS) -> running._Laboratory:  # type: ignore[no-untyped-def]
    setup, rng = setup_of(paper_task()), np.random.default_rng(7)
    return running._Laboratory(
        document=document,
        values=running._values(document, runs, rng),
        task=paper_task(),
        setup=setup,
        draws=draw(setup, len(rules()), runs, rng),
    )


def test_without_effects_it_is_the_monte_carlo_run() -> None:
    lab = laboratory(model())
    draws = replace(lab.draws, film_ratio=lab.values[:, 0], friction=lab.values[:, 1])

    ran = running._run(rules(), lab)

    assert np.all(ran.outcomes == 0)
    np.testing.assert_allclose(ran.final, run(rules(), lab.setup, draws).final, rtol=0, atol=1e-12)


def test_a_part_that_nothing_touches_is_carried_on_between_moves() -> None:
    """At 1 um/s for the 10 s of handling after each move, on top of what happens in it."""
    force = {"body_force.x_um_s": (0.0, 0.0), "body_force.y_um_s": (1.0, 1.0)}
    lab = laboratory(model(force))
    which = np.isin(np.arange(RUNS), (1, 4))

    poses = running._rested(np.zeros((2, 3)), which, lab)

    np.testing.assert_allclose(poses, [[0.0, 10e-6, 0.0]] * 2, rtol=0, atol=1e-10)


def test_a_mount_that_drifts_has_drifted_by_the_time_of_a_move() -> None:
    drift = {"probe_drift.x_um_s": (0.1, 0.1), "probe_drift.y_um_s": (-0.2, -0.2)}
    lab = laboratory(model(drift))
    (order,) = by_rules(rules(), lab.setup, lab.draws)[0](
        lab.draws.start, np.ones(RUNS, dtype=np.bool_)
    )

    first, lab.clock = lab.ways(0, order), 30.0
    later = lab.ways(0, order)

    expected = np.broadcast_to([3e-6, -6e-6], first.shape)
    np.testing.assert_allclose(later - first, expected, rtol=0, atol=1e-12)


def test_a_base_on_dry_contact_can_be_run_too() -> None:
    dry = model(base={"mu": (0.3, 0.35)}, model="uniform_pressure")

    found = evidence(rules(), paper_task(), dry, 2, 0, EXACT)

    assert found.runs == 2
    assert found.completed + sum(count for _, count in found.endings) == 2


def test_an_offset_of_the_tracker_is_an_error_of_sensing_that_turns_with_the_part() -> None:
    """The same runs by the plain simulation, whose sensing errors are given the offset."""
    document = model({"reference_offset.x_um": (1.5, 1.5), "reference_offset.y_um": (-1.0, -1.0)})
    lab = laboratory(document)
    poses = running._run(rules(), lab).final

    draws = replace(lab.draws, film_ratio=lab.values[:, 0], friction=lab.values[:, 1])
    start, sensing = draws.start.copy(), draws.sensing.copy()
    cos, sin = np.cos(start[:, 2]), np.sin(start[:, 2])
    start[:, 0] -= 1e-6 * (1.5 * cos + 1.0 * sin)
    start[:, 1] -= 1e-6 * (1.5 * sin - 1.0 * cos)
    draws = replace(draws, start=start, sensing=sensing)
    for k in range(len(rules())):  # the offset at the pose before each move
        before = run(rules(), lab.setup, draws).moves[k].before
        cos, sin = np.cos(before[:, 2]), np.sin(before[:, 2])
        sensing[:, k, 0] += 1e-6 * (1.5 * cos + 1.0 * sin)
        sensing[:, k, 1] += 1e-6 * (1.5 * sin - 1.0 * cos)

    np.testing.assert_allclose(poses, run(rules(), lab.setup, draws).final, rtol=0, atol=1e-11)


def test_a_stage_that_leans_too_much_carries_the_part_out_of_the_goal() -> None:
    """At rest after the last move alone it carries the part by 20 um/s * 10 s."""
    force = {"body_force.x_um_s": (20.0, 20.0), "body_force.y_um_s": (0.0, 0.0)}

    found = evidence(rules(), paper_task(), model(force), RUNS, 0, EXACT)

    assert found.completed == RUNS
    assert found.in_goal == 0
    assert found.broken
    assert 20.0 * 10.0 - 2 * 76.0 < found.worst_um < 20.0 * 10.0


def test_a_part_much_larger_than_planned_for_meets_the_probe() -> None:
    large = {"part_geometry.x_um": (60.0, 60.0), "part_geometry.y_um": (60.0, 60.0)}
    document = model(large)

    outcomes = running._run(rules(), laboratory(document)).outcomes
    found = evidence(rules(), paper_task(), document, RUNS, 0, EXACT)

    assert np.all(outcomes == STARTS_INSIDE)
    assert found.endings == (("a probe would start inside the part", RUNS),)
    assert found.broken
    assert (found.completed, found.in_goal, found.worst_um) == (0, 0, 0.0)


def test_values_come_from_the_intervals_and_open_sides_end_at_the_best_value() -> None:
    document = model(open_=("mu",))

    values = running._values(document, 400, np.random.default_rng(0))

    assert set(values[:, 1]) == {0.33}
    assert values[:, 0].min() == pytest.approx(372_000e-12, rel=1e-12)
    assert values[:, 0].max() == pytest.approx(381_000e-12, rel=1e-12)


def test_a_plan_needs_the_place_of_its_start_and_the_time_of_its_travels() -> None:
    chain, task = paper_chain(), paper_task()

    need = needed(chain, task, 1616 / 837)

    # the start is farthest out: (2060.4 + 5, 9.2 + 5) um, and a sensed pose may be 5 um off each way; the
    # first push moves the part by some 50 um across while it hardly comes nearer
    start = np.hypot(2065.4, 14.2) + 5.0 * np.sqrt(2.0)
    assert start < need.radius_um < start + np.hypot(2065.4, 14.2 + 90.0) - 2065.4 + 0.5
    sampled = run(rules(), setup_of(task), draw(setup_of(task), 4, 50, np.random.default_rng(0)))
    travelled = sum(np.abs(move.travel).sum(axis=2).max() for move in sampled.moves)
    least = 1e6 * travelled / 75.0 + 40.0
    assert least <= need.seconds <= least + 2.0
    assert enough(roomier(need), need)
    assert not enough(
        replace(need, seconds=0.99 * need.seconds),
        need,
    )
    assert not enough(
        replace(need, radius_um=0.99 * need.radius_um),
        need,
    )
