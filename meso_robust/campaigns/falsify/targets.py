"""What an adversary raises: how near a run comes to leaving what is claimed of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from meso_robust.laboratory.ascent import Score
from meso_robust.laboratory.claims import LOWER, PASSIVE, UPPER, Claims, first_meeting
from meso_robust.laboratory.crosscheck import REFUTING
from meso_robust.laboratory.draws import Draws
from meso_robust.laboratory.geometry import gaps_to
from meso_robust.laboratory.judging import INSTANTS
from meso_robust.laboratory.meetings import CORNER, stick_ratio
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.running import MoveRun, PlanRun
from meso_robust.types import Floats

Measure = Callable[[PlanRun, Draws], Floats]

ANGLES = 5  # orientations between the first and the last of a move at which sticking is asked
COORDINATES = ("x", "y", "theta")
TIGHTEST = 1e-9  # m and rad: a box that is tighter is measured as if it were this wide
HALF_WIDTHS = "half widths"


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """Something that an adversary raises."""

    name: str
    unit: str
    limit: float
    """Value that breaks the claim."""
    measure: Measure
    """Runs and what was drawn for them to (N,) values; minus infinity for a run that ended before."""
    record: int = 0
    """Intervals of the path of each move that the measure looks at."""


def box_targets(claims: Claims) -> tuple[Target, ...]:
    """The six directions of every certified box and of the goal, in half widths from its middle."""
    found = []
    for k, post in enumerate(claims.posts):
        if post is not None:
            found += [_side(f"move {k + 1}: box", k, post, axis, way) for axis, way in _SIDES]
    goal, last = claims.setup.goal.ends, len(claims.rules) - 1
    return (*found, *(_side("goal", last, goal, axis, way) for axis, way in _SIDES))


_SIDES = tuple((axis, way) for axis in range(3) for way in (-1, 1))


def _side(name: str, k: int, box: Floats, axis: int, way: int) -> Target:
    middle = 0.5 * (box[0, axis] + box[1, axis])
    half = max(0.5 * (box[1, axis] - box[0, axis]), TIGHTEST)

    def measure(runs: PlanRun, _: Draws) -> Floats:
        reached = way * (runs.moves[k].after[:, axis] - middle) / half
        return np.where(runs.failed_in > k, reached, -np.inf)

    side = "low" if way < 0 else "high"
    return Target(
        name=f"{name}, {COORDINATES[axis]} {side}", unit=HALF_WIDTHS, limit=1.0, measure=measure
    )


def tube_targets(claims: Claims) -> tuple[Target, ...]:
    """How near the poses of a move come to the surface of its tube."""
    return tuple(
        Target(
            name=f"move {k + 1}: tube",
            unit=HALF_WIDTHS,
            limit=1.0,
            measure=_in_tube(k, tube),
            record=INSTANTS,
        )
        for k, tube in enumerate(claims.tubes)
        if tube is not None
    )


def _in_tube(k: int, tube: Floats) -> Measure:
    """For every instant the slice that holds the pose best; of these the worst instant."""
    middles = 0.5 * (tube[:, 0] + tube[:, 1])
    halves = np.maximum(0.5 * (tube[:, 1] - tube[:, 0]), TIGHTEST)

    def measure(runs: PlanRun, _: Draws) -> Floats:
        path = runs.moves[k].path
        nearest = np.full(path.shape[:2], np.inf)
        for middle, half in zip(middles, halves, strict=True):
            nearest = np.minimum(nearest, (np.abs(path - middle) / half).max(axis=2))
        return np.where(runs.failed_in > k, nearest.max(axis=1), -np.inf)

    return measure


def motion_targets(claims: Claims) -> tuple[Target, ...]:
    """What the motions need: friction that holds, probes that start clear, a grasp that is open."""
    found = []
    for k, rule in enumerate(claims.rules):
        name = f"move {k + 1}:"
        found.append(Target(name=f"{name} start", unit="um inside", limit=0.0, measure=_start(k)))
        if rule.action in ("tilt", "straighten"):
            sticking = _sticking(k)
            found.append(Target(name=f"{name} sticks", unit="of mu", limit=0.0, measure=sticking))
        if rule.action == "rotate":
            grasp = _grasp(k, LOWER if rule.side > 0 else UPPER)
            found.append(Target(name=f"{name} grasp", unit="of mu", limit=0.0, measure=grasp))
    return tuple(found)


def _start(k: int) -> Measure:
    def measure(runs: PlanRun, _: Draws) -> Floats:
        move = runs.moves[k]
        gaps = gaps_to(move.tips, move.before, move.outlines, move.radii)
        return np.where(runs.failed_in >= k, -1e6 * gaps.min(axis=1), -np.inf)

    return measure


def _friction(draws: Draws, k: int, pick: Callable[[Floats], Floats]) -> Floats:
    """(N,) least or largest friction of any tip in a move."""
    if draws.tip_friction is None:
        return draws.friction
    return pick(draws.tip_friction[:, k].reshape(len(draws.friction), -1))


def _sticking(k: int) -> Measure:
    def measure(runs: PlanRun, draws: Draws) -> Floats:
        needed = needed_friction(runs.moves[k], draws.film_ratio)
        least = _friction(draws, k, lambda all_: all_.min(axis=1))
        return np.where(runs.failed_in > k, needed - least, -np.inf)

    return measure


def needed_friction(move: MoveRun, film_ratio: Floats) -> Floats:
    """(N,) least friction with which the first tip to touch sticks during the whole move.

    Of an even film about the reference point: where the film is another one this only guides.
    """
    first, met = first_meeting(move)
    which = np.arange(len(first))
    corner = move.outlines[which, met.edge]
    side = np.roll(move.outlines, -1, axis=1)[which, met.edge] - corner
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    point, normal = corner + met.along[:, None] * side, np.stack([-side[:, 1], side[:, 0]], axis=1)
    ratios = []
    for share in np.linspace(0.0, 1.0, ANGLES):
        pose = move.before + share * (move.after - move.before)
        ratios.append(stick_ratio(point, normal, move.travel[which, first], pose, film_ratio))
    return np.where(met.edge == CORNER, np.inf, np.max(ratios, axis=0))


def _grasp(k: int, active: int) -> Measure:
    """By how much mu exceeds what locks the part between the two tips where they are nearest.

    Across the part the contacts are as far apart as it is wide, the centres by both radii more; the
    line through the contacts stands at the angle of friction to the normals where the part locks.
    """

    def measure(runs: PlanRun, draws: Draws) -> Floats:
        move = runs.moves[k]
        apart = move.tips[:, active] - move.tips[:, PASSIVE]
        way = move.travel[:, active]
        share = np.clip(-np.sum(apart * way, axis=1) / np.sum(way * way, axis=1), 0.0, 1.0)
        nearest = np.linalg.norm(apart + share[:, None] * way, axis=1)
        width = np.ptp(move.outlines, axis=1).min(axis=1)
        wide = width + move.radii[:, active] + move.radii[:, PASSIVE]
        locks = np.sqrt(np.maximum(nearest**2 - wide**2, 0.0)) / width
        largest = _friction(draws, k, lambda all_: all_.max(axis=1))
        return np.where(runs.failed_in >= k, largest - locks, -np.inf)

    return measure


def all_targets(claims: Claims) -> tuple[Target, ...]:
    """Motions, boxes, goal and tubes."""
    return (*motion_targets(claims), *box_targets(claims), *tube_targets(claims))


def failing(runs: PlanRun, measured: Floats) -> Floats:
    """(N,) values with infinity for runs that could not be carried out: nothing is worse."""
    return np.where(np.isin(runs.outcomes, REFUTING), np.inf, measured)


def scorer(player: Feedback, target: Target) -> Score:
    """What rows score as runs of a plan: the target's measure, infinite for runs that fail."""

    def score(rows: Floats) -> Floats:
        runs = player.run(rows, record=target.record)
        return failing(runs, target.measure(runs, player.draws_of(rows)))

    return score
