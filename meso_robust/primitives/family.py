"""Many rotations followed together, by looser bounds than one: for maps.

See `meso_robust.primitives.rotation` for what a rotation is.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.bounds import Interval, enclose_rows
from meso_robust.motion.two_sided import SlideTube, cut, enclose_slide
from meso_robust.primitives.approach import STATED, Touch, approach, touches
from meso_robust.primitives.force import squeeze_below_cap
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import Which
from meso_robust.primitives.rotation import (
    EARLY,
    Held,
    Move,
    Slice,
    all_proved,
    apart,
    as_begun,
    before_end,
    facing,
    idle_tip_clear,
    joined,
    opposite,
    poses,
    unknown,
    within,
)
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tips import comes_free

CELL, STEPS, SLICES, BOXES = 1.0 / 210.0, 2.5, 8, 64
"""Room of the tips, of the part's width; times longer steps; slices; boxes for a pose."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """Rotations whose tips are in several places across the travel and whose push has several ends.

    They are followed together, each cell of the tube as far as it holds.
    """

    move: Move
    """All of them at once."""
    touch: Touch
    tube: SlideTube
    parts: list[Move]
    """The move in each cell of the tube."""
    places: Sequence[Mapping[str, Interval]]
    cells: list[list[int]]
    """Cells that each place may be in."""
    reached: list[float]
    """The least h to which all of them hold, by place, m."""
    starts: list[Interval]
    """h where both tips touch, by place, m."""
    ends: Sequence[Interval]
    h_ends: list[Interval]
    """h at each end of the push, m."""
    travels: list[Interval]
    """Travel of the active tip to each, m."""

    def held(self, place: int, longer: int, shorter: int) -> bool:
        """Whether both tips are proved to hold the part wherever the push ends between two ends."""
        h_end = self.h_ends[longer].hull(self.h_ends[shorter])
        rests = before_end(self.starts[place], h_end) * STATED
        return rests.lo > 0.0 and h_end.lo >= self.reached[place]

    def pose(self, place: int, end: int) -> PoseBox | None:
        """All poses at an end of the push, in the move's axes; None where they are not enclosed."""
        if not self.held(place, end, end):
            return None
        h = self.h_ends[end]
        row = {**self.places[place], "end_x": self.ends[end]}
        found = [
            poses(self.move.of.end, self.parts[k], cell, [h], [cell.around(h)], BOXES, row)[0]
            for k, cell in ((k, self.tube.cells[k]) for k in self.cells[place])
        ]
        held = functools.reduce(joined, found)
        return None if held is None else held.pose

    def clear(self, longer: int, shorter: int) -> bool:
        """Whether the idle tip is clear, and the tips come free, wherever the push ends between two ends."""
        slices = self._slices(self.h_ends[longer].lo)
        if len(slices) <= EARLY:
            return False
        at_end = functools.reduce(
            Held.hull, [one.held for one in slices if one.h.lo <= self.h_ends[shorter].hi]
        )
        move = replace(self.move, travel=self.travels[longer])
        faced = facing(move, at_end.edge_angle)
        obligations = [
            *idle_tip_clear(move, self.touch, slices, at_end),
            comes_free(Which.BOTH, faced.hull(faced + move.lean)),
        ]
        force = max(self.touch.largest_force, self.tube.largest_force)
        return all_proved([*obligations, *squeeze_below_cap(force, move.setup)])

    def _slices(self, least: float) -> list[Slice]:
        """The turn down to an h."""
        h = self.tube.h
        last = int(np.searchsorted(-h, -least, side="left"))
        cuts = sorted({round(k * last / SLICES) for k in range(SLICES + 1)})
        found: list[list[Held]] = [[] for _ in cuts[1:]]
        for part, cell in zip(self.parts, self.tube.cells, strict=True):
            # a cell that does not come so far has no place whose push may end there
            pairs = [
                (a, min(b, cell.checked)) for a, b in itertools.pairwise(cuts) if a < cell.checked
            ]
            spans = [Interval(float(h[b]), float(h[a])) for a, b in pairs]
            lines = [cell.line(a, b) for a, b in pairs]
            for one, held in zip(
                found, poses(self.move.of.during, part, cell, spans, lines, 1), strict=False
            ):
                one.append(held or unknown())
        return [
            Slice(h=Interval(float(h[b]), float(h[a])), held=functools.reduce(Held.hull, one))
            for (a, b), one in zip(itertools.pairwise(cuts), found, strict=True)
            if one
        ]


def follow(
    rule: MoveRule,
    pre: PoseBox,
    setup: Setup,
    places: Sequence[Mapping[str, Interval]],
    ends: Sequence[Interval],
) -> Family | None:
    """Follow many rotations at once, by looser bounds than `certify_rotation`.

    Parameters
    ----------
    rule, pre, setup
        As of `certify_rotation`; the rule commands ranges that hold all of the places and ends.
    places
        Ranges of the commands ``dual_y`` and ``single_y`` (`grasp.AIMS`), m.
    ends
        Commands for the end of the push, rising, m.

    Returns
    -------
    Family or None
        None where they are not proved to begin, or all end too early.

    Raises
    ------
    ValueError
        If the rule is not a counter-clockwise rotation with a passive tip.
    """
    move, obligations = as_begun(rule, pre, setup)
    if not (opposite(move.lean, setup) and all_proved(obligations)):
        return None
    touch = approach(move.box, move.grip, move.labels, move.first_gap, move.edge, move.of)
    if touch is None or not all_proved(touch.obligations):
        return None
    begun = enclose_rows(move.of.begin, move.box, [{"end_x": end} for end in ends], boxes=16)
    h_ends, travels = [row[4] for row in begun], [row[7] for row in begun]
    starts = touches(touch, move.of, places)
    # a push that ends before both tips surely touch is not held: it needs no tube
    latest = max(start.lo - start.width for start in starts)
    stops = sorted((h.lo for h in h_ends if h.hi < latest), reverse=True)
    if len(stops) < 2:
        return None
    grip = move.grip
    most = CELL * (grip.depth.mid + grip.depth_far.mid)
    rooms = cut(grip, max(1, math.ceil(grip.room.width / most)))
    moves = within(move, rooms)
    parts = [(one.grip, {**touch.start.labels, **one.labels}) for one in moves]
    tube = enclose_slide(grip, touch.start, stops[-1], coarse=STEPS, parts=parts, stops=stops)
    own = [row[1] for row in enclose_rows(move.of.begin, move.box, places, boxes=16)]
    cells = [[k for k, room in enumerate(rooms) if not apart(room, one)] for one in own]
    reach = [float(cell.h[cell.checked]) for cell in tube.cells]
    return Family(
        move=move,
        touch=touch,
        tube=tube,
        parts=moves,
        places=places,
        cells=cells,
        reached=[max(reach[k] for k in one) for one in cells],
        starts=starts,
        ends=ends,
        h_ends=h_ends,
        travels=travels,
    )


def held_ends(family: Family) -> npt.NDArray[np.bool_]:
    """Where both tips are proved to hold the part at the end.

    Parameters
    ----------
    family
        Rotations, followed.

    Returns
    -------
    npt.NDArray[np.bool_]
        (places, ends - 1): whether at a place they do wherever the push ends between an end and the next.
        All of these are certified if they are also `Family.clear`.
    """
    rows = range(len(family.ends) - 1)
    return np.array([[family.held(k, j, j + 1) for j in rows] for k in range(len(family.places))])
