"""Things drawn ahead in their own frame, finer than the image, to be stamped at any pose."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from meso_robust.microscope.looks import Metal, Oil, Part, Probe
from meso_robust.microscope.outline import rounded_distance
from meso_robust.microscope.texture import marks, rolled
from meso_robust.types import Floats, Singles

Texels = Singles

COVERAGE, RADIANCE, SHADE, RELIEF_X, RELIEF_Y = range(5)
DISTANCE = 3  # of a smooth texel, which has no relief
HALVED = 2.0  # texels of the drawing for each of the smooth one
_TRANSPARENT = 1e-3  # share of a blurred shaft that is left out, less than a grey level
HALO_REACH = 6.0  # halo widths after which the halo has ended


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """A drawing in a body frame.

    Attributes
    ----------
    texels
        (h, w, 5) float32, rows along +y: share of metal; its brightness times that share; relative
        change of what lies beneath; by how much light from body direction x, and y, brightens it.
    smooth
        (h/2, w/2, 4) float32: the first three, averaged over about a pixel, which are enough, in one
        sample, away from edges; and the distance to the edge in m, negative inside.
    origin
        (x, y) of texel [0, 0] in m, body frame.
    pitch
        Distance of texels in m.
    band
        Width in m of the rim, which one sample a pixel does not do justice to.
    """

    texels: Texels
    smooth: Texels
    origin: tuple[float, float]
    pitch: float
    band: float


def grid(low: Floats, high: Floats, pitch: float) -> tuple[Floats, Floats]:
    """Row of x (1, w) and column of y (h, 1) that cover a box."""
    count = np.ceil((high - low) / pitch).astype(int) + 2
    x, y = (low[k] + pitch * np.arange(count[k]) for k in (0, 1))
    return x[None, :], y[:, None]


def part_layer(part: Part, oil: Oil, pitch: float) -> Layer:
    """The part with its halo, ``pitch`` in m."""
    margin = HALO_REACH * oil.halo_width + 4.0 * pitch
    low, high = part.outline.min(axis=0) - margin, part.outline.max(axis=0) + margin
    x, y = grid(low, high, pitch)
    distance = rounded_distance(part.outline, part.metal.corner_radius, x, y)
    return plate_layer(distance, (float(low[0]), float(low[1])), pitch, part.metal, oil)


def plate_layer(
    distance: Floats, origin: tuple[float, float], pitch: float, metal: Metal, oil: Oil
) -> Layer:
    """Sheet metal where a distance (h, w) in m is negative."""
    texels = np.zeros((*distance.shape, 5), dtype=np.float32)
    # A ramp one texel wide stands for the step: sampled no coarser than that, its mean is the share
    # of the pixel that the metal covers.
    cover = np.clip(0.5 - distance / pitch, 0.0, 1.0)
    slope = _bevel_slope(distance, metal.bevel)
    surface = 1.0 + metal.texture * rolled(distance.shape, pitch, metal.seed)
    surface += marks(distance.shape, pitch, metal.scratches, metal.specks, metal.seed)
    brightness = metal.brightness * np.maximum(surface, 0.0)
    brightness *= 1.0 + (metal.bevel_brightness - 1.0) * slope
    relief = metal.brightness * metal.bevel_relief * slope * cover
    normal_y, normal_x = np.gradient(distance, pitch)
    texels[..., COVERAGE] = cover
    texels[..., RADIANCE] = brightness * cover
    texels[..., SHADE] = halo(distance, oil)
    texels[..., RELIEF_X], texels[..., RELIEF_Y] = relief * normal_x, relief * normal_y
    return _layer(texels, distance, origin, pitch, band=metal.bevel)


def _layer(
    texels: Texels, distance: Floats, origin: tuple[float, float], pitch: float, band: float
) -> Layer:
    mean = cv2.blur(np.dstack([texels[..., :DISTANCE], distance.astype(np.float32)]), (3, 3))
    step = int(HALVED)
    # one row and column more than the texels need, to interpolate up to their last
    mean = cv2.copyMakeBorder(mean, 0, 2 * step, 0, 2 * step, cv2.BORDER_REPLICATE)
    return Layer(texels, np.ascontiguousarray(mean[::step, ::step]), origin, pitch, band)


def _bevel_slope(distance: Floats, width: float) -> Floats:
    """Steepness of the rim: 1 at the edge, falling smoothly to 0 at ``width`` inside."""
    if width == 0.0:
        return np.zeros_like(distance)
    depth = np.clip(-distance / width, 0.0, 1.0)
    return np.asarray(np.cos(0.5 * math.pi * depth))


def halo(distance: Floats, oil: Oil) -> Floats:
    """Relative change of the background by the meniscus at a distance in m outside an edge."""
    if oil.halo_width == 0.0:
        return np.zeros_like(distance)
    away = np.maximum(distance, 0.0) / oil.halo_width
    dark = -oil.halo * np.exp(-away)
    bright = oil.ring * np.exp(-(((away - 2.0) / 0.8) ** 2))
    # faded out, so that it ends where the layer does
    fade = np.clip(HALO_REACH - away, 0.0, 1.0)
    return np.asarray((dark + bright) * fade)


def probe_layer(probe: Probe, oil: Oil, pitch: float, length: float) -> Layer:
    """The probe in a frame at the centre of its tip, shaft along +x, drawn over a ``length`` in m."""
    widest = min(probe.defocus * length, 0.5 * probe.shaft_radius)
    margin = max(HALO_REACH * oil.halo_width, 3.0 * widest) + 4.0 * pitch
    across = _half_width(probe, np.float64(length)) + margin
    low = np.array([-probe.tip_radius - margin, -across])
    x, y = grid(low, np.array([length, across]), pitch)
    distance = needle_distance(probe, x, y)
    shaft = np.maximum(x, 0.0)
    sigma = np.minimum(probe.defocus * shaft, 0.5 * probe.shaft_radius)
    cover = _smooth_step(-distance / np.maximum(sigma, 0.4 * pitch))
    texels = np.zeros((*distance.shape, 5), dtype=np.float32)
    cover[cover < _TRANSPARENT] = 0.0
    texels[..., COVERAGE] = cover
    texels[..., RADIANCE] = cover * _needle_brightness(probe, sigma, shaft, y)
    # the oil climbs the needle at its tip only
    wet = np.exp(-((shaft / (8.0 * probe.tip_radius)) ** 2))
    texels[..., SHADE] = halo(distance, oil) * np.where(wet > _TRANSPARENT, wet, 0.0)
    return _layer(texels, distance, (float(low[0]), float(low[1])), pitch, band=0.0)


def needle_distance(probe: Probe, x: Floats, y: Floats) -> Floats:
    """Signed distance in m to a round tip about the origin with a tapering shaft along +x."""
    c, s = math.cos(probe.half_angle), math.sin(probe.half_angle)
    side = np.abs(y)
    flank = c * side - s * x - probe.tip_radius
    tip = np.hypot(x, side) - probe.tip_radius
    cone = np.where(c * x + s * side < 0.0, tip, flank)
    return np.asarray(np.where(x > 0.0, np.maximum(cone, side - probe.shaft_radius), cone))


def _half_width(probe: Probe, x: Floats | np.float64) -> Floats:
    """Half of the width in m at a length along the shaft."""
    wide = probe.tip_radius / math.cos(probe.half_angle) + x * math.tan(probe.half_angle)
    return np.asarray(np.minimum(wide, max(probe.shaft_radius, probe.tip_radius)))


def _needle_brightness(probe: Probe, sigma: Floats, x: Floats, y: Floats) -> Floats:
    """A cylinder lit from above: a bright line along the middle, blurred with the shaft."""
    half = _half_width(probe, x)
    width = np.hypot(0.3 * half, sigma)
    line = np.exp(-0.5 * ((y - 0.15 * half) / width) ** 2) * 0.3 * half / width
    return np.asarray(probe.brightness + (probe.highlight - probe.brightness) * line)


def _smooth_step(z: Floats) -> Floats:
    """Normal distribution function, to 2e-4 (logistic form of Page 1977), odd about 1/2."""
    return np.asarray(0.5 + 0.5 * np.tanh(0.7988 * z * (1.0 + 0.04417 * z * z)))
