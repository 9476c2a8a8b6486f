"""Problems whose highest points are known."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from meso_robust.campaigns.falsify.budgeted_search import Problem

Floats = npt.NDArray[np.float64]

SIZE = 25
"""As many coordinates as the paper's plan has uncertain numbers."""


def problem(score: Callable[[Floats], Floats], limit: float = math.inf) -> Problem:
    """A score over the box from -1 to 2."""
    return Problem(score=score, low=np.full(SIZE, -1.0), high=np.full(SIZE, 2.0), limit=limit)


def signs() -> npt.NDArray[np.int64]:
    """(SIZE,) +1 or -1, from the digits of a hash and not from a generator."""
    bits = hashlib.sha256(b"corner").digest()
    return np.array([1 if byte % 2 else -1 for byte in bits[:SIZE]])


def share_above(sides: int, gap: Fraction) -> float:
    """Probability that ``sides`` uniform numbers of 0 to 1 have a sum above ``sides - gap``.

    Irwin and Hall, by inclusion and exclusion in exact arithmetic.
    """
    terms = (
        (-1) ** k * math.comb(sides, k) * (gap - k) ** sides
        for k in range(sides + 1)
        if gap - k > 0
    )
    return float(sum(terms, Fraction(0)) / math.factorial(sides))
