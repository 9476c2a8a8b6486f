"""A move as a rule: where the probes go, as a function of the pose sensed before it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.primitives.action import Action as Action
from meso_robust.primitives.frame import WORLD, Frame
from meso_robust.types import Floats


class Anchor(Enum):
    """What a commanded coordinate is measured from."""

    PART = "sensed part"
    WORLD = "world"


@dataclass(frozen=True, slots=True, kw_only=True)
class Aim:
    """One commanded coordinate: the sensed one plus an offset, or the offset in the world."""

    anchor: Anchor
    offset_um: float
    """Decimal um, as written to the plan; converted exactly where a proof needs it."""

    def command(self, sensed: Floats) -> Floats:
        """The commanded coordinate for sensed coordinates of the part, m."""
        base = sensed if self.anchor is Anchor.PART else np.zeros_like(sensed)
        return base + self.offset_um * units.UM

    @property
    def offset(self) -> Interval:
        """The offset, m."""
        return units.metres(self.offset_um)

    def ahead_of(self, true: Interval, sensing: Interval, actuation: Interval) -> Interval:
        """Where the probe really is, minus the part's true coordinate.

        ``sensing`` is sensed minus true, ``actuation`` true minus commanded.
        """
        if self.anchor is Anchor.PART:
            return self.offset + sensing + actuation
        return self.offset + actuation - true

    def place(self, true: Interval, sensing: Interval, actuation: Interval) -> Interval:
        """Where the probe really is in the world."""
        if self.anchor is Anchor.PART:
            return true + self.offset + sensing + actuation
        return self.offset + actuation


def from_part(offset_um: float) -> Aim:
    """A coordinate measured from the sensed part.

    Parameters
    ----------
    offset_um
        From the part's reference point, um; rounded to 0.1 um, the manipulator's resolution. What is
        proved is proved of the rounded number, which the plan states.

    Returns
    -------
    Aim
        Commanded as the sensed coordinate plus the offset.
    """
    return Aim(anchor=Anchor.PART, offset_um=round(float(offset_um), 1))


def in_world(offset_um: float) -> Aim:
    """A coordinate in the world.

    Parameters
    ----------
    offset_um
        From the world's origin, um; rounded as :func:`from_part` does.

    Returns
    -------
    Aim
        Commanded whatever is sensed.
    """
    return Aim(anchor=Anchor.WORLD, offset_um=round(float(offset_um), 1))


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """A commanded point."""

    x: Aim
    y: Aim


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Commands:
    """Commanded positions of N runs of a move, world frame."""

    tips: Floats
    """(N, P, 2) at the start: upper, lower (in the move's axes) and, if present, passive tip, m."""
    travel: Floats
    """(N, P, 2) displacement of the tips, m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveRule:
    """One move of the policy: the dual-tip probe travels along its -x, the single tip rests.

    All coordinates are in the axes of ``frame``.
    """

    step: int
    """Step of the paper's algorithm (1 to 4) that the move belongs to."""
    primitive: str
    """y_translation, rotation or x_translation."""
    action: Action
    """tilt, straighten, rotate, regrasp or guide: which certified motion the move is."""
    side: int
    """tilt, rotate: +1 turns the part counter-clockwise, -1 clockwise; else 0."""
    dual: Point
    """Middle of the two tips at the start; the tips lie half the spacing above and below it."""
    dual_end: Aim
    """x of that middle at the end of the travel."""
    single: Point | None = None
    """The passive tip, if it is in the plane."""
    frame: Frame = WORLD

    def commands(self, sensed: Floats, spacing: float | Floats, misalignment: Floats) -> Commands:
        """Where the probes go when ``sensed`` is the pose before the move.

        Parameters
        ----------
        sensed
            (N, 3) sensed poses, m and rad, world frame.
        spacing
            Distance of the two tips across the push, m; or (1|N,) of them.
        misalignment
            (N,) angle beta by which the pair is turned counter-clockwise in the world from square to
            the push, rad; positive: the tip on the right, seen along the push, is ahead.
        """
        own = self.frame.sensed(sensed)
        x, y = own[:, 0], own[:, 1]
        start = np.stack([self.dual.x.command(x), self.dual.y.command(y)], axis=1)
        # counter-clockwise in own axes, where the right-hand tip is the upper one unless they are
        # mirrored; a positive beta puts the upper tip ahead, towards -x
        beta = -misalignment if self.frame.mirrored else misalignment
        upper = (
            0.5
            * np.reshape(spacing, (-1, 1))
            * np.stack([-np.tan(beta), np.ones_like(beta)], axis=1)
        )
        push = np.stack([self.dual_end.command(x) - start[:, 0], np.zeros_like(x)], axis=1)
        tips, travel = [start + upper, start - upper], [push, push]
        if self.single is not None:
            passive = [self.single.x.command(x), self.single.y.command(y)]
            tips.append(np.stack(passive, axis=1))
            travel.append(np.zeros_like(push))
        return Commands(
            tips=self.frame.to_world(np.stack(tips, axis=1)),
            travel=self.frame.to_world(np.stack(travel, axis=1)),
        )
