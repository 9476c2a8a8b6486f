"""What a fit is worth: one word, and what to do about it.

χ² with the noise that is stated, or estimated from still frames, decides whether the recordings reject
the model. Noise that was fitted with the model makes χ² fit by itself and decides nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from meso_robust.identification.document import FitWord, ModelDocument

Colour = Literal["PROVED", "UNKNOWN", "NEUTRAL"]

COLOURS: Mapping[FitWord, Colour] = {
    "IDENTIFIED": "PROVED",
    "PARTLY IDENTIFIED": "UNKNOWN",
    "NOT IDENTIFIED": "UNKNOWN",
    "FITTED": "NEUTRAL",
    "FIT REJECTED": "UNKNOWN",
}
NEGATIVE_WORDS = ("NOT IDENTIFIED", "FIT REJECTED")
"""Verdicts that are a negative answer."""
_LEAST_P = 1e-12  # what is smaller is told as being smaller


def verdict(document: ModelDocument) -> FitWord:
    """The word for a fitted model."""
    quality = document.quality
    if quality is not None and quality.rejected:
        return "FIT REJECTED"
    bounded = [not (one.open_low or one.open_high) for one in document.parameters.values()]
    if not any(bounded):
        return "NOT IDENTIFIED"
    if not all(bounded):
        return "PARTLY IDENTIFIED"
    return "FITTED" if quality is None or _noise_fitted(document) else "IDENTIFIED"


def meaning(document: ModelDocument) -> str:
    """The grounds of the word in a sentence, with what to do; empty if there is nothing to add."""
    word, quality = verdict(document), document.quality
    if word == "FIT REJECTED" and quality is not None:
        return (
            f"the recordings reject this model: χ² = {quality.chi2:,.0f} on {quality.freedom:,} degrees "
            f"of freedom ({quality.chi2 / max(quality.freedom, 1):.3g} times what the noise explains, "
            f"{p_words(quality.p_value)}); values and intervals describe no laboratory. Run "
            "`meso-robust diagnose` to see what the model leaves out"
        )
    if word == "FITTED":
        why = (
            "the printed objective has no noise to compare with"
            if quality is None
            else "the noise was fitted too"
        )
        return f"nothing tells whether the model explains the recordings: {why}"
    return ""


def p_words(p_value: float) -> str:
    """A probability of χ²; never zero."""
    return f"p < {_LEAST_P:g}" if p_value < _LEAST_P else f"p = {p_value:.2g}"


def _noise_fitted(document: ModelDocument) -> bool:
    sensor = document.sensor
    return sensor is not None and sensor.position_source == sensor.orientation_source == "fitted"
