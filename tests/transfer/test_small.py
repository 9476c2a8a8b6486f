"""The shipped 300 um part: proved without adhesion, honestly UNKNOWN with it."""

from __future__ import annotations

import math
from contextlib import nullcontext
from functools import cache

import numpy as np
import pytest

from meso_robust.certificates.chain import certify
from meso_robust.certificates.premise import Premise
from meso_robust.checker.reading import parse_certificate
from meso_robust.checker.verdict import check
from meso_robust.identification.document import ModelDocument
from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.running import run
from meso_robust.pipeline import make
from meso_robust.planning.clearance import fine
from meso_robust.planning.compose import compose
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import setup_of
from meso_robust.simulator import simulate
from meso_robust.task import Task, load_task
from meso_robust.tasks import SMALL, SMALL_MODEL
from meso_robust.transfer import running
from meso_robust.transfer.answer import document, summary, why
from meso_robust.transfer.promise import promise, read
from reports.tasks.adhesion import adhering, at, page
from tests.conftest import paper_task
from tests.nightly import at_night

UM = 1e-6


@cache
def task() -> Task:
    return load_task(SMALL)


@cache
def rules() -> tuple[MoveRule, ...]:
    return compose(task()).rules


@at_night
def test_the_small_part_is_proved_simulated_and_checked() -> None:
    planned = make(task(), 1000, 0)
    text = planned.certificate.model_dump_json(by_alias=True)
    found, digest = parse_certificate(text, "a certificate", task())

    assert planned.certificate.verdict == "PROVED"
    assert check(found, digest, task()).verdict == "VERIFIED"
    # the goal by hand: 14.1 um and 5 deg around (0, 0, pi)
    final = planned.check.sampled.final
    assert planned.check.sampled.completed.all()
    assert np.all(np.abs(final[:, :2]) <= 14.1e-6)
    assert np.all(np.abs(final[:, 2] - math.pi) <= math.radians(5.0))


def test_every_box_holds_event_driven_runs_at_corners() -> None:
    setup = setup_of(task())
    draws = draw(setup, len(rules()), 60, np.random.default_rng(2))
    done = run(rules(), setup, draws, engine="events")

    assert done.completed.all()
    for move, step in zip(done.moves, certify(rules(), setup).steps, strict=True):
        assert step.post is not None
        for column, side in enumerate((step.post.x, step.post.y, step.post.theta)):
            assert np.all(side.lo <= move.after[:, column])
            assert np.all(move.after[:, column] <= side.hi)


@at_night
def test_with_a_coarser_objective_next_to_nothing_is_left_in_hand() -> None:
    """10X instead of 20X: pixels of 2 um, and the probe is placed by them."""
    worse = {"sensed_position_um": 2.0, "sensed_orientation_deg": 0.64, "probe_position_um": 2.0}
    coarse = task().model_copy(update={"uncertainty": task().uncertainty.model_copy(update=worse)})

    planned = make(coarse, 100, 0)
    assert planned.certificate.margin is not None
    assert 1.0 < planned.certificate.margin.factor < 1.1
    text = planned.certificate.model_dump_json(by_alias=True)
    found, digest = parse_certificate(text, "a certificate", coarse)
    assert planned.certificate.verdict == "PROVED"
    assert check(found, digest, coarse).verdict == "VERIFIED"


def test_only_parts_that_are_smaller_than_a_millimetre_get_finer_lengths() -> None:
    assert fine(setup_of(paper_task())) == 1.0
    assert fine(setup_of(task())) == pytest.approx(155.4 / 800.0)


@at_night
def test_adhesion_is_unknown_with_its_premise_and_size_and_runs_as_evidence() -> None:
    model = read(SMALL_MODEL, task())
    pull = model.parameters["tip_adhesion.pull_um_s"]

    made = promise(task(), model, 20, 0, lambda _: nullcontext())
    told, certificate = document(made), made.planned.certificate

    assert told.verdict == certificate.verdict == "UNKNOWN"
    assert certificate.undecided is not None
    assert certificate.undecided.reason.about == {
        "premise": Premise.COULOMB_EACH_TIP,
        "effect": "tip_adhesion",
    }
    assert certificate.undecided.settled_by.about["effect"] == "tip_adhesion"
    said = certificate.reading.undecided
    assert said is not None
    low, high = math.floor(100 * pull.low) / 100, math.ceil(100 * pull.high) / 100
    assert f"pull_um_s {low:.2f} … {high:.2f} µm/s" in said.inequality  # outward
    assert "without tip adhesion" in said.settled_by
    assert "tip_adhesion (breaks a premise)" in why(made)
    assert told.evidence is not None
    assert told.evidence.runs == 20
    assert "evidence, not proof" in summary(made)


def laboratory(model: ModelDocument, runs: int = 1) -> running._Laboratory:
    setup, rng = setup_of(task()), np.random.default_rng(0)
    return running._Laboratory(
        document=model,
        values=running._values(model, runs, rng),
        task=task(),
        setup=setup,
        draws=draw(setup, 1, runs, rng),
    )


@pytest.mark.parametrize("pull", [3.0, 12.0])
def test_two_tips_drag_the_part_along_until_both_menisci_break(pull: float) -> None:
    """By hand: the part follows at 2 p while the gap opens at v - 2 p to r = 2 um."""
    lab = laboratory(adhering(pull))
    poses = np.array([[0.0, 0.0, 0.5 * math.pi]])
    tips = np.array([[[90.0, 50.0], [90.0, -50.0]]]) * UM
    travel = np.broadcast_to([-20.0 * UM, 0.0], tips.shape)

    ways = np.stack([tips, tips + travel], axis=1)
    points = np.zeros((1, 2))
    left = running._push(poses, ways, slice(None), laboratory(adhering(0.0)), points)
    held = running._push(poses, ways, slice(None), lab, points)
    free, drawn = simulate(left).poses[0], simulate(held).poses[0]

    # pushed by 20 um less the way to the edge, 90 - 155.4 / 2
    assert free[0] == pytest.approx(-(20.0 - 12.3) * UM, abs=1e-10)
    by_hand = 2.0 * pull * 2.0 / (75.0 - 2.0 * pull) * UM
    assert drawn[0] - free[0] == pytest.approx(by_hand, rel=0.15)
    assert drawn[1:] == pytest.approx(free[1:], abs=1e-9)


def test_the_passive_tip_backs_off_to_its_own_side() -> None:
    tips = np.array([[[100.0, 50.0], [100.0, -50.0], [-90.0, -20.0]]]) * UM
    travel = np.array([[[-30.0, 0.0], [-30.0, 0.0], [0.0, 0.0]]]) * UM
    lab = laboratory(adhering(1.0))

    there = np.stack([tips, tips + travel], axis=1)
    ways, times = running._way(there, lab, back=True)
    only, _ = running._way(there, lab, back=False)

    # a quarter of 300 um, at 75 um/s
    assert ways[0, 2] * 1e6 == pytest.approx(np.array([[145.0, 50], [145.0, -50], [-165.0, -20]]))
    assert times[0] == pytest.approx([0.0, 0.4, 1.4])
    assert np.array_equal(only, ways[:, :2])


def test_a_small_pull_is_borne_in_simulation_and_a_large_one_is_not() -> None:
    small, large = (at(pull, rules(), task(), 16) for pull in (1.0, 45.0))

    assert small.in_goal == 16
    assert large.in_goal == 0


def test_the_report_says_what_was_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("reports.tasks.adhesion.HALVINGS", 1)

    text = page((1.0, 45.0), 4)

    assert "| 1 | 4 of 4 |" in text
    assert "| 45 | 0 of 4 |" in text
