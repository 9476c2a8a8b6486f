"""What is known of a video before its first frame."""

from __future__ import annotations

from dataclasses import dataclass

from meso_robust.tracking.calibration import Calibration
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Start:
    """A probe where it is in the first frame.

    Attributes
    ----------
    name
        As in the recording.
    tip
        (x, y) of its tip in m, world, right to about five pixels.
    """

    name: str
    tip: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scene:
    """What is known before the first frame.

    Attributes
    ----------
    outline
        (V, 2) corners of the part in m, body frame, counter-clockwise.
    tip_radius
        Of the probes, m.
    calibration
        Of the camera.
    pose
        (3,) x, y in m, θ in rad of the part in the first frame; parts may be NaN; None: unknown.
    probes
        Probes and where they start; None: whatever moves in from the border is a probe.
    """

    outline: Floats
    tip_radius: float
    calibration: Calibration
    pose: Floats | None = None
    probes: tuple[Start, ...] | None = None
