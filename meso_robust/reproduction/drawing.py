"""A matplotlib figure as a picture of an item."""

from __future__ import annotations

from collections.abc import Callable

from meso_robust.reproduction.item import Figure


def drawn(draw: Callable[[], object], name: str, caption: str) -> Figure:
    """Draw in the report's style.

    Parameters
    ----------
    draw
        Makes the matplotlib figure.
    name
        Prefix of its ids.
    caption
        What it shows.

    Raises
    ------
    TypeError
        If something else is made.
    """
    from matplotlib.figure import Figure as Canvas

    from meso_robust.reporting.svg import style, to_svg

    with style():
        canvas = draw()
        if not isinstance(canvas, Canvas):
            raise TypeError(f"{name}: must be drawn on a matplotlib figure")
        return Figure(svg=to_svg(canvas, name, caption), caption=caption)
