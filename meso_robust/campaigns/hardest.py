"""The hardest runs of a part: kept to the last bit, and drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meso_robust import units
from meso_robust.campaigns.kind import Paths
from meso_robust.laboratory.making import outline
from meso_robust.laboratory.replay import Player
from meso_robust.laboratory.running import PlanRun
from meso_robust.types import Floats, Indices

HARDEST = 3  # runs that are kept of a chunk


def hardest(away: Floats) -> Indices:
    """(HARDEST,) or fewer runs that end farthest from the middle of the goal; NaN (N,) is no end."""
    known = np.flatnonzero(~np.isnan(away))
    return known[np.argsort(-away[known], kind="stable")][:HARDEST]


def hexadecimal(row: Floats) -> list[str]:
    """Doubles to their last bit."""
    return [float(value).hex() for value in row]


def row_of(text: Sequence[str]) -> Floats:
    """The inverse of :func:`hexadecimal`."""
    return np.array([float.fromhex(value) for value in text])


def paths(title: str, player: Player, runs: PlanRun, labels: Sequence[str]) -> Paths:
    """Runs with a recorded path, as they are drawn.

    Parameters
    ----------
    title, labels
        Of the picture, and of each run.
    player, runs
        What was run, and N runs of it.
    """
    goal = player.setup.goal
    poses = np.concatenate([move.path for move in runs.moves], axis=1)
    scale = np.array([units.UM, units.UM, units.DEG])
    x, y, theta = np.array(goal.mid) / scale
    half = (0.5 * (goal.x.hi - goal.x.lo), 0.5 * (goal.theta.hi - goal.theta.lo))
    return Paths(
        title=title,
        part_um=tuple((float(a), float(b)) for a, b in outline(player.setup) / units.UM),
        goal=(float(x), float(y), float(theta)),
        tolerance=(half[0] / units.UM, half[1] / units.DEG),
        runs=tuple(
            (label, tuple((float(a), float(b), float(c)) for a, b, c in one / scale))
            for label, one in zip(labels, poses, strict=True)
        ),
    )
