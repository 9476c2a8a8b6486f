"""A probe as it looks in an image: a needle with a round tip, opaque, before a film.

The needle is a disc of the known radius that widens along its axis into a cone. What it looks like
inside, how bright the film is, how it darkens towards the needle, and how sharp the image is, are
fitted; only the disc's centre, the tip, is of interest. The model is drawn finely, blurred and summed
over pixels, because half of the contrast does not mark the edge of a tip that is as small as the blur.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares
from scipy.special import ndtr

from meso_robust.types import Floats

_FINER = 3  # samples a pixel and direction
_AHEAD, _ALONG, _ASIDE = 9.0, 20.0, 8.0  # px; the piece of the image that the tip is fitted to
_HALOS = (1.5, 4.0)  # px; lengths over which the film may darken or brighten towards the needle
_KNOTS = np.linspace(-1.0, 1.0, 5)  # of the brightness across the needle, in half widths
_PAD = 5  # px around the piece, so that the blur does not meet its border


@dataclass(frozen=True, slots=True, kw_only=True)
class Needle:
    """Shape and place of a probe, px and rad, v down.

    Attributes
    ----------
    tip
        (u, v) of the centre of the round tip.
    direction
        Of the shaft, away from the tip, from +u to +v.
    taper
        Half angle of the cone.
    radius
        Of the tip, known.
    blur
        Standard deviation of the image's blur.
    rise
        Blur gained a px of shaft, as it rises out of focus.
    """

    tip: tuple[float, float]
    direction: float
    taper: float
    radius: float
    blur: float = 1.0
    rise: float = 0.02

    @property
    def axis(self) -> Floats:
        """(2,) unit vector along the shaft."""
        return np.array([math.cos(self.direction), math.sin(self.direction)])

    def along_across(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Coordinates along the axis from the tip and across it, px."""
        a = self.axis
        du, dv = u - self.tip[0], v - self.tip[1]
        return du * a[0] + dv * a[1], dv * a[0] - du * a[1]

    def distance(self, s: Floats, n: Floats) -> Floats:
        """Signed distance to the outline, negative inside, px."""
        c, d = math.cos(self.taper), math.sin(self.taper)
        flank = np.abs(n) * c - s * d - self.radius
        return np.where(s * c + np.abs(n) * d >= 0.0, flank, np.hypot(s, n) - self.radius)

    def half_width(self, s: Floats) -> Floats:
        """Half the width at a place along the axis, at least the radius, px."""
        wide = self.radius / math.cos(self.taper) + s * math.tan(self.taper)
        return np.maximum(wide, self.radius)

    def moved(self, shift: Floats) -> Needle:
        """The needle shifted by (2,) px."""
        return replace(self, tip=(float(self.tip[0] + shift[0]), float(self.tip[1] + shift[1])))

    def polygon(self, margin: float, length: float) -> Floats:
        """(V, 2) outline, wider by a margin, of the first ``length`` px of the needle."""
        wide = self.radius + margin
        end = float(self.half_width(np.array(length))) + margin
        arc = np.linspace(0.5 * math.pi, 1.5 * math.pi, 9)
        cap = wide * np.stack([np.cos(arc), np.sin(arc)], axis=1)
        local = np.vstack([cap, np.array([[length, -end], [length, end]])])
        a = self.axis
        turn = np.array([[a[0], a[1]], [-a[1], a[0]]])
        return np.array(self.tip) + local @ turn


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fit:
    """A fitted needle.

    Attributes
    ----------
    needle
        The best one.
    covariance
        (2, 2) of its tip, px²; of the noise that the residuals show.
    contrast
        Difference of film and needle over the standard deviation of the residuals.
    """

    needle: Needle
    covariance: Floats
    contrast: float


def coverage(needle: Needle, corner: Floats, shape: tuple[int, int]) -> Floats:
    """(h, w) share of each pixel that the needle covers, blurred; ``corner`` (u, v) is the first."""
    s, _, dist = _fine(needle, corner, shape)
    return _seen(_inside(needle, s, dist)[..., None], needle.blur)[..., 0]


def fit_needle(image: Floats, corner: Floats, start: Needle, used: Floats | None = None) -> Fit:
    """Fit tip, direction, taper and blur.

    Parameters
    ----------
    image
        (h, w) grey values of a piece of a frame.
    corner
        (u, v) of its first pixel.
    start
        First guess, right to about two pixels and ten degrees; its radius is kept.
    used
        (h, w) weights, or None for all 1.

    Returns
    -------
    Fit
        In the frame's pixels.
    """
    piece = _piece(image, corner, start, used)

    def needle(y: Floats) -> Needle:
        x = y - 1.0
        return replace(
            start,
            tip=(start.tip[0] + x[0], start.tip[1] + x[1]),
            direction=start.direction + 0.1 * x[2],
            taper=float(np.clip(start.taper + 0.1 * x[3], 0.0, 0.5)),
            blur=float(np.clip(start.blur * math.exp(x[4]), 0.3, 5.0)),
            rise=float(np.clip(start.rise + 0.02 * x[5], 0.0, 0.2)),
        )

    # unknowns about 1: steps of differences are relative, and the image is in single precision
    found = least_squares(
        lambda y: piece.miss(needle(y)),
        np.ones(6),
        xtol=2e-3,
        ftol=1e-5,
        max_nfev=25,
        diff_step=3e-3,
    )
    count = max(int((piece.weight > 0.0).sum()) - 18, 1)
    variance = 2.0 * found.cost / count
    spread = variance * np.linalg.pinv(found.jac.T @ found.jac)[:2, :2]
    best = needle(found.x)
    return Fit(
        needle=best,
        covariance=np.asarray(spread),
        contrast=_contrast(piece.grey, best, piece.corner, math.sqrt(variance)),
    )


def nearest_needle(image: Floats, starts: Sequence[Needle]) -> Needle:
    """The one of some needles that explains a whole image (H, W) best around the first one."""
    piece = _piece(image, np.zeros(2), starts[0], None)
    return min(starts, key=lambda needle: float(np.sum(piece.miss(needle) ** 2)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Piece:
    """Part of an image, and how much each pixel counts."""

    grey: Floats
    weight: Floats
    corner: Floats

    def miss(self, needle: Needle) -> Floats:
        """What the best brightnesses leave of the piece, (h w,)."""
        basis = _basis(needle, self.corner, self.grey.shape) * self.weight[..., None]
        flat = basis.reshape(-1, basis.shape[-1]).astype(np.float64)
        target = (self.grey * self.weight).ravel()
        # a little ridge: a halo or a brightness that the data do not tell is taken as none
        gram = flat.T @ flat + 1e-3 * np.eye(flat.shape[1])
        return np.asarray(flat @ np.linalg.solve(gram, flat.T @ target) - target)


def _piece(image: Floats, corner: Floats, start: Needle, used: Floats | None) -> _Piece:
    wide = math.hypot(_ALONG, _ASIDE)
    low = np.maximum(np.floor(np.array(start.tip) - wide - corner), 0).astype(int)
    high = np.maximum(np.ceil(np.array(start.tip) + wide - corner).astype(int) + 1, low + 1)
    grey = np.asarray(image[low[1] : high[1], low[0] : high[0]], dtype=float)
    first = corner + low
    v, u = np.mgrid[: grey.shape[0], : grey.shape[1]].astype(float)
    s, n = start.along_across(u + first[0], v + first[1])
    near = (s > -_AHEAD) & (s < _ALONG) & (np.abs(n) < _ASIDE + np.maximum(s, 0.0) * 0.1)
    weight = near.astype(float)
    if used is not None:
        weight *= used[low[1] : high[1], low[0] : high[0]]
    return _Piece(grey=grey, weight=weight, corner=first)


def _contrast(piece: Floats, needle: Needle, corner: Floats, noise: float) -> float:
    share = coverage(needle, corner, (piece.shape[0], piece.shape[1]))
    inside, outside = piece[share > 0.7], piece[share < 0.05]
    if not inside.size or not outside.size:
        return 0.0
    return float(abs(inside.mean() - np.median(outside)) / max(noise, 0.3))


def _fine(needle: Needle, corner: Floats, shape: tuple[int, ...]) -> tuple[Floats, Floats, Floats]:
    """Along, across and distance on the fine grid, padded."""
    rows, columns = (_FINER * (k + 2 * _PAD) for k in shape[:2])
    u = (np.arange(columns) + 0.5) / _FINER - 0.5 - _PAD + corner[0]
    v = (np.arange(rows) + 0.5) / _FINER - 0.5 - _PAD + corner[1]
    s, n = needle.along_across(u[None, :], v[:, None])
    return s, n, needle.distance(s, n)


def _inside(needle: Needle, s: Floats, distance: Floats) -> Floats:
    """Share of each fine sample that the needle covers."""
    return np.asarray(ndtr(-distance / np.maximum(needle.rise * s, 0.3 / _FINER)))


def _basis(needle: Needle, corner: Floats, shape: tuple[int, ...]) -> Floats:
    """(h, w, K) images whose sum, each times a brightness, is the piece."""
    s, n, dist = _fine(needle, corner, shape)
    inside = _inside(needle, s, dist)
    film = 1.0 - inside
    far = np.maximum(dist, 0.0)
    halos = [film * np.exp(-far / length) for length in _HALOS]
    across = n / needle.half_width(s)
    hats = [inside * np.maximum(0.0, 1.0 - np.abs(across - knot) / 0.5) for knot in _KNOTS]
    layers = [
        film,
        film * s / 10.0,
        film * n / 10.0,
        *halos,
        *hats,
        inside * s / 10.0,
    ]
    return _seen(np.stack(layers, axis=-1).astype(np.float32), needle.blur)


def _seen(fine: npt.NDArray[Any], blur: float) -> Floats:
    """What a camera sees of fine images (H, W, K): blurred and summed over pixels."""
    size = 2 * math.ceil(3.5 * blur * _FINER) + 1
    kernel = cv2.getGaussianKernel(size, blur * _FINER, cv2.CV_64F)
    rows, columns, depth = fine.shape
    # all images at once: side by side first, then, turned, on top of each other
    down = _filtered(fine.reshape(rows, columns * depth), kernel).reshape(fine.shape)
    turned = np.ascontiguousarray(down.transpose(1, 0, 2)).reshape(columns, rows * depth)
    done = _filtered(turned, kernel)
    tall, wide = rows // _FINER, columns // _FINER
    binned = done.reshape(wide, _FINER, tall, _FINER, depth).mean(axis=(1, 3)).transpose(1, 0, 2)
    return np.asarray(binned[_PAD:-_PAD, _PAD:-_PAD])


def _filtered(image: npt.NDArray[Any], kernel: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Each column of an image filtered."""
    return np.asarray(cv2.sepFilter2D(np.ascontiguousarray(image), -1, np.ones(1), kernel))
