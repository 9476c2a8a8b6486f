"""The slot as a push along it sees it."""

from __future__ import annotations

from dataclasses import dataclass

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.setup import HALF, ZERO, PoseBox, Setup

ACROSS = {"-x": "+x", "-y": "+y", "+x": "-x", "+y": "-y"}
"""Which way a slot opens that a push with this heading enters."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """A slot along -x of the axes of a move, m."""

    mouth_x: Interval
    mouth_y: Interval
    """Its axis."""
    half: Interval
    """Half its width."""
    depth: Interval
    """From the mouth to the end."""
    friction: Interval
    """Between wall and part."""


def channel(frame: Frame, setup: Setup) -> Channel | None:
    """The slot in the axes of a move.

    Parameters
    ----------
    frame, setup
        Of the move, and the task.

    Returns
    -------
    Channel or None
        None if there is none along the push.
    """
    slot = setup.slot
    if slot is None or not setup.blocks or slot.opens != ACROSS[frame.heading]:
        return None
    mouth = PoseBox(x=units.metres(slot.mouth_x_um), y=units.metres(slot.mouth_y_um), theta=ZERO)
    own = frame.from_world(mouth)
    return Channel(
        mouth_x=own.x,
        mouth_y=own.y,
        half=units.metres(slot.width_um) * HALF,
        depth=units.metres(slot.depth_um),
        friction=units.plain(slot.friction),
    )
