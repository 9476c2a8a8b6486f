"""The shrunk task: similitude, errors that stay, adhesion."""

from __future__ import annotations

import math

import pytest

from meso_robust.primitives.setup import setup_of
from meso_robust.reproduction.certified import certified_plan
from meso_robust.reproduction.scales import PULLS, Pull, release_um
from meso_robust.reproduction.shrunk import adhering, certified_at, shrunk, shrunk_rules
from meso_robust.task import Part

FULL = 1616.0


def test_what_shrinks_and_what_stays() -> None:
    task = certified_plan().task
    small = shrunk(task, 0.25, "camera stays")
    assert small.part == Part(length_um=404.0, width_um=209.25)
    assert small.goal.position_tolerance_um == 19.0
    assert small.goal.orientation_tolerance_deg == 5.0
    assert small.probe.tip_spacing_um == 145.0
    u = small.uncertainty
    assert u.film_ratio_um2 == pytest.approx(376_900.0 / 16.0)
    assert (u.sensed_position_um, u.sensed_orientation_deg) == pytest.approx((5.0, 1.2))
    assert u.probe_position_um == 1.25
    assert shrunk(task, 0.25, "camera and probe stay").uncertainty.probe_position_um == 5.0
    alike = shrunk(task, 0.25, "scaled").uncertainty
    assert (alike.sensed_position_um, alike.sensed_orientation_deg) == pytest.approx((1.25, 0.3))


def test_the_model_has_no_length_of_its_own() -> None:
    plan = certified_plan()
    full, small = (
        certified_at(plan.task, size, "scaled", [shrunk_rules(plan.rules, size)])
        for size in (1.0, 0.125)
    )
    assert full.proved
    assert small.proved
    assert small.margin == pytest.approx(full.margin, rel=0.02)


def test_errors_that_stay_end_the_certificate_with_a_reason() -> None:
    plan = certified_plan()
    size = 100.0 / FULL
    rules = shrunk_rules(plan.rules, size)
    found = certified_at(plan.task, size, "camera and probe stay", [rules])
    assert not found.proved
    assert 0.0 < found.margin < 1.0
    assert found.reason


def test_a_meniscus_over_the_drag() -> None:
    force = 4.0 * math.pi * 12.5e-6 * 0.03
    drag = 0.1 * 1616e-6 * 837e-6 / 10e-6
    for pull in PULLS:
        assert pull.newtons(1.0) == pytest.approx(pull.share * force)
        assert pull.um_s(1.0) == pytest.approx(1e6 * pull.share * force / drag)
        growth = 2.0 if pull.tip_shrinks else 4.0
        assert pull.um_s(0.5) == pytest.approx(growth * pull.um_s(1.0))


def share(size: float, pull_um_s: float) -> float:
    plan = certified_plan()
    setup = setup_of(shrunk(plan.task, size, "scaled"))
    return float(adhering(shrunk_rules(plan.rules, size), setup, size, pull_um_s, 12, 0).mean())


def test_adhesion_that_is_absent_or_weak_changes_nothing() -> None:
    assert share(1.0, 0.0) == 1.0
    assert share(0.25, 0.0) == 1.0
    assert share(1.0, 1.0) == 1.0


def test_a_part_that_follows_its_tips_leaves_the_goal() -> None:
    pull = Pull(name="", share=1.0, tip_shrinks=True)
    length = release_um(pull)
    assert 2.0 * pull.um_s(length / FULL) == pytest.approx(1700.0)
    for factor, least, most in ((2.0, 0.5, 1.0), (0.9, 0.0, 0.0)):
        size = factor * length / FULL
        assert least <= share(size, pull.um_s(size)) <= most
