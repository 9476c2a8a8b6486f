"""What a direct test finds: an effect with a first estimate of its size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

TestName = Literal["gap", "hand", "clock", "straight", "balance", "rest"]
"""Tip to face while pushing, part in the hand's frame, stamps, straight travel, moments, frames at rest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """One number of an effect, in the unit of its key, with its 90 % interval.

    Attributes
    ----------
    key
        As in the catalogue of effects, such as ``x_um``.
    value, low, high
        Least squares; the interval is that of the jackknife over recordings.
    """

    key: str
    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """An effect that a direct test sees.

    Attributes
    ----------
    test
        Which one.
    effect
        Name in the catalogue of effects.
    estimates
        First estimates of its numbers.
    before, after
        Robust standard deviation of what the test looks at without and with it, in m.
    p_value
        Of the randomisation test over the signs of whole recordings, for the largest of all effects
        tried; NaN where none was made.
    alike
        Effects that would explain nearly as much at the same step: these recordings hardly
        distinguish them.
    """

    test: TestName
    effect: str
    estimates: tuple[Estimate, ...]
    before: float
    after: float
    p_value: float
    alike: tuple[str, ...] = ()


PHYSICAL: Mapping[str, tuple[float, float]] = {
    "camera_latency.time_ms": (0.0, 1000.0),  # a camera cannot see ahead
    "camera_scale.percent": (-20.0, 20.0),
    "camera_anisotropy.x_percent": (-20.0, 20.0),
    "camera_anisotropy.y_percent": (-20.0, 20.0),
    "camera_rotation.angle_deg": (-15.0, 15.0),
    "part_yaw.angle_deg": (-15.0, 15.0),
}
"""Ranges beyond which an estimate is vetoed, in the unit of the key."""
MOST_OF_SIZE = 0.25
"""Lengths beyond this share of the part's size are vetoed: no template is off by a quarter."""


def possible(effect: str, key: str, value: float, size_um: float) -> bool:
    """Whether a value is within physical ranges.

    Parameters
    ----------
    effect, key
        As in the catalogue.
    value
        In the unit of the key.
    size_um
        Square root of the part's area.

    Returns
    -------
    bool
        False vetoes the effect.
    """
    low, high = PHYSICAL.get(f"{effect}.{key}", (-float("inf"), float("inf")))
    if key.endswith("_um"):
        low, high = -MOST_OF_SIZE * size_um, MOST_OF_SIZE * size_um
    return low <= value <= high
