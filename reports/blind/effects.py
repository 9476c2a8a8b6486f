"""The published catalogue of effects, each as the benchmark's own small law.

A law draws what its size leaves open, then says what it changes. Sizes and parameters are in the
units of the catalogue: forces over the film's drag in um/s, ratios over the drag at 75 um/s.
"""

from __future__ import annotations

import numpy as np

from reports.blind.change import Change, Effect, direction, sign
from reports.blind.kernel import REFERENCE
from reports.blind.world import LENGTH, WIDTH

Rng = np.random.Generator
DEG = np.pi / 180.0


def dry_friction(size: float, rng: Rng) -> Change:
    return Change({"ratio": size}, {"dry": REFERENCE * size})


def stribeck_friction(size: float, rng: Rng) -> Change:
    speed = float(rng.uniform(20.0, 70.0))
    laws = {"stribeck": REFERENCE * size, "stribeck_speed": speed}
    return Change({"ratio": size, "speed_um_s": speed}, laws)


def shear_thinning(size: float, rng: Rng) -> Change:
    return Change({"exponent_drop": size}, {"thinning": size})


def anisotropic_drag(size: float, rng: Rng) -> Change:
    angle = float(rng.uniform(-90.0, 90.0))
    laws = {"anisotropy": size, "anisotropy_angle": angle * DEG}
    return Change({"fraction": size, "direction_deg": angle}, laws)


def part_anisotropic_drag(size: float, rng: Rng) -> Change:
    angle = float(rng.uniform(-90.0, 90.0))
    laws = {"part_anisotropy": size, "part_anisotropy_angle": angle * DEG}
    return Change({"fraction": size, "direction_deg": angle}, laws)


def drag_centre_offset(size: float, rng: Rng) -> Change:
    c, s = direction(rng)
    x, y = size * c, size * s
    return Change({"x_um": x, "y_um": y}, {"centre_x": x, "centre_y": y})


def drag_gradient(size: float, rng: Rng) -> Change:
    c, s = direction(rng)
    laws = {"gradient_x": 1e-3 * size * c, "gradient_y": 1e-3 * size * s}
    return Change({"x_per_mm": size * c, "y_per_mm": size * s}, laws)


def drag_drift(size: float, rng: Rng) -> Change:
    rate = size * sign(rng)
    return Change({"rate_percent_s": rate}, {"growth": 0.01 * rate})


def breakaway_friction(size: float, rng: Rng) -> Change:
    distance = float(rng.uniform(2.0, 10.0))
    laws = {"ageing": REFERENCE * size, "ageing_distance": distance}
    return Change({"ratio": size, "distance_um": distance}, laws)


def uneven_support(size: float, rng: Rng) -> Change:
    # No pressure is negative while |6 x / L| + |6 y / W| < 1, on the smallest footprint too.
    share, total = rng.uniform(0.2, 0.8), rng.uniform(0.5, 0.8)
    x = float(sign(rng) * share * total * LENGTH / 6.0)
    y = float(sign(rng) * (1.0 - share) * total * WIDTH / 6.0)
    laws = {"uneven": REFERENCE * size, "uneven_x": x, "uneven_y": y}
    return Change({"ratio": size, "x_um": x, "y_um": y}, laws)


def body_force(size: float, rng: Rng) -> Change:
    c, s = direction(rng)
    x, y = size * c, size * s
    return Change({"x_um_s": x, "y_um_s": y}, {"force_x": x, "force_y": y})


def film_flow(size: float, rng: Rng) -> Change:
    c, s = direction(rng)
    x, y = size * c, size * s
    return Change({"x_um_s": x, "y_um_s": y}, {"flow_x": x, "flow_y": y})


def wall_capillarity(size: float, rng: Rng) -> Change:
    angle = float(rng.uniform(-180.0, 180.0))
    place, reach = float(rng.uniform(1200.0, 2000.0)), float(rng.uniform(300.0, 600.0))
    laws = {
        "wall": size,
        "wall_angle": angle * DEG,
        "wall_place": place,
        "wall_range": reach,
    }
    names = ("pull_um_s", "direction_deg", "position_um", "range_um")
    return Change(dict(zip(names, (size, angle, place, reach), strict=True)), laws)


def unmodelled_wall(size: float, rng: Rng) -> Change:
    """A post larger by the size than one that the pushes would only just not hit (see `posts`)."""
    x, y = (float(v) for v in rng.uniform(-400.0, 400.0, 2))
    laws = {"post_radius": POST + size, "post_x": x, "post_y": y}
    names = ("radius_um", "x_um", "y_um")
    return Change(dict(zip(names, laws.values(), strict=True)), laws)


POST = 60.0
"""Radius of the post that the paths of `posts` end at, um."""


def tip_adhesion(size: float, rng: Rng) -> Change:
    reach = float(rng.uniform(1.5, 6.0))
    laws = {"adhesion": size, "adhesion_range": reach}
    return Change({"pull_um_s": size, "range_um": reach}, laws)


def tip_attraction(size: float, rng: Rng) -> Change:
    reach = float(rng.uniform(3.0, 12.0))
    laws = {"attraction": size, "attraction_range": reach}
    return Change({"pull_um_s": size, "range_um": reach}, laws)


def edge_dependent_friction(size: float, rng: Rng) -> Change:
    # A coefficient cannot fall by more than itself: a fall is by a factor, as a rise is.
    edge, falls = int(rng.integers(4)), rng.random() < 0.7
    change = 1.0 / (1.0 + size) - 1.0 if falls else size
    return Change({"change": change, "edge": edge}, {"edge_change": change, "edge": edge})


def part_geometry(size: float, rng: Rng) -> Change:
    c, s = direction(rng)
    x, y = size * c, size * s
    return Change({"x_um": x, "y_um": y}, excess=(x, y))


def tip_radius(size: float, rng: Rng) -> Change:
    excess = size * sign(rng)
    return Change({"excess_um": excess}, {"tip_radius": 12.5 + excess})


def reference_offset(size: float, rng: Rng) -> Change:
    c, s = direction(rng)
    x, y = size * c, size * s
    return Change({"x_um": x, "y_um": y}, camera={"offset": (x, y)})


def probe_compliance(size: float, rng: Rng) -> Change:
    return Change({"time_ms": size}, {"compliance": 1e-3 * size})


def backlash(size: float, rng: Rng) -> Change:
    return Change({"width_um": size}, {"backlash": size})


def probe_drift(size: float, rng: Rng) -> Change:
    c, s = direction(rng)
    x, y = size * c, size * s
    return Change({"x_um_s": x, "y_um_s": y}, {"drift_x": x, "drift_y": y})


def camera_latency(size: float, rng: Rng) -> Change:
    return Change({"time_ms": size}, camera={"latency": 1e-3 * size})


def camera_scale(size: float, rng: Rng) -> Change:
    percent = size * sign(rng)
    return Change({"percent": percent}, camera={"scale": (0.01 * percent, 0.01 * percent)})


def camera_rotation(size: float, rng: Rng) -> Change:
    angle = size * sign(rng)
    return Change({"angle_deg": angle}, camera={"rotation": angle * DEG})


def camera_drift(size: float, rng: Rng) -> Change:
    c, s = direction(rng)
    x, y = size * c, size * s
    return Change({"x_um_s": x, "y_um_s": y}, camera={"drift": (x, y)})


def lens_distortion(size: float, rng: Rng) -> Change:
    k1 = size * sign(rng)
    return Change({"k1_per_mm2": k1}, camera={"radial": 1e-6 * k1})


_ALL = (
    Effect("dry_friction", "support", dry_friction, 0.02, 3.0),
    Effect("stribeck_friction", "support", stribeck_friction, 0.05, 5.0),
    Effect("shear_thinning", "support", shear_thinning, 0.05, 0.8),
    Effect("anisotropic_drag", "support", anisotropic_drag, 0.02, 0.8),
    Effect("part_anisotropic_drag", "support", part_anisotropic_drag, 0.05, 0.8),
    Effect("drag_centre_offset", "support", drag_centre_offset, 3.0, 250.0),
    Effect("drag_gradient", "support", drag_gradient, 0.02, 1.5),
    Effect("drag_drift", "support", drag_drift, 0.5, 30.0),
    Effect("breakaway_friction", "support", breakaway_friction, 0.3, 30.0),
    Effect("uneven_support", "support", uneven_support, 0.02, 3.0),
    Effect("body_force", "environment", body_force, 0.1, 15.0),
    Effect("film_flow", "environment", film_flow, 0.1, 15.0),
    Effect("wall_capillarity", "environment", wall_capillarity, 2.0, 300.0),
    Effect("unmodelled_wall", "environment", unmodelled_wall, 1.0, 60.0),
    Effect("tip_adhesion", "contact", tip_adhesion, 2.0, 300.0),
    Effect("tip_attraction", "contact", tip_attraction, 1.0, 300.0),
    Effect("edge_dependent_friction", "contact", edge_dependent_friction, 0.1, 2.0),
    Effect("part_geometry", "geometry", part_geometry, 0.5, 12.0),
    Effect("tip_radius", "geometry", tip_radius, 0.5, 10.0),
    Effect("reference_offset", "geometry", reference_offset, 2.0, 200.0),
    Effect("probe_compliance", "actuation", probe_compliance, 5.0, 500.0),
    Effect("backlash", "actuation", backlash, 0.5, 30.0),
    Effect("probe_drift", "actuation", probe_drift, 0.1, 5.0),
    Effect("camera_latency", "observation", camera_latency, 5.0, 300.0),
    Effect("camera_scale", "observation", camera_scale, 0.1, 15.0),
    Effect("camera_rotation", "observation", camera_rotation, 0.05, 10.0),
    Effect("camera_drift", "observation", camera_drift, 0.05, 10.0),
    Effect("lens_distortion", "observation", lens_distortion, 0.003, 0.1),
)

EFFECTS = {effect.name: effect for effect in _ALL}
"""The 28 effects of the published catalogue."""
