"""One proved and one refuted result for all tests of the report."""

from __future__ import annotations

import pytest

from meso_robust import pipeline
from meso_robust.pipeline import Planned
from meso_robust.reporting.plan import report
from meso_robust.task import Task, load_task
from meso_robust.tasks import PAPER

SAMPLES, SEED = 40, 3


def made(task: Task) -> Planned:
    return pipeline.make(task, SAMPLES, SEED)


@pytest.fixture(scope="session")
def proved() -> Planned:
    """The shipped task."""
    result = made(load_task(PAPER))
    assert result.certificate.verdict == "PROVED"
    return result


@pytest.fixture(scope="session")
def refuted(proved: Planned) -> Planned:
    """The shipped plan under friction that it was not made for: nothing is searched, so it is fast."""
    hidden = load_task(PAPER)
    uncertainty = hidden.uncertainty.model_copy(update={"friction": (0.05, 0.9)})
    task = hidden.model_copy(update={"uncertainty": uncertainty})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pipeline, "compose", lambda *_: proved.found)
        result = made(task)
    assert result.certificate.verdict == "REFUTED"
    assert not result.chain.complete
    return result


@pytest.fixture(scope="session")
def proved_page(proved: Planned) -> str:
    return report(proved)


@pytest.fixture(scope="session")
def refuted_page(refuted: Planned) -> str:
    return report(refuted)
