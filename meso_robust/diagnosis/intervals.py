"""Intervals of the numbers of a fit, the colour of the noise and the nuisances included."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from meso_robust.diagnosis.tangent import Tangent, tangent
from meso_robust.identification.models import Model
from meso_robust.types import Floats

CONFIDENCE = 0.9
"""Probability with which an interval shall cover."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """A number of a model in the unit of its name."""

    key: str
    unit: str
    value: float
    low: float
    high: float
    open_low: bool
    open_high: bool


def intervals(model: Model, values: Floats, jacobian: Floats, at: Tangent) -> tuple[Interval, ...]:
    """Intervals of all fitted numbers from the curvature of the likelihood at the fit.

    Parameters
    ----------
    model, values
        n numbers, (n,) in SI.
    jacobian
        (R, 3 T, n + d) at the fit.
    at
        Tells what is seen and the colour of the noise.
    """
    n = len(model.parameters)
    alone = tangent(
        np.concatenate([np.zeros_like(jacobian[..., :n]), jacobian[..., n:]], axis=2),
        n,
        at.seen,
        at.correlation,
    )
    own = np.moveaxis(jacobian[..., :n], -1, 0).reshape(n, *at.seen.shape)
    left = alone.evidence(alone.rows(own))
    free = np.flatnonzero(model.fitted & (np.linalg.norm(left, axis=1) > 0.0))
    spread = np.full(n, np.inf)
    covariance = np.linalg.pinv(left[free] @ left[free].T, rcond=1e-12, hermitian=True)
    spread[free] = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    reach = norm.isf(0.5 * (1.0 - CONFIDENCE)) * spread
    middle = model.coordinates(values[None])[0]
    ends = [model.values((middle + sign * np.minimum(reach, 40.0))[None])[0] for sign in (-1, 1)]
    return tuple(_interval(model, k, values, ends) for k in range(n) if model.fitted[k])


def _interval(model: Model, k: int, values: Floats, ends: list[Floats]) -> Interval:
    parameter = model.parameters[k]
    low, high = max(ends[0][k], parameter.low), min(ends[1][k], parameter.high)
    return Interval(
        key=parameter.key,
        unit=parameter.unit,
        value=float(values[k] / parameter.to_si),
        low=float(min(low, values[k]) / parameter.to_si),
        high=float(max(high, values[k]) / parameter.to_si),
        open_low=bool(low <= parameter.low),
        open_high=bool(high >= parameter.high),
    )
