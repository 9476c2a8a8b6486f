"""The certificate of the paper's task, as a user would get it."""

from __future__ import annotations

import json
from typing import Any

import pytest

from meso_robust.pipeline import Planned

Document = dict[str, Any]


@pytest.fixture(scope="session")
def document(paper_plan: Planned) -> Document:
    """``certificate.json`` of the paper's task."""
    found: Document = json.loads(paper_plan.certificate.model_dump_json(by_alias=True))
    return found
