"""Fitted values that no part on a film can have, or that ran into the end of what was searched."""

from __future__ import annotations

import math

from meso_robust.identification.models.model import Model, Parameter
from meso_robust.types import Floats

_AT_THE_END = 1e-3  # of the range, of its logarithm if the parameter counts by ratio


def doubts(model: Model, values: Floats) -> tuple[str, ...]:
    """What makes fitted values unlikely to be the part's, a line each.

    Parameters
    ----------
    model, values
        The fitted model, and its (n,) parameters in SI.
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
