"""Films of pushes in the independent plant: a renderer that shares nothing with the package.

Part and needle are each painted once, five times as fine as a pixel, blurred as by a lens and averaged over the
place of a pixel, and then laid into each frame where the camera sees them. What a law does to the image it does
to each corner of the part, so that an image that is larger shows a larger part. Only OpenCV and numpy draw.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from reports.blind3.generate import (
    LENGTH,
    RADIUS,
    RATE,
    WIDTH,
    Change,
    Floats,
    Push,
    World,
    corners_of,
    moved,
)

PIXEL_UM, SIDE = 9.0, 400
"""Of the camera, whose image shows SIDE x SIDE pixels about the stage's origin."""
FINE, MARGIN = 5, 8
"""Painted points a pixel (odd, so that a pixel has one in its middle), and pixels around what is painted."""
BACK, FLANK = 150, 0.08
"""px that a needle is painted long, and how fast it grows thicker."""
QUALITY = 85
"""Of the compression of frames."""
UP = np.array([1.0, -1.0])
"""Rows of an image go down, y of the stage goes up."""
PART_CORNERS = (
    0.5 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * [LENGTH, WIDTH]
)
SHAFT = np.array([[0.0, -10.0], [100.0, -10.0], [100.0, 10.0], [0.0, 10.0]])
"""Points of part (um, its own frame) and needle (px, along and across it) by which they are laid into a frame."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Painted:
    """Grey values and the share of what they cover, (H, W), and the place of the origin in it, px."""

    grey: Floats
    cover: Floats
    origin: Floats


def _waves(rng: np.random.Generator, height: int, width: int, finest: float) -> Floats:
    """(H, W) noise of unit variance with no detail below ``finest`` px."""
    raw = cv2.GaussianBlur(rng.normal(size=(height, width)), (0, 0), finest)
    return np.asarray(raw / raw.std())


def _lens(image: Floats, disc: float) -> Floats:
    """What a blur of a disc of this radius in px, and pixels that average, leave of a fine image."""
    reach = np.arange(-int(FINE * disc) - 1, int(FINE * disc) + 2)
    spread = np.clip(FINE * disc + 0.5 - np.hypot(reach[:, None], reach), 0.0, 1.0)
    blurred = cv2.filter2D(image, -1, spread / spread.sum())
    return np.asarray(cv2.blur(blurred, (FINE, FINE)))


def _filled(shape: tuple[int, int], corners: Floats) -> Floats:
    """(H, W) share of each fine place that lies in a polygon (V, 2) of fine places, x and y."""
    mask = np.zeros((shape[0] * FINE, shape[1] * FINE), np.uint8)
    places = np.round(16.0 * ((corners + 0.5) * FINE - 0.5)).astype(np.int32)  # in sixteenths
    cv2.fillPoly(mask, [places], 255, shift=4)
    return np.asarray(cv2.resize(mask, shape[::-1], interpolation=cv2.INTER_AREA) / 255.0)


def painted_part(corners_um: Floats, rng: np.random.Generator, disc: float) -> Painted:
    """A rough face with a bright, narrow rim; corners (V, 2) in its own frame, y down."""
    half = np.abs(corners_um).max(axis=0) / PIXEL_UM + MARGIN
    shape = (2 * math.ceil(half[1]) * FINE, 2 * math.ceil(half[0]) * FINE)
    origin = np.array([shape[1] / 2 - 0.5, shape[0] / 2 - 0.5])
    inside = _filled(shape, corners_um * (FINE / PIXEL_UM) + origin)
    depth = cv2.distanceTransform((inside > 0.5).astype(np.uint8), cv2.DIST_L2, 5) / FINE
    face = rng.uniform(130.0, 170.0) + 4.0 * _waves(rng, *shape, 1.2 * FINE)
    face += rng.uniform(25.0, 45.0) * np.exp(-depth / 1.2)
    cover = _lens(inside, disc)
    return Painted(grey=_lens(face * inside, disc), cover=cover, origin=origin)


def painted_needle(rng: np.random.Generator, disc: float) -> Painted:
    """A dark needle along +x, whose round tip has its centre at the origin."""
    radius = RADIUS / PIXEL_UM
    reach = MARGIN + radius + FLANK * BACK
    shape = (2 * math.ceil(reach) * FINE, (BACK + MARGIN) * FINE)
    origin = np.array([MARGIN * FINE - 0.5, shape[0] / 2 - 0.5])
    angles = np.linspace(0.5 * np.pi, 1.5 * np.pi, 33)
    tip = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    end = radius + FLANK * BACK
    outline = np.vstack([tip, [[BACK + MARGIN, -end], [BACK + MARGIN, end]]])
    inside = _filled(shape, outline * FINE + origin)
    dark = rng.uniform(20.0, 40.0)
    return Painted(grey=_lens(dark * inside, disc), cover=_lens(inside, disc), origin=origin)


def pixels(points_um: Floats) -> Floats:
    """(..., 2) u and v, px, of places on the stage; y points up."""
    return np.asarray(points_um * UP / PIXEL_UM + 0.5 * (SIDE - 1))


def laid(ground: Floats, painted: Painted, own: Floats, seen: Floats) -> Floats:
    """A frame with something laid into it: its points (4, 2) in px of the camera are seen at (4, 2) px."""
    fine = (own * FINE + painted.origin).astype(np.float32)
    map_ = cv2.getPerspectiveTransform(fine, seen.astype(np.float32))
    size = (SIDE, SIDE)
    cover = cv2.warpPerspective(painted.cover, map_, size)
    return np.asarray(ground * (1.0 - cover) + cv2.warpPerspective(painted.grey, map_, size))


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """Of the films of a set: all were taken with one camera in one light.

    Attributes
    ----------
    disc
        Radius of the blur in px.
    noise
        Grey steps, standard deviation of every pixel.
    ground
        (SIDE, SIDE) grey values of stage and film.
    part, needle
        As painted, y down.
    """

    disc: float
    noise: float
    ground: Floats
    part: Painted
    needle: Painted


def drawn_look(world: World, rng: np.random.Generator) -> Look:
    """How a set looks; the outline of its part is the true one."""
    disc, ramp = rng.uniform(0.9, 1.6), np.linspace(-1.0, 1.0, SIDE)
    slope = 1.0 + 0.08 * rng.uniform(-1.0, 1.0, 2) * ramp[:, None]
    light = rng.uniform(60.0, 85.0) * slope[:, :1] * slope[:, 1]
    return Look(
        disc=disc,
        noise=rng.uniform(8.0, 20.0),
        ground=light + 2.5 * _waves(rng, SIDE, SIDE, 1.5),
        part=painted_part(corners_of(world) * UP, rng, disc),
        needle=painted_needle(rng, disc),
    )


def film(
    path: Path,
    scene: tuple[World, Look],
    push: Push,
    exposures: Floats,
    rng: np.random.Generator,
) -> None:
    """Write a film of a push.

    Parameters
    ----------
    path
        Of the film, an AVI file.
    scene
        What is true, and how it looks.
    push
        As commanded.
    exposures
        (F,) s, instants at which frames are taken.
    rng
        Noise.
    """
    world, look = scene
    own, tips, away = PART_CORNERS, push.tips, _away(push)
    poses = moved(world, push)
    for change in world.changes:
        tips = change.drive(push.times, tips) if change.drive else tips
    c, s = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
    ways = [poses + np.hstack([c * x - s * y, s * x + c * y, np.zeros_like(c)]) for x, y in own]
    ways.append(np.column_stack([tips, np.zeros(len(tips))]))
    seen = [_taken(world.changes, push.times, way, exposures) for way in ways]
    turned = np.array([[away[0], -away[1]], [away[1], away[0]]])
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), RATE, (SIDE, SIDE), False)
    writer.set(cv2.VIDEOWRITER_PROP_QUALITY, QUALITY)
    for places in np.stack(seen, axis=1):
        frame = laid(look.ground, look.part, own * UP / PIXEL_UM, pixels(places[:4]))
        frame = laid(frame, look.needle, SHAFT, pixels(places[4]) + SHAFT @ turned.T)
        frame += look.noise * rng.standard_normal(frame.shape)
        writer.write(np.clip(np.round(frame), 0, 255).astype(np.uint8))
    writer.release()


def _away(push: Push) -> Floats:
    """(2,) direction in the image in which a needle leads away from its tip: against the push."""
    way = push.tips - push.tips[0]
    back = -way[np.argmax(np.hypot(*way.T))]
    return np.asarray(back / np.hypot(*back) * UP)


def _taken(changes: tuple[Change, ...], times: Floats, path: Floats, exposures: Floats) -> Floats:
    """(F, 2) where frames show what goes along a path (T, 3) of places and headings."""
    for change in changes:
        path = change.see(times, path) if change.see else path
    return np.column_stack([np.interp(exposures, times, path[:, k]) for k in range(2)])
