"""Pictures as values: shapes in the units of their axes, which become SVG without a plotting library."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup, escape

from meso_robust.primitives.setup import PoseBox
from meso_robust.reporting import plot
from meso_robust.reporting.canvas import AXIS_NAME, Coordinate, ends
from meso_robust.reporting.plot import Area
from meso_robust.reporting.theme import INK, PAPER
from meso_robust.types import Floats

Ends = tuple[float, float]

INCH = 72.0  # pt
LEFT, BOTTOM, RIGHT, TOP = 0.66 * INCH, 0.46 * INCH, 0.18 * INCH, 0.10 * INCH
"""Room beside the axes for their names and numbers, pt."""
STRIP, BETWEEN = 0.42 * INCH, 0.56 * INCH
"""Height of a strip under the axes, and the room over it, pt."""

ACROSS, UPWARD = 60.0, 32.0
"""Room that each number of an axis has, pt."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """How a shape is drawn: colours, or ``none``; lengths in pt."""

    fill: str = "none"
    line: str = "none"
    width: float = 1.0
    dash: str = ""
    opacity: float = 1.0

    def svg(self) -> str:
        """Attributes of an element."""
        stroke = f' stroke="{self.line}" stroke-width="{self.width:g}"' * (self.line != "none")
        dash = f' stroke-dasharray="{self.dash}"' * bool(self.dash)
        faint = f' opacity="{self.opacity:g}"' * (self.opacity != 1.0)
        return f' fill="{self.fill}"{stroke}{dash}{faint}'


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Line:
    """(N, 2) points joined by a line, which may be closed."""

    name: str
    points: Floats
    look: Look
    closed: bool = False

    def svg(self, area: Area) -> str:
        """A path."""
        across, down = area.at(self.points[:, 0], self.points[:, 1])
        way = "M" + "L".join(_pairs(across, down)) + "Z" * self.closed
        return f'<path d="{way}"{self.look.svg()} stroke-linejoin="round"/>'


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Boxes:
    """(N, 4) rectangles by their left, right, low and high ends."""

    name: str
    ends: Floats
    look: Look

    def svg(self, area: Area) -> str:
        """All in one path."""
        left, top = area.at(self.ends[:, 0], self.ends[:, 3])
        right, bottom = area.at(self.ends[:, 1], self.ends[:, 2])
        way = "".join(
            f"M{x0:.2f} {y0:.2f}H{x1:.2f}V{y1:.2f}H{x0:.2f}Z"
            for x0, y0, x1, y1 in np.stack([left, top, right, bottom], axis=1).tolist()
        )
        return f'<path d="{way}"{self.look.svg()}/>'


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Dots:
    """A disc at each of (N, 2) points."""

    name: str
    points: Floats
    radius: float
    """pt."""
    look: Look

    def svg(self, area: Area) -> str:
        """A group, so that what all share is stated once; dots that cover one another stay visible."""
        across, down = area.at(self.points[:, 0], self.points[:, 1])
        discs = "".join(
            f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{self.radius:g}"/>'
            for x, y in zip(across.tolist(), down.tolist(), strict=True)
        )
        faint = self.look.svg().replace(" opacity=", " fill-opacity=")
        return f"<g{faint}>{discs}</g>"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arrow:
    """From one point (2,) to another."""

    name: str
    start: Floats
    end: Floats
    colour: str

    def svg(self, area: Area) -> str:
        """A line and a head, both as long as there is room for."""
        across, down = area.at(*np.stack([self.start, self.end]).T)
        ends = np.stack([across, down], axis=1)
        length = float(np.hypot(*(ends[1] - ends[0])))
        if length == 0.0:
            return ""
        along = (ends[1] - ends[0]) / length
        neck = ends[1] - min(6.0, length) * along
        side = 2.2 * np.array([-along[1], along[0]])
        head = "L".join(_pairs(*np.stack([neck + side, ends[1], neck - side]).T))
        (tail,), (stop,) = _pairs(*ends[:1].T), _pairs(*neck[None].T)
        return (
            f'<path d="M{tail}L{stop}" stroke="{self.colour}" stroke-width="1.1" fill="none"/>'
            f'<path d="M{head}Z" fill="{self.colour}"/>'
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Words:
    """A text beside a point (2,), on a ground of paper, or in a disc of ink upon the point."""

    name: str
    text: str
    point: Floats
    colour: str = INK
    size: float = 8.5
    """pt."""
    shift: float = 0.0
    """To the right if positive, to the left if negative, and as much upon the point if 0; pt."""
    disc: float = 0.0
    """Radius, pt; 0 without."""

    def svg(self, area: Area) -> str:
        """A text and its ground."""
        across, down = (float(one) for one in area.at(*self.point))
        anchor = "middle" if self.shift == 0.0 else "start" if self.shift > 0.0 else "end"
        colour, ground = self.colour, f' paint-order="stroke" stroke="{PAPER}" stroke-width="3"'
        disc = ""
        if self.disc:
            colour, ground = PAPER, ' font-weight="bold"'
            disc = (
                f'<circle cx="{across:.2f}" cy="{down:.2f}" r="{self.disc:g}" fill="{INK}" '
                f'stroke="{PAPER}" stroke-width="0.8"/>'
            )
        return (
            f'{disc}<text x="{across + self.shift:.2f}" y="{down + 0.36 * self.size:.2f}" '
            f'text-anchor="{anchor}" font-size="{self.size:g}"{ground} stroke-linejoin="round" '
            f'style="fill: {colour}">{escape(self.text)}</text>'
        )


Shape = Line | Boxes | Dots | Arrow | Words


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Axes:
    """Shapes in an area with axes, in the order of drawing; what lies outside is cut off."""

    area: Area
    x_name: str
    y_name: str = ""
    """Empty: what is upward has no numbers, either."""
    shapes: Sequence[Shape]

    def svg(self, clip: str) -> str:
        """The axes and what is in them; ``clip`` is an id of the page."""
        area = self.area
        most = area.wide / ACROSS, area.tall / UPWARD * bool(self.y_name)
        frame = area.frame(self.x_name, self.y_name, most=most)
        place = (
            f'x="{area.left:.2f}" y="{area.top:.2f}" width="{area.wide:.2f}" '
            f'height="{area.tall:.2f}"'
        )
        return (
            f'<g class="axes">{frame}</g><clipPath id="{clip}"><rect {place}/></clipPath>'
            f'<g clip-path="url(#{clip})">{"".join(shape.svg(area) for shape in self.shapes)}</g>'
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """Axes beside and under one another; sizes in pt."""

    width: float
    height: float
    axes: tuple[Axes, ...]

    def svg(self, name: str, label: str) -> Markup:
        """An ``<svg>`` element.

        Parameters
        ----------
        name
            Prefix of all ids, so that they are unique in a page of several pictures.
        label
            What it shows, for readers who do not see it.

        Returns
        -------
        Markup
            The same bytes whenever and wherever it is drawn; no width or height of its own.
        """
        parts = (axes.svg(f"{name}-{number}") for number, axes in enumerate(self.axes))
        return plot.picture(self.width, self.height, label, parts)


def faces(
    name: str, boxes: Sequence[PoseBox], across: Coordinate, up: Coordinate, look: Look
) -> Boxes:
    """Faces of boxes of poses, um and deg.

    Parameters
    ----------
    name, look
        What they are called and how they are drawn.
    boxes, across, up
        The boxes, and which two of their sides.
    """
    sides = [[*ends(box, across), *ends(box, up)] for box in boxes]
    return Boxes(name=name, ends=np.array(sides).reshape(-1, 4), look=look)


def room(width: float, height: float, *, strip: bool = False) -> tuple[float, float]:
    """Size of the axes in a picture of a size in inches, pt; with or without a strip under them."""
    under = STRIP + BETWEEN if strip else 0.0
    return width * INCH - LEFT - RIGHT, height * INCH - TOP - BOTTOM - under


def panel(
    width: float,
    height: float,
    limits: tuple[Ends, Ends],
    shapes: Sequence[Shape],
    up: Coordinate = "y",
) -> Picture:
    """One pair of axes that fills a picture; sizes in inches.

    Parameters
    ----------
    width, height
        Of the picture.
    limits, shapes
        Of x and of what is upward, um and deg; and what is drawn.
    up
        What is upward.

    Returns
    -------
    Picture
        The margins leave room for the axes' names only.
    """
    wide, tall = room(width, height)
    area = Area(LEFT, TOP, wide, tall, *limits)
    axes = Axes(area=area, x_name=AXIS_NAME["x"], y_name=AXIS_NAME[up], shapes=shapes)
    return Picture(width=width * INCH, height=height * INCH, axes=(axes,))


def panel_and_strip(
    width: float,
    height: float,
    x: Ends,
    y: Ends,
    theta: Ends,
    shapes: Sequence[Shape],
    in_strip: Sequence[Shape],
) -> Picture:
    """Axes of x and y, and under them a strip of theta from 0 to 1; sizes in inches.

    Parameters
    ----------
    width, height
        Of the picture.
    x, y, theta
        Limits, um and deg.
    shapes, in_strip
        What is drawn.
    """
    wide, tall = room(width, height, strip=True)
    plane = Area(LEFT, TOP, wide, tall, x, y)
    below = Area(LEFT, TOP + tall + BETWEEN, wide, STRIP, theta, (-0.12, 1.12))
    axes = (
        Axes(area=plane, x_name=AXIS_NAME["x"], y_name=AXIS_NAME["y"], shapes=shapes),
        Axes(area=below, x_name=AXIS_NAME["theta"], shapes=in_strip),
    )
    return Picture(width=width * INCH, height=height * INCH, axes=axes)


def _pairs(across: Floats, down: Floats) -> list[str]:
    """Points of the picture, to a hundredth of a point: finer than any screen or printer."""
    return [f"{x:.2f} {y:.2f}" for x, y in zip(across.tolist(), down.tolist(), strict=True)]
