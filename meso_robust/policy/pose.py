"""A pose as a camera reports it: read from a line, and compared with boxes of poses."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval
from meso_robust.policy.cover import ends_of
from meso_robust.primitives.setup import PoseBox
from meso_robust.reading import each_once, like
from meso_robust.types import Floats

KEYS = ("x_um", "y_um", "theta_deg")
WEIGHTS = np.array([1.0, 1.0, 100.0])  # a hundredth of a degree counts as much as 1 um
LARGEST = 1e6  # um or deg: catches a slip of the unit


class PoseError(ValueError):
    """A line is not a sensed pose; the message says what to send instead."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensed:
    """A sensed pose; orientations that differ by full turns are the same."""

    x_um: float
    y_um: float
    theta_deg: float

    @property
    def numbers(self) -> tuple[float, float, float]:
        """As they were sent."""
        return self.x_um, self.y_um, self.theta_deg

    def around(self, low: float, high: float) -> Iterator[PoseBox]:
        """The pose in SI units for every orientation near ``low`` ... ``high`` (rad), enclosed."""
        x, y = units.metres(self.x_um), units.metres(self.y_um)
        degrees = Fraction(repr(self.theta_deg))
        first = math.floor((units.to_deg(low) - self.theta_deg) / 360.0)
        last = math.ceil((units.to_deg(high) - self.theta_deg) / 360.0)
        for turns in range(first, last + 1):
            theta = Interval.exactly((degrees + 360 * turns) / 90) * HALF_PI
            yield PoseBox(x=x, y=y, theta=theta)


def parse(line: str) -> Sensed:
    """Read a line ``{"x_um": ..., "y_um": ..., "theta_deg": ...}``.

    Parameters
    ----------
    line
        As the laboratory sent it.

    Returns
    -------
    Sensed
        The pose, number for number.

    Raises
    ------
    PoseError
        The line is anything else.
    """
    if not line.strip():
        raise PoseError(f"a blank line is not a pose; send {_example()}")
    try:
        value = json.loads(line, object_pairs_hook=each_once)
    except (ValueError, RecursionError) as error:
        raise PoseError(f"not a JSON object ({error}); send {_example()}") from error
    if not isinstance(value, dict):
        raise PoseError(f"a JSON object is needed, got {type(value).__name__}; send {_example()}")
    for key in value:
        if key not in KEYS:
            raise PoseError(f"key {key} is unknown; {like(key, KEYS)}send {_example()}")
    for key in KEYS:
        if key not in value:
            raise PoseError(f"key {key} is missing; send {_example()}")
    return Sensed(**{key: _number(key, value[key]) for key in KEYS})


def _number(key: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise PoseError(f"key {key} = {value!r}: must be a number")
    if not abs(value) <= LARGEST:
        raise PoseError(f"key {key} = {value!r}: must be finite and within {LARGEST:g}")
    return float(value)


def _example() -> str:
    return '{"x_um": 0.0, "y_um": 0.0, "theta_deg": 0.0}'


def beyond(sensed: Iterable[PoseBox], boxes: Sequence[PoseBox]) -> str:
    """By how much a pose misses the nearest of the boxes, side by side, in um and deg."""
    low, high = ends_of(boxes)
    scale = np.array([units.UM, units.UM, units.DEG])
    found: tuple[float, Floats, Floats] | None = None
    for pose in sensed:
        at = np.array(pose.mid)
        by = (np.maximum(at - high, 0.0) + np.minimum(at - low, 0.0)) / scale
        far = (np.abs(by) * WEIGHTS).sum(axis=1)
        nearest = int(far.argmin())
        if found is None or far[nearest] < found[0]:
            found = float(far[nearest]), by[nearest], at / scale
    if found is None or not found[1].any():
        return "it lies on the very bound"
    return ", ".join(
        f"{name} = {value:.6g} is {abs(by):.6g} {name.rsplit('_', 1)[1]} "
        f"{'above' if by > 0 else 'below'} the bound {value - by:.6g}"
        for name, by, value in zip(KEYS, found[1], found[2], strict=True)
        if by
    )
