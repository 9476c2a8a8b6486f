"""One frame of a scene."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from meso_robust.microscope.layer import Layer, grid, part_layer, plate_layer, probe_layer
from meso_robust.microscope.looks import Fixture, Oil, Probe, Scene
from meso_robust.microscope.optics import Optics
from meso_robust.microscope.outline import signed_distance
from meso_robust.microscope.sensor import (
    Exposure,
    Irradiance,
    blur_at,
    blurred,
    compressed,
    light_at,
    light_field,
    noisy,
    quantised,
)
from meso_robust.microscope.stamp import PixelMap, stamp
from meso_robust.microscope.texture import dust, smooth_noise
from meso_robust.types import Floats, Image

_FINE = 4.0  # texels a pixel of what moves
_COARSE = 2.0  # and of the fixture


@dataclass(frozen=True, slots=True, eq=False)
class _Ready:
    """What does not change from frame to frame."""

    pixels: PixelMap
    background: Irradiance
    light: Irradiance
    part: Layer | None
    probes: tuple[Layer, ...]


def render(
    scene: Scene, pose: Floats, tips: Floats, rng: np.random.Generator, time: float = 0.0
) -> Image:
    """The frame that the camera delivers.

    Parameters
    ----------
    scene
        What is there; what does not move is drawn once a scene and kept.
    pose
        (3,) x, y in m and θ in rad of the part; NaN: the part is not there.
    tips
        (P, 2) tip centres in m, one for each probe of the scene; NaN: the probe is away.
    rng
        Of the noise.
    time
        s; drifts, flicker and steps of light and focus follow it.

    Returns
    -------
    :
        (height, width) uint8.

    Raises
    ------
    ValueError
        If the shapes do not fit the scene.
    """
    image = exposed(scene, pose, tips, rng, time)
    quality = scene.exposure.jpeg_quality
    return image if quality is None else compressed(image, quality)


def exposed(
    scene: Scene, pose: Floats, tips: Floats, rng: np.random.Generator, time: float = 0.0
) -> Image:
    """The frame before compression; arguments as of `render`."""
    grey = irradiance(scene, pose, tips, time)
    return quantised(noisy(grey, scene.exposure, rng))


def irradiance(scene: Scene, pose: Floats, tips: Floats, time: float = 0.0) -> Irradiance:
    """(height, width) float32 grey levels without noise; arguments as of `render`."""
    pose, tips = np.asarray(pose, dtype=float), np.asarray(tips, dtype=float).reshape(-1, 2)
    if pose.shape != (3,) or len(tips) != len(scene.probes):
        raise ValueError(
            f"pose {pose.shape}, tips {tips.shape}; must be (3,) and ({len(scene.probes)}, 2), a "
            "tip for each probe of the scene"
        )
    ready = _ready(scene)
    lamp = scene.exposure.lamp_azimuth
    image = ready.background.copy()
    if ready.part is not None and np.isfinite(pose).all():
        stamp(image, ready.pixels, ready.part, pose, lamp)
    for probe, layer, tip in zip(scene.probes, ready.probes, tips, strict=True):
        if np.isfinite(tip).all():
            stamp(image, ready.pixels, layer, np.array([*tip, probe.direction]), lamp)
    image = blurred(image, blur_at(scene.optics, scene.exposure, time))
    image *= ready.light
    image *= np.float32(light_at(scene.exposure, time))
    return image


@lru_cache(maxsize=3)
def _ready(scene: Scene) -> _Ready:
    optics, pixels = scene.optics, _pixels(scene.optics)
    pitch = optics.pixel_size / _FINE
    # a tip in the image and a shaft across all of it, whatever the distortion
    length = 2.4 * optics.half_diagonal * optics.pixel_size
    return _Ready(
        pixels,
        _background(scene.oil, scene.fixture, scene.exposure, scene.optics),
        light_field(optics, scene.exposure),
        None if scene.part is None else part_layer(scene.part, scene.oil, pitch),
        tuple(
            _probe(dataclasses.replace(probe, direction=0.0), scene.oil, pitch, length)
            for probe in scene.probes
        ),
    )


@lru_cache(maxsize=4)
def _probe(probe: Probe, oil: Oil, pitch: float, length: float) -> Layer:
    """The same for all probes that differ in their direction alone, and for scene after scene."""
    return probe_layer(probe, oil, pitch, length)


@lru_cache(maxsize=3)
def _pixels(optics: Optics) -> PixelMap:
    return PixelMap(optics)


@lru_cache(maxsize=3)
def _background(
    oil: Oil, fixture: Fixture | None, exposure: Exposure, optics: Optics
) -> Irradiance:
    """(height, width) brightness of everything that stays, sharp."""
    pixels = _pixels(optics)
    shape, size = pixels.world.shape[:2], pixels.optics.pixel_size
    length = oil.texture_length / size
    shading = 1.0 + oil.texture * smooth_noise(shape, (length, length), oil.seed)
    shading += oil.grain * smooth_noise(shape, (0.7, 0.7), oil.seed + 1)
    image: Irradiance = (oil.brightness * shading).astype(np.float32)
    if fixture is not None:
        stamp(
            image, pixels, _fixture_layer(fixture, oil, pixels), np.zeros(3), exposure.lamp_azimuth
        )
    image *= 1.0 + dust(shape, size, oil.dust, oil.seed)
    return image


def _fixture_layer(fixture: Fixture, oil: Oil, pixels: PixelMap) -> Layer:
    pitch = pixels.optics.pixel_size / _COARSE
    seen = pixels.world[..., :2].reshape(-1, 2)
    low, high = seen.min(axis=0) - 10.0 * pitch, seen.max(axis=0) + 10.0 * pitch
    x, y = grid(low, high, pitch)
    distance = signed_distance(fixture.rings, x, y)
    return plate_layer(distance, (float(low[0]), float(low[1])), pitch, fixture.metal, oil)
