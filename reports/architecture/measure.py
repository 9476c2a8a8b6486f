"""Size and shape of the house, of this checkout beside others.

``python -m reports.architecture.measure [NAME=TREE …] --out FILE`` measures checkouts that each have
their own ``.venv``; without a tree, this one. Every figure comes from the sources or from a run of the
verb itself, so that the same command gives the figures before and after a change.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
PASSED_BY = {"reporting", "simulator", "cli", "api"}
"""Rooms that serve a document on its way without handling it: pages, pushes, calls, formulas."""

_TRACER = """
import json, sys
out, *argv = sys.argv[1:]
files = set()
def profile(frame, event, _):
    if event == "call":
        code = frame.f_code
        if code.co_name != "<module>" and "meso_robust" in code.co_filename:
            files.add(code.co_filename)
import typer
from meso_robust.cli import main
sys.argv = ["meso-robust", *argv]
sys.setprofile(profile)
try:
    main()
except SystemExit:
    pass
finally:
    sys.setprofile(None)
    json.dump(sorted(files), open(out, "w"))
"""
"""Runs a verb and notes each file of the package in which a function was called."""


def sources(tree: Path) -> dict[str, ast.Module]:
    """The package's modules by dotted name, parsed."""
    found = {}
    for file in sorted((tree / "meso_robust").rglob("*.py")):
        parts = file.relative_to(tree).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        found[name] = ast.parse(file.read_text())
    return found


def arrows(name: str, module: ast.Module, names: set[str]) -> Iterator[str]:
    """Modules of the package that a module imports, at its top or inside a function."""
    for node in ast.walk(module):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                target = whole if whole in names else node.module
                if target in names and target != name and "." in target:
                    yield target
        elif isinstance(node, ast.Import):
            yield from (
                alias.name for alias in node.names if alias.name in names and "." in alias.name
            )


def in_circles(graph: dict[str, set[str]]) -> set[str]:
    """Nodes from which a way leads back to themselves."""

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        ahead = [*graph[start]]
        while ahead:
            node = ahead.pop()
            if node not in seen:
                seen.add(node)
                ahead += graph[node]
        return seen

    return {node for node in graph if node in reached(node)}


def circles(tree: Path, modules: dict[str, ast.Module]) -> tuple[int, int]:
    """Files and rooms that import each other in a circle."""
    names = set(modules)
    files = {
        name: set(arrows(name, module, names)) & names
        for name, module in modules.items()
        if "." in name  # the package itself names its calls for type checkers alone
    }
    rooms: dict[str, set[str]] = {}
    for name, module in modules.items():
        room = name.split(".")[1] if "." in name else ""
        targets = arrows(name, module, names)
        rooms.setdefault(room, set()).update(
            target.split(".")[1] for target in targets if "." in target
        )
    inner = set(rooms) - {"", "cli"}  # the command line is called by name, from anywhere
    apart = {room: (rooms[room] & inner) - {room} for room in inner}
    return len(in_circles(files)), len(in_circles(apart))


def lines(tree: Path, folder: str, pattern: str = "*.py") -> tuple[int, int]:
    """Lines and files that git tracks below a folder."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--", folder],
        cwd=tree,
        capture_output=True,
        text=True,
        check=True,
    )
    files = [tree / name for name in listed.stdout.split("\0") if Path(name).match(pattern)]
    return sum(file.read_bytes().count(b"\n") for file in files if file.is_file()), len(files)


def statements(modules: dict[str, ast.Module]) -> int:
    """Lines of code: docstrings, comments and blank lines left out, as the parser prints it."""
    total = 0
    for module in modules.values():
        for node in ast.walk(module):
            body = getattr(node, "body", None)
            if isinstance(body, list):  # a string that stands alone documents what is beside it
                node.body = [  # type: ignore[attr-defined]
                    part
                    for part in body
                    if not (isinstance(part, ast.Expr) and isinstance(part.value, ast.Constant))
                ]
        total += sum(bool(line) for line in ast.unparse(module).splitlines())
    return total


def touched(tree: Path, *verb: str) -> list[str]:
    """Files of the package in which a verb calls a function, relative to the package."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "files.json"
        command = [str(tree / ".venv/bin/python"), "-c", _TRACER, str(out), *verb]
        subprocess.run(
            [*command, "--quiet", "--out", f"{folder}/out"],
            cwd=tree,
            check=True,
            stdout=subprocess.DEVNULL,
            env={**os.environ, "NO_COLOR": "1"},
        )
        files = json.loads(out.read_text())
    package = str(tree / "meso_robust") + "/"
    return [file.removeprefix(package) for file in files]


def on_the_way(files: list[str]) -> str:
    """How many files handle the document itself, of all that are called into."""
    own = sum(file.split("/")[0] not in PASSED_BY for file in files)
    return f"{own} ({len(files)} with all that is called)"


def measure(tree: Path) -> dict[str, str]:
    """Every figure of a checkout, in words."""
    modules = sources(tree)
    package, reports = lines(tree, "meso_robust"), lines(tree, "reports", "*")
    tests = lines(tree, "tests")
    files, rooms = circles(tree, modules)
    code = statements(modules)
    task = touched(tree, "plan", "--samples", "20")
    recording = touched(tree, "diagnose", "tests/example/set", "--quick")
    return {
        "package: lines": f"{package[0]:,}",
        "package: statements, a line each, without docstrings": f"{code:,}",
        "package: files": f"{package[1]:,}",
        "package: rooms": str(sum(is_room(tree, name) for name in modules)),
        "files in import circles": str(files),
        "rooms in import circles": str(rooms),
        "files that a task passes on its way to certificate.json": on_the_way(task),
        "files that a recording passes on its way to diagnosis.json": on_the_way(recording),
        "tests: lines": f"{tests[0]:,}",
        "tests: files": f"{tests[1]:,}",
        "reports: tracked lines": f"{reports[0]:,}",
        "README: lines": str(lines(tree, "README.md", "*")[0]),
    }


def is_room(tree: Path, name: str) -> bool:
    """Whether a module is a folder right below the package."""
    return name.count(".") == 1 and (tree / Path(*name.split("."))).is_dir()


def main() -> None:
    """Measure the checkouts named on the command line and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("trees", nargs="*", default=[f"now={ROOT}"], metavar="NAME=TREE")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "measure.md")
    given = parser.parse_args()
    trees = dict(item.split("=", 1) for item in given.trees)
    columns = [measure(Path(tree).resolve()) for tree in trees.values()]
    rows = [
        f"| {name} | " + " | ".join(column[name] for column in columns) + " |"
        for name in columns[0]
    ]
    head = ["| | " + " | ".join(trees) + " |", "|---|" + "---|" * len(trees)]
    given.out.write_text("\n".join(["# Size and shape", "", *head, *rows]) + "\n")
    print(given.out.read_text())


if __name__ == "__main__":
    main()
