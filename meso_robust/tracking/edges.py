"""Where a part's outline lies in an image, from grey values along its normals.

A profile across the outline shows background, etched rim and metal. Its derivative is compared with
a pattern (:mod:`meso_robust.tracking.edge_pattern`) - first a single step, then what the part's own
outline showed - so that a rim band or a halo is part of it instead of a second edge. The pattern is the same for all sides:
a bias that it has is a common displacement δ along the outward normal, and a uniform pressure on a
closed outline has neither a resultant nor a moment, so δ changes no pose while the outline is seen
whole. Where some of it is hidden, δ is estimated along with the pose.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from meso_robust.tracking.covariance import clustered, side_modes, systematic
from meso_robust.tracking.edge_pattern import PATTERN_HALF, STEP, Pattern, learned
from meso_robust.tracking.sampling import Patch, derivatives
from meso_robust.types import Flags, Floats, Ints

Map = Callable[[Floats], Floats]

SPACING = 3.0
"""Distance in px of the points along the outline: as far as a profile is averaged."""
CORNER = 6.0
"""Distance in px kept from corners: etching rounds them and blur mixes the two sides."""
CLUSTER = 6
"""Points in a run that errors are taken to share: 18 px, two blocks of compression."""
ALIKE = 0.5
"""Least normalised correlation of a profile with the pattern to count as the outline."""
_LEAST_SCALE = 0.05  # px, of residuals: quantisation and texture leave no less
_TOLD = 1e6  # condition of what tells a size: 1e1 to 1e3 where it is told, 1e15 where it is not


@dataclass(frozen=True, slots=True)
class Lens:
    """Seen pixels to ideal ones, free of distortion, and back.

    Attributes
    ----------
    to_ideal, to_image
        Maps of (N, 2) px to (N, 2) px, each the other's inverse; None: the lens is ideal.
    """

    to_ideal: Map | None = None
    to_image: Map | None = None

    def seen(self, points: Floats) -> Floats:
        """(N, 2) px of the image where ideal ``points`` are seen."""
        return points if self.to_image is None else self.to_image(points)

    def ideal(self, points: Floats) -> Floats:
        """(N, 2) ideal px of ``points`` of the image."""
        return points if self.to_ideal is None else self.to_ideal(points)


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """Points on a part's outline, in ideal px of its own frame (v down).

    Attributes
    ----------
    corners
        (V, 2).
    points, normals
        (N, 2), and the unit outward normals there.
    side
        (N,) the side that each point lies on.
    design
        (N, 4) displacement along the normal per unit of (u, v, angle, δ), the first two along
        the axes of the part's frame.
    moves
        (N, 3) the first three of them.
    starts
        First point of every run of CLUSTER points along one side: errors within one are correlated.
    modes
        (2 S, N) the sides displaced or tilted as a whole (:func:`covariance.side_modes`).
    """

    corners: Floats
    points: Floats
    normals: Floats
    side: Ints
    design: Floats
    moves: Floats
    starts: Ints
    modes: Floats


class Matched(NamedTuple):
    """Edges found along normals.

    Attributes
    ----------
    offset
        (N,) px outward of the outline; NaN where the profile is not visible.
    quality
        (N,) normalised correlation with the pattern, 0...1.
    polarity
        (N,) +1 or -1: as the pattern, or dark and bright exchanged.
    """

    offset: Floats
    quality: Floats
    polarity: Floats


class EdgeFit(NamedTuple):
    """A pose from edges.

    Attributes
    ----------
    pose
        (3,) u, v in ideal px and angle in rad.
    delta
        Common outward displacement in px of what was found.
    residual, weight
        (N,) px along the normals, and the robust weights (0: not used).
    visible
        (N,) whether a profile could be taken at all.
    """

    pose: Floats
    delta: float
    residual: Floats
    weight: Floats
    visible: Flags


def rotation(angle: float) -> Floats:
    """(2, 2) matrix from the part's frame to the image."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


def placed(points: Floats, pose: Floats) -> Floats:
    """(N, 2) ``points`` of the part in ideal px of the image, for a pose (3,)."""
    from meso_robust.tracking.sampling_kernels import placed as fill

    turn = math.cos(pose[2]), math.sin(pose[2])
    return fill(points, turn, (float(pose[0]), float(pose[1])))


def moved(pose: Floats, motion: Floats) -> Floats:
    """The pose (3,) after a motion (u, v, angle, ...) along the axes of the part's frame."""
    return np.append(pose[:2] + rotation(pose[2]) @ motion[:2], pose[2] + motion[2])


def sampled_outline(corners: Floats) -> Outline:
    """Points on the outline ``corners`` (V, 2) px, in either order, away from the corners.

    Sides too short to keep away from both corners carry no points.
    """
    ends = np.roll(corners, -1, axis=0)
    u, v = corners.T
    turn = np.sign(np.sum(u * ends[:, 1] - v * ends[:, 0]))
    points, normals, sides = [], [], []
    for index, (start, end) in enumerate(zip(corners, ends, strict=True)):
        length = float(np.hypot(*(end - start)))
        count = int((length - 2.0 * CORNER) // SPACING)
        if count < 1:
            continue
        along = (end - start) / length
        at = 0.5 * length + SPACING * (np.arange(count) - 0.5 * (count - 1))
        points.append(start + at[:, None] * along)
        normals.append(np.tile(turn * np.array([along[1], -along[0]]), (count, 1)))
        sides.append(np.full(count, index))
    return _outline(corners, np.concatenate(points), np.concatenate(normals), np.concatenate(sides))


def thinned(outline: Outline) -> Outline:
    """Every second point of each side of an outline: no side goes without any."""
    first = np.searchsorted(outline.side, outline.side)
    kept = (np.arange(len(outline.side)) - first) % 2 == 0
    return _outline(
        outline.corners, outline.points[kept], outline.normals[kept], outline.side[kept]
    )


def _outline(corners: Floats, p: Floats, n: Floats, side: Ints) -> Outline:
    """Of points (N, 2), their normals and sides."""
    moment = p[:, 0] * n[:, 1] - p[:, 1] * n[:, 0]
    design = np.column_stack((n, moment, np.ones(len(p))))
    first = np.searchsorted(side, side)
    starts = np.flatnonzero((np.arange(len(side)) - first) % CLUSTER == 0)
    moves = np.ascontiguousarray(design[:, :3])
    return Outline(corners, p, n, side, design, moves, starts, side_modes(side))


def seen_normals(outline: Outline, pose: Floats, lens: Lens) -> tuple[Floats, Floats, Floats]:
    """The outline's points in ideal px and in seen px, and the unit normals in the seen image."""
    q = placed(outline.points, pose)
    n = outline.normals @ rotation(pose[2]).T
    if lens.to_image is None:
        return q, q, n
    seen = lens.seen(q)
    direction = lens.seen(q + n) - seen
    return q, seen, direction / np.linalg.norm(direction, axis=1, keepdims=True)


def slopes(of: Patch, seen: Floats, normals: Floats, reach: float) -> Floats:
    """(N, K) derivative of the profiles, long enough to move a pattern by ``reach`` px."""
    half = PATTERN_HALF + math.ceil(reach / STEP) + 1
    return derivatives(of, seen, normals, half, STEP)


def matched(derivative: Floats, pattern: Pattern) -> Matched:
    """Where each profile agrees best with ``pattern``, either way round."""
    from meso_robust.tracking.fit_kernels import match

    filters = np.empty((0, 0)) if pattern.filters is None else pattern.filters
    found = Matched(*np.empty((3, len(derivative))))
    match(derivative, pattern.mean, filters, STEP, *found)
    return found


def robust_fit(
    design: Floats, offset: Floats, quality: Floats, delta_sigma: float
) -> tuple[Floats, Floats]:
    """Solution (k,) of weighted least squares and its weights (N,), by reweighting.

    ``delta_sigma`` in px is how well δ, the fourth, is known to be zero beforehand; what does not look like the
    outline (quality below ALIKE) has no weight.
    """
    from meso_robust.tracking.fit_kernels import reweighted

    weight = np.where(np.isfinite(offset) & (quality >= ALIKE), quality**2, 0.0)
    solution, rows = np.zeros(design.shape[1]), np.flatnonzero(weight)
    reweighted(design, offset, rows, delta_sigma, _LEAST_SCALE, solution, weight)
    return solution, weight


def edge_fit(
    of: Patch,
    outline: Outline,
    pose: Floats,
    lens: Lens,
    pattern: Pattern,
    reach: float,
    delta_sigma: float,
) -> EdgeFit:
    """One step towards the pose from the edges within ``reach`` px of the outline at ``pose``."""
    offset, quality = _offsets(of, outline, pose, lens, pattern, reach)
    solution, weight = robust_fit(outline.design, offset, quality, delta_sigma)
    residual = np.nan_to_num(offset) - outline.design @ solution
    return EdgeFit(moved(pose, solution), float(solution[3]), residual, weight, np.isfinite(offset))


def seen_size(
    of: Patch,
    outline: Outline,
    pose: Floats,
    lens: Lens,
    pattern: Pattern,
    reach: float,
    delta_sigma: float,
) -> tuple[float, float]:
    """By how much longer than stated the part is seen, as a share of its lengths; and the standard deviation.

    Of a part as wide as it is long, that is the same as an outline displaced alike on all sides, and is not told. Nor
    is it where two opposite sides are nowhere both seen: then it is 0, with an infinite standard deviation.
    """
    offset, quality = _offsets(of, outline, pose, lens, pattern, reach)
    design = np.column_stack((outline.design, np.sum(outline.points * outline.normals, axis=1)))
    solution, weight = robust_fit(design, offset, quality, delta_sigma)
    seen = (design / np.abs(design).max(axis=0)) * np.sqrt(weight)[:, None]
    if not np.linalg.cond(seen) < _TOLD:
        return 0.0, math.inf
    residual = np.nan_to_num(offset) - design @ solution
    sides = systematic(design, weight, residual, outline.modes)
    variance = clustered(design, weight, residual, outline.starts)[4, 4]
    variance += float(np.sum((sides.sigma * sides.response[:, 4]) ** 2))
    # what the size takes of a displacement that was held to be small beforehand
    normal = (design * weight[:, None]).T @ design
    left = np.abs(residual[weight > 0.0])
    scale = 1.4826 * float(np.median(left)) if left.size else 1.0
    prior = (max(scale, _LEAST_SCALE) / delta_sigma) ** 2
    normal[3, 3] += prior
    taken = delta_sigma * prior * np.linalg.pinv(normal, hermitian=True)[4, 3]
    return float(solution[4]), math.sqrt(variance + taken**2)


def _offsets(
    of: Patch, outline: Outline, pose: Floats, lens: Lens, pattern: Pattern, reach: float
) -> tuple[Floats, Floats]:
    """(N,) ideal px outward of the outline at which edges are found, NaN where not visible; and quality."""
    q, seen, normals = seen_normals(outline, pose, lens)
    found = matched(slopes(of, seen, normals, reach), pattern)
    offset = found.offset
    if lens.to_ideal is not None:
        n = outline.normals @ rotation(pose[2]).T
        at = seen + np.nan_to_num(offset)[:, None] * normals
        offset = np.where(np.isfinite(offset), np.sum((lens.ideal(at) - q) * n, axis=1), np.nan)
    return offset, found.quality


def learned_pattern(of: Patch, outline: Outline, pose: Floats, lens: Lens) -> Pattern:
    """How the outline looks across at a pose (3,), all sides alike."""
    _, seen, normals = seen_normals(outline, pose, lens)
    derivative = derivatives(of, seen, normals, PATTERN_HALF + 1, STEP)
    visible = np.isfinite(derivative).all(axis=1)
    return learned(derivative[visible], outline.side[visible])
