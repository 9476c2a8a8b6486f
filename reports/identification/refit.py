"""Refits of simulated pushes by dense Gauss–Newton, to see what designs are worth in actual errors.

Shares with the design only the simulator: no information matrix, no Schur complement, no search. On a
film the data come from the event-driven engine, and the fit uses the stepper.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.identification.experiment import PlannedPush
from meso_robust.identification.rollout import Setting, rollout, start_of
from meso_robust.recordings.rules import DEG
from meso_robust.simulator import Film, Outcome, Push, Round, exact

F = npt.NDArray[np.float64]

RATE = 10.0
SIGMAS = np.array([1.2e-6, 1.2e-6, 0.08 * DEG])
PLACED = np.array([5e-6, 5e-6, 0.3 * DEG])
"""How well the part is laid down, half widths."""
_UNITS = np.array([1e-6, 1e-6, 1e-3])
"""Of the unknown starts, m, m and rad, also the steps of the differences."""
_STEP = 1e-3
_STEPS = 25
_LEAST_GAIN = 0.01  # of the sum of squares
_FINER = 5.0


@dataclass(frozen=True)
class Fit:
    values: F
    deviations: F
    """Of the fitted coordinates, from the residuals' Jacobian; NaN where not fitted."""
    chi2: float
    """Of the residuals, a degree of freedom."""


def recorded(
    setting: Setting, pushes: Sequence[PlannedPush], truth: F, rng: np.random.Generator
) -> F | None:
    """(R, T, 3) noisy poses at the frames, parts laid down with errors; None if a run ends early."""
    starts = start_of(pushes) + PLACED * rng.uniform(-1.0, 1.0, (len(pushes), 3))
    path = _path(setting, pushes, starts, truth)
    return None if path is None else path + SIGMAS * rng.standard_normal(path.shape)


def _path(setting: Setting, pushes: Sequence[PlannedPush], starts: F, truth: F) -> F | None:
    frames = _frames(setting, pushes)
    physics = setting.model.physics(np.tile(truth, (len(pushes), 1)))
    if isinstance(physics.support, Film):
        events = exact(_push(setting, pushes, starts, truth), samples=frames)
        return events.path if np.all(events.outcomes == Outcome.COMPLETED) else None
    fine = replace(setting, model=replace(setting.model, step=setting.model.step / _FINER))
    result = rollout(fine, pushes, starts, truth, intervals=frames)
    return result.path if np.all(result.outcomes == Outcome.COMPLETED) else None


def _push(setting: Setting, pushes: Sequence[PlannedPush], starts: F, truth: F) -> Push:
    physics = setting.model.physics(np.tile(truth, (len(pushes), 1)))
    return Push.straight(
        vertices=setting.part.outline,
        poses=starts,
        tips=np.array([push.tip for push in pushes])[:, None],
        travel=np.array([push.travel for push in pushes])[:, None],
        friction=physics.friction,
        support=physics.support,
        shapes=(Round(setting.bench.tip_radius),),
        step=1e-6,
    )


def _frames(setting: Setting, pushes: Sequence[PlannedPush]) -> int:
    (way,) = {round(float(np.hypot(*push.travel)), 9) for push in pushes}
    return round(way / setting.bench.speed * RATE)


def refit(setting: Setting, pushes: Sequence[PlannedPush], seen: F, guess: F) -> Fit:
    """Parameters and starts of R pushes, by Levenberg and Marquardt's method from a guess."""
    model = setting.model
    fitted = np.flatnonzero(model.fitted)
    here, starts = model.coordinates(guess[None])[0], seen[:, 0].copy()
    residual = _residual(setting, pushes, seen, here, starts)
    slopes = _slopes(setting, pushes, seen.shape[1], here, starts)
    damping = 1e-3
    for _ in range(_STEPS):
        normal = slopes.T @ slopes
        lifted = normal + damping * np.diag(np.diag(normal) + 1e-12)
        change = np.linalg.solve(lifted, -slopes.T @ residual)
        there = here.copy()
        there[fitted] += change[: len(fitted)]
        moved = starts + change[len(fitted) :].reshape(-1, 3) * _UNITS
        new = np.full(1, np.inf)
        if model.valid(model.values(there[None]))[0]:
            new = _residual(setting, pushes, seen, there, moved)
        gain = residual @ residual - new @ new
        if gain <= 0.0:
            damping *= 10.0
            continue
        here, starts, residual, damping = there, moved, new, 0.1 * damping
        slopes = _slopes(setting, pushes, seen.shape[1], here, starts)
        if gain < _LEAST_GAIN:
            break
    covariance = np.linalg.pinv(slopes.T @ slopes, hermitian=True)
    deviations = np.full(len(here), np.nan)
    deviations[fitted] = np.sqrt(np.diag(covariance)[: len(fitted)])
    freedom = residual.size - slopes.shape[1]
    return Fit(model.values(here[None])[0], deviations, float(residual @ residual) / freedom)


def _residual(setting: Setting, pushes: Sequence[PlannedPush], seen: F, here: F, starts: F) -> F:
    values = setting.model.values(here[None])[0]
    path = rollout(setting, pushes, starts, values, intervals=seen.shape[1] - 1).path
    return np.asarray(((path - seen) / SIGMAS).ravel())


def _slopes(setting: Setting, pushes: Sequence[PlannedPush], frames: int, here: F, starts: F) -> F:
    """Slopes of the residuals: by the parameters, then by every push's own start."""
    model, count = setting.model, len(pushes)
    fitted = np.flatnonzero(model.fitted)
    m = len(fitted)
    ahead, back = (model.values(here + s * _STEP * np.eye(len(here))[fitted]) for s in (1.0, -1.0))
    middle = model.values(here[None])
    can = np.stack([model.valid(ahead), model.valid(back)])
    ahead[~can[0]], back[~can[1]] = middle, middle
    values = np.concatenate([ahead, back, np.tile(middle, (6, 1))])
    shifts = np.concatenate([np.zeros((2 * m, 3)), np.diag(_UNITS), -np.diag(_UNITS)])
    each = len(values)
    result = rollout(
        setting,
        [push for push in pushes for _ in range(each)],
        (starts[:, None] + shifts).reshape(-1, 3),
        np.tile(values, (count, 1)),
        intervals=frames - 1,
    )
    paths = (result.path.reshape(count, each, -1, 3) / SIGMAS).reshape(count, each, -1)
    size = paths.shape[2]
    slopes = np.zeros((count * size, m + 3 * count))
    spans = _STEP * can.sum(axis=0)
    for j in range(m):
        slopes[:, j] = ((paths[:, j] - paths[:, m + j]) / spans[j]).ravel()
    own = 0.5 * (paths[:, 2 * m : 2 * m + 3] - paths[:, 2 * m + 3 :])
    for r in range(count):
        slopes[r * size : (r + 1) * size, m + 3 * r : m + 3 * r + 3] = own[r].T
    return slopes
