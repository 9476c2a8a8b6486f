"""Samples of one clock brought to the instants of another."""

from __future__ import annotations

import numpy as np

from meso_robust.types import Flags, Floats


def forward(times: Floats) -> Flags:
    """Rows of a clock that go on: each later than all before it.

    Parameters
    ----------
    times
        (T,) instants as they were recorded.

    Returns
    -------
    Flags
        (T,); the first is always true.
    """
    before = np.maximum.accumulate(times)
    return np.concatenate(([True], times[1:] > before[:-1]))[: times.size]


def sampled(instants: Floats, times: Floats, values: Floats, hole: float) -> Floats:
    """Values at other instants, linearly between the two samples around each.

    Parameters
    ----------
    instants
        (N,) in s.
    times
        (T,) instants of the samples in s, strictly increasing.
    values
        (T, D) samples.
    hole
        Longest time between two samples, in s, across which is interpolated.

    Returns
    -------
    Floats
        (N, D); NaN before the first sample, after the last and in holes. An instant that has a
        sample of its own gets it, whatever lies beside it.
    """
    if times.size == 0:
        return np.full((instants.size, values.shape[1]), np.nan)
    after = np.clip(np.searchsorted(times, instants), 0, times.size - 1)
    before = np.clip(after - 1, 0, None)
    step = times[after] - times[before]
    exact = times[after] == instants
    within = (times[before] < instants) & (instants < times[after]) & (step <= hole)
    weight = np.divide(instants - times[before], step, out=np.ones(instants.size), where=step > 0.0)
    weight = np.where(exact, 1.0, np.clip(weight, 0.0, 1.0))[:, None]
    between = (1.0 - weight) * values[before] + weight * values[after]
    return np.where((exact | within)[:, None], between, np.nan)
