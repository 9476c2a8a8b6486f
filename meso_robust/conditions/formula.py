"""Generated formulas by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from importlib import import_module
from typing import Any

Formula = Callable[..., tuple[Any, ...]]


def formula(module: str, name: str) -> Formula:
    """The generated function ``module.name``: the arithmetic first, then the arguments."""
    found: Formula = getattr(import_module(f"meso_robust._generated.{module}"), name)
    return found


def inputs(module: str, name: str) -> tuple[str, ...]:
    """Names of its arguments, in order."""
    return tuple(inspect.signature(formula(module, name)).parameters)[1:]
