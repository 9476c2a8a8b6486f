"""What lies behind a needle at the part's edge: the edge's mean brightness across it, from beside.

Where a tip touches the part, its outline is seen before film, meniscus, rim and metal. All of these run
along the edge, so that their brightness is known from the edge on either side of the needle, and so is
how much it varies there, which says how far it can be trusted.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import cv2
import numpy as np

from meso_robust.tracking.needle import Needle
from meso_robust.types import Floats, Image, Ints, Singles

if TYPE_CHECKING:
    from meso_robust.tracking.edge_profile_kernels import Sides

_REACH = 12.0  # px to either side of the edge that differ from the film
_NEAR, _FAR = 5.0, 40.0  # px from the needle; from the foot, that an edge is read over
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
        from meso_robust.tracking.edge_profile_kernels import across

        change = np.zeros(len(self.rows), np.float32)
        variance = np.full(len(self.rows), _NOISE * _UNKNOWN, np.float32)
        distance = self.distance + self.normals @ shift
        across(distance, self.edge, self.profiles, DISTANCES[0], (change, variance))
        return change, variance / np.float32(_NOISE)


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
    from meso_robust.tracking.edge_profile_kernels import extent, nearest, sides

    rows = _near(outline, places)
    if not len(rows):
        return None
    border = sides(outline)
    about = places[rows]
    distance, normals, nearby, edge = nearest(border, about)
    box = extent(about)
    found = {
        one: _rays(frame.shape, border, one, box, needle) for one in np.unique(nearby).tolist()
    }
    rays = {one: places for one, places in found.items() if places is not None}
    index = np.full(int(nearby.max()) + 2, -1)  # the last is for those beside a corner
    index[list(rays)] = np.arange(len(rays))
    return Behind(
        rows=rows,
        distance=distance,
        normals=normals,
        edge=index[edge],
        profiles=_profiles(frame, rays.values()),
        rays=tuple(rays.values()),
    )


def _near(outline: Floats, places: Floats) -> Ints:
    """Which places are within reach of the border."""
    from meso_robust.tracking.edge_profile_kernels import extent, within

    box = extent(places)
    low = np.floor(box[0]) - 1.0
    size = (np.ceil(box[1]) - low).astype(int) + 2
    band = np.zeros((int(size[1]), int(size[0])), np.uint8)
    local = np.rint((outline - low) * 16.0).astype(np.int32)
    cv2.polylines(band, [local], True, 1, 2 * int(_REACH) - 1, cv2.LINE_8, 4)
    return within(band, places, low)


def _rays(
    shape: tuple[int, ...], border: Sides, edge: int, box: Floats, needle: Needle
) -> Singles | None:
    """(L, D, 2) places across an edge, beside the needle, where its brightness is read, or None."""
    from meso_robust.tracking.edge_profile_kernels import rays

    reach = _FAR + 0.5 * float((box[1] - box[0]).max())
    at = rays(border, edge, 0.5 * (box[0] + box[1]), reach, _APART, DISTANCES)
    s, n = needle.along_across(at[..., 0], at[..., 1])
    free = np.all(needle.distance(s, n) > _NEAR, axis=1)
    height, width = shape
    free &= np.all((at >= 1.0) & (at <= (width - 2.0, height - 2.0)), axis=(1, 2))
    return at[free].astype(np.float32) if free.sum() >= _LEAST else None


def _profile(frame: Image | Singles, rays: Singles) -> Floats:
    """(2, D) mean change from film and its variance over the distance from an edge."""
    read = cv2.remap(frame, rays[..., 0], rays[..., 1], cv2.INTER_LINEAR).astype(float)
    change = read - np.partition(read[:, -3:], 1, axis=1)[:, 1:2]
    return np.stack([change.mean(axis=0), change.var(axis=0) * (1.0 + 1.0 / len(change))])


def _profiles(frame: Image | Singles, rays: Iterable[Singles]) -> Floats:
    read = [_profile(frame, places) for places in rays]
    return np.array(read).reshape(-1, 2, len(DISTANCES))
