"""Equations written in plain text, set for a page: italic symbols, sub- and superscripts."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

_MINUS, _PRIME = "−", "′"
_LETTER = "[A-Za-zµΑ-Ωα-ω]"  # not the raised and lowered ones, which stand as they are
_PATTERN = re.compile(
    r"(?P<unit>(?<=\d )s\b|(?<=m/)s\b)"
    r"|(?P<article>\ba(?= [a-z]{2}))"
    rf"|(?P<word>{_LETTER}{{2,}}('s\b)?)"
    rf"|(?P<symbol>{_LETTER})"
    r"|_(?P<sub>[^\W_]+)"
    r"|\^\((?P<power>[^()]*)\)"
    r"|\^(?P<short>[^\W_]+)"
    rf"|(?P<index>(?<={_LETTER})\d+)"
    r"|(?P<minus>-)"
    r"|(?P<prime>')"
    r"|(?P<rest>.)",
    re.DOTALL,
)


def typeset(equation: str) -> Markup:
    """An equation of plain text as HTML; every sign of it is escaped.

    Single letters are symbols and set italic, longer words and functions upright; ``v_s`` and ``k1``
    have subscripts, ``v^(n−1)`` a superscript. An ``a`` before a word is the article.

    Parameters
    ----------
    equation
        As in the catalogue of effects.
    """
    return Markup("").join(_set(found) for found in _PATTERN.finditer(equation))


def _set(found: re.Match[str]) -> Markup:
    kind, text = str(found.lastgroup), found[str(found.lastgroup)]
    if kind == "symbol":
        return Markup("<i>{}</i>").format(text)
    if kind in ("sub", "index"):
        # a subscript of one letter is a symbol, a longer one a name
        return Markup("<sub>{}</sub>").format(typeset(text) if len(text) == 1 else text)
    if kind in ("power", "short"):
        return Markup("<sup>{}</sup>").format(typeset(text))
    return escape({"minus": _MINUS, "prime": _PRIME}.get(kind, text))
