"""The contact conditions, evaluated in four ways from one formula.

The formulas come from ``meso_robust/_generated``; this package only names their arguments.
:func:`condition` gives CasADi numbers and outward-rounded bounds, :func:`values` NumPy arrays,
:func:`balls` rigorous balls of any precision. Each way imports what it needs when it is asked for:
arrays and balls do without CasADi.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from meso_robust.conditions.arrays import values as values
from meso_robust.conditions.ball import balls as balls
from meso_robust.conditions.formula import formula as formula, inputs

if TYPE_CHECKING:
    from meso_robust.bounds import Bounded


@cache
def condition(module: str, name: str) -> Bounded:
    """The generated function ``module.name`` as a CasADi function with rigorous bounds.

    Parameters
    ----------
    module
        A module of ``meso_robust._generated``, named after its derivation file.
    name
        A function of it.

    Returns
    -------
    Bounded
        Prepared once and kept: compiling its tapes takes longer than a bound.

    Examples
    --------
    >>> condition("two_sided_rotation", "no_jam").inputs
    ('V', 'd1', 'mu')
    """
    import casadi as ca

    from meso_robust.bounds import bounded

    names = inputs(module, name)
    x = ca.SX.sym("x", len(names))
    results = ca.vertcat(*formula(module, name)(ca, *ca.vertsplit(x)))
    return bounded(f"{module}.{name}", names, ca.Function(name, [x], [ca.densify(results)]))
