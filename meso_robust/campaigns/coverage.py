"""How much of the box of everything uncertain was drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meso_robust.campaigns.kind import Coverage
from meso_robust.types import Floats

BINS = 20
"""Equal parts of the range of each coordinate."""


def histogram(rows: Floats, low: Floats, high: Floats) -> list[list[int]]:
    """(D, BINS) rows (N, D) in each part of each coordinate's range; an end counts to its part."""
    width = np.where(high > low, high - low, 1.0)
    bins = np.minimum(((rows - low) / width * BINS).astype(int), BINS - 1)
    return [[int(n) for n in np.bincount(column, minlength=BINS)] for column in bins.T]


def coverage(names: Sequence[str], counts: Sequence[Sequence[int]]) -> Coverage:
    """Histograms as a picture.

    Parameters
    ----------
    names
        Of the D coordinates.
    counts
        (D, BINS) from :func:`histogram`, perhaps added up.
    """
    return Coverage(
        title="Coverage of the uncertainty box",
        labels=tuple(names),
        counts=tuple(tuple(int(n) for n in row) for row in counts),
        note=f"Executions in each of {BINS} equal parts of every range, low to high.",
    )
