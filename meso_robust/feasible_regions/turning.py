"""The map of a two-sided rotation: many of them are followed together, or proved to fail.

See ``impossible`` for what counts as a proof that one fails.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.bounds import HALF_PI, Interval, enclose
from meso_robust.bounds.interval import cos, sin
from meso_robust.conditions import condition
from meso_robust.copies import shared
from meso_robust.feasible_regions.cells import at_height, extreme, span
from meso_robust.feasible_regions.impossible import misses
from meso_robust.feasible_regions.paving import Region
from meso_robust.motion import sticking
from meso_robust.primitives.family import Family, follow, held_ends
from meso_robust.primitives.grasp import aims_of
from meso_robust.primitives.move import MoveRule, Point
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tips import HALF
from meso_robust.types import Floats

LONGER = Interval.point(2.0)  # how much longer the part is made to see a tip run off its edge
TOGETHER = 4  # columns that are certified together; more are looser, fewer take longer
TOGETHER_AT_POINT = 32  # the same where all but what is commanded is known
LEAST_ROWS = 16
"""Parts of all rows that are tried apart, where tips are not proved to be clear of the part for more at once."""
Regions = npt.NDArray[np.int8]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Turning:
    """A rotation whose tips' distance across the push and whose end are free."""

    rule: MoveRule
    pre: PoseBox
    setup: Setup
    across: Floats
    """(N+1,) ends of the cells: distance of both tips across the push, m."""
    up: Floats
    """(M+1,) the same: x of the active tip less that of the passive one at the end, m."""

    @property
    def passive(self) -> Point:
        """Where the passive tip is commanded."""
        if self.rule.single is None:
            raise ValueError(f"a rotation needs a passive tip, got {self.rule}")
        return self.rule.single

    def rule_of(self, columns: tuple[int, int], rows: tuple[int, int]) -> MoveRule:
        """All rotations of some columns and rows of cells at once, from the first to before the last."""
        apart, end = (
            Interval(float(edges[first]), float(edges[last]))
            for edges, (first, last) in ((self.across, columns), (self.up, rows))
        )
        passive, up, half = self.passive, HALF * self.setup.spacing, HALF * apart
        middle = HALF * (self.rule.dual.y.offset - up + passive.y.offset)
        return replace(
            at_height(self.rule, middle + half + up),
            dual_end=span(self.rule.dual_end, passive.x.offset + end),
            single=replace(passive, y=span(passive.y, middle - half)),
        )

    def followed(
        self, columns: tuple[int, int], rows: tuple[int, int], pre: PoseBox, setup: Setup
    ) -> Family | None:
        """The same, followed from a pose."""
        each = [aims_of(self.rule_of((k, k + 1), rows)) for k in range(*columns)]
        places = [{name: aims[name].offset for name in ("dual_y", "single_y")} for aims in each]
        still = self.passive.x.offset
        ends = [still + Interval.point(float(self.up[j])) for j in range(rows[0], rows[1] + 1)]
        return follow(self.rule_of(columns, rows), pre, setup, places, ends)


def turning_regions(turning: Turning) -> tuple[Regions, int]:
    """What is proved of each cell.

    Parameters
    ----------
    turning
        The rotation.

    Returns
    -------
    tuple[Regions, int]
        (N, M) values of `Region`, and how many proofs were tried.
    """
    shape = turning.across.size - 1, turning.up.size - 1
    found, tried = np.zeros(shape, dtype=np.int8), 0
    # neither the proof nor its opposite gets past a jam
    apart = [k for k in range(shape[0]) if not _may_close(turning, k)]

    def failing(at: tuple[tuple[int, int], bool]) -> Regions:
        marked = np.zeros(shape, dtype=np.int8)
        _fail(turning, *at, marked)
        return marked

    def certified(columns: tuple[int, int]) -> tuple[Regions, int]:
        marked = np.zeros(shape, dtype=np.int8)
        return marked, _certify(turning, columns, (0, shape[1]), marked)

    blocks = itertools.product(_blocks(apart, TOGETHER_AT_POINT), (True, False))
    for marked in shared(failing, blocks):
        found = np.where(marked, marked, found)
    for marked, proofs in shared(certified, _blocks(apart, TOGETHER)):
        found, tried = np.where(marked, marked, found), tried + proofs
    return found, tried + _alone(turning, set(apart), found)


def _blocks(columns: Sequence[int], most: int) -> list[tuple[int, int]]:
    """First and last but one of columns that lie beside each other, at most so many."""
    blocks: list[tuple[int, int]] = []
    for k in columns:
        if blocks and blocks[-1][1] == k and k - blocks[-1][0] < most:
            blocks[-1] = blocks[-1][0], k + 1
        else:
            blocks.append((k, k + 1))
    return blocks


def _certify(
    turning: Turning, columns: tuple[int, int], rows: tuple[int, int], found: Regions
) -> int:
    """Mark what is certified; how many proofs that took."""
    family = turning.followed(columns, rows, turning.pre, turning.setup)
    if family is not None:
        held = held_ends(family)
        used = np.flatnonzero(held.any(axis=0))
        if not used.size:
            return 1
        if family.clear(int(used[0]), int(used[-1]) + 1):
            found[slice(*columns), slice(*rows)][held] = Region.CERTIFIED
            return 1
        rows = rows[0] + int(used[0]), rows[0] + int(used[-1]) + 1
        parts = [(columns, half) for half in _halves(rows, max(1, found.shape[1] // LEAST_ROWS))]
    else:
        parts = [(half, rows) for half in _halves(columns, 1)]
    return 1 + sum(_certify(turning, *part, found) for part in parts)


def _halves(of: tuple[int, int], least: int) -> list[tuple[int, int]]:
    """A range in two, if it is longer than so much."""
    first, last = of
    middle = (first + last) // 2
    return [(first, middle), (middle, last)] if last - first > least else []


def _alone(turning: Turning, columns: set[int], found: Regions) -> int:
    """Certify cells at the border of what is certified, each alone; how many proofs that took."""
    tried: set[tuple[int, int]] = set()
    certified = [(int(k), int(j)) for k, j in np.argwhere(found == Region.CERTIFIED)]
    todo = [*_beyond(found), *(cell for one in certified for cell in _beside(*one))]
    while todo:
        cell = todo.pop()
        if cell in tried or cell[0] not in columns or found[cell] != Region.UNDECIDED:
            continue
        tried.add(cell)
        _certify(turning, (cell[0], cell[0] + 1), (cell[1], cell[1] + 1), found)
        if found[cell] == Region.CERTIFIED:
            todo += _beside(*cell)
    return len(tried)


def _beside(column: int, row: int) -> list[tuple[int, int]]:
    return [(column - 1, row), (column + 1, row)]


def _beyond(found: Regions) -> Iterator[tuple[int, int]]:
    """Both ends of each row into which nothing that is certified reaches from the row before or after."""
    certified = np.pad(found == Region.CERTIFIED, ((1, 1), (0, 0))).astype(np.int8)
    for row in range(found.shape[1]):
        runs = np.flatnonzero(np.diff(certified[:, row])).reshape(-1, 2).tolist()
        for first, last in runs:
            for next_ in (row - 1, row + 1):
                inside = 0 <= next_ < found.shape[1]
                if inside and not (found[first:last, next_] == Region.CERTIFIED).any():
                    yield from ((first, next_), (last - 1, next_))


def _may_close(turning: Turning, column: int) -> bool:
    """Whether two tips this far apart are not proved to be too far apart for a jam."""
    setup, edges = turning.setup, turning.across
    u = setup.uncertainty
    off, depth = u.probe_position, setup.edge(HALF_PI.mid).depth
    box = {
        "V": Interval(float(edges[column]), float(edges[column + 1])) + off - off + u.probe_wander,
        "width": depth + depth,
        "radii": u.tip_radius + u.passive_tip_radius,
        "mu": u.friction,
    }
    (margin,) = enclose(condition("opposite_edges", "no_jam"), box)
    return not margin.lo > 0.0


def _fail(turning: Turning, columns: tuple[int, int], upper: bool, found: Regions) -> None:
    """Mark what fails from one pose and at one value of the uncertainties.

    A push that is too short to turn the part fails if it is shorter still, and one after which a tip is off
    its edge fails if it goes on: it is as before until then.
    """
    pose, at = _point(turning.pre, turning.setup, upper)
    rows = found.shape[1]
    # else no tip is near an end
    past = int((turning.up[1:] < 0.0).sum())
    longer = replace(at.rectangle, half_length=at.half_length * LONGER)
    family = (
        turning.followed(columns, (0, past), pose, replace(at, outline=longer)) if past else None
    )
    short, off = rows, 0
    for k in range(*columns):

        def too_short(j: int, k: int = k) -> bool:
            return _too_short(turning.rule_of((k, k + 1), (j, j + 1)), pose, at)

        def runs_off(down: int, k: int = k) -> bool:
            end = past - down
            after = family.pose(k - columns[0], end) if family is not None else None
            rule = turning.rule_of((k, k + 1), (end - 1, end))
            return after is not None and _runs_off(rule, after, pose, at)

        short = _first(too_short, min(short, rows - 1), rows)
        off = _first(runs_off, min(off, past), past) if family is not None else past
        found[k, short:] = found[k, : past - off] = Region.IMPOSSIBLE


def _first(holds: Callable[[int], bool], guess: int, count: int) -> int:
    """The first of so many numbers for which it holds, if it does for all after the first; else the count."""
    if guess < count and holds(guess):
        while guess > 0 and holds(guess - 1):
            guess -= 1
        return guess
    return next((k for k in range(guess + 1, count) if holds(k)), count)


def _point(pre: PoseBox, setup: Setup, upper: bool) -> tuple[PoseBox, Setup]:
    """A pose and values of the uncertainties: the pair of tips high (or low) on the part."""
    u = setup.uncertainty
    known = replace(
        u,
        sensed_position=extreme(u.sensed_position, upper),
        probe_position=extreme(u.probe_position, upper),
        misalignment=extreme(u.misalignment, not upper),
        friction=extreme(u.friction, upper),
        film_ratio=extreme(u.film_ratio, upper),
    )
    pose = PoseBox(
        x=Interval.point(pre.x.mid),
        y=extreme(pre.y, not upper),
        theta=extreme(pre.theta, upper),
    )
    return pose, replace(setup, uncertainty=known)


def _heights(rule: MoveRule, pose: PoseBox, setup: Setup) -> tuple[Interval, Interval]:
    """Where the active and the passive tip are in y, in the world."""
    if rule.single is None:
        raise ValueError(f"a rotation needs a passive tip, got {rule}")
    sensed, off = setup.uncertainty.sensed_position, setup.uncertainty.probe_position
    active = rule.dual.y.place(pose.y, sensed, off) - HALF * setup.spacing
    return active, rule.single.y.place(pose.y, sensed, off)


def _too_short(rule: MoveRule, pose: PoseBox, setup: Setup) -> bool:
    """Both tips could hold the part at the end only at a lower angle than it started with."""
    edge, beta = setup.edge(pose.theta.mid), setup.uncertainty.misalignment
    active, passive = _heights(rule, pose, setup)
    behind = HALF * setup.spacing * sin(beta) / cos(beta)
    end = rule.dual_end.offset + behind  # the errors of both x are the same here
    if rule.single is not None:
        end = end - rule.single.x.offset
    box = {"theta": edge.angle(pose.theta), "V": active - passive, "d1": edge.depth}
    (h_start,) = enclose(condition("two_sided_rotation", "pair_position"), box)
    return end.lo > h_start.hi


def _runs_off(rule: MoveRule, after: PoseBox, pose: PoseBox, setup: Setup) -> bool:
    """Whether a tip is beyond the end of its edge in all poses ``after`` the push.

    The push was followed on a longer part, which moves the same as long as both tips are on the real
    one. That the idle tip would touch the longer part does not matter.
    """
    edge = setup.edge(pose.theta.mid)
    angle = edge.angle(after.theta)
    active, passive = (height - after.y for height in _heights(rule, pose, setup))
    # the far edge is the near one after half a turn of the part
    offsets = [sticking.contact_offset(angle, edge.depth, rise) for rise in (active, -passive)]
    return any(misses(offset, edge) for offset in offsets)
