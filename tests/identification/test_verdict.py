"""What a fit is worth: the word, its grounds, and what is no test at all."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from scipy.stats import chi2, f

from meso_robust.identification.document import ModelDocument
from meso_robust.identification.prepared import sigmas_of
from meso_robust.identification.quality import quality
from meso_robust.identification.verdict import COLOURS, NEGATIVE_WORDS, meaning, verdict
from meso_robust.recordings import read_set
from meso_robust.recordings.noise import estimated_noise
from tests.transfer.models import model


def fitted(
    p_value: float | None = 0.4,
    source: str = "stated",
    open_: tuple[str, ...] = (),
    **more: Any,
) -> ModelDocument:
    """A plain model with a test of its fit."""
    tested = {
        "chi2": 22086.4,
        "freedom": 2815,
        "p_value": p_value,
        "correlation": 0.1,
        "inflation": 1.0,
        "numerical": 0.0,
    }
    sensor = {
        "position_sigma_um": 1.0,
        "orientation_sigma_deg": 0.1,
        "position_source": source,
        "orientation_source": source,
    }
    return model(open_=open_, quality=None if p_value is None else tested, sensor=sensor, **more)


@pytest.mark.parametrize(
    ("document", "word"),
    [
        (fitted(), "IDENTIFIED"),
        (fitted(open_=("mu",)), "PARTLY IDENTIFIED"),
        (fitted(open_=("mu", "rho_um2")), "NOT IDENTIFIED"),
        (fitted(p_value=0.0), "FIT REJECTED"),
        (fitted(p_value=0.0, open_=("mu",)), "FIT REJECTED"),
        (fitted(source="fitted"), "FITTED"),
        (fitted(p_value=None), "FITTED"),
    ],
)
def test_the_word(document: ModelDocument, word: str) -> None:
    assert verdict(document) == word


def test_green_is_for_a_fit_that_was_tested_and_held() -> None:
    assert [word for word, colour in COLOURS.items() if colour == "PROVED"] == ["IDENTIFIED"]
    assert NEGATIVE_WORDS == ("NOT IDENTIFIED", "FIT REJECTED")


def test_a_rejection_says_the_figures_and_what_to_do() -> None:
    said = meaning(fitted(p_value=0.0))

    for words in ("χ² = 22,086 on 2,815", "7.85 times", "p < 1e-12", "`meso-robust diagnose`"):
        assert words in said
    assert meaning(fitted()) == ""


@pytest.mark.parametrize("ratio", [0.9, 1.05, 1.3, 2.0])
def test_noise_that_is_an_estimate_rejects_no_more_than_it_can(ratio: float, film_fit: Any) -> None:
    """χ² over its degrees of freedom is then a ratio of two variances: Fisher's law."""
    prepared, settings, fits = film_fit.prepared, film_fit.settings, film_fit.fitted.fits
    known = replace(prepared, sigmas=replace(prepared.sigmas, freedom=20.0))
    plain = quality(prepared, film_fit.model, fits, settings.sigma)
    scaled = replace(fits, chi2=fits.chi2 / plain.chi2 * plain.freedom * ratio)

    stated = quality(prepared, film_fit.model, scaled, settings.sigma)
    estimated = quality(known, film_fit.model, scaled, settings.sigma)

    n = plain.freedom
    assert stated.p_value == pytest.approx(1.0 - chi2.cdf(n * ratio, n), abs=1e-9)
    assert estimated.p_value == pytest.approx(1.0 - f.cdf(ratio, n, 20), abs=1e-9)


def test_what_still_frames_know_is_counted() -> None:
    known = read_set(Path(__file__).parents[1] / "example" / "set")
    sensor = replace(known.sensor, position_sigma=1e-6, orientation_sigma=1e-3)
    stated = replace(known, sensor=sensor)
    unstated = replace(known, sensor=replace(sensor, position_sigma=None, orientation_sigma=None))
    noise = estimated_noise(unstated)

    assert sigmas_of(stated).freedom == float("inf")
    assert sigmas_of(unstated).freedom == min(
        noise.x.freedom + noise.y.freedom, noise.theta.freedom
    )
    assert sigmas_of(unstated).freedom > 20
