"""``meso-robust drive``: the laboratory's side of a plan or policy, JSON lines in and out."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import Reporter, negative, refuse

if TYPE_CHECKING:
    from meso_robust.policy.controller import Controller, Reply
    from meso_robust.task import Task


def drive(
    task: Annotated[Path, typer.Argument(help="Task file (TOML).")],
    plan: Annotated[Path, typer.Argument(help="Plan (plan.json) or policy (policy.json) for it.")],
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the answers.")] = False,
) -> None:
    """Answer each sensed pose with the next certified move.

    Reads lines {"x_um": 0.0, "y_um": 0.0, "theta_deg": 0.0} from standard input, each the pose
    sensed after the last move was carried out, and answers each with one line: a move,
    {"done": true, "within": {...}}, {"refused": "..."} or {"error": "..."}. Ends at end of input.
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
    from meso_robust.policy.controller import controller_of
    from meso_robust.policy.pose import PoseError, parse
    from meso_robust.task import load_task

    task = load_task(task_file)
    with say.doing("proving the plan before anything is moved"):
        controller = controller_of(plan_file, task)
        _warm(controller, task)
    with say.doing("ready for sensed poses, one line each"):
        for line in sys.stdin:
            if not line.strip():
                continue
            try:
                answer = _told(controller.answer(parse(line)), task)
            except PoseError as error:
                answer = {"error": str(error)}
            print(json.dumps(answer, allow_nan=False), flush=True)


def _warm(controller: Controller, task: Task) -> None:
    """Import and compile what an answer needs, so that the first one is as fast as the others."""
    from meso_robust.policy.controller import rehearsed

    for reply in rehearsed(controller):
        _told(reply, task)


def _told(reply: Reply, task: Task) -> dict[str, object]:
    from meso_robust.planning.document import box_document
    from meso_robust.policy.controller import Done, Refused, commanded

    if isinstance(reply, Refused):
        return {"refused": reply.why}
    if isinstance(reply, Done):
        return {"done": True, "within": box_document(reply.within).model_dump()}
    return commanded(reply, task).model_dump(mode="json")
