"""Profile likelihoods with several dips, of a likelihood that is written down here."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from meso_robust.identification import profiles
from meso_robust.identification.likelihood import Settings
from meso_robust.identification.models import MODELS
from meso_robust.identification.profiles import Profiled, profiled
from meso_robust.types import Floats

SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * 1e-3
MODEL = MODELS["viscous"](SQUARE)
MU = MODEL.keys.index("mu")
ROOT = 2.7055  # of χ² with one degree of freedom, 90 %


def rise(values: Floats) -> Floats:
    """A dip at 0.306 that is 0.002 wide, within one about 0.33 that is 0.016 wide."""
    mu = values[:, MU]
    return np.minimum(
        ((mu - 0.306) / 0.0012) ** 2,
        1.0 + ((mu - 0.33) / 0.01) ** 2 + (values[:, MU] < 0.308) * 9.0,
    )


@pytest.fixture
def found(monkeypatch: pytest.MonkeyPatch) -> Profiled:
    values = np.array([[1.5e-7, 0.306]])
    best: Any = SimpleNamespace(
        fits=SimpleNamespace(values=values, starts=[None], offsets=[None], chi2=np.zeros(1)),
        information=np.diag([1e6, 0.306**2 / 0.0012**2])[None],
        jacobian=None,
    )

    def fit(prepared: object, model: object, values: Floats, *_: object, **__: object) -> Any:
        return SimpleNamespace(fits=SimpleNamespace(values=values, chi2=rise(values)))

    monkeypatch.setattr(profiles, "fit", fit)
    nothing: Any = None
    return profiled(nothing, MODEL, Settings(position=1e-6, orientation=1e-3), best)


def test_an_interval_holds_what_is_as_likely_beyond_the_dip_of_the_fit(found: Profiled) -> None:
    mu = next(one for one in found.profiles if one.key == "mu")
    end = 0.33 + 0.01 * np.sqrt(ROOT - 1.0)
    assert mu.low == pytest.approx(0.306 - 0.0012 * np.sqrt(ROOT), abs=3e-4)
    assert mu.high == pytest.approx(end, abs=2e-3)
    assert not mu.open_low
    assert not mu.open_high
    assert found.better is None
