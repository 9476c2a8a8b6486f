"""``meso-robust diagnose``: says what physics the plain model leaves out of recordings."""

from __future__ import annotations

from meso_robust.api.diagnose import Diagnosed, diagnose as call
from meso_robust.api.inputs import keep_apart
from meso_robust.cli.verb import Run, verb
from meso_robust.copies import allow

STATE = ".meso-robust-diagnose"
"""Folder in that of the results, for what a run that was interrupted has done."""


@verb(
    call,
    out="meso-robust-diagnose",
    document="diagnosis.json",
    interrupted="run again to go on",
)
def diagnose(run: Run) -> Diagnosed:
    """Say what physics a plain model leaves out of recordings: where, what, and how much it helps."""
    allow()
    keep_apart(run.out, run.given["recordings"])
    diagnosed = run.saved(store=run.out / STATE)

    from meso_robust.diagnosis.store import Store

    Store(run.out / STATE, "").clear()
    return diagnosed
