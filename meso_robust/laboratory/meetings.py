"""Where tips meet the part, by plain geometry and the film's law, apart from proof and simulator."""

from __future__ import annotations

import numpy as np

from meso_robust.laboratory.geometry import in_part, turned
from meso_robust.types import Flags, Floats


def _slabs(tip: Floats, way: Floats, pose: Floats, half: Floats) -> tuple[Floats, Floats]:
    """(..., 2) shares of the way at which a tip enters and leaves each of the part's two slabs."""
    own, along = in_part(tip, pose), turned(way, pose)
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (-half - own) / along, (half - own) / along
    return np.minimum(one, other), np.maximum(one, other)


def arrives(tip: Floats, way: Floats, pose: Floats, half: Floats) -> Floats:
    """(...) part of the way until a tip meets a part at rest; see `meets`, for any leading shape."""
    return _share(*_slabs(tip, way, pose, half))


def _share(enters: Floats, leaves: Floats) -> Floats:
    share = np.maximum(enters[..., 0], enters[..., 1])
    hits = (share < np.minimum(leaves[..., 0], leaves[..., 1])) & (share >= 0.0)
    return np.where(hits, share, np.inf)


def meets(tip: Floats, way: Floats, pose: Floats, half: Floats) -> tuple[Floats, Floats, Floats]:
    """Where a tip that travels along ``way`` meets a part at rest.

    Parameters
    ----------
    tip, way
        (N, 2) start outside the part, and displacement, m.
    pose, half
        (N, 3) of the part, (2,) half its sides.

    Returns
    -------
    share
        (N,) part of the way until it meets; infinite if it does not, even farther on.
    point
        (N, 2) where on the part, its axes, m.
    normal
        (N, 2) inward normal of the edge there, the part's axes.
    """
    enters, leaves = _slabs(tip, way, pose, half)
    last, share = enters.argmax(axis=1), _share(enters, leaves)
    point = at_share(share, tip, way, pose)
    rows = np.arange(len(tip))
    normal = np.zeros_like(point)
    normal[rows, last] = -np.sign(point[rows, last])
    return share, point, normal


def at_share(share: Floats, tip: Floats, way: Floats, pose: Floats) -> Floats:
    """(N, 2) where on the part, its axes, a tip is after a share of its way; at its start if infinite."""
    finite = np.where(np.isfinite(share), share, 0.0)[:, None]
    return np.asarray(in_part(tip, pose) + finite * turned(way, pose))


def crosses(tip: Floats, way: Floats, pose: Floats, half: Floats, within: float) -> Flags:
    """(...) whether the way of a tip goes through the part shrunk by ``within``.

    A tip in contact that leaves its edge along ``way`` does not.
    """
    enters, leaves = _slabs(tip, way, pose, half - within)
    first = np.maximum(np.maximum(enters[..., 0], enters[..., 1]), 0.0)
    return np.asarray(first < np.minimum(np.minimum(leaves[..., 0], leaves[..., 1]), 1.0))


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
