"""What would speak against a name, on the page."""

from __future__ import annotations

import pytest
from markupsafe import Markup

from meso_robust.reporting.diagnosis import diagnosis_report
from meso_robust.reporting.pages import Figure
from tests.reporting.diagnoses import document, evidence


@pytest.fixture(autouse=True)
def _no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    names = ("budget", "held_out", "vectors", "map", "strip", "null")
    picture = Figure(svg=Markup("a picture"))
    drawn = {**dict.fromkeys(names, picture), "recordings": []}
    monkeypatch.setattr("meso_robust.reporting.diagnosis._pictures", lambda *_: drawn)


def page(**changes: object) -> str:
    return " ".join(
        diagnosis_report(document("named", **changes), evidence("named"), "set").split()
    )


def test_the_page_tells_where_the_physics_should_not_help_and_how_decoys_did() -> None:
    control = {"spans": 7, "within_sigma": 0.2, "sigma_before": 1.03, "sigma_after": 1.04}
    found = page(control=control, decoys=99, decoy_share=0.0)
    assert "in 7 spans of the recordings both models predict the same to within 0.2 σ" in found
    assert "1.03 σ with the plain and 1.04 σ with the extended model" in found
    assert "99 decoys have the signature of <code>dry_friction</code>" in found
    assert "0 % of them explain as much" in found
    assert "hardly supports its name" not in found


def test_many_decoys_that_do_as_well_are_a_warning_and_none_are_not_named() -> None:
    assert "hardly supports its name" in page(decoys=99, decoy_share=0.4)
    assert "40 % of them" in page(decoys=99, decoy_share=0.4)
    assert "decoys" not in page()
    assert "should not help" not in page()
