"""``meso-robust campaign``: properties, Monte Carlo and falsification, from one core to a cluster."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from meso_robust.api.campaign import Campaigned, campaign as call
from meso_robust.cli.verb import Run, verb

EXAMPLES = "examples"
"""Folder of failing examples below that of the results, unless another one is given."""


@verb(
    call,
    document="campaign.json",
    interrupted="finished work is kept, continue with --resume",
)
def campaign(
    run: Run,
    out: Annotated[Path, typer.Option(help="Folder for the store and the report.")] = Path(
        "meso-robust-campaign"
    ),
) -> Campaigned:
    """Run a campaign in small seeded chunks; write its store, campaign.json and report.html."""
    examples = run.given["examples"] or out / EXAMPLES
    campaigned = run.result(folder=out, examples=examples)
    campaigned.save(out, progress=run.say)
    return campaigned
