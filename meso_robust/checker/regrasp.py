"""A re-grasp: the pair of tips travels in the plane beside the part, which stays at rest."""

from __future__ import annotations

from functools import partial

from meso_robust.checker import statement as st
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.ids import Must, Property, named
from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.outline import Edge
from meso_robust.checker.passage import Passage
from meso_robust.checker.pushing import UNIT, line_off
from meso_robust.checker.ranges import shift
from meso_robust.checker.requirement import Part, Requirement, holds, prove
from meso_robust.checker.scene import NAMES, Scene


def check_regrasp(scene: Scene) -> Passage:
    """Prove that each tip stays beyond one edge of the part all the way.

    Raises
    ------
    Refused
        It does not follow.
    """
    requirements = tuple(_clear(scene, side) for side in (1, -1))
    for requirement in requirements:
        prove(requirement)
    box = scene.box
    at_rest = PoseBox(x=box["x"], y=box["y"], theta=shift(box["theta"], scene.turn))
    return Passage(
        does=named(Property.PART_RESTS),
        post=at_rest,
        requirements=requirements,
    )


def _clear(scene: Scene, side: int) -> Requirement:
    """One side of the convex hull has the whole way of a tip on its outer side."""
    tried = [_beyond(scene, side, edge) for edge in scene.outline.sides(scene.edge)]
    return next((one for one in tried if holds(one.statement, one.parts[0])), tried[0])


def _beyond(scene: Scene, side: int, edge: Edge) -> Requirement:
    place = partial(_place, scene, side)
    return Requirement(
        name=named(Must.TIP_CLEAR_OF_PART, tip=NAMES[side]),
        statement=st.CLEARANCE,
        parts=(
            Part(line_off(scene, edge, scene.angle, place, side), {**scene.box, "share": UNIT}),
        ),
    )


def _place(scene: Scene, side: int, at: Point) -> tuple[Dual, Dual]:
    """A tip on its way, from the part, axes of the travel."""
    first = scene.ahead(at, side)
    return first + at["share"] * (scene.ahead_end(at, side) - first), scene.rise(at, side)
