"""Bringing samples of one clock to the instants of another."""

from __future__ import annotations

import numpy as np
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from meso_robust.recordings.importers.streams import forward, sampled

CLOCKS = arrays(np.float64, st.integers(1, 12), elements=st.integers(0, 20).map(float))


@given(CLOCKS)
def test_a_clock_goes_on_where_each_row_is_later_than_all_before(times: np.ndarray) -> None:
    expected = [all(later > earlier for earlier in times[:k]) for k, later in enumerate(times)]
    assert forward(times).tolist() == expected


def test_samples_are_joined_only_between_themselves_and_across_no_hole() -> None:
    times = np.array([1.0, 2.0, 3.0, 6.0, 7.0])
    values = np.stack([10.0 * times, -times], axis=-1)
    instants = np.array([0.9, 1.0, 1.25, 3.0, 4.5, 6.0, 6.5, 7.0, 7.1])
    found = sampled(instants, times, values, hole=1.0)
    seen = np.array([False, True, True, True, False, True, True, True, False])
    assert np.array_equal(np.isfinite(found).all(axis=1), seen)
    assert np.allclose(found[seen, 0], 10.0 * instants[seen], atol=1e-12)
    assert np.allclose(found[seen, 1], -instants[seen], atol=1e-12)
    assert np.isfinite(sampled(instants, times, values, hole=3.0)[4]).all()


def test_nothing_comes_of_no_samples() -> None:
    assert np.isnan(sampled(np.zeros(3), np.zeros(0), np.zeros((0, 2)), hole=1.0)).all()
    one = sampled(np.array([0.0, 1.0, 2.0]), np.array([1.0]), np.array([[5.0]]), hole=9.0)
    assert np.array_equal(one[:, 0], [np.nan, 5.0, np.nan], equal_nan=True)
