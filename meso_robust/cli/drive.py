"""``meso-robust drive``: the laboratory's side of a plan or policy, JSON lines in and out."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from meso_robust.api.drive import drive as call
from meso_robust.cli.console import Reporter, negative
from meso_robust.errors import NotApplicableError


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
    try:
        _drive(task, plan, Reporter(quiet))
    except NotApplicableError as error:
        negative(error)
    except KeyboardInterrupt:
        raise typer.Exit from None


def _drive(task: Path, plan: Path, say: Reporter) -> None:
    driver = call(task, plan, progress=say)
    with say.doing("ready for sensed poses, one line each"):
        for line in sys.stdin:
            print(json.dumps(driver.answer_line(line), allow_nan=False), flush=True)
