"""``meso-robust certify``: certifies a plan that someone else made."""

from __future__ import annotations

from meso_robust.api.plan import Planned, certify as call
from meso_robust.cli.plan import CHECKED, RESULTS, unplanned
from meso_robust.cli.verb import Run, verb
from meso_robust.copies import allow
from meso_robust.errors import NotApplicableError


@verb(call, out="meso-robust-certify", document="certificate.json")
def certify(run: Run) -> Planned:
    """Certify a plan, cross-check it in the simulator, and write a report."""
    allow()
    try:
        found: Planned = run.saved([*RESULTS, CHECKED])
    except NotApplicableError as error:
        unplanned(run, run.given["task"], error, "certify")
    (run.out / CHECKED).unlink(missing_ok=True)  # of an earlier plan
    return found
