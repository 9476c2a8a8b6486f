"""What a law without physics reaches: a regression with as many numbers as the named effects have.

The residual of the plain model is taken to grow while a tip pushes on, at a rate that is linear in
speed, heading, place, time, edge or place along it, in either frame or as a turn. The columns that
explain the training recordings best are chosen one by one; the choice itself is not counted, which
favours the regression.
"""

from __future__ import annotations

import numpy as np

from meso_robust.diagnosis.cuts import tips_of
from meso_robust.diagnosis.validation import Errors
from meso_robust.identification.prepared import Prepared
from meso_robust.recordings.contact import gaps
from meso_robust.types import Floats

_NEAR = 2.0  # steps of the simulator within which a tip touches
_GONE = 1e-9  # of the length of a column: what is left of it is rounding


def black_box(training: Errors, held_out: Errors, numbers: int) -> float:
    """Error of the regression on held-out recordings, in σ per degree of freedom.

    Parameters
    ----------
    training, held_out
        Errors of the plain model on the recordings of the fit, and on others.
    numbers
        Columns that may be chosen.
    """
    known, other = _left(training), _left(held_out)
    weights = chosen(known, training.rows.ravel(), numbers)
    left = held_out.rows.ravel() - weights @ other
    return float(np.sqrt(left @ left / held_out.freedom.sum()))


def chosen(columns: Floats, data: Floats, numbers: int) -> Floats:
    """Weights (K,) of columns (K, M) for data (M,), at most so many of them not zero.

    Forward selection: at each turn the column that takes most beyond those chosen before.
    """
    weights, rest, left = np.zeros(len(columns)), columns.copy(), data.copy()
    whole = np.sum(columns**2, axis=1)
    taken: list[int] = []
    for _ in range(numbers):
        squares = np.sum(rest**2, axis=1)
        useful = squares > _GONE**2 * whole
        if not np.any(useful):
            break
        gains = np.where(useful, (rest @ left) ** 2 / np.where(useful, squares, 1.0), -1.0)
        best = int(np.argmax(gains))
        taken.append(best)
        way = rest[best] / np.sqrt(squares[best])
        left = left - (way @ left) * way
        rest = rest - np.outer(rest @ way, way)
        rest[best] = 0.0
    weights[taken] = np.linalg.lstsq(columns[taken].T, data, rcond=None)[0] if taken else 0.0
    return weights


def _left(of: Errors) -> Floats:
    """(K, R M) of the white columns, what the starts take projected out."""
    grown = columns_of(of.prepared, of.poses)
    left = of.at.cleaned(of.at.rows(np.where(of.at.seen, grown, 0.0)))
    return np.asarray(left.reshape(len(grown), -1))


def columns_of(prepared: Prepared, poses: Floats) -> Floats:
    """(K, R, T, 3) growing residuals, lengths over the part's; a column for each rate and direction.

    Parameters
    ----------
    prepared
        R recordings.
    poses
        (R, T, 3) as the plain model has them, m and rad; NaN where nothing was seen.
    """
    tips = tips_of(prepared)
    each = [_of_one(prepared, r, _filled(poses[r]), tips[r]) for r in range(len(poses))]
    return np.stack(each, axis=1)


def _of_one(prepared: Prepared, r: int, poses: Floats, tips: Floats) -> Floats:
    """(K, T, 3) of one recording."""
    radius = max(shape.radius for shape in prepared.shapes)
    gap = gaps(prepared.outline, poses, tips, radius)
    tip, frames = np.argmin(gap, axis=1), np.arange(len(poses))
    steps = np.diff(tips, axis=0, prepend=tips[:1])[frames, tip]
    way = np.hypot(*steps.T) / prepared.length
    way[gap[frames, tip] > _NEAR * prepared.step] = 0.0
    speed = way / np.maximum(np.diff(prepared.instants[r], prepend=-1.0), 1e-9)
    edges = _edges(prepared.outline, poses, tips[frames, tip])
    scale = prepared.length
    rates = np.stack(
        [
            np.ones(len(poses)),
            speed,
            np.sin(poses[:, 2]),
            np.cos(poses[:, 2]),
            poses[:, 0] / scale,
            poses[:, 1] / scale,
            prepared.instants[r],
            *edges,
        ]
    )
    cos, sin, none = np.cos(poses[:, 2]), np.sin(poses[:, 2]), np.zeros(len(poses))
    one = none + 1.0
    directions = np.stack(
        [
            np.stack([one, none, none], axis=1),
            np.stack([none, one, none], axis=1),
            np.stack([cos, sin, none], axis=1),
            np.stack([-sin, cos, none], axis=1),
            np.stack([none, none, one], axis=1),
        ]
    )
    growth = (rates * way)[:, None, :, None] * directions[None]
    return np.asarray(np.cumsum(growth, axis=2).reshape(-1, *poses.shape))


def _edges(outline: Floats, poses: Floats, tips: Floats) -> Floats:
    """(V + 1, T) whether a tip (T, 2) is at each of V edges, and its place along the edge, −1 … 1."""
    away = tips - poses[:, :2]
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    own = np.stack([cos * away[:, 0] + sin * away[:, 1], cos * away[:, 1] - sin * away[:, 0]], 1)
    sides = np.roll(outline, -1, axis=0) - outline
    offset = own[:, None] - outline
    share = np.clip(np.sum(offset * sides, axis=2) / np.sum(sides**2, axis=1), 0.0, 1.0)
    edge = np.argmin(np.linalg.norm(offset - share[..., None] * sides, axis=2), axis=1)
    place = 2.0 * share[np.arange(len(edge)), edge] - 1.0
    return np.vstack([np.arange(len(outline))[:, None] == edge, place])


def _filled(poses: Floats) -> Floats:
    """Poses (T, 3) with what is missing interpolated."""
    frames = np.arange(len(poses))
    columns = []
    for column in poses.T:
        known = np.isfinite(column)
        columns.append(np.interp(frames, frames[known], column[known]))
    return np.stack(columns, axis=1)
