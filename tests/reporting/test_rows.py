"""Rows of tables: margins, excesses and what is to spare at the end."""

from __future__ import annotations

import math
import re
from dataclasses import fields, replace

import pytest

from meso_robust.pipeline import Planned
from meso_robust.planning.remedy import Remedy
from meso_robust.planning.stated import widened
from meso_robust.primitives.names import Reason, about
from meso_robust.primitives.setup import Uncertainty
from meso_robust.reporting import rows
from meso_robust.reporting.answer import answer
from meso_robust.reporting.plan import report
from meso_robust.reporting.reading import Standing
from meso_robust.reporting.steps import step_rows
from meso_robust.task import parse_task
from tests.test_task_real import GIVEN, ROUND, values


def with_excess(result: Planned, *excess: tuple[float, float, float]) -> Planned:
    simulation = result.certificate.simulation.model_copy(
        update={
            "largest_excess_um_um_deg": excess,
            "simulator_error_um_um_deg": (0.05, 0.05, 0.001),
        }
    )
    certificate = result.certificate.model_copy(update={"simulation": simulation})
    return replace(result, certificate=certificate)


def test_an_excess_is_judged_by_the_simulators_own_error(proved: Planned) -> None:
    result = with_excess(proved, (0, 0, 0), (0.04, 0, 0.001), (0, 0, 0.0011))
    found = rows.excess_rows(result)
    assert [row.judged for row in found] == ["none", "within", "above", "none"]
    assert found[1].excess == ("0.040", "0", "0.0010")
    assert found[3].excess is None


def test_margins_go_from_tight_to_wide_and_the_binding_one_is_marked(proved: Planned) -> None:
    margins, margin = rows.margin_rows(proved), proved.certificate.margin
    together, *each = margins.rows
    assert margin.binds_first is not None
    assert [row.binds for row in each] == [True] + [False] * (len(each) - 1)
    assert each[0].name == margin.binds_first.replace("_", " ")
    lengths = [row.percent for row in each]
    assert lengths == sorted(lengths)
    assert together.percent / margins.one_percent == pytest.approx(margin.factor)
    assert max(lengths) <= 100


def test_a_margin_is_told_as_less_than_was_proved_everywhere(proved: Planned) -> None:
    each = dict.fromkeys(proved.margin.each, 1.6875)
    told = proved.certificate.margin.model_copy(update={"factor": 1.21875, "each_alone": each})
    result = replace(
        proved,
        margin=replace(proved.margin, factor=1.21875, each=each),
        certificate=proved.certificate.model_copy(update={"margin": told}),
    )
    page = report(result)

    assert "all uncertainties x 1.21; " in result.summary
    assert "× 1.21" in page
    assert "1.22" not in re.sub(r"<svg.*?</svg>|<script.*?</script>", "", page, flags=re.DOTALL)
    budgets = {row.name: row.budget for row in rows.margin_rows(result).rows}
    assert budgets["probe position"] == "± 8.437 µm"  # 5 times 1.6875 is 8.4375
    assert budgets["friction"] == "0.28 … 0.38"  # 0.33 ± 0.050625, inward


def test_every_uncertainty_has_its_words_and_its_budget(proved: Planned) -> None:
    """By hand: radii 7.5 ± 5 um by 1.5 and by 2, where a tip would get a negative one; the rest times 2."""
    task = parse_task(values({**ROUND, **GIVEN}), "real")
    result = replace(proved, task=task)
    names = [field.name for field in fields(Uncertainty)]
    stated = rows._stated(result)
    budgets = {name: widened(task, name, 2.0) for name in names}

    assert set(stated) == set(names)
    assert stated["tip_radius"] == "2.5 … 12.5 µm"
    assert stated["travel_direction"] == "−0.1 … 0.1 deg"
    assert stated["size"] == "± 4 µm"
    assert widened(task, "tip_radius", 1.5) == "0 … 15 µm"
    assert budgets["tip_radius"] == "0 … 17.5 µm"
    assert budgets["passive_tip_radius"] == "1.25 … 6.25 µm"
    assert budgets["drag_anisotropy"] == "± 10 %"
    assert budgets["squareness"] == "± 0.2 deg"
    assert budgets["probe_wander"] == "± 1 µm"


def test_what_is_to_spare_is_the_room_of_the_certified_box(proved: Planned) -> None:
    end, found = proved.chain.end, rows.end_rows(proved)
    assert end is not None
    assert [row.goal for row in found] == ["0 ± 76", "0 ± 76", "180 ± 5"]
    sides = ((end.x, 0.0, 76.0, 1e-6), (end.y, 0.0, 76.0, 1e-6), (end.theta, 180, 5, math.pi / 180))
    for row, (side, middle, reach, unit) in zip(found, sides, strict=True):
        room = reach - max(side.hi / unit - middle, middle - side.lo / unit)
        assert room - 0.1 < float(row.spare) <= room + 1e-6


def test_without_a_certified_box_the_simulated_poses_are_compared(refuted: Planned) -> None:
    x, *_ = rows.end_rows(refuted)
    assert x.certified == "—"
    values = refuted.check.sampled.final[refuted.check.sampled.completed, 0] * 1e6
    room = min(values.min() + 76, 76 - values.max())
    shown = float(x.spare.replace("−", "-"))
    assert room - 0.1 < shown <= room + 1e-6


def test_moves_beyond_the_proof_have_a_row_of_their_own(refuted: Planned) -> None:
    found = step_rows(refuted)
    assert len(found) == len(refuted.found.rules)
    reached = len(refuted.chain.steps)
    assert {row.standing for row in found[reached:]} == {Standing.NOT_REACHED}
    assert found[0].proved < len(found[0].obligations)


def test_the_answer_counts_what_is_proved(refuted: Planned) -> None:
    verdicts = [o.verdict for step in refuted.certificate.steps for o in step.obligations]
    said = [value for _, value in answer(refuted).figures]
    assert f"{verdicts.count('PROVED')} of {len(verdicts)}" in said


def test_a_final_box_outside_the_goal_is_told_by_how_far(proved: Planned) -> None:
    goal, end = proved.setup.goal, proved.chain.end
    assert end is not None
    lowest = end.y.lo + 12e-6
    narrow = replace(goal, y=replace(goal.y, lo=lowest))
    setup = replace(proved.setup, goal=narrow)
    chain = replace(proved.chain, setup=setup)
    from meso_robust.certificates.document import undecided_document

    open_ = undecided_document(chain, about(Remedy.CHANGE_MOVE))
    assert open_ is not None
    assert open_.document.reason.id == Reason.ENDS_IN_GOAL
    reading = proved.certificate.reading.model_copy(update={"undecided": open_.reading})
    certificate = proved.certificate.model_copy(
        update={"verdict": "UNKNOWN", "undecided": open_.document, "reading": reading}
    )
    found = answer(replace(proved, setup=setup, chain=chain, certificate=certificate)).open
    assert found is not None
    said = float(found.how.split("leaves the goal by ")[1].split(" µm in y;")[0])
    assert abs(said - 12.0) <= 0.05
    assert found.where.startswith("move 4 ")


def test_a_bar_is_as_long_as_its_factor(proved: Planned) -> None:
    """On the scale on which factor 1 is marked."""
    found, margin = rows.margin_rows(proved), proved.certificate.margin
    told = {name.replace("_", " "): value for name, value in margin.each_alone.items()}

    for row in found.rows:
        expected = told.get(row.name, margin.factor)
        assert row.percent / found.one_percent == pytest.approx(expected, rel=1e-12)
    assert max(row.percent for row in found.rows) < 100.0


def test_what_is_stated_exactly_has_no_factor_and_a_radius_its_range(proved: Planned) -> None:
    probe = proved.task.probe.model_copy(update={"tip_radius_um": (12.5, 12.5)})
    task = proved.task.model_copy(update={"probe": probe})
    each = proved.margin.each | {"tip_radius": 8.0, "passive_tip_radius": 8.0}
    told = proved.certificate.margin.model_copy(update={"each_alone": each})
    result = replace(
        proved,
        task=task,
        margin=replace(proved.margin, each=each, radii={"tip_radius": (10.4, 14.6)}),
        certificate=proved.certificate.model_copy(update={"margin": told}),
    )

    found = {row.name: row for row in rows.margin_rows(result).rows}

    tip, passive = found["tip radius"], found["passive tip radius"]
    assert (tip.stated, tip.budget, tip.factor) == ("12.5 µm", "10.4 … 14.6 µm", "")
    assert (passive.budget, passive.factor) == ("", "")
    assert "× 8" not in report(result)[: report(result).index('id="simulation"')]
