"""Texts that hold LaTeX between dollar signs, as MathML for pages and as Markdown.

Everything between formulas is plain text and is escaped. An odd number of dollar signs or an empty
formula is an error: a dollar sign was lost, or a formula stands within another.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from functools import cache

from latex2mathml.converter import convert
from markupsafe import Markup, escape

from derivations._statement import DerivationError

TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[^\\]", re.DOTALL)
OPENING = {"{", "(", "[", r"\{", r"\left", r"\begin", r"\lbrace", r"\langle"}
CLOSING = {"}", ")", "]", r"\}", r"\right", r"\end", r"\rbrace", r"\rangle"}
DELIMITED = {r"\left", r"\right", r"\big", r"\Big"}
RELATIONS = {
    *"=<>",
    *(r"\le", r"\ge", r"\leq", r"\geq", r"\lt", r"\gt", r"\ne", r"\neq", r"\approx", r"\sim"),
    *(r"\Rightarrow", r"\Leftrightarrow", r"\implies", r"\iff", r"\to", r"\in", r"\equiv"),
}
SHORTEST = 24  # characters of LaTeX between two places where a line may break
SIGNS = {"+", "-"}
INFIX_SHOWN = {"±", "∓", "⟹", "⟺", "→", "∈", "⊥", "∥"}  # taken for letters by the converter
SIGNS_SHOWN = {"+", "−", "±", "∓"}
SHUT = {")", "]", "}", "′", "!"}
SPACE = re.compile(r"^(\\[ ,:;!]|\\quad|\\qquad|~)\s*")
ELEMENTS = {
    *("math", "mrow", "mi", "mo", "mn", "mtext", "mspace", "mfrac", "msqrt", "mroot", "msub"),
    *("msup", "msubsup", "mover", "munder", "munderover", "mtable", "mtr", "mtd", "mstyle"),
}
FUNCTIONS = {
    "sin",
    "cos",
    "tan",
    "atan",
    "asin",
    "acos",
    "arctan",
    "cot",
    "ln",
    "exp",
    "max",
    "min",
}
NAMESPACE = ' xmlns="http://www.w3.org/1998/Math/MathML"'  # a page needs none
# as the backslash of a command before punctuation is eaten by Markdown
IN_MARKDOWN = {
    r"\{": r"\lbrace ",
    r"\}": r"\rbrace ",
    r"\,": r"\thinspace ",
    r"\:": r"\medspace ",
    r"\;": r"\thickspace ",
    r"\!": r"\negthinspace ",
    r"\ ": r"\enspace ",
    r"\|": r"\Vert ",
    r"\\": r"\cr ",
    "|": r"\vert ",
    "<": r"\lt ",
    ">": r"\gt ",
    "*": r"\ast ",
}


def parts(text: str, where: str) -> Iterator[tuple[bool, str]]:
    """Pieces of a text in turn, each with whether it is a formula.

    Parameters
    ----------
    text
        LaTeX between dollar signs, plain text elsewhere.
    where
        Named if the text is faulty.

    Raises
    ------
    DerivationError
        If a dollar sign has no partner or a formula is empty.
    """
    pieces = text.split("$")
    if len(pieces) % 2 == 0:
        raise DerivationError(f"{where}: a dollar sign without its partner in: {text}")
    for number, piece in enumerate(pieces):
        is_formula = number % 2 == 1
        if is_formula and not piece.strip():
            raise DerivationError(f"{where}: an empty formula in: {text}")
        if piece:
            yield is_formula, piece.strip() if is_formula else piece


def to_html(text: str, where: str) -> Markup:
    """HTML of a text; arguments as of :func:`parts`."""
    return Markup("").join(
        _to_mathml(piece, where) if is_formula else escape(piece)
        for is_formula, piece in parts(text, where)
    )


def to_markdown(text: str, where: str) -> str:
    """Markdown of a text; arguments as of :func:`parts`."""
    return "".join(
        f"${_markdown_formula(piece)}$" if is_formula else plain_markdown(piece)
        for is_formula, piece in parts(text, where)
    )


def plain_markdown(text: str) -> str:
    """Markdown that shows a plain text as it stands."""
    return re.sub(r"([\\`*_\[\]<>|#~$])", r"\\\1", text).replace("&", "&amp;")


def _markdown_formula(latex: str) -> str:
    short = (IN_MARKDOWN.get(token, token) for token in TOKEN.findall(latex))
    return re.sub(r"\s+", " ", "".join(short)).strip()


def breakable(latex: str) -> list[str]:
    """A long formula cut before its outermost relations and sums and after its outermost commas.

    Browsers break lines between formulas, but not within one.
    """
    found, depth, in_bars, last = [""], 0, False, ""
    for token in TOKEN.findall(latex):
        names_delimiter = last in DELIMITED
        outermost = depth == 0 and not in_bars
        binary = last not in {"", ",", *SIGNS, *RELATIONS}
        if outermost and (token in RELATIONS or (token in SIGNS and binary)):
            found.append("")
        found[-1] += token
        if not names_delimiter:
            depth += (token in OPENING) - (token in CLOSING)
            in_bars ^= token == "|"
        if outermost and token == ",":
            found.append("")
        last = last if token.isspace() else token
    stripped = [SPACE.sub("", piece.strip()) for piece in found]
    return _joined([piece for piece in stripped if piece])


def _joined(pieces: list[str]) -> list[str]:
    """Short pieces put back: a line shall not break after the first letter of a formula."""
    found: list[str] = []
    for piece in pieces:
        if found and len(found[-1]) < SHORTEST:
            found[-1] += f"\\ {piece}" if found[-1].endswith(",") else f" {piece}"
        else:
            found.append(piece)
    return found


def _to_mathml(latex: str, where: str) -> Markup:
    try:
        shown, gap = Markup(""), Markup("")
        for number, piece in enumerate(breakable(latex)):
            shown += gap + _one_mathml(piece, number > 0)
            gap = Markup(" " if piece.endswith(",") else "<wbr>")
        return shown
    except Exception as error:
        raise DerivationError(f"{where}: ${latex}$ is not understood: {error!r}") from error


@cache
def _one_mathml(latex: str, continues: bool) -> Markup:
    """MathML of a formula or, if it ``continues`` one, of a further piece of it."""
    tree = ET.fromstring(convert(latex).replace(NAMESPACE, ""))
    _refuse_foreign(tree)
    first = tree[0][0] if len(tree[0]) else None
    if continues and first is not None and first.tag == "mo":
        first.set("form", "infix")
    for letter in tree.iter("mi"):
        letter.tag = "mo" if letter.text in INFIX_SHOWN else letter.tag
    for row in tree.iter("mrow"):
        _set_forms(row)
        _space_functions(row)
    return Markup(ET.tostring(tree, encoding="unicode"))


def _refuse_foreign(tree: ET.Element) -> None:
    """Let through nothing but the elements of formulas, without links or commands left over."""
    for element in tree.iter():
        if element.tag not in ELEMENTS:
            raise ValueError(f"element {element.tag}")
        if "href" in element.attrib:
            raise ValueError("a link")
        if "\\" in (element.text or ""):
            raise ValueError(f"unknown command {element.text}")


def _set_forms(row: ET.Element) -> None:
    """Tell signs from sums, and opening from closing bars, so that they are spaced as in print."""
    bars = 0
    for before, child in zip([None, *row], row, strict=False):
        if child.tag != "mo" or "form" in child.attrib:
            continue
        if child.text in SIGNS_SHOWN and _expects_operand(before):
            child.set("form", "prefix")
        if child.text == "|":
            child.set("form", "postfix" if bars % 2 else "prefix")
            bars += 1


def _space_functions(row: ET.Element) -> None:
    """A thin space before the name of a function, and before its argument without parentheses."""
    children = list(row)
    row[:] = []
    for before, child, after in zip(
        [None, *children], children, [*children[1:], None], strict=False
    ):
        base = child[0] if child.tag in {"msup", "msub"} else child
        is_name = base.text in FUNCTIONS
        if is_name:
            base.tag = "mi"
        if is_name and not _expects_operand(before):
            row.append(ET.Element("mspace", width="0.17em"))
        row.append(child)
        if is_name and after is not None and _first(after).tag != "mo":
            row.append(ET.Element("mspace", width="0.17em"))


def _expects_operand(before: ET.Element | None) -> bool:
    """Whether what follows ``before`` starts a term: at the beginning and after an operator."""
    if before is None or before.tag == "mspace":
        return True
    return before.tag == "mo" and before.get("form") != "postfix" and before.text not in SHUT


def _first(element: ET.Element) -> ET.Element:
    while element.tag == "mrow" and len(element):
        element = element[0]
    return element
