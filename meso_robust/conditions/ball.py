"""Formulas over balls: midpoint, radius and any precision, with every rounding accounted for.

The balls are those of Arb. A result holds the exact value for every choice of points of the
arguments. Nothing is rounded outside Arb: the generated code holds no constants but small dyadic
numbers, which the generator ensures (``derivations/_dimension.py``).
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

from meso_robust.conditions.formula import formula

if TYPE_CHECKING:
    from flint import arb

Number: TypeAlias = "arb | Fraction | float | str"


def balls(module: str, name: str) -> Callable[..., tuple[arb, ...]]:
    """The generated function ``module.name`` over balls.

    Parameters
    ----------
    module, name
        As for :func:`meso_robust.conditions.condition`.

    Returns
    -------
    Callable
        Takes the arguments by name and the precision as ``bits``; returns one ball a result, not
        finite where the formula may be undefined. An argument is a ball or a number that is meant
        exactly: a float is the double itself, ``"0.1"`` and ``"1/3"`` are a tenth and a third. The
        precision holds for all of python-flint during the call: do not call from several threads.

    Examples
    --------
    >>> (margin,) = balls("two_sided_rotation", "no_jam")(V=3, d1="0.5", mu=Fraction(1, 3))
    >>> print(margin.str(10))
    [7.888888889 +/- 1.12e-10]
    """
    from flint import arb, ctx

    function = formula(module, name)

    def evaluate(*, bits: int = 128, **arguments: Number) -> tuple[arb, ...]:
        with ctx.workprec(bits):
            named = {key: _off_zero(_ball(value)) for key, value in arguments.items()}
            return tuple(map(arb, function(arb, **named)))

    return evaluate


def _ball(value: Number) -> arb:
    """A number as the narrowest ball of the precision in force."""
    from flint import arb, fmpq

    if isinstance(value, arb | float):
        return arb(value)
    exact = Fraction(value)
    return arb(fmpq(int(exact.numerator), int(exact.denominator)))


def _off_zero(ball: arb) -> arb:
    """A ball around ``ball`` that is not centred at 0, where Arb would not give its powers."""
    from flint import arb

    if ball.is_exact() or ball.mid() != 0:
        return ball
    shift = ball.rad() * 2.0**-20
    return shift + arb(0, ball.rad() + shift)
