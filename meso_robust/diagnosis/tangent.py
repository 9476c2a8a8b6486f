"""Linear algebra about a fit: coloured noise made white, and nuisances projected out.

A vector of the data is what is seen of all recordings in standard deviations, made white: with noise
of correlation φ, ``(r_t − φ r_{t−1}) / √(1 − φ²)``. What the parameters and starts of the fit could
take of such a vector is projected out; what is left is evidence against the fitted model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.stats import chi2, norm, t as student

from meso_robust.identification.models import Model, Parameter
from meso_robust.types import Flags, Floats

Without: TypeAlias = Callable[[int], Floats | None]
"""Coordinates (n,) of a model fitted without one of the recordings; None where that fit fails."""

CONFIDENCE = 0.9
"""Probability with which an interval shall cover."""
_TAIL = 0.5 * (1.0 - CONFIDENCE)
_DISAGREE = 0.1, 0.025
"""Chances with which recordings that agree are taken to disagree in part, and altogether, which makes
intervals a little wide."""
_DECISIVE = 0.2  # of what leaving out recordings does, squared, that is one's alone
_RANK = 1e-8  # of the largest singular value, below which a direction is none
_PRIOR = 4  # offsets of the tips, with a prior of their own


def whitened(residuals: Floats, seen: Flags, correlation: float) -> Floats:
    """Residuals (…, R, T, 3) in σ with the colour taken out; zero where not seen (R, T, 3).

    A frame after one that was not seen is as uncertain as a first one.
    """
    kept = np.where(seen, residuals, 0.0)
    if correlation == 0.0:
        return kept
    both = seen[:, 1:] & seen[:, :-1]
    white = kept.copy()
    # in place: of all simulated sets together these are larger than a cache
    white[..., 1:, :] -= np.where(both, correlation, 0.0) * kept[..., :-1, :]
    white[..., 1:, :] *= np.where(both, 1.0 / np.sqrt(1.0 - correlation**2), 1.0)
    return white


@dataclass(frozen=True, slots=True, eq=False)
class Tangent:
    """What a fitted model can take of the data, to first order.

    Attributes
    ----------
    own
        (R, M, d) orthonormal: what the start of each recording can take.
    shared
        (R M, n) orthonormal: what parameters can take beyond the starts.
    seen
        (R, T, 3) whether there is a datum.
    correlation
        φ of the noise.
    """

    own: Floats
    shared: Floats
    seen: Flags
    correlation: float

    def rows(self, residuals: Floats, offsets: Floats | None = None) -> Floats:
        """(…, R, M) white data of residuals (…, R, T, 3) and offsets (…, R, 4) in σ."""
        white = whitened(residuals, self.seen, self.correlation)
        flat = white.reshape(*white.shape[:-2], -1)
        more = self.own.shape[1] - flat.shape[-1]
        if not more:
            return flat
        prior = np.zeros((*flat.shape[:-1], more)) if offsets is None else -offsets
        return np.concatenate([flat, np.broadcast_to(prior, (*flat.shape[:-1], more))], axis=-1)

    def cleaned(self, rows: Floats) -> Floats:
        """(…, R, M) of what is left of rows (…, R, M) after the starts have taken their part."""
        # recording by recording, as products of matrices
        each = np.moveaxis(rows, -2, 0).reshape(len(self.own), -1, rows.shape[-1])
        taken = (each @ self.own) @ np.swapaxes(self.own, 1, 2)
        whole = np.moveaxis(taken.reshape(len(self.own), *rows.shape[:-2], -1), 0, -2)
        return np.asarray(rows - whole)

    def evidence(self, rows: Floats) -> Floats:
        """(…, R M) of what neither starts nor parameters can take."""
        left = self.cleaned(rows)
        flat = left.reshape(*left.shape[:-2], -1)
        return np.asarray(flat - (flat @ self.shared) @ self.shared.T)


def tangent(jacobian: Floats, parameters: int, seen: Flags, correlation: float) -> Tangent:
    """The tangent of a fit.

    Parameters
    ----------
    jacobian
        (R, 3 T, n + d) derivatives of the predictions over σ; of d = 7 the last 4 are offsets in σ.
    parameters
        n.
    seen
        (R, T, 3) whether there is a datum.
    correlation
        φ of the noise.
    """
    count, frames = seen.shape[:2]
    columns = np.moveaxis(jacobian, -1, 0).reshape(-1, count, frames, 3)
    white = whitened(columns, seen, correlation).reshape(len(columns), count, -1)
    own, shared = white[parameters:], white[:parameters]
    if len(own) > 3:
        prior = np.zeros((len(own), count, _PRIOR))
        prior[np.arange(_PRIOR) + 3, :, np.arange(_PRIOR)] = 1.0
        own = np.concatenate([own, prior], axis=-1)
        none = np.zeros((parameters, count, _PRIOR))
        shared = np.concatenate([shared, none], axis=-1)
    bases = np.stack([_padded(own[:, r].T) for r in range(count)])
    only = Tangent(bases, np.zeros((bases.shape[0] * bases.shape[1], 0)), seen, correlation)
    left = only.cleaned(shared).reshape(parameters, -1).T
    return Tangent(bases, basis(left), seen, correlation)


def basis(columns: Floats) -> Floats:
    """Orthonormal basis (M, k') of the span of columns (M, k); directions of no length are left out."""
    if not columns.shape[1]:
        return columns
    left, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, sizes > _RANK * max(float(sizes[0]), 1e-300)])


def _padded(columns: Floats) -> Floats:
    """Orthonormal basis with as many columns as were given, zero where the rank is less."""
    found = basis(columns)
    return np.pad(found, ((0, 0), (0, columns.shape[1] - found.shape[1])))


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """A number of a fitted model, SI, and what the recordings bound it to.

    Attributes
    ----------
    parameter
        Which number.
    value, low, high
        Best value and ends; an open end is that of the parameter's range.
    open_low, open_high
        Whether the recordings give no bound on that side.
    """

    parameter: Parameter
    value: float
    low: float
    high: float
    open_low: bool
    open_high: bool

    @property
    def key(self) -> str:
        """Name of the parameter."""
        return self.parameter.key

    @property
    def shown(self) -> dict[str, float]:
        """Value and ends as documents have them, in the unit of the name."""
        shown = self.parameter.shown
        return {"value": shown(self.value), "low": shown(self.low), "high": shown(self.high)}


def intervals(
    model: Model,
    values: Floats,
    jacobian: Floats,
    at: Tangent,
    rows: Floats | None = None,
    without: Without | None = None,
) -> tuple[Interval, ...]:
    """Intervals of all fitted numbers.

    From the curvature of the likelihood at the fit, which is right if the model is. With what is left
    of the data, and where recordings disagree by more than their noise, from the jackknife too, and the
    wider of both is taken: every recording is then a little wrong in its own way. In between, where it is
    not sure that they disagree, squares of the widths go over evenly from the one to the other.

    Parameters
    ----------
    model, values
        n numbers, (n,) in SI.
    jacobian
        (R, 3 T, n + d) at the fit.
    at
        Tells what is seen and the colour of the noise.
    rows
        (R, M) white residuals of the fit; without them no jackknife.
    without
        Fits again without a recording, for those that the jackknife hangs on; without it, it is linear
        in all of them.

    Returns
    -------
    tuple
        Of the fitted numbers, in the model's order.
    """
    n = len(model.parameters)
    alone, left = beyond_starts(model, jacobian, at)
    free = np.flatnonzero(model.fitted & (np.linalg.norm(left, axis=1) > 0.0))
    reach = np.full(n, np.inf)
    covariance = _inverse(left[free] @ left[free].T)
    reach[free] = norm.isf(_TAIL) * np.sqrt(np.maximum(np.diag(covariance), 0.0))
    if rows is not None:
        count = len(at.seen)
        curved = reach[free]

        def moved(row: int) -> Floats | None:
            again = None if without is None else without(row)
            return None if again is None else (model.coordinates(values[None])[0] - again)[free]

        columns = left[free].reshape(len(free), count, -1)
        apart, share = _jackknife(columns, alone.cleaned(rows), curved, moved)
        reach[free] = np.sqrt(curved**2 + share * np.maximum(apart**2 - curved**2, 0.0))
    middle = model.coordinates(values[None])[0]
    ends = [model.values((middle + sign * np.minimum(reach, 40.0))[None])[0] for sign in (-1, 1)]
    return tuple(_interval(model, k, values, ends) for k in range(n) if model.fitted[k])


def beyond_starts(model: Model, jacobian: Floats, at: Tangent) -> tuple[Tangent, Floats]:
    """What the starts can take alone, and what the numbers of a model change beyond it.

    Parameters
    ----------
    model, jacobian, at
        As of `intervals`.

    Returns
    -------
    Tangent, Floats
        That of the starts, and (n, R M) white changes.
    """
    n = len(model.parameters)
    alone = tangent(
        np.concatenate([np.zeros_like(jacobian[..., :n]), jacobian[..., n:]], axis=2),
        n,
        at.seen,
        at.correlation,
    )
    own = np.moveaxis(jacobian[..., :n], -1, 0).reshape(n, *at.seen.shape)
    return alone, alone.evidence(alone.rows(own))


def _inverse(matrix: Floats) -> Floats:
    return np.asarray(np.linalg.pinv(matrix, rcond=1e-12, hermitian=True))


def _jackknife(
    columns: Floats, rows: Floats, curved: Floats, again: Callable[[int], Floats | None]
) -> tuple[Floats, float]:
    """(k,) half widths by leaving out one recording at a time; and how far they count.

    Parameters
    ----------
    columns
        (k, R, M) derivatives of the white data.
    rows
        (R, M) what is left of the white data.
    curved
        (k,) half widths by the curvature.
    again
        (k,) by how much the numbers are more with a recording than without it, fitted again; None where that
        is not known.

    Returns
    -------
    Floats, float
        With few recordings they are rather too wide than too narrow (Tukey 1958; CR3 of MacKinnon and White
        1985, doi:10.1016/0304-4076(85)90158-7). They do not count where there is but one recording, or all
        agree to within their noise.
    """
    count = len(rows)
    if count < 2:
        return np.zeros(len(columns)), 0.0
    information = np.einsum("krm,lrm->rkl", columns, columns, optimize=True)
    scores = np.einsum("krm,rm->rk", columns, rows, optimize=True)
    whole = np.sum(information, axis=0)
    root = _inverse(whole)
    pulls = float(np.einsum("rk,kl,rl->", scores, root, scores, optimize=True))
    shares = root @ information
    # mean of the pulls by noise
    freedom = float(np.trace(np.sum(shares - shares @ shares, axis=0)))
    if freedom <= 0.0:
        return np.zeros(len(columns)), 0.0
    share = float(np.interp(pulls, chi2.isf(_DISAGREE, freedom), (0.0, 1.0)))
    moved = np.stack([_inverse(whole - information[r]) @ scores[r] for r in range(count)])
    for r in _decisive(moved, curved) if share > 0.0 else ():
        # the only recording that tells a number is far from where anything is linear
        fitted = again(r)
        moved[r] = moved[r] if fitted is None else fitted
    variance = (count - 1) / count * np.sum((moved - moved.mean(axis=0)) ** 2, axis=0)
    return np.asarray(student.isf(_TAIL, count - 1) * np.sqrt(variance)), share


def _decisive(moved: Floats, curved: Floats) -> list[int]:
    """Recordings without which numbers (R, k) move by more than their widths, and most of all."""
    away = np.abs(moved - moved.mean(axis=0))
    most = away**2 > _DECISIVE * np.sum(away**2, axis=0)
    return [int(r) for r in np.flatnonzero(np.any(most & (away > curved), axis=1))]


def _interval(model: Model, k: int, values: Floats, ends: list[Floats]) -> Interval:
    parameter = model.parameters[k]
    low, high = max(ends[0][k], parameter.low), min(ends[1][k], parameter.high)
    return Interval(
        parameter=parameter,
        value=float(values[k]),
        low=float(min(low, values[k])),
        high=float(max(high, values[k])),
        open_low=bool(low <= parameter.low),
        open_high=bool(high >= parameter.high),
    )
