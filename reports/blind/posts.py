"""Pushes about a hidden post: some end where they would just touch it, the others stay clear."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from reports.blind.kernel import nearest
from reports.blind.pushes import Plan, commanded, contact_point, turned
from reports.blind.world import World, run

Floats = npt.NDArray[np.float64]

TOUCHING = 5
"""Pushes across the part that end at the post."""
STAGGER = 15.0
"""How far before the post the pushes end at most, um."""
CLEAR = 400.0
"""Distance that the other parts keep from the post, um."""
OUT = 3000.0
"""Where parts are put of which no nearby place is clear, um."""


def paths(plan: Plan, world: World) -> Floats:
    """(T, 3) poses that the push takes the part through without a post."""
    push = commanded(plan, np.zeros(3))
    return run(world, push, push.frames)[0]


def distance(world: World, poses: Floats, place: Floats) -> float:
    """Smallest distance of the part's outline from a place, over poses (T, 3)."""
    outline = world.outline()
    gaps = []
    for pose in poses:
        x, y = turned(place - pose[:2], -pose[2])
        gaps.append(nearest(outline, x, y)[3])
    return float(min(gaps))


def moved(plan: Plan, shift: Floats) -> Plan:
    """The push somewhere else on the stage."""
    x, y, heading = plan.start
    return replace(plan, start=(x + shift[0], y + shift[1], heading))


def laid(
    plans: list[Plan], world: World, place: Floats, radius: float, rng: np.random.Generator
) -> list[Plan]:
    """The pushes moved so that they suit a post of a radius at a place (2,) of the stage."""
    wide = [k for k, plan in enumerate(plans) if plan.edge % 2 == 0]
    chosen = set(rng.permutation(wide)[:TOUCHING].tolist())
    return [
        _ending_at(plan, world, place, radius, rng)
        if k in chosen
        else _clear_of(plan, world, place, radius, rng)
        for k, plan in enumerate(plans)
    ]


def _ending_at(
    plan: Plan, world: World, place: Floats, radius: float, rng: np.random.Generator
) -> Plan:
    """A push that ends with the far edge at the post, or a little before it.

    The post is so far off the line of the push that this leaves both friction cones: the part turns
    about it and does not jam. Of a part pushed lengthways no place is as far off.
    """
    end = paths(plan, world)[-1]
    facing = -plan.place
    aside = facing + float(rng.uniform(0.65, 0.85)) * (-1.0 if facing > 0.0 else 1.0)
    point, normal = contact_point((plan.edge + 2) % 4, aside)
    front = end[:2] + turned(point + (radius + rng.uniform(0.0, STAGGER)) * normal, end[2])
    return moved(plan, place - front)


def _clear_of(
    plan: Plan, world: World, place: Floats, radius: float, rng: np.random.Generator
) -> Plan:
    """The push itself if it stays clear of the post, or else one at a place that does."""
    poses = paths(plan, world)
    for reach in np.linspace(0.0, OUT, 40):
        shift = reach * turned(np.array([1.0, 0.0]), rng.uniform(-np.pi, np.pi))
        if distance(world, poses + np.array([*shift, 0.0]), place) > radius + CLEAR:
            return moved(plan, shift)
    return moved(plan, np.array([OUT, 0.0]))
