"""The register as one page that needs nothing else: no scripts, no outside references."""

from __future__ import annotations

import re
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

import meso_robust.reporting
from derivations._claim import Verdict
from derivations.report import notation
from derivations.report.figures import Picture
from derivations.report.formulas import to_html
from derivations.report.register import MARKS, Chapter, tally
from derivations.report.witnesses import values

FOLDERS = (Path(__file__).parent, Path(meso_robust.reporting.__file__).parent)
STANDS = (Verdict.CONFIRMED, Verdict.SHARPENED)


def page(register: tuple[Chapter, ...], drawn: tuple[Picture, ...]) -> str:
    """The page, verdicts first.

    Parameters
    ----------
    register, drawn
        What it shows.

    Raises
    ------
    DerivationError
        Names the claim of a text that cannot be typeset.
    """
    environment = Environment(
        loader=FileSystemLoader(FOLDERS),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(tex=to_html, values=values, code=_code)
    return environment.get_template("register.html.j2").render(
        register=register,
        counts=tally(register),
        headline=headline(register),
        marks=MARKS,
        drawn=drawn,
        notation=notation,
    )


def _code(text: str) -> Markup:
    """Plain text with commands between backquotes."""
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))


def headline(register: tuple[Chapter, ...]) -> str:
    """How many printed statements stand."""
    counts = tally(register)
    printed = sum(counts.values()) - counts[Verdict.NEW]
    return notation.headline(sum(counts[verdict] for verdict in STANDS), printed)
