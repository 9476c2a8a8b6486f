"""``meso-robust certify``: certifies a plan that someone else made."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import Reporter, refuse
from meso_robust.cli.plan import RESULTS, tell, unplanned
from meso_robust.limits import MOST_SAMPLES

if TYPE_CHECKING:
    from meso_robust.api.plan import Planned


def certify(
    task: Annotated[Path, typer.Argument(help="Task file (TOML).")],
    plan: Annotated[Path, typer.Argument(help="Plan for this task (plan.json).")],
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-certify"
    ),
    samples: Annotated[
        int, typer.Option(min=1, max=MOST_SAMPLES, help="Random runs in the simulator.")
    ] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random runs.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print certificate.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the result.")] = False,
) -> None:
    """Certify a plan, cross-check it in the simulator, and write a report."""
    from meso_robust.errors import InputError, NotApplicableError

    say = Reporter(quiet or as_json)
    try:
        found = _found(task, plan, out, say, samples=samples, seed=seed)
    except InputError as error:
        refuse(error)
    except NotApplicableError as error:
        unplanned(task, out, error, "certify", quiet)
    tell(found, out, as_json, quiet)


def _found(task: Path, plan: Path, out: Path, say: Reporter, **asked: int) -> Planned:
    """The judged plan, written into ``out``."""
    from meso_robust.files import check_folder
    from meso_robust.planning.reading import read_plan
    from meso_robust.task import load_task

    known = load_task(task)
    stated = read_plan(plan, known)
    check_folder(out, RESULTS, (task, plan))

    from meso_robust.api.plan import certify as certified

    found = certified(known, stated, progress=say, **asked)
    found.save(out, progress=say)
    return found
