"""Polynomial statements over the reals as SMT-LIB text, decided by z3's nlsat.

The text is what is decided: it is stored beside the report, so that any other solver can be put to
the same question.
"""

from __future__ import annotations

import sympy as sp
from sympy.logic.boolalg import Boolean

TIMEOUT_MS = 30_000

_HEADS = {
    sp.And: "and",
    sp.Or: "or",
    sp.Not: "not",
    sp.Implies: "=>",
    sp.Equivalent: "=",
    sp.StrictGreaterThan: ">",
    sp.StrictLessThan: "<",
    sp.GreaterThan: ">=",
    sp.LessThan: "<=",
    sp.Equality: "=",
    sp.Unequality: "distinct",
    sp.Add: "+",
    sp.Mul: "*",
}


def query(assertions: list[Boolean], comment: str) -> str:
    """SMT-LIB 2 text that asks whether all ``assertions`` can hold together.

    Raises
    ------
    TypeError
        If something other than rational arithmetic occurs.
    """
    symbols = sorted(set().union(*(a.free_symbols for a in assertions)), key=str)
    return "".join(
        [
            f"; {comment}\n(set-logic QF_NRA)\n",
            *(f"(declare-const {symbol} Real)\n" for symbol in symbols),
            *(f"(assert {_term(assertion)})\n" for assertion in assertions),
            "(check-sat)\n",
        ]
    )


def solve(text: str) -> tuple[str, dict[str, sp.Rational]]:
    """Put a query to z3: ``("unsat", {})``, ``("sat", rational model)`` or ``("unknown", {})``.

    Values of a model that are not rational are left out.
    """
    import z3

    solver = z3.SolverFor("QF_NRA")
    solver.set("timeout", TIMEOUT_MS)
    solver.from_string(text)
    answer = str(solver.check())
    if answer != "sat":
        return answer, {}
    model = solver.model()
    values = {str(name): model[name] for name in model.decls() if name.arity() == 0}
    return answer, {
        name.split("(")[0]: sp.Rational(value.numerator_as_long(), value.denominator_as_long())
        for name, value in values.items()
        if z3.is_rational_value(value)
    }


def _term(node: sp.Basic) -> str:
    if node.is_Symbol:
        return str(node)
    if node in (sp.true, sp.false):
        return str(node).lower()
    if node.is_Rational:
        top = str(abs(node.p)) if node.q == 1 else f"(/ {abs(node.p)} {node.q})"
        return f"(- {top})" if node.p < 0 else top
    if node.is_Pow and node.exp.is_Integer:
        base = _term(node.base)
        product = base if abs(node.exp) == 1 else f"(* {' '.join([base] * abs(int(node.exp)))})"
        return product if node.exp > 0 else f"(/ 1 {product})"
    head = _HEADS.get(node.func)
    if head is None:
        raise TypeError(f"no rational arithmetic: {node.func.__name__} in {node}")
    return f"({head} {' '.join(map(_term, _in_order(node)))})"


def _in_order(node: sp.Basic) -> list[sp.Basic]:
    """Arguments in an order that does not change from run to run."""
    if isinstance(node, sp.And | sp.Or | sp.Equivalent):
        return sorted(node.args, key=sp.default_sort_key)
    return list(node.as_ordered_terms() if node.is_Add else node.args)
