"""The planned task: its runs, their uncertainties, and the printed rotation in the plan."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from meso_robust.bounds import Verdict
from meso_robust.campaigns.intervals import share_interval
from meso_robust.certificates.chain import certify
from meso_robust.laboratory.draws import nominal
from meso_robust.laboratory.running import run
from meso_robust.planning.compose import compose
from meso_robust.primitives.setup import setup_of
from meso_robust.reproduction import tolerance
from meso_robust.reproduction.certified import (
    UNCERTAINTIES,
    certified_plan,
    certified_successes,
    first_failure,
    how_runs_fail,
    scaled,
    trials,
)
from meso_robust.reproduction.item import Setting
from meso_robust.reproduction.planned_task import ITEM, sequence, with_separation
from meso_robust.simulator import Outcome
from tests.checker.test_check import checked
from tests.nightly import at_night
from tests.paper import paper_task
from tests.polygons import certificate

ROOT = Path(__file__).parents[2]


def test_the_exact_interval_of_a_share() -> None:
    # all of n: the probability at which n successes have a chance of 2.5 %
    assert share_interval(3, 3) == pytest.approx((0.025 ** (1 / 3), 1.0))
    assert share_interval(0, 40) == pytest.approx((0.0, 1.0 - 0.025 ** (1 / 40)))
    # Clopper and Pearson's tables
    np.testing.assert_allclose(share_interval(9, 10), (0.5550, 0.9975), atol=1e-4)


@pytest.mark.parametrize(("hits", "runs"), [(2, 1), (-1, 3), (0, 0)])
def test_impossible_counts_are_refused(hits: int, runs: int) -> None:
    with pytest.raises(ValueError, match="hits"):
        share_interval(hits, runs)


def test_an_uncertainty_is_scaled_about_its_middle() -> None:
    setup = certified_plan().setup
    wide = scaled(setup, {"friction": 2.0, "sensed_position": 3.0})
    u = wide.uncertainty
    assert (u.friction.lo, u.friction.hi) == pytest.approx((0.27, 0.39))
    assert (wide.start.x.lo, wide.start.x.hi) == pytest.approx((2045.4e-6, 2075.4e-6))
    assert u.probe_position == setup.uncertainty.probe_position


@pytest.mark.parametrize("scales", [{"colour": 1.0}, {"friction": 12.0}])
def test_scales_that_make_no_sense_are_refused(scales: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="scales"):
        scaled(certified_plan().setup, scales)


def test_successes_are_all_at_the_stated_uncertainties_and_fewer_beyond() -> None:
    assert certified_plan().chain.verdict is Verdict.PROVED
    assert certified_successes(60, 3).all()
    wide = certified_successes(60, 3, {"probe_position": 6.0})
    assert 0 < wide.sum() < 60
    np.testing.assert_array_equal(wide, certified_successes(60, 3, {"probe_position": 6.0}))


def test_without_any_uncertainty_all_runs_are_the_nominal_one() -> None:
    plan = certified_plan()
    sure = scaled(plan.setup, dict.fromkeys(UNCERTAINTIES, 0.0))
    ends = trials(plan.rules, sure, 4, 0).final
    middle = run(plan.rules, plan.setup, nominal(plan.setup, len(plan.rules)), engine="events")
    np.testing.assert_allclose(ends, np.repeat(middle.final, 4, axis=0), atol=1e-9)


def test_friction_fails_first_where_the_grasp_of_the_rotation_closes() -> None:
    plan = certified_plan()
    (turn,) = [rule for rule in plan.rules if rule.single is not None]
    assert turn.single is not None
    apart = turn.dual.y.offset_um - 290.0 - turn.single.y.offset_um
    # the two probes may be 5 um off each, towards each other
    first, last = (np.sqrt(((apart - off) / 837.0) ** 2 - 1.0) for off in (10.0, 0.0))
    found = first_failure("friction", 60, 0)
    assert found.factor is not None
    assert (first - 0.33) / 0.03 <= found.factor * 1.001
    assert found.factor <= (last - 0.33) / 0.03
    assert "jam" in found.why


def test_the_printed_separation_jams_in_the_same_plan() -> None:
    plan = certified_plan()
    printed = with_separation(plan.rules, plan.setup.spacing.mid, 857.0)
    (was,), (now,) = (
        [rule for rule in rules if rule.single is not None] for rules in (plan.rules, printed)
    )
    assert was.single is not None
    assert now.single is not None
    assert now.dual.y.offset_um - 290.0 - now.single.y.offset_um == pytest.approx(857.0, abs=0.11)
    middle = was.dual.y.offset_um + was.single.y.offset_um
    assert now.dual.y.offset_um + now.single.y.offset_um == pytest.approx(middle, abs=0.11)
    found = run(printed, plan.setup, nominal(plan.setup, len(printed)), engine="events")
    assert found.outcomes[0] == Outcome.JAM
    assert "move 3: jam" in how_runs_fail(found, plan.setup)


def test_the_sequence_counts_a_tilt_and_its_straightening_once() -> None:
    rules = certified_plan().rules
    assert sequence(rules) == "Y-translation, rotation, X-translation"
    assert sequence((*rules[:2], *rules[:2], rules[-1])) == (
        "Y-translation, Y-translation, X-translation"
    )


@at_night
def test_the_item_says_that_the_printed_rotation_fails() -> None:
    found = ITEM.run(Setting(quick=True))
    assert found.data["in_goal"] == found.data["runs"] == 200
    assert found.data["printed_rotation_in_goal"] == 0
    assert "PROVED" in found.answer
    assert len(found.figures) == 2
    json.dumps(found.data)


@at_night
def test_both_readings_of_the_tolerance_are_measured() -> None:
    plan = certified_plan()
    sampled = trials(plan.rules, plan.setup, 40, 0)
    whole, half, one_side, any_side = tolerance.rows(plan, sampled, Setting(quick=True))
    post = json.loads((ROOT / "reports/paper_task/certificate.json").read_text())["steps"][-1][
        "post"
    ]
    reach = max(abs(end) for end in (*post["x_um"], *post["y_um"]))  # of the committed certificate
    assert reach < 38.0
    said = f"the certified end reaches {np.ceil(10.0 * reach) / 10.0:.1f} um"
    assert whole.why.startswith(f"PROVED: {said}")
    assert half.why.startswith(f"PROVED: {said}")
    assert "ε_p/2" in half.quantity
    worst = np.abs(sampled.final[:, :2]).max() * 1e6
    found = float(re.search(r"find is ([\d.]+) um off", half.why)[1])  # type: ignore[index]
    assert worst <= found + 0.05 <= reach + 0.05
    text = (ROOT / "meso_robust/tasks/paper.toml").read_text()
    assert "epsilon_p/2" in text
    assert f"certified to end within +- {np.ceil(reach):.0f} um" in text
    assert "along -x:" in one_side.quantity
    assert one_side.why.startswith("PROVED: 4 moves, along -x; 40 of 40 runs")
    assert any_side.why.startswith("PROVED: 5 moves, along +x, -x, +y; 40 of 40 runs")


def test_the_plan_for_the_narrower_tolerance_is_verified_by_the_checker() -> None:
    task = tolerance.with_half_side(paper_task(), 38.0)
    assert task.goal.position_tolerance_um == 38.0
    rules = compose(task).rules
    assert {rule.frame.heading for rule in rules} == {"-x"}
    document = certificate(task, rules, certify(rules, setup_of(task)))
    assert checked(document, task).verdict == "VERIFIED"
