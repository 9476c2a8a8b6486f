"""Building a policy backward from the goal: a pose needs one move more than where it leads.

``make_policy`` only proposes cells; each is kept if its move is certified from all true poses that
can be sensed in it, and all poses that can be sensed afterwards lie in cells with fewer moves to go.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval
from meso_robust.policy.candidates import QUARTERS, Candidate, Kit
from meso_robust.policy.cells import Cell, Policy, in_order, resting, sensed_poses
from meso_robust.policy.cover import Ends, Room, ends_of, left_over, rooms
from meso_robust.policy.proof import certified
from meso_robust.primitives.frame import HEADINGS, Heading
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.stages import Doing, quietly
from meso_robust.task import Task
from meso_robust.wording import counted

MOST_MOVES = 8  # effort of the search: starts that need more are left out
AROUND_UM = 500.0  # looked at beyond the start, on all sides of the goal
FINE, COARSE = 2e-6, 4e-5  # m: thinner is not worth a cell, in the goal's orientation and in others
MOST_ROOMS = {FINE: 4, COARSE: 2}  # that a move is tried into, the largest
INSIDE = 1e-9  # m that a proposed cell keeps from where it is expected to fail


def reach_of(task: Task) -> float:
    """Half the side of the square around the goal in which starts are looked at, m."""
    start, goal = task.start, task.goal
    far = max(abs(start.x_um - goal.x_um), abs(start.y_um - goal.y_um))
    return units.UM * (far + AROUND_UM)


def make_policy(
    task: Task,
    doing: Doing = quietly,
    *,
    headings: Sequence[Heading] | None = None,
    quarters: Sequence[int] = QUARTERS,
    reach: float | None = None,
    most_moves: int = MOST_MOVES,
) -> Policy:
    """Build a certified policy for all starts that it can be built for.

    Parameters
    ----------
    task
        The goal, the part, the probe and the uncertainties; its start only sets the default reach.
    doing
        Shows what is being done while a stage runs.
    headings
        Directions in which the active probe can push; the task's own if absent.
    quarters
        Orientations of the part at the start, in quarter turns from the goal's; 0 is needed by all,
        and -2 by way of -1.
    reach
        Half the side of the square around the goal in which starts are looked at, m.
    most_moves
        Starts that need more moves are left out.

    Returns
    -------
    Policy
        Cells of sensed poses, each certified; none if none could be.
    """
    task.rectangle("a feedback policy (--policy)")
    setup = setup_of(task)
    kit = Kit(
        setup=setup,
        reach=reach_of(task) if reach is None else reach,
        headings=tuple(headings or task.probe.headings or HEADINGS),
    )
    with doing("certifying moves"):
        candidates = [found for turn in quarters for found in kit.near(turn)]
    grown = _Grown(setup=setup, rest=resting(setup))
    for moves in range(1, most_moves + 1):
        with doing(f"certifying starts that need {counted(moves, 'move')}"):
            if not grown.grow(candidates, moves):
                break
    return Policy(task=task, cells=in_order(grown.cells), rest=grown.rest)


@dataclass(slots=True, kw_only=True)
class _Grown:
    """The cells found so far."""

    setup: Setup
    rest: PoseBox | None
    cells: list[Cell] = field(default_factory=list)
    known: Ends = field(init=False)
    """Ends of all boxes of sensed poses for which there is an answer."""

    def __post_init__(self) -> None:
        """Note where the part is in the goal already."""
        self.known = ends_of(self._boxes)

    @property
    def _boxes(self) -> list[PoseBox]:
        """Sensed poses for which there is an answer already."""
        boxes = [cell.sensed for cell in self.cells]
        return boxes if self.rest is None else [*boxes, self.rest]

    def grow(self, candidates: Sequence[Candidate], moves: int) -> bool:
        """Add cells that need ``moves`` moves; whether there were any."""
        below = self._boxes
        found: dict[Interval, list[Room]] = {}
        before = len(self.cells)
        for candidate in candidates:
            if left_over(candidate.sensed, self.known, self._thinnest(candidate)) is None:
                continue
            theta = sensed_poses(candidate.post, self.setup).theta
            if theta not in found:
                found[theta] = rooms(below, theta)
            for box in self._proposed(candidate, found[theta], moves):
                self._add(candidate, box, moves, below)
        return len(self.cells) > before

    def _thinnest(self, candidate: Candidate) -> float:
        """Gaps matter where the part has to pass between them: near the goal and to be turned."""
        off = abs(candidate.sensed.theta.mid - self.setup.goal.theta.mid)
        narrow = off < 0.5 * HALF_PI.mid or candidate.rule.action == "rotate"
        return FINE if narrow else COARSE

    def _proposed(
        self, candidate: Candidate, open_to: Sequence[Room], moves: int
    ) -> Iterator[PoseBox]:
        """Sensed poses from which the move is expected to lead into one of the rooms."""
        error = self.setup.uncertainty.sensed_position
        goal = self.setup.goal
        wanted = [(room, error + error) for room in open_to]
        if moves == 1 and candidate.post.theta.within(goal.theta):
            wanted.append(((goal.x, goal.y), error))
        boxes = [box for room, by in wanted if (box := _into(candidate, room, by)) is not None]
        yield from sorted(boxes, key=_area, reverse=True)[: MOST_ROOMS[self._thinnest(candidate)]]

    def _add(
        self, candidate: Candidate, box: PoseBox, moves: int, below: Sequence[PoseBox]
    ) -> None:
        new = left_over(box, self.known, self._thinnest(candidate))
        if new is None:
            return
        cell = certified(candidate.rule, new, moves, below, self.setup)
        if cell is not None:
            self.cells.append(cell)
            self.known = ends_of(self._boxes)


def _into(candidate: Candidate, room: Room, error: Interval) -> PoseBox | None:
    x = _back(candidate.sensed.x, candidate.post.x, room[0], error, candidate.follows_x)
    y = _back(candidate.sensed.y, candidate.post.y, room[1], error, candidate.follows_y)
    return None if x is None or y is None else replace(candidate.sensed, x=x, y=y)


def _back(
    sensed: Interval, post: Interval, room: Interval, error: Interval, follows: bool
) -> Interval | None:
    """Sensed coordinates of a candidate that lead into one side of a room."""
    if not follows:
        return sensed if (post + error).within(room) else None
    low = sensed.lo + (room.lo - post.lo) + error.hi + INSIDE
    high = sensed.hi + (room.hi - post.hi) + error.lo - INSIDE
    low, high = max(low, sensed.lo), min(high, sensed.hi)
    return Interval(low, high) if low < high else None


def _area(box: PoseBox) -> float:
    return box.x.width * box.y.width
