"""Runs under a model's own physics against the boxes that are proved of its plan."""

from __future__ import annotations

from meso_robust.identification.document import ModelDocument
from meso_robust.laboratory.running import excess
from meso_robust.transfer.promise import Recertified, as_fast
from meso_robust.transfer.running import outcomes_of
from tests.paper import paper_task


def outside_boxes(found: Recertified, document: ModelDocument) -> float:
    """How far any of 60 runs of the paper's plan leaves a certified box, m; all are to be completed."""
    task = as_fast(paper_task(), found.changed.task)
    ran = outcomes_of(found.plan.rules, task, document, 60, 4)
    assert ran.completed.all()
    return max(
        float(excess(move.after, step.post)[:, :2].max())
        for move, step in zip(ran.moves, found.wide.steps, strict=True)
        if step.post is not None
    )
