"""Images of a rectangular part from closed forms: blurred by the error function, no pixels drawn."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

HALF = (150.0, 80.0)
"""Half sides in px."""
CORNERS = np.array([[-150.0, -80.0], [150.0, -80.0], [150.0, 80.0], [-150.0, 80.0]])


def body_coordinates(pose: Floats, shape: tuple[int, int] = (480, 640)) -> tuple[Floats, Floats]:
    """(h, w) coordinates of every pixel in the part's frame."""
    v, u = np.mgrid[: shape[0], : shape[1]].astype(float)
    c, s = math.cos(pose[2]), math.sin(pose[2])
    du, dv = u - pose[0], v - pose[1]
    return c * du + s * dv, -s * du + c * dv


def covered(x: Floats, half: float, blur: float) -> Floats:
    """A blurred slab |x| < half."""
    return np.asarray(ndtr((half - x) / blur) - ndtr((-half - x) / blur))


def plain(pose: Floats, blur: float = 1.0, background: float = 60.0, face: float = 170.0) -> Floats:
    """(480, 640) grey values of a rectangle without rim or texture, exactly blurred."""
    x, y = body_coordinates(pose)
    cover = covered(x, HALF[0], blur) * covered(y, HALF[1], blur)
    return np.asarray(background + (face - background) * cover)


def textured(pose: Floats, blur: float = 1.0) -> Floats:
    """The rectangle with waves of 9 to 30 px on its face."""
    x, y = body_coordinates(pose)
    waves = 12.0 * np.sin(0.4 * x + 0.21 * y + 0.3) + 9.0 * np.cos(0.33 * y - 0.25 * x)
    waves += 7.0 * np.sin(0.7 * x + 0.1) * np.cos(0.5 * y + 1.0)
    inside = covered(x, HALF[0] - 4.0, 2.0) * covered(y, HALF[1] - 4.0, 2.0)
    return plain(pose, blur) + waves * inside


def obliquely_lit(
    pose: Floats, lamp: Floats, blur: float = 1.0, width: float = 3.0, rounded: bool = False
) -> Floats:
    """A rectangle whose chamfer, ``width`` px wide, is brighter towards ``lamp`` (2,) of the image.

    The chamfer is 90 grey steps darker than the face at the edge, rising linearly to the face, or,
    ``rounded``, as a parabola that is level at the edge.
    """
    x, y = body_coordinates(pose)
    fine = np.arange(-200.0, 200.0, 0.02)
    lengths = np.arange(-300, 301) * 0.02
    kernel = np.exp(-0.5 * (lengths / blur) ** 2)
    kernel /= kernel.sum()
    c, s = math.cos(pose[2]), math.sin(pose[2])
    axes = np.array([[c, s], [-s, c]])  # rows: the part's axes in the image

    def slab(values: Floats, half: float, lit: float) -> tuple[Floats, Floats]:
        inside = (np.abs(fine) < half).astype(float)
        ramp = np.clip(1.0 - (half - np.abs(fine)) / width, 0.0, 1.0) * inside
        ramp = 1.0 - (1.0 - ramp) ** 2 if rounded else ramp
        ramp *= inside
        rim = ramp * (-90.0 + lit * np.sign(fine))
        blurred = [np.convolve(one, kernel, "same") for one in (inside, rim)]
        return np.interp(values, fine, blurred[0]), np.interp(values, fine, blurred[1])

    cover_x, rim_x = slab(x, HALF[0], float(axes[0] @ lamp))
    cover_y, rim_y = slab(y, HALF[1], float(axes[1] @ lamp))
    return np.asarray(50.0 + 120.0 * cover_x * cover_y + rim_x * cover_y + rim_y * cover_x)


def digitised(grey: Floats, rng: np.random.Generator, noise: float = 1.5) -> Bytes:
    """Grey values with normal noise, rounded to bytes."""
    return np.clip(np.round(grey + rng.normal(0.0, noise, grey.shape)), 0, 255).astype(np.uint8)
