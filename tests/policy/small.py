"""A small policy that is built once for all tests."""

from __future__ import annotations

from functools import cache

from meso_robust.policy.build import make_policy
from meso_robust.policy.cells import Policy
from tests.strategies import paper_task


@cache
def built() -> Policy:
    """No pushes along +x, at most one quarter turn and four moves."""
    return make_policy(paper_task(), headings=("-x", "-y", "+y"), quarters=(0, -1), most_moves=4)
