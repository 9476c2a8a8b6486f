"""``meso-robust check``: re-verifies a certificate by a route of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from meso_robust.api.check import check as call
from meso_robust.api.checked import Checked
from meso_robust.cli.verb import Run, verb
from meso_robust.tasks import PAPER


@verb(call, document="the answer as JSON", quiet="the verdict")
def check(
    run: Run,
    task: Annotated[
        Path | None, typer.Argument(help="Its task (TOML); the paper's task if left out.")
    ] = None,
) -> Checked:
    """Verify a certificate without the planner, in exact and ball arithmetic.

    Exit status 0: VERIFIED, the plan is proved. 1: any other answer.
    """
    return run.result(task=task or PAPER)
