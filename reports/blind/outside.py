"""Physics that the published catalogue does not have, which a diagnosis must call unknown."""

from __future__ import annotations

import numpy as np

from reports.blind.change import Change, Effect, direction, sign
from reports.blind.kernel import REFERENCE
from reports.blind.world import LENGTH, WIDTH

Rng = np.random.Generator


def constant_moment(size: float, rng: Rng) -> Change:
    """A vortex under the part spins it, by itself at about `size` deg/s."""
    rate = size * sign(rng)
    square = (LENGTH**2 + WIDTH**2) / 12.0
    return Change({"rate_deg_s": rate}, {"moment": float(np.radians(rate)) * square})


def stage_vibration(size: float, rng: Rng) -> Change:
    """The image shakes at 1 to 3 Hz along a line."""
    c, s = direction(rng)
    rate = float(rng.uniform(1.0, 3.0))
    camera = {"shake": (size * c, size * s), "shake_rate": 2.0 * np.pi * rate}
    return Change({"amplitude_um": size, "rate_hz": rate}, camera=camera)


def sticky_patch(size: float, rng: Rng) -> Change:
    """Dry friction where the part lies over a disc of the stage."""
    x, y = (float(v) for v in rng.uniform(-300.0, 300.0, 2))
    radius = float(rng.uniform(200.0, 500.0))
    laws = {"patch": REFERENCE * size, "patch_x": x, "patch_y": y, "patch_radius": radius}
    return Change({"ratio": size, "x_um": x, "y_um": y, "radius_um": radius}, laws)


def viscoelastic_film(size: float, rng: Rng) -> Change:
    """A fraction of the film's drag is that of a Maxwell fluid."""
    time = float(rng.uniform(0.2, 1.0))
    return Change({"fraction": size, "time_s": time}, {"memory": size, "memory_time": time})


def camera_aspect(size: float, rng: Rng) -> Change:
    """Pixels that are not square."""
    percent = size * sign(rng)
    camera = {"scale": (0.01 * percent, -0.01 * percent)}
    return Change({"percent": percent}, camera=camera)


def central_force(size: float, rng: Rng) -> Change:
    """Attraction to a point that falls with the distance; the size is that at 500 um."""
    x, y = (float(v) for v in rng.uniform(-500.0, 500.0, 2))
    laws = {"centre_pull": size, "pull_x": x, "pull_y": y}
    return Change({"pull_um_s": size, "x_um": x, "y_um": y}, laws)


def load_dependent_friction(size: float, rng: Rng) -> Change:
    """A friction coefficient that goes as a power of the load."""
    return Change({"exponent": -size}, {"load_exponent": -size})


def probe_runout(size: float, rng: Rng) -> Change:
    """The tip goes round in a circle while it travels."""
    rate, phase = float(rng.uniform(0.3, 1.5)), float(rng.uniform(0.0, 2.0 * np.pi))
    laws = {"runout": size, "runout_rate": 2.0 * np.pi * rate, "runout_phase": phase}
    return Change({"radius_um": size, "rate_hz": rate}, laws)


def tip_wear(size: float, rng: Rng) -> Change:
    """Friction of the tip that is lost during a recording."""
    time = float(rng.uniform(1.5, 4.0))
    return Change({"fraction": size, "time_s": time}, {"wear": size, "wear_time": time})


def quadratic_drag(size: float, rng: Rng) -> Change:
    """A drag that grows with the square of the speed, by the size at 75 um/s."""
    return Change({"fraction": size}, {"quadratic": size})


def keystone(size: float, rng: Rng) -> Change:
    """A camera that looks at the stage askew; the size is per mm."""
    c, s = direction(rng)
    camera = {"keystone": (1e-3 * size * c, 1e-3 * size * s)}
    return Change({"x_per_mm": size * c, "y_per_mm": size * s}, camera=camera)


def clock_jitter(size: float, rng: Rng) -> Change:
    """Frames whose times are wrong at random, by up to the size in ms: less than half a frame."""
    camera = {"jitter": 1e-3 * size, "jitter_seed": int(rng.integers(2**31))}
    return Change({"time_ms": size}, camera=camera)


def pixel_locking(size: float, rng: Rng) -> Change:
    """A tracker that pulls towards the middle of pixels, a periodic error of the place."""
    pitch = float(rng.uniform(40.0, 120.0))
    return Change(
        {"amplitude_um": size, "pitch_um": pitch}, camera={"locking": size, "pitch": pitch}
    )


_ALL = (
    Effect("constant_moment", "environment", constant_moment, 0.02, 5.0),
    Effect("stage_vibration", "observation", stage_vibration, 0.1, 20.0),
    Effect("sticky_patch", "support", sticky_patch, 0.05, 5.0),
    Effect("viscoelastic_film", "support", viscoelastic_film, 0.05, 0.9),
    Effect("camera_aspect", "observation", camera_aspect, 0.1, 15.0),
    Effect("central_force", "environment", central_force, 0.2, 30.0),
    Effect("load_dependent_friction", "contact", load_dependent_friction, 0.1, 0.9),
    Effect("probe_runout", "actuation", probe_runout, 0.2, 12.0),
    Effect("tip_wear", "contact", tip_wear, 0.1, 0.9),
    Effect("quadratic_drag", "support", quadratic_drag, 0.05, 5.0),
    Effect("keystone", "observation", keystone, 0.002, 0.1),
    Effect("clock_jitter", "observation", clock_jitter, 2.0, 16.0),
    Effect("pixel_locking", "observation", pixel_locking, 0.1, 10.0),
)

OUTSIDE = {effect.name: effect for effect in _ALL}
"""Kinds outside the catalogue."""
