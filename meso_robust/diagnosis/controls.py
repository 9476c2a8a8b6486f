"""What a name is held against: negative controls, a law without physics, and any law at all.

- Where both models predict the same (`control`), the named physics should not help. The error cannot
  change there by more than the models differ; what it says is its size. At the noise floor, the plain
  model was right where the named physics is not at work; above it, something else is missing there.
- A signature put where it does not belong (`decoys`) should explain little: would any wiggle of this
  size do? The idea is that of knockoffs.
- A regression with as many numbers as the named effects have (`black_box`), and free hidden inputs in
  every window (`catch_all`), tell what could be reached without the name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.detect import Span
from meso_robust.diagnosis.hidden_inputs import left
from meso_robust.diagnosis.signatures import estimate
from meso_robust.diagnosis.tangent import Tangent
from meso_robust.diagnosis.validation import Errors
from meso_robust.diagnosis.windows import tips_of, windowed
from meso_robust.identification.prepared import Prepared
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.contact import gaps
from meso_robust.types import Floats, Ints

SAME = 0.2
"""σ: predictions that differ by less in every frame of a span are the same."""
COUNT = 49
"""Decoys that are drawn."""
_NEAR = 2.0  # steps of the simulator within which a tip touches
_GONE = 1e-9  # of the length of a column: what is left of it is rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """Errors of both models in the spans where they predict the same.

    Attributes
    ----------
    spans
        Their number.
    sigma_before, sigma_after
        Root mean squares of seen less predicted, in σ.
    """

    spans: int
    sigma_before: float
    sigma_after: float


def control(
    pairs: Sequence[tuple[tuple[Span, ...], Errors, Errors]], sigma: Floats
) -> Control | None:
    """Compare both models where they predict the same; None if they do so nowhere.

    Parameters
    ----------
    pairs
        Of each group of recordings its spans, and the errors of the plain and of the extended model.
    sigma
        (3,) standard deviations of the noise, m and rad.
    """
    squares, count, spans = np.zeros(2), 0, 0
    for own, before, after in pairs:
        seen = before.prepared.seen
        for span in own:
            at = (span.recording, slice(span.first, span.last))
            models = [before.poses[at] / sigma, after.poses[at] / sigma]
            apart = np.abs(models[0] - models[1])
            known = np.isfinite(apart)
            if not np.any(known) or np.max(apart[known]) >= SAME:
                continue
            away = [(seen[at] / sigma - one)[known] for one in models]
            squares += [one @ one for one in away]
            count += int(known.sum())
            spans += 1
    if not spans:
        return None
    before_sigma, after_sigma = np.sqrt(squares / count)
    return Control(spans=spans, sigma_before=float(before_sigma), sigma_after=float(after_sigma))


@dataclass(frozen=True, slots=True, kw_only=True)
class Decoys:
    """How decoys of a set of effects did.

    Attributes
    ----------
    count
        Decoys.
    share
        Of them, that reach the gain of the set.
    """

    count: int
    share: float


def decoys(at: Tangent, rows: Floats, columns: Floats, seed: int) -> Decoys | None:
    """Score decoys of a set by the linear gain that the set itself has; None of one recording.

    A decoy has the signature of every recording on another recording and in a wrong frame: turned by
    a multiple of 90°, or mirrored, independently for each recording. The share of decoys that explain
    as much as the signature itself is how often a name of this form would win by chance.

    Parameters
    ----------
    at, rows
        The plain fit, and its white residuals (R, M).
    columns
        (k, R, M) signatures of the set.
    seed
        Of the decoys.
    """
    if len(rows) < 2:
        return None
    rng = np.random.default_rng([seed, 3])
    evidence = at.evidence(rows)
    drawn = [columns, *(decoy(at, columns, rng) for _ in range(COUNT))]
    own, *others = (estimate(evidence, left, False)[1] for left in at.evidence(np.stack(drawn)))
    return Decoys(count=COUNT, share=float(np.mean(np.array(others) >= own)))


def decoy(at: Tangent, columns: Floats, rng: np.random.Generator) -> Floats:
    """Columns (k, R, M) on other recordings, in frames turned or mirrored at random."""
    count, frames = at.seen.shape[:2]
    moved = columns[:, _elsewhere(count, rng)]
    poses = moved[..., : 3 * frames].reshape(len(columns), count, frames, 3)
    poses = np.einsum("krtj,rij->krti", poses, _frames(count, rng))
    poses = np.where(at.seen, poses, 0.0)
    flat = poses.reshape(len(columns), count, -1)
    return np.concatenate([flat, moved[..., 3 * frames :]], axis=2)


def _elsewhere(count: int, rng: np.random.Generator) -> Ints:
    """(R,) a cycle through all recordings: none keeps its own."""
    order = rng.permutation(count)
    where = np.empty(count, dtype=np.int64)
    where[order] = np.roll(order, 1)
    return where


def _frames(count: int, rng: np.random.Generator) -> Floats:
    """(R, 3, 3) of x, y, θ: quarter turns, half of them after a mirror."""
    turn = 0.5 * np.pi * rng.integers(0, 4, count)
    side = rng.choice([-1.0, 1.0], count)
    cos, sin = np.round(np.cos(turn)), np.round(np.sin(turn))
    found = np.zeros((count, 3, 3))
    found[:, 0, 0], found[:, 0, 1] = cos, -side * sin
    found[:, 1, 0], found[:, 1, 1] = sin, side * cos
    found[:, 2, 2] = side
    return found


def black_box(training: Errors, held_out: Errors, numbers: int) -> float:
    """Error on held-out recordings, in σ per degree of freedom, of a regression without physics.

    The residual of the plain model is taken to grow while a tip pushes on, at a rate that is linear
    in speed, heading, place, time, edge or place along it, in either frame or as a turn. The columns
    that explain the training recordings best are chosen one by one; the choice itself is not counted,
    which favours the regression.

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


def catch_all(recordings: RecordingSet, prepared: Prepared, baseline: Baseline) -> float | None:
    """Error in σ of the plain model with hidden inputs at all stages, free from window to window.

    Parameters
    ----------
    recordings, prepared
        The same recordings, such as those held out.
    baseline
        The plain model; its parameters are held.

    Returns
    -------
    float or None
        Per degree of freedom beyond starts and inputs; None if no window has enough frames.
    """
    noise = baseline.noise
    try:
        found = windowed(
            recordings,
            baseline.model,
            baseline.fits.values[0],
            noise.sigma,
            noise.correlation,
            prepared=prepared,
        )
    except ValueError:
        return None
    return left(found.found)
