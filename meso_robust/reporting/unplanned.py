"""The page of a task that has no plan to judge: the reason, what would settle it, the task."""

from __future__ import annotations

from meso_robust.even_film import remarks
from meso_robust.provenance import made_with
from meso_robust.reporting.skeleton import Banner, code, page, versions
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.task_card import task_figure
from meso_robust.task import Task
from meso_robust.wording import worded


def unplanned_report(task: Task, why: str, verb: str) -> str:
    """One self-contained HTML page.

    Parameters
    ----------
    task
        What was to be planned or certified.
    why
        The reason, and after its first semicolon, else its last colon, what to do.
    verb
        Of the command line.
    """
    cut = why.find("; ") if "; " in why else why.rfind(": ")
    reason, advice = (why[:cut], why[cut + 2 :]) if cut > 0 else (why, "")
    banner = Banner(
        verb=verb,
        subject=task.name,
        word="UNKNOWN",
        colour="UNKNOWN",
        meaning="Not proved and not refuted: no primitive can handle the task as it is stated.",
    )
    made = (
        ("to reproduce", code(f"meso-robust {verb} TASK.toml", " with the task file of this hash")),
        ("task hash (SHA-256)", code(task.hash)),
        versions(made_with(("numpy", "pydantic"))),
    )
    with style():
        picture = to_svg(task_figure(task), "task", "Start and goal")
    return page(
        "unplanned.html.j2",
        banner,
        made,
        reason=worded(reason),
        advice=worded(advice),
        picture=picture,
        remarks=[worded(one) for one in remarks(task)],
    )
