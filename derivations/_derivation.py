"""The values a derivation returns: checked statements and the functions to generate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

import sympy as sp


class Status(Enum):
    """What the machine found of a printed statement; always computed, never typed in."""

    CONFIRMED = "confirmed"
    REFUTED = "refuted: the derivation gives something else"
    DERIVED = "not in the paper: derived here"


@dataclass(frozen=True, slots=True, kw_only=True)
class Statement:
    """One checked statement of the paper, or a new one."""

    place: str
    """Where it stands in the paper, or what it is for."""
    text: str
    """The statement as derived, in words and symbols."""
    status: Status
    """Computed by the derivation from a symbolic identity or an exact witness."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Derivation:
    """What one derivation file contributes."""

    name: str
    """File name without ``.py``; also the name of the generated module."""
    summary: str
    """One sentence for the head of the generated module."""
    statements: tuple[Statement, ...]
    functions: Mapping[str, tuple[tuple[sp.Symbol, ...], tuple[sp.Expr, ...], str]]
    """name -> (arguments, results, what it returns)"""


class DerivationError(AssertionError):
    """A step of a derivation that must hold does not; the file must be mended before use."""


def require_zero(expression: sp.Expr, step: str) -> None:
    """Stop unless ``expression`` vanishes identically.

    Raises
    ------
    DerivationError
        Names the step and shows what is left over.
    """
    rest = sp.simplify(expression)
    if rest != 0:
        raise DerivationError(f"{step}: expected 0, but {rest} is left over")


def verdict(difference: sp.Expr) -> Status:
    """CONFIRMED when ``difference`` (printed minus derived) vanishes identically.

    REFUTED needs a witness: a rational point at which it is different from zero to 40 digits.

    Raises
    ------
    DerivationError
        If neither can be shown.
    """
    rest = sp.simplify(difference)
    if rest == 0:
        return Status.CONFIRMED
    symbols = sorted(rest.free_symbols, key=str)
    signs = [-1 if symbol.is_negative else 1 for symbol in symbols]
    point = {
        s: sp.Rational(sign * (k + 3), 2 * k + 7)
        for k, (s, sign) in enumerate(zip(symbols, signs, strict=True))
    }
    if abs(sp.N(rest.subs(point), 50)) > sp.Float("1e-40"):
        return Status.REFUTED
    raise DerivationError(f"neither zero nor shown to differ from it: {rest}")
