"""Would any wiggle of this size do? The named signature, put where it does not belong.

A decoy has the signature of every recording on another recording and in a wrong frame: turned by a
multiple of 90°, or mirrored, independently for each recording. The share of decoys that explain as much as the
signature itself is how often a name of this form would win by chance (the idea of knockoffs).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.diagnosis.signatures import estimate
from meso_robust.diagnosis.tangent import Tangent
from meso_robust.types import Floats

COUNT = 49
"""Decoys that are drawn."""


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


def _elsewhere(count: int, rng: np.random.Generator) -> npt.NDArray[np.int64]:
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
