"""What a fit is worth: one word, and what to do about it.

χ² with the noise that is stated, or estimated from still frames, decides whether the recordings reject
the model. Noise that was fitted with the model makes χ² fit by itself and decides nothing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

from meso_robust.identification.document import FitWord, ModelDocument
from meso_robust.identification.models.model import Model, Parameter
from meso_robust.types import Floats

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
_AT_THE_END = 1e-3  # of the range, of its logarithm if the parameter counts by ratio


def verdict(document: ModelDocument) -> FitWord:
    """The word for a fitted model.

    Parameters
    ----------
    document
        The fitted model.

    Returns
    -------
    FitWord
        See `ModelDocument.verdict`; χ² rejects before bounds are looked at, because intervals of a
        rejected model mean nothing.
    """
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
    """The grounds of the word in a sentence, with what to do; empty if there is nothing to add.

    Parameters
    ----------
    document
        The fitted model.

    Returns
    -------
    str
        One or two sentences.
    """
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
        return f"nothing shows whether the model explains the recordings: {why}"
    return ""


def p_words(p_value: float) -> str:
    """A probability of χ²; never zero.

    Parameters
    ----------
    p_value
        0 … 1; a χ² that is far out has one that underflows to 0.

    Returns
    -------
    str
        ``p = …`` or ``p < …``.
    """
    return f"p < {_LEAST_P:g}" if p_value < _LEAST_P else f"p = {p_value:.2g}"


def _noise_fitted(document: ModelDocument) -> bool:
    sensor = document.sensor
    return sensor is not None and sensor.position_source == sensor.orientation_source == "fitted"


def doubts(model: Model, values: Floats) -> tuple[str, ...]:
    """What makes fitted values unlikely to be the part's, a line each.

    Parameters
    ----------
    model, values
        The fitted model, and its (n,) parameters in SI.

    Returns
    -------
    tuple of str
        None where every value is plausible and within its range.
    """
    lines = (_doubt(p, float(v)) for p, v in zip(model.parameters, values, strict=True))
    return tuple(line for line in lines if line)


def _doubt(one: Parameter, value: float) -> str:
    if one.unseen:
        return ""
    shown = f"warning: {one.key} = {one.shown(value):.6g}"
    low, high = one.shown(one.low), one.shown(one.high)
    end = _end(one, value)
    if end:
        return (
            f"{shown}: at the {end} end of its range, {low:.4g} to {high:.4g}; a fit that ends there "
            "has not found the part's value; check units, outline and tips, or fit another model"
        )
    if one.likely is not None and not one.likely[0] <= value <= one.likely[1]:
        least, most = (one.shown(bound) for bound in one.likely)
        return (
            f"{shown}: implausible; {one.why_likely}, {least:.4g} to {most:.4g}; check units, outline "
            "and tips"
        )
    return ""


def _end(one: Parameter, value: float) -> str:
    """Which end of its range a value is at, if any."""
    if one.log:
        place = math.log(value / one.low) / math.log(one.high / one.low)
    else:
        place = (value - one.low) / (one.high - one.low)
    return "lower" if place < _AT_THE_END else "upper" if place > 1.0 - _AT_THE_END else ""
