"""Imports point one way, and what is named exists."""

from __future__ import annotations

import ast
import functools
import graphlib
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import meso_robust
from tests.sources import tree
from tests.strategies import paper_chain

PACKAGE = Path(meso_robust.__file__).parent
ROOT = PACKAGE.parent
SOURCES = sorted(PACKAGE.rglob("*.py"))

BASE = {"errors", "kernels", "stages", "types", "wording"}
BELOW_MOTION = {"bounds", "conditions", *BASE}
BELOW_PLANNING = {"reading", "motion", "primitives", "units", "task", "tasks", *BELOW_MOTION}
MAY_IMPORT = {
    "_generated": set(),
    "bounds": BASE,
    "conditions": {"bounds", "_generated", *BASE},
    "motion": {*BELOW_MOTION, "units"},
    "primitives": BELOW_PLANNING - {"primitives"},
    "planning": {*BELOW_PLANNING, "copies", "even_film"},
    "feasible_regions": {*BELOW_PLANNING, "copies"},
    "certificates": {*BELOW_PLANNING, "planning", "files", "copies"},
    "policy": {*BELOW_PLANNING, "planning", "certificates"},
    "checker": {"errors", "reading", "task"},
    "simulator": {"errors", "kernels", "lifetime", "types"},
    "plant": set(),
    "live": {
        *BELOW_PLANNING,
        "planning",
        "identification",
        "laboratory",
        "microscope",
        "plant",
        "recordings",
        "toml_files",
        "tracking",
    },
    "recordings": {"errors", "types", "wording", "reading", "toml_files", "files"},
    "microscope": {"errors", "types", "wording", "files", "kernels"},
    "tracking": {
        "errors",
        "types",
        "wording",
        "reading",
        "toml_files",
        "files",
        "kernels",
        "recordings",
        "task",
        "__version__",
    },
    "diagnosis": {
        "errors",
        "types",
        "copies",
        "wording",
        "toml_files",
        "simulator",
        "recordings",
        "identification",
        "__version__",
    },
    "identification": {
        "errors",
        "types",
        "wording",
        "toml_files",
        "files",
        "kernels",
        "simulator",
        "recordings",
        "task",
    },
}
ABOVE = {
    "api",
    "campaigns",
    "cli",
    "reporting",
    "reproduction",
    "__init__",
}  # what nothing else may reach


def part_of(path: Path) -> str:
    """First name below the package: a folder or a module."""
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


@functools.cache
def imported(path: Path) -> tuple[str, ...]:
    """Dotted names of everything that a file imports, wherever in the file."""
    return tuple(_imported(path))


def _imported(path: Path) -> Iterator[str]:
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path.name} imports relatively"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def parts_imported(path: Path) -> set[str]:
    """First names below meso_robust that a file imports."""
    names = (name.split(".") for name in imported(path))
    return {name[1] for name in names if name[0] == "meso_robust" and len(name) > 1}


def names(path: Path) -> str:
    return str(path.relative_to(PACKAGE))


@pytest.mark.parametrize("part", MAY_IMPORT)
def test_a_package_imports_only_what_lies_below_it(part: str) -> None:
    files = [path for path in SOURCES if part_of(path) == part]
    assert files
    for path in files:
        extra = parts_imported(path) - MAY_IMPORT[part] - {part}
        assert not extra, f"{names(path)} imports {sorted(extra)}"


def test_the_two_engines_of_the_simulator_share_nothing() -> None:
    events = PACKAGE / "simulator" / "events"
    allowed = (
        "meso_robust.simulator.events",
        "meso_robust.simulator.outcome",
        "meso_robust.kernels",
        "meso_robust.types",
    )
    for path in sorted(events.glob("*.py")):
        own = [name for name in imported(path) if name.startswith("meso_robust")]
        assert all(name.startswith(allowed) for name in own), path.name
    for path in sorted((PACKAGE / "simulator").glob("*.py")):
        if path.stem not in {"exact", "__init__"}:
            assert not any("simulator.events" in name for name in imported(path)), path.name


@pytest.mark.parametrize(
    "part",
    ["bounds", "checker", "motion", "conditions", "primitives", "certificates", "feasible_regions"],
)
def test_no_proof_and_no_checker_rounds_a_product_with_a_sum(part: str) -> None:
    """Outward rounding counts on each rounding of its own."""
    for path in sorted((PACKAGE / part).rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"\b(fused|FUSED|fastmath)\b", text), path


def test_packages_form_no_cycle() -> None:
    graph: dict[str, set[str]] = {}
    for path in SOURCES:
        graph.setdefault(part_of(path), set()).update(parts_imported(path) - {part_of(path)})
    order = list(graphlib.TopologicalSorter(graph).static_order())  # raises on a cycle
    assert order.index("bounds") < order.index("motion") < order.index("planning")


def test_files_form_no_cycle() -> None:
    """Wherever in a file an import stands, and if only for the type checker."""
    files = {".".join(path.relative_to(ROOT).with_suffix("").parts): path for path in SOURCES}
    graph = {
        name: {
            known
            for one in imported(path)
            for known in (one, one.rpartition(".")[0])
            if known in files and known != name
        }
        for name, path in files.items()
        if path.stem != "__init__"  # a room's front door names what it shows
    }
    list(graphlib.TopologicalSorter(graph).static_order())  # raises on a cycle


def test_nothing_below_reaches_the_reports_the_command_line_or_the_derivations() -> None:
    for path in (path for path in SOURCES if part_of(path) not in ABOVE):
        assert not parts_imported(path) & ABOVE, names(path)
        assert not any(name.split(".")[0] == "derivations" for name in imported(path)), names(path)


def test_campaigns_reach_nothing_that_tells_of_them() -> None:
    for path in (path for path in SOURCES if part_of(path) == "campaigns"):
        assert not parts_imported(path) & (ABOVE - {"campaigns", "__init__"}), names(path)


def test_derivations_know_nothing_of_the_package() -> None:
    for path in sorted((ROOT / "derivations").glob("*.py")):
        assert not any(name.split(".")[0] == "meso_robust" for name in imported(path)), path.name


def test_only_reports_draw() -> None:
    for path in (path for path in SOURCES if part_of(path) not in {"reporting", "reproduction"}):
        assert not any(name.split(".")[0] == "matplotlib" for name in imported(path)), names(path)


def test_no_print_and_no_assert_in_the_library() -> None:
    for path in (path for path in SOURCES if part_of(path) not in {"cli", "reporting"}):
        for node in ast.walk(tree(path)):
            assert not isinstance(node, ast.Assert), f"{names(path)}:{node.lineno}"
            called = node.func if isinstance(node, ast.Call) else None
            printed = isinstance(called, ast.Name) and called.id == "print"
            assert not printed, f"{names(path)}:{getattr(node, 'lineno', 0)}"


def test_derivations_named_in_obligations_exist() -> None:
    named = {
        obligation.inequality.derivation
        for step in paper_chain().steps
        for obligation in step.obligations
        if obligation.inequality.derivation is not None
    }
    assert len(named) >= 4
    for name in sorted(named):
        assert (ROOT / name).is_file(), name


def test_derivations_named_in_the_sources_exist() -> None:
    pattern = re.compile(r"derivations/\w+\.py")
    named = {name for path in SOURCES for name in pattern.findall(path.read_text(encoding="utf-8"))}
    assert len(named) >= 5
    for name in sorted(named):
        assert (ROOT / name).is_file(), name


def test_every_generated_module_names_its_own_derivation() -> None:
    modules = [path for path in SOURCES if part_of(path) == "_generated"]
    for path in modules:
        if path.stem != "__init__":
            assert f"Generated from derivations/{path.name} " in path.read_text(encoding="utf-8")


PROMISE = {
    "motion", "primitives", "planning", "feasible_regions", "certificates", "checker", "transfer", "policy",
    "laboratory", "campaigns", "pipeline", "api", "reporting",
}  # fmt: skip
_ASKED = {"startswith", "endswith", "removeprefix", "index", "find", "search", "match", "fullmatch"}


def sentences_compared(source: ast.AST) -> Iterator[tuple[int, str]]:
    """Texts of several words that something is compared with, searched for or looked up by."""
    for node in ast.walk(source):
        held: list[ast.expr] = []
        if isinstance(node, ast.Compare):
            held = [node.left, *node.comparators]
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            held = node.args if node.func.attr in _ASKED else []
        elif isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Load):
            typed = isinstance(node.value, ast.Name) and node.value.id in {"Annotated", "Literal"}
            held = [] if typed else [node.slice]
        for inner in (one for expression in held for one in ast.walk(expression)):
            if isinstance(inner, ast.Constant) and isinstance(inner.value, str):
                said = inner.value
                if len(said.split()) > 2:
                    yield inner.lineno, said


def test_nothing_of_the_promise_compares_or_searches_a_sentence() -> None:
    """Names are compared; the sentences of schema 1, which were compared, stand in one file."""
    found = [
        f"{names(path)}:{line}: {text}"
        for path in SOURCES
        if part_of(path) in PROMISE and path.name != "schema_one.py"
        for line, text in sentences_compared(tree(path))
    ]
    assert found == []


def test_words_of_names_stand_in_one_file_a_side() -> None:
    """No other file of the proof tells what an obligation, a premise or a remedy says."""
    from meso_robust.certificates.words import _SENTENCES, PREMISES

    said = {text for text in (*_SENTENCES.values(), *PREMISES.values()) if len(text.split()) > 4}
    rooms = PROMISE - {"checker", "reporting"}
    for path in (path for path in SOURCES if part_of(path) in rooms):
        if names(path) != "certificates/words.py":
            texts = {one.value for one in ast.walk(tree(path)) if isinstance(one, ast.Constant)}
            assert not texts & said, names(path)
