"""The generator of the blind benchmark shares no code with what it tests."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

import pytest

from reports import blind

HERE = Path(blind.__file__).parent
ALLOWED = {"numpy", "numba", "scipy", *sys.stdlib_module_names} - {
    "importlib",
    "runpy",
    "subprocess",
}
"""Packages that the generator may use; none by which another could be brought in unseen."""
FORBIDDEN_CALLS = {"__import__", "eval", "exec"}


def imported(source: str) -> set[str]:
    """Full names of the modules that a source imports."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add("." * node.level + (node.module or ""))
    return names


def calls(source: str) -> set[str]:
    """Names of the functions that a source calls."""
    nodes = ast.walk(ast.parse(source))
    return {n.func.id for n in nodes if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)}


def foreign(source: str) -> set[str]:
    """What a source imports that is neither allowed nor of this folder."""
    return {
        name
        for name in imported(source)
        if name.split(".")[0] not in ALLOWED and not name.startswith("reports.blind.")
    }


def reached(start: str) -> dict[str, str]:
    """Sources of all modules of this folder that one of them imports, itself included."""
    found: dict[str, str] = {}
    waiting = [start]
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        found[name] = (HERE / f"{name}.py").read_text(encoding="utf-8")
        local = [other for other in imported(found[name]) if other.startswith("reports.blind.")]
        waiting += [other.split(".")[2] for other in local]
    return found


def test_the_generator_reaches_its_own_physics_only() -> None:
    modules = reached("generator")
    assert {"kernel", "effects", "outside", "camera", "pushes", "detectable"} <= set(modules)
    assert {name: foreign(source) for name, source in modules.items() if foreign(source)} == {}
    assert not FORBIDDEN_CALLS & set().union(*(calls(source) for source in modules.values()))


@pytest.mark.parametrize(
    "line",
    [
        "import meso_robust",
        "from meso_robust.simulator import simulate",
        "def f():\n    import meso_robust.units as u",
        "from importlib import import_module",
        "from tests.recordings import planted",
        "from reports.simulator import jam",
        "from . import corpus",
    ],
)
def test_a_borrowed_line_would_be_seen(line: str) -> None:
    assert foreign(line)
