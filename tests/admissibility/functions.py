"""All generated functions, where to evaluate them, and copies of them with one sign changed."""

from __future__ import annotations

import ast
import inspect
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

PACKAGE = "meso_robust._generated"
MODULES = [module.name for module in iter_modules(import_module(PACKAGE).__path__)]
NAMES = [
    (module, name)
    for module in MODULES
    for name, value in vars(import_module(f"{PACKAGE}.{module}")).items()
    if inspect.isfunction(value)
]

_RANGES = {
    (0.1, 3.0): "theta theta_0 theta_1 theta_2",
    (1.2, 2.2): "theta_start theta_end",
    (-0.5, 0.5): "beta",
    (0.05, 1.0): "mu",
    (-1.0, 1.0): "tau tau_D tau_S side",
    (1e-4, 4e-4): "d1",
    (-8e-4, 8e-4): "d2 d2_back sigma p_S rise dx dy x0 y0 x1 y1",
    (5e-4, 1e-3): "d4 half h V",
    (1e-7, 8e-7): "rho",
}
RANGES = {name: ends for ends, names in _RANGES.items() for name in names.split()}
"""Where an argument lies, in SI units; a new one needs an entry."""


def source_of(module: str, name: str) -> str:
    return inspect.getsource(getattr(import_module(f"{PACKAGE}.{module}"), name))


def at_shares(names: tuple[str, ...], shares: Floats) -> dict[str, Floats]:
    """Arguments at ``shares`` (..., arguments) of their ranges."""
    lo, hi = np.array([RANGES[name] for name in names]).T
    points = lo + shares * (hi - lo)
    return {name: points[..., k] for k, name in enumerate(names)}


def with_a_changed_sign(module: str, name: str) -> list[ModuleType]:
    """Modules with a copy of the function each, in which one sum is a difference or vice versa."""
    sums = len(_sums(ast.parse(source_of(module, name))))
    return [_changed(module, name, k) for k in range(sums)]


def _changed(module: str, name: str, which: int) -> ModuleType:
    tree = ast.parse(source_of(module, name))
    changed = _sums(tree)[which]
    changed.op = ast.Sub() if isinstance(changed.op, ast.Add) else ast.Add()
    copy = ModuleType(f"{PACKAGE}.{module}_changed_{which}")
    exec("from typing import Any\n" + ast.unparse(tree), vars(copy))
    return copy


def _sums(tree: ast.Module) -> list[ast.BinOp]:
    return [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)
    ]
