"""``meso-robust plan``: the main job, from a task to a certified and cross-checked plan."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from meso_robust.api.plan import Planned, plan as call, with_check
from meso_robust.cli.console import INTERRUPTED, negative, note
from meso_robust.cli.running import is_interruption
from meso_robust.cli.verb import Run, verb
from meso_robust.copies import allow
from meso_robust.errors import NotApplicableError
from meso_robust.tasks import PAPER

RESULTS = ("plan.json", "certificate.json", "report.html")
"""Files that are always written."""
CHECKED = "check.json"


@verb(call, out="meso-robust-plan", document="certificate.json")
def plan(
    run: Run,
    task: Annotated[
        Path | None, typer.Argument(help="Task file (TOML); the paper's task if left out.")
    ] = None,
) -> Planned:
    """Find a plan, certify it, cross-check it in the simulator, and write a report."""
    allow()
    file = task or PAPER
    try:
        names = written(**run.of(call, task=file))
        found: Planned = run.saved(names, task=file, check=False)
    except NotApplicableError as error:
        unplanned(run, file, error, "plan")
    (run.out / CHECKED).unlink(missing_ok=True)  # of an earlier plan
    if not run.given["check"]:
        return found
    try:  # the plan is kept, whatever becomes of its check
        found = with_check(found, run.say)
        found.save(run.out, progress=run.say)
    except (KeyboardInterrupt, Exception) as error:
        if not is_interruption(error):
            raise
        kept = f"the plan is in {run.out}, its certificate is not checked"
        print(f"meso-robust: interrupted; {kept}", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None
    return found


def written(*, model: object, widest: bool, policy: bool, maps: bool, **_: object) -> list[str]:
    """Names of the files that will be written or removed (but the drawings of the maps)."""
    names = [*RESULTS, CHECKED]
    names += ["task.toml"] if widest or model is not None else []
    names += ["premises.json"] if model is not None else []
    names += ["policy.json", "policy.md", "region.svg"] if policy else []
    return [*names, "admissible.json"] if maps else names


def unplanned(run: Run, task: Path, error: object, verb: str) -> NoReturn:
    """Write the report of a task that has no plan to judge; ends with exit status 1."""
    from meso_robust.files import write_all
    from meso_robust.planning.possible import remarks
    from meso_robust.reporting.unplanned import unplanned_report
    from meso_robust.task import load_task

    stated = load_task(task)
    if not run.quiet:  # a ratio of the wrong unit is a reason to find no plan
        for remark in remarks(stated):
            note(remark)
    within = run.given.get("search_s")
    options = "" if within is None else f" --search-s {within:g}"
    write_all(run.out, {"report.html": unplanned_report(stated, str(error), verb, options)})
    for name in ("plan.json", "certificate.json", CHECKED):  # of an earlier run: not the answer now
        (run.out / name).unlink(missing_ok=True)
    negative(f"UNKNOWN ({stated.tips}): {error} (report: {run.out / 'report.html'})")
