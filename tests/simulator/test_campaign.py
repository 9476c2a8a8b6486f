"""Quick form of the property campaign, and its measures on results that are wrong."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from meso_robust.simulator import Outcome, simulate
from reports.simulator import campaign
from reports.simulator.jam import jam_is_real
from tests.simulator import draws
from tests.simulator.problems import UM, one_point, two_sided

WRONG = ("FALSE", "close")


def test_laws_hold_on_random_moves() -> None:
    reports = campaign.campaign(range(1000, 1110))
    kinds = {name for report in reports for name in report.kind.split("+")}
    assert kinds == {"Point", "Round", "Flat"}
    outcomes = [report.outcome for report in reports]
    assert outcomes.count(Outcome.COMPLETED) > 40
    assert outcomes.count(Outcome.JAM) > 10
    assert Outcome.SOLVER_FAILURE not in outcomes
    assert outcomes.count(Outcome.OUT_OF_RANGE) < 6
    for report in reports:
        assert report.measures["penetration"] <= 1.0, report
        assert report.measures.get("balance", 0.0) < 1e-9, report
        assert report.measures.get("energy", 0.0) < 1e-9, report
        assert report.measures.get("cone", 0.0) < 1e-9, report
        assert report.jam not in WRONG, report


def broken(name: str) -> campaign.Report:
    """Measures of a good run with one thing made wrong."""
    push = one_point(200 * UM, 100 * UM, 1 * UM)
    result = simulate(push, record=100)
    arrays: dict[str, Any] = {"path": result.path.copy(), "forces": result.forces.copy()}
    if name == "deep":
        arrays["path"][0, :, 0] += 0.5 * UM
    elif name == "weak":
        arrays["forces"][0, 50] *= 0.9
    elif name == "sideways":
        arrays["forces"][0, 1:] = np.abs(arrays["forces"][0, 1:]) * [0, 1]
    report = campaign.Report(0)
    campaign.measure(push, replace(result, **arrays), report)
    return report


def test_measures_tell_what_is_wrong() -> None:
    good = broken("nothing").measures
    assert good["penetration"] < 0.5
    assert max(good["balance"], good["energy"], good["cone"]) < 1e-9
    assert broken("deep").measures["penetration"] > 1.5
    assert broken("weak").measures["balance"] > 0.05
    assert broken("weak").measures["energy"] > 0.05
    assert broken("sideways").measures["cone"] > 0.5


def test_jam_is_confirmed_and_a_step_that_goes_on_is_not_called_one() -> None:
    jammed = two_sided([857 * UM], 1700 * UM, 1 * UM)
    result = simulate(jammed, record=jammed.steps)
    assert result.outcomes[0] == Outcome.JAM
    assert jam_is_real(jammed, result) == "real"
    free = two_sided([1000 * UM], 300 * UM, 1 * UM)
    assert jam_is_real(free, simulate(free, record=free.steps)) == "FALSE"


def test_table_names_the_seed_of_the_worst() -> None:
    reports = [
        campaign.Report(seed, 0, "Point", {"penetration": depth})
        for seed, depth in ((3, 0.1), (7, 0.4), (8, 0.2))
    ]
    assert "| COMPLETED | 3 |" in campaign.table(reports)
    assert "| penetration | 0.4 | 7 |" in campaign.table(reports)


def test_a_seed_gives_the_same_push() -> None:
    one, two = draws.draw(1001), draws.draw(1001)
    assert one is not None
    assert two is not None
    np.testing.assert_array_equal(one.waypoints, two.waypoints)
    assert simulate(one).poses[0] == pytest.approx(simulate(two).poses[0], abs=0)
