"""Shared inputs: repeatable Hypothesis settings, awkward doubles, and the shipped plan."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from fractions import Fraction
from functools import cache

from hypothesis import settings, strategies as st

from meso_robust.bounds import Interval
from meso_robust.certificates.chain import Chain, certify
from meso_robust.planning.compose import compose
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, load_task
from meso_robust.tasks import PAPER

REPEATABLE = settings(derandomize=True, deadline=None, database=None, max_examples=200)

LARGEST = sys.float_info.max
SMALLEST = 5e-324
AWKWARD = (0.0, -0.0, 1.0, 0.1, 1 / 3, SMALLEST, 1e-310, 2.3e-308, 1e-160, 1e160, 1e300, LARGEST)

doubles = st.one_of(
    st.sampled_from([sign * value for value in AWKWARD for sign in (1.0, -1.0)]),
    st.floats(-10.0, 10.0),
    st.floats(allow_nan=False, allow_infinity=False),
)


@st.composite
def intervals(draw: st.DrawFn, ends: st.SearchStrategy[float] = doubles) -> Interval:
    """Intervals of all widths, degenerate ones among them."""
    low = draw(ends)
    high = draw(st.one_of(st.just(low), ends))
    return Interval(min(low, high), max(low, high))


@st.composite
def intervals_with_points(
    draw: st.DrawFn, ends: st.SearchStrategy[float] = doubles
) -> tuple[Interval, list[Fraction]]:
    """An interval with exact points of it: both ends, and some in between."""
    whole = draw(intervals(ends))
    shares = draw(st.lists(st.fractions(0, 1, max_denominator=64), max_size=3))
    low, high = Fraction(whole.lo), Fraction(whole.hi)
    return whole, [low, high, *(low + share * (high - low) for share in shares)]


def holds(pair: Sequence[float], value: Fraction) -> bool:
    """Whether the exact ``value`` lies in the pair of ends."""
    return pair[0] <= value <= pair[1]


def is_whole(pair: Sequence[float]) -> bool:
    """Whether the pair is the whole line."""
    return tuple(pair) == (-math.inf, math.inf)


@cache
def paper_task() -> Task:
    """The task that ships with the package."""
    return load_task(PAPER)


@cache
def paper_chain() -> Chain:
    """The plan for it, certified."""
    task = paper_task()
    return certify(compose(task).rules, setup_of(task))
