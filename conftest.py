"""What the examples in the docstrings of the API share: a plan of the paper's task, made once."""

from __future__ import annotations

from typing import Any

import pytest
from _pytest.doctest import DoctestItem

import meso_robust as mr


@pytest.fixture(autouse=True)
def _planned(request: pytest.FixtureRequest, doctest_namespace: dict[str, Any]) -> None:
    """Give ``mr``, ``task`` and ``planned`` to every example of the API, and to no other test."""
    item = request.node
    of_the_api = isinstance(item, DoctestItem) and item.name.startswith("meso_robust.api.")
    if of_the_api and "planned" not in doctest_namespace:
        task = mr.Task.paper()
        doctest_namespace.update(mr=mr, task=task, planned=mr.plan(task, samples=20))
