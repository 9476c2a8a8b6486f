"""Programs stand in ``reports/`` beside what they wrote; ``tests/`` holds tests."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from tests.sources import tree

ROOT = Path(__file__).parents[1]
TESTS = sorted((ROOT / "tests").rglob("*.py"))
PROGRAMS = sorted((ROOT / "reports").rglob("*.py"))
TEXTS = ("*.md", "*.py", "*.txt", "Makefile", "*.toml")
_COMMAND = re.compile(r"python -m ((?:tests|reports)[\w.]*\w)")
_LINK = re.compile(r"\]\(([^)#\s:]+)\)")
_ELSEWHERE = {".venv", ".git"}


def guarded(path: Path) -> bool:
    """Whether a file does something when it is run: it asks for its own name."""
    return any(
        isinstance(node, ast.If) and "'__main__'" in ast.unparse(node.test)
        for node in tree(path).body
    )


def imported(path: Path) -> Iterator[str]:
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def commands() -> set[tuple[str, str]]:
    """Every module that a text tells to run, with the text that does."""
    texts = (
        path
        for pattern in TEXTS
        for path in ROOT.rglob(pattern)
        if not _ELSEWHERE & set(path.relative_to(ROOT).parts)
    )
    return {
        (module, path.relative_to(ROOT).as_posix())
        for path in texts
        for module in _COMMAND.findall(path.read_text(encoding="utf-8"))
    }


def test_no_test_is_a_program() -> None:
    assert [path.name for path in TESTS if guarded(path) or path.stem == "__main__"] == []


def test_a_program_uses_no_test_though_it_may_use_what_the_tests_share() -> None:
    private = re.compile(r"tests\.(.*\.)?(test_\w*|conftest)(\.|$)")
    found = {
        path.name: [name for name in imported(path) if private.match(name)] for path in PROGRAMS
    }
    assert {name: names for name, names in found.items() if names} == {}


def test_the_package_uses_neither_programs_nor_tests() -> None:
    sources = [
        path for part in ("meso_robust", "derivations") for path in (ROOT / part).rglob("*.py")
    ]
    above = {"reports", "tests"}
    assert [p.name for p in sources if above & {name.split(".")[0] for name in imported(p)}] == []


def test_every_command_that_a_text_names_is_a_program() -> None:
    found = commands()
    assert len(found) > 50
    for module, text in sorted(found):
        path = ROOT.joinpath(*module.split("."))
        program = path / "__main__.py" if path.is_dir() else path.with_suffix(".py")
        assert program.is_file(), f"{text}: python -m {module}"
        assert guarded(program), f"{text}: python -m {module} does nothing"


def test_every_folder_says_what_it_asks() -> None:
    index = (ROOT / "reports" / "README.md").read_text(encoding="utf-8")
    rooms = {path.parent for path in PROGRAMS if path.parents[1] == ROOT / "reports"}
    for room in rooms:
        assert (room / "README.md").is_file(), room.name
        assert f"({room.name}/README.md)" in index, room.name


def test_every_link_of_a_report_leads_to_what_is_kept() -> None:
    """On a new clone; elsewhere a page that was built there may stand in."""
    pages = sorted((ROOT / "reports").rglob("*.md"))
    links = [(page, link) for page in pages for link in _LINK.findall(page.read_text("utf-8"))]
    assert len(links) > 100
    for page, link in links:
        assert (page.parent / link).exists(), f"{page.relative_to(ROOT)}: {link}"
