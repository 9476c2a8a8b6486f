"""Plans side by side: equal errors, exact intervals, and what a single uncertainty is."""

from __future__ import annotations

import numpy as np
import pytest

from meso_robust.reproduction import comparison, uncertainties
from meso_robust.reproduction.baselines import ON_FILM, Errors
from meso_robust.reproduction.item import Agreement, Setting
from meso_robust.reproduction.plans_figures import side_by_side
from meso_robust.reproduction.printed import FILM_RATIO, FRICTION
from meso_robust.reproduction.uncertainties import ONES, scaled


def test_a_scale_widens_every_range_about_its_middle() -> None:
    wide = scaled(ON_FILM, 2.0)
    assert wide.position == pytest.approx((10e-6, 10e-6))
    assert wide.tip == pytest.approx((10e-6, 10e-6))
    assert wide.orientation == pytest.approx(np.radians(0.6))
    assert wide.friction == pytest.approx((0.27, 0.39))
    assert wide.film_ratio == pytest.approx((0.9 * FILM_RATIO, 1.1 * FILM_RATIO))
    assert scaled(ON_FILM, 1.0).friction == pytest.approx(FRICTION)


def test_one_at_a_time_the_others_are_at_their_middle() -> None:
    changed = {
        "sensed position": {"position"},
        "sensed orientation": {"orientation"},
        "probe position": {"tip"},
        "friction": {"friction"},
        "film ratio": {"film_ratio"},
    }
    none = Errors(friction=(0.33, 0.33), film_ratio=(FILM_RATIO, FILM_RATIO))
    assert set(ONES) == set(changed)
    for name, one in ONES.items():
        differing = {
            key
            for key in ("position", "orientation", "tip", "friction", "film_ratio", "share")
            if getattr(one.errors, key) != pytest.approx(getattr(none, key))
        }
        assert differing == changed[name]


def test_shares_are_those_of_the_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """With plans that succeed in the first of every four runs, and a certified one that always does."""

    def quarter(plan: object, runs: int, errors: Errors, rng: object, step: float) -> np.ndarray:
        return np.arange(runs) % 4 == 0

    monkeypatch.setattr(comparison, "several", lambda _: {"RRT": ((), ()), "scripted": ((),)})
    monkeypatch.setattr(comparison, "successes", quarter)
    monkeypatch.setattr(
        comparison, "certified_successes", lambda runs, seed: np.ones(runs, dtype=bool)
    )
    found = comparison.run(Setting(quick=True))
    data = found.data["hits_of_runs"]
    assert isinstance(data, dict)
    assert data[f"RRT: {comparison.STATED}"] == [50, 200]
    assert data[f"certified: {comparison.STATED}"] == [200, 200]
    row = next(row for row in found.rows if row.quantity.startswith("certified"))
    # of 200 successes in 200 the exact lower end is 0.025 to the power 1/200
    assert row.ours == pytest.approx((100.0 * 0.025 ** (1 / 200), 100.0))
    assert "100.00 % of the runs" in found.answer
    assert "25.0 %" in found.answer
    (picture,) = found.figures
    assert picture.svg.count("the same on dry points") == 2  # RRT and scripted; none is certified
    assert picture.svg.count("certified; stated") == 1


def test_the_answer_names_what_each_plan_suffers_from() -> None:
    shares = {
        "friction": {"RRT": [90.0, 10.0], "scripted": [100.0, 90.0], "certified": [100.0, 100.0]},
        "film ratio": {"RRT": [90.0, 40.0], "scripted": [100.0, 95.0], "certified": [100.0, 100.0]},
    }
    said = uncertainties._answer(shares, (1.0, 4.0))
    assert said == (
        "At 4 times its stated size, the RRT plan suffers most from the friction (10 % succeed); "
        "the scripted plan suffers most from the friction (90 % succeed); "
        "none makes a run of the certified plan fail. "
        "At 4 times the stated size the certified plan bears less than the scripted one: none of them."
    )


def test_every_share_that_is_not_the_printed_one_has_a_reason() -> None:
    for name in ("RRT", "scripted"):
        for what in (comparison.DRY, comparison.VARIED):
            row = comparison._row(name, what, 200, 1000)
            assert row.agreement is Agreement.DIFFERS
            assert row.why.endswith(comparison.REASONS[name, what])


def test_the_scripted_and_the_certified_plan_are_drawn_side_by_side() -> None:
    shares = {
        "friction": {"scripted": [100.0, 84.0], "certified": [100.0, 31.0]},
        "film ratio": {"scripted": [100.0, 92.0], "certified": [100.0, 100.0]},
    }
    assert uncertainties._compared(shares, 8.0) == (
        "At 8 times the stated size the certified plan bears less than the scripted one: "
        "friction (31 against 84 %)."
    )
    picture = side_by_side(shares, 8.0, "why")
    assert picture.caption == "why"
    for words in ("scripted", "certified", "friction", "film ratio", ">84<", ">31<", ">92<"):
        assert words in picture.svg
