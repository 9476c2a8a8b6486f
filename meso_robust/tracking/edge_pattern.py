"""How an outline looks across, and the filter that reads its displacement off a profile.

Rolling lines, grain and patches on the metal and slow shading of the background change a profile from
place to place, and a plain correlation with the mean profile takes much of that for a displacement. How
they vary is seen along the outline itself. So the displacement is the generalised least-squares one:
profile = gain · pattern - displacement · pattern′ + what varies, with the covariance of what varies as
the sides show it. A displacement that varies along the outline leaves the filter as it is.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from meso_robust.types import Floats, Ints

STEP = 0.5
"""Distance in px of the samples of a profile."""
PATTERN_HALF = 11
"""Samples either side of the outline that a pattern has (5.5 px: rim, blur and some background)."""
_STEP_WIDTH = 1.6  # px, standard deviation of a blurred single edge
_LIKE = 0.8  # least correlation of a profile that what varies is learned from
_ODD = 0.05  # share of the profiles, specks and dust, that it is not learned from
_LEAST = 4 * PATTERN_HALF  # profiles, about two for every sample, below which nothing is learned
_WHITE = 0.1  # share of the mean variance that is added evenly: a few hundred profiles tell no more


class Pattern(NamedTuple):
    """What a profile's derivative is compared with.

    Attributes
    ----------
    mean
        (2 PATTERN_HALF + 1,) grey values a px.
    filters
        (2, 2 PATTERN_HALF + 1) whose products with a derivative are its gain, and its gain times
        its outward displacement in px, good within about 0.5 px; None: not learned.
    """

    mean: Floats
    filters: Floats | None


def single_step() -> Pattern:
    """Of a blurred step at the outline."""
    t = STEP * np.arange(-PATTERN_HALF, PATTERN_HALF + 1)
    return Pattern(np.exp(-0.5 * (t / _STEP_WIDTH) ** 2), None)


def learned(derivative: Floats, side: Ints) -> Pattern:
    """The pattern of derivatives (N, 2 PATTERN_HALF + 1) across an outline, the same on all sides.

    Which way dark and bright lie is decided profile by profile; ``side`` (N,) that each lies on.
    """
    if not len(derivative):
        return single_step()
    # the leading direction of the profiles does not care about their signs
    _, _, directions = np.linalg.svd(derivative, full_matrices=False)
    alike = np.sign(derivative @ directions[0])[:, None] * derivative
    mean = np.asarray(alike.mean(axis=0))
    size = np.linalg.norm(alike, axis=1) * np.linalg.norm(mean)
    like = alike @ mean > _LIKE * size
    if like.sum() < _LEAST:
        return Pattern(mean, None)
    return Pattern(mean, _filters(mean, _variation(alike[like], side[like])))


def _variation(profiles: Floats, side: Ints) -> Floats:
    """(K, K) covariance of profiles (N, K) about the mean of their side, the oddest left out."""
    apart = np.concatenate(
        [on - on.mean(axis=0) for on in (profiles[side == name] for name in np.unique(side))]
    )
    size = np.sum(apart**2, axis=1)
    kept = apart[size <= np.quantile(size, 1.0 - _ODD)]
    covariance = kept.T @ kept / len(kept)
    # and an even part beyond rounding where all profiles are alike
    white = _WHITE * np.trace(covariance) / len(covariance) + 1e-9 * np.mean(profiles**2)
    return np.asarray(covariance + white * np.eye(len(covariance)))


def _filters(mean: Floats, covariance: Floats) -> Floats:
    """(2, K) generalised least squares for gain and gain times displacement."""
    parts = np.column_stack((mean, -np.gradient(mean, STEP)))
    weighted = np.linalg.solve(covariance, parts)
    return np.asarray(np.linalg.solve(parts.T @ weighted, weighted.T))
