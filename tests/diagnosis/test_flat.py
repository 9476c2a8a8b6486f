"""A size that recordings bound to one side only has an open end."""

from __future__ import annotations

import pytest

from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.flat import opened


def test_a_size_that_is_told_to_both_sides_keeps_its_interval(late: Diagnosis) -> None:
    best = late.best
    assert best is not None
    assert opened(late.baseline, best.refit, late.known) == late.known


@pytest.mark.parametrize(
    ("without", "twice", "is_open"),
    [(1000.0, 103.0, True), (1000.0, 120.0, False), (110.0, 100.1, False)],
)
def test_a_size_is_open_where_twice_as_much_does_as_well(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch, without: float, twice: float, is_open: bool
) -> None:
    """By what is left of a best fit that leaves 100: without the effect, and with twice its size."""
    best = late.best
    assert best is not None
    monkeypatch.setattr("meso_robust.diagnosis.flat._chi2", lambda *_: [100.0, without, twice])
    found = {one.key: one for one in opened(late.baseline, best.refit, late.known)}
    own = found["camera_latency.time_ms"]
    before = next(one for one in late.known if one.key == own.key)
    assert own.open_high == is_open
    assert own.high == (2.0 * own.value if is_open else before.high)
    assert (own.low, own.open_low) == (before.low, False)
    assert found["mu"] == next(one for one in late.known if one.key == "mu")
