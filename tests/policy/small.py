"""A small policy that is built once for all tests, and parts of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from meso_robust.policy.build import make_policy
from meso_robust.policy.cells import Policy, sensed_poses
from meso_robust.policy.cover import ends_of
from meso_robust.primitives.setup import setup_of
from tests.strategies import paper_task


def built() -> Policy:
    """No pushes along +x, at most one quarter turn and four moves."""
    return make_policy(paper_task(), headings=("-x", "-y", "+y"), quarters=(0, -1), most_moves=4)


def from_starts(policy: Policy, starts: Sequence[tuple[float, float, float]]) -> Policy:
    """The cells that may answer a pose that is sensed first, or any after it: few to prove again.

    Parameters
    ----------
    policy
        All cells.
    starts
        x, y, theta in m and rad, of the world's frame.
    """
    setup = setup_of(policy.task)
    low, high = ends_of([cell.sensed for cell in policy.cells])
    moves = np.array([cell.moves for cell in policy.cells])
    to_see = [(np.array(start), np.array(start), int(moves.max()) + 1) for start in starts]
    found: set[int] = set()
    while to_see:
        least, most, left = to_see.pop()
        answering = ((low <= most) & (least <= high)).all(axis=1) & (moves < left)
        for k in set(np.flatnonzero(answering).tolist()) - found:
            found.add(k)
            if not policy.cells[k].ends:
                to_see.append((*sensed_poses(policy.cells[k].post, setup).ends, int(moves[k])))
    return replace(policy, cells=tuple(policy.cells[k] for k in sorted(found)))
