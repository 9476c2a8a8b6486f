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
from functools import lru_cache

import cv2
import numpy as np
from scipy.optimize import least_squares

from meso_robust.types import Flags, Floats, Ints

FINER = 3
"""Samples a pixel and direction."""
ORDINARY = np.array([0.08, 0.0, 0.02])
"""Taper (rad), log of blur (px) and rise of an etched tungsten needle before the image is seen."""
SPREAD = np.array([0.03, 0.5, 0.03])
"""Standard deviations of them: a blunt, blurred needle is else much like a sharp one that ends later."""
SHARED = 3.0
"""Variance of what is fitted by grain and compression, which neighbours share, over that by noise."""
WIDEST, SHARPEST, BLUREST, STEEPEST = 0.5, 0.3, 5.0, 0.2
"""Limits of taper (rad), blur (px, twice) and rise; a fit that stands at one has found no needle."""
_GREY = 2.0  # standard deviation of noise, grey values
_AHEAD, _ALONG, _ASIDE = 9.0, 20.0, 8.0  # px; the piece of the image that the tip is fitted to


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
    disc
        0: the blur is a normal distribution; 1: of that variance it is about as flat as a disc.
    """

    tip: tuple[float, float]
    direction: float
    taper: float
    radius: float
    blur: float = 1.0
    rise: float = 0.02
    disc: float = 0.0

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
        from meso_robust.tracking.needle_kernels import distances

        out = np.empty(s.size)
        distances(s.ravel(), n.ravel(), self.taper, self.radius, out)
        return out.reshape(s.shape)

    def half_width(self, s: float) -> float:
        """Half the width at a place along the axis, at least the radius, px."""
        from meso_robust.tracking.needle_kernels import half_width

        return half_width(s, math.cos(self.taper), math.sin(self.taper), self.radius)

    def drawn(self) -> tuple[float, float, float, float, float, float, float]:
        """As kernels take it: tip, axis, cosine and sine of the taper, radius."""
        axis = math.cos(self.direction), math.sin(self.direction)
        return *self.tip, *axis, math.cos(self.taper), math.sin(self.taper), self.radius

    def reshaped(self, taper: float, blur: float, rise: float) -> Needle:
        """The needle with another taper, blur and rise, as far as there are such needles."""
        return replace(
            self,
            taper=float(np.clip(taper, 0.0, WIDEST)),
            blur=float(np.clip(blur, SHARPEST, BLUREST)),
            rise=float(np.clip(rise, 0.0, STEEPEST)),
        )

    @property
    def ordinary(self) -> Needle:
        """The needle with the shape that is expected before the image is seen."""
        taper, log_blur, rise = ORDINARY.tolist()
        return self.reshaped(taper, math.exp(log_blur), rise)

    @property
    def at_limit(self) -> bool:
        """Whether it is as wide, as sharp, as blurred or as steep as may be; none may well be parallel or level."""
        return self.taper >= WIDEST or not SHARPEST < self.blur < BLUREST or self.rise >= STEEPEST

    @property
    def numbers(self) -> Floats:
        """(3,) what ORDINARY and SPREAD are of."""
        return np.array([self.taper, math.log(self.blur), self.rise])

    def moved(self, shift: Floats) -> Needle:
        """The needle shifted by (2,) px."""
        return replace(self, tip=(float(self.tip[0] + shift[0]), float(self.tip[1] + shift[1])))

    def polygon(self, margin: float, length: float) -> Floats:
        """(V, 2) outline, wider by a margin, of the first ``length`` px of the needle."""
        ends = self.radius + margin, self.half_width(length) + margin
        return np.array(self.tip) + _border(self.direction, length, *ends)


@lru_cache(64)  # asked for in each frame
def _border(direction: float, length: float, tip: float, end: float) -> Floats:
    """(V, 2) outline from the tip on, of half widths ``tip`` and ``end``."""
    arc = np.linspace(0.5 * math.pi, 1.5 * math.pi, 9)
    cap = tip * np.stack([np.cos(arc), np.sin(arc)], axis=1)
    local = np.vstack([cap, np.array([[length, -end], [length, end]])])
    c, s = math.cos(direction), math.sin(direction)
    return local @ np.array([[c, s], [-s, c]])


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
        RMS difference of film and needle over the standard deviation of the residuals.
    """

    needle: Needle
    covariance: Floats
    contrast: float


def pixel_weights(blur: float) -> Floats:
    """(K,) weights in a pixel of fine samples around it, for a blur in px; K − FINER is even."""
    size = 2 * math.ceil(3.5 * blur * FINER) + 1
    optics = cv2.getGaussianKernel(size, blur * FINER, cv2.CV_64F)
    return np.convolve(optics.ravel(), np.full(FINER, 1.0 / FINER))


def coverage(needle: Needle, corner: Floats, shape: tuple[int, int]) -> Floats:
    """(h, w) share of each pixel that the needle covers, blurred; ``corner`` (u, v) is the first."""
    whole = np.tile([0, shape[1]], (shape[0], 1))
    return np.asarray(1.0 - _basis(needle, corner, whole, shape[1])[..., 0])


def fit_needle(
    image: Floats,
    corner: Floats,
    start: Needle,
    used: Floats | None = None,
    aside: Sequence[float] = (0.0,),
) -> Fit:
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
    aside
        px across the axis by which the start is moved, one after the other; what fits best is kept. One
        flank of a needle whose middle is as bright as the film looks like a needle of its own.

    Returns
    -------
    Fit
        In the frame's pixels.
    """
    piece = _piece(image, corner, start, used)
    across = np.array([-start.axis[1], start.axis[0]])

    def needle(y: Floats) -> Needle:
        x = y - 1.0
        turned = replace(start.moved(x[:2]), direction=start.direction + 0.1 * x[2])
        return turned.reshaped(
            start.taper + 0.1 * x[3], start.blur * math.exp(x[4]), start.rise + 0.02 * x[5]
        )

    def miss(y: Floats) -> Floats:
        tried = needle(y)
        unusual = (tried.numbers - ORDINARY) / SPREAD
        return np.append(piece.miss(tried), math.sqrt(SHARED) * _GREY * unusual)

    # unknowns about 1: steps of differences are relative, and the image is in single precision
    fits = [
        least_squares(
            miss,
            1.0 + np.append(place * across, np.zeros(4)),
            xtol=2e-3,
            ftol=1e-5,
            max_nfev=25,
            diff_step=3e-3,
        )
        for place in aside
    ]
    found = min(fits, key=lambda one: one.cost)
    count = max(int((piece.weight > 0.0).sum()) - 18, 1)
    variance = 2.0 * found.cost / count
    spread = variance * np.linalg.pinv(found.jac.T @ found.jac)[:2, :2]
    best = needle(found.x)
    return Fit(
        needle=best,
        covariance=np.asarray(spread),
        contrast=_contrast(piece.grey, best, piece.corner, math.sqrt(variance)),
    )


def alone(image: Floats, corner: Floats, needle: Needle, used: Flags) -> tuple[Floats, Flags]:
    """(h, w) a piece of a frame as it would be with nothing but a needle and film, and where that is known.

    ``corner`` (u, v) is the piece's first pixel, ``used`` (h, w) where it shows nothing else.
    """
    piece, whole = _piece(image, corner, needle, None), np.full(image.shape, math.nan)
    u, v = np.rint(piece.corner - corner).astype(int)
    inner = np.s_[v : v + piece.grey.shape[0], u : u + piece.grey.shape[1]]
    basis = _basis(needle, piece.corner, piece.columns, piece.grey.shape[1])
    counts, near = (piece.weight > 0.0) & used[inner], piece.weight > 0.0
    share = _brightness(basis[counts], piece.grey[counts])
    whole[inner][near] = basis[near] @ share
    return whole, np.isfinite(whole)


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

    columns: Ints
    """(h, 2) first of each row that counts, and the one after the last."""

    def miss(self, needle: Needle) -> Floats:
        """What the best brightnesses leave of the pixels that count, (N,)."""
        basis = _basis(needle, self.corner, self.columns, self.grey.shape[1])
        counts = self.weight > 0.0
        weight = self.weight[counts]
        flat, target = basis[counts] * weight[:, None], self.grey[counts] * weight
        return np.asarray(flat @ _brightness(flat, target) - target)


def _brightness(flat: Floats, target: Floats) -> Floats:
    """(K,) that explain grey values (N,) best by images (N, K)."""
    # a little ridge: a halo or a brightness that the data do not tell is taken as none
    gram = flat.T @ flat + 1e-3 * np.eye(flat.shape[1])
    return np.asarray(np.linalg.solve(gram, flat.T @ target))


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
    counts = weight > 0.0
    columns = np.stack(
        [np.argmax(counts, axis=1), grey.shape[1] - np.argmax(counts[:, ::-1], axis=1)], axis=1
    )
    columns[~counts.any(axis=1)] = 0
    return _Piece(grey=grey, weight=weight, corner=first, columns=columns)


def _contrast(piece: Floats, needle: Needle, corner: Floats, noise: float) -> float:
    share = coverage(needle, corner, (piece.shape[0], piece.shape[1]))
    inside, outside = piece[share > 0.7], piece[share < 0.05]
    if not inside.size or not outside.size:
        return 0.0
    return float(np.sqrt(np.mean((inside - np.median(outside)) ** 2)) / max(noise, 0.3))


def _basis(needle: Needle, corner: Floats, columns: Ints, width: int) -> Floats:
    """(h, w, K) images whose sum, each times a brightness, is the piece; drawn in some columns only."""
    from meso_robust.tracking.needle_kernels import BASIS, basis

    out = np.zeros((len(columns), width, BASIS))
    shape = np.array([needle.taper, needle.radius, needle.rise])
    tip = np.array(needle.tip) - corner
    basis(tip, needle.axis, shape, pixel_weights(needle.blur), FINER, columns, out)
    return out
