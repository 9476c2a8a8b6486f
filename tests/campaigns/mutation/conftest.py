"""The certificate of the paper's task, to be tampered with."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from meso_robust.campaigns.kind import Part
from meso_robust.campaigns.mutation.kind import MUTATION, Prepared, prepare
from meso_robust.campaigns.mutation.original import Original
from meso_robust.campaigns.mutation.section import MutationSection
from meso_robust.pipeline import Planned
from tests.conftest import paper_task

Document = dict[str, Any]


@pytest.fixture(scope="package")
def document(paper_plan: Planned) -> Document:
    """``certificate.json``."""
    found: Document = json.loads(paper_plan.certificate.model_dump_json(by_alias=True))
    return found


@pytest.fixture(scope="package")
def part(document: Document, tmp_path_factory: pytest.TempPathFactory) -> Part:
    """Three chunks, the last one shorter."""
    folder = tmp_path_factory.mktemp("campaign")
    (folder / "certificate.json").write_text(json.dumps(document), encoding="utf-8")
    section = MutationSection(
        name="tampered", kind="mutation", certificate="certificate.json", certificates=15, chunk=6
    )
    return Part(
        name="tampered", kind="mutation", seed=11, confidence=0.95,
        asked=section.model_dump(mode="json"), given=MUTATION.given(section, Path(folder)),
    )  # fmt: skip


@pytest.fixture(scope="package")
def prepared(part: Part) -> Prepared:
    """The original, checked once."""
    return prepare(part)


@pytest.fixture(scope="package")
def original(document: Document) -> Original:
    """The certificate with its task."""
    return Original(paper_task(), document)
