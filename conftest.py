"""Which tests are slow, and what the examples of the API share: a plan of the paper's task, made once."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import pytest
from _pytest.doctest import DoctestItem

import meso_robust as mr
from tests.slow import LONGEST, ROOT, changed, is_slow, last_commit


def pytest_addoption(parser: pytest.Parser) -> None:
    """``--fast`` leaves slow tests to ``make test-all``, but for those of code that has changed."""
    parser.addoption("--fast", action="store_true", help="without slow tests of unchanged code")
    parser.addoption(
        "--recent",
        action="store_true",
        help="--fast, where what was committed lately is changed, and others come by turns",
    )


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leave slow tests out before they are imported, which would take seconds in every worker."""
    return (not collection_path.is_dir() and _waits(_path(collection_path), config)) or None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave single slow tests out, too, and begin with the slow files.

    One that is left for the end keeps a worker busy alone for minutes.
    """
    waiting = [item for item in items if _waits(_name(item), config)]
    config.hook.pytest_deselected(items=waiting)
    items[:] = [item for item in items if item not in waiting]
    items.sort(key=lambda item: _turn(_path(item.path)))


def _waits(test: str, config: pytest.Config) -> bool:
    recent = config.getoption("--recent")
    if not (recent or config.getoption("--fast")):
        return False
    touched, turn = _drawn(recent)
    if recent and not turn:  # nothing is known of what has changed
        return False
    return is_slow(test, touched, turn)


@cache
def _drawn(recent: bool) -> tuple[tuple[str, ...], str]:
    return changed(recent), last_commit() if recent else ""


def _turn(test: str) -> int:
    if test in LONGEST:
        return LONGEST.index(test)
    return len(LONGEST) + (not is_slow(test, ()))


def _path(file: Path) -> str:
    return file.relative_to(ROOT).as_posix() if file.is_relative_to(ROOT) else ""


def _name(item: pytest.Item) -> str:
    return f"{_path(item.path)}::{item.name.split('[')[0]}"


@pytest.fixture(autouse=True)
def _planned(request: pytest.FixtureRequest, doctest_namespace: dict[str, Any]) -> None:
    """Give ``mr``, ``task`` and ``planned`` to every example of the API, and to no other test."""
    item = request.node
    of_the_api = isinstance(item, DoctestItem) and item.name.startswith("meso_robust.api.")
    if of_the_api and "planned" not in doctest_namespace:
        task = mr.Task.paper()
        doctest_namespace.update(mr=mr, task=task, planned=mr.plan(task, samples=20))
