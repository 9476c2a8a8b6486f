"""``Task``, which shows itself in notebooks like everything that the calls give."""

from __future__ import annotations

from meso_robust.task import Task as Task


def _card(task: Task) -> str:
    from meso_robust.reporting.task_card import task_card

    return task_card(task, str(task))


Task.card = _card
