"""What every page is made of: a `Report` of a banner, sections and provenance, set by one template."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from meso_robust.reporting.slim import slim
from meso_robust.reporting.theme import themed

Colour = Literal["PROVED", "REFUTED", "UNKNOWN", "NEUTRAL"]
Rows = Sequence[tuple[str, str]]
_CELLS = {"#": "n", "~": "nowrap"}
"""Class of a column's cells by the sign before its head: numbers, and what is not broken."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Banner:
    """What a page leads with."""

    verb: str
    """Of the command line, without the program's name."""
    subject: str
    """What the page is about, in the user's own words: a task, a recording set, a campaign."""
    word: str
    """The verdict."""
    colour: Colour
    meaning: str | Markup
    """The verdict in one sentence."""
    figures: Rows = ()
    """Name and value of the key figures."""
    about: str = ""
    """What else is to be known of the subject."""
    answers: str | Markup = ""
    """What stands between the meaning and the key figures."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A picture with what stands above and below it."""

    svg: Markup
    title: str = ""
    caption: str = ""
    wide: bool = True
    """Whether it takes the whole width of the page, and scrolls where that is too narrow."""
    look: str = ""
    """Class of the style sheet."""


@dataclass(frozen=True, slots=True)
class Section:
    """One heading and what stands under it."""

    anchor: str
    title: str | Markup
    body: Sequence[Markup]
    _: KW_ONLY
    link: str | None = None
    """Its name in the list at the top of the page; its title if None, not listed if empty."""
    look: str | None = None
    """Class of the box around it; None for no box."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """A page."""

    banner: Banner
    sections: Sequence[Section]
    made: Rows
    """Name and value of what it was made from and how to make it again; see `made`."""
    lead: str | Markup = ""
    """What stands before the first section."""
    styles: Sequence[str] = ()
    """Style sheets besides the one of all pages."""
    scripted: bool = False
    """Whether scripts of the page itself may run."""


def page(report: Report, *folders: Path) -> str:
    """A self-contained HTML page; ``folders`` hold style sheets from outside this package.

    Parameters
    ----------
    report
        What stands on it.
    folders
        Where style sheets from outside this package are.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    return environment(*folders).get_template("page.html.j2").render(report=report)


def prose(template: str, *folders: Path, **values: Any) -> Any:
    """The macros of a template, each of them the body of a section.

    Parameters
    ----------
    template
        File of this folder or of ``folders``.
    values
        What its macros show.

    Returns
    -------
    module of the template
        Its macros as attributes; see `section`.
    """
    return environment(*folders).get_template(template).make_module(values)


def section(
    body: Any, anchor: str, title: str | Markup, link: str | None = None, look: str | None = None
) -> Section:
    """The section whose body is the macro ``section_ANCHOR`` of `prose`.

    Parameters
    ----------
    body
        Of `prose`.
    anchor, title, link, look
        As of a `Section`.

    Returns
    -------
    Section
        One piece: what the macro gives.
    """
    pieces = (getattr(body, f"section_{anchor}")(),)
    return Section(anchor, title, pieces, link=link, look=look)


@cache
def environment(*folders: Path) -> Environment:
    """Templates of this folder and of ``folders``; every text is escaped, a missing value is an error."""
    templates = Environment(
        loader=FileSystemLoader([Path(__file__).parent, *folders]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    templates.filters.update(themed=themed, slim=slim)
    templates.globals["table"] = table
    templates.globals["parts"] = templates.get_template("parts.html.j2").module
    return templates


def figure(*figures: Figure) -> Markup:
    """Pictures, one below the other.

    Returns
    -------
    Markup
        One ``<figure>`` each, in the colours of the reader's theme.
    """
    return Markup().join(_part("figure", each) for each in figures)


def table(
    label: str,
    heads: str,
    rows: Iterable[Sequence[str | int]],
    *,
    named: bool = True,
    look: str = "",
    most: int | None = None,
    file: str = "",
) -> Markup:
    """A table that scrolls by itself where the window is too narrow.

    Parameters
    ----------
    label
        What it holds, for readers who do not see it.
    heads, rows
        ``first | second | …``, and a cell for each of them in every row. ``#`` before a head: its
        cells are numbers; ``~``: they are not broken into lines.
    named
        Whether the first cell of a row is its name.
    look
        Class of the style sheet.
    most, file
        How many rows are shown, and which file holds them all.

    Returns
    -------
    Markup
        The table, and below it how many rows are left out.
    """
    columns = [(head.lstrip("#~"), _CELLS.get(head[:1], "")) for head in heads.split(" | ")]
    cells = list(rows)
    return _part("table", label, columns, cells, named, look, most or len(cells), file)


def facts(rows: Rows) -> Markup:
    """Names and values."""
    return _part("facts", rows)


def bullets(texts: Sequence[str], *, most: int | None = None, file: str = "") -> Markup:
    """A list; ``most`` and ``file`` as for a `table`.

    Parameters
    ----------
    texts
        An entry each.
    most, file
        As for a `table`.

    Returns
    -------
    Markup
        An HTML list; texts are escaped.
    """
    return _part("bullets", texts, most or len(texts), file)


def html(text: str, *values: object) -> Markup:
    """HTML of this package, in which ``values`` are set and escaped.

    Parameters
    ----------
    text
        HTML with braces; nothing of a user.
    values
        What stands in the braces.

    Returns
    -------
    Markup
        Safe whatever the values are.
    """
    return Markup(text + "\n").format(*values)


def _part(name: str, *values: object) -> Markup:
    return Markup(getattr(environment().globals["parts"], name)(*values))


def code(text: str, after: str = "") -> Markup:
    """A command or a hash as it is typed, and plain words after it.

    Parameters
    ----------
    text, after
        As typed, and plain words after it.

    Returns
    -------
    Markup
        The text in ``<code>``.
    """
    return Markup("<code>{}</code>{}").format(text, after)


def made(
    command: str,
    *rows: tuple[str, str],
    after: str = "",
    using: Mapping[str, str],
    notes: Iterable[str] = (),
) -> Rows:
    """What a page was made from and how to make it again.

    Parameters
    ----------
    command, after
        What to type, and plain words on it.
    rows
        Name and value of what it was made from.
    using, notes
        Versions of the programs, and what else is to be known of the run.

    Returns
    -------
    rows
        Name and value, for a `Report`.
    """
    versions = " · ".join(f"{name} {version}" for name, version in using.items())
    return (
        ("to reproduce", code(command, after)),
        *rows,
        ("made with", versions),
        *(("note", note) for note in notes),
    )
