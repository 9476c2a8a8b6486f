"""How far out, how long and how slowly a plan goes: whether it keeps the budget that bounds were computed for."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.bounds.interval import cos, sin
from meso_robust.certificates.chain import Chain
from meso_robust.primitives.base import bend_of
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.rotation import held_poses
from meso_robust.primitives.setup import ZERO, PoseBox, Setup, setup_of
from meso_robust.task import Part, PolygonPart, Task
from meso_robust.transfer.inflation import Budget
from meso_robust.transfer.running import HANDLING_S

_ROUNDING = 1.0 + 1e-9  # of lengths and times that are computed in plain doubles


def needed(chain: Chain, task: Task, slender: float) -> Budget:
    """What the certified steps need, with everything that is added to a sensed pose.

    Parameters
    ----------
    chain
        The steps, as far as they go, and all poses on the way.
    task
        The task that they were certified for: its bound of sensing holds all that is added.
    slender
        Of the film, as in `Budget`.
    """
    added = math.sqrt(2.0) * task.uncertainty.sensed_position_um
    radius = max(_farthest(step) for step in chain.steps)
    speed = task.probe.speed_um_s
    seconds = sum(_travel_um(step, chain, task) / speed + HANDLING_S for step in chain.steps)
    ratios = ratio_ends(task)
    slowest = [_slowest(step, chain.setup) for step in chain.steps]
    return Budget(
        radius_um=(radius + added) * _ROUNDING,
        seconds=seconds * _ROUNDING,
        ratio_um2=ratios[1],
        least_ratio_um2=ratios[0],
        slender=slender,
        rectangle=isinstance(task.part, Part),
        reach_um=reach_um(task),
        speed_um_s=speed,
        press=min(press for press, _ in slowest),
        turn_per_um=min(turn for _, turn in slowest),
        capped=task.probe.max_force_un is not None,
    )


def ratio_ends(task: Task) -> tuple[float, float]:
    """Smallest and largest ratio of rotational to translational drag that a task allows, um^2."""
    u = task.uncertainty
    low, high = (1.0 + side * 0.01 * u.film_ratio_percent for side in (-1.0, 1.0))
    return u.film_ratio_um2 * low / _ROUNDING, u.film_ratio_um2 * high * _ROUNDING


def reach_um(task: Task) -> float:
    """Largest distance of a place of the part from its reference point, um."""
    part = task.part
    if isinstance(part, PolygonPart):
        corners = setup_of(task).body.corners
        far = max(math.hypot(*(max(-side.lo, side.hi) for side in corner)) for corner in corners)
        return units.to_um(far) * _ROUNDING
    # an edge farther out by half the tolerance, and turned about the foot of the centre
    across = math.hypot(part.length_um, part.width_um)
    lean = math.tan(math.radians(part.squareness_deg or 0.0))
    return (0.5 * across + (part.size_tolerance_um or 0.0) + across * lean) * _ROUNDING


def _slowest(step: Step, setup: Setup) -> tuple[float, float]:
    """How slow a move is at least.

    Least speed of a moving tip against the edge of a part that it alone turns, over its speed, and least turn of
    a part between two tips, rad per um of travel.
    """
    if step.rule.action == "regrasp":
        return 1.0, math.inf
    there = step.rule.frame.setup(setup)
    held = held_poses(step) if step.rule.action == "rotate" else []
    alone = [step.pre, *(knot.box for knot in step.tube)]
    turn = min((_turn(box, step, there) for box in held), default=math.inf)
    if held and turn > 0.0:
        alone = alone[: -len(held)]
    elif held:
        turn = math.inf  # what is known of one tip is known of two
    return min(_pressing(box, step, there)[0] for box in alone), turn


def _pressing(box: PoseBox, step: Step, setup: Setup) -> tuple[float, Interval, Interval]:
    """Least speed of the tip against its edge, over the one that is commanded; cosine and sine of the edge.

    Both are from the travel. A travel that is shorter than commanded takes as long; a tip that strays may
    fall behind while it does.
    """
    frame, u = step.rule.frame, setup.uncertainty
    edge = setup.edge(frame.from_world(step.pre).theta.mid)
    angle = edge.angle(frame.from_world(box).theta) + u.squareness - u.travel_direction
    c, s = cos(angle), sin(angle)
    one = Interval.point(1.0)
    slow = (one + u.travel_scale) * (one - bend_of(u))
    return max(0.0, ((s + bend_of(u) * c) * slow).lo), c, s


def _turn(box: PoseBox, step: Step, setup: Setup) -> float:
    """Least turn between two tips on parallel edges, rad per um of travel; 0 if not known.

    It is s / T, with (h, V) = T (c, s) + W (s, -c) from the passive tip to the moving one
    (derivations/opposite_edges.py).
    """
    u = setup.uncertainty
    edge = setup.edge(step.rule.frame.from_world(step.pre).theta.mid)
    far, askew = setup.opposite(edge)
    if u.squareness != ZERO or askew != ZERO:
        return 0.0
    width = edge.depth + far.depth + u.tip_radius + u.passive_tip_radius
    both = next(one for one in step.obligations if one.name.id is ObligationId.BOTH_TIPS_TOUCH)
    h, across = both.proof.box["h"], both.proof.box["V"]
    press, c, s = _pressing(box, step, setup)
    if not (press > 0.0 and s.lo > 0.0):
        return 0.0
    most = ((across + width * c) / s).hi
    if c.hi < 0.0:  # the moving tip is no farther ahead than W s
        ahead = Interval.point(max((width * s).hi, -h.lo))
        most = min(
            most, math.sqrt((ahead * ahead + across * across - width * width).hi) * _ROUNDING
        )
    return (
        (Interval.point(press) / Interval.point(most)).lo / 1e6 / _ROUNDING if most > 0.0 else 0.0
    )


def _farthest(step: Step) -> float:
    """Largest distance of the part's centre from the world's origin in a move, um."""
    boxes = [step.pre, *(knot.box for knot in step.tube)] + ([step.post] if step.post else [])
    return max(
        math.hypot(*(units.to_um(max(-side.lo, side.hi)) for side in (box.x, box.y)))
        for box in boxes
    )


def _travel_um(step: Step, chain: Chain, task: Task) -> float:
    """Longest travel of a probe in a move: commands are affine in what is sensed."""
    error = chain.setup.uncertainty.sensed_position
    sides = [(side - error, side + error) for side in (step.pre.x, step.pre.y)]
    corners = itertools.product(*((low.lo, high.hi) for low, high in sides))
    sensed = np.array([(x, y, step.pre.theta.mid) for x, y in corners])
    commands = step.rule.commands(sensed, chain.setup.spacing.mid, np.zeros(len(sensed)))
    return units.to_um(float(np.abs(commands.travel).sum(axis=2).max()))


def enough(budget: Budget, need: Budget) -> bool:
    """Whether a plan keeps within its budget."""
    far = need.radius_um <= budget.radius_um and need.seconds <= budget.seconds
    return far and need.press >= budget.press and need.turn_per_um >= budget.turn_per_um


def roomier(need: Budget) -> Budget:
    """A budget for another try: a little more than was needed."""
    return replace(
        need,
        radius_um=float(math.ceil(1.02 * need.radius_um)),
        seconds=float(math.ceil(1.05 * need.seconds)),
        press=0.99 * need.press,
        turn_per_um=0.95 * need.turn_per_um,
    )
