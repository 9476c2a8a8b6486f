"""LaTeX for the texts of a claim."""

from __future__ import annotations

import sympy as sp


def tex(expression: sp.Basic) -> str:
    """``$...$`` of an expression, for use in an f-string."""
    return f"${sp.latex(expression, fold_short_frac=True)}$"
