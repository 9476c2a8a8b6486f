"""Command line: ``meso-robust VERB``; one small file a verb.

Exit status: 0 done and the answer is positive, 1 done and the answer is negative, 2 bad input,
3 internal fault.
"""

from __future__ import annotations

import os
import sys
import traceback
from typing import Annotated

import typer

from meso_robust.caches import prepare
from meso_robust.cli.running import end_by_a_signal_as_by_ctrl_c, escape_what_cannot_be_shown
from meso_robust.cli.verbs import Verbs
from meso_robust.lifetime import short

app = typer.Typer(
    cls=Verbs,
    help="Plans pushes for mesoscale parts, proves that they work, and says why when it cannot.",
    epilog="Exit status: 0 done, the answer is yes; 1 done, the answer is no; 2 bad input; "
    "3 internal fault; 130 interrupted. `meso-robust VERB --help` describes one verb.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _tell_version(asked: bool) -> None:
    if asked:
        from meso_robust.cli.version import lines

        print("\n".join(lines()))
        raise typer.Exit


@app.callback()
def _meso_robust(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_tell_version,
            is_eager=True,
            help="Show versions, machine and caches, for a bug report.",
        ),
    ] = False,
) -> None:
    pass


def main() -> None:
    """Run the command line; the only place where an internal fault is turned into exit status 3."""
    # products here are of thin matrices, for which threads of the linear algebra only wait: beside other
    # work a diagnosis took twice the processor
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    short()
    prepare()
    escape_what_cannot_be_shown()
    end_by_a_signal_as_by_ctrl_c()
    try:
        app()
    except Exception:  # a fault of ours, not of the user: show it whole
        traceback.print_exc()
        print(
            "meso-robust: internal fault, please report it with the lines above and those of "
            "`meso-robust --version`",
            file=sys.stderr,
        )
        sys.exit(3)
