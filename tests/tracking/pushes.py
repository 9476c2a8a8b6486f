"""Rendered pushes, with their truth, for the tests of frames, probes and the whole tracker."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from meso_robust.microscope import Exposure, Oil, Optics, Part, Probe, Scene, film

Floats = npt.NDArray[np.float64]

HALF_LONG, HALF_SHORT, RADIUS = 808e-6, 418.5e-6, 12.5e-6
PART = np.array(
    [[-HALF_LONG, -HALF_SHORT], [HALF_LONG, -HALF_SHORT], [HALF_LONG, HALF_SHORT],
     [-HALF_LONG, HALF_SHORT]]
)  # fmt: skip
PIXEL = 5.26e-6


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Filmed:
    """A video and what is true in it: times (T,), poses (T, 3), tips (T, P, 2), SI, world."""

    path: Path
    optics: Optics
    times: Floats
    poses: Floats
    tips: Floats


def push(
    path: Path,
    frames: int,
    optics: Optics | None = None,
    gap: float = 120e-6,
    speed: float = 6e-6,
    seed: int = 0,
    sideways: float = 0.0,
) -> Filmed:
    """Film a needle that comes from above, meets the long side and pushes the part down and round.

    Parameters
    ----------
    path
        Of the video.
    frames
        How many.
    optics
        The camera.
    gap
        Free way before contact, m.
    speed
        Way a frame, m.
    seed
        Of the film's texture, its dust and the noise.
    sideways
        Way to the right a way down, of the needle and, from contact on, of the part.
    """
    optics = optics or Optics()
    scene = Scene(
        part=Part(outline=PART),
        probes=(Probe(tip_radius=RADIUS, direction=1.45, half_angle=0.09),),
        oil=Oil(seed=seed + 3),
        optics=optics,
        exposure=Exposure(jpeg_quality=92, vignetting=0.1, gradient=(0.04, 0.03)),
    )
    k = np.arange(frames)
    pushed = np.maximum(0.0, speed * k - gap)
    theta = -0.4 * pushed / HALF_LONG
    centre = np.array(optics.centre)
    tips = np.stack(
        [1e-4 + sideways * (speed * k - gap), HALF_SHORT + RADIUS + gap - speed * k], axis=1
    )
    # the tip rests against the side, which turns about the middle of the part
    place = np.stack([1e-5 + sideways * pushed, -pushed / np.cos(theta)], axis=1)
    away = (tips[:, 0] - place[:, 0]) * -np.sin(theta) + (tips[:, 1] - place[:, 1]) * np.cos(theta)
    place[:, 1] += np.where(pushed > 0.0, (away - HALF_SHORT - RADIUS) / np.cos(theta), 0.0)
    poses = np.concatenate([place + centre, theta[:, None]], axis=1)
    times = k / 30.0
    film(path, scene, times, poses, (tips + centre)[:, None], np.random.default_rng(seed))
    return Filmed(path=path, optics=optics, times=times, poses=poses, tips=(tips + centre)[:, None])


def rms(values: Floats) -> Floats:
    """Root mean square over the first axis."""
    return np.asarray(np.sqrt(np.mean(np.square(values), axis=0)))
