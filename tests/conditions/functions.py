"""Copies of the generated functions with one sign changed."""

from __future__ import annotations

import ast
import inspect
from importlib import import_module
from types import ModuleType

from meso_robust.campaigns.property.laws.routes import PACKAGE


def source_of(module: str, name: str) -> str:
    return inspect.getsource(getattr(import_module(f"{PACKAGE}.{module}"), name))


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
