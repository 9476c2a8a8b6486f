"""How a liquid's meniscus may brighten or darken the film about a needle: by any amount at some distances and heights."""

from __future__ import annotations

import numpy as np

from meso_robust.types import Floats

RINGS = (0.0, 1.2, 2.7, 4.6, 7.0, 10.1, 14.0)
"""px from a needle between which the change is linear; at the last it has ended."""
CLIMB, HEIGHTS = 9.0, 3
"""px of shaft over which it may change, and how many places along it tell how."""
COUNT = HEIGHTS * (len(RINGS) - 1)
"""Of unknown shares, those of one ring after the other."""
_SPREAD = 0.25  # of each, over the film's brightness, before the image is seen
# px away from a needle and along it over which they are alike, and the share of their variance that is not
_WIDE, _HIGH, _OWN = 3.0, 18.0, 1e-4


def certainty() -> Floats:
    """(COUNT, COUNT) inverse covariance of the shares before the image is seen: they are smooth, and about 0."""
    places = np.meshgrid(RINGS[:-1], CLIMB * np.arange(HEIGHTS), indexing="ij")
    away, up = (np.subtract.outer(one.ravel(), one.ravel()) for one in places)
    alike = np.exp(-0.5 * ((away / _WIDE) ** 2 + (up / _HIGH) ** 2)) + _OWN * np.eye(COUNT)
    return np.asarray(np.linalg.inv(_SPREAD**2 * alike))
