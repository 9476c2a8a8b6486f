"""How little a tip can be off along its needle at least, by the bound of Cramer and Rao.

From the renderer's own images, a needle before film without a part: how they vary with the tip, and with
what else is not known, against the sensor's noise. The tracker is not asked.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from meso_robust.microscope import Probe, Scene, project
from meso_robust.microscope.frame import irradiance
from meso_robust.microscope.layer import COVERAGE, RADIANCE, Layer, needle_distance, probe_layer
from meso_robust.microscope.optics import Optics
from meso_robust.microscope.sensor import blurred, light_field
from meso_robust.microscope.stamp import PixelMap, stamp

Floats = npt.NDArray[np.float64]

AROUND = 24.0
"""px about a tip that count."""
_RINGS = np.array([0.0, 1.2, 2.7, 4.6, 7.0, 10.1])  # px from the needle; knots of any meniscus
_UP = np.array([0.0, 9.0, 18.0])  # px up the shaft; knots by which it changes
_KNOTS = np.linspace(-1.0, 1.0, 7)  # of half widths across; of any brightness
_ANY = 0.5  # over the film's brightness: how far each of these may be off, before the image is seen
_FINE = 4.0  # samples a px
_BORDER = 16  # px around what counts


def least_along(scene: Scene, tip: Floats) -> float:
    """Standard deviation in px along its axis below which no unbiased estimate of a tip (2,) m from one frame gets.

    The needle's look and shape, the blur and the film's texture count as known, and nothing as compressed; the
    film's brightness and its slopes are free.
    """
    own = _own(scene, tip)
    return float(math.sqrt(np.linalg.inv(own @ own.T)[0, 0]))


def least_alike(scene: Scene, tip: Floats, frames: int) -> float:
    """The same of what all tips of a film of some frames are off by, if the needle's look is not known.

    Its taper, defocus and direction and the blur are free, its brightness across and how that changes along it, and
    the meniscus as a function of the distance and of the place along the shaft; of these only that they are no
    more than about `_ANY` of the film's brightness. Where a tip touches a part, a film tells less than this.
    """
    middle = (float(tip[0]), float(tip[1]))  # a camera that shows the tip alone is drawn sooner
    around = int(2.0 * AROUND) + 2 * _BORDER
    optics = replace(scene.optics, width=around, height=around, centre=middle)
    scene = replace(scene, part=None, optics=optics)
    own, look = _own(scene, tip), _look(scene, tip)
    within, crossed = own @ own.T, own @ look.T
    sure = np.append(np.zeros(4), np.full(len(look) - 4, _ANY**-2))
    solved = np.linalg.inv(within)
    left = frames * (look @ look.T - crossed.T @ solved @ crossed) + np.diag(sure)
    led = (solved @ crossed)[0]
    return float(math.sqrt(led @ np.linalg.inv(left) @ led + solved[0, 0] / frames))


def _near(optics: Optics, tip: Floats) -> tuple[npt.NDArray[np.bool_], Floats]:
    """(h, w) the pixels that count, and (2, N) their places from the tip."""
    at = project(optics, tip)
    v, u = np.indices((optics.height, optics.width))
    near = np.hypot(u - at[0], v - at[1]) < AROUND
    return near, np.array([u[near] - at[0], v[near] - at[1]])


def _seen(scene: Scene, tip: Floats) -> Floats:
    near, _ = _near(scene.optics, tip)
    return np.asarray(irradiance(scene, np.full(3, np.nan), tip[None])[near], dtype=float)


def _noise(scene: Scene, tip: Floats) -> Floats:
    exposure = scene.exposure
    return np.sqrt(exposure.shot_noise * _seen(scene, tip) + exposure.read_noise**2 + 1.0 / 12.0)


def _own(scene: Scene, tip: Floats) -> Floats:
    """(5, N) slopes over the noise: along and across the needle, of the film's brightness and its two slopes."""
    near, place = _near(scene.optics, tip)
    way = np.array([math.cos(scene.probes[0].direction), math.sin(scene.probes[0].direction)])

    def at(shift: Floats) -> Floats:
        image = irradiance(scene, np.full(3, np.nan), (tip + shift)[None])[near]
        return np.asarray(image, dtype=float)

    brighter = replace(scene, oil=replace(scene.oil, brightness=1.1 * scene.oil.brightness))
    film = _seen(brighter, tip) - _seen(scene, tip)
    step = 0.2 * scene.optics.pixel_size * np.array([way, [-way[1], way[0]]])
    moved = [(at(s) - at(-s)) / 0.4 for s in step]
    return np.array([*moved, film, *(film * place)]) / _noise(scene, tip)


def _look(scene: Scene, tip: Floats) -> Floats:
    """(4 + K, N) slopes over the noise: of taper, defocus, direction and blur, then of what is bright."""
    probe, optics = scene.probes[0], scene.optics

    def by(step: float, **changes: float) -> Floats:
        ends = []
        for sign in (-step, step):
            new = {name: value + sign for name, value in changes.items()}
            ends.append(_seen(replace(scene, probes=(replace(probe, **new),)), tip))
        return (ends[1] - ends[0]) / (2.0 * step)

    softer = [
        _seen(replace(scene, optics=replace(optics, blur=optics.blur + s)), tip)
        for s in (-0.05, 0.05)
    ]
    shape = [
        by(0.01, half_angle=probe.half_angle),
        by(0.005, defocus=probe.defocus),
        by(0.01, direction=probe.direction),
        (softer[1] - softer[0]) / 0.1,
    ]
    return np.array([*shape, *_bright(scene, tip)]) / _noise(scene, tip)


def _bright(scene: Scene, tip: Floats) -> list[Floats]:
    """Images (N,) of what may be brighter, each by the film's brightness."""
    probe, optics = scene.probes[0], scene.optics
    size, level = optics.pixel_size, scene.oil.brightness
    layer = probe_layer(replace(probe, direction=0.0), scene.oil, size / _FINE, 2.0 * AROUND * size)
    height, width = layer.texels.shape[:2]
    x: Floats = layer.origin[0] + layer.pitch * np.arange(width, dtype=np.float64)[None, :]
    y: Floats = layer.origin[1] + layer.pitch * np.arange(height, dtype=np.float64)[:, None]
    cover = layer.texels[..., COVERAGE].astype(float)
    away, up = np.maximum(needle_distance(probe, x, y), 0.0) / size, np.maximum(x, 0.0) / size
    across = np.clip(y / np.maximum(_half(probe, x), probe.tip_radius), -1.0, 1.0)
    rings = [
        (1.0 - cover) * _hat(away, _RINGS, k) * _hat(up, _UP, j) for k in range(6) for j in range(3)
    ]
    knots = [
        cover * _hat(across, _KNOTS, k) * along for k in range(7) for along in (1.0, up / AROUND)
    ]
    near, _ = _near(optics, tip)
    pixels, light = PixelMap(optics), light_field(optics, scene.exposure)
    images = []
    for one in (*rings, *knots):
        image = np.zeros(near.shape, np.float32)
        stamp(image, pixels, _adding(layer, level * one), np.array([*tip, probe.direction]), 0.0)
        images.append((blurred(image, optics.blur) * light)[near].astype(float))
    return images


def _half(probe: Probe, x: Floats) -> Floats:
    return probe.tip_radius / math.cos(probe.half_angle) + x * math.tan(probe.half_angle)


def _hat(at: Floats, knots: Floats, k: int) -> Floats:
    """1 at one of some knots, falling to 0 at its neighbours; the last keeps its value beyond."""
    return np.asarray(np.interp(at, knots, np.eye(len(knots))[k]))


def _adding(layer: Layer, brightness: Floats) -> Layer:
    """The layer that hides nothing and adds a brightness (h, w), sampled as finely as at an edge everywhere."""
    texels = np.zeros_like(layer.texels)
    texels[..., RADIANCE] = brightness
    return replace(layer, texels=texels, smooth=np.zeros_like(layer.smooth))
