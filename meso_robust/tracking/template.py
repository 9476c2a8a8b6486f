"""Where in a frame a part may be: its outline, drawn at many angles, compared at low resolution.

What is compared is the direction of the edges, at twice the angle so that dark-on-bright and
bright-on-dark count alike, and only to a small part their contrast.
"""

from __future__ import annotations

import math

import cv2
import numpy as np

from meso_robust.tracking.edges import rotation
from meso_robust.types import Floats, Image as Bytes, Singles

STEP = math.radians(6.0)
"""Between the angles tried; the edges' reach covers half of it at the ends of a part."""
SHORTEST = 18.0
"""Width in px that the outline keeps at low resolution."""
_PER_ANGLE = 2
_SATURATION = 12.0  # grey steps a (reduced) px at which an edge counts half


def symmetry(corners: Floats, tolerance: float = 1.0) -> int:
    """In how many orientations an outline looks alike.

    Parameters
    ----------
    corners
        (V, 2) px.
    tolerance
        Largest distance of a corner from the one that it comes to lie on, px.

    Returns
    -------
    int
        1 if none but its own. Only turns about the frame's origin count: the reference point must stay
        where it is.
    """
    best = 1
    for n in range(2, len(corners) + 1):
        turned = corners @ rotation(2.0 * math.pi / n).T
        gap = np.linalg.norm(turned[:, None] - corners[None], axis=-1).min(axis=1)
        if np.all(gap < tolerance):
            best = n
    return best


def _factor(corners: Floats) -> int:
    """Reduction (1, 2, 4, 8) that keeps the outline's smallest width visible."""
    _, (a, b), _ = cv2.minAreaRect(corners.astype(np.float32))
    return max(k for k in (1, 2, 4, 8) if k == 1 or min(a, b) >= k * SHORTEST)


def _directions(frame: Bytes, mask: Bytes | None, factor: int) -> Singles:
    """(h, w, 2) edges of the reduced frame: cosine and sine of twice their direction, by contrast."""
    height, width = (n // factor for n in frame.shape)
    cut = frame[: height * factor, : width * factor]
    small = cv2.resize(cut, (width, height), interpolation=cv2.INTER_AREA).astype(np.float32)
    gu, gv = cv2.Scharr(small, cv2.CV_32F, 1, 0) / 32.0, cv2.Scharr(small, cv2.CV_32F, 0, 1) / 32.0
    power = gu**2 + gv**2
    size = np.sqrt(power)
    strength = size / (size + _SATURATION) / np.maximum(power, 1e-6)
    out = np.stack(((gu**2 - gv**2) * strength, 2.0 * gu * gv * strength), axis=-1)
    if mask is not None:
        covered = cv2.resize(
            (mask[: height * factor, : width * factor] != 0).astype(np.uint8),
            (width, height),
            interpolation=cv2.INTER_AREA,
        )
        out[cv2.dilate(covered, np.ones((3, 3), np.uint8)) > 0] = 0.0
    return out.astype(np.float32)


def _drawn(corners: Floats, angle: float) -> tuple[Singles, Floats]:
    """The outline at an angle as (h, w, 2) directions of unit sum, and where its origin lies."""
    turned = corners @ rotation(angle).T
    low = np.floor(turned.min(axis=0)) - 2.0
    width, height = (np.ceil(turned.max(axis=0)) - low + 3.0).astype(int)
    image = np.zeros((height, width, 2), np.float32)
    for a, b in zip(turned - low, np.roll(turned, -1, axis=0) - low, strict=True):
        side = np.zeros((height, width), np.float32)
        ends = [tuple(int(x) for x in np.round(p * 256.0)) for p in (a, b)]
        cv2.line(side, ends[0], ends[1], 1.0, 2, cv2.LINE_8, 8)
        twice = 2.0 * (math.atan2(b[1] - a[1], b[0] - a[0]) + 0.5 * math.pi)
        fresh = (side > 0.0) & (image == 0.0).all(axis=-1)
        image[fresh] = (math.cos(twice), math.sin(twice))
    image /= max(float(np.abs(image).max(axis=-1).sum()), 1.0)
    return image, -low


def candidates(frame: Bytes, mask: Bytes | None, corners: Floats, count: int) -> list[Floats]:
    """Poses (3,) in px and rad where the outline may be, the best first.

    Angles lie in [0, 2π / n) for an outline that looks alike in n orientations. Good to a few px and
    half of STEP: material for a fit of the edges.
    """
    factor = _factor(corners)
    image = _directions(frame, mask, factor)
    small = corners / factor
    steps = math.ceil(2.0 * math.pi / symmetry(corners) / STEP)
    angles = np.arange(steps) * (2.0 * math.pi / symmetry(corners) / steps)
    # a border lets half of the part lie outside the frame
    border = math.ceil(0.5 * float(np.linalg.norm(small, axis=1).max()))
    wide = cv2.copyMakeBorder(image, border, border, border, border, cv2.BORDER_CONSTANT, value=0)
    found: list[tuple[float, Floats]] = []
    for angle in angles:
        drawn, origin = _drawn(small, float(angle))
        if drawn.shape[0] > wide.shape[0] or drawn.shape[1] > wide.shape[1]:
            continue
        score = cv2.matchTemplate(wide, drawn, cv2.TM_CCORR)
        for _ in range(_PER_ANGLE):
            _, best, _, (u, v) = cv2.minMaxLoc(score)
            at = (np.array([u, v]) + origin - border + 0.5) * factor - 0.5
            found.append((best, np.append(at, angle)))
            cv2.circle(score, (u, v), 6, -1.0, cv2.FILLED)
    found.sort(key=lambda pair: -pair[0])
    return _distinct([pose for _, pose in found], 2.0 * factor, count)


def _distinct(poses: list[Floats], distance: float, count: int) -> list[Floats]:
    """The first ``count`` poses that are further apart than ``distance`` px or two steps of angle."""
    kept: list[Floats] = []
    for pose in poses:
        near = (
            np.hypot(*(pose[:2] - other[:2])) < distance and abs(pose[2] - other[2]) < 1.5 * STEP
            for other in kept
        )
        if not any(near):
            kept.append(pose)
        if len(kept) == count:
            break
    return kept
