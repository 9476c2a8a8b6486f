"""CasADi functions of the contact conditions, ready for numbers and for bounds.

The formulas come from ``meso_robust/_generated``; this package only names their arguments.
"""

from __future__ import annotations

import inspect
from functools import cache
from importlib import import_module

import casadi as ca

from meso_robust.bounds import Bounded, bounded


@cache
def condition(module: str, name: str) -> Bounded:
    """The generated function ``module.name`` as a CasADi function with rigorous bounds.

    Parameters
    ----------
    module
        A module of ``meso_robust._generated``, named after its derivation file.
    name
        A function of it.

    Examples
    --------
    >>> condition("two_sided_rotation", "no_jam").inputs
    ('V', 'd1', 'mu')
    """
    generated = getattr(import_module(f"meso_robust._generated.{module}"), name)
    inputs = tuple(inspect.signature(generated).parameters)[1:]
    x = ca.SX.sym("x", len(inputs))
    values = ca.vertcat(*generated(ca, *ca.vertsplit(x)))
    return bounded(f"{module}.{name}", inputs, ca.Function(name, [x], [ca.densify(values)]))
