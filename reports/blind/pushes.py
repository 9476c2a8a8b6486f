"""The experiments: which pushes a laboratory records when it wants to know, or does not care."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from reports.blind.world import LENGTH, TIP_RADIUS, WIDTH, Push

Floats = npt.NDArray[np.float64]

FRAME_RATE = 30.0
SPEEDS = (25.0, 75.0, 225.0)
LONGEST = {25.0: 170.0, 75.0: 560.0, 225.0: 600.0}
"""Longest push at each speed, so that a recording stays below 12 s."""
RETRACT = 60.0
BACK_OFF = 30.0
AIM = np.array([1.0, 1.0, np.radians(0.08)])
"""Errors of the sensed pose that a push is aimed with, um and rad."""
FAR = 1e4
"""Time at which the last corner of a path may lie, s."""


@dataclass(frozen=True, slots=True)
class Plan:
    """One push about the part: where, whither, how fast, and from which pose of the part."""

    edge: int
    """0 below, 1 right, 2 above, 3 left, at heading 0."""
    place: float
    """Along the edge, counter-clockwise, from -1 to 1."""
    slant: float
    """Of the travel against the edge's normal, rad."""
    speed: float
    length: float
    gap: float
    start: tuple[float, float, float]
    wait: float = 0.4
    reversal: bool = False
    rest: float = 0.7
    retract: float = RETRACT


def contact_point(edge: int, place: float) -> tuple[Floats, Floats]:
    """Point of the outline and the outward normal there, frame of the part."""
    angle = 0.5 * np.pi * (edge - 1)
    normal = np.array([round(np.cos(angle)), round(np.sin(angle))], dtype=np.float64)
    along = np.array([-normal[1], normal[0]])
    half = 0.5 * np.array([LENGTH, WIDTH])
    return np.asarray((normal + place * along) * half), normal


def turned(vector: Floats, angle: float) -> Floats:
    """A vector (2,) turned counter-clockwise."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def commanded(plan: Plan, aim: Floats) -> Push:
    """The push as commanded with an error `aim` (3,) of the sensed pose."""
    sensed = np.array(plan.start) + aim
    point, normal = contact_point(plan.edge, plan.place)
    travel = turned(turned(-normal, plan.slant), sensed[2])
    touch = sensed[:2] + turned(point + TIP_RADIUS * normal, sensed[2])
    stops = [-plan.gap, -plan.gap]
    if plan.reversal:
        stops += [-0.5 * plan.gap, -0.5 * plan.gap - BACK_OFF]
    stops += [plan.length]
    if plan.retract:
        stops += [plan.length - plan.retract]
    spans = np.abs(np.diff(stops)) / plan.speed
    spans[0] = plan.wait
    times = np.concatenate([[0.0], np.cumsum(spans)])
    end = times[-1] + plan.rest
    way = touch + np.outer([*stops, stops[-1]], travel)
    frames = np.arange(int(end * FRAME_RATE) + 1) / FRAME_RATE
    return Push(np.append(times, FAR), way, np.array(plan.start), frames)


def diagnostic(rng: np.random.Generator, count: int = 16) -> list[Plan]:
    """All edges, three speeds, random poses, idle and retract, half of it paired."""
    singles = count - 2 * (count // 4)
    plans = [_random(rng, k) for k in range(singles)]
    kinds = rng.permutation(["speed", "place", "heading", "later", "flip", "mirror"])
    for k in range(count // 4):
        first = replace(_random(rng, k), speed=75.0)
        plans += [first, _twin(first, str(kinds[k % len(kinds)]), rng)]
    return [plans[k] for k in rng.permutation(len(plans))]


def lazy(rng: np.random.Generator, count: int = 16) -> list[Plan]:
    """One edge, one speed, one place, no retract, no idle."""
    heading = rng.uniform(-np.pi, np.pi)
    edge, place = int(rng.integers(4)), float(rng.uniform(0.2, 0.6) * rng.choice([-1, 1]))
    plans = []
    for _ in range(count):
        start = (*rng.uniform(-30.0, 30.0, 2), heading + rng.uniform(-0.03, 0.03))
        slant = float(rng.uniform(-0.05, 0.05))
        length, gap = float(rng.uniform(400.0, 500.0)), float(rng.uniform(15.0, 25.0))
        plans.append(
            Plan(edge, place, slant, 75.0, length, gap, start, wait=0.1, rest=0.0, retract=0.0)
        )
    return plans


DESIGNS = {"diagnostic": diagnostic, "lazy": lazy}


def _pose(rng: np.random.Generator) -> tuple[float, float, float]:
    reach = 1500.0 if rng.random() < 0.2 else 500.0
    return (*rng.uniform(-reach, reach, 2), float(rng.uniform(-np.pi, np.pi)))


def _random(rng: np.random.Generator, k: int) -> Plan:
    """A push at a random place; edges and speeds take turns."""
    speed = SPEEDS[(k // 4 + k) % 3]
    place = float(rng.uniform(-0.85, 0.85))
    # Near a corner the travel leans inwards, lest the tip slides off the edge.
    lean = np.sign(place) if abs(place) > 0.5 else float(rng.choice([-1.0, 1.0]))
    return Plan(
        edge=k % 4,
        place=place,
        slant=float(lean * rng.uniform(0.0, 0.35)),
        speed=speed,
        length=min(float(rng.uniform(400.0, 600.0)), LONGEST[speed]),
        gap=float(rng.uniform(15.0, 25.0)),
        start=_pose(rng),
        reversal=bool(rng.random() < 0.35) and speed > SPEEDS[0],
    )


def _twin(first: Plan, kind: str, rng: np.random.Generator) -> Plan:
    """The same push about the part, but for one thing."""
    x, y, heading = first.start
    near = (x + rng.uniform(-15.0, 15.0), y + rng.uniform(-15.0, 15.0), heading)
    if kind == "speed":
        speed = float(rng.choice([25.0, 225.0]))
        length = min(first.length, LONGEST[speed])
        return replace(first, start=near, speed=speed, length=length, reversal=False)
    if kind == "later":
        return replace(first, start=near, wait=first.wait + float(rng.uniform(1.5, 2.5)))
    if kind == "place":
        return replace(first, start=(*_pose(rng)[:2], heading))
    if kind == "heading":
        return replace(first, start=(*near[:2], float(rng.uniform(-np.pi, np.pi))))
    if kind == "flip":
        return replace(first, start=(*near[:2], heading + np.pi), edge=(first.edge + 2) % 4)
    return replace(first, start=near, place=-first.place, slant=-first.slant)
