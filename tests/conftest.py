"""Fixtures that are costly enough to be shared."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from meso_robust import copies, pipeline
from meso_robust.certificates.margin import margin
from meso_robust.pipeline import Planned, make
from meso_robust.planning.compose import compose
from meso_robust.policy.cells import Policy
from tests.browser import REQUIRED, Browser, Page, browser as started, executable, tab
from tests.paper import paper_task as paper_task  # read from here by many tests
from tests.plan_once import once, one_at_a_time
from tests.policy.small import built

if TYPE_CHECKING:
    from derivations._derivation import Derivation


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that all workers of a run share."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "shared"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="session", autouse=True)
def _planned_once(shared: Path) -> Iterator[None]:
    """What ``plan`` searches for the same task is found once in a run: the searches take longest."""
    with pytest.MonkeyPatch.context() as patch:
        for of in (compose, margin):
            patch.setattr(pipeline, of.__name__, once(of, shared))
        yield


@pytest.fixture(autouse=True)
def _no_copies(monkeypatch: pytest.MonkeyPatch) -> None:
    """A verb that lets its process be copied, run by a test, does so for no later one."""
    monkeypatch.setattr(copies, "_allowed", [])


@pytest.fixture(scope="session")
def derived(shared: Path) -> tuple[Derivation, ...]:
    """All derivations. One worker runs them, on all cores, and keeps them for the next."""
    from derivations.generate import derive_all  # SymPy, which most workers of --fast never need

    with one_at_a_time(shared / "derived.lock"):
        return derive_all()


@pytest.fixture(scope="session")
def paper_plan() -> Planned:
    """The main job on the paper's task, with the 1,000 runs that the task asks for."""
    return make(paper_task(), 1000, 0)


@pytest.fixture(scope="session")
def wide_friction_plan() -> Planned:
    """The same task with friction anywhere from 0.05 to 0.9, and a probe on one side only."""
    return make(paper_task(uncertainty__friction=[0.05, 0.9], probe__headings=["-x"]), 100, 0)


@pytest.fixture(scope="session")
def small_policy(shared: Path) -> Policy:
    """The policy of ``tests.policy.small``."""
    found: Policy = once(built, shared)()
    return found


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """The session's Chromium; without one the test is skipped, or fails if MESO_BROWSER=required."""
    path = executable()
    if path is None:
        missing = pytest.fail if os.environ.get(REQUIRED) == "required" else pytest.skip
        missing("no Chromium on this machine (Debian: apt-get install chromium)")
    with started(path) as running:
        yield running


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """An empty tab of the session's browser."""
    with tab(browser) as opened:
        yield opened
