"""The page of a task that has no plan to judge: the reason, what would settle it, the task."""

from __future__ import annotations

from meso_robust.planning.possible import remarks
from meso_robust.provenance import made_with
from meso_robust.reporting import pages
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.task_card import task_figure
from meso_robust.reporting.words import sentence
from meso_robust.task import Task
from meso_robust.wording import worded


def unplanned_report(task: Task, why: str, verb: str, options: str = "") -> str:
    """One self-contained HTML page.

    Parameters
    ----------
    task
        What was to be planned or certified.
    why
        The reason, and after its first semicolon, else its last colon, what to do.
    verb
        Of the command line.
    options
        Of that line, after the task.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    cut = why.find("; ") if "; " in why else why.rfind(": ")
    reason, advice = (why[:cut], why[cut + 2 :]) if cut > 0 else (why, "")
    with style():
        picture = to_svg(task_figure(task), "task", "Start and goal")
    settled = pages.html("<p><strong>What would settle it:</strong> {}.</p>", worded(advice))
    task_body = pages.figure(
        pages.Figure(
            svg=picture,
            title="Start and goal",
            caption="Solid: the part at the start; dashed: in the middle of the goal.",
            wide=False,
        )
    )
    notes = [worded(remark) for remark in remarks(task)]
    return pages.page(
        pages.Report(
            banner=pages.Banner(
                verb=verb,
                subject=task.name,
                word="UNKNOWN",
                colour="UNKNOWN",
                meaning="Not proved and not refuted: no primitive can handle the task as it is "
                "stated.",
            ),
            sections=(
                pages.Section(
                    "open",
                    "Why there is no plan to judge",
                    link="What is open",
                    look="notice UNKNOWN",
                    body=(
                        pages.html("<p>{}</p>", sentence(worded(reason))),
                        *[settled] * bool(advice),
                    ),
                ),
                pages.Section(
                    "task", "The task", (task_body, *[pages.bullets(notes)] * bool(notes))
                ),
            ),
            made=pages.made(
                f"meso-robust {verb} TASK.toml{options}",
                ("task hash (SHA-256)", pages.code(task.hash)),
                after=" with the task file of this hash",
                using=made_with(("numpy", "pydantic")),
            ),
        )
    )
