"""Certificates that are kept with the sources are verified by the checker as it is."""

from __future__ import annotations

from pathlib import Path

import pytest

from meso_robust.api.check import check
from tests.nightly import at_night

REPORTS = Path(__file__).parents[2] / "reports"


@at_night
@pytest.mark.parametrize("folder", ["real_paper", "real_paper/at_38_um"])
def test_the_kept_plans_of_real_probes_are_verified(folder: str) -> None:
    found = check(REPORTS / folder / "certificate.json", REPORTS / folder / "task.toml")
    assert (found.verdict, found.verified) == ("VERIFIED", True)
