"""Write what the derivations return: generated code and a readable list of checked statements."""

from __future__ import annotations

from pathlib import Path

import sympy as sp
from sympy.printing.pycode import PythonCodePrinter

from derivations import (
    one_point_sticking,
    sticking_motion,
    two_point_sticking,
    two_sided_rotation,
    y_translation,
)
from derivations._derivation import Derivation

ROOT = Path(__file__).resolve().parent.parent
GENERATED = ROOT / "meso_robust" / "_generated"
REPORT = ROOT / "reports" / "derivations" / "statements.md"
SOURCES = (
    one_point_sticking,
    sticking_motion,
    two_point_sticking,
    two_sided_rotation,
    y_translation,
)

HEADER = '''"""{summary}

Generated from derivations/{name}.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any
'''


class _Printer(PythonCodePrinter):
    """Prints functions as ``ops.name`` so that one source serves every arithmetic."""

    def _print_Function(self, expr: sp.Function) -> str:
        return f"ops.{expr.func.__name__}({', '.join(map(self._print, expr.args))})"

    _print_sin = _print_cos = _print_log = _print_Function

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:
        if expr.exp == sp.Rational(1, 2):
            return f"ops.sqrt({self._print(expr.base)})"
        if expr.exp == sp.Rational(-1, 2):
            return f"1/ops.sqrt({self._print(expr.base)})"
        return str(super()._print_Pow(expr, rational=rational))


def derive_all() -> tuple[Derivation, ...]:
    """Run every derivation.

    Raises
    ------
    DerivationError
        If a step does not hold.
    """
    return tuple(source.derive() for source in SOURCES)


def render(derivations: tuple[Derivation, ...]) -> dict[Path, str]:
    """File contents by path: one module a derivation, and the list of statements."""
    files = {GENERATED / f"{d.name}.py": _module(d) for d in derivations}
    files[GENERATED / "__init__.py"] = (
        '"""Code generated from derivations/ by `meso-robust derive`; do not edit."""\n'
    )
    files[REPORT] = _report(derivations)
    return files


def _module(derivation: Derivation) -> str:
    parts = [HEADER.format(summary=derivation.summary, name=derivation.name)]
    for name, (arguments, results, meaning) in derivation.functions.items():
        parts.append(_function(name, arguments, results, meaning))
    return "\n\n".join(parts)


def _function(
    name: str, arguments: tuple[sp.Symbol, ...], results: tuple[sp.Expr, ...], meaning: str
) -> str:
    printer = _Printer({"fully_qualified_modules": False})
    shared, finals = sp.cse(results, order="canonical")
    lines = [f"    {symbol} = {printer.doprint(value)}" for symbol, value in shared]
    values = "".join(f"        {printer.doprint(value)},\n" for value in finals)
    inputs = ", ".join(f"{symbol}: Any" for symbol in arguments)
    body = "".join(line + "\n" for line in lines)
    return (
        f"def {name}(ops: Any, {inputs}) -> tuple[Any, ...]:\n"
        f'    """Return {meaning}."""\n{body}    return (\n{values}    )\n'
    )


def _report(derivations: tuple[Derivation, ...]) -> str:
    lines = [
        "# Statements of the paper, checked by derivation",
        "",
        "Written by `meso-robust derive`; every verdict is computed.",
        "",
        "| place | as derived | verdict | derivation |",
        "|---|---|---|---|",
    ]
    for derivation in derivations:
        for s in derivation.statements:
            text = s.text.replace("|", "\\|")
            lines.append(
                f"| {s.place} | {text} | **{s.status.name}**: {s.status.value} "
                f"| derivations/{derivation.name}.py |"
            )
    return "\n".join(lines) + "\n"
