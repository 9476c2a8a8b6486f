"""The register as one page that needs nothing else: no scripts, no outside references."""

from __future__ import annotations

import re
from pathlib import Path

from markupsafe import Markup, escape

from derivations._claim import Verdict
from derivations.report import notation
from derivations.report.figures import Picture
from derivations.report.formulas import to_html
from derivations.report.register import MARKS, Chapter, tally
from derivations.report.witnesses import values
from meso_robust.reporting import pages

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
    here = Path(__file__).parent
    body = pages.prose(
        "register.html.j2",
        here,
        register=register,
        counts=tally(register),
        marks=MARKS,
        drawn=drawn,
        notation=notation,
        tex=to_html,
        values=values,
        code=_code,
    )
    return pages.page(
        pages.Report(
            banner=pages.Banner(
                verb="derive",
                subject="register of claims",
                word=headline(register),
                colour="NEUTRAL",
                meaning=notation.ABOUT_REGISTER,
                answers=body.answers(),
            ),
            sections=(
                pages.section(body, "overview", "Overview"),
                pages.section(body, "notation", "Notation and signs", "Notation"),
                pages.section(body, "pictures", "Pictures"),
                pages.section(body, "checking", "How to check"),
                *(
                    pages.Section(
                        f"file-{chapter.name}",
                        to_html(chapter.title, chapter.name),
                        link=chapter.name.replace("_", " "),
                        look="chapter",
                        body=(body.chapter(chapter),),
                    )
                    for chapter in register
                ),
            ),
            made=(
                (
                    "to reproduce",
                    pages.code("meso-robust derive", "; written by it, not to be edited"),
                ),
                (
                    "to check",
                    pages.code("meso-robust derive --check", " fails if anything on disk differs"),
                ),
            ),
            styles=("register.css",),
        ),
        here,
    )


def _code(text: str) -> Markup:
    """Plain text with commands between backquotes."""
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))


def headline(register: tuple[Chapter, ...]) -> str:
    """How many printed statements stand."""
    counts = tally(register)
    printed = sum(counts.values()) - counts[Verdict.NEW]
    return notation.headline(sum(counts[verdict] for verdict in STANDS), printed)
