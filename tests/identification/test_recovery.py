"""The recovery campaign in its quick form; see ``recovery.py`` for the full one."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
from scipy.stats import chi2

from reports.identification.recovery import Result, campaign, case, clopper


def test_errors_on_the_film_are_as_large_as_their_intervals_say() -> None:
    """Over many sets the errors, in standard deviations, have a mean square of one."""
    results = campaign("viscous", 3, starts=2)
    assert [one.refused for one in results] == [""] * 3
    errors = [np.array(one.errors)[np.isfinite(one.widths)] for one in results]
    z = 1.645 * np.concatenate(errors)
    assert np.sum(z**2) < chi2.ppf(0.999, len(z))
    assert np.all(np.concatenate([one.widths for one in results]) < 0.1)


def test_truths_differ_from_set_to_set() -> None:
    assert not np.any(case("viscous", 0).truth == case("viscous", 1).truth)


def test_the_campaign_goes_on_from_its_ledger(tmp_path: Path) -> None:
    ledger = tmp_path / "ledger.jsonl"
    kept = Result("viscous", 0, 2, ["mu"], [False], [3.5], [0.1], 1.0)
    ledger.write_text(json.dumps(asdict(kept)) + "\n", encoding="utf-8")
    assert campaign("viscous", 1, starts=2, ledger=ledger) == [kept]


def test_the_interval_of_a_share() -> None:
    np.testing.assert_allclose(clopper(9, 10), (0.5550, 0.9975), atol=1e-4)
