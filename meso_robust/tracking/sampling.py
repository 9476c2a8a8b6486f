"""Grey values between the pixels; the compiled code is imported by the first of them."""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np

from meso_robust.types import Floats, Image, Singles

SMOOTHING = 1.0
"""Standard deviation in px of the smoothing before any sampling: bilinear interpolation of an image
this smooth is right to a hundredth of a grey step's pixel, and compression blocks are quenched."""
_RADIUS = 3
_KERNEL = cv2.getGaussianKernel(2 * _RADIUS + 1, SMOOTHING, cv2.CV_32F)
_SPREAD = np.ones((2 * _RADIUS + 1, 2 * _RADIUS + 1), np.uint8)


class Patch(NamedTuple):
    """A smoothed piece of a frame.

    Attributes
    ----------
    grey
        (h, w) smoothed grey values.
    hidden
        (h, w) non-zero where a probe hides the scene or reaches through the smoothing.
    covered
        First column and row, width and height of the box that holds all that is hidden.
    corner
        (u, v) in px of the piece's first pixel.
    """

    grey: Singles
    hidden: Image
    covered: tuple[int, int, int, int]
    corner: Floats


def patch(frame: Image, mask: Image | None, points: Floats, margin: float) -> Patch:
    """The piece of ``frame`` about ``points`` (N, 2) in px with ``margin`` px around, smoothed."""
    height, width = frame.shape
    low = np.floor(points.min(axis=0) - margin).astype(int)
    high = np.ceil(points.max(axis=0) + margin).astype(int) + 1
    u0, v0 = np.clip(low, 0, (width - 1, height - 1))
    u1, v1 = np.clip(high, (u0 + 1, v0 + 1), (width, height))
    piece = frame[v0:v1, u0:u1]
    smooth = cv2.sepFilter2D(piece, cv2.CV_32F, _KERNEL, _KERNEL, borderType=cv2.BORDER_REPLICATE)
    if mask is None:
        hidden, covered = np.zeros(piece.shape, np.uint8), (0, 0, 0, 0)
    else:
        hidden = (mask[v0:v1, u0:u1] != 0).view(np.uint8)
        u, v, wide, high = cv2.boundingRect(hidden)
        u, v = max(u - _RADIUS, 0), max(v - _RADIUS, 0)
        covered = (u, v, wide + 2 * _RADIUS, high + 2 * _RADIUS)
        box = hidden[v : v + covered[3], u : u + covered[2]]
        box[:] = cv2.dilate(box, _SPREAD)
    corner = np.array([u0, v0], dtype=float)
    return Patch(np.asarray(smooth, dtype=np.float32), hidden, covered, corner)


def sample(of: Patch, points: Floats) -> Floats:
    """(N,) grey values at ``points`` (N, 2) in px of the frame; NaN where not visible."""
    from meso_robust.tracking.sampling_kernels import sample as fill

    values = np.empty(len(points))
    fill(of.grey, of.hidden, points - of.corner, values)
    return values


def derivatives(of: Patch, points: Floats, normals: Floats, half: int, step: float) -> Floats:
    """Derivatives of grey values along normals, averaged over 3 px along the edge.

    Parameters
    ----------
    of
        The piece of the frame.
    points, normals
        (N, 2) in px of the frame, and unit normals there.
    half, step
        ``half`` samples either side of each point, ``step`` px apart, are differentiated.

    Returns
    -------
    Floats
        (N, 2 half - 1) grey values a px, NaN where a sample is hidden or outside the frame.
    """
    from meso_robust.tracking.sampling_kernels import derivatives as fill

    values = np.empty((len(points), 2 * half - 1))
    fill(of.grey, of.hidden, of.covered, points - of.corner, normals, step, values)
    return values
