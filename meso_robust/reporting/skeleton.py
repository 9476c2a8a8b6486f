"""What all pages share: banner, sections, provenance, and ``skeleton.html.j2`` to extend."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from meso_robust.reporting.slim import slim
from meso_robust.reporting.theme import themed

Colour = Literal["PROVED", "REFUTED", "UNKNOWN", "NEUTRAL"]
Rows = Iterable[tuple[str, str]]


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
    figures: tuple[tuple[str, str], ...] = ()
    """Name and value of the key figures."""
    about: str = ""
    """What else is to be known of the subject."""


def page(template: str, banner: Banner, made: Rows, **values: Any) -> str:
    """A self-contained HTML page.

    Parameters
    ----------
    template
        File of this folder that extends the skeleton.
    banner
        What the page leads with.
    made
        Name and value of what it was made from and how to make it again; see `command`.
    values
        What else the template shows.
    """
    return environment().get_template(template).render(banner=banner, made=tuple(made), **values)


def environment(*folders: Path) -> Environment:
    """Templates of this folder and of ``folders``; every text is escaped, a missing value is an error."""
    found = Environment(
        loader=FileSystemLoader([Path(__file__).parent, *folders]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    found.filters.update(themed=themed, slim=slim)
    return found


def code(text: str, after: str = "") -> Markup:
    """A command or a hash as it is typed, and plain words after it."""
    return Markup("<code>{}</code>{}").format(text, after)


def versions(made_with: Mapping[str, str]) -> tuple[str, str]:
    """The row on what a page was made with."""
    return "made with", " · ".join(f"{name} {value}" for name, value in made_with.items())
