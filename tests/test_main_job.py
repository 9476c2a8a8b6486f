"""The promise of the main job, from the task to the simulator."""

from __future__ import annotations

import math

import numpy as np

from meso_robust.pipeline import Planned


def test_the_paper_task_is_proved(paper_plan: Planned) -> None:
    assert paper_plan.certificate.verdict == "PROVED"
    assert all(step.verdict == "PROVED" for step in paper_plan.certificate.steps)


def test_the_plan_has_the_steps_of_the_paper(paper_plan: Planned) -> None:
    moves = [(rule.step, rule.primitive) for rule in paper_plan.found.rules]

    assert moves == [
        (1, "y_translation"),
        (1, "y_translation"),
        (2, "rotation"),
        (4, "x_translation"),
    ]


def test_all_sampled_runs_end_in_the_certified_box_and_in_the_goal(paper_plan: Planned) -> None:
    check = paper_plan.check
    final = check.sampled.final
    # the goal of Section IX-E by hand: 76 um and 5 deg around (0, 0, pi)
    assert final.shape == (1000, 3)
    assert np.all(np.abs(final[:, :2]) <= 76e-6)
    assert np.all(np.abs(final[:, 2] - math.pi) <= math.radians(5.0))
    assert check.sampled.completed.all()
    assert check.in_box is not None
    assert check.in_box.all()


def test_sampled_runs_use_the_box_they_claim_to(paper_plan: Planned) -> None:
    """The draws must reach the ends of every range, or the check above would be worth nothing."""
    draws = paper_plan.check.draws

    assert np.allclose([draws.friction.min(), draws.friction.max()], [0.3, 0.36], rtol=1e-12)
    assert np.isclose(np.ptp(draws.film_ratio), 0.1 * 376900e-12, rtol=1e-6)
    assert np.allclose(np.ptp(draws.start, axis=0), [10e-6, 10e-6, math.radians(0.6)], rtol=1e-6)
    assert np.allclose(np.abs(draws.dual).max(axis=(0, 1)), 5e-6, rtol=1e-6)
    assert np.allclose(np.abs(draws.single).max(axis=(0, 1)), 5e-6, rtol=1e-6)
    assert np.allclose(np.abs(draws.misalignment).max(), math.radians(0.25), rtol=1e-6)
    assert np.abs(draws.sensing[:, 1:]).max(axis=(0, 1))[2] > math.radians(0.299)


def test_every_intermediate_box_holds_the_simulated_poses(paper_plan: Planned) -> None:
    """Up to the simulator's own error, which is measured by halving its step."""
    excess = np.array(paper_plan.check.step_excess)
    error = np.array(paper_plan.check.error)

    assert excess.shape == (4, 3)
    assert np.all(excess <= error)
    assert np.all(error < [0.5e-6, 0.5e-6, math.radians(0.02)])


def test_the_certified_boxes_are_not_needlessly_wide(paper_plan: Planned) -> None:
    """The simulated poses fill a good part of each box, so a box is not right by being huge."""
    for move, step in zip(paper_plan.check.sampled.moves, paper_plan.chain.steps, strict=True):
        assert step.post is not None
        spread = np.ptp(move.after, axis=0)
        widths = np.array([step.post.x.width, step.post.y.width, step.post.theta.width])

        assert np.all(spread[1:] >= 0.4 * widths[1:])


def test_wide_friction_is_not_proved(wide_friction_plan: Planned) -> None:
    certificate = wide_friction_plan.certificate

    assert certificate.verdict != "PROVED"
    assert certificate.undecided is not None
    from meso_robust.planning.remedy import Remedy

    assert certificate.undecided.settled_by.id == Remedy.NARROW_ALL
    assert 0.0 < float(certificate.undecided.settled_by.about["scale"]) < 1.0
    assert certificate.simulation.in_goal < certificate.simulation.samples


def test_a_refuted_plan_carries_a_witness_that_fails_again(wide_friction_plan: Planned) -> None:
    from meso_robust.laboratory.crosscheck import confirmed

    certificate = wide_friction_plan.certificate
    assert certificate.verdict == "REFUTED"
    assert certificate.witness is not None
    assert 0.05 <= float.fromhex(certificate.witness.friction) <= 0.9
    assert confirmed(
        wide_friction_plan.found.rules, wide_friction_plan.setup, wide_friction_plan.check
    )


def test_margin_is_a_factor_that_is_really_proved_and_nearly_the_largest(
    paper_plan: Planned,
) -> None:
    from meso_robust.bounds import Verdict
    from meso_robust.certificates.chain import certify
    from meso_robust.primitives.setup import setup_of

    found = paper_plan.margin
    rules, task = paper_plan.found.rules, paper_plan.task
    assert found.refused is not None
    assert 1.1 < found.factor < found.refused <= 1.03 * found.factor
    assert certify(rules, setup_of(task, found.factor)).verdict is Verdict.PROVED
    assert certify(rules, setup_of(task, found.refused)).verdict is not Verdict.PROVED
    assert found.binding == min(found.each, key=lambda name: found.each[name])
