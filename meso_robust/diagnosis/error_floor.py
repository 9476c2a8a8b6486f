"""What any law could reach: the error that is left with a free hidden input in every window."""

from __future__ import annotations

import numpy as np

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.window_statistics import Statistics
from meso_robust.diagnosis.windows import windowed
from meso_robust.identification.prepared import Prepared
from meso_robust.recordings import RecordingSet


def catch_all(recordings: RecordingSet, prepared: Prepared, baseline: Baseline) -> float | None:
    """Error in σ of the plain model with hidden inputs at all stages, free from window to window.

    Parameters
    ----------
    recordings, prepared
        The same recordings, such as those held out.
    baseline
        The plain model; its parameters are held.

    Returns
    -------
    float or None
        Per degree of freedom beyond starts and inputs; None if no window has enough frames.
    """
    noise = baseline.noise
    try:
        found = windowed(
            recordings,
            baseline.model,
            baseline.fits.values[0],
            noise.sigma,
            noise.correlation,
            prepared=prepared,
        )
    except ValueError:
        return None
    return left(found.found)


def left(found: Statistics) -> float | None:
    """Root mean square in σ of what the inputs of all stages together leave; None of no datum."""
    freedom = float(np.sum(found.freedom - found.ranks[:, -1]))
    if freedom <= 0.0:
        return None
    chi2 = float(np.sum(found.chi2 - found.gains[:, -1]))
    return float(np.sqrt(max(chi2, 0.0) / freedom))
