"""The random tree of Section VII: pushes along x or y at 100 places of the peg's reachable boundary.

Every node is a pose, every branch a push by a lifted and lowered tip. All inputs of a node are
simulated in one batch on a film that stands for the three points, in coarse steps; the few best are
made once more on the points p1* themselves, in fine steps, and only these poses enter the tree.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from meso_robust.reproduction import printed
from meso_robust.reproduction.bench import START, Place, Plan, follow, nominal, succeeded
from meso_robust.simulator import Film, Outcome, Push, Round, simulate
from meso_robust.simulator.support_models import Support
from meso_robust.types import Flags, Floats

PLACES = 100
"""Pushing locations on the boundary of the peg; Section VII."""
GAP = 20e-6
"""m between tip and peg when the tip is lowered: more than the errors of both."""
LENGTHS = 6  # of a push that are tried
LONGEST = 1.2e-3
"""m; pushes of one sixth of it to the whole are tried."""
COARSE, FINE = 10e-6, 2e-6
"""m a step, for the choice of a push and for the push that is kept."""
TRIED = 4
"""Pushes of a node made in fine steps before the best is kept."""
LEAST_TURN = 0.5
"""Least share of a push that goes against the boundary's normal: within 60 deg of it."""
SAME = 30e-6
"""m; poses nearer than this are one node."""
GOAL_BIAS = 0.4
"""Share of the samples that are the goal; not printed."""
AHEAD = 0.2e-3
"""m that the goal lies behind the mouth."""
GYRATION = float(np.hypot(printed.PART.length, printed.PART.width) / np.sqrt(12.0))
"""m a rad: the peg's radius of gyration, which sets turns against shifts in the metric."""
MOST_ITERATIONS = 400
"""After which a search is given up; the paper needed 12 at least."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Searched:
    """What a search came to.

    Attributes
    ----------
    plan
        One stroke a push.
    iterations
        Of the tree until the goal was reached.
    nodes
        Of the tree.
    seconds, processor
        Of the search, by the clock and of the processor's time, s.
    """

    plan: Plan
    iterations: int
    nodes: int
    seconds: float
    processor: float


@dataclass(frozen=True, slots=True, eq=False)
class Inputs:
    """Pushes of a node and where a film lets them end.

    Attributes
    ----------
    strokes
        (M, 2, 2) start and end of the tip, m.
    poses
        (M, 3)
    """

    strokes: Floats
    poses: Floats


@dataclass(slots=True)
class Tree:
    """Poses, the node before each and the push between; the inputs of nodes that were expanded."""

    poses: Floats = field(default_factory=lambda: START[None].copy())
    before: list[int] = field(default_factory=lambda: [-1])
    strokes: list[Floats] = field(default_factory=lambda: [np.zeros((2, 2))])
    inputs: dict[int, Inputs] = field(default_factory=dict)
    aimed: set[int] = field(default_factory=set)

    def add(self, node: int, stroke: Floats, pose: Floats) -> None:
        """Append a pose reached from a node by a push."""
        self.poses = np.concatenate([self.poses, pose[None]])
        self.before.append(node)
        self.strokes.append(stroke)

    def way(self, node: int) -> Plan:
        """Pushes from the start to a node."""
        strokes: list[Floats] = []
        while node > 0:
            strokes.append(self.strokes[node])
            node = self.before[node]
        return tuple(reversed(strokes))


def distance(poses: Floats, pose: Floats) -> Floats:
    """(N,) distance of (N, 3) poses from a pose, m; either end of the peg may be ahead."""
    off = poses - pose
    turn = (off[:, 2] + 0.5 * np.pi) % np.pi - 0.5 * np.pi
    return np.asarray(np.sqrt(off[:, 0] ** 2 + off[:, 1] ** 2 + (GYRATION * turn) ** 2))


def boundary(places: int = PLACES) -> tuple[Floats, Floats]:
    """(places, 2) points evenly spaced on the peg's outline and their outward normals, body frame."""
    outline = printed.PART.outline
    edges = np.roll(outline, -1, axis=0) - outline
    length = np.hypot(*edges.T)
    ends = np.cumsum(length)
    along = (np.arange(places) + 0.5) * ends[-1] / places
    edge = np.searchsorted(ends, along)
    share = (along - (ends - length)[edge]) / length[edge]
    tangents = edges[edge] / length[edge, None]
    points = outline[edge] + share[:, None] * edges[edge]
    return points, np.column_stack([tangents[:, 1], -tangents[:, 0]])


def pushes(pose: Floats, place: Place) -> Floats:
    """(M, 2, 2) strokes along x or y against the reachable boundary, of the longest length."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    turn = np.array([[c, s], [-s, c]])
    points, normals = (part @ turn for part in boundary())
    found = []
    for way in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        against = -(normals @ np.array(way))
        chosen = against > LEAST_TURN
        middle = points[chosen] + pose[:2] + printed.TIP_RADIUS * normals[chosen]
        start = middle - np.outer(GAP / against[chosen], way)
        start = start[place.clear(start)]
        found.append(np.stack([start, start + LONGEST * np.array(way)], axis=1))
    return np.concatenate(found)


def pads() -> Film:
    """Film under the three points p1* alone: viscous where the points are dry."""
    drag = np.zeros((3, 3))
    for x, y, load in printed.three_points("p1*").tables().points[0]:
        row = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
        drag += load * row.T @ row
    return Film(drag)


def inputs(pose: Floats, place: Place) -> Inputs:
    """All pushes of a node, in all lengths, and where they end on the film of `pads`."""
    strokes = pushes(pose, place)
    if not len(strokes):
        return Inputs(np.zeros((0, 2, 2)), np.zeros((0, 3)))
    push = _batch(np.repeat(pose[None], len(strokes), axis=0), strokes, place, pads(), COARSE)
    result = simulate(push, record=LENGTHS)
    share = np.arange(1, LENGTHS + 1) / LENGTHS
    ends = strokes[:, :1] + share[:, None] * np.diff(strokes, axis=1)
    going = result.outcomes == Outcome.COMPLETED
    last = (result.path[:, 1:] == result.poses[:, None]).all(axis=2)
    free = np.logical_and.accumulate(place.clear(ends), axis=1)
    some, which = np.nonzero(free & (going[:, None] | ~last))
    both = np.stack([strokes[some, 0], ends[some, which]], axis=1)
    return Inputs(both, result.path[some, which + 1])


def _batch(poses: Floats, strokes: Floats, place: Place, support: Support, step: float) -> Push:
    return Push.straight(
        vertices=printed.PART.outline,
        poses=poses,
        tips=strokes[:, :1],
        travel=np.diff(strokes, axis=1),
        friction=np.full(len(poses), printed.TIP_FRICTION["p1*"]),
        support=support,
        shapes=(Round(printed.TIP_RADIUS),),
        fixture=place.fixture,
        step=step,
    )


def plan(place: Place, seed: int, most: int = MOST_ITERATIONS) -> Searched:
    """Search a sequence of pushes that brings the peg from its start into the slot.

    Parameters
    ----------
    place
        The slot.
    seed
        Of the samples.
    most
        Iterations after which the search is given up.

    Raises
    ------
    ValueError
        If the goal is not reached in so many iterations.
    """
    began, used, tree = time.perf_counter(), time.process_time(), Tree()
    for iteration, (sample, aimed) in enumerate(_samples(place, seed, most), start=1):
        node = _nearest(tree, sample, aimed)
        if _grow(tree, node, sample, place) and place.holds(tree.poses[-1:])[0]:
            found = tree.way(len(tree.poses) - 1)
            if succeeded(follow(found, nominal("p1*"), place), place)[0]:
                return Searched(
                    plan=found,
                    iterations=iteration,
                    nodes=len(tree.poses),
                    seconds=time.perf_counter() - began,
                    processor=time.process_time() - used,
                )
    raise ValueError(f"no plan after {most} iterations from seed {seed}; try another seed")


def _samples(place: Place, seed: int, most: int) -> Iterator[tuple[Floats, bool]]:
    """Poses to grow towards, and whether each is the goal."""
    rng = np.random.default_rng(seed)
    goal = np.array([place.mouth - AHEAD, place.axis, np.pi])
    low = np.array([place.mouth, place.axis - 0.5e-3, 0.4 * np.pi])
    high = np.array([START[0] + 0.5e-3, place.axis + 0.5e-3, 1.1 * np.pi])
    for _ in range(most):
        aimed = bool(rng.random() < GOAL_BIAS)
        yield (goal if aimed else rng.uniform(low, high)), aimed


def _nearest(tree: Tree, sample: Floats, aimed: bool) -> int:
    """The nearest node; from one node the goal is aimed at once only."""
    far = distance(tree.poses, sample)
    if aimed and len(tree.aimed) < len(far):
        far[list(tree.aimed)] = np.inf
    node = int(np.argmin(far))
    if aimed:
        tree.aimed.add(node)
    return node


def _grow(tree: Tree, node: int, sample: Floats, place: Place) -> bool:
    """Add the pose nearest to a sample that a push of the node reaches; whether there is one."""
    if node not in tree.inputs:
        tree.inputs[node] = inputs(tree.poses[node], place)
    known = tree.inputs[node]
    best = np.argsort(distance(known.poses, sample), kind="stable")[:TRIED]
    inside = np.flatnonzero(place.holds(known.poses))[:TRIED]
    chosen = np.unique(np.concatenate([best, inside]))
    if not len(chosen):
        return False
    strokes = known.strokes[chosen]
    ended, done = _kept(tree.poses[node], strokes, place)
    new = done & (np.array([distance(tree.poses, pose).min() for pose in ended]) > SAME)
    if not new.any():
        return False
    far = np.where(place.holds(ended), -1.0, distance(ended, sample))
    one = int(np.argmin(np.where(new, far, np.inf)))
    tree.add(node, strokes[one], ended[one])
    return True


def _kept(pose: Floats, strokes: Floats, place: Place) -> tuple[Floats, Flags]:
    """(M, 3) ends of pushes on the points p1* in fine steps, and whether each was completed."""
    support = printed.three_points("p1*")
    poses = np.repeat(pose[None], len(strokes), axis=0)
    result = simulate(_batch(poses, strokes, place, support, FINE))
    return result.poses, np.asarray(result.outcomes == Outcome.COMPLETED)
