"""Families of effects, each with a law of a form that the catalogue does not list."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from reports.blind3.generate import LENGTH, WIDTH, Change, Floats, Instant, turn

Rng = np.random.Generator
Make = Callable[[float, Rng], Change]


@dataclass(frozen=True, slots=True)
class Family:
    """A family of effects, or something outside the catalogue."""

    stage: str
    make: Make
    guess: float
    """Size to begin the measurement of the just-detectable one with."""
    most: float
    """Largest size that makes sense."""
    form: str
    """The law in words."""
    alike: tuple[str, ...] = ()
    """Names of the catalogue that are right as well, because no motion tells them apart."""


def _speeds(now: Instant) -> Floats:
    return np.asarray(np.hypot(now.slips[:, 0], now.slips[:, 1]))


def _sign(rng: Rng) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _way(rng: Rng) -> Floats:
    angle = rng.uniform(0.0, 2.0 * np.pi)
    return np.array([np.cos(angle), np.sin(angle)])


def rim_friction(size: float, rng: Rng) -> Change:
    """Dry friction whose pressure grows from the middle to the rim."""
    power = rng.uniform(1.0, 2.0)

    def drag(now: Instant) -> Floats:
        pressure = np.hypot(*(now.own / [LENGTH, WIDTH]).T) ** power
        return np.asarray(75.0 * size * pressure / pressure.mean())

    return Change(drag=drag)


def slow_friction(size: float, rng: Rng) -> Change:
    """Dry friction that falls as 1 / (1 + (u / v)²)."""
    decay = rng.uniform(15.0, 60.0)
    return Change(drag=lambda now: 75.0 * size / (1.0 + (_speeds(now) / decay) ** 2))


def cross_film(size: float, rng: Rng) -> Change:
    """A Cross fluid on top of the plain one: more drag, lost above a speed."""
    turnover = rng.uniform(20.0, 80.0)

    def drag(now: Instant) -> Floats:
        u = _speeds(now)
        return np.asarray(size * u / (1.0 + u / turnover))

    return Change(drag=drag)


def _directed(size: float, rng: Rng, own: bool) -> Change:
    angle = rng.uniform(0.0, np.pi)

    def drag(now: Instant) -> Floats:
        heading = angle + (now.pose[2] if own else 0.0)
        along = now.slips @ np.array([np.cos(heading), np.sin(heading)])
        return np.asarray(2.0 * size * along**2 / np.maximum(_speeds(now), 1e-9))

    return Change(drag=drag)


def stage_lay(size: float, rng: Rng) -> Change:
    """More drag along a direction of the stage, always against the slip."""
    return _directed(size, rng, own=False)


def part_lay(size: float, rng: Rng) -> Change:
    """More drag along a direction of the part, always against the slip."""
    return _directed(size, rng, own=True)


def thick_end(size: float, rng: Rng) -> Change:
    """A film with a step: more drag beyond a line across the part."""
    way, edge = _way(rng), rng.uniform(-100.0, 100.0)
    return Change(drag=lambda now: size * _speeds(now) * (now.own @ way > edge))


def stage_step(size: float, rng: Rng) -> Change:
    """Drag that rises over the stage as a smooth step, not exponentially or linearly."""
    way, width = _way(rng), rng.uniform(300.0, 900.0)
    return Change(drag=lambda now: size * _speeds(now) * (1.0 + np.tanh(now.places @ way / width)))


def power_ageing(size: float, rng: Rng) -> Change:
    """Dry friction that grows as the cube root of the age of the contact."""
    distance = rng.uniform(5.0, 20.0)
    store = {"age": 0.0, "time": 0.0}

    def drag(now: Instant) -> Floats:
        step = now.time - store["time"]
        if step < 0.0:
            store["age"] = step = 0.0
        rate = float(np.mean(_speeds(now))) / distance
        store["age"] = (store["age"] + step) / (1.0 + rate * step)
        store["time"] = now.time
        return np.full(len(now.own), 75.0 * size * np.cbrt(store["age"]))

    return Change(drag=drag)


def two_patches(size: float, rng: Rng) -> Change:
    """Dry friction on one corner of the part only."""
    x, y = _sign(rng), _sign(rng)

    def drag(now: Instant) -> Floats:
        patch = (x * now.own[:, 0] > 0.1 * LENGTH) & (y * now.own[:, 1] > 0.1 * WIDTH)
        return np.asarray(75.0 * size * patch / patch.mean())

    return Change(drag=drag)


def bowl(size: float, rng: Rng) -> Change:
    """A stage whose tilt grows along it."""
    way, slope = _way(rng), rng.uniform(0.2, 0.5)
    return Change(force=lambda now: size * way * (1.0 + slope * float(now.pose[:2] @ way) / 500.0))


def meniscus(size: float, rng: Rng) -> Change:
    """A pull to a wall that falls as a Gaussian of the gap."""
    way, reach = _way(rng), rng.uniform(400.0, 900.0)

    def force(now: Instant) -> Floats:
        gap = max(700.0 - float(now.pose[:2] @ way), 0.0)
        return np.asarray(size * way * np.exp(-((gap / reach) ** 2)))

    return Change(force=force)


def parabolic_bridge(size: float, rng: Rng) -> Change:
    """Adhesion that falls as (1 - gap / r)²."""
    reach = rng.uniform(8.0, 20.0)
    return Change(adhesion=lambda gap: size * max(1.0 - gap / reach, 0.0) ** 2)


def square_attraction(size: float, rng: Rng) -> Change:
    """Attraction that falls as 1 / (1 + (gap / r)²)."""
    reach = rng.uniform(5.0, 20.0)
    return Change(attraction=lambda gap: size / (1.0 + (gap / reach) ** 2))


def half_edge(size: float, rng: Rng) -> Change:
    """Another friction on half of one edge, not the whole."""
    axis, side, half = int(rng.integers(2)), _sign(rng), _sign(rng)
    extent = 0.5 * np.array([LENGTH, WIDTH])
    change = size * _sign(rng)

    def friction(now: Instant) -> float:
        there = side * now.at[axis] > extent[axis] and half * now.at[1 - axis] > 0.0
        return 1.0 + change * there

    return Change(friction=friction)


def one_edge_out(size: float, rng: Rng) -> Change:
    """One edge stands out, its opposite does not."""
    axis, side, out = int(rng.integers(2)), _sign(rng), size * _sign(rng)

    def corners(stated: Floats) -> Floats:
        moved = stated.copy()
        moved[side * stated[:, axis] > 0.0, axis] += side * out
        return moved

    return Change(corners=corners, truth={f"part_geometry.{'xy'[axis]}_um": 0.5 * out})


def flat_beam(size: float, rng: Rng) -> Change:
    """A probe that bends in one direction only."""
    angle = rng.uniform(0.0, np.pi)
    return Change(give=lambda heading: 1e-3 * size * float(np.cos(heading - angle)) ** 2)


def round_play(size: float, rng: Rng) -> Change:
    """Lost motion within a circle, not a square."""

    def drive(_: Floats, way: Floats) -> Floats:
        true = way.copy()
        for k in range(1, len(way)):
            back = true[k - 1] - way[k]
            far = np.hypot(*back)
            true[k] = way[k] + back * min(1.0, 0.5 * size / max(far, 1e-12))
        return true

    return Change(drive=drive, truth={"backlash.width_um": size})


def settling_probe(size: float, rng: Rng) -> Change:
    """A mount that creeps to a new place exponentially."""
    way, time = _way(rng), rng.uniform(2.0, 5.0)
    return Change(drive=lambda t, tips: tips + np.outer(size * -np.expm1(-t / time), way))


def long_exposure(size: float, rng: Rng) -> Change:
    """Frames that are averages over an exposure which ends at the stamp; the delay is its half."""

    def see(times: Floats, poses: Floats) -> Floats:
        shares = np.linspace(0.0, 2e-3 * size, 9)
        later = [np.interp(times - s, times, column) for s in shares for column in poses.T]
        return np.asarray(np.reshape(later, (9, 3, -1)).mean(axis=0).T)

    return Change(see=see, truth={"camera_latency.time_ms": size})


def _about(centre: Floats, matrix: Floats, poses: Floats, angle: float = 0.0) -> Floats:
    seen = poses.copy()
    seen[:, :2] = (poses[:, :2] - centre) @ matrix.T + centre
    seen[:, 2] += angle
    return seen


def image_scale(size: float, rng: Rng) -> Change:
    """A scale about the middle of an image, not about the origin of the stage."""
    centre, scale = rng.uniform(-600.0, 600.0, 2), 0.01 * size * _sign(rng)
    return Change(
        see=lambda _, poses: _about(centre, (1.0 + scale) * np.eye(2), poses),
        truth={"camera_scale.percent": 100.0 * scale},
    )


def image_turn(size: float, rng: Rng) -> Change:
    """A turn about the middle of an image, not about the origin of the stage."""
    centre, angle = rng.uniform(-600.0, 600.0, 2), np.radians(size) * _sign(rng)
    return Change(
        see=lambda _, poses: _about(centre, turn(angle), poses, angle),
        truth={"camera_rotation.angle_deg": float(np.degrees(angle))},
    )


def settling_camera(size: float, rng: Rng) -> Change:
    """A camera that creeps to a new place exponentially."""
    way, time = _way(rng), rng.uniform(2.0, 5.0)

    def see(times: Floats, poses: Floats) -> Floats:
        seen = poses.copy()
        seen[:, :2] += np.outer(size * -np.expm1(-times / time), way)
        return seen

    return Change(see=see)


def quartic_lens(size: float, rng: Rng) -> Change:
    """A lens whose distortion goes as the fourth power of the radius."""
    scale = size * _sign(rng)

    def see(_: Floats, poses: Floats) -> Floats:
        seen = poses.copy()
        square = 1e-6 * np.sum(poses[:, :2] ** 2, axis=1)
        seen[:, :2] *= 1.0 + scale * square[:, None] ** 2
        return seen

    return Change(see=see)


FAMILIES: Mapping[str, Family] = {
    "dry_friction": Family("support", rim_friction, 0.1, 2.0, "pressure at the rim"),
    "stribeck_friction": Family("support", slow_friction, 0.1, 2.0, "falls as 1/(1 + (u/v)²)"),
    "shear_thinning": Family("support", cross_film, 0.2, 5.0, "Cross fluid with a plateau"),
    "anisotropic_drag": Family("support", stage_lay, 0.2, 3.0, "cos² of the slip's direction, no force across"),
    "part_anisotropic_drag": Family("support", part_lay, 0.2, 3.0, "the same, fixed in the part"),
    "drag_centre_offset": Family("support", thick_end, 0.05, 2.0, "a step of the drag across the part", ("uneven_support",)),
    "drag_gradient": Family("support", stage_step, 0.05, 2.0, "tanh of the place"),
    "breakaway_friction": Family("support", power_ageing, 0.1, 2.0, "cube root of the age"),
    "uneven_support": Family("support", two_patches, 0.01, 1.0, "one corner only"),
    "body_force": Family("environment", bowl, 0.3, 20.0, "grows along the stage", ("film_flow",)),
    "wall_capillarity": Family("environment", meniscus, 0.5, 40.0, "Gaussian of the gap"),
    "tip_adhesion": Family("contact", parabolic_bridge, 3.0, 60.0, "(1 − gap/r)²"),
    "tip_attraction": Family("contact", square_attraction, 3.0, 60.0, "1/(1 + (gap/r)²)"),
    "edge_dependent_friction": Family("contact", half_edge, 0.1, 0.85, "half of an edge"),
    "part_geometry": Family("geometry", one_edge_out, 2.0, 60.0, "one edge of two"),
    "probe_compliance": Family("actuation", flat_beam, 20.0, 600.0, "bends one way only"),
    "backlash": Family("actuation", round_play, 2.0, 60.0, "within a circle"),
    "probe_drift": Family("actuation", settling_probe, 2.0, 60.0, "exponential in time"),
    "camera_latency": Family("observation", long_exposure, 10.0, 300.0, "mean of an exposure"),
    "camera_scale": Family("observation", image_scale, 0.3, 8.0, "about the image's middle"),
    "camera_rotation": Family("observation", image_turn, 0.3, 12.0, "about the image's middle"),
    "camera_drift": Family("observation", settling_camera, 1.0, 60.0, "exponential in time"),
    "lens_distortion": Family("observation", quartic_lens, 0.02, 0.3, "fourth power of the radius"),
}  # fmt: skip
"""By the name of the family in the catalogue."""


def sticky_patch(size: float, rng: Rng) -> Change:
    """Dry friction where the part lies over a disc of the stage."""
    middle, radius = rng.uniform(-300.0, 300.0, 2), rng.uniform(200.0, 500.0)
    return Change(drag=lambda now: 75.0 * size * (np.hypot(*(now.places - middle).T) < radius))


def shake(size: float, rng: Rng) -> Change:
    """An image that shakes at 1 to 3 Hz."""
    way, rate = _way(rng), rng.uniform(1.0, 3.0)

    def see(times: Floats, poses: Floats) -> Floats:
        seen = poses.copy()
        seen[:, :2] += np.outer(size * np.sin(2.0 * np.pi * rate * times), way)
        return seen

    return Change(see=see)


def runout(size: float, rng: Rng) -> Change:
    """A tip that goes round in a circle."""
    rate = 2.0 * np.pi * rng.uniform(0.3, 1.5)
    return Change(
        drive=lambda t, tips: (
            tips + size * np.column_stack([np.cos(rate * t) - 1.0, np.sin(rate * t)])
        )
    )


def wearing_tip(size: float, rng: Rng) -> Change:
    """Friction of the tip that is lost during a recording."""
    time = rng.uniform(1.5, 4.0)
    return Change(friction=lambda now: 1.0 - size * -np.expm1(-now.time / time))


def central_pull(size: float, rng: Rng) -> Change:
    """Attraction to a point of the stage."""
    middle = rng.uniform(-500.0, 500.0, 2)

    def force(now: Instant) -> Floats:
        away = middle - now.pose[:2]
        return np.asarray(size * away * 500.0 / (np.hypot(*away) + 100.0) ** 2)

    return Change(force=force)


def pixel_locking(size: float, rng: Rng) -> Change:
    """A tracker that pulls towards the middle of pixels."""
    pitch = 2.0 * np.pi / rng.uniform(40.0, 120.0)

    def see(_: Floats, poses: Floats) -> Floats:
        seen = poses.copy()
        seen[:, :2] += size * np.sin(pitch * poses[:, :2])
        return seen

    return Change(see=see)


OUTSIDE: Mapping[str, Family] = {
    "sticky_patch": Family("support", sticky_patch, 0.1, 2.0, "dry over a disc of the stage"),
    "shake": Family("observation", shake, 0.3, 30.0, "the image shakes"),
    "runout": Family("actuation", runout, 1.0, 30.0, "the tip goes round"),
    "wearing_tip": Family("contact", wearing_tip, 0.1, 0.9, "friction is lost in time"),
    "central_pull": Family("environment", central_pull, 0.3, 20.0, "to a point of the stage"),
    "pixel_locking": Family("observation", pixel_locking, 0.3, 20.0, "periodic in the place"),
}
"""What the catalogue has not."""
