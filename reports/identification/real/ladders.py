"""Models of growing size for the same pushes: what each explains of pushes it has not seen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.identification.models import Model, viscous, with_effects
from meso_robust.identification.prepared import prepare
from meso_robust.recordings import RecordingSet
from reports.identification.real.fitting import (
    Fit,
    Problem,
    Rows,
    bootstrapped,
    errors,
    fitted,
    held_out,
    losses,
)

F = npt.NDArray[np.float64]
Effects = Mapping[str, Mapping[str, float]]

OFFSET: Effects = {"reference_offset": {"x_um": 1000.0, "y_um": 1000.0}}
CENTRE: Effects = {"drag_centre_offset": {"x_um": 3000.0, "y_um": 3000.0}}
GRAIN: Effects = {"anisotropic_drag": {"fraction": 0.1, "direction_deg": 10.0}}
DELAY: Effects = {"camera_latency": {"time_ms": 50.0}}

FRAMES = 20  # of a push: neighbours say the same
SCALE = 1e-3  # m: residual of a frame over √frames from which it counts less than quadratically
FRICTION = 0.3
RATIO = 0.36  # ρ over the square of the characteristic length, where searches start


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rung:
    """One model, fitted.

    Attributes
    ----------
    name
        What was added.
    model, fit
        The model and its values for all pushes.
    spread
        (draws, n) values refitted to pushes drawn with replacement.
    own
        (R, 2) errors of each push, m and rad, of the fit to all.
    unseen
        (R, 2) errors of each push as predicted from other pushes.
    losses
        (R,) loss of each push in m², of the fit to all.
    """

    name: str
    model: Model
    fit: Fit
    spread: F
    own: F
    unseen: F
    losses: F


def problem_of(recordings: RecordingSet, effects: Effects) -> Problem:
    """A film with friction at the tips, and effects beside it."""
    base = viscous(recordings.part.outline)
    model = with_effects(base, effects) if effects else base
    prepared = prepare(recordings, step=base.step, most_frames=FRAMES)
    return Problem(prepared=prepared, model=model, scale=SCALE)


def start_of(problem: Problem, guess: Mapping[str, float]) -> F:
    """(n,) where a search starts: a usual film, effects off or as guessed, SI."""
    length = problem.prepared.length
    known = {"rho_um2": RATIO * length**2, "mu": FRICTION, **guess}
    return np.array([known.get(key, 0.0) for key in problem.model.keys])


def rung(
    name: str,
    problem: Problem,
    folds: Sequence[Rows],
    *,
    guess: Mapping[str, float],
    draws: int,
) -> Rung:
    """Fit a model, and predict each fold from the others."""
    start = start_of(problem, guess)
    fit = fitted(problem, start)
    return Rung(
        name=name,
        model=problem.model,
        fit=fit,
        spread=bootstrapped(problem, fit.values, draws, seed=1),
        own=errors(problem, fit.values),
        unseen=held_out(problem, start, folds),
        losses=losses(problem, fit.values[None])[0],
    )
