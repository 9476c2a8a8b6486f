"""A result as a notebook shows it: the answer, key figures, one picture; nothing from outside."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Sequence

from markupsafe import Markup
from matplotlib.figure import Figure

from meso_robust.reporting.pages import environment
from meso_robust.reporting.svg import style, to_svg

_EVERYWHERE = re.compile(r"<style[^>]*>\s*\*\s*\{([^}]*)\}\s*</style>")
"""The library's rule for all elements: in a notebook these are also those of others."""


def card(
    *,
    word: str,
    colour: str,
    about: str,
    meaning: str,
    figures: Sequence[tuple[str, str]],
    text: str,
    picture: Markup | None = None,
    caption: str = "",
) -> str:
    """An element that can stand in any page, light or dark; every text is escaped.

    Parameters
    ----------
    word, colour
        The verdict, and how it is shown: PROVED (positive), REFUTED, UNKNOWN or NEUTRAL.
    about, meaning
        What the verdict is about, and what it means, in a sentence.
    figures
        Name and value of the key figures.
    text
        The answer as it is printed.
    picture, caption
        An SVG element, and what it shows.
    """
    shown = {"word": word, "colour": colour, "about": about, "meaning": meaning, "text": text}
    drawn = {"figures": figures, "picture": picture, "caption": caption}
    return environment().get_template("card.html.j2").render(card=shown | drawn)


def picture(draw: Callable[[], Figure], text: str, label: str) -> Markup:
    """A figure as an SVG element whose ids and rules are its own.

    Parameters
    ----------
    draw
        Makes the figure.
    text
        What tells one result from another, such as the printed answer: cards stand side by side.
    label
        What it shows.
    """
    name = own_name(text, label)
    with style():
        svg = str(to_svg(draw(), name, label)).replace("<svg", f'<svg id="{name}"', 1)
    return Markup(_EVERYWHERE.sub(rf"<style>#{name} * {{\1}}</style>", svg))


def own_name(text: str, label: str) -> str:
    """What the ids of a picture begin with: cards stand side by side in one page.

    Parameters
    ----------
    text, label
        As for `picture`.

    Returns
    -------
    str
        An id.
    """
    return "c" + hashlib.sha256(f"{label}\0{text}".encode()).hexdigest()[:12]
