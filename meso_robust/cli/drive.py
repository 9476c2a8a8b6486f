"""``meso-robust drive``: the laboratory's side of a plan or policy, JSON lines in and out."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from meso_robust.cli.console import Reporter, negative, refuse


def drive(
    task: Annotated[Path, typer.Argument(help="Task file (TOML).")],
    plan: Annotated[Path, typer.Argument(help="Plan (plan.json) or policy (policy.json) for it.")],
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the answers.")] = False,
) -> None:
    """Answer each sensed pose with the next certified move.

    Reads lines {"x_um": 0.0, "y_um": 0.0, "theta_deg": 0.0} from standard input, each the pose
    sensed after the last move was carried out, and answers each with one line: a move,
    {"done": true, "within": {...}}, {"refused": "..."} or {"error": "..."}. After done and refused,
    the next line is the first of the next part; an error (a line that is no pose, a blank one too)
    changes nothing. Ends at end of input.
    """
    from meso_robust.errors import InputError, NotApplicableError

    try:
        _drive(task, plan, Reporter(quiet))
    except InputError as error:
        refuse(error)
    except NotApplicableError as error:
        negative(error)
    except KeyboardInterrupt:
        raise typer.Exit from None


def _drive(task_file: Path, plan_file: Path, say: Reporter) -> None:
    from meso_robust.planning.reading import read_plan, read_text
    from meso_robust.task import load_task

    task = load_task(task_file)
    if '"meso-robust/policy/' not in read_text(plan_file):
        read_plan(plan_file, task)  # before the imports that take seconds

    from meso_robust.api.drive import drive as made_ready

    with say.doing("proving the plan before anything is moved"):
        driver = made_ready(task, plan_file)
    with say.doing("ready for sensed poses, one line each"):
        for line in sys.stdin:
            print(json.dumps(driver.answer_line(line), allow_nan=False), flush=True)
