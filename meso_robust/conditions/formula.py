"""Generated formulas by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from importlib import import_module
from typing import Any

Formula = Callable[..., tuple[Any, ...]]


def formula(module: str, name: str) -> Formula:
    """The generated function ``module.name``.

    Parameters
    ----------
    module
        A module of ``meso_robust._generated``, named after its derivation file.
    name
        A function of it.

    Returns
    -------
    Formula
        Takes the arithmetic (``numpy``, ``casadi`` or what has functions of the same names) first,
        then the arguments.
    """
    found: Formula = getattr(import_module(f"meso_robust._generated.{module}"), name)
    return found


def inputs(module: str, name: str) -> tuple[str, ...]:
    """Names of the arguments of a generated function.

    Parameters
    ----------
    module, name
        As for :func:`formula`.

    Returns
    -------
    tuple[str, ...]
        In the order of the call, without the arithmetic.
    """
    return tuple(inspect.signature(formula(module, name)).parameters)[1:]
