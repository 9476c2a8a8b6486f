"""How far oblique light displaces the edges: a rim that faces the lamp is brighter than its opposite.

A blurred rim that is brighter on one side looks displaced there, and as the opposite side is darker
the whole part seems displaced towards (or away from) the lamp, by up to half a px, the same in every
frame. The residuals of the edges cannot show it. What can is the shape of the profiles at full
resolution: the pixels along a slanted side sample it far finer than a px, and the step from the
background to the rim does not move with the rim's brightness. So all sides are fitted together by
background | meniscus | edge | chamfer with a brightness linear in the cosine to the lamp | face.
Where the part is not seen in the size that is stated, its size is fitted along: of sides that do not lie where the
outline says, one would be taken for lit.
Rolling lines, grain and dust beside an edge are no noise of pixels: along a side they are alike. How
much of that there is shows deeper in the face and farther out, and the fit weighs the profiles by it.
What the fit states of its error is scaled by what else a film shows of it (`_scatter`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import cv2
import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.special import ndtr

from meso_robust.tracking.covariance import LAMP_SIGMA
from meso_robust.tracking.edges import CORNER, Lens, Outline, placed, rotation
from meso_robust.types import Flags, Floats, Image as Bytes

_IN, _OUT, _BIN = -10.0, 9.0, 0.25  # px inward and outward of the outline, and a bin
_DEEP = -24.0  # px inward to which the face is looked at to tell how it varies
_BINS = np.arange(_DEEP, _OUT, _BIN) + 0.5 * _BIN
_FITTED = _BINS > _IN
_CENTRES = _BINS[_FITTED]
_LEAST = 150  # pixels a side must show
_CLEAR = 5.0  # px from the outline, where neither rim nor meniscus reach
_LAG, _ALIKE = (
    6,
    1.2,
)  # bins between values that are compared, and px over which what varies is alike
_OWN = 0.6  # share of a side's own variation, the rest being the mean of all: 20 px tell little
_FLOOR = 0.3  # grey steps that rounding and compression leave in any mean
# displacement (px, twice) and that common to all sides, log of blur, chamfer and meniscus (px), how round the
# chamfer and how flat the blur is, and the farthest side's displacement (px) by the part's size: middle and spread of what parts under a 4x objective show; they bind only where the
# image says nothing
_EXPECTED = np.array([0.0, 0.0, 0.0, 0.0, math.log(2.5), math.log(2.5), 0.5, 0.25, 0.0])
_SPREAD = np.array([LAMP_SIGMA, LAMP_SIGMA, 0.15, 0.5, 1.0, 0.4, 0.5, 0.3, 1.0])
_SCALE = np.array([0.1, 0.1, 0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.1])
_CHAMFER = 4  # of them
# a strongly lit rim may have been taken for the edge on one side and not on the other
_STARTS = np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
_UNEVEN = 0.03  # change of the film's brightness over 10 px, by which sides may differ
_LOOSEST = 2.5  # px; a larger displacement is no rim
# variance of errors over that of the fit, for a step between blocks of compression over those within; set on films
# of their own, as was the next; chamfer and blur vary less than the fit grants them
_BY_BLOCKS = 0.2
_BY_PRESSURE = 0.2  # of the square of what displaces all sides alike
_BLOCK = 8  # px, side of a block
_ALIEN = 2.0  # standard deviations of a displacement common to all sides, beyond which edges are not the outline's
_DISTINCT, _DOUBT = 0.2, 2.0  # px between solutions, and decline of their likelihood by their cost
_LEAST_STEP = 0.4  # of blocks; fine compression smooths their borders and still displaces edges


class LampFit(NamedTuple):
    """Displacement (2,) px of a pose from edges by oblique light, and its covariance (2, 2).

    ``doubt`` (2, 2) is the variance that other solutions add, which fit nearly as well, and all that there is
    before an image is seen if the fit's edges are not where the outline is.
    """

    displacement: Floats
    covariance: Floats
    doubt: Floats


class _Profiles(NamedTuple):
    mean: Floats
    """(S, B) grey value a side and bin."""
    whitener: Floats
    """(S, B, B) that makes what varies and the noise of a side's bins independent and of variance 1."""
    normal: Floats
    """(S, 2) outward, in the image."""
    place: Floats
    """(S, B) px outward, where the pixels of a bin lie: those of a side along rows or columns at one end of it."""
    arm: Floats
    """(S,) by how much a side moves outward with the part's size, that of the farthest being 1."""


def _binned(
    frame: Bytes, mask: Bytes | None, outline: Outline, pose: Floats, lens: Lens
) -> _Profiles:
    """Grey values by the distance from the outline, a row for every side seen well enough."""
    from meso_robust.tracking.rim_kernels import binned

    corners = placed(outline.corners, pose)
    seen = lens.seen(corners)
    limit = np.array(frame.shape[::-1]) - 1
    low = np.clip(np.floor(seen.min(axis=0) - 12.0), 0, limit).astype(int)
    high = np.clip(np.ceil(seen.max(axis=0) + 12.0), 0, limit).astype(int)
    u, v = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    at = lens.ideal(np.column_stack((u.ravel(), v.ravel())).astype(float))
    grey = frame[low[1] : high[1] + 1, low[0] : high[0] + 1].ravel()
    hidden = np.zeros_like(grey)
    if mask is not None:
        hidden = (mask[low[1] : high[1] + 1, low[0] : high[0] + 1] != 0).ravel().view(np.uint8)
    means, counts, noises, normals, places, arms = [], [], [], [], [], []
    for side in np.unique(outline.side):
        a, b = corners[side], corners[(side + 1) % len(corners)]
        length = float(np.hypot(*(b - a)))
        n = rotation(pose[2]) @ outline.normals[np.argmax(outline.side == side)]
        ends = np.array([1.5 * CORNER, length - 1.5 * CORNER])
        sums = np.zeros((4, len(_BINS)))
        line = np.concatenate((a, (b - a) / length, n))
        level = _levelled(grey, hidden, (at - a) @ np.column_stack((n, (b - a) / length)), ends)
        if binned(level, hidden, at, line, ends, np.array([_DEEP, _BIN, _IN]), sums) < _LEAST:
            continue
        count, total, square, distance = sums
        filled = count > 0
        value = total[filled] / count[filled]
        noises.append(np.mean(np.maximum(square[filled] / count[filled] - value**2, 0.0)))
        means.append(np.interp(_BINS, _BINS[filled], value))
        places.append(np.divide(distance, count, out=_BINS.copy(), where=filled)[_FITTED])
        counts.append(count)
        normals.append(n)
        arms.append(float(a @ n) - float(pose[:2] @ n))
    if not means:
        none = np.empty((0, 0))
        return _Profiles(none, np.empty((0, 0, 0)), np.empty((0, 2)), none, np.empty(0))
    mean, pixels = np.array(means), np.array(counts, dtype=float)
    whitener = _whitener(mean, pixels, np.array(noises))
    arm = np.array(arms) / np.abs(arms).max()
    return _Profiles(mean[:, _FITTED], whitener, np.array(normals), np.array(places), arm)


def _levelled(grey: Bytes, hidden: Bytes, at: Floats, ends: Floats) -> Floats:
    """(N,) grey values without what film and face vary along a side; ``at`` (N, 2) px outward of it and along it.

    Of a side nearly along rows or columns every bin shows another stretch, and would tell of that.
    """
    away, along = at.T
    middle, half = 0.5 * ends.sum(), 0.5 * (ends[1] - ends[0])
    level, beside = grey.astype(float), (hidden == 0) & (np.abs(along - middle) < half)
    near = beside & (away > _DEEP) & (away < _OUT)
    for within, sign in ((away > 0.9 * _CLEAR, 1.0), (away < -_CLEAR, -1.0)):
        seen = near & within
        x, s = away[seen] / _OUT, (along[seen] - middle) / half
        columns = np.column_stack((np.ones(len(x)), x, x**2, s, s**2))
        if len(x) < _LEAST:
            continue
        slope, bend = np.linalg.lstsq(columns, level[seen], rcond=None)[0][3:]
        s = (along[near] - middle) / half
        level[near] -= ndtr(sign * away[near]) * (slope * s + bend * (s**2 - 1.0 / 3.0))
    return level


def _whitener(mean: Floats, count: Floats, noise: Floats) -> Floats:
    """(S, B, B) from all bins of the means (S, D), their pixels, and the variance (S,) of a pixel."""
    each = noise[:, None] / np.maximum(count, 1e-6)  # a bin without a pixel says nothing
    alike = np.exp(-0.5 * ((_CENTRES[:, None] - _CENTRES) / _ALIKE) ** 2)
    single = np.eye(len(_CENTRES))
    covariance = (each[:, _FITTED] + _FLOOR**2)[:, :, None] * single
    for within, share in (
        (_BINS < -_CLEAR, ndtr(-_CENTRES)),
        (_BINS > 0.9 * _CLEAR, ndtr(_CENTRES)),
    ):
        varied = _varied(mean, count, within, _LAG) + _FLOOR**2
        covariance += varied[:, None, None] * alike * np.outer(share, share)
        # of a side nearly along rows or columns every bin shows another stretch
        seen = within & (count > 0.0)
        of_noise = np.where(seen, each, 0.0).sum(axis=1) / np.maximum(seen.sum(axis=1), 1)
        jumps = _varied(mean, count, within, 1) - of_noise
        covariance += np.maximum(jumps, 0.0)[:, None, None] * single * share**2
    return np.asarray(np.linalg.inv(np.linalg.cholesky(covariance)))


def _varied(mean: Floats, count: Floats, within: Flags, lag: int) -> Floats:
    """(S,) variance of the means (S, D) of bins within some (D,), by those of them that are some bins apart."""
    both = within[lag:] & within[:-lag] & (count[:, lag:] > 0.0) & (count[:, :-lag] > 0.0)
    total = np.where(both, 0.5 * (mean[:, lag:] - mean[:, :-lag]) ** 2, 0.0).sum(axis=1)
    seen = both.sum(axis=1)
    common = total.sum() / max(seen.sum(), 1)
    own = total / np.maximum(seen, 1)
    return np.where(seen > 0, _OWN * own + (1.0 - _OWN) * common, common)


def lamp_displacement(
    frame: Bytes,
    mask: Bytes | None,
    outline: Outline,
    pose: Floats,
    lens: Lens,
    near: Floats | None = None,
    sized: bool = False,
) -> LampFit | None:
    """By how much a pose from edges is displaced by oblique light, in the image's axes.

    ``pose`` (3,) must be right within about 2 px. With ``near`` (2,) px, what an earlier frame
    showed, only the solution near to it is looked for. ``sized``: the outline's size is as seen, not as
    stated. None where too few sides are seen to tell, or the profiles do not look like a chamfered plate.
    """
    given = _binned(frame, mask, outline, pose, lens)
    if len(given.mean) < 3:
        return None
    starts = _STARTS if near is None else -near[None]
    fits = _all_fitted(given, starts, sized)
    if fits and not sized and _alien(fits[0]):
        fits = _all_fitted(given, starts, True)
    if not fits:
        return None
    fit = fits[0]
    if np.hypot(*fit.x[:2]) > _LOOSEST:
        return None
    # what was met on all sides may be the rim's inner edge: nothing is known of the light then
    alien = _alien(fit)
    doubt = LAMP_SIGMA**2 * np.eye(2) if alien else np.zeros((2, 2))
    for other in fits:
        away = other.x[:2] - fit.x[:2]
        if np.hypot(*away) > _DISTINCT and np.hypot(*other.x[:2]) < _LOOSEST:
            doubt += math.exp(_DOUBT * (fit.cost - other.cost)) * np.outer(away, away) / len(fits)
    found = np.linalg.pinv(fit.jac.T @ fit.jac, hermitian=True)
    wrong = _wrong(fit.x, found[_CHAMFER, _CHAMFER])
    covariance = _scatter(frame) * found[:2, :2] + wrong * np.eye(2)
    return LampFit(-fit.x[:2], covariance, doubt)


def _alien(fit: OptimizeResult) -> bool:
    """Whether all sides lie elsewhere than an outline may."""
    return bool(abs(fit.x[2] - _EXPECTED[2]) > _ALIEN * _SPREAD[2])


def _wrong(found: Floats, variance: float) -> float:
    """Variance (px²) of a displacement by what the model of a rim gets wrong, ``variance`` being that of its log width.

    A lit rim that is narrower than the blur looks like a displaced edge, and how far that is hangs on the width that
    it is taken for: of the displacement no larger share is known than of the width. And as the outline is known,
    all sides displaced alike are a rim that is not as the model has it; of what the light displaces, which is the same
    rim brighter on one side, about half as much may be wrong, if there is as much of it.
    """
    lit = float(found[:2] @ found[:2])
    return variance * lit + _BY_PRESSURE * min(float(found[2]) ** 2, lit)


def _scatter(frame: Bytes) -> float:
    """Variance of errors over what the fit states: compression errs alike along a side, which it does not know."""
    return _BY_BLOCKS * max(block_step(frame) - 1.0, _LEAST_STEP)


def block_step(frame: Bytes) -> float:
    """Step of grey values (H, W) at the borders of blocks of compression over that within; 1: none.

    The borders may lie anywhere; medians leave out what edges in the image do to single columns.
    """
    ratio = 1.0
    for image in (frame, np.ascontiguousarray(frame.T)):
        steps = cv2.absdiff(image[:, 1:], image[:, :-1]).mean(axis=0)
        whole = len(steps) // _BLOCK * _BLOCK
        each = np.median(steps[:whole].reshape(-1, _BLOCK), axis=0)
        within = (each.sum() - each.max()) / (_BLOCK - 1)
        ratio *= float(each.max() / max(within, _FLOOR / 3.0))
    return math.sqrt(ratio)


def _all_fitted(given: _Profiles, starts: Floats, sized: bool) -> list[OptimizeResult]:
    """The fits from all starts (K, 2), the best first."""
    fits = [fit for start in starts if (fit := _fitted(given, start, sized)) is not None]
    return sorted(fits, key=lambda one: one.cost)


def _fitted(given: _Profiles, start: Floats, sized: bool) -> OptimizeResult | None:
    """Least squares over displacement (2), δ, shape and, where it is not as stated, size, the levels solved for within."""
    from meso_robust.tracking.rim_kernels import misfit, slopes

    count = len(given.mean)
    target = np.append(given.whitener @ given.mean[:, :, None], np.zeros(count))
    alike = 1.0 / (_UNEVEN * float(given.mean[:, -1].mean()))
    sides = (
        given.place,
        np.column_stack((given.normal, given.arm * sized)),
        given.whitener,
        target,
        alike,
    )
    expected = np.diag(1.0 / _SPREAD)
    begin = np.concatenate((start, _EXPECTED[2:]))
    try:
        return least_squares(
            lambda x: np.append(misfit(sides, x), (x - _EXPECTED) / _SPREAD),
            begin,
            jac=lambda x: np.vstack((slopes(sides, x), expected)),
            x_scale=_SCALE,
            max_nfev=12,
        )
    except (ValueError, np.linalg.LinAlgError):  # a shape ran to infinity
        return None
