"""Named boxes over which a basis is proved, and wider ones over which it must not be."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from meso_robust.basis.contact import FIXTURE, Contact, Corner, Mode, Mover, Part, Tip, symbol
from meso_robust.basis.support import Support, diagonal_film, film, limit_surface, mixture
from meso_robust.bounds import Interval

LONG, SHORT = 1616e-6, 837e-6
RECTANGLE = Part.rectangle(LONG, SHORT)
HEXAGON = Part(tuple((600e-6 * math.cos(k * math.pi / 3), 600e-6 * math.sin(k * math.pi / 3)) for k in range(6)))  # fmt: skip
TRIANGLE = Part(((-500e-6, -300e-6), (700e-6, -300e-6), (-200e-6, 600e-6)))
L_SHAPE = Part(
    (
        (-600e-6, -500e-6), (600e-6, -500e-6), (600e-6, -100e-6),
        (-100e-6, -100e-6), (-100e-6, 500e-6), (-600e-6, 500e-6),
    )
)  # fmt: skip

FRICTION = {"mu": Interval(0.30, 0.36)}
RATIO = {"rho": Interval(3.4e-7, 4.1e-7)}
STICK, PLUS, MINUS, OPEN = Mode.STICK, Mode.SLIP_PLUS, Mode.SLIP_MINUS, Mode.OPEN

Ends = tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Example:
    """A named problem: a box to be proved, and what widens it too far."""

    name: str
    part: Part
    contacts: tuple[Contact, ...]
    support: Support
    modes: tuple[Mode, ...]
    box: Mapping[str, Interval]
    wider: Mapping[str, Interval]
    """Sides of the box that are replaced."""

    @property
    def wide_box(self) -> dict[str, Interval]:
        """The widened box."""
        return {**self.box, **self.wider}


def degrees(low: float, high: float) -> Interval:
    """An interval of angles whose ends are the doubles nearest to the degrees given."""
    return Interval(math.radians(low), math.radians(high))


def um(low: float, high: float) -> Interval:
    """An interval of lengths, likewise."""
    return Interval(low * 1e-6, high * 1e-6)


LEFT = Mover((-1.0, 0.0))
PROBE = Mover(("u_x", "u_y"))
ONE = (Tip(edge=0, at="d2", friction="mu", mover=LEFT),)
PAIR = (*ONE, Tip(edge=0, at=symbol("d2") - symbol("d4"), friction="mu", mover=LEFT))
OFF_CENTRE = film(1.0, "e_xy", "e_xt", "e_yy", "e_yt", "rho")
UNEVEN = {
    "e_xy": Interval(0.02, 0.06),
    "e_xt": um(10, 30),
    "e_yy": Interval(1.1, 1.3),
    "e_yt": um(-40, -20),
}


def examples() -> tuple[Example, ...]:
    """All of them."""
    return (*_rectangles(), *_polygons(), *_supports(), *_slot())


def _rectangles() -> tuple[Example, ...]:
    paper = {**FRICTION, **RATIO}
    spacing = {"d4": um(300, 310)}
    return (
        Example(
            name="one tip on the long edge sticks (Lemma 1)",
            part=RECTANGLE, contacts=ONE, support=diagonal_film("rho"), modes=(STICK,),
            box={"theta": degrees(92, 114), "d2": um(340, 360), **paper},
            wider={"theta": degrees(92, 129)},
        ),
        Example(
            name="the same, past the limit: slips",
            part=RECTANGLE, contacts=ONE, support=diagonal_film("rho"), modes=(MINUS,),
            box={"theta": degrees(126, 140), "d2": um(340, 360), **paper},
            wider={"theta": degrees(112, 140)},
        ),
        Example(
            name="two tips stick (eq. 9)",
            part=RECTANGLE, contacts=PAIR, support=diagonal_film("rho"), modes=(STICK, STICK),
            box={"theta": degrees(84, 96), "d2": um(120, 180), **spacing, **paper},
            wider={"theta": degrees(72, 108)},
        ),
        Example(
            name="two tips, one of them loses touch: the centre beyond the pair",
            part=RECTANGLE, contacts=PAIR, support=diagonal_film("rho"), modes=(OPEN, STICK),
            box={"theta": degrees(88, 92), "d2": um(430, 450), **spacing, **paper},
            wider={"d2": um(300, 450)},
        ),
    )  # fmt: skip


def _polygons() -> tuple[Example, ...]:
    paper = {**FRICTION, "rho": Interval(2.4e-7, 3.0e-7)}
    return (
        Example(
            name="hexagon, off-centre anisotropic film, one tip sticks",
            part=HEXAGON, support=OFF_CENTRE, modes=(STICK,),
            contacts=(Tip(edge=1, at="d2", friction="mu", mover=PROBE),),
            box={"theta": degrees(-5, 5), "d2": um(-60, -20), "u_x": Interval(-0.05, 0.05),
                 "u_y": Interval(-1.0, -1.0), **UNEVEN, **paper},
            wider={"theta": degrees(-35, 5)},
        ),
        Example(
            name="triangle, one tip slips",
            part=TRIANGLE, support=OFF_CENTRE, modes=(MINUS,),
            contacts=(Tip(edge=0, at="d2", friction="mu", mover=PROBE),),
            box={"theta": degrees(-4, 4), "d2": um(150, 250), "u_x": Interval(0.9, 1.1),
                 "u_y": Interval(1.0, 1.0), **UNEVEN, **paper},
            wider={"u_x": Interval(-0.2, 1.1)},
        ),
        Example(
            name="L-shape, two tips on the two sides of the notch stick",
            part=L_SHAPE, support=diagonal_film("rho"), modes=(STICK, STICK),
            contacts=(Tip(edge=2, at="low", friction="mu", mover=PROBE),
                      Tip(edge=3, at="side", friction="mu", mover=PROBE)),
            box={"theta": degrees(-3, 3), "low": um(-320, -280), "side": um(180, 220),
                 "u_x": Interval(-1.1, -0.9), "u_y": Interval(-1.0, -1.0), **paper},
            wider={"u_x": Interval(-1.1, 1.0)},
        ),
    )  # fmt: skip


def _supports() -> tuple[Example, ...]:
    paper = {**FRICTION, **RATIO}
    box = {"theta": degrees(96, 110), "d2": um(340, 360), **paper}
    surface = limit_surface(1.0, 0.0, 0.0, 1.0, 0.0, "rho")
    stiff = limit_surface(1.0, 0.0, 0.0, Interval(0.95, 1.05), 0.0, Interval(3.0e-7, 3.3e-7))
    return (
        Example(
            name="one tip on a limit surface",
            part=RECTANGLE, contacts=ONE, support=surface, modes=(STICK,), box=box,
            wider={"theta": degrees(80, 110)},
        ),
        Example(
            name="one tip on film and limit surface in any proportion",
            part=RECTANGLE, contacts=ONE, support=mixture(diagonal_film("rho"), stiff),
            modes=(STICK,), box=box, wider={"theta": degrees(80, 110)},
        ),
    )  # fmt: skip


def _slot() -> tuple[Example, ...]:
    """The part in a slot along -x: two tips on its short edge, its rear corner on the upper wall."""
    paper = {**FRICTION, **RATIO, "wall": Interval(0.1, 0.2)}
    tips = (
        Tip(edge=3, at="upper", friction="mu", mover=PROBE),
        Tip(edge=3, at="lower", friction="mu", mover=PROBE),
    )
    wall = Corner(corner=0, normal=(0.0, -1.0), friction="wall", mover=FIXTURE)
    pushed = {"u_x": Interval(-1.0, -1.0), "u_y": Interval(0.02, 0.05), **paper}
    return (
        Example(
            name="slot: two tips push and slide, the rear corner slides along the wall",
            part=RECTANGLE, contacts=(*tips, wall), support=diagonal_film("rho"),
            modes=(MINUS, MINUS, PLUS),
            box={"theta": degrees(180.2, 181), "upper": um(140, 160), "lower": um(-160, -140), **pushed},
            wider={"u_y": Interval(-0.05, 0.05)},
        ),
        Example(
            name="slot: both tips stick, the corner leaves the wall",
            part=RECTANGLE, contacts=(*tips, wall), support=diagonal_film("rho"),
            modes=(STICK, STICK, OPEN),
            box={"theta": degrees(180.2, 181), "upper": um(140, 160), "lower": um(-160, -140),
                 **pushed, "u_y": Interval(-0.05, -0.025)},
            wider={"u_y": Interval(-0.05, 0.05)},
        ),
        Example(
            name="slot: one tip sticks, the front corner slides along the wall",
            part=RECTANGLE, support=diagonal_film("rho"), modes=(STICK, PLUS),
            contacts=(tips[1], Corner(corner=1, normal=(0.0, -1.0), friction="wall")),
            box={"theta": degrees(177, 179), "lower": um(-220, -180), **pushed,
                 "u_y": Interval(-0.02, 0.02)},
            wider={"lower": um(-220, 220)},
        ),
    )  # fmt: skip
