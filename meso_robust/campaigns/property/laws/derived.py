"""Formulas as the derivations give them, evaluated by mpmath at high precision.

SymPy's expressions are walked as they are: nothing of the generated code is used, neither its common
subexpressions nor its printing.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

from meso_robust.conditions import balls

if TYPE_CHECKING:
    from flint import arb

BITS = 256
"""Of mpmath."""
SLACK = 2.0**-150
"""Error of mpmath's result over what rounding may do at 53 bits; it is about 2^-203."""


@cache
def _functions(module: str) -> Any:
    """The functions that a derivation generates; takes seconds if they were not kept."""
    found = import_module("derivations._kept").load(module)
    return (found or import_module(f"derivations.{module}").derive()).functions


@cache
def _evaluator(module: str, name: str) -> Callable[..., Any]:
    import sympy as sp

    function = _functions(module)[name]
    return sp.lambdify(function.arguments, list(function.results), "mpmath", cse=False)


def derived(module: str, name: str) -> Callable[..., tuple[arb, ...]]:
    """The derivation's formula at a point.

    Parameters
    ----------
    module, name
        As for :func:`meso_robust.conditions.condition`.

    Returns
    -------
    Callable
        Takes the arguments by name, doubles that are meant exactly; returns a ball a result, not
        finite where the formula is undefined or not real.
    """
    rounded = balls(module, name)

    def evaluate(**arguments: float) -> tuple[arb, ...]:
        from flint import arb, ctx

        rough = rounded(**arguments, bits=53)
        with ctx.workprec(BITS):
            found = _numbers(_evaluator(module, name), arguments, len(rough))
            return tuple(
                _ball(value, one.rad() * SLACK if one.is_finite() else arb(abs(value)) * SLACK)
                for value, one in zip(found, rough, strict=True)
            )

    return evaluate


def _numbers(function: Callable[..., Any], arguments: dict[str, float], results: int) -> list[Any]:
    import mpmath  # type: ignore[import-untyped]

    with mpmath.workprec(BITS):
        try:
            exact = {key: mpmath.mpf(value) for key, value in arguments.items()}
            return [mpmath.mpmathify(value) for value in function(**exact)]
        except ZeroDivisionError:
            return [mpmath.nan] * results


def _ball(value: Any, error: arb) -> arb:
    """A number of mpmath, exactly, and its error."""
    import mpmath
    from flint import arb

    if not isinstance(value, mpmath.mpf) or not mpmath.isfinite(value):
        return arb("nan")
    mantissa, exponent = value.man_exp
    sign = -1 if value < 0 else 1
    return arb((sign * abs(int(mantissa)), int(exponent))) + arb(0, error)
