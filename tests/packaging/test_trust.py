"""What SECURITY.md promises of the sources: files are data, and nothing in them is run."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.sources import tree

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "meso_robust").rglob("*.py"))

FORBIDDEN_CALLS = {
    "eval", "exec", "compile", "execfile", "__import__", "os.system", "os.popen", "yaml.load",
    "runpy.run_path", "runpy.run_module", "sp.sympify", "sympy.sympify", "sp.parse_expr",
    "sympy.parse_expr",
}  # fmt: skip
FORBIDDEN_IMPORTS = {
    "pickle", "cPickle", "dill", "cloudpickle", "marshal", "shelve", "joblib", "yaml", "jsonpickle",
    "socket", "urllib", "http", "ftplib", "smtplib", "requests", "httpx", "ctypes", "code",
    "subprocess", "distributed",
}  # fmt: skip
ALLOWED = {
    # names of the package's own modules, from a table in the source
    ("meso_robust/__init__.py", "calls import_module"),
    ("meso_robust/conditions/formula.py", "calls import_module"),
    ("meso_robust/campaigns/kinds.py", "calls import_module"),
    ("meso_robust/campaigns/property/registry.py", "calls import_module"),
    ("meso_robust/campaigns/property/laws/derived.py", "calls import_module"),
    ("meso_robust/campaigns/property/laws/routes.py", "calls import_module"),
    ("meso_robust/cli/schema.py", "calls import_module"),
    ("meso_robust/cli/verbs.py", "calls import_module"),
    ("meso_robust/reporting/conditions.py", "calls import_module"),
    ("meso_robust/reproduction/items.py", "calls import_module"),
    # libraries of the extra "tables", from a table in the source
    ("meso_robust/tracking/tables.py", "calls import_module"),
    # the name of this machine, for the store
    ("meso_robust/campaigns/chunk.py", "imports socket"),
    # git, to say which commit a certificate was made with
    ("meso_robust/provenance.py", "imports subprocess"),
    # this interpreter with a module of the package, to compile beside what runs
    ("meso_robust/simulator/ahead.py", "imports subprocess"),
    # the same, to verify the margin beside the moves
    ("meso_robust/api/aside.py", "imports subprocess"),
    # the page of a live run, for this machine alone, which a user asks for with --page
    ("meso_robust/live/page.py", "imports http"),
    # the one connection that a user can ask for, --scheduler
    ("meso_robust/campaigns/cluster.py", "imports distributed"),
}


def dotted(node: ast.expr) -> str:
    """Name of what is called, such as np.load."""
    if isinstance(node, ast.Attribute):
        return f"{dotted(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""


def keywords(call: ast.Call) -> dict[str, object]:
    return {
        one.arg: one.value.value
        for one in call.keywords
        if one.arg and isinstance(one.value, ast.Constant)
    }


def faults(source: ast.Module) -> Iterator[str]:
    """What a source does that could run what a file holds, or reach the network."""
    for node in ast.walk(source):
        if isinstance(node, ast.Import):
            yield from (fault for alias in node.names for fault in of_import(node, alias.name))
        elif isinstance(node, ast.ImportFrom):
            yield from of_import(node, node.module or "")
        elif isinstance(node, ast.Call):
            yield from of_call(node)


def of_import(node: ast.stmt, name: str) -> Iterator[str]:
    root = name.split(".")[0]
    if root in FORBIDDEN_IMPORTS:
        yield f"line {node.lineno}: imports {root}"


def of_call(node: ast.Call) -> Iterator[str]:
    called, given = dotted(node.func), keywords(node)
    if called in FORBIDDEN_CALLS or called.endswith("import_module"):
        yield f"line {node.lineno}: calls {called.split('.')[-1]}"
    if called in ("np.load", "numpy.load") and given.get("allow_pickle") is not False:
        yield f"line {node.lineno}: {called} without allow_pickle=False"
    if given.get("allow_pickle") is True or given.get("shell") is True:
        yield f"line {node.lineno}: {called} with {given}"


def test_nothing_of_a_file_is_run() -> None:
    found = [
        f"{name}: {fault}"
        for path in SOURCES
        for name in (path.relative_to(ROOT).as_posix(),)
        for fault in faults(tree(path))
        if not any(name == file and fault.endswith(what) for file, what in ALLOWED)
    ]
    assert not found


@pytest.mark.parametrize(
    "source",
    [
        "import pickle",
        "from pickle import loads",
        "import urllib.request",
        "eval('1')",
        "exec(text)",
        "np.load(path)",
        "np.load(path, allow_pickle=True)",
        "os.system('ls')",
        "subprocess.run('ls', shell=True)",
        "import subprocess",
        "importlib.import_module(name)",
        "sp.sympify(text)",
    ],
)
def test_the_search_finds_what_it_looks_for(source: str) -> None:
    assert list(faults(ast.parse(source)))


def test_every_exception_is_one_that_is_used() -> None:
    for file, what in ALLOWED:
        source = (ROOT / file).read_text(encoding="utf-8")
        assert any(fault.endswith(what) for fault in faults(ast.parse(source))), file


def test_the_limits_are_those_that_the_note_tells() -> None:
    from meso_robust.planning.reading import MOST_MOVES, MOST_PROBES
    from meso_robust.reading import DEEPEST, LARGEST_DATA, LARGEST_STATED, MIB
    from meso_robust.tracking.pixels import LARGEST_IMAGE, MOST_PIXELS

    note = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
    for told in (
        f"campaign) | {LARGEST_STATED // MIB} MiB",
        f"log of another format | {LARGEST_DATA // MIB} MiB",
        f"{DEEPEST} deep",
        f"rules of a plan | {MOST_MOVES:,}",
        f"probes of a move | {MOST_PROBES}",
        f"image file | {LARGEST_IMAGE // MIB} MiB",
        f"{MOST_PIXELS:,}",
    ):
        assert told in note, told
    for line in note.splitlines():
        if line.startswith("| ") and "meso_robust/" in line:
            place = (
                line.split("`")[-2] if "frames.py" not in line else "meso_robust/tracking/frames.py"
            )
            assert (ROOT / place).is_file(), place
