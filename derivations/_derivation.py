"""What one derivation file contributes: claims for the register and functions to generate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy as sp

from derivations._claim import Claim


@dataclass(frozen=True, slots=True, kw_only=True)
class Function:
    """A function to generate."""

    arguments: tuple[sp.Symbol, ...]
    results: tuple[sp.Expr, ...]
    unit: str
    """Of every result: ``1``, ``m``, ``m^2``, ...; checked against the expressions."""
    meaning: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Derivation:
    """What one derivation file contributes."""

    name: str
    """File name without ``.py``; also the name of the generated module."""
    summary: str
    """One sentence for the head of the generated module."""
    claims: tuple[Claim, ...]
    functions: Mapping[str, Function] = field(default_factory=dict)
    """name -> what to generate."""
