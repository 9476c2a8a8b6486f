"""``meso-robust run``: a certified plan carried out in a laboratory, or in the virtual one."""

from __future__ import annotations

import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.api.run import DRAFT, JOURNAL, Ran, Repeated, replay as replay_call, run as call
from meso_robust.cli.console import negative
from meso_robust.cli.verb import Run, verb
from meso_robust.errors import NotApplicableError

if TYPE_CHECKING:
    from meso_robust.live.loop import Words


@verb(call, out="meso-robust-run", document="run.json")
def run(
    run: Run,
    yes: Annotated[
        bool, typer.Option("--yes", help="Make every move without asking first.")
    ] = False,
    replay: Annotated[
        Path | None,
        typer.Option(help="Decide again from the readings of this journal, and compare."),
    ] = None,
) -> Ran | Repeated:
    """Carry out a certified plan at the microscope: see the part, make the next move, see again.

    Each move waits for a yes, unless --yes. Ctrl-C stops everything and lifts the probes. A pose that cannot
    be trusted, or from which nothing is proved, is never acted on.
    """
    try:
        if replay is not None:
            task, plan = run.given["task"], run.given["plan"]
            return replay_call(task, plan, replay, progress=run.say)
        run.check_folder(["run.json", JOURNAL, DRAFT])
        from meso_robust.live.session import Attendance

        asked = not yes and not run.given["dry_run"]
        attendance = Attendance(ask=_ask if asked else None)
        result: Ran = run.result(folder=run.out, attendance=attendance)
    except NotApplicableError as error:
        negative(error)
    result.save(run.out)
    return result


def _ask(move: str, words: Words) -> None:
    """Ask, and take the answer meanwhile: the loop goes on watching."""
    print(f"{move}\nmake this move? [y/N] ", end="", file=sys.stderr, flush=True)

    def answer() -> None:
        words.say("yes" if sys.stdin.readline().strip().lower() in ("y", "yes") else "no")

    threading.Thread(target=answer, daemon=True).start()
