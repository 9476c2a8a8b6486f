"""The pattern across an outline, and its filter where the surface beside the edge varies."""

from __future__ import annotations

import numpy as np

from meso_robust.tracking.edge_pattern import PATTERN_HALF, STEP, learned
from meso_robust.types import Floats

AT = STEP * np.arange(-PATTERN_HALF, PATTERN_HALF + 1)
SIDES = np.repeat(np.arange(4), 75)


def bump(place: Floats | float, width: float) -> Floats:
    """A blurred line, or the derivative of a blurred step, at a place (N, 1) px."""
    return np.asarray(np.exp(-0.5 * ((AT - place) / width) ** 2))


def profiles(rng: np.random.Generator, displacement: Floats) -> Floats:
    """(N, K) a dark rim's two edges, displaced, and beside the inner one lines and patches."""
    at = displacement[:, None]
    count = len(displacement)
    patch, line = rng.normal(0.0, [[0.15], [0.2]], (2, count))[..., None]
    slope = (AT - at + 2.0) / 1.3**2
    lines = line * slope * bump(at - 2.0, 1.3)
    return (
        bump(at, 1.3) + (0.6 + patch) * bump(at - 2.5, 1.3) + lines + rng.normal(0, 0.005, at.shape)
    )


def test_what_varies_beside_an_edge_hardly_displaces_it() -> None:
    rng = np.random.default_rng(0)
    pattern = learned(profiles(rng, np.zeros(300)), SIDES)
    assert pattern.filters is not None
    gain, moment = pattern.filters @ profiles(rng, np.full(300, 0.2)).T
    slope = -np.gradient(pattern.mean, STEP)
    plain = profiles(rng, np.full(300, 0.2)) - pattern.mean
    usual = plain @ slope / (slope @ slope)
    assert abs(np.median(moment / gain) - 0.2) < 0.02
    assert np.std(moment / gain) < 0.4 * np.std(usual)


def test_a_displacement_along_the_outline_is_not_taken_for_what_varies() -> None:
    """As of a pose that is not yet right: the filters still see it in full."""
    rng = np.random.default_rng(1)
    tilt = np.tile(np.linspace(-0.2, 0.2, 75), 4)
    pattern = learned(profiles(rng, tilt), SIDES)
    assert pattern.filters is not None
    gain, moment = pattern.filters @ profiles(rng, tilt).T
    assert abs(np.polyfit(tilt, moment / gain, 1)[0] - 1.0) < 0.1


def test_too_few_profiles_teach_no_filter() -> None:
    given = profiles(np.random.default_rng(2), np.zeros(300))
    assert learned(given[:20], SIDES[:20]).filters is None
    assert learned(given[:0], SIDES[:0]).filters is None


def test_profiles_without_any_variation_still_teach_one() -> None:
    alike = np.tile(np.round(64.0 * bump(0.0, 1.6)), (300, 1))  # their mean is exact
    filters = learned(alike, SIDES).filters
    assert filters is not None
    gain, moment = filters @ bump(0.1, 1.6)
    assert abs(moment / gain - 0.1) < 0.01
