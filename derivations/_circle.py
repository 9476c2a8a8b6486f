"""Rational functions of cosines and sines, simplified with cos^2 + sin^2 = 1.

SymPy's general ``simplify`` and ``solve`` search among many forms; here every cosine and sine is an
unknown of a polynomial ring and only the circle relates them, which takes a fraction of the time.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import sympy as sp

Circle = dict[sp.Expr, sp.Symbol]


def tidy(expression: sp.Expr) -> sp.Expr:
    """A reduced quotient of polynomials; 0 exactly if the expression vanishes on the circles.

    Roots and other functions count as independent unknowns: they are left as they are.
    """
    ratio = expression.replace(sp.tan, lambda turn: sp.sin(turn) / sp.cos(turn))
    plain, circle = _plain(sp.expand_trig(ratio))
    top, bottom = sp.fraction(sp.cancel(sp.together(plain)))
    quotient = sp.cancel(_reduced(top, circle) / _reduced(bottom, circle))
    return quotient.subs({symbol: function for function, symbol in circle.items()})


def solve_linear(
    equations: Iterable[sp.Expr], unknowns: Sequence[sp.Symbol]
) -> dict[sp.Symbol, sp.Expr]:
    """The one solution of linear equations ``expression = 0`` whose coefficients hold angles.

    Raises
    ------
    ValueError
        If there is no solution or more than one.
    """
    rows = [sp.expand_trig(equation) for equation in equations]
    circle = _circle(rows)
    solutions = sp.solve([row.subs(circle) for row in rows], unknowns, dict=True)
    if len(solutions) != 1 or set(solutions[0]) != set(unknowns):
        raise ValueError(f"not one solution for {', '.join(map(str, unknowns))}: {solutions}")
    back = {symbol: function for function, symbol in circle.items()}
    return {unknown: tidy(value.subs(back)) for unknown, value in solutions[0].items()}


def _plain(expression: sp.Expr) -> tuple[sp.Expr, Circle]:
    circle = _circle([expression])
    return expression.subs(circle), circle


def _circle(expressions: Iterable[sp.Expr]) -> Circle:
    """Unknowns for the cosine and the sine of every angle that occurs."""
    angles = {f.args[0] for e in expressions for f in e.atoms(sp.cos, sp.sin)}
    return {
        function(turn): sp.Symbol(f"{function.__name__}_{k}", real=True)
        for k, turn in enumerate(sorted(angles, key=sp.default_sort_key))
        for function in (sp.cos, sp.sin)
    }


def _reduced(polynomial: sp.Expr, circle: Circle) -> sp.Expr:
    """Without squares of sines."""
    for function, symbol in circle.items():
        if isinstance(function, sp.sin):
            other = circle[sp.cos(function.args[0])]
            polynomial = sp.rem(polynomial, symbol**2 + other**2 - 1, symbol)
    return polynomial
