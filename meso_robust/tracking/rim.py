"""How far oblique light displaces the edges: a rim that faces the lamp is brighter than its opposite.

A blurred rim that is brighter on one side looks displaced there, and as the opposite side is darker
the whole part seems displaced towards (or away from) the lamp, by up to half a px, the same in every
frame. The residuals of the edges cannot show it. What can is the shape of the profiles at full
resolution: the pixels along a slanted side sample it far finer than a px, and the step from the
background to the rim does not move with the rim's brightness. So all sides are fitted together by
background | meniscus | edge | chamfer with a brightness linear in the cosine to the lamp | face.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.special import erfcx, ndtr

from meso_robust.tracking.covariance import LAMP_SIGMA
from meso_robust.tracking.edges import CORNER, Lens, Outline, placed, rotation
from meso_robust.types import Floats, Image as Bytes

_IN, _OUT, _BIN = -10.0, 9.0, 0.25  # px inward and outward of the outline, and a bin
_CENTRES = np.arange(_IN, _OUT, _BIN) + 0.5 * _BIN
_LEAST = 150  # pixels a side must show
# displacement (px, twice) and that common to all sides, log of blur, chamfer and meniscus (px): middle and spread
# of what etched foil under a 4x objective shows; they bind only where the image says nothing
_EXPECTED = np.array([0.0, 0.0, 0.0, 0.0, math.log(2.5), math.log(2.5)])
_SPREAD = np.array([LAMP_SIGMA, LAMP_SIGMA, 0.25, 0.5, 0.35, 0.4])
_TRUST = 3.0  # weight of what is expected: profiles agree with the model to some grey steps only
_GREY = 1.0 / 6.0  # weight of a grey step: one is believed where 36 pixels say so
# a strongly lit rim may have been taken for the edge on one side and not on the other
_STARTS = 1.2 * np.array(
    [[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [1, -1], [-1, 1], [-1, -1]]
)
_LOOSEST = 2.5  # px; a larger displacement is no rim


class LampFit(NamedTuple):
    """Displacement (2,) px of a pose from edges by oblique light, and its covariance (2, 2)."""

    displacement: Floats
    covariance: Floats


class _Profiles(NamedTuple):
    mean: Floats
    """(S, B) grey value a side and bin."""
    weight: Floats
    """(S, B) square root of the pixels in a bin."""
    normal: Floats
    """(S, 2) outward, in the image."""


def _binned(
    frame: Bytes, mask: Bytes | None, outline: Outline, pose: Floats, lens: Lens
) -> _Profiles:
    """Grey values by the distance from the outline, a row for every side seen well enough."""
    corners = placed(outline.corners, pose)
    seen = lens.seen(corners)
    limit = np.array(frame.shape[::-1]) - 1
    low = np.clip(np.floor(seen.min(axis=0) - 12.0), 0, limit).astype(int)
    high = np.clip(np.ceil(seen.max(axis=0) + 12.0), 0, limit).astype(int)
    u, v = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    grey = frame[v, u].ravel().astype(float)
    if mask is not None:
        grey[mask[v, u].ravel() != 0] = np.nan
    at = lens.ideal(np.column_stack((u.ravel(), v.ravel())).astype(float))
    means, weights, normals = [], [], []
    for side in np.unique(outline.side):
        a, b = corners[side], corners[(side + 1) % len(corners)]
        length = float(np.hypot(*(b - a)))
        along = (b - a) / length
        n = rotation(pose[2]) @ outline.normals[np.argmax(outline.side == side)]
        x, t = (at - a) @ along, (at - a) @ n
        near = (x > 1.5 * CORNER) & (x < length - 1.5 * CORNER) & (t > _IN) & (t < _OUT)
        near &= np.isfinite(grey)
        if near.sum() < _LEAST:
            continue
        k = ((t[near] - _IN) / _BIN).astype(int)
        count = np.bincount(k, minlength=len(_CENTRES)).astype(float)
        total = np.bincount(k, grey[near], minlength=len(_CENTRES))
        means.append(total / np.maximum(count, 1.0))
        weights.append(np.sqrt(count))
        normals.append(n)
    return _Profiles(np.array(means), np.array(weights), np.array(normals))


def _shapes(x: Floats, blur: float, chamfer: float, meniscus: float) -> Floats:
    """(B, 6) background, its slope, meniscus, face, its slope, chamfer; each blurred."""
    z = x / blur
    out = ndtr(z)

    def ramp(t: Floats) -> Floats:
        return t * ndtr(t / blur) + blur / math.sqrt(2.0 * math.pi) * np.exp(-0.5 * (t / blur) ** 2)

    rising = ramp(x)
    # exp(-x / h) for x > 0, blurred
    tail = 0.5 * np.exp(-0.5 * z**2) * erfcx((blur / meniscus - z) / math.sqrt(2.0))
    rim = (ramp(x + chamfer) - rising) / chamfer - out
    return np.column_stack((out, 0.1 * rising, tail, 1.0 - out, 0.1 * (x - rising), rim))


def _design(given: _Profiles, unknown: Floats) -> Floats:
    """(S B, 4 S + 4): levels and slopes a side; meniscus, chamfer and its two cosines for all."""
    count = len(given.mean)
    blur, chamfer, meniscus = np.exp(unknown[3:])
    rows = np.zeros((count, len(_CENTRES), 4 * count + 4))
    for s, n in enumerate(given.normal):
        shapes = _shapes(_CENTRES - n @ unknown[:2] - unknown[2], blur, chamfer, meniscus)
        rows[s, :, 4 * s : 4 * s + 4] = shapes[:, [0, 1, 3, 4]]
        rows[s, :, -4], rows[s, :, -3] = shapes[:, 2], shapes[:, 5]
        rows[s, :, -2:] = shapes[:, 5:] * n
    return (rows * given.weight[:, :, None]).reshape(-1, 4 * count + 4)


def lamp_displacement(
    frame: Bytes,
    mask: Bytes | None,
    outline: Outline,
    pose: Floats,
    lens: Lens,
    near: Floats | None = None,
) -> LampFit | None:
    """By how much a pose from edges is displaced by oblique light, in the image's axes.

    ``pose`` (3,) must be right within about 2 px. With ``near`` (2,) px, what an earlier frame
    showed, only the solution near to it is looked for. None where too few sides are seen to tell,
    or the profiles do not look like a chamfered plate.
    """
    given = _binned(frame, mask, outline, pose, lens)
    if len(given.mean) < 3:
        return None
    starts = _STARTS if near is None else -near[None]
    fits = [fit for start in starts if (fit := _fitted(given, start)) is not None]
    if not fits:
        return None
    fit = min(fits, key=lambda one: one.cost)
    if np.hypot(*fit.x[:2]) > _LOOSEST:
        return None
    # the profiles' misfit is the model's, not noise: it is taken as it is, as if it were independent
    variance = 2.0 * fit.cost / max(len(fit.fun) - 4 * len(given.mean) - 10, 1)
    covariance = variance * np.linalg.pinv(fit.jac.T @ fit.jac, hermitian=True)[:2, :2]
    return LampFit(-fit.x[:2], covariance)


def _fitted(given: _Profiles, start: Floats) -> OptimizeResult | None:
    """Least squares over displacement (2), δ and shape, the levels being solved for within."""
    target = (given.mean * given.weight).ravel()

    def misfit(unknown: Floats) -> Floats:
        design = _design(given, unknown)
        unit = design / (np.linalg.norm(design, axis=0) + 1e-9)
        normal = unit.T @ unit
        normal[np.diag_indices(len(normal))] += 1e-6
        rest = target - unit @ np.linalg.solve(normal, unit.T @ target)
        return np.append(_GREY * rest, _TRUST * (unknown - _EXPECTED) / _SPREAD)

    begin = np.concatenate((start, _EXPECTED[2:]))
    try:
        return least_squares(misfit, begin, x_scale=[0.1, 0.1, 0.1, 0.1, 0.2, 0.2], max_nfev=12)
    except (ValueError, np.linalg.LinAlgError):  # a shape ran to infinity
        return None
