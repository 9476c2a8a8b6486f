"""The margin verified by another process: it is believed if it says yes, and never for anything else."""

from __future__ import annotations

import copy
import json
import signal
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from meso_robust.api import aside as asides
from meso_robust.api.aside import aside
from meso_robust.checker import margin as margins
from meso_robust.checker.document import Certificate
from meso_robust.checker.reading import digest, parse_certificate
from meso_robust.checker.verdict import Answer, check
from meso_robust.pipeline import Planned
from tests.conftest import paper_task

Document = dict[str, Any]
TASK = paper_task()


@pytest.fixture(scope="module")
def document(paper_plan: Planned) -> Document:
    """``certificate.json`` of the paper's task."""
    found: Document = json.loads(paper_plan.certificate.model_dump_json(by_alias=True))
    return found


@pytest.fixture(autouse=True)
def _two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(asides, "cores", lambda: 2)


def read(document: Document) -> tuple[Certificate, str]:
    sealed = {**document, "task_hash": TASK.hash, "task": TASK.name}
    sealed["digest"] = digest(sealed)
    return parse_certificate(json.dumps(sealed), "test", TASK)


def exaggerated(document: Document) -> Document:
    found = copy.deepcopy(document)
    margin = found["margin"]
    margin["factor"], margin["refused_at"] = 1.9, 1.95
    margin["each_alone"] = dict.fromkeys(margin["each_alone"], 2.0)
    return found


def says(document: Document) -> bool:
    with aside() as asked:
        return asked(read(document)[0], TASK, alone=False)()


def test_only_a_margin_that_holds_is_said_to(document: Document) -> None:
    assert says(document)
    assert not says(exaggerated(document))


@pytest.mark.parametrize("program", ["absent", "dies", "talks"])
def test_a_process_that_cannot_say_so_is_not_believed(
    document: Document, program: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = tmp_path / program
    if program != "absent":
        here.write_text("#!/bin/sh\n" + ("exit 1\n" if program == "dies" else "echo verified\n"))
        here.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(here))
    assert not says(document)


def test_on_one_core_none_is_begun(document: Document, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(asides, "cores", lambda: 1)
    monkeypatch.setattr(sys, "executable", "nothing may be started")
    assert not says(document)


def answer(document: Document, monkeypatch: pytest.MonkeyPatch) -> tuple[Answer, list[float]]:
    """The answer, and the factors that were verified in this process."""
    here: list[float] = []
    own = margins.check_factor

    def counted(certificate: Certificate, *args: Any, **more: Any) -> None:
        here.append(certificate.margin.factor)
        own(certificate, *args, **more)

    monkeypatch.setattr(margins, "check_factor", counted)
    certificate, own_digest = read(document)
    with aside() as asked:
        elsewhere = asked(certificate, TASK, alone=False)
        return check(certificate, own_digest, TASK, elsewhere=elsewhere), here


def test_a_certificate_is_verified_by_both(
    document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, here = answer(document, monkeypatch)
    assert (found.verdict, here) == ("VERIFIED", [])


def test_a_margin_that_is_refused_is_left_open_here(
    document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, here = answer(exaggerated(document), monkeypatch)
    assert (found.verdict, here) == ("MARGIN UNDECIDED", [1.9])


@pytest.mark.parametrize("told", [False, True])
def test_no_process_outlives_a_check_that_ends_early(
    document: Document, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, own = [], asides._begun

    def kept() -> Any:
        begun.append(own())
        return begun[-1]

    monkeypatch.setattr(asides, "_begun", kept)
    with suppress(KeyError), aside() as asked:
        if told:
            asked(read(document)[0], TASK, alone=False)
        raise KeyError
    (process,) = begun
    assert process is not None
    assert process.returncode == -signal.SIGKILL  # not waited for
