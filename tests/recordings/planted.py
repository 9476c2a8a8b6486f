"""A clean set made by hand, to plant one mistake in."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from meso_robust.recordings import Recording, RecordingSet, Rectangle, SensorInfo

Floats = npt.NDArray[np.float64]
UM = 1e-6
RATE = 30.0
FRAMES = 240
SIGMA = 1.2 * UM
TURN_SIGMA = np.radians(0.08)
PART = Rectangle(length=1600 * UM, width=800 * UM)
RADIUS = 12.5 * UM
TOUCH, BACK = 80, 180
"""Frames at which the tip arrives and turns back."""
STEP = 2.5 * UM
"""Way of the tip from frame to frame."""
FILES = ("push_00.csv", "push_01.csv", "push_02.csv")
MIDDLE = FILES[1]


def tip_way() -> Floats:
    """(T,) x of the tip about where it meets a part at the origin: rest, forth, back, rest."""
    frames = np.arange(FRAMES, dtype=np.float64)
    forth = np.clip(frames, 40, BACK) - TOUCH
    return np.asarray(forth - np.clip(frames - BACK, 0, 40)) * STEP


def one(
    file: str,
    seed: int = 0,
    noise: float = 1.0,
    start: tuple[float, float, float] = (2700 * UM, -30 * UM, np.pi / 2),
) -> Recording:
    """A part at 90 or 0 deg, pushed along x by a tip against the middle of a side."""
    rng = np.random.default_rng(seed)
    half = 0.5 * (PART.width if start[2] else PART.length)
    poses = np.tile(np.array(start), (FRAMES, 1))
    poses[:, 0] += np.maximum.accumulate(np.maximum(tip_way(), 0.0))
    poses += noise * rng.normal(size=poses.shape) * [SIGMA, SIGMA, TURN_SIGMA]
    probes = np.zeros((FRAMES, 1, 2))
    probes[:, 0, 0] = tip_way() + start[0] - half - RADIUS
    return Recording(
        file=file,
        probe_names=("probe1",),
        times=np.arange(FRAMES) / RATE,
        poses=poses,
        probes=probes,
    )


def clean(**changes: Any) -> RecordingSet:
    """Three such recordings."""
    given: dict[str, Any] = {
        "part": PART,
        "tip_radius": RADIUS,
        "position_source": "controller",
        "sensor": SensorInfo(
            frame_rate=RATE, position_sigma=SIGMA, orientation_sigma=float(TURN_SIGMA)
        ),
        "recordings": tuple(one(file, seed) for seed, file in enumerate(FILES)),
    }
    return RecordingSet(**{**given, **changes})


def planted(**arrays: Any) -> RecordingSet:
    """The clean set with arrays of the middle recording replaced."""
    made = clean()
    first, middle, last = made.recordings
    return replace(made, recordings=(first, replace(middle, **arrays), last))


def poses() -> Floats:
    """A copy of the middle recording's poses, to be changed."""
    return clean().recordings[1].poses.copy()


def probes() -> Floats:
    """A copy of its probes."""
    return clean().recordings[1].probes.copy()
