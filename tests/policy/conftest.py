"""Fixtures of the policy's tests."""

from __future__ import annotations

import pytest

from meso_robust.policy.cells import Policy
from tests.policy.small import built


@pytest.fixture(scope="session")
def small_policy() -> Policy:
    """The policy of ``tests.policy.small``."""
    return built()
