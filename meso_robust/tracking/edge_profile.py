"""What lies behind a needle at the part's edge: the edge's mean brightness across it, from beside.

Where a tip touches the part, its outline is seen before film, meniscus, rim and metal. All of these run
along the edge, so that their brightness is known from the edge on either side of the needle, and so is
how much it varies there, which says how far it can be trusted.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meso_robust.tracking.needle import Needle
from meso_robust.types import Floats, Image, Ints, Singles

_REACH = 12.0  # px to either side of the edge that differ from the film
DISTANCES = np.arange(-_REACH, _REACH + 0.5, 1.0)
# px: from the edge to what it changes; from the needle, and from the foot, to where it is read, every 3 px
_READ = np.array([_REACH - 0.5, 5.0, 40.0, 3.0])


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
    rays, counts
        (K, L, D, 2) px, where they were read, and (K,) how many of L there are.
    """

    rows: Ints
    distance: Floats
    normals: Floats
    edge: Ints
    profiles: Floats
    rays: Floats
    counts: Ints

    def of(self, frame: Image | Singles) -> Behind:
        """The same edge in another image (H, W)."""
        from meso_robust.tracking.needle_kernels import profiles

        return replace(self, profiles=profiles(frame, self.rays, self.counts))

    def here(self) -> tuple[Floats, Floats]:
        """Change (M,) in grey values, and its variance over the noise's."""
        from meso_robust.tracking.fit_kernels import across

        return across(self.distance, self.edge, self.profiles)


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
    from meso_robust.tracking.needle_kernels import border, profiles

    size = np.array(frame.shape[::-1], dtype=float)
    near, rays, counts = border(outline, places, needle.drawn(), size, _READ, len(DISTANCES))
    rows, distance, normals, edge = near
    if not len(rows):
        return None
    return Behind(
        rows=rows,
        distance=distance,
        normals=normals,
        edge=edge,
        profiles=profiles(frame, rays, counts),
        rays=rays,
        counts=counts,
    )
