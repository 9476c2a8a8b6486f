"""Command line: ``meso-robust VERB``; one small file a verb.

Exit status: 0 done and the answer is positive, 1 done and the answer is negative, 2 bad input,
3 internal fault.
"""

from __future__ import annotations

import sys
import traceback

import typer

from meso_robust.cli.campaign import campaign
from meso_robust.cli.certify import certify
from meso_robust.cli.check import check
from meso_robust.cli.derive import derive
from meso_robust.cli.diagnose import diagnose
from meso_robust.cli.drive import drive
from meso_robust.cli.example import example
from meso_robust.cli.identify import identify
from meso_robust.cli.plan import plan
from meso_robust.cli.recordings import recordings
from meso_robust.cli.reproduce import reproduce
from meso_robust.cli.schema import schema
from meso_robust.cli.simulate import simulate
from meso_robust.cli.track import track

app = typer.Typer(
    help="Plans pushes for mesoscale parts that are proved to work, and says why when none is.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
_VERBS = (
    example,
    plan,
    certify,
    check,
    simulate,
    drive,
    campaign,
    derive,
    track,
    recordings,
    identify,
    diagnose,
    reproduce,
    schema,
)
for verb in _VERBS:
    app.command()(verb)


def main() -> None:
    """Run the command line; the only place where an internal fault is turned into exit status 3."""
    try:
        app()
    except Exception:  # a fault of ours, not of the user: show it whole
        traceback.print_exc()
        print("meso-robust: internal fault, please report it with the lines above", file=sys.stderr)
        sys.exit(3)
