"""What is known of the noise of a recording set."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from meso_robust.recordings import RecordingSet
from meso_robust.recordings.noise import estimated_sensor

Source = Literal["stated", "estimated", "fitted", "unknown"]
"""From ``set.toml``, from still frames, from the residuals of the fit, or none of them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sigmas:
    """Standard deviations of a seen coordinate, and where they are from.

    Attributes
    ----------
    position, orientation
        In m and rad; None where unknown, to be estimated with the fit.
    position_source, orientation_source
        Where they are from.
    freedom
        Degrees of freedom of the estimate that is known least well; infinite if none is an estimate.
    """

    position: float | None
    orientation: float | None
    position_source: Source
    orientation_source: Source
    freedom: float = math.inf


def sigmas_of(recordings: RecordingSet) -> Sigmas:
    """The noise as stated, or else as still frames show it; a stated zero is taken as unknown."""
    found = estimated_sensor(recordings)
    position, orientation = found.info.position_sigma, found.info.orientation_sigma
    noise = found.noise
    counts = (
        (found.position_source, noise.x.freedom + noise.y.freedom),
        (found.orientation_source, noise.theta.freedom),
    )
    known = [count for source, count in counts if source == "estimated"]
    return Sigmas(
        position=position or None,
        orientation=orientation or None,
        position_source=found.position_source if position else "unknown",
        orientation_source=found.orientation_source if orientation else "unknown",
        freedom=min(known, default=math.inf),
    )
