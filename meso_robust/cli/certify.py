"""``meso-robust certify``: certifies a plan that somebody else made."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from meso_robust.cli.console import Reporter, negative, refuse
from meso_robust.cli.plan import tell, write


def certify(
    task: Annotated[Path, typer.Argument(help="Task file (TOML).")],
    plan: Annotated[Path, typer.Argument(help="Plan for this task (plan.json).")],
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-certify"
    ),
    samples: Annotated[
        int, typer.Option(min=1, max=1_000_000, help="Random runs in the simulator.")
    ] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random runs.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print certificate.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Certify a plan, cross-check it in the simulator, and write a report."""
    from meso_robust.errors import InputError, NotApplicableError

    say = Reporter(quiet or as_json)
    try:
        _certify(task, plan, out, samples, seed, as_json, quiet, say)
    except InputError as error:
        refuse(error)
    except NotApplicableError as error:
        negative(f"UNKNOWN: {error}")


def _certify(
    task_file: Path,
    plan_file: Path,
    out: Path,
    samples: int,
    seed: int,
    as_json: bool,
    quiet: bool,
    say: Reporter,
) -> None:
    from meso_robust.files import check_folder
    from meso_robust.planning.reading import read_plan
    from meso_robust.task import load_task

    task = load_task(task_file)
    plan = read_plan(plan_file, task)
    check_folder(out)

    from meso_robust.job import judge
    from meso_robust.planning.compose import Found
    from meso_robust.planning.inference import inferred
    from meso_robust.planning.reading import rules_of
    from meso_robust.primitives.setup import setup_of

    rules = rules_of(plan) or inferred(plan, task, setup_of(task))
    found = Found(
        rules=rules,
        scale=1.0,
        advice="change the move that is not proved, or let `meso-robust plan` find a plan",
    )
    result = judge(task, found, samples, seed, say.doing)
    write(result, out, say)
    tell(result, out, as_json, quiet)
