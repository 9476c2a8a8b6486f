"""``meso-robust identify``: fits a model to recordings, plans and designs the pushes for it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from meso_robust.api.identify import Identified, StandardTests, identify as call, standard_tests
from meso_robust.api.inputs import keep_apart
from meso_robust.cli.verb import Run, verb


@verb(call, out="meso-robust-identify", document="identification.json")
def identify(
    run: Run,
    recordings: Annotated[
        Path, typer.Argument(help="Recording set (folder); with --plan also a task file.")
    ],
    plan: Annotated[
        bool, typer.Option("--plan", help="Only write the paper's tests A-H for this part.")
    ] = False,
) -> Identified | StandardTests:
    """Fit a model to recorded pushes: values, intervals, and what cannot be known from them."""
    keep_apart(run.out, recordings)
    if not plan:
        return run.saved()
    run.check_folder()
    with run.say.doing("planning the tests"):
        tests = standard_tests(recordings)
    tests.save(run.out)
    return tests
