"""A first contact that slips while it turns the part back: how far it can slip, and what that costs.

Let the part turn to ``side``, the contact being at ``r = d2 a + d1 n`` from the centre of drag, and let
the part slide by ``u`` along ``a`` over the tip per unit of travel. With the names of ``film.py`` the
part's point under the tip moves along ``a`` by ``u`` more than the tip, so

    omega F = p s - q c + q u,    f_a F = -(C (c - u) + A s),    -f_n F = A (c - u) + B s

At the ratio ``k`` of ``f_a`` to the pressing force this gives ``u (C + k A) = C c + A s + k (A c + B s)``: with
``C + k A > 0`` for all ``|k| <= mu`` and ``s > 0`` the contact presses, ``u`` grows with k, and there is one
motion. It does not slide against ``side`` if sticking needs less than ``mu`` in that sense. Sliding to
``side`` friction is at its end, ``k = -side mu``, and with ``X = -(mu N + side T)`` of sticking, ``N`` and ``T``
its forces times F, ``side u (C - side mu A) = X``. Per turn, ``F`` and the divisor cancelling,

    d(slip)/d(angle) = X / (D s (side d2 - mu d1)),    D = 1 - stretch^2 - shear^2

The slip is thought to stay below ``m = creep |f(first) - f(now)|`` with ``f = cos^3 + cos/256``, which grows along the turn
by ``creep s (3 c^2 + 1/256)``. **If at slip ``m`` it grows more slowly than ``m``, whatever the instant, it never passes
m**: both begin at zero, and at a first passage it would have to grow at least as fast. Where ``X`` is
negative the contact sticks.

What slips to ``side`` turns the part by ``q u`` per travel more than what sticks at the same place, so the
travel until the other tip touches is at most the integral of the sticking contact's over the turn, at
the worst place that it can have slipped to.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable
from typing import Any

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.film import Arm
from meso_robust.checker.ids import Must, named
from meso_robust.checker.pushing import TURNS
from meso_robust.checker.ranges import (
    ZERO,
    Box,
    Formula,
    Side,
    positive,
    side_of,
    span,
    whole,
)
from meso_robust.checker.requirement import Part, Requirement, Variables
from meso_robust.checker.rows import most_of
from meso_robust.checker.scene import NAMES, Scene

SLIPPED, MOST, TURNED = "creep_now", "creep_most", "turned"
"""Variables: ``slip = creep_now |f(first) - f(now)|``, the largest ``creep_now``, and the turn so far."""
SMALLEST, LARGEST, GROWTH, HALVINGS = arb("0.25"), 40, arb("1.2"), 3
"""Of ``creep`` over the depth of the edge, and how closely the smallest one is looked for; effort of the
search, no proof rests on it."""
STAGE, PIECE = 0.01, 0.01
"""rad of the turn and of the orientation before it, in which travel is bounded."""
NEAR, CUTS = 1e-4, 4
"""m/rad: how closely the travel of a turn is; how often a box is cut in four for that."""
Offset = Callable[[Point, Dual, Dual | None], Dual]
"""Place of the contact along the edge at an angle of the edge, with its slip so far (or none)."""


@dataclasses.dataclass(frozen=True, slots=True)
class Slip:
    """That the first contact slips to its own side, and by how much at most."""

    box: Box
    """The variables of the move and those of the slip."""
    requirements: tuple[Requirement, ...]
    """In the place of those of a tip that sticks."""


def slipped(creep: Dual, first: Dual, now: Dual) -> Dual:
    """How far a contact has slipped along ``a``; from the direction of the edge at the touch and now."""
    c, c_now = first.sin_cos()[1], now.sin_cos()[1]
    return creep * (c.squared() * c - c_now.squared() * c_now + (c - c_now) / 256)


def slip_of(scene: Scene, side: int, box: Box, aligned: Formula, offset: Offset) -> Slip | None:
    """The smallest bound of the slip that is found and proved; None if there is none.

    Parameters
    ----------
    scene, side, box
        The move, the tip that touches first, and the variables.
    aligned
        Direction of the edge when both tips touch.
    offset
        Place of the contact.
    """

    def turn(at: Point) -> Dual:
        return (aligned(at) - scene.angle(at)) * side

    longest = span(turn, box)[1]
    if not longest > 0:
        return None
    wide: Box = {**box, TURNED: (ZERO, longest)}
    creep = _creep(scene, side, wide, offset)
    if creep is None:
        return None
    found = {**wide, SLIPPED: (ZERO, creep), MOST: side_of(creep)}
    return Slip(found, _requirements(scene, side, found, aligned, offset))


def _along(scene: Scene, side: int, offset: Offset, creep: str, angle: Formula) -> Variables:
    """Variables of one contact at an instant."""
    mu = scene.mu(side)
    return {
        "theta": angle,
        "d1": lambda at: at["depth"],
        "d2": lambda at: offset(at, angle(at), at[creep]),
        "mu": lambda at: at[mu],
        "side": lambda at: Dual(arb(side)),
        **scene.film_variables("_now"),
    }


def _bounded(scene: Scene, side: int, box: Box, offset: Offset) -> Part:
    def angle(at: Point) -> Dual:
        return scene.angle(at) + at[TURNED] * side

    variables = {**_along(scene, side, offset, MOST, angle), "creep": lambda at: at[MOST]}
    return Part(variables, box)


def _creep(scene: Scene, side: int, box: Box, offset: Offset) -> arb | None:
    """The smallest guess that is proved."""
    part = _bounded(scene, side, box, offset)

    def less(at: Point) -> Dual:
        return st.CREEPS_LESS.of({name: of(at) for name, of in part.variables.items()}, ZERO)[0]

    def proved(creep: arb) -> bool:
        return positive(less, {**box, MOST: side_of(creep)})

    depth = scene.d1.mid()
    low = creep = (depth * SMALLEST).mid()
    while not proved(creep):
        if not creep < depth * LARGEST:
            return None
        low, creep = creep, (creep * GROWTH).mid()
    for _ in range(HALVINGS):
        middle = ((low + creep) / 2).mid()
        low, creep = (low, middle) if proved(middle) else (middle, creep)
    return creep


def _requirements(
    scene: Scene, side: int, box: Box, aligned: Formula, offset: Offset
) -> tuple[Requirement, ...]:
    which, share = NAMES[side], {**box, "share": (ZERO, arb(1))}

    def angle(at: Point) -> Dual:
        first = scene.angle(at)
        return first + at["share"] * (aligned(at) - first)

    every = _along(scene, side, offset, SLIPPED, angle)
    turns = {key: of for key, of in every.items() if key != "rho"}
    return (
        Requirement(
            name=named(Must.TIP_PUSHES, tip=which),
            statement=st.SLIPS_ONE_WAY,
            parts=(Part(every, share),),
        ),
        Requirement(
            name=named(Must.SLIP_BOUNDED, tip=which),
            statement=st.CREEPS_LESS,
            parts=(_bounded(scene, side, box, offset),),
        ),
        Requirement(
            name=named(Must.TIP_TURNS_PART, tip=which, turn=TURNS[side]),
            statement=st.TURNS_BACK,
            parts=(Part(turns, share),),
        ),
    )


def spare(
    scene: Scene, side: int, aligned: Formula, offset: Offset, travel: Formula, at: Point
) -> Dual:
    """A lower bound of the travel that is left when both tips touch, over a box seen as a point."""
    box: Box = {name: _side(value) for name, value in at.items()}

    def rate(at: Any) -> Any:
        """Travel per turn of a contact that sticks where this one is."""
        angle = scene.angle(at) + at[TURNED] * side
        s, c = angle.sin_cos()
        arm = Arm.of(at["depth"], offset(at, angle, at[SLIPPED]), scene.film(at, "_now"))
        return arm.stiffness / (arm.turn(c, s) * side)

    def turn(at: Point) -> Dual:
        return (aligned(at) - scene.angle(at)) * side

    parts: list[Box] = [{**box, "theta": theta} for theta in _parts(box["theta"], PIECE)]
    stages = [_parts((ZERO, span(turn, part)[1].max(ZERO)), STAGE) for part in parts]
    pieces = [
        {**part, TURNED: stage} for part, own in zip(parts, stages, strict=True) for stage in own
    ]
    rates = iter(most_of(rate, pieces, NEAR, CUTS))
    left = [
        span(travel, part)[0] - sum((next(rates) * (end - start) for start, end in own), ZERO)
        for part, own in zip(parts, stages, strict=True)
    ]
    low = left[0]
    for one in left[1:]:
        low = low.min(one)
    return Dual(low.lower() if low.is_finite() else arb("-inf"))


def _side(value: Dual) -> Side:
    if not value.slopes:
        return side_of(value.value)
    return value.value.lower(), value.value.upper()


def _parts(side: Side, length: float) -> list[Side]:
    """A range in parts of about this length."""
    count = max(1, round(float(whole(side).rad()) * 2 / length))
    cuts = [
        side[0],
        *((side[0] + (side[1] - side[0]) * k / count).mid() for k in range(1, count)),
        side[1],
    ]
    return list(itertools.pairwise(cuts))
