"""Values that no part can have are told with the model: on the terminal, the page and in the file."""

from __future__ import annotations

import numpy as np
import pytest

import meso_robust as mr
from meso_robust.identification.models import MODELS
from meso_robust.identification.verdict import doubts
from meso_robust.simulator import Film
from tests.identification.sets import PART, random_pushes, recorded

HALF_DIAGONAL = np.hypot(808.0, 418.5)  # um
EVEN = (1616.0**2 + 837.0**2) / 12.0
"""Of a film that is even under the whole part, um²."""


def told(rho_um2: float, mu: float) -> tuple[str, ...]:
    model = MODELS["viscous"](PART.outline)
    return doubts(model, np.array([1e-12 * rho_um2, mu]))


@pytest.mark.parametrize("rho", [0.05 * EVEN, EVEN, 0.99 * HALF_DIAGONAL**2])
@pytest.mark.parametrize("mu", [0.01, 0.3, 0.99])
def test_what_a_film_under_the_part_can_have_is_not_doubted(rho: float, mu: float) -> None:
    assert told(rho, mu) == ()


@pytest.mark.parametrize("rho", [0.01 * EVEN, 1.01 * HALF_DIAGONAL**2, 100.0 * EVEN])
def test_a_film_beyond_the_part_is_implausible(rho: float) -> None:
    (line,) = told(rho, 0.3)

    assert line.startswith("warning: rho_um2 = ")
    assert "implausible" in line


@pytest.mark.parametrize(
    ("rho", "mu", "words"),
    [
        (EVEN, 0.0, "mu = 0: at the lower end of its range, 0 to 1"),
        (EVEN, 1.0, "mu = 1: at the upper end"),
        (100.0 * HALF_DIAGONAL**2, 0.3, "at the upper end"),
        (1e-4 * HALF_DIAGONAL**2, 0.3, "at the lower end"),
    ],
)
def test_a_value_at_the_end_of_its_range_is_told(rho: float, mu: float, words: str) -> None:
    (line,) = told(rho, mu)

    assert words in line


def test_doubts_stand_on_the_terminal_on_the_page_and_in_the_file() -> None:
    """Recordings of a film twice as wide as the part, without friction."""
    rng = np.random.default_rng(3)
    film = Film.ratio(np.full(6, 4e-12 * EVEN))
    recordings = recorded(random_pushes(rng, 6), film, 0.0, rng)

    found = mr.identify(recordings, starts=4)

    files = found.files()
    for where in (str(found), files["model.toml"], files["identification.json"]):
        assert "implausible" in where
        assert "at the lower end of its range" in where
    assert files["report.html"].count("implausible") >= 1


def test_noise_that_was_assumed_is_told_apart() -> None:
    rng = np.random.default_rng(3)
    found = mr.identify(
        recorded(random_pushes(rng, 6), Film.ratio(np.full(6, 1e-12 * EVEN)), 0.3, rng), starts=4
    )

    assert "noise of x and y: σ = 1.2 µm" in str(found)
    assert found.document.sensor is not None
    repeatability = found.document.sensor.position_repeatability_um
    assert repeatability is None or repeatability == pytest.approx(1.2, rel=0.4)
    assert "noise of x and y" in found.files()["report.html"]
    assert "implausible" not in str(found)
