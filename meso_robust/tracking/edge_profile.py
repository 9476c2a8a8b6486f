"""What lies behind a needle at the part's edge: the edge's mean brightness across it, from beside.

Where a tip touches the part, its outline is seen before film, meniscus, rim and metal. All of these run
along the edge, so that their brightness is known from the edge on either side of the needle, and so is
how much it varies there, which says how far it can be trusted.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import cv2
import numpy as np

from meso_robust.tracking.needle import Needle
from meso_robust.types import Flags, Floats, Image, Ints, Singles

_REACH = 12.0  # px to either side of the edge that differ from the film
_NEAR, _FAR = 5.0, 40.0  # px from the needle; from the foot, that an edge is read over
_CORNER = 7.0  # px from a corner that count as neither of its edges
_STRAIGHT = 0.97  # cosine; edges that turn less are one
_NOISE = 4.0  # grey values²; what varies less does not matter
DISTANCES = np.arange(-_REACH, _REACH + 0.5, 1.0)
_LEAST = 8  # places along the edge
_APART = 3.0  # px between the places
_UNKNOWN = 1e6  # variance where nothing is known


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Behind:
    """The part's edge as it is behind the places near it.

    Attributes
    ----------
    rows
        (M,) which of the places are near the border.
    distance
        (M,) of them from it, positive outside, px.
    normals
        (M, 2) outward, of the border nearest to them.
    edge
        (M,) which profile belongs to them; −1: none, nothing is known there.
    profiles
        (K, 2, D) mean change from film and its variance, over `DISTANCES`.
    rays
        K times (L, D, 2) px, where they were read.
    """

    rows: Ints
    distance: Floats
    normals: Floats
    edge: Ints
    profiles: Floats
    rays: tuple[Singles, ...]

    def of(self, frame: Image | Singles) -> Behind:
        """The same edge in another image (H, W)."""
        return replace(self, profiles=_profiles(frame, self.rays))

    def at(self, shift: Floats) -> tuple[Singles, Singles]:
        """Change (M,) in grey values, and its variance over the noise's, after a shift (2,)."""
        distance = self.distance + self.normals @ shift
        change = np.zeros(len(self.rows), np.float32)
        variance = np.full(len(self.rows), _UNKNOWN, np.float32)
        for k, (mean, spread) in enumerate(self.profiles):
            here = self.edge == k
            change[here] = np.interp(distance[here], DISTANCES, mean)
            variance[here] = np.interp(distance[here], DISTANCES, spread) / _NOISE
        return change, variance


def behind(
    frame: Image | Singles, outline: Floats | None, places: Floats, needle: Needle
) -> Behind | None:
    """What the part's edge does to the film behind a needle.

    Parameters
    ----------
    frame
        (H, W) grey values.
    outline
        (V, 2) border of the part in seen px, or None.
    places
        (N, 2) px, on and around the needle.
    needle
        Where it is.

    Returns
    -------
    Behind or None
        None if the border is far from all places.
    """
    if outline is None:
        return None
    rows = _near(outline, places)
    if not len(rows):
        return None
    border = _border(outline)
    about = places[rows]
    sides = _close_sides(border, about)
    gap = about[:, None] - border.starts[sides]
    along = np.sum(gap * border.along[sides], axis=-1)
    within = np.clip(along, 0.0, border.lengths[sides])
    square = np.sum((gap - within[..., None] * border.along[sides]) ** 2, axis=-1)
    best = np.argmin(square, axis=1)
    each = np.arange(len(rows))
    side, normals = sides[best], border.outward[sides[best]]
    cornered = (border.sharp[side] & (within[each, best] < _CORNER)) | (
        np.roll(border.sharp, -1)[side] & (border.lengths[side] - within[each, best] < _CORNER)
    )
    edges = np.unique(border.edges[side])
    found = {edge: _rays(frame.shape, border, edge, about, needle) for edge in edges.tolist()}
    rays = {edge: places for edge, places in found.items() if places is not None}
    known = list(rays)
    index = np.full(int(border.edges.max()) + 1, -1)
    index[known] = np.arange(len(known))
    return Behind(
        rows=rows,
        distance=np.sum(gap[each, best] * normals, axis=1),
        normals=normals,
        edge=np.where(cornered, -1, index[border.edges[side]]),
        profiles=_profiles(frame, rays.values()),
        rays=tuple(rays.values()),
    )


def _near(outline: Floats, places: Floats) -> Ints:
    """Which places are within reach of the border."""
    low = np.floor(places.min(axis=0)) - 1.0
    size = (np.ceil(places.max(axis=0)) - low).astype(int) + 2
    band = np.zeros((int(size[1]), int(size[0])), np.uint8)
    local = np.rint((outline - low) * 16.0).astype(np.int32)
    cv2.polylines(band, [local], True, 1, 2 * int(_REACH) - 1, cv2.LINE_8, 4)
    at = np.rint(places - low).astype(int)
    return np.flatnonzero(band[at[:, 1], at[:, 0]])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Border:
    """The sides of the outline (V), whether each starts at a corner, and the edge that it is part of."""

    starts: Floats
    along: Floats
    outward: Floats
    lengths: Floats
    sharp: Flags
    edges: Ints


def _border(outline: Floats) -> _Border:
    sides = np.roll(outline, -1, axis=0) - outline
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    along = sides / lengths[:, None]
    x, y = outline.T
    turn = np.sign(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    sharp = np.sum(along * np.roll(along, 1, axis=0), axis=1) < _STRAIGHT
    edges = np.cumsum(sharp)
    if not sharp[0]:  # the last edge goes on over the first corner of the list
        edges[edges == edges[-1]] = 0
    return _Border(
        starts=outline,
        along=along,
        outward=turn * np.stack([along[:, 1], -along[:, 0]], axis=1),
        lengths=lengths,
        sharp=np.asarray(sharp),
        edges=np.asarray(edges),
    )


def _close_sides(border: _Border, about: Floats) -> Ints:
    """Sides whose box comes within reach of the box of some places."""
    ends = border.starts + border.lengths[:, None] * border.along
    low, high = np.minimum(border.starts, ends), np.maximum(border.starts, ends)
    near = (low < about.max(axis=0) + 2.0 * _REACH) & (high > about.min(axis=0) - 2.0 * _REACH)
    return np.flatnonzero(near.all(axis=1))


def _rays(
    shape: tuple[int, ...], border: _Border, edge: int, about: Floats, needle: Needle
) -> Singles | None:
    """(L, D, 2) places across an edge, beside the needle, where its brightness is read, or None."""
    points, normals = _along(border, edge, about)
    if len(points) < _LEAST:
        return None
    at = points[:, None] + DISTANCES[None, :, None] * normals[:, None]
    s, n = needle.along_across(at[..., 0], at[..., 1])
    free = np.all(needle.distance(s, n) > _NEAR, axis=1)
    height, width = shape
    free &= np.all((at >= 1.0) & (at <= (width - 2.0, height - 2.0)), axis=(1, 2))
    return at[free].astype(np.float32) if free.sum() >= _LEAST else None


def _profile(frame: Image | Singles, rays: Singles) -> Floats:
    """(2, D) mean change from film and its variance over the distance from an edge."""
    read = cv2.remap(frame, rays[..., 0], rays[..., 1], cv2.INTER_LINEAR).astype(float)
    change = read - np.median(read[:, -3:], axis=1, keepdims=True)
    return np.stack([change.mean(axis=0), change.var(axis=0) * (1.0 + 1.0 / len(change))])


def _profiles(frame: Image | Singles, rays: Iterable[Singles]) -> Floats:
    read = [_profile(frame, places) for places in rays]
    return np.array(read).reshape(-1, 2, len(DISTANCES))


def _along(border: _Border, edge: int, about: Floats) -> tuple[Floats, Floats]:
    """Places along an edge near some others, clear of its corners, and the outward normals there."""
    points, normals = [np.empty((0, 2))], [np.empty((0, 2))]
    after = np.roll(border.sharp, -1)
    middle = 0.5 * (about.min(axis=0) + about.max(axis=0))
    reach = _FAR + 0.5 * float(np.ptp(about, axis=0).max())
    for side in np.flatnonzero(border.edges == edge).tolist():
        start, along = border.starts[side], border.along[side]
        foot = float((middle - start) @ along)
        first = max(_CORNER if border.sharp[side] else 0.0, foot - reach)
        last = min(border.lengths[side] - (_CORNER if after[side] else 0.0), foot + reach)
        places = np.arange(first, last, _APART)
        points.append(start + places[:, None] * along)
        normals.append(np.broadcast_to(border.outward[side], (len(places), 2)))
    return np.concatenate(points), np.concatenate(normals)
