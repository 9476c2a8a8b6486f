"""Stamping a layer into an image, averaged over the area of each pixel."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.kernels import sealed
from meso_robust.microscope.layer import (
    COVERAGE,
    DISTANCE,
    HALVED,
    RADIANCE,
    RELIEF_X,
    RELIEF_Y,
    SHADE,
    Layer,
    Texels,
)
from meso_robust.microscope.optics import Optics, pixel_centres, unproject
from meso_robust.types import Floats

Irradiance = npt.NDArray[np.float32]
_EDGE = (
    5.0  # texels, at least half the diagonal of a pixel and the ramp of an edge, and a smooth texel
)


def lattice(count: int, step: int) -> Floats:
    """(count, 2) points of a Fibonacci lattice in a pixel, as offsets from its centre in px."""
    k = np.arange(count)
    return np.stack([(k + 0.5) / count, (k * step % count + 0.5) / count], axis=1) - 0.5


# A regular grid would meet edges along its rows or diagonals in few different places, and misplace
# them by up to 0.01 px.
AT_EDGES = lattice(34, 21)
"""(34, 2) samples of a pixel with an edge, about its centre in px."""
_IN_RIM = lattice(5, 3)  # sloping, but no sharp edge


class PixelMap:
    """World points of all pixels and how they change from pixel to pixel.

    Attributes
    ----------
    optics
        The camera.
    world
        (height, width, 2): x, y in m.
    by_pixel
        (height, width, 4): dx/du, dy/du, dx/dv, dy/dv in m per px.
    """

    def __init__(self, optics: Optics) -> None:
        """Evaluate the inverse map of ``optics`` at every pixel."""
        self.optics = optics
        self.world = unproject(optics, pixel_centres(optics))
        by_v, by_u = np.gradient(self.world, axis=(0, 1))
        self.by_pixel = np.concatenate([by_u, by_v], axis=2)


def stamp(
    image: Irradiance, pixels: PixelMap, layer: Layer, pose: Floats, lamp_azimuth: float
) -> None:
    """Draw a layer into ``image`` (height, width), in place.

    Parameters
    ----------
    image
        Brightness, float32.
    pixels
        Where the pixels are.
    layer
        What is drawn.
    pose
        (3,) x, y in m and θ in rad of its frame in the world.
    lamp_azimuth
        Direction of oblique light in rad, world frame.
    """
    x, y, theta = (float(value) for value in pose)
    turn = lamp_azimuth - theta
    _stamp(
        image,
        (pixels.world, pixels.by_pixel),
        layer.texels,
        layer.smooth,
        (x, y, math.cos(theta), math.sin(theta)),
        (*layer.origin, layer.pitch, layer.band),
        (math.cos(turn), math.sin(turn)),
        _box(pixels.optics, layer, x, y, theta),
    )


def _box(
    optics: Optics, layer: Layer, x: float, y: float, theta: float
) -> tuple[int, int, int, int]:
    """First and last (excluded) u and v of the pixels that the layer can reach."""
    h, w = layer.texels.shape[:2]
    corners = np.array(layer.origin) + layer.pitch * np.array([[0, 0], [w, 0], [w, h], [0, h]])
    c, s = math.cos(theta), math.sin(theta)
    world = corners @ np.array([[c, s], [-s, c]]) + np.array([x, y]) - np.array(optics.centre)
    c, s = math.cos(optics.rotation), math.sin(optics.rotation)
    flat = world @ np.array([[c, s], [s, -c]]) / optics.pixel_size + optics.middle
    # what distortion can shift a point by that is seen in the image
    reach = 2.0 + 8.0 * abs(optics.k1) * optics.half_diagonal
    low = np.clip(flat.min(axis=0) - reach, 0, [optics.width, optics.height]).astype(int)
    high = np.clip(flat.max(axis=0) + reach, 0, [optics.width, optics.height]).astype(int)
    return int(low[0]), int(high[0]), int(low[1]), int(high[1])


@sealed
def _bilinear(texels: Texels, j: float, i: float, channel: int) -> float:
    """A channel at row j, column i, between texels."""
    row, column = int(j), int(i)
    fj, fi = np.float32(j - row), np.float32(i - column)
    a, b = texels[row, column, channel], texels[row, column + 1, channel]
    c, d = texels[row + 1, column, channel], texels[row + 1, column + 1, channel]
    upper, lower = a + (b - a) * fi, c + (d - c) * fi
    return upper + (lower - upper) * fj


@sealed
def _area_mean(
    texels: Texels,
    at: tuple[float, float],
    by: tuple[float, float, float, float],
    points: Floats,
) -> tuple[float, float, float, float, float]:
    """All channels but the distance over a pixel at texel ``at``, changing by ``by`` a pixel."""
    cover = radiance = shade = relief_x = relief_y = np.float32(0.0)
    for k in range(len(points)):
        du, dv = points[k, 0], points[k, 1]
        i, j = at[0] + du * by[0] + dv * by[2], at[1] + du * by[1] + dv * by[3]
        cover += _bilinear(texels, j, i, COVERAGE)
        radiance += _bilinear(texels, j, i, RADIANCE)
        shade += _bilinear(texels, j, i, SHADE)
        relief_x += _bilinear(texels, j, i, RELIEF_X)
        relief_y += _bilinear(texels, j, i, RELIEF_Y)
    share = np.float32(1.0 / len(points))
    return (
        float(cover * share),
        float(radiance * share),
        float(shade * share),
        float(relief_x * share),
        float(relief_y * share),
    )


@njit(cache=True, error_model="numpy", fastmath={"contract", "arcp"})
def _stamp(
    image: Irradiance,
    maps: tuple[Floats, Floats],
    texels: Texels,
    smooth: Texels,
    pose: tuple[float, float, float, float],
    frame: tuple[float, float, float, float],
    lamp: tuple[float, float],
    box: tuple[int, int, int, int],
) -> None:
    world, by_pixel = maps
    x, y = pose[:2]
    x0, y0, pitch, band = frame
    c, s = pose[2] / pitch, pose[3] / pitch
    rows, columns = texels.shape[0], texels.shape[1]
    for v in range(box[2], box[3]):
        for u in range(box[0], box[1]):
            dx, dy = world[v, u, 0] - x, world[v, u, 1] - y
            i, j = c * dx + s * dy - x0 / pitch, c * dy - s * dx - y0 / pitch
            if not (_EDGE <= i < columns - 1 - _EDGE and _EDGE <= j < rows - 1 - _EDGE):
                continue
            near_j, near_i = j / HALVED, i / HALVED
            distance = abs(smooth[int(near_j), int(near_i), DISTANCE])
            if distance >= band + _EDGE * pitch:
                shade = _bilinear(smooth, near_j, near_i, SHADE)
                cover = _bilinear(smooth, near_j, near_i, COVERAGE)
                if shade != 0.0 or cover != 0.0:
                    beneath = image[v, u] * (1.0 + shade) * (1.0 - cover)
                    image[v, u] = beneath + _bilinear(smooth, near_j, near_i, RADIANCE)
                continue
            at = by_pixel[v, u]
            by = (
                c * at[0] + s * at[1],
                c * at[1] - s * at[0],
                c * at[2] + s * at[3],
                c * at[3] - s * at[2],
            )
            points = AT_EDGES if distance < _EDGE * pitch else _IN_RIM
            cover, radiance, shade, relief_x, relief_y = _area_mean(texels, (i, j), by, points)
            beneath = image[v, u] * (1.0 + shade) * (1.0 - cover)
            image[v, u] = beneath + radiance + lamp[0] * relief_x + lamp[1] * relief_y
