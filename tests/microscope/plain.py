"""Scenes without anything but edges, whose image is known exactly."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from meso_robust.microscope import Exposure, Metal, Oil, Optics, Part, Probe, Scene

Floats = npt.NDArray[np.float64]
PIXEL = 5e-6
FLAT = Metal(
    brightness=1.0,
    texture=0.0,
    scratches=0,
    specks=0,
    bevel=0.0,
    bevel_brightness=1.0,
    bevel_relief=0.0,
    corner_radius=0.0,
)
QUIET = Exposure(level=1.0, shot_noise=0.0, read_noise=0.0)
NO_TIPS = np.zeros((0, 2))


def still(brightness: float) -> Oil:
    """A background of one brightness."""
    return Oil(brightness=brightness, halo=0.0, ring=0.0, texture=0.0, grain=0.0, dust=0)


def small(**changes: float) -> Optics:
    """A camera of 96 x 80 px, perfectly sharp unless changed."""
    return Optics(**{"pixel_size": PIXEL, "width": 96, "height": 80, "blur": 0.0, **changes})  # type: ignore[arg-type]


def white_part(outline: Floats, **optics: float) -> Scene:
    """A white part before black: brightness is the share of a pixel that it covers."""
    part = Part(outline=outline, metal=FLAT)
    return Scene(part=part, oil=still(0.0), optics=small(**optics), exposure=QUIET)


def black_probe(probe: Probe) -> Scene:
    """A black probe before white."""
    return Scene(part=None, probes=(probe,), oil=still(1.0), optics=small(), exposure=QUIET)


def turned(points: Floats, pose: Floats) -> Floats:
    """World points of body points (V, 2) at a pose (3,)."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return np.stack(
        [
            pose[0] + c * points[:, 0] - s * points[:, 1],
            pose[1] + s * points[:, 0] + c * points[:, 1],
        ],
        axis=1,
    )
