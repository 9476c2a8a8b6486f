"""``meso-robust calibrate``: camera and manipulators of a laboratory, brought together."""

from __future__ import annotations

from meso_robust.api.calibrate import Calibrated, calibrate as call
from meso_robust.cli.console import negative
from meso_robust.cli.verb import Run, verb
from meso_robust.errors import NotApplicableError


@verb(call, out="meso-robust-calibrate", document="calibration.json")
def calibrate(run: Run) -> Calibrated:
    """Measure where each manipulator's tips are in the camera's world, and how well that is known."""
    try:
        return run.saved(["calibration.json"])
    except NotApplicableError as error:
        negative(error)
