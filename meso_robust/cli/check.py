"""``meso-robust check``: re-verifies a certificate by a route of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, refuse


def check(
    certificate: Annotated[Path, typer.Argument(help="The certificate (certificate.json).")],
    task: Annotated[
        Path | None, typer.Argument(help="Its task (TOML); the paper's task if left out.")
    ] = None,
    thorough: Annotated[
        bool, typer.Option("--thorough", help="Also the margin of each uncertainty alone.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the answer as JSON only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the verdict.")] = False,
) -> None:
    """Verify a certificate without the planner, in exact and ball arithmetic.

    Exit status 0: VERIFIED, the plan is proved. 1: any other answer.
    """
    import json

    from meso_robust.api.check import check as checked
    from meso_robust.errors import InputError
    from meso_robust.tasks import PAPER

    try:
        say = Reporter(quiet or as_json)
        found = checked(certificate, task or PAPER, thorough=thorough, progress=say)
    except InputError as error:
        refuse(error)
    if as_json:
        print(json.dumps(found.document, indent=2, ensure_ascii=False))
    else:
        print(found.verdict if quiet and found.answer.refused is None else found)
    if not found.verified:
        raise typer.Exit(NEGATIVE)
