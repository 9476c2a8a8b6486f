"""What is known of a move once it is verified."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from flint import arb

from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.ids import Named
from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.ranges import Box, Formula
from meso_robust.checker.requirement import Requirement
from meso_robust.checker.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True)
class Known:
    """How y before a move hangs on the direction of its edge, after the move before it."""

    box: Box
    """Variables of the move before."""
    height: Formula
    """y, from those and the move's own variables."""


Memory: TypeAlias = Callable[[Scene], Known | None]
"""What a move leaves known for the one whose scene is given, beyond a box of poses; None: nothing."""


Pose: TypeAlias = tuple[Dual, Dual, Dual]
"""x and y of the centre and the direction of the edge, in the axes of the move."""


@dataclass(frozen=True, slots=True)
class Sweep:
    """Poses that are passed during one stage of a move."""

    pose: Callable[[Point], Pose]
    box: Box
    along: str
    """The variable that grows or falls with the travel."""
    exact: bool = False
    """Whether each point of the box is a motion that can be; else some may be ones that cannot."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Passage:
    """A verified move."""

    does: Named
    """The property that it is proved to have."""
    post: PoseBox
    """All poses after it, in the move's own axes."""
    requirements: tuple[Requirement, ...]
    """What was proved, in the order in which a certificate lists it."""
    memory: Memory | None = None
    swept: tuple[Sweep, ...] = ()
    """Every pose of the move but those at rest before it."""
    largest_force: Callable[[], arb] | None = None
    """Bound of all contact forces over drag and commanded speed, if it depends on the motion."""
    guided: bool = False
    """Whether the part may touch the slot's side walls."""
    slips: bool = False
    """Whether a tip that pushes alone may slip: forces are not bounded then."""
