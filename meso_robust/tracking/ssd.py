"""Sum of squared differences against the part's own appearance, by inverse composition.

The face of the part (texture, scratches, pits) moves with it exactly, whatever the light does to its
rim. With the appearance T and its gradient fixed in the part's frame, I ≈ g T + b + T (gₓ x + g_y y) +
κ ΔT - g ∇T·ξ is linear in gain g, offset b, the slope of the light, a change κ of focus and the motion
ξ; solved again after each motion (Baker and Matthews, doi:10.1023/B:VISI.0000011205.11775.fd).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np

from meso_robust.tracking.covariance import clustered, turned
from meso_robust.tracking.edges import Lens, moved, placed, rotation
from meso_robust.tracking.sampling import Patch, sample
from meso_robust.types import Floats, Ints

INSET = 6.0
"""Distance in px from the outline inside which nothing is compared: the rim changes with the light."""
MOST = 3000
"""Points that are compared: those with the steepest grey values."""
BLOCK = 16.0
"""Side in px of the blocks within which errors are taken to be correlated (two JPEG blocks)."""
_LEAST = 60  # points and
_LEAST_BLOCKS = 12  # blocks below which nothing is compared
_ROUNDS = 3
_LEAST_SCALE = 0.3  # grey steps, of residuals
_STILL = 5e-3  # px: a step below this ends the iteration
_LIGHT = 5  # unknowns that are not motion


@dataclass(frozen=True, slots=True, eq=False)
class Appearance:
    """Mean grey values of the part's face on a grid of 1 px in its frame.

    Attributes
    ----------
    low
        (2,) px of the first grid point.
    inside
        (h, w) whether a grid point lies on the face, away from the rim.
    total, count
        (h, w) sum of the grey values seen there, and how often.
    """

    low: Floats
    inside: Floats
    total: Floats
    count: Floats


class Template(NamedTuple):
    """What is compared.

    Attributes
    ----------
    points
        (M, 2) px in the part's frame, sorted by block.
    design
        (M, 8) gain, offset, two slopes, focus, and ∇T times the motion (u, v, angle).
    starts
        (B,) first point of each block.
    """

    points: Floats
    design: Floats
    starts: Ints


class SsdFit(NamedTuple):
    """A pose (3,) from the appearance, its covariance (3, 3), and the correlation reached."""

    pose: Floats
    covariance: Floats
    correlation: float


def blank(corners: Floats) -> Appearance:
    """Nothing seen yet of the part with ``corners`` (V, 2) px."""
    low = np.floor(corners.min(axis=0))
    width, height = (np.ceil(corners.max(axis=0)) - low).astype(int) + 1
    face = np.zeros((height, width), np.uint8)
    cv2.fillPoly(face, [np.round(corners - low).astype(np.int32)], 1)
    face = np.pad(face, 1)
    depth = cv2.distanceTransform(face, cv2.DIST_L2, 5)[1:-1, 1:-1]
    empty = np.zeros((height, width))
    return Appearance(low, (depth > INSET).astype(float), empty, empty)


def _grid(of: Appearance) -> tuple[Ints, Floats]:
    """Flat indices of the face's grid points, and their place (K, 2)."""
    index = np.flatnonzero(of.inside)
    row, column = np.divmod(index, of.inside.shape[1])
    return index, np.column_stack((column, row)) + of.low


def added(of: Appearance, piece: Patch, pose: Floats, lens: Lens) -> Appearance:
    """The appearance with one more frame at a known pose, brought to the same mean grey."""
    index, points = _grid(of)
    grey = sample(piece, lens.seen(placed(points, pose)))
    seen = np.isfinite(grey)
    if not seen.any():
        return of
    total, count = of.total.ravel().copy(), of.count.ravel().copy()
    both = seen & (count[index] > 0)
    gain = 1.0
    if both.any():
        gain = float(np.mean(total[index[both]] / count[index[both]]) / np.mean(grey[both]))
    total[index[seen]] += gain * grey[seen]
    count[index[seen]] += 1.0
    shape = of.inside.shape
    return Appearance(of.low, of.inside, total.reshape(shape), count.reshape(shape))


def template(of: Appearance) -> Template | None:
    """What to compare, or None where the face shows too little."""
    known = of.count > 0
    mean = np.where(known, of.total / np.maximum(of.count, 1.0), 0.0)
    dv, du = np.gradient(mean)
    bend = np.gradient(dv, axis=0) + np.gradient(du, axis=1)
    # two differences reach two grid points far
    usable = cv2.erode((known & (of.inside > 0)).astype(np.uint8), np.ones((5, 5), np.uint8))
    steep = np.where(usable.astype(bool), du**2 + dv**2, 0.0).ravel()
    index = np.argsort(steep)[::-1][:MOST]
    index = index[steep[index] > 0.0]
    row, column = np.divmod(index, mean.shape[1])
    block = (row // BLOCK) * mean.shape[1] + column // BLOCK
    order = np.argsort(block, kind="stable")
    index, block = index[order], block[order]
    starts = np.flatnonzero(np.diff(block, prepend=-1.0))
    if len(index) < _LEAST or len(starts) < _LEAST_BLOCKS:
        return None
    points = np.column_stack((column[order], row[order])) + of.low
    gu, gv, T = du.ravel()[index], dv.ravel()[index], mean.ravel()[index]
    x, y = ((points - points.mean(axis=0)) / np.ptp(points, axis=0)).T
    turn = gv * points[:, 0] - gu * points[:, 1]
    design = np.column_stack((T, np.ones(len(T)), x * T, y * T, bend.ravel()[index], gu, gv, turn))
    return Template(points, design, starts)


def registered(piece: Patch, of: Template, pose: Floats, lens: Lens) -> SsdFit | None:
    """The pose near ``pose`` (3,) where the appearance agrees best; None if it is not found.

    Starts within about 2 px. The covariance holds noise and what is correlated within blocks, not
    an error of the poses that the appearance was learned with.
    """
    from meso_robust.tracking.fit_kernels import alike, face_step

    solution, residual = np.empty(of.design.shape[1]), np.empty(len(of.points))
    weight = np.ones(len(of.points))
    for _ in range(_ROUNDS):
        grey = sample(piece, lens.seen(placed(of.points, pose)))
        seen = face_step(of.design, grey, _LEAST_SCALE, weight, solution, residual)
        if seen < max(_LEAST, 0.2 * len(grey)) or not solution[0] > 0.1:
            return None
        motion = -solution[_LIGHT:] / solution[0]
        if np.hypot(*motion[:2]) > 4.0:
            return None
        pose = moved(pose, motion)
        if np.abs(motion[:2]).max() < _STILL:
            break
    covariance = clustered(of.design, weight, residual, of.starts)
    motion_covariance = covariance[_LIGHT:, _LIGHT:] / solution[0] ** 2
    correlation = alike(of.design, float(solution[0]), weight, residual)
    return SsdFit(pose, turned(motion_covariance, rotation(pose[2])), correlation)
