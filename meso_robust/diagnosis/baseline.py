"""The plain model, refitted in full to the training recordings."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meso_robust.diagnosis.noise import Noise, weighed
from meso_robust.diagnosis.tangent import Tangent, tangent
from meso_robust.identification.identify import Identification, Told, identify
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared, prepare
from meso_robust.identification.problem import Fits, Settings
from meso_robust.recordings import RecordingSet
from meso_robust.types import Flags, Floats

_FINER = 4.0  # by how much shorter the steps of the other solver are
_LONGEST = 0.2  # s, of a step: forces that act on a part at rest move it evenly
_PIECES = 50  # of a recording, at least, where that is less
_STARTS = {True: 6, False: 12}  # random starts of a quick and of a full search


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Baseline:
    """A fitted model, and all that tests of it need.

    Attributes
    ----------
    found
        The identification.
    model, prepared, settings, fits
        Model, recordings with the correction for the steps, noise and the best fit (one).
    finer
        The recordings with shorter steps and no correction: another solver.
    jacobian
        (R, 3 T, n + d) at the fit.
    tangent
        What the fit can take of the data.
    noise
        Of the sensor.
    """

    found: Identification
    model: Model
    prepared: Prepared
    settings: Settings
    fits: Fits
    finer: Prepared
    jacobian: Floats
    tangent: Tangent
    noise: Noise

    @property
    def seen(self) -> Flags:
        """(R, T, 3) whether there is a datum."""
        return np.isfinite(self.prepared.seen)

    @property
    def evidence(self) -> Floats:
        """(R M,) what the recordings have against the model."""
        return self.tangent.evidence(self.rows)

    @property
    def rows(self) -> Floats:
        """(R, M) white residuals."""
        return rows_of(self.tangent, self.settings, self.fits)[0]


def rows_of(at: Tangent, settings: Settings, fits: Fits) -> Floats:
    """(B, R, M) white residuals of fits."""
    offsets = fits.offsets / settings.offset if settings.offset else None
    return at.rows(fits.residuals, offsets)


def fitted_baseline(
    training: RecordingSet, noise: Noise, model: str, *, quick: bool, seed: int, told: Told
) -> Baseline:
    """Fit the plain model.

    Parameters
    ----------
    training
        With the noise stated (`noise.with_noise`).
    noise
        Of the sensor.
    model
        Name of the model.
    quick, seed, told
        Fewer random starts; their seed; a callback for progress.

    Raises
    ------
    InputError
        As `identify`.
    """
    found = identify(training, model=model, starts=_STARTS[quick], seed=seed, told=told)
    if found.fitted is None or found.settings is None:  # only of the printed objective
        raise AssertionError("a likelihood has a fit")
    jacobian = found.fitted.jacobian[0]
    noise = weighed(noise, found.settings.sigma)
    n = len(found.model.parameters)
    longest = min(_LONGEST, float(np.max(found.prepared.times[:, -1])) / _PIECES)
    return Baseline(
        found=found,
        model=found.model,
        prepared=replace(found.prepared, time_step=longest),
        settings=found.settings,
        fits=found.fitted.fits,
        finer=replace(
            prepare(training, step=found.prepared.step / _FINER), time_step=longest / _FINER
        ),
        jacobian=jacobian,
        tangent=tangent(jacobian, n, np.isfinite(found.prepared.seen), noise.correlation),
        noise=noise,
    )
