"""Parts about the paper's plan, and their claims with a planted defect."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from meso_robust.campaigns.falsify.kind import FALSIFY
from meso_robust.campaigns.falsify.ready import Ready, ready_of
from meso_robust.campaigns.falsify.section import FalsifySection
from meso_robust.campaigns.falsify.targets import all_targets
from meso_robust.campaigns.kind import Part
from meso_robust.laboratory.claims import Claims

ROOT = Path(__file__).parents[3]
PLAN = "reports/paper_task/plan.json"


def part_of(**asked: Any) -> Part:
    """A part about the paper's plan."""
    section = FalsifySection(name="paper", kind="falsify", plan=PLAN, **asked)
    return Part(
        name="paper",
        kind="falsify",
        seed=7,
        confidence=0.95,
        asked=section.model_dump(mode="json"),
        given=FALSIFY.given(section, ROOT),
    )


@cache
def paper_ready(factor: float = 1.0) -> Ready:
    """Prepared, without rows for adversarial draws."""
    return ready_of(part_of(factor=factor))


def claiming(ready: Ready, claims: Claims) -> Ready:
    """The same plan with other claims."""
    return replace(ready, claims=claims, targets=all_targets(claims))


def with_side(ready: Ready, move: int, axis: int, side: int, at: float) -> Ready:
    """One side of the box after a move (0 for the first) put elsewhere: 0 the lower, 1 the upper."""
    posts = list(ready.claims.posts)
    box = posts[move]
    assert box is not None
    posts[move] = box.copy()
    posts[move][side, axis] = at  # type: ignore[index]
    return claiming(ready, replace(ready.claims, posts=tuple(posts)))
