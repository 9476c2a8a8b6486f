"""All tips of a video once more, when the needle, the part's image and its poses are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt

from meso_robust.tracking.alpha_matting import Window
from meso_robust.tracking.backdrop import Canvas, Glimpse, backdrop, canvas, glimpse_at
from meso_robust.tracking.needle import Needle
from meso_robust.tracking.tip_fit import Matte, fit_matte, place
from meso_robust.types import Floats

LEAST = 8
"""Frames that the needle is fitted to; fewer do not tell it from what is behind it."""
_CANVAS = 32  # frames that the part's image is the mean of
_CLEAR = 12.0  # px from the part where a tip counts as free
_ROUNDS = 2
_ALONG, _ACROSS = 0.115, 0.025  # px; what the needle's and the film's simplicity leave
_AMISS = 2.0  # px between the two estimates that are worth a doubt
_UNSEEN = 0.5  # px along the axis, where the part may be in front of the tip but was not found
_BLOCKED = 1.0  # px along the axis, where the part hides the end of the tip in all frames
_LEAST_GAP = 2.0  # px between part and needle where its end shows


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Refined:
    """Tips (T, 2) px, their covariances (T, 2, 2), and a remark or ""."""

    tips: Floats
    covariances: Floats
    remark: str


def refined(glimpses: Sequence[Glimpse], needle: Needle, window: Window) -> Refined:
    """Fit the needle, then each tip.

    Parameters
    ----------
    glimpses
        T pieces around the tip.
    needle
        As first fitted, right to ten degrees.
    window
        Of the pixels that are compared; the pieces were cut with it.
    """
    free = np.array([_clearance(one) for one in glimpses])
    chosen = np.argsort(-free, kind="stable")
    even = np.linspace(0, len(glimpses) - 1, min(_CANVAS, len(glimpses))).astype(int)
    drawn = np.unique(np.concatenate([even, chosen[:LEAST]]))
    chosen = _spread(chosen, free)
    offset, part = np.zeros(2), None
    shape = needle
    for _ in range(_ROUNDS):
        seen = [backdrop(glimpse_at(glimpses[k], offset), window, shape, part) for k in chosen]
        starts = np.array([glimpses[k].tip for k in chosen]) + offset
        matte, tips = fit_matte(seen, starts, shape, window)
        offset = offset + np.mean(tips - starts, axis=0)
        shape = matte.needle
        part = canvas([glimpse_at(glimpses[k], offset) for k in drawn], shape)
    blocked = float(free.max()) < needle.radius + _LEAST_GAP
    found = _each(glimpses, offset, matte, part, window)
    if not blocked:
        return found
    along = _BLOCKED**2 * np.outer(matte.needle.axis, matte.needle.axis)
    return replace(
        found, covariances=found.covariances + along, remark="never seen free of the part"
    )


def _each(
    glimpses: Sequence[Glimpse], offset: Floats, matte: Matte, part: Canvas | None, window: Window
) -> Refined:
    axis = matte.needle.axis
    constant = _ACROSS**2 * np.eye(2) + (_ALONG**2 - _ACROSS**2) * np.outer(axis, axis)
    unseen = _UNSEEN**2 * np.outer(axis, axis)
    tips, spreads = [], []
    for one in glimpses:
        seen = backdrop(glimpse_at(one, offset), window, matte.needle, part)
        found = place(seen, one.tip + offset, matte, window)
        apart = found.tip - one.tip - offset
        doubt = np.outer(apart, apart) if np.hypot(*apart) > _AMISS else np.zeros((2, 2))
        if part is not None and one.outline is None:
            doubt = doubt + unseen
        tips.append(found.tip)
        spreads.append(found.covariance + constant + doubt)
    return Refined(tips=np.array(tips), covariances=np.array(spreads), remark="")


def _clearance(one: Glimpse) -> float:
    """Distance of the tip from the part, at most `_CLEAR`, px."""
    if one.outline is None:
        return _CLEAR
    at = (float(one.tip[0]), float(one.tip[1]))
    return min(-cv2.pointPolygonTest(one.outline.astype(np.float32), at, True), _CLEAR)


def _spread(order: npt.NDArray[np.int64], free: Floats) -> npt.NDArray[np.int64]:
    """The clearest frames, evenly over time if there are more than needed."""
    clear = np.flatnonzero(free >= _CLEAR)
    if len(clear) <= LEAST:
        return order[:LEAST]
    return np.asarray(clear[np.linspace(0, len(clear) - 1, LEAST).astype(int)])
