"""The tip of a needle of known radius, fitted to what it covers and what is behind it.

First the needle's shape, brightness and meniscus are fitted to the frames in which its tip stands
farthest from the part, all at once; then each frame's tip and film alone. Both are Gauss-Newton with
weights that leave out what does not fit (Tukey), the first with each frame's unknowns eliminated.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.tracking import meniscus
from meso_robust.tracking.alpha_matting import (
    AHEAD,
    ALONG,
    ASIDE,
    HALO_COUNT,
    OWN_COUNT,
    PAD,
    Window,
    blurred,
    sampled,
    sharp,
)
from meso_robust.tracking.backdrop import Backdrop
from meso_robust.tracking.needle import FINER, ORDINARY, SHARED, SPREAD, Needle
from meso_robust.types import Floats, Singles

_STEPS = 8
_LOOSE = 3  # first steps, in which nothing is left out
_SETTLED = 0.01  # px by which a tip moves in a step that is the last
_TRIED = np.array([0.02, 0.02, 0.02, 0.1, 0.1])  # steps of the differences of the shape
_UNITS = np.array([0.1, 0.1, 1.0, 0.02, 1.0])  # of direction, taper, log of blur, rise, and disc
_LINEAR = HALO_COUNT + OWN_COUNT
# how much a meniscus brightens the film, and how bright a needle is, and how much that changes along it, over the
# film's: middle, and spread of the latter, before the image is seen; of its direction, which was fitted once, the spread (rad)
_BRIGHT = np.array([0.0] * HALO_COUNT + [0.6] * (OWN_COUNT - 1) + [0.0])
_OWN_SPREAD = np.array([0.6] * (OWN_COUNT - 1) + [0.3])
_TURN = 0.1
_DISC, _DISC_SPREAD = 0.25, 0.5  # of how flat the blur is
_DISCS = -0.25, 1.25  # limits of it
_REACH = 4.5  # px from the window's middle, beyond which its images do not reach
_PIXEL = 1.0 / 12.0  # px²; variance of a place within a pixel
_NEAR = 6  # px within which what is left may be alike
_FAR = 4.0  # standard deviations at which what is left is cut off, to compare it
_ROUNDING = (
    1.0 / 48.0
)  # least variance of a grey value, that of rounding, over what the weights take it for
_MEDIAN_CHI2 = 0.4549364  # median of χ² with one degree of freedom
_BOUNDS = np.array([AHEAD, ALONG, ASIDE])


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
    common
        (2, 2) px², covariance of what every tip that is placed with it is off by, as it is not known exactly.
    alike
        Variance of what is fitted, over that if what is left were alike in no two pixels.
    noise
        Variance of what is left, over what the weights take it for.
    """

    needle: Needle
    brightness: Floats
    fine: Singles
    common: Floats
    alike: float
    noise: float


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
    certain = _certain()
    noise, alike = 1.0, SHARED
    for count in range(_STEPS):
        fine = _all_layers(shape, bright, window)
        turn = needle.direction - shape.direction
        other = np.array([turn, *(ORDINARY - shape.numbers), _DISC - shape.disc]) / _UNITS
        back = []
        rows = [
            _rows(one, place, film, shape, fine, window)
            for place, film, one in zip(places, films, seen, strict=True)
        ]
        if count >= _LOOSE:
            noise, alike = _left_over(rows, window)
            alike = max(alike, SHARED)
        normal = alike * certain
        right = normal @ np.append(_BRIGHT - bright, other)
        for own, shared, left, weight in rows:
            weight /= noise
            weight *= _tukey(left, weight) if count >= _LOOSE else 1.0
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
        before = places.copy()
        for k, (solved, cross, pull) in enumerate(back):
            own_step = solved @ (pull - cross @ step)
            places[k] = _within(seen[k], places[k] + np.clip(own_step[:2], -1.0, 1.0))
            films[k] += own_step[2:]
        if count > _LOOSE and np.abs(places - before).max() < _SETTLED:
            break
    fine = _with_slopes(blurred(_joined(sharp(shape, window), bright), shape))
    led = np.mean([(solved @ cross)[:2] for solved, cross, _ in back], axis=0)
    common = alike * led @ np.linalg.inv(normal) @ led.T
    matte = Matte(
        needle=shape, brightness=bright, fine=fine, common=common, alike=alike, noise=noise
    )
    return matte, places


def _certain() -> Floats:
    """(K, K) inverse covariance of what is shared, before the image is seen."""
    spread = np.concatenate([_OWN_SPREAD, np.array([_TURN, *SPREAD, _DISC_SPREAD]) / _UNITS])
    certain = np.diag(np.append(np.zeros(HALO_COUNT), spread**-2))
    certain[:HALO_COUNT, :HALO_COUNT] = meniscus.certainty()
    return certain


def place(one: Backdrop, tip: Floats, matte: Matte, window: Window) -> Placed:
    """The tip in one frame, from a start (2,) right to about a pixel."""
    from meso_robust.tracking.fit_kernels import place as fitted

    part, normal = _within(one, tip) - one.near, np.empty((6, 6))
    square = fitted(
        matte.fine,
        _stacked(replace(one, used=one.used / np.float32(matte.noise))),
        one.film,
        part,
        np.array(window.low, float),
        matte.needle.axis,
        matte.needle.blur**2 + _PIXEL,
        _BOUNDS,
        np.array([FINER, PAD, _REACH]),
        normal,
    )
    return Placed(tip=one.near + part, covariance=square * np.linalg.inv(normal)[:2, :2])


def _within(one: Backdrop, tip: Floats) -> Floats:
    """A tip that the window holds; one at its border disagrees with the start and is doubted."""
    return np.asarray(np.clip(tip, one.near - _REACH, one.near + _REACH))


def _changed(needle: Needle, step: Floats) -> Needle:
    step = step * _UNITS
    disc = float(np.clip(needle.disc + step[4], *_DISCS))
    turned = replace(needle, direction=needle.direction + float(step[0]), disc=disc)
    return turned.reshaped(
        needle.taper + step[1], needle.blur * math.exp(step[2]), needle.rise + step[3]
    )


def _joined(fine: Singles, bright: Floats) -> Singles:
    """(2, h, w) transmission and own brightness."""
    share = np.concatenate([[1.0], bright]).astype(np.float32)
    first = 1 + HALO_COUNT
    parts = (slice(None, first), slice(first, None))
    return np.stack(
        [
            (share[part] @ fine[part].reshape(len(share[part]), -1)).reshape(fine.shape[1:])
            for part in parts
        ]
    )


def _with_slopes(both: Singles) -> Singles:
    down, right = np.gradient(both, axis=(1, 2))
    return np.concatenate([both, FINER * right, FINER * down]).astype(np.float32, copy=False)


def _all_layers(shape: Needle, bright: Floats, window: Window) -> Singles:
    """The six images of a matte, its parts, and how transmission and brightness vary with shape."""
    fine = sharp(shape, window)
    parts = blurred(fine, shape)
    both = _joined(parts, bright)
    varied = []
    for step in np.diag(_TRIED):
        other = _changed(shape, step)
        sharpened = replace(
            other, blur=shape.blur, disc=shape.disc
        )  # the blur comes after what is sharp
        drawn = _joined(fine if sharpened == shape else sharp(other, window), bright)
        varied.append((blurred(drawn, other) - both) / np.float32(step.sum()))
    return np.concatenate([_with_slopes(both), parts[1:], *varied])


def _rows(
    one: Backdrop, tip: Floats, film: Floats, shape: Needle, fine: Singles, window: Window
) -> tuple[Floats, Floats, Floats, Floats]:
    """Slopes in the frame's unknowns and in the shared ones, what is left, and weights."""
    from meso_robust.tracking.fit_kernels import behind, compare, through

    images = sampled(fine, window, tip - one.near)
    scene = np.empty((5, *images.shape[1:]))
    behind(one.relative, tip - one.near - window.low, shape.axis, film, scene)
    own, left, weight = np.empty((5, images[0].size)), *np.empty((2, images[0].size))
    variance = shape.blur**2 + _PIXEL
    compare(images, scene, variance, _stacked(one), film[0], _BOUNDS, own, left, weight)
    bright = 6 + HALO_COUNT
    varied = images[6 + _LINEAR :]
    clear = np.concatenate([images[6:bright], varied[::2]])
    seen = np.empty(clear.shape)
    through(scene, variance, clear, seen)
    shared = [
        seen[:HALO_COUNT],
        film[0] * images[bright : 6 + _LINEAR],
        seen[HALO_COUNT:] + film[0] * varied[1::2],
    ]
    return own, np.concatenate(shared).reshape(-1, images[0].size), left, weight


def _stacked(one: Backdrop) -> Singles:
    """(4, h, w) what is compared, as the kernels take it."""
    return np.stack([one.grey, one.relative, one.variance, one.used])


def _left_over(
    rows: Sequence[tuple[Floats, Floats, Floats, Floats]], window: Window
) -> tuple[float, float]:
    """Noise and likeness of what is left, as `Matte` has them; texture and a needle that is not quite so are alike."""
    left = np.array([(left * np.sqrt(weight)).reshape(window.shape) for *_, left, weight in rows])
    known = left[left != 0.0] ** 2
    noise = max(float(np.median(known)) / _MEDIAN_CHI2, _ROUNDING) if len(known) else 1.0
    size = [n + _NEAR for n in window.shape]
    spectrum = np.fft.rfft2(np.clip(left / math.sqrt(noise), -_FAR, _FAR), size)
    pairs = np.fft.irfft2((np.abs(spectrum) ** 2).sum(axis=0), size)
    v, u = (np.minimum(k, n - k) for k, n in zip(np.ogrid[: size[0], : size[1]], size, strict=True))
    return noise, float(pairs[np.hypot(u, v) < _NEAR + 0.5].sum() / max(pairs[0, 0], 1e-9))


def _tukey(left: Floats, weight: Floats) -> Floats:
    """(N,) weights of what is left."""
    from meso_robust.tracking.fit_kernels import tukey_weights

    out = np.empty(len(left))
    tukey_weights(left, weight, out)
    return out
