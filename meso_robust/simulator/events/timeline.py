"""Phases of one run, for people and plots."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.simulator.events.scene import POINT, WALL
from meso_robust.types import Floats, Ints


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Timeline:
    """K intervals of one run in which the mode of every contact stays the same.

    Modes are 0 separate, 1 stick, 2 and 3 slip. The part slips over a tip in its counter-clockwise
    direction in mode 2 and clockwise in mode 3; at a wall it slips with the solid of the fixture on
    its left in mode 3, on its right in mode 2. Without friction a slip is always shown as mode 2.
    """

    times: Floats
    """(K,) starts of the intervals as parts of the move."""
    poses: Floats
    """(K, 3) poses at the starts, in m and rad."""
    modes: npt.NDArray[np.int8]
    """(K, P) modes of the tips; of a tip that touches in two places, that of the first closed."""
    tip_edges: Ints
    """(K, P) edge (by its first corner) that each tip is on, −1 if it is on none; a disc or point
    tip on a corner has −2 − corner."""
    pairs: tuple[tuple[str, int, int], ...]
    """Pairs of part and fixture that were in contact: ``("corner", i, f)`` is corner i of the part
    on edge f of the fixture, ``("edge", q, j)`` convex corner q of the fixture on edge j of the
    part; edges of the fixture are counted through all its polygons."""
    pair_modes: npt.NDArray[np.int8]
    """(K, C) modes of the pairs."""


def make_timeline(starts: Floats, contacts: Ints, movers: int) -> Timeline:
    """Arrange the log of a run.

    Parameters
    ----------
    starts
        (K, 4) parts of the move and poses.
    contacts
        (K, M, 4) kind, tip or corner, edge or corner, and mode.
    movers
        Number of tips; higher numbers are corners of the fixture.

    Returns
    -------
    Timeline
        The same, by tips and pairs.
    """
    count = len(starts)
    modes = np.zeros((count, movers), dtype=np.int8)
    edges = np.full((count, movers), -1, dtype=np.int64)
    at_fixture: dict[tuple[str, int, int], dict[int, int]] = {}
    for k, row in enumerate(contacts):
        for kind, first, second, mode in row.tolist():
            if mode <= 0:
                continue
            if kind == WALL:
                at_fixture.setdefault(("corner", first, second), {})[k] = mode
            elif first >= movers:
                at_fixture.setdefault(("edge", first - movers, second), {})[k] = mode
            elif modes[k, first] == 0:
                modes[k, first] = mode
                edges[k, first] = second if kind not in (1, POINT) else -2 - second
    pair_modes = np.zeros((count, len(at_fixture)), dtype=np.int8)
    for c, found in enumerate(at_fixture.values()):
        for k, mode in found.items():
            pair_modes[k, c] = mode
    return Timeline(
        times=starts[:, 0],
        poses=starts[:, 1:],
        modes=modes,
        tip_edges=edges,
        pairs=tuple(at_fixture),
        pair_modes=pair_modes,
    )
