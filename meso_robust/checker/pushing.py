"""Requirements that several moves share: free at the start, a tip that sticks, a tip that passes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.contact import Contact, place_on_edge
from meso_robust.checker.dual import Dual, Number, Point
from meso_robust.checker.ids import Must, Named, named
from meso_robust.checker.outline import Edge, Rectangle
from meso_robust.checker.ranges import Box, Formula
from meso_robust.checker.requirement import Part, Requirement, Variables, holds
from meso_robust.checker.scene import Scene, direction

NAMES = {1: "upper", -1: "lower"}
TURNS = {1: "counter_clockwise", -1: "clockwise"}
UNIT = (arb(0), arb(1))
"""Side of a share between none and all."""
Touching = Callable[[Point], Contact]


def constant(value: Number) -> Formula:
    """A number as a formula."""
    return lambda at: value if isinstance(value, Dual) else Dual(arb(value))


def touch(scene: Scene, at: Point, side: int) -> Contact:
    """The upper (1) or lower (-1) tip when it touches the part, which has not moved yet."""
    c, s = direction(at["theta"])
    return Contact(c, s, scene.d1, place_on_edge(c, s, scene.d1, scene.rise(at, side)))


def free_at_start(scene: Scene, sides: tuple[int, ...]) -> list[Requirement]:
    """The tips stand off the line of the edge."""

    def one(side: int) -> Requirement:
        return Requirement(
            name=named(Must.TIP_FREE_AT_START, tip=NAMES[side]),
            statement=st.CLEARANCE,
            parts=(
                Part(
                    {
                        "theta": lambda at: at["theta"],
                        "d1": constant(scene.d1),
                        "dx": lambda at: scene.ahead(at, side),
                        "dy": lambda at: scene.rise(at, side),
                    },
                    scene.box,
                ),
            ),
        )

    return [one(side) for side in sides]


def on_edge(which: str, scene: Scene, offset: Formula, box: Box) -> Requirement:
    """A contact lies between the ends of the edge."""
    edge, statement = scene.edge, st.ON_EDGE
    variables: Variables = {"d2": offset, "half": constant(scene.half)}
    if not isinstance(scene.outline, Rectangle):
        statement = st.BETWEEN_ENDS
        variables = {"d2": offset, "first": constant(edge.first), "last": constant(edge.last)}
    return Requirement(
        name=named(Must.TIP_ON_EDGE, tip=which),
        statement=statement,
        parts=(Part(variables, box),),
    )


def sticks(
    which: str,
    scene: Scene,
    theta: Formula,
    offset: Formula,
    side: int,
    box: Box,
    ends: tuple[Formula, ...] = (),
) -> list[Requirement]:
    """One tip alone pushes, sticks, turns the part to ``side``, and nothing else can happen.

    ``theta`` runs over all angles that are passed; ``ends``, if given, are the first and the last of
    them (the part turns one way, which is one of the requirements).
    """
    variables: Variables = {
        "d1": constant(scene.d1),
        "d2": offset,
        "rho": lambda at: at["rho"],
        "mu": lambda at: at["mu"],
        "side": constant(arb(side)),
    }

    def one(must: Named, statement: st.Statement, keys: str) -> Requirement:
        def part(angle: Formula) -> Part:
            every = {"theta": angle, **variables}
            return Part({key: every[key] for key in keys.split()}, box)

        cover = tuple(map(part, ends)) or None
        return Requirement(name=must, statement=statement, parts=(part(theta),), cover=cover)

    return [
        one(named(Must.TIP_PUSHES, tip=which), st.PRESSES, "theta d1 d2 rho"),
        one(named(Must.TIP_STICKS, tip=which), st.STICKS, "theta d1 d2 rho mu"),
        one(named(Must.TIP_TURNS_PART, tip=which, turn=TURNS[side]), st.TURNS, "theta d1 d2 side"),
        one(named(Must.NO_SLIPPING, tip=which), st.ONLY, "d1 d2 rho mu"),
    ]


def beside(scene: Scene, theta: Formula, offset: Formula, flight: Formula, side: int) -> Variables:
    """While one tip is ``flight`` short of its place, the other, on ``side``, is clear of the part."""
    return {
        "theta": theta,
        "d2": offset,
        "half": constant(scene.half),
        "dx": lambda at: flight(at) - scene.lag(at, side) * 2,
        "dy": constant(scene.spacing * side),
        "side": constant(arb(side)),
    }


def passes(
    when: str, parts: tuple[Part, ...], cover: tuple[Part, ...] | None = None
) -> Requirement:
    """The idle tip is clear of the part in all ``parts`` (variables as from :func:`beside`)."""
    must = named(Must.IDLE_TIP_PASSES, when=when)
    return Requirement(name=must, statement=st.BESIDE, parts=parts, cover=cover)


def passes_hull(
    when: str,
    scene: Scene,
    offset: Formula,
    flight: Formula,
    side: int,
    angles: tuple[Formula, ...],
    box: Box,
) -> Requirement:
    """The idle tip is off the line of one side of the part's convex hull in all states of ``box``.

    ``angles``: the direction of the pushed edge, and if it passes many its first and last one.
    """
    must = named(Must.IDLE_TIP_PASSES, when=when)

    def off(line: Edge) -> Requirement:
        def part(angle: Formula) -> Part:
            return Part(_off_side(scene, line, angle, offset, flight, side), box)

        parts, ends = (part(angles[0]),), tuple(map(part, angles[1:]))
        return Requirement(name=must, statement=st.CLEARANCE, parts=parts, cover=ends or None)

    tried = [off(line) for line in scene.outline.sides(scene.edge)]
    shown = [one for one in tried if holds(one.statement, one.parts[0])] or tried
    return replace(shown[0], instead=tuple(shown[1:]))


def _off_side(
    scene: Scene, line: Edge, angle: Formula, offset: Formula, flight: Formula, side: int
) -> Variables:
    """The idle tip, on ``side``, from the centre, and a side of the convex hull."""

    def contact(at: Point) -> Contact:
        return Contact(*direction(angle(at)), scene.d1, offset(at))

    return {
        "theta": lambda at: angle(at) + (scene.turn - line.turn),
        "d1": constant(line.d1),
        "dx": lambda at: contact(at).arm_x + flight(at) - scene.lag(at, side) * 2,
        "dy": lambda at: contact(at).arm_y + scene.spacing * side,
    }


def comes_free(which: str, theta: Formula, box: Box) -> Requirement:
    """A tip on the edge leaves its line at once when it backs off along +x (sin(theta) > 0)."""
    return Requirement(
        name=named(Must.WITHDRAWS_FREE, tips=which),
        statement=st.COMES_FREE,
        parts=(Part({"theta": theta}, box),),
    )
