"""``meso-robust example``: the tutorial and everything that it needs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def example(
    folder: Annotated[
        Path, typer.Argument(help="New folder; existing files are never overwritten.")
    ] = Path("meso-robust-example"),
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing.")] = False,
) -> None:
    """Copy the tutorial, its task and videos, and all shipped tasks into a new folder."""
    from meso_robust.example import copy_example

    copy_example(folder)
    if not quiet:
        print(f"start with {folder / 'tutorial.md'}")
