"""Examples drawn independently of each other, and of everything else in the process.

Hypothesis draws an example so as to be unlike the ones before it, repeats parts of them, and mixes in
constants from whatever modules happen to be imported. Then the examples of a chunk depend on what ran
before in the process, and "no failure in n examples" bounds no probability. Here each example is
drawn afresh from one distribution; only the first one of a search, the simplest, is always the same.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from contextlib import contextmanager
from random import Random
from typing import Any
from unittest import mock

from hypothesis.internal.conjecture import engine, providers
from hypothesis.internal.constants_ast import Constants

AT_AN_END = 0.1
"""Probability that a number lies at an end of its range: that is where things break."""
UNBOUNDED = 2**64
"""Where a range without an end is cut off."""

_names = (f"independent-{k}" for k in itertools.count())


class Independent(providers.PrimitiveProvider):
    """Uniform over the range of a number, or at one of its ends."""

    random: Random

    def draw_boolean(self, p: float = 0.5) -> bool:
        """True with probability ``p``."""
        return self.random.random() < p

    def draw_integer(
        self,
        min_value: int | None = None,
        max_value: int | None = None,
        *,
        weights: dict[int, float] | None = None,
        shrink_towards: int = 0,
    ) -> int:
        """An integer of the range; ``weights`` are hints and not needed."""
        low = -UNBOUNDED if min_value is None else min_value
        high = UNBOUNDED if max_value is None else max_value
        low, high = min(low, high), max(low, high)
        if self.random.random() < AT_AN_END:
            return self.random.choice((low, high))
        return self.random.randint(low, high)

    def draw_float(
        self,
        *,
        min_value: float = float("-inf"),
        max_value: float = float("inf"),
        allow_nan: bool = True,
        smallest_nonzero_magnitude: float,
    ) -> float:
        """A finite double of the range, -0.0 left out."""
        low, high = max(min_value, -float(UNBOUNDED)), min(max_value, float(UNBOUNDED))
        if self.random.random() < AT_AN_END:
            return self.random.choice((low, high))
        found = min(max(low + self.random.random() * (high - low), low), high)
        return found if abs(found) >= smallest_nonzero_magnitude else max(low, 0.0)

    def draw_string(self, intervals: Any, *, min_size: int = 0, max_size: int = 0) -> str:
        """No property is about text."""
        raise NotImplementedError("examples of properties are made of numbers, not of text")

    def draw_bytes(self, min_size: int = 0, max_size: int = 0) -> bytes:
        """No property is about bytes."""
        raise NotImplementedError("examples of properties are made of numbers, not of bytes")


@contextmanager
def independent(seed: int) -> Iterator[str]:
    """Name of a Hypothesis backend that draws from ``seed``, as long as the context lasts."""
    name = next(_names)
    drawn = type("Drawn", (Independent,), {"random": Random(seed)})
    with mock.patch.dict(providers.AVAILABLE_PROVIDERS, {name: drawn}), alone():
        yield name


@contextmanager
def alone() -> Iterator[None]:
    """Hypothesis does not look at the modules that are imported, not while it shrinks either.

    It would write what it finds there to the working directory, too.
    """
    nothing = Constants()
    providers.CONSTANTS_CACHE.cache.clear()
    with (
        mock.patch.object(providers, "_get_local_constants", return_value=nothing),
        # shrinking is limited by its count: a clock would let the machine's load decide
        mock.patch.object(engine, "MAX_SHRINKING_SECONDS", math.inf),
    ):
        yield
    providers.CONSTANTS_CACHE.cache.clear()
