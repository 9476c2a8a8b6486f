"""A function that another room imports says what it takes, returns and raises."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path

from tests.sources import tree

ROOT = Path(__file__).parents[1]
PACKAGES = ("meso_robust", "derivations")
GENERATED = "_generated"

Trees = Mapping[str, ast.Module]
Key = tuple[str, str]
"""Module and function."""


def trees() -> Trees:
    """The parsed modules of the packages by their names."""
    return {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): tree(path)
        for package in PACKAGES
        for path in sorted((ROOT / package).rglob("*.py"))
    }


def room(module: str) -> str:
    """A folder or a file of the package; the derivations are one room."""
    first, *rest = module.split(".")
    return rest[0] if rest and first == "meso_robust" else first


def used(module: str, source: ast.Module) -> Iterator[Key]:
    """Functions (and other names) that a module takes from another one."""
    named: dict[str, str] = {}
    for node in ast.walk(source):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                yield node.module, alias.name
                named[alias.asname or alias.name] = f"{node.module}.{alias.name}"
        elif isinstance(node, ast.Import):
            named |= {alias.asname or alias.name: alias.name for alias in node.names}
    for node in ast.walk(source):
        of = node.value if isinstance(node, ast.Attribute) else None
        if isinstance(node, ast.Attribute) and isinstance(of, ast.Name) and of.id in named:
            yield named[of.id], node.attr


def shared(modules: Trees) -> dict[Key, ast.FunctionDef]:
    """Public functions that a module of another room uses."""
    users: dict[Key, set[str]] = defaultdict(set)
    for module, source in modules.items():
        for key in used(module, source):
            users[key].add(room(module))
    return {
        (module, node.name): node
        for module, source in modules.items()
        for node in source.body
        if isinstance(node, ast.FunctionDef)
        and not node.name.startswith("_")
        and users[module, node.name] - {room(module)}
    }


def lacking(function: ast.FunctionDef) -> list[str]:
    """The sections that a docstring should have and has not."""
    arguments = function.args
    returns = function.returns is not None and ast.unparse(function.returns)
    wanted = {
        "Parameters": any((*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)),
        "Returns|Yields": returns not in (False, "None", "NoReturn"),
        "Raises": any(isinstance(node, ast.Raise) for node in ast.walk(function)),
    }
    text = ast.get_docstring(function) or ""
    return [
        section
        for section, is_wanted in wanted.items()
        if is_wanted and not re.search(rf"^({section})\n---", text, re.MULTILINE)
    ]


def test_functions_that_another_room_imports_have_all_sections() -> None:
    found = {
        f"{module}.{name}": lacking(function)
        for (module, name), function in shared(trees()).items()
        if room(module) != GENERATED
    }
    assert {name: sections for name, sections in found.items() if sections} == {}


def test_the_scan_sees_functions_and_their_users() -> None:
    """An import, an attribute of a module and no use at all, each of another room or of the own one."""
    source = "def taken(x): ...\ndef by_module(x): ...\ndef own(x): ...\ndef idle(x): ...\n"
    modules = {
        "meso_robust.bounds.a": ast.parse(source),
        "meso_robust.bounds.b": ast.parse("from meso_robust.bounds.a import own"),
        "meso_robust.task": ast.parse(
            "from meso_robust.bounds import a\nfrom meso_robust.bounds.a import taken\na.by_module(1)"
        ),
    }
    assert [name for _, name in shared(modules)] == ["taken", "by_module"]
    assert len(shared(trees())) > 250


def test_sections_that_are_named_only_in_passing_do_not_count() -> None:
    (function,) = ast.parse(
        'def of(x) -> int:\n    """Parameters and Returns.\n\n    Raises\n    ------\n    ValueError\n'
        '        Always.\n    """\n    raise ValueError\n'
    ).body
    assert isinstance(function, ast.FunctionDef)
    assert lacking(function) == ["Parameters", "Returns|Yields"]
    assert room("derivations.report") == "derivations"
