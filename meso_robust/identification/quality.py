"""Whether the residuals of a fit look like the noise, and what intervals must be widened by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2 as chi2_law, f as f_law

from meso_robust.identification.document import REJECTED_BELOW
from meso_robust.identification.likelihood import Fits
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared
from meso_robust.types import Floats

_SIGNIFICANT = 4.0  # standard errors of a correlation that are not taken for chance
_TRUST = 0.2  # share of the correction for the steps that may be wrong
_MOST = 0.98  # correlation of neighbours that an inflation is computed for


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Quality:
    """How good a fit is.

    Attributes
    ----------
    chi2, freedom
        Squared residuals over σ² and their degrees of freedom.
    p_value
        Probability of a χ² at least as large if the model is right and the noise is white, of the
        stated σ or of that which still frames show as well as they can.
    correlation
        Of the residuals of neighbouring frames.
    inflation
        By how much χ² varies more than it would with white noise of the stated σ; intervals take it
        into account. One if the residuals give no reason.
    numerical
        Largest change of a parameter, in standard deviations, when predictions were corrected for the
        length of the steps; the correction is trusted to a fifth, and intervals take that in.
    rms
        (R, 3) root mean squares of the residuals along x, y in m and θ in rad.
    sigma
        (3,) root mean squares of all, likewise.
    """

    chi2: float
    freedom: int
    p_value: float
    correlation: float
    inflation: float
    numerical: float
    rms: Floats
    sigma: Floats

    @property
    def widening(self) -> float:
        """What variances are multiplied with: of the noise, and of the numerical error."""
        return self.inflation * (1.0 + (_TRUST * self.numerical) ** 2)


def quality(
    prepared: Prepared, model: Model, fits: Fits, sigma: Floats, numerical: float = 0.0
) -> Quality:
    """Quality of the one fit in `fits` with σ (3,) of x, y and θ, and the numerical shift."""
    counts = prepared.counts
    freedom = int(counts.sum() - 3 * len(counts) - model.fitted.sum())
    chi2 = float(fits.chi2[0])
    p_value = _probability(chi2, max(freedom, 1), prepared.sigmas.freedom)
    correlation, pairs = _correlation(prepared, fits.residuals[0])
    inflation = max(1.0, chi2 / max(freedom, 1)) if p_value < REJECTED_BELOW else 1.0
    if correlation * np.sqrt(pairs) > _SIGNIFICANT:
        kept = min(correlation, _MOST)
        inflation *= (1.0 + kept) / (1.0 - kept)
    squares = np.sum(fits.residuals[0] ** 2, axis=1)
    return Quality(
        chi2=chi2,
        freedom=freedom,
        p_value=p_value,
        correlation=correlation,
        inflation=float(inflation),
        numerical=numerical,
        rms=sigma * np.sqrt(squares / np.maximum(counts, 1)),
        sigma=sigma * np.sqrt(squares.sum(axis=0) / np.maximum(counts.sum(axis=0), 1)),
    )


def _probability(chi2: float, freedom: int, known: float) -> float:
    """Of such a χ² where its σ² is itself an estimate of ``known`` degrees of freedom."""
    if np.isinf(known):
        return float(chi2_law.sf(chi2, freedom))
    return float(f_law.sf(chi2 / freedom, freedom, known))


def _correlation(prepared: Prepared, residuals: Floats) -> tuple[float, int]:
    """Correlation of residuals (R, T, 3) of neighbouring frames, and the number of pairs."""
    seen = np.isfinite(prepared.seen)
    both = seen[:, 1:] & seen[:, :-1]
    products = np.sum(residuals[:, 1:] * residuals[:, :-1] * both)
    squares = np.sum(residuals**2) / max(int(seen.sum()), 1)
    pairs = max(int(both.sum()), 1)
    return float(products / (pairs * squares)) if squares > 0.0 else 0.0, pairs
