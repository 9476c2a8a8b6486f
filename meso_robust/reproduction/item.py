"""An item of the reproduction, and what came of it: rows with printed value and ours, and pictures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import TypeAlias

import numpy as np

from meso_robust.campaigns.intervals import share_interval
from meso_robust.reporting.pages import Figure
from meso_robust.types import Floats

Value: TypeAlias = float | tuple[float, float] | str | None
"""A number, a range from and to, words, or None where there is nothing to compare with."""

Told = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and of how much."""


class Agreement(Enum):
    """How a printed number or range and ours lie to each other; the value is what readers see."""

    PRINT_CONTAINS = "the print contains ours"
    OURS_CONTAINS = "ours contains the print"
    OVERLAPS = "they overlap"
    DIFFERS = "they differ"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One quantity, as printed and as found.

    Attributes
    ----------
    quantity, unit
        In words, and its unit (um, deg, s, %); empty for a plain number.
    printed
        By the paper; None where it prints none.
    ours
        Found here.
    why
        Where they differ or nothing is printed: the reason, and the input that the paper leaves out.
    loose
        What stands as printed is no result but a tolerance, or what a few trials leave open: to lie
        within it says little, so such a row is counted apart.
    """

    quantity: str
    unit: str = ""
    printed: Value = None
    ours: Value
    why: str = ""
    loose: bool = False

    def __post_init__(self) -> None:
        """Refuse a difference without a reason.

        Raises
        ------
        ValueError
            Names the quantity.
        """
        if self.agreement is Agreement.DIFFERS and not self.why:
            raise ValueError(f"{self.quantity}: differs from the print; say why")

    @property
    def agreement(self) -> Agreement | None:
        """Which contains the other; None if not comparable."""
        if isinstance(self.printed, str | None) or isinstance(self.ours, str | None):
            return None
        low, high = _ends(self.printed)
        own_low, own_high = _ends(self.ours)
        if low <= own_low and own_high <= high:
            return Agreement.PRINT_CONTAINS
        if own_low <= low and high <= own_high:
            return Agreement.OURS_CONTAINS
        return Agreement.OVERLAPS if own_low <= high and low <= own_high else Agreement.DIFFERS

    @property
    def difference(self) -> float | None:
        """Ours less the printed number, or how far from the printed range; None if not comparable."""
        if isinstance(self.printed, str | None) or isinstance(self.ours, str | None):
            return None
        low, high = _ends(self.printed)
        own_low, own_high = _ends(self.ours)
        if own_low > high:
            return own_low - high
        if own_high < low:
            return own_high - low
        return 0.0


def _ends(value: float | tuple[float, float]) -> tuple[float, float]:
    return value if isinstance(value, tuple) else (value, value)


def span(numbers: Floats) -> tuple[float, float]:
    """Smallest and largest of those that are known: a run that jams has none."""
    known = numbers[np.isfinite(numbers)]
    return float(known.min()), float(known.max())


def success(hits: int, runs: int) -> tuple[float, float]:
    """Exact 95 % interval (Clopper–Pearson) of the probability of success, in %."""
    low, high = share_interval(hits, runs)
    return 100.0 * low, 100.0 * high


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """The outcome of an item.

    Attributes
    ----------
    answer
        One or two sentences: whether the paper's result stands, and with what.
    rows
        Quantities side by side.
    missing
        Inputs that the paper does not print, and what was taken instead.
    figures
        Pictures.
    data
        What the figures and rows are made of, for other programs: numbers, strings, lists, mappings.
    """

    answer: str
    rows: tuple[Row, ...]
    missing: tuple[str, ...] = ()
    figures: tuple[Figure, ...] = ()
    data: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """How much is to be done.

    Attributes
    ----------
    quick
        Fewer runs: for a first look and for tests.
    seed
        The same seed gives the same result.
    told
        Told of progress.
    """

    quick: bool = False
    seed: int = 0
    told: Told = lambda *_: None


@dataclass(frozen=True, slots=True, kw_only=True)
class Item:
    """Something that the paper reports.

    Attributes
    ----------
    title, where
        In words, and the place in the paper.
    run
        Makes it again.
    """

    title: str
    where: str
    run: Callable[[Setting], Found]
