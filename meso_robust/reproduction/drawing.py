"""A drawing as a picture of an item."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec

from matplotlib.figure import Figure as Drawing

from meso_robust.reporting.pages import Figure
from meso_robust.reporting.svg import style, to_svg

Given = ParamSpec("Given")


def pictured(
    name: str, caption: str, label: str = ""
) -> Callable[[Callable[Given, Drawing]], Callable[Given, Figure]]:
    """Let a function that makes a drawing return the picture; arguments as of `drawn`."""

    def of(draw: Callable[Given, Drawing]) -> Callable[Given, Figure]:
        @wraps(draw)
        def picture(*args: Given.args, **kwargs: Given.kwargs) -> Figure:
            return drawn(lambda: draw(*args, **kwargs), name, caption, label)

        return picture

    return of


def drawn(draw: Callable[[], Drawing], name: str, caption: str, label: str = "") -> Figure:
    """Draw in the report's style.

    Parameters
    ----------
    draw
        Makes the drawing.
    name
        Prefix of its ids.
    caption
        What it shows.
    label
        The same in fewer words, for readers who do not see it; the caption by default.
    """
    with style():
        return Figure(svg=to_svg(draw(), name, label or caption), caption=caption)
