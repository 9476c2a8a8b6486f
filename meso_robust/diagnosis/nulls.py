"""Recordings without a mismatch: simulated with the fitted model, and fitted like the real ones.

Motion is from shorter steps than the fit's, so that errors of the solver are in the distribution;
noise has the colour of the sensor's, with what is not known of it redrawn for each set, and the
frames that the camera lost are lost again.
"""

from __future__ import annotations

import numpy as np

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.identification.forward import Prediction, predicted
from meso_robust.identification.problem import Arrow
from meso_robust.simulator import Outcome
from meso_robust.types import Flags, Floats, Ints

_ROUNDS = 3  # Newton's steps of a refit that starts next to its end
_EXCLUDED = 9.0  # χ² of what no refit takes of a change of the parameters: three σ
_FARTHEST = 0.5  # largest step of a coordinate


def null_rows(baseline: Baseline, count: int, seed: int) -> Floats:
    """White residuals (B, R, M) of sets simulated without a mismatch, each refitted.

    Parameters
    ----------
    baseline
        The fitted model.
    count
        B.
    seed
        Of parameters and noise.
    """
    rng = np.random.default_rng([seed, 1])
    fits, settings = baseline.fits, baseline.settings
    values = _drawn(baseline, count, rng)
    starts = fits.starts + _start_errors(baseline, count, rng)
    offsets: Floats = np.zeros((count, *fits.offsets.shape[1:]))
    if settings.offset:
        offsets = settings.offset * rng.standard_normal(offsets.shape)

    def of(rows: Ints, values: Floats) -> Prediction:
        return predicted(
            baseline.finer, baseline.model, values, starts=starts[rows], offsets=offsets[rows]
        )

    # the range of a weak parameter is not as even as its curvature says: what the recordings exclude
    # is not drawn
    drawn = of(np.arange(count), values)
    known = predicted(
        baseline.finer,
        baseline.model,
        fits.values,
        starts=fits.starts,
        offsets=np.zeros_like(fits.offsets),
    )
    change = drawn.poses - known.poses  # what starts and tips make of it, the tangent takes
    rows = baseline.tangent.rows(np.where(baseline.seen, change / settings.sigma, 0.0))
    excluded = np.flatnonzero(np.sum(baseline.tangent.evidence(rows) ** 2, axis=1) > _EXCLUDED)
    poses, outcomes = drawn.poses, drawn.outcomes
    if excluded.size:
        instead = of(excluded, np.repeat(fits.values, len(excluded), axis=0))
        poses[excluded], outcomes[excluded] = instead.poses, instead.outcomes
    failed = outcomes != Outcome.COMPLETED
    noise = _coloured(baseline, poses.shape, rng)
    return _refitted(baseline, poses + noise, noise, failed)


def _drawn(baseline: Baseline, count: int, rng: np.random.Generator) -> Floats:
    """Vectors (B, n) as likely as the recordings make them."""
    model, fitted = baseline.model, baseline.found.fitted
    best = baseline.fits.values
    if fitted is None:
        return np.repeat(best, count, axis=0)
    free = model.fitted
    spread = np.linalg.pinv(fitted.information[0][np.ix_(free, free)], hermitian=True)
    moves = np.zeros((count, len(free)))
    widths, ways = np.linalg.eigh(spread)
    steps = rng.standard_normal((count, len(widths))) * np.sqrt(np.clip(widths, 0.0, 0.01))
    moves[:, free] = steps @ ways.T
    drawn = model.values(model.coordinates(best) + moves)
    drawn[:, ~free] = best[:, ~free]
    drawn[~model.valid(drawn)] = best
    return np.asarray(drawn)


def _start_errors(baseline: Baseline, count: int, rng: np.random.Generator) -> Floats:
    """(B, R, 3) by how much the true starts may differ from the fitted ones, m and rad."""
    n = len(baseline.model.parameters)
    own = _normal(baseline)[:, n : n + 3, n : n + 3] + 1e-6 * np.eye(3)
    widths, ways = np.linalg.eigh(np.linalg.inv(own))
    steps = rng.standard_normal((count, len(own), 3)) * np.sqrt(widths)
    return np.asarray(np.einsum("rij,brj->bri", ways, steps) * baseline.settings.sigma)


def _coloured(baseline: Baseline, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
    """Noise (B, R, T, 3) in m and rad."""
    noise, count = baseline.noise, shape[0]
    drawn = noise.correlation + noise.correlation_error * rng.standard_normal(count)
    phi = np.clip(drawn, 0.0, 0.95)[:, None, None]
    spread = np.zeros((count, 3))
    if np.isfinite(noise.freedom):
        spread = rng.standard_normal((count, 3)) / np.sqrt(2.0 * noise.freedom)
    fresh = rng.standard_normal(shape)
    kept = np.sqrt(1.0 - phi**2)
    for t in range(1, shape[2]):
        fresh[:, :, t] = phi * fresh[:, :, t - 1] + kept * fresh[:, :, t]
    sigma = noise.floor * baseline.settings.sigma
    return np.asarray(fresh * sigma * (1.0 + spread)[:, None, None])


def _refitted(baseline: Baseline, seen: Floats, noise: Floats, failed: Flags) -> Floats:
    """White residuals (B, R, M) of data (B, R, T, 3) after a fit of everything to each.

    Of a parameter that hardly shows a step may lead away: the best round counts.

    A push that fails (B, R) with numbers so near to the fit's, as a jam between two tips may, says
    nothing; its noise stands for what a fit would leave.
    """
    model, settings, prepared = baseline.model, baseline.settings, baseline.prepared
    n, count = len(model.parameters), len(seen)
    coordinates = np.repeat(model.coordinates(baseline.fits.values), count, axis=0)
    starts = np.repeat(baseline.fits.starts, count, axis=0)
    offsets = np.zeros((count, *baseline.fits.offsets.shape[1:]))
    normal = _normal(baseline)
    moving = np.broadcast_to(model.fitted, coordinates.shape)
    best, least = np.zeros(0), np.full(count, np.inf)
    for turn in range(_ROUNDS + 1):
        # all begin alike: one prediction is that of all
        some = slice(None if turn else 1)
        values = _valid(baseline, model.values(coordinates[some]))
        found = predicted(prepared, model, values, starts=starts[some], offsets=offsets[some])
        lost = (failed | (found.outcomes != Outcome.COMPLETED))[..., None, None]
        left = np.where(lost, noise, seen - found.poses)
        residuals = np.where(baseline.seen, left / settings.sigma, 0.0)
        scaled = offsets / settings.offset if settings.offset else None
        rows = baseline.tangent.rows(residuals, scaled)
        misfit = np.sum(rows**2, axis=(1, 2))
        best = np.where((misfit < least)[:, None, None], rows, best) if turn else rows
        least = np.minimum(misfit, least)
        if turn == _ROUNDS:
            break
        slope = np.einsum(
            "rmj,brm->brj", baseline.jacobian, residuals.reshape(*residuals.shape[:2], -1)
        )
        if settings.offset:
            slope[..., n + 3 :] -= offsets / settings.offset
        arrow = Arrow(
            normal=np.broadcast_to(normal, (count, *normal.shape)), slope=slope, parameters=n
        )
        shared, own = arrow.step(np.full(count, 1e-6), moving)
        coordinates = coordinates + np.clip(shared, -_FARTHEST, _FARTHEST)
        starts = starts + own[..., :3] * settings.sigma
        if settings.offset:
            offsets = offsets + own[..., 3:] * settings.offset
    return best


def _normal(baseline: Baseline) -> Floats:
    """(R, n + d, n + d) normal matrices at the fit."""
    jacobian = baseline.jacobian
    normal = np.einsum("rmi,rmj->rij", jacobian, jacobian)
    if baseline.settings.offset:
        own = np.arange(len(baseline.model.parameters) + 3, jacobian.shape[-1])
        normal[:, own, own] += 1.0
    return np.asarray(normal)


def _valid(baseline: Baseline, values: Floats) -> Floats:
    """Values within their ranges; those of the fit where a constraint is broken."""
    low = [parameter.low for parameter in baseline.model.parameters]
    high = [parameter.high for parameter in baseline.model.parameters]
    values = np.clip(values, low, high)
    values[~baseline.model.valid(values)] = baseline.fits.values
    return np.asarray(values)
