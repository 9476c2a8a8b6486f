"""``meso-robust recordings``: checks a recording set, repairs it, imports other formats."""

from __future__ import annotations

from meso_robust.api.recordings import Recordings, read_recordings
from meso_robust.cli.verb import Run, verb


@verb(read_recordings, out="meso-robust-recordings", document="summary.json")
def recordings(run: Run) -> Recordings:
    """Check recordings and list what is wrong; write a report, a repaired or an imported set."""
    return run.saved()
