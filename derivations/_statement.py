"""Deciding one statement: an identity, a polynomial statement over the reals, or a bound.

Angles enter polynomial statements as points of the unit circle: every ``cos(t)``, ``sin(t)`` becomes
a pair of real unknowns with ``cos^2 + sin^2 = 1``. What comes out is a :class:`Finding`, which only
the functions of this file make; one that does not hold carries a witness or the query that shows it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations import _smt
from derivations._circle import tidy

Point = Mapping[sp.Symbol, sp.Expr]
Side: TypeAlias = sp.Expr | sp.MatrixExpr | sp.MatrixBase | Sequence[sp.Expr]
Circles = Sequence[tuple[sp.Symbol, sp.Symbol]]
"""``(x, y)`` pairs of unknowns with ``x^2 + y^2 = 1``."""


class DerivationError(AssertionError):
    """A step of a derivation that must hold does not; the file must be mended before use."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """What the machine found of one statement."""

    what: str
    """The statement in words and formulas (``$...$`` is LaTeX)."""
    holds: bool
    how: str
    """By what route it was decided."""
    witness: Mapping[str, str] = field(default_factory=dict)
    """Where it fails (or, for an existence, where it holds): name -> exact value."""
    formal: str
    """What exactly was decided, in SymPy's notation; no assumption is left out but the signs that
    symbols carry."""
    query: str = ""
    """SMT-LIB text that was decided, if that was the route; empty otherwise."""


def require_zero(expression: sp.Expr, step: str) -> None:
    """Stop unless ``expression`` vanishes identically.

    Raises
    ------
    DerivationError
        Names the step and shows what is left over.
    """
    rest = _rest(expression)
    if rest != 0:
        raise DerivationError(f"{step}: expected 0, but {rest} is left over")


def as_written(build: Callable[[], sp.Expr]) -> sp.Expr:
    """An expression as it is written, which SymPy would otherwise evaluate while it is built.

    For one side of an :func:`identity` whose two sides would print alike once evaluated.
    """
    with sp.evaluate(False):
        return build()


def crossed(p: Sequence[sp.Expr], q: Sequence[sp.Expr]) -> sp.Expr:
    """Cross product p_x q_y - p_y q_x as it is written, a determinant."""
    return sp.Determinant(sp.ImmutableMatrix([list(p), list(q)]))


def combined(*terms: tuple[sp.Expr, sp.MatrixBase]) -> sp.MatrixExpr:
    """A sum of vectors, each with its factor, as it is written."""
    return sp.MatAdd(*(sp.MatMul(factor, vector.as_immutable()) for factor, vector in terms))


def identity(
    what: str, left: Side, right: Side, at: Point | None = None, on: Circles = ()
) -> Finding:
    """Whether ``left`` equals ``right`` at every point.

    What is recorded are the two sides as they are given, so they must not be simplified before: a
    derivative is given as ``sp.Derivative``, a value at a point as ``sp.Subs``, a product of matrices
    as ``sp.MatMul``, a sum as :func:`as_written`.

    Parameters
    ----------
    what
        The statement, for the reader.
    left, right
        Expressions, or as many entries on either side.
    at
        A point to show the difference at, if there is one.
    on
        Cosines and sines that are unknowns of their own.

    Raises
    ------
    DerivationError
        If it is neither shown to hold nor shown to fail, or if both sides print alike.
    """
    sides = [_entries(side) for side in (left, right)]
    shown = [_printed(side) for side in (left, right)]
    if shown[0] == shown[1]:
        raise DerivationError(
            f"{what}: both sides are {shown[0]}, which says nothing; state them before they are "
            "simplified"
        )
    formal = " = ".join(shown)
    if on:
        formal += f" where {_listed(_circles(on))}"
    rests = (_rest(p - q, on) for p, q in zip(*sides, strict=True))
    rest = next((rest for rest in rests if rest != 0), sp.Integer(0))
    if rest == 0:
        how = "identity: the difference simplifies to 0"
        return Finding(what=what, holds=True, how=how, formal=formal)
    point = dict(at) if at is not None else _some_point(rest.free_symbols)
    _require_exact(point)
    value = sp.expand_trig(rest).subs(point)
    if value.free_symbols:
        raise DerivationError(f"{what}: the point leaves {value.free_symbols} open")
    if value.is_Rational and value != 0:
        how = f"the two sides differ by {value} at the witness, in exact arithmetic"
    elif abs(sp.N(value, 50)) > sp.Float("1e-40"):
        how = f"the two sides differ by {sp.N(value, 6)} at the witness, to 50 digits"
    else:
        raise DerivationError(f"{what}: neither 0 nor shown to differ from it: {rest}")
    return Finding(what=what, holds=False, how=how, formal=formal, witness=_shown(point))


def for_all(what: str, given: Iterable[Boolean], then: Boolean, at: Point | None = None) -> Finding:
    """Whether ``then`` follows from ``given`` for all real values, decided by z3.

    Signs that the symbols carry (positive, negative) count as given.

    Parameters
    ----------
    what
        The statement, for the reader.
    given, then
        Polynomial relations; cosines and sines of symbols may occur.
    at
        A counterexample to look at first, in exact numbers.

    Raises
    ------
    DerivationError
        If ``at`` is no counterexample, if the premises contradict each other or hold what is to follow
        (the statement would say nothing), or if the solver does not decide.
    """
    premises = list(given)
    listed = _listed(premises)
    formal = f"{listed} => {sp.sstr(then)}" if listed else sp.sstr(then)
    if at is not None:
        if not _is_true(sp.And(*premises), at) or _is_true(then, at):
            raise DerivationError(f"{what}: the point given is no counterexample: {_shown(at)}")
        how = "fails at the witness, in exact arithmetic"
        return Finding(what=what, holds=False, how=how, formal=formal, witness=_shown(at))
    if then == sp.true or then in premises:
        raise DerivationError(
            f"{what}: what is to follow is given or true by itself, which says nothing"
        )
    answer, text, witness = _ask(what, [*premises, sp.Not(then)])
    if answer == "unsat":
        if _ask(what, premises)[0] != "sat":
            raise DerivationError(f"{what}: the premises are not shown to be possible")
        how = "z3: no counterexample exists"
        return Finding(what=what, holds=True, how=how, formal=formal, query=text)
    how = "z3: a counterexample exists"
    return Finding(what=what, holds=False, how=how, formal=formal, witness=witness, query=text)


def there_is(what: str, such: Iterable[Boolean], at: Point) -> Finding:
    """Whether all of ``such`` hold at the point ``at``, in exact arithmetic."""
    conditions = list(such)
    holds = _is_true(sp.And(*conditions), at)
    how = "holds at the witness, in exact arithmetic" if holds else "does not hold at the point"
    formal = _listed(conditions)
    return Finding(what=what, holds=holds, how=how, formal=formal, witness=_shown(at))


def together(what: str, *printed: Boolean) -> Finding:
    """Whether the printed relations can all be true of the same values, decided by z3."""
    answer, text, shown = _ask(what, list(printed))
    how = "z3: possible" if answer == "sat" else "z3: no values satisfy all of them"
    formal = _listed(printed)
    return Finding(
        what=what, holds=answer == "sat", how=how, formal=formal, witness=shown, query=text
    )


def positive_by(
    what: str,
    goal: sp.Expr,
    given: Mapping[str, sp.Expr],
    multiplier: str,
    combination: str,
    on: Circles = (),
) -> Finding:
    """``goal > 0`` wherever all ``given`` are positive, by a certificate checked exactly.

    The certificate is the identity ``goal * multiplier = combination`` in which both are
    polynomials in the given quantities with positive coefficients.

    Parameters
    ----------
    what
        The statement, for the reader.
    goal
        What is to be positive.
    given
        name -> expression that is positive.
    multiplier, combination
        In the names of ``given``.
    on
        Cosines and sines that are unknowns of their own.

    Raises
    ------
    DerivationError
        If the identity does not hold or a coefficient is not positive.
    """
    names = {name: sp.Symbol(name) for name in given}
    parts = [sp.sympify(text, locals=names) for text in (multiplier, combination)]
    for part in parts:
        if part.free_symbols - set(names.values()):
            raise DerivationError(f"{what}: {part} uses what is not given")
        if not all(k.is_Rational and k > 0 for k in sp.Poly(part, *names.values()).coeffs()):
            raise DerivationError(f"{what}: {part} has a coefficient that is not positive")
    back = {symbol: given[name] for name, symbol in names.items()}
    scale, combined = (part.subs(back, simultaneous=True) for part in parts)
    rest = _on_circles(sp.expand(goal * scale - combined), on)
    if rest != 0:
        raise DerivationError(f"{what}: the certificate leaves {sp.factor(rest)}")
    if _ask(what, [*_circles(on), *(value > 0 for value in given.values())])[0] != "sat":
        raise DerivationError(f"{what}: what is given is not shown to be possible")
    left = "goal" if multiplier == "1" else f"goal * ({multiplier})"
    named = {"goal": goal, **given}
    meaning = ", ".join(f"{name} = {sp.sstr(value)}" for name, value in named.items())
    how = f"certificate, checked exactly: {left} = {combination} with {meaning} all positive"
    formal = f"{_listed([value > 0 for value in given.values()])} => {sp.sstr(goal)} > 0"
    return Finding(what=what, holds=True, how=how, formal=formal)


def angle(half_tangent: sp.Rational, of: sp.Symbol) -> dict[sp.Expr, sp.Rational]:
    """Exact cosine and sine of an angle, as a point to evaluate at: t = tan(angle/2)."""
    t = sp.Rational(half_tangent)
    return {sp.cos(of): (1 - t**2) / (1 + t**2), sp.sin(of): 2 * t / (1 + t**2)}


def _listed(relations: Iterable[Boolean]) -> str:
    """Relations in the order in which they were stated, but those that a symbol's sign makes true."""
    return "; ".join(sp.sstr(relation) for relation in relations if relation != sp.true)


def _entries(side: Side) -> list[sp.Expr]:
    if isinstance(side, sp.MatrixExpr):
        return list(side.doit().as_explicit())  # a sum that stays one iterates over nothing
    return [side] if isinstance(side, sp.Expr) else list(side)


def _printed(side: Side) -> str:
    """One side of an identity, on one line; entries in brackets."""
    if isinstance(side, sp.Expr):
        return " ".join(sp.sstr(side).split())
    texts = [sp.sstr(entry) for entry in side]
    return texts[0] if len(texts) == 1 else f"({', '.join(texts)})"


def _circles(on: Circles) -> list[Boolean]:
    return [sp.Eq(x**2 + y**2, 1) for x, y in on]


def _on_circles(polynomial: sp.Expr, on: Circles) -> sp.Expr:
    """Remainder of a polynomial by the circles: 0 if it vanishes on them."""
    for x, y in on:
        polynomial = sp.rem(polynomial, x**2 + y**2 - 1, x) if polynomial.has(x) else polynomial
    return sp.expand(polynomial)


def _rest(expression: sp.Expr, on: Circles = ()) -> sp.Expr:
    """0 if the expression vanishes; roots and inverse functions need the general simplifier."""
    tidied = tidy(expression.doit())
    if on:
        top, bottom = sp.fraction(tidied)
        tidied = _on_circles(top, on) / bottom
    return tidied if tidied == 0 else sp.simplify(tidied)


def _is_true(relation: Boolean, at: Point) -> bool:
    """Whether a relation holds at a point of rationals; angles given by cosine and sine.

    Raises
    ------
    DerivationError
        If the point leaves it open, or is not on the unit circle.
    """
    _require_exact(at)
    value = sp.simplify(relation.subs(dict(at), simultaneous=True))
    if value not in (sp.true, sp.false):
        raise DerivationError(f"{relation} is not decided at {_shown(at)}: {value}")
    return bool(value)


def _ask(what: str, relations: list[Boolean]) -> tuple[str, str, dict[str, str]]:
    """Whether all relations can hold: z3's answer, the query, and the rational part of a model.

    A model that is rational throughout is put into the relations again: division by zero, say, has
    some value for the solver and none for us.
    """
    plain = _algebraic(relations)
    text = _smt.query(plain, what)
    answer, model = _smt.solve(text)
    if answer not in ("sat", "unsat"):
        raise DerivationError(f"{what}: not decided by z3")
    symbols = set().union(*(relation.free_symbols for relation in plain))
    values = {symbol: model[str(symbol)] for symbol in symbols if str(symbol) in model}
    complete = answer == "sat" and len(values) == len(symbols)
    if complete and not all(_holds(relation, values) for relation in plain):
        raise DerivationError(f"{what}: z3's example does not hold in exact arithmetic")
    return answer, text, {name: str(value) for name, value in sorted(model.items())}


def _holds(relation: Boolean, values: Mapping[sp.Symbol, sp.Rational]) -> bool:
    try:
        return bool(relation.subs(values) == sp.true)
    except TypeError:  # undefined there: a division by zero
        return False


def _require_exact(at: Point) -> None:
    """Stop unless a point is exact, on the circles, and keeps the signs of its symbols."""
    for key, value in at.items():
        exact = sp.sympify(value)
        if not (exact.is_algebraic and exact.is_real) or exact.has(sp.Float):
            raise DerivationError(f"{key} = {value} is not an exact number")
        if isinstance(key, sp.cos | sp.sin):
            turn = key.args[0]
            if at.get(sp.cos(turn), 2) ** 2 + at.get(sp.sin(turn), 2) ** 2 != 1:
                raise DerivationError(f"{turn} is not on the unit circle: {_shown(at)}")
    if not all(_signs_kept(at)):
        raise DerivationError(f"a value has the wrong sign: {_shown(at)}")


def _signs_kept(at: Point) -> Iterable[bool]:
    for symbol, value in at.items():
        if symbol.is_Symbol and symbol.is_positive:
            yield bool(value > 0)
        if symbol.is_Symbol and symbol.is_negative:
            yield bool(value < 0)


def _algebraic(relations: list[Boolean]) -> list[Boolean]:
    """The relations over unknowns for cosines and sines, with what is known of every unknown."""
    angles = sorted({f.args[0] for r in relations for f in r.atoms(sp.cos, sp.sin)}, key=str)
    on_circle = []
    for turn in angles:
        if not turn.is_Symbol:
            raise DerivationError(f"an angle must be a symbol, not {turn}: expand it first")
        cosine, sine = sp.Symbol(f"cos_{turn}", real=True), sp.Symbol(f"sin_{turn}", real=True)
        relations = [r.subs({sp.cos(turn): cosine, sp.sin(turn): sine}) for r in relations]
        on_circle.append(sp.Eq(cosine**2 + sine**2, 1, evaluate=False))
    plain, known = {}, []
    symbols = sorted(set().union(*(r.free_symbols for r in relations)), key=str)
    names = [str(symbol) for symbol in symbols]
    if len(set(names)) != len(names) or set(angles) & set(symbols):
        raise DerivationError(
            f"symbols that share a name, or an angle outside cos and sin: {names}"
        )
    for symbol in symbols:
        plain[symbol] = sp.Symbol(str(symbol), real=True)  # without its sign: nothing is folded
        if symbol.is_positive:
            known.append(plain[symbol] > 0)
        if symbol.is_negative:
            known.append(plain[symbol] < 0)
    return [*known, *(r.subs(plain) for r in [*on_circle, *relations])]


def _some_point(symbols: Iterable[sp.Symbol]) -> dict[sp.Symbol, sp.Rational]:
    ordered = sorted(symbols, key=str)
    signs = [-1 if symbol.is_negative else 1 for symbol in ordered]
    return {
        symbol: sp.Rational(sign * (k + 3), 2 * k + 7)
        for k, (symbol, sign) in enumerate(zip(ordered, signs, strict=True))
    }


def _shown(at: Point) -> dict[str, str]:
    return {
        str(key): str(value) for key, value in sorted(at.items(), key=lambda item: str(item[0]))
    }
