"""Entries from Python to functions that only kernels call."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast

from numba import njit

_P = ParamSpec("_P")
_R = TypeVar("_R")


def entry(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """The same function compiled by itself; what it calls is as in a kernel."""
    source: Any = function
    return cast("Callable[_P, _R]", njit(error_model="numpy")(source.py_func))
