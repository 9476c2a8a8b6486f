"""Requirements that several moves share: free at the start, a tip that sticks, a tip that passes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.contact import Contact, Turning, place_on_edge
from meso_robust.checker.dual import Dual, Number, Point, once
from meso_robust.checker.film import MOVING
from meso_robust.checker.ids import Must, Named, Objection, named
from meso_robust.checker.outline import Edge, Rectangle
from meso_robust.checker.ranges import Box, Formula
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, Variables, holds
from meso_robust.checker.scene import NAMES, Scene, direction

TURNS = {1: "counter_clockwise", -1: "clockwise"}
UNIT = (arb(0), arb(1))
"""Side of a share between none and all."""
NEAR = 5e-10
"""m and rad: how closely poses after a move are bounded where no sign decides; a box that is stated
has far more room."""


def constant(value: Number) -> Formula:
    """A number as a formula."""
    return lambda at: value if isinstance(value, Dual) else Dual(arb(value))


def touch(scene: Scene, at: Point, side: int) -> Contact:
    """The upper (1) or lower (-1) tip when it touches the part, which has not moved yet."""

    def work() -> Contact:
        c, s = direction(scene.angle(at))
        contact = Contact(c, s, at["depth"], c, scene.radius(at, side))
        return replace(contact, d2=place_on_edge(c, s, contact.out, scene.rise(at, side)))

    return once((id(scene), "touch", side), at, work)


def turning(scene: Scene, at: Point, tip: int, side: int) -> Turning:
    """Turn of the part to ``side`` about the upper (1) or lower (-1) tip, from its touch on."""
    return Turning(touch(scene, at, tip), scene.angle(at), side, scene.film(at))


def free_at_start(scene: Scene, sides: tuple[int, ...]) -> list[Requirement]:
    """The tips stand off the line of the edge."""

    def one(side: int) -> Requirement:
        variables: Variables = {
            "theta": scene.angle,
            "d1": lambda at: at["depth"] + scene.radius(at, side),
            "dx": lambda at: scene.ahead(at, side),
            "dy": lambda at: scene.rise(at, side),
        }
        return Requirement(
            name=named(Must.TIP_FREE_AT_START, tip=NAMES[side]),
            statement=st.CLEARANCE,
            parts=(Part(variables, scene.box),),
        )

    return [one(side) for side in sides]


def on_edge(which: str, scene: Scene, offset: Formula, box: Box) -> Requirement:
    """A contact lies on the straight part of the edge."""
    edge, rectangle = scene.edge, isinstance(scene.outline, Rectangle)
    variables: Variables = {"d2": offset}
    if not (scene.exact("size_other", "kappa") and scene.corner_radius == 0):
        variables = {
            "d2": offset,
            "first": partial(_end, scene, 0),
            "last": partial(_end, scene, 1),
        }
    elif rectangle:
        variables = {"d2": offset, "half": constant(scene.half)}
    else:
        variables = {"d2": offset, "first": constant(edge.first), "last": constant(edge.last)}
    return Requirement(
        name=named(Must.TIP_ON_EDGE, tip=which),
        statement=st.ON_EDGE if rectangle else st.BETWEEN_ENDS,
        parts=(Part(variables, box),),
    )


def _end(scene: Scene, which: int, at: Point) -> Dual:
    """Where the straight part of the edge begins (0) or ends (1), from the foot of the part."""
    if scene.edge.ends is None:
        raise Refused(named(Objection.EDGE_ON_HULL), 0, "1 or more")
    other, sign = scene.edge.ends[which], 2 * which - 1
    corner = (at["kappa_other"] - at["kappa"]) * sign + other.turn
    s, c = corner.sin_cos()
    end = (at["size_other"] + other.d1 - at["depth"] * c) / s
    return (end - (corner / 2).tan() * scene.corner_radius) * sign


def sticks(
    which: str,
    scene: Scene,
    theta: Formula,
    offset: Formula,
    tip: int,
    side: int,
    box: Box,
    ends: tuple[Formula, ...] = (),
) -> list[Requirement]:
    """One tip alone pushes, sticks, turns the part to ``side``, and nothing else can happen.

    ``tip``: the upper (1) or the lower (-1) one, called ``which``. ``theta`` runs over all angles that are passed; ``ends``, if given, are the first and the last of
    them (the part turns one way, which is one of the requirements).
    """
    film, mu = scene.film_variables("_now"), scene.mu(tip)
    variables: Variables = {
        "d1": lambda at: at["depth"],
        "d2": offset,
        "mu": lambda at: at[mu],
        "side": constant(arb(side)),
        **film,
    }
    uneven = " ".join(name for name in film if name != "rho")

    def one(must: Named, statement: st.Statement, keys: str) -> Requirement:
        def part(angle: Formula) -> Part:
            every = {"theta": angle, **variables}
            return Part({key: every[key] for key in keys.split()}, box)

        cover = tuple(map(part, ends)) or None
        return Requirement(name=must, statement=statement, parts=(part(theta),), cover=cover)

    pushed = f"theta d1 d2 {uneven}"
    return [
        one(named(Must.TIP_PUSHES, tip=which), st.PRESSES, f"{pushed} rho"),
        one(named(Must.TIP_STICKS, tip=which), st.STICKS, f"{pushed} rho mu"),
        one(named(Must.TIP_TURNS_PART, tip=which, turn=TURNS[side]), st.TURNS, f"{pushed} side"),
        # it follows from the others (film.py)
        replace(
            one(named(Must.NO_SLIPPING, tip=which), st.ONLY, f"d1 d2 {uneven} rho mu"),
            shown=True,
        ),
    ]


CENTRE = frozenset((*MOVING, *MOVING.values()))
"""Names of the centre of drag."""


def turns_back(which: str, scene: Scene, offset: Formula, side: int, box: Box) -> Requirement:
    """The tip on ``side`` alone would turn the part to that side, whether it sticks or slips."""
    mu = scene.mu(side)
    film = {name: of for name, of in scene.film_variables().items() if name in CENTRE}
    variables: Variables = {
        "d1": lambda at: at["depth"],
        "d2": offset,
        "mu": lambda at: at[mu],
        "side": constant(arb(side)),
        **film,
    }
    return Requirement(
        name=named(Must.TIP_TURNS_PART, tip=which, turn=TURNS[side]),
        statement=st.ANY_WAY,
        parts=(Part(variables, box),),
    )


def beside(scene: Scene, theta: Formula, offset: Formula, flight: Formula, side: int) -> Variables:
    """While one tip is ``flight`` short of its place, the other, on ``side``, is clear of the part."""
    return {
        "theta": theta,
        "d2": offset,
        "half": constant(scene.half),
        "dx": lambda at: flight(at) + scene.to_other(at, side)[0],
        "dy": lambda at: scene.to_other(at, side)[1],
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
    angles: tuple[Formula, ...],
    place: Callable[[Point], tuple[Dual, Dual]],
    side: int,
    box: Box,
) -> Requirement:
    """The idle tip is off the line of one side of the part's convex hull in all states of ``box``.

    ``angles``: the direction of the pushed edge, and if it passes many its first and last one.
    ``place``: where the idle tip, the one on ``side``, is from the part; axes of the travel.
    """
    must = named(Must.IDLE_TIP_PASSES, when=when)

    def off(line: Edge) -> Requirement:
        def part(angle: Formula) -> Part:
            return Part(line_off(scene, line, angle, place, side), box)

        parts, ends = (part(angles[0]),), tuple(map(part, angles[1:]))
        return Requirement(name=must, statement=statement, parts=parts, cover=ends or None)

    lines = scene.outline.sides(scene.edge)
    statement = st.CLEARANCE
    if isinstance(scene.outline, Rectangle):  # the edge's own line, or that of the next one
        lines, statement = (lines[0], lines[-side]), st.BESIDE_ONE
    return any_of([off(line) for line in lines])


def line_off(
    scene: Scene,
    line: Edge,
    angle: Formula,
    place: Callable[[Point], tuple[Dual, Dual]],
    side: int,
) -> Variables:
    """A tip at ``place`` and a side of the hull, as variables of a clearance."""
    return {
        "theta": partial(line_angle, scene, line, angle),
        "d1": lambda at: line_depth(scene, line, at) + scene.radius(at, side),
        "dx": lambda at: place(at)[0],
        "dy": lambda at: place(at)[1],
    }


def any_of(tried: list[Requirement]) -> Requirement:
    """The first of some requirements that is proved; the others may be stated instead of it."""
    for one in tried:
        if all(holds(one.statement, part) for part in one.parts):
            return replace(one, shown=True, instead=tuple(two for two in tried if two is not one))
    return tried[0]


def line_angle(scene: Scene, line: Edge, angle: Formula, at: Point) -> Dual:
    """Direction of a side of the hull when the pushed edge has some direction."""
    found = angle(at) + (scene.turn - line.turn)
    if line.name == scene.edge.name or scene.exact("kappa"):
        return found
    return found - at["kappa"] + (0 if line.ends is None else at["kappa_other"])


def line_depth(scene: Scene, line: Edge, at: Point) -> Dual:
    """How far out the whole part is along its normal."""
    if line.name == scene.edge.name:
        return at["depth"]
    if line.ends is None:
        return Dual(
            line.d1 + scene.outline.astray(scene.box["size_other"], scene.box["kappa_other"])
        )
    return at["size_other"] + line.d1


def comes_free(which: str, angle: Formula, scene: Scene, box: Box) -> Requirement:
    """A tip on the edge leaves its line at once when it backs off along +x (sin(theta) > 0)."""
    variables: Variables = {"theta": angle}
    if not scene.exact("bend_now"):
        variables = {"theta": angle, "bend": lambda at: at["bend_now"]}
    return Requirement(
        name=named(Must.WITHDRAWS_FREE, tips=which),
        statement=st.COMES_FREE,
        parts=(Part(variables, box),),
    )
