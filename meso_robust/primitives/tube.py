"""Tubes: every pose that the part can have during a move, as slices one after the other."""

from __future__ import annotations

import numpy as np

from meso_robust.bounds import Box
from meso_robust.bounds.implicit import Implicit, bound_slices
from meso_robust.motion.one_tip import POSE
from meso_robust.primitives.base import pose_of
from meso_robust.primitives.obligation import Knot

SLICES = 8  # of a turn about one tip, a power of 2; more only make the boxes of a turn narrower
WAY = (*((k / SLICES, (k + 1) / SLICES) for k in range(SLICES)), (1.0, 1.0))
"""Shares of a turn, and its very end."""


def turn_tube(of: Implicit, box: Box, guess: float) -> tuple[Knot, ...]:
    """Slices of a turn about one sticking tip, from its touch on.

    Parameters
    ----------
    of
        Where the part is when a share of the turn is done.
    box
        The base parameters of the move.
    guess
        About the direction of the edge at the end, rad.

    Returns
    -------
    tuple[Knot, ...]
        One for each share of the turn, and one for its very end; none where they could not be
        enclosed.
    """
    slices = [pose_of(ends) for ends in bound_slices(of, box, guess, "share", WAY, POSE)]
    if not all(np.isfinite(pose.ends).all() for pose in slices):
        return ()
    return tuple(Knot(stage="one tip turns the part", box=pose) for pose in slices)
