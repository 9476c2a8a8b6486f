"""Whether a search has explained what was seen: few frames may speak against it by themselves, all for it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from meso_robust.identification.identify import _explained


@pytest.mark.parametrize(
    ("few", "every", "explained", "asked"),
    [
        (4.1, 1.0, False, 0),  # so far off that all frames are not asked
        (3.9, 1.0, True, 1),
        (1.0, 1.1, False, 1),  # what few frames hide
    ],
)
def test_all_frames_are_asked_unless_few_of_them_are_far_off(
    monkeypatch: pytest.MonkeyPatch, few: float, every: float, explained: bool, asked: int
) -> None:
    rough, fine = np.full((2, 3), 30), np.full((2, 3), 300)
    freedom = [counts.sum() - 2 * 3 - 2 for counts in (rough, fine)]  # two starts, two numbers
    calls: list[object] = []

    def fit(prepared: object, *_: object) -> Any:
        calls.append(prepared)
        return SimpleNamespace(fits=SimpleNamespace(chi2=np.array([every * freedom[1]])))

    monkeypatch.setattr("meso_robust.identification.identify.fit", fit)
    job: Any = SimpleNamespace(
        model=SimpleNamespace(fitted=np.array([True, True])),
        rough=SimpleNamespace(counts=rough),
        fine=SimpleNamespace(counts=fine),
    )
    best: Any = SimpleNamespace(cost=few * freedom[0], values=np.zeros(2))
    none: Any = None
    assert _explained(job, none, best) is explained
    assert len(calls) == asked
