"""Fixtures: solids at rest that the part may touch, and those of the paper's Fig. 1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.simulator.outline import check_outline, refuse
from meso_robust.types import Floats

SLOT_WIDTH = 976e-6
"""m; the narrow channel of the paper's Section IV, the 137 µm clearance of Section VII wider than the
part is."""
CHANNEL_WIDTH = 1936e-6
"""m; the wide channel of Section IV."""
PLAYPEN = (16.3e-3, 11.5e-3)
"""m; the playpen by the inches of Section IV. The millimetres printed beside them are a tenth, too
small for the part to turn in; see derivations/printed_numbers.py."""
_THICK = 1e-3  # m, of walls: the part cannot pass through them in one step


@dataclass(frozen=True, slots=True, eq=False)
class Fixture:
    """Solids at rest.

    Attributes
    ----------
    outlines
        Corners (K, 2) in m, world frame, of each solid, which lies on the left of the edges:
        counter-clockwise for a block, clockwise for walls around a free space.
    friction
        μ between part and fixture.

    Raises
    ------
    ValueError
        If an outline is not a simple polygon, or μ is negative or not finite.
    """

    outlines: tuple[Floats, ...] = ()
    friction: float = 0.0

    def __post_init__(self) -> None:
        """Copy, freeze and check."""
        if not 0.0 <= self.friction < np.inf:
            refuse("fixture.friction", f"{self.friction}", "must not be negative", "give μ")
        copies = []
        for k, outline in enumerate(self.outlines):
            array = np.array(outline, dtype=np.float64)
            check_outline(f"fixture.outlines[{k}]", array)
            array.flags.writeable = False
            copies.append(array)
        object.__setattr__(self, "outlines", tuple(copies))


def playpen(
    centre: tuple[float, float], size: tuple[float, float] = PLAYPEN, *, friction: float
) -> Fixture:
    """Four walls around a rectangle.

    Parameters
    ----------
    centre
        Centre of the free space, m.
    size
        Its sides along x and y, m.
    friction
        μ between part and walls.
    """
    x, y = 0.5 * size[0], 0.5 * size[1]
    corners = np.array([[-x, -y], [-x, y], [x, y], [x, -y]]) + centre
    return Fixture((corners,), friction)


def channel(
    centre: tuple[float, float], length: float, width: float = CHANNEL_WIDTH, *, friction: float
) -> Fixture:
    """Two walls along x.

    Parameters
    ----------
    centre
        Centre of the free space, m.
    length, width
        Of the free space along x and across it, m.
    friction
        μ between part and walls.
    """
    x, y = 0.5 * length, 0.5 * width
    upper = np.array([[-x, y], [x, y], [x, y + _THICK], [-x, y + _THICK]])
    return Fixture((upper + centre, -upper + centre), friction)


def slot(
    mouth: tuple[float, float],
    depth: float,
    width: float = SLOT_WIDTH,
    *,
    approach: float = CHANNEL_WIDTH,
    lead: float = 4e-3,
    friction: float,
) -> Fixture:
    """A slot along −x that opens into a wider channel, the hole of the peg-in-the-hole task.

    Parameters
    ----------
    mouth
        Middle of the mouth, m.
    depth, width
        Of the slot along −x from the mouth and across, m.
    approach, lead
        Width and length of the channel before the mouth, m.
    friction
        μ between part and walls.

    Returns
    -------
    Fixture
        One solid body around slot and channel.

    Raises
    ------
    ValueError
        If the slot is wider than the channel.
    """
    if not width < approach:
        refuse("width", f"{width} m", f"must be less than the channel's {approach} m", "narrow it")
    a, b, out = 0.5 * width, 0.5 * approach, 0.5 * approach + _THICK
    corners = np.array(
        [
            [lead, b], [0.0, b], [0.0, a], [-depth, a], [-depth, -a], [0.0, -a], [0.0, -b],
            [lead, -b], [lead, -out], [-depth - _THICK, -out], [-depth - _THICK, out], [lead, out],
        ]
    )  # fmt: skip
    return Fixture((corners[::-1] + mouth,), friction)
