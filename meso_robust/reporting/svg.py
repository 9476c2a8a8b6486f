"""Figures as SVG that can stand in a page: same bytes every time, no outside references."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import matplotlib
from markupsafe import Markup, escape
from matplotlib.figure import Figure

from meso_robust.reporting.theme import FRAME, GRID, INK, MUTED

STYLE = {
    "axes.axisbelow": True,
    "axes.edgecolor": FRAME,
    "axes.grid": True,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.unicode_minus": True,
    "font.size": 9.0,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "path.simplify": False,
    "svg.fonttype": "none",  # text stays text: searchable, and set in the page's own font
    "text.parse_math": False,  # names of files and probes are no formulas, whatever signs they have
    "svg.hashsalt": "meso-robust",  # otherwise the ids differ from run to run
    "xtick.color": MUTED,
    "ytick.color": MUTED,
}
NUMBERS = re.compile(r' (d|x|y)="([^"]*)"')
LONG = re.compile(r"(\.\d{2})\d+")


@contextmanager
def style(*, formulas: bool = False) -> Iterator[None]:
    """Draw in the report's style, whatever the user's own configuration of the library says.

    Parameters
    ----------
    formulas
        Whether text between dollar signs is a formula.

    Returns
    -------
    context manager
        In force until the block ends.
    """
    with matplotlib.rc_context(), warnings.catch_warnings():
        # text is set by the browser, so it does not matter what letters the library's font lacks
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        warnings.filterwarnings("ignore", message="Matplotlib currently does not support")
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE | {"text.parse_math": formulas})
        yield


def to_svg(figure: Figure, name: str, label: str) -> Markup:
    """An ``<svg>`` element of the figure.

    Parameters
    ----------
    figure
        What to write.
    name
        Prefix of all ids, so that they are unique in a page of several figures.
    label
        What the figure shows, for readers who do not see it.

    Returns
    -------
    Markup
        The same bytes whenever and wherever it is drawn; no width or height of its own.
    """
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :].rstrip()
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->\s*", "", text, flags=re.DOTALL)
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'(url\(|href=")#', rf"\1#{name}-", text)
    # a hundredth of a point is finer than any screen or printer
    text = NUMBERS.sub(lambda found: LONG.sub(r"\1", found.group()), text)
    opening = re.sub(r' (width|height)="[^"]*"', "", text[: text.index(">") + 1])
    opening = opening.replace("<svg", '<svg role="img"', 1)
    return Markup(opening + f"<title>{escape(label)}</title>" + text[text.index(">") + 1 :])
