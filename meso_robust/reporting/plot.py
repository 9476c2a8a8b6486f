"""Plain plots as SVG, without a plotting library: what a page of many small pictures is drawn with.

Loading a plotting library takes longer than checking a hundred recordings.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup, escape

from meso_robust.reporting.theme import FRAME, GRID, INK, MUTED
from meso_robust.types import Floats

_TICKS = 5.0  # aimed at on an axis
_FONT = 9.0  # pt, as of the other pictures of a report


@dataclass(frozen=True, slots=True)
class Area:
    """A rectangle of a picture with axes.

    Attributes
    ----------
    left, top, wide, tall
        Where it is, in points from the upper left corner.
    x, y
        Limits of the axes.
    """

    left: float
    top: float
    wide: float
    tall: float
    x: tuple[float, float]
    y: tuple[float, float]

    def at(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Points of the picture for values.

        Parameters
        ----------
        x, y
            Values of equal shape.

        Returns
        -------
        (…,), (…,)
            From the left and from the top.
        """
        across = self.left + (np.asarray(x) - self.x[0]) / (self.x[1] - self.x[0]) * self.wide
        down = self.top + (self.y[1] - np.asarray(y)) / (self.y[1] - self.y[0]) * self.tall
        return np.asarray(across), np.asarray(down)

    def frame(
        self,
        x_label: str = "",
        y_label: str = "",
        *,
        numbers: bool = True,
        most: tuple[float, float] = (_TICKS, _TICKS),
    ) -> str:
        """Box, grid, ticks and names of the axes.

        Parameters
        ----------
        x_label, y_label
            Names; empty for none.
        numbers
            Whether the x axis has numbers.
        most
            How many numbers x and y have at most.

        Returns
        -------
        str
            SVG.
        """
        bottom = self.top + self.tall
        parts = []
        for value in ticks(*self.x, most[0]):
            across = float(self.at(np.array(value), np.array(self.y[0]))[0])
            parts.append(_rule(across, self.top, across, bottom, GRID))
            if numbers:
                parts.append(_text(across, bottom + 11.0, _number(value), MUTED, "middle"))
        for value in ticks(*self.y, most[1]):
            down = float(self.at(np.array(self.x[0]), np.array(value))[1])
            parts.append(_rule(self.left, down, self.left + self.wide, down, GRID))
            parts.append(_text(self.left - 4.0, down + 3.0, _number(value), MUTED, "end"))
        parts.append(
            f'<rect x="{self.left:.2f}" y="{self.top:.2f}" width="{self.wide:.2f}" '
            f'height="{self.tall:.2f}" fill="none" stroke="{FRAME}" stroke-width="0.7"/>'
        )
        middle = self.left + 0.5 * self.wide
        if x_label:
            parts.append(_text(middle, bottom + 23.0, x_label, INK, "middle"))
        if y_label:
            at = self.top + 0.5 * self.tall
            turn = f' transform="rotate(-90 {self.left - 34.0:.2f} {at:.2f})"'
            parts.append(_text(self.left - 34.0, at, y_label, INK, "middle", turn))
        return "".join(parts)

    def line(
        self, x: Floats, y: Floats, colour: str, width: float = 1.0, dash: str = "", fill: str = ""
    ) -> str:
        """A line that is broken at NaN, with a dot where a point stands alone.

        Parameters
        ----------
        x, y
            (N,) values.
        colour, width, dash
            Of the stroke; pt.
        fill
            Colour of its inside; none if empty.

        Returns
        -------
        str
            SVG.
        """
        across, down = self.at(x, y)
        seen = np.flatnonzero(np.isfinite(across) & np.isfinite(down))
        if not seen.size:
            return ""
        pieces = []
        for run in np.split(seen, np.flatnonzero(np.diff(seen) > 1) + 1):
            points = [f"{across[k]:.2f} {down[k]:.2f}" for k in run.tolist()]
            # a line of no length with round ends is a dot
            pieces.append(f"M{points[0]}L{'L'.join(points[1:] or points)}")
        style = f' stroke-dasharray="{dash}"' if dash else ""
        return (
            f'<path d="{"".join(pieces)}" fill="{fill or "none"}" stroke="{colour}" '
            f'stroke-width="{width:g}" stroke-linecap="round" stroke-linejoin="round"{style}/>'
        )

    def dots(self, x: Floats, y: Floats, colour: str, radius: float = 1.6) -> str:
        """Dots at (N,) values, NaN left out; ``radius`` in pt."""
        across, down = self.at(x, y)
        return "".join(
            f'<circle cx="{a:.2f}" cy="{d:.2f}" r="{radius:g}" fill="{colour}"/>'
            for a, d in zip(across.tolist(), down.tolist(), strict=True)
            if math.isfinite(a) and math.isfinite(d)
        )

    def band(self, first: float, last: float, colour: str, opacity: float = 1.0) -> str:
        """A band of the whole height between two values of x."""
        ends = np.clip([first, last], *self.x)
        left, right = self.at(ends, np.full(2, self.y[0]))[0].tolist()
        return (
            f'<rect x="{left:.2f}" y="{self.top:.2f}" width="{right - left:.2f}" '
            f'height="{self.tall:.2f}" fill="{colour}" fill-opacity="{opacity:g}"/>'
        )


def picture(width: float, height: float, label: str, parts: Iterable[str]) -> Markup:
    """An ``<svg>`` element.

    Parameters
    ----------
    width, height
        In pt; the page scales it.
    label
        What it shows, for readers who do not see it.
    parts
        SVG, in the order of drawing.

    Returns
    -------
    Markup
        The same bytes whenever and wherever it is drawn.
    """
    return Markup(
        f'<svg role="img" viewBox="0 0 {width:g} {height:g}" xmlns="http://www.w3.org/2000/svg" '
        f'font-size="{_FONT:g}"><title>{escape(label)}</title>{"".join(parts)}</svg>'
    )


def ticks(low: float, high: float, most: float = _TICKS) -> Sequence[float]:
    """Round values between two limits.

    Parameters
    ----------
    low, high
        Limits, ``low`` below ``high``.
    most
        How many are wanted at most, but for one; none below 1.

    Returns
    -------
    list of float
        Multiples of 1, 2 or 5 times a power of ten.
    """
    if most < 1:
        return []
    rough = (high - low) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= rough)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]


def limits(values: Floats, pad: float = 0.07) -> tuple[float, float]:
    """Limits that show all finite values with some space around them; 0 … 1 of none."""
    seen = values[np.isfinite(values)]
    if not seen.size:
        return 0.0, 1.0
    low, high = float(seen.min()), float(seen.max())
    space = pad * (high - low) if high > low else pad * max(abs(high), 1.0)
    return low - space, high + space


def equal(
    points: Floats, wide: float, tall: float, pad: float = 0.05
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Limits of x and y that show (N, 2) points at one scale in an area of a size in pt."""
    low, high = points.min(axis=0), points.max(axis=0)
    size = (high - low) + 2.0 * pad * max(float((high - low).max()), 1.0)
    scale = max(size[0] / wide, size[1] / tall)
    x, y = (0.5 * (low + high)).tolist()
    half_x, half_y = 0.5 * scale * wide, 0.5 * scale * tall
    return (x - half_x, x + half_x), (y - half_y, y + half_y)


def _rule(x0: float, y0: float, x1: float, y1: float, colour: str) -> str:
    return (
        f'<line x1="{x0:.2f}" y1="{y0:.2f}" x2="{x1:.2f}" y2="{y1:.2f}" stroke="{colour}" '
        'stroke-width="0.6"/>'
    )


def _text(x: float, y: float, words: str, colour: str, anchor: str, more: str = "") -> str:
    return (
        f'<text x="{x:.2f}" y="{y:.2f}" fill="{colour}" text-anchor="{anchor}"{more}>'
        f"{escape(words)}</text>"
    )


def _number(value: float) -> str:
    return f"{value + 0.0:.6g}".replace("-", "\N{MINUS SIGN}")
