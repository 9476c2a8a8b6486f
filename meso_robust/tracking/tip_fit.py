"""The tip of a needle of known radius, fitted to what it covers and what is behind it.

First the needle's shape, brightness and meniscus are fitted to the frames in which its tip stands
farthest from the part, all at once; then each frame's tip and film alone. Both are Gauss-Newton with
weights that leave out what does not fit (Tukey), the first with each frame's unknowns eliminated.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from meso_robust.tracking.alpha_matting import (
    AHEAD,
    ALONG,
    ASIDE,
    HALO_COUNT,
    OWN_COUNT,
    Window,
    blurred,
    sampled,
    sharp,
)
from meso_robust.tracking.backdrop import Backdrop
from meso_robust.tracking.needle import FINER, Needle
from meso_robust.types import Floats, Singles

_NOISE = 4.0  # grey values²
_TUKEY = 5.0  # standard deviations beyond which a pixel does not count
_STEPS, _STEPS_EACH = 8, 3
_TRIED = np.array([0.02, 0.02, 0.02, 0.1])  # steps of the differences of the shape
_SHAPE_PRIOR = np.array([0.11, 1.0, 1.0, 0.25])  # weak: a step that nothing asks for is not made
_GAIN = 0.05  # by which the needle's brightness over the film's may vary
_LINEAR = HALO_COUNT + OWN_COUNT
_REACH = 4.5  # px from the window's middle, beyond which its images do not reach
_PIXEL = 1.0 / 12.0  # px²; variance of a place within a pixel


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Matte:
    """A fitted needle.

    Attributes
    ----------
    needle
        Its shape; its place does not count.
    brightness
        (HALO_COUNT + OWN_COUNT,) of its meniscus and of itself, over the film's.
    fine
        (6, h, w) transmission and brightness about the tip, their slopes to the right, then down.
    """

    needle: Needle
    brightness: Floats
    fine: Singles


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Placed:
    """A tip in one frame.

    Attributes
    ----------
    tip
        (2,) u, v in px.
    covariance
        (2, 2) of it, px²; of the noise that is left.
    """

    tip: Floats
    covariance: Floats


def fit_matte(
    seen: Sequence[Backdrop], tips: Floats, needle: Needle, window: Window
) -> tuple[Matte, Floats]:
    """Fit a needle to several frames.

    Parameters
    ----------
    seen
        K frames around the tip.
    tips
        (K, 2) where it is about, px.
    needle
        First guess of its shape.
    window
        Of the pixels that are compared.

    Returns
    -------
    Matte
        The needle.
    numpy.ndarray
        (K, 2) tips.
    """
    shape, places = needle, np.array([_within(*pair) for pair in zip(seen, tips, strict=True)])
    bright = np.concatenate([np.zeros(HALO_COUNT), np.full(OWN_COUNT - 1, 0.4), [0.0]])
    films = np.array([[one.film, 0.0, 0.0] for one in seen])
    for count in range(_STEPS):
        fine = _all_layers(shape, bright, window)
        normal = np.diag(np.concatenate([np.ones(_LINEAR), 0.5 * _SHAPE_PRIOR]))
        right = np.concatenate([-bright, np.zeros(4)])
        right[HALO_COUNT:] = 0.0
        back = []
        for place, film, one in zip(places, films, seen, strict=True):
            own, shared, left, weight = _rows(one, place, film, shape, fine, window)
            weight *= _tukey(left, weight) if count > 2 else 1.0
            block = (own * weight) @ own.T
            block += 1e-6 * np.diag(np.diag(block)) + 1e-9 * np.eye(len(block))
            cross, pull = (own * weight) @ shared.T, (own * weight) @ left
            solved = np.linalg.inv(block)
            normal += (shared * weight) @ shared.T - cross.T @ solved @ cross
            right += (shared * weight) @ left - cross.T @ solved @ pull
            back.append((solved, cross, pull))
        step = np.linalg.solve(normal, right)
        bright = bright + step[:_LINEAR]
        shape = _changed(shape, np.clip(step[_LINEAR:], -1.0, 1.0))
        for k, (solved, cross, pull) in enumerate(back):
            own_step = solved @ (pull - cross @ step)
            places[k] = _within(seen[k], places[k] + np.clip(own_step[:2], -1.0, 1.0))
            films[k] += own_step[2:]
    fine = _with_slopes(blurred(_joined(sharp(shape, window), bright), shape))
    return Matte(needle=shape, brightness=bright, fine=fine), places


def place(one: Backdrop, tip: Floats, matte: Matte, window: Window) -> Placed:
    """The tip in one frame, from a start (2,) right to about a pixel."""
    tip, film, gain = _within(one, tip), np.array([one.film, 0.0, 0.0]), 1.0
    for count in range(_STEPS_EACH):
        lit = matte.fine.copy()
        lit[1::2] *= np.float32(gain)
        images = sampled(lit, window, tip - one.near)
        own, left, weight = _frame(one, tip, film, matte.needle, images, window)
        own = np.vstack([own, (film[0] * images[1] / gain).ravel()])
        weight *= _tukey(left, weight) if count else 1.0
        normal, right = (own * weight) @ own.T, (own * weight) @ left
        normal[5, 5] += _GAIN**-2
        normal += 1e-9 * np.eye(6)
        right[5] -= (gain - 1.0) * _GAIN**-2
        step = np.linalg.solve(normal, right)
        tip = _within(one, tip + np.clip(step[:2], -1.5, 1.5))
        film += step[2:5]
        gain += float(np.clip(step[5], -0.3, 0.3))
    many = max(int((weight > 0.0).sum()), 1)
    square = float(weight @ left**2) / many
    return Placed(tip=tip, covariance=np.asarray(square * np.linalg.inv(normal)[:2, :2], float))


def _within(one: Backdrop, tip: Floats) -> Floats:
    """A tip that the window holds; one at its border disagrees with the start and is doubted."""
    return np.asarray(np.clip(tip, one.near - _REACH, one.near + _REACH))


def _changed(needle: Needle, step: Floats) -> Needle:
    return replace(
        needle,
        direction=needle.direction + 0.1 * float(step[0]),
        taper=float(np.clip(needle.taper + 0.1 * step[1], 0.0, 0.5)),
        blur=float(np.clip(needle.blur * math.exp(step[2]), 0.3, 5.0)),
        rise=float(np.clip(needle.rise + 0.02 * step[3], 0.0, 0.2)),
    )


def _joined(fine: Singles, bright: Floats) -> Singles:
    """(2, h, w) transmission and own brightness."""
    share = np.concatenate([[1.0], bright]).astype(np.float32)
    first = 1 + HALO_COUNT
    parts = (slice(None, first), slice(first, None))
    return np.stack([np.tensordot(share[part], fine[part], 1) for part in parts])


def _with_slopes(both: Singles) -> Singles:
    down, right = np.gradient(both, axis=(1, 2))
    return np.concatenate([both, FINER * right, FINER * down]).astype(np.float32)


def _all_layers(shape: Needle, bright: Floats, window: Window) -> Singles:
    """The six images of a matte, its parts, and how transmission and brightness vary with shape."""
    parts = blurred(sharp(shape, window), shape)
    both = _joined(parts, bright)
    varied = []
    for step in np.diag(_TRIED):
        other = _changed(shape, step)
        varied.append((blurred(_joined(sharp(other, window), bright), other) - both) / step.sum())
    return np.concatenate([_with_slopes(both), parts[1:], *varied]).astype(np.float32)


def _rows(
    one: Backdrop, tip: Floats, film: Floats, shape: Needle, fine: Singles, window: Window
) -> tuple[Floats, Floats, Floats, Floats]:
    """Slopes in the frame's unknowns and in the shared ones, what is left, and weights."""
    images = sampled(fine, window, tip - one.near)
    own, left, weight = _frame(one, tip, film, shape, images[:6], window)
    behind = _Behind(one, film, shape, tip, window)
    first = 6 + HALO_COUNT
    varied = images[6 + _LINEAR :]
    shared = [
        *(behind.through(image) for image in images[6:first]),
        *(film[0] * image for image in images[first : 6 + _LINEAR]),
        *(behind.through(varied[2 * k]) + film[0] * varied[2 * k + 1] for k in range(4)),
    ]
    return own, np.stack(shared).reshape(len(shared), -1), left, weight


def _frame(
    one: Backdrop, tip: Floats, film: Floats, shape: Needle, images: Singles, window: Window
) -> tuple[Floats, Floats, Floats]:
    """Slopes (5, N) in tip and film, what is left (N,), and weights (N,)."""
    behind = _Behind(one, film, shape, tip, window)
    clear, bright = images[0], images[1]
    model = behind.through(clear) + film[0] * bright
    own = np.stack(
        [
            -(behind.through(images[2]) + film[0] * images[3]),
            -(behind.through(images[4]) + film[0] * images[5]),
            model / film[0],
            film[0] * one.relative * clear * behind.s / 10.0,
            film[0] * one.relative * clear * behind.n / 10.0,
        ]
    )
    near = (behind.s > -AHEAD) & (behind.s < ALONG)
    near &= np.abs(behind.n) < ASIDE + 0.1 * np.maximum(behind.s, 0.0)
    weight = near * one.used / (_NOISE + one.variance * (film[0] * clear) ** 2)
    return own.reshape(5, -1), (one.grey - model).ravel(), weight.ravel().astype(np.float64)


class _Behind:
    """The scene behind a needle, px and grey values."""

    def __init__(
        self, one: Backdrop, film: Floats, shape: Needle, tip: Floats, window: Window
    ) -> None:
        v, u = np.mgrid[: window.shape[0], : window.shape[1]].astype(float)
        first = one.near + window.low
        here = replace(shape, tip=(float(tip[0] - first[0]), float(tip[1] - first[1])))
        self.s, self.n = here.along_across(u, v)
        slope = 1.0 + film[1] * self.s / film[0] / 10.0 + film[2] * self.n / film[0] / 10.0
        self._grey = film[0] * slope * one.relative
        self._right, self._down = _slopes(self._grey)
        self._variance = shape.blur**2 + _PIXEL

    def through(self, clear: Singles) -> Floats:
        """What a needle of some transmission lets through."""
        right, down = _slopes(clear)
        mixed = self._down * down + self._right * right
        return np.asarray(self._grey * clear + self._variance * mixed)


def _slopes(image: npt.NDArray[Any]) -> tuple[Singles, Singles]:
    """Central differences to the right and down."""
    single = np.ascontiguousarray(image, np.float32)
    right = cv2.Sobel(single, cv2.CV_32F, 1, 0, ksize=1, scale=0.5)
    down = cv2.Sobel(single, cv2.CV_32F, 0, 1, ksize=1, scale=0.5)
    return np.asarray(right, np.float32), np.asarray(down, np.float32)


def _tukey(left: Floats, weight: Floats) -> Floats:
    return np.asarray(np.maximum(1.0 - left**2 * weight / _TUKEY**2, 0.0) ** 2)
