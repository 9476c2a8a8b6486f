"""``meso-robust campaign``: properties, Monte Carlo and falsification, from one core to a cluster."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from meso_robust.cli.console import INTERRUPTED, NEGATIVE, Reporter, refuse
from meso_robust.limits import MOST_WORKERS

if TYPE_CHECKING:
    from meso_robust.api.campaign import Campaigned

EXAMPLES = "examples"
"""Folder of failing examples below that of the results, unless another one is given."""


def campaign(  # noqa: PLR0913  # every option of the verb is an argument
    campaign: Annotated[Path, typer.Argument(help="Campaign file (TOML).")],
    out: Annotated[Path, typer.Option(help="Folder for the store and the report.")] = Path(
        "meso-robust-campaign"
    ),
    examples: Annotated[
        Path | None,
        typer.Option(
            help="Folder where failing examples are kept, and tried again by every campaign that is "
            "given it; the results' own by default."
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(min=1, max=MOST_WORKERS, help="Processes; one for each core by default."),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            help="Dask scheduler to use instead of local processes, such as tcp://host:8786."
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Resume from the results already in the folder.")
    ] = False,
    seed: Annotated[int | None, typer.Option(min=0, help="Overrides the seed in the file.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print campaign.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the result.")] = False,
) -> None:
    """Run a campaign in small seeded chunks; write its store, campaign.json and report.html."""
    from meso_robust.errors import InputError

    asked = {
        "examples": examples or out / EXAMPLES,
        "workers": workers,
        "scheduler": scheduler,
        "resume": resume,
        "seed": seed,
    }
    try:
        found = _found(campaign, out, Reporter(quiet or as_json), **asked)
    except InputError as error:
        refuse(error)
    except KeyboardInterrupt:
        print(
            "meso-robust: interrupted; finished work is kept, continue with --resume",
            file=sys.stderr,
        )
        raise typer.Exit(INTERRUPTED) from None
    if as_json:
        print(found.text(), end="")
    elif not quiet:
        print(found)
        print(f"report: {out / 'report.html'}")
    if not found.positive:
        raise typer.Exit(NEGATIVE)


def _found(campaign: Path, out: Path, say: Reporter, **asked: Any) -> Campaigned:
    """What came of the campaign, with its results written into ``out``."""
    from meso_robust.api.campaign import campaign as campaigned

    found = campaigned(campaign, out, progress=say, **asked)
    found.save(out)
    return found
