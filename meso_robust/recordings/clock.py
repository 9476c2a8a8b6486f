"""Which rows to keep so that the clock runs forward."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence

import numpy as np

from meso_robust.types import Floats, Indices


def forward(times: Floats) -> Indices:
    """Indices of as many instants as possible that increase strictly.

    If it loses no more rows, every instant that is later than all before it is kept; else one
    instant far ahead would throw out all that follow, and a longest increasing subsequence is taken
    (Schensted 1961, doi:10.4153/CJM-1961-015-3). Of equal instants the first is kept.

    Parameters
    ----------
    times
        (T,) finite instants.
    """
    if not times.size:
        return np.zeros(0, dtype=np.intp)
    later = np.ones(times.size, dtype=bool)
    later[1:] = times[1:] > np.maximum.accumulate(times)[:-1]
    longest = _longest(times.tolist())
    return np.flatnonzero(later) if later.sum() >= longest.size else longest


def _longest(times: Sequence[float]) -> Indices:
    """Longest strictly increasing subsequence by patience sorting."""
    ends: list[float] = []  # smallest last instant of an increasing run of each length
    at: list[int] = []  # its index
    before = np.full(len(times), -1, dtype=np.intp)
    for k, time in enumerate(times):
        length = bisect_left(ends, time)
        before[k] = at[length - 1] if length else -1
        if length == len(ends):
            ends.append(time)
            at.append(k)
        elif time < ends[length]:
            ends[length], at[length] = time, k
    chain = [at[-1]]
    while before[chain[-1]] >= 0:
        chain.append(int(before[chain[-1]]))
    return np.array(chain[::-1], dtype=np.intp)
