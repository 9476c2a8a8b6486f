"""``meso-robust reproduce``: the paper's tables and figures, side by side with the printed values."""

from __future__ import annotations

from meso_robust.api.reproduce import Reproduced, reproduce as call
from meso_robust.cli.verb import Run, verb


@verb(
    call,
    out="meso-robust-reproduce",
    document="reproduction.json",
    interrupted="nothing was written",
)
def reproduce(run: Run) -> Reproduced:
    """Reproduce the paper's tables and figures; show them next to the printed values."""
    return run.saved()
