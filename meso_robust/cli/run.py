"""``meso-robust run``: a certified plan carried out in a laboratory, or in the virtual one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from meso_robust.api.result import Result
from meso_robust.api.run import (
    DRAFT,
    JOURNAL,
    Ran,
    replay as replay_call,
    run as call,
    view_of,
)
from meso_robust.cli.console import negative, note
from meso_robust.cli.verb import Run, verb
from meso_robust.errors import InputError, NotApplicableError


@verb(call, out="meso-robust-run", document="run.json")
def run(
    run: Run,
    plan: Annotated[
        Path | None,
        typer.Argument(
            help="Plan (plan.json) or policy (policy.json) for it; none with --experiment."
        ),
    ] = None,
    experiment: Annotated[
        Path | None,
        typer.Option(
            help="Make these pushes (experiment.json), then identify, diagnose and plan again."
        ),
    ] = None,
    yes: Annotated[
        bool, typer.Option("--yes", help="Make every move without asking first.")
    ] = False,
    page: Annotated[
        bool,
        typer.Option("--page", help="Show the run on a page of this machine, with a stop button."),
    ] = False,
    replay: Annotated[
        Path | None,
        typer.Option(help="Decide again from the readings of this journal, and compare."),
    ] = None,
) -> Result:
    """Carry out a certified plan at the microscope: see the part, make the next move, see again.

    Each move waits for a yes, unless --yes. Ctrl-C, or the Enter key, stops everything and lifts the probes. A
    pose that cannot be trusted, or from which nothing is proved, is never acted on.
    """
    followed = experiment if plan is None else plan
    if followed is None or (plan is not None and experiment is not None):
        raise InputError("PLAN: give either a plan.json or policy.json, or --experiment FILE")
    try:
        if replay is not None:
            return replay_call(run.given["task"], followed, replay, progress=run.say)
        run.check_folder(["run.json", JOURNAL, DRAFT, "calibration.toml"], [followed])
        ran = _carried_out(run, not (yes or run.given["dry_run"]), page, followed)
        result: Result = ran
        if experiment is not None and not run.given["dry_run"]:
            from meso_robust.api.explore import explored

            result = explored(run.given["task"], ran, run.out, run.given["seed"], run.say)
    except NotApplicableError as error:
        negative(error)
    result.save(run.out)
    return result


def _carried_out(run: Run, asks: bool, page: bool, plan: Path) -> Ran:
    from meso_robust.cli.keys import Keys
    from meso_robust.live.session import Attendance

    result: Ran
    with Keys(stops=not run.given["dry_run"]) as keys:
        ask = keys.ask if asks else None
        if not page:
            attendance = Attendance(words=keys.words, ask=ask)
            result = run.result(plan=plan, folder=run.out, attendance=attendance)
            return result
        from meso_robust.live.page import served

        given = {name: run.given[name] for name in ("task", "lab", "seed")}
        view = view_of(plan=plan, **given)
        attendance = Attendance(words=keys.words, ask=ask, show=view.show)
        with served(view.shown, attendance.words) as address:
            note(f"the run is shown at {address}")
            result = run.result(plan=plan, folder=run.out, attendance=attendance)
        return result
