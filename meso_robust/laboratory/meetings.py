"""Where tips meet the part, by plain geometry and the film's law, apart from proof and simulator."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.kernels import inlined
from meso_robust.laboratory.geometry import frames, turned
from meso_robust.types import Flags, Floats

CORNER = -1
"""In place of an edge: the tip meets a corner."""


class Meetings(NamedTuple):
    """Where each tip of N runs meets a part at rest."""

    share: Floats
    """(N, P) legs made until then, with the part of the last; infinite if it never does."""
    edge: npt.NDArray[np.int64]
    """(N, P) edge that it meets, by its first corner, or `CORNER`."""
    along: Floats
    """(N, P) where on that edge, from its first corner, m."""


def meets(ways: Floats, radii: Floats, poses: Floats, outlines: Floats) -> Meetings:
    """Where tips that travel along straight legs meet parts at rest.

    Parameters
    ----------
    ways
        (N, L + 1, P, 2) ends of the legs of the tips' centres, m; they start outside the parts.
    radii
        (N, P) of the tips, m.
    poses, outlines
        (N, 3) of the parts, and (N, V, 2) their corners, m.

    Returns
    -------
    Meetings
        The first of each.
    """
    found = Meetings(
        np.full(radii.shape, np.inf), np.full(radii.shape, CORNER), np.zeros(radii.shape)
    )
    _find_meetings(
        np.ascontiguousarray(ways), frames(poses), np.ascontiguousarray(radii), outlines, *found
    )
    return found


@njit(cache=True, nogil=True)
def _find_meetings(
    ways: Floats,
    parts: Floats,
    radii: Floats,
    outlines: Floats,
    shares: Floats,
    edges: npt.NDArray[np.int64],
    alongs: Floats,
) -> None:
    """Write what `meets` finds; of the parts `frames`."""
    for i in range(ways.shape[0]):
        for tip in range(ways.shape[2]):
            for leg in range(ways.shape[1] - 1):
                found = _on_a_leg(ways, parts, radii, outlines, (i, leg, tip))
                if found[0] < np.inf:
                    shares[i, tip] = leg + found[0]
                    edges[i, tip], alongs[i, tip] = found[1], found[2]
                    break


@inlined
def _on_a_leg(
    ways: Floats, parts: Floats, radii: Floats, outlines: Floats, which: tuple[int, int, int]
) -> tuple[float, int, float]:
    """Share of a leg, edge and place at which a tip meets a part first; see `Meetings`."""
    i, leg, tip = which
    cos, sin, r, count = parts[i, 2], parts[i, 3], radii[i, tip], outlines.shape[1]
    ax, ay = ways[i, leg, tip, 0] - parts[i, 0], ways[i, leg, tip, 1] - parts[i, 1]
    bx, by = ways[i, leg + 1, tip, 0] - parts[i, 0], ways[i, leg + 1, tip, 1] - parts[i, 1]
    x, y = cos * ax + sin * ay, cos * ay - sin * ax
    wx, wy = cos * bx + sin * by - x, cos * by - sin * bx - y
    first, edge, place = np.inf, CORNER, 0.0
    for j in range(count):
        after = j + 1 if j + 1 < count else 0
        dx, dy = x - outlines[i, j, 0], y - outlines[i, j, 1]
        ex = outlines[i, after, 0] - outlines[i, j, 0]
        ey = outlines[i, after, 1] - outlines[i, j, 1]
        length = np.hypot(ex, ey)
        closing = (ex * wy - ey * wx) / length
        gap = (ey * dx - ex * dy) / length - r
        if closing > 0.0 and 0.0 <= gap <= closing and gap / closing < first:
            share = gap / closing
            along = ((dx + share * wx) * ex + (dy + share * wy) * ey) / length
            if 0.0 <= along <= length:
                first, edge, place = share, j, along
        # the disc about the corner
        square, half = wx * wx + wy * wy, dx * wx + dy * wy
        rest = half * half - square * (dx * dx + dy * dy - r * r)
        if r > 0.0 and half < 0.0 < rest:
            share = (-half - np.sqrt(rest)) / square
            if 0.0 <= share <= 1.0 and share < first:
                first, edge, place = share, CORNER, 0.0
    return first, edge, place


def crosses(
    tips: Floats, ways: Floats, radii: Floats, poses: Floats, outlines: Floats, within: float
) -> Flags:
    """Whether straight ways of tips that start outside go through parts at rest.

    Parameters
    ----------
    tips, ways
        (N, P, 2) starts and displacements of the tips, m.
    radii
        (N, P) m.
    poses, outlines
        (N, 3) of the parts, and (N, V, 2) their corners, m.
    within
        How deep a tip may be in the part, m: one that leaves its edge along it crosses nothing.

    Returns
    -------
    Flags
        (N,) whether any of the tips does.
    """
    legs = np.stack([tips, tips + ways], axis=1)
    share = meets(legs, radii - within, poses, outlines).share
    return np.asarray(np.isfinite(share).any(axis=1))


def stick_ratio(
    point: Floats, normal: Floats, way: Floats, pose: Floats, film_ratio: Floats
) -> Floats:
    """Friction over normal force of one contact that sticks while its tip moves.

    Parameters
    ----------
    point, normal
        (N, 2) contact and inward normal of its edge, part's axes, m.
    way
        (N, 2) displacement of the tip, world frame, m; its length does not matter.
    pose
        (N, 3) of the part, m and rad.
    film_ratio
        (N,) rho, m^2.

    Returns
    -------
    Floats
        (N,) infinite where the tip would have to pull.

    Notes
    -----
    The film drags with ``F = v`` and the moment ``film_ratio * omega``; the contact moves with the tip,
    so that ``F + (q . F / film_ratio) q = u`` with ``q`` the point turned by 90 deg: eq. (5) of the
    paper, derived anew.
    """
    u = turned(way / np.linalg.norm(way, axis=1, keepdims=True), pose)
    q = np.stack([-point[:, 1], point[:, 0]], axis=1)
    force = u - q * (np.sum(q * u, axis=1) / (film_ratio + np.sum(q * q, axis=1)))[:, None]
    along = force[:, 1] * normal[:, 0] - force[:, 0] * normal[:, 1]
    inward = np.sum(force * normal, axis=1)
    with np.errstate(divide="ignore"):
        return np.where(inward > 0.0, np.abs(along) / inward, np.inf)
