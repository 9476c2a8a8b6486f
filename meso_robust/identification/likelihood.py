"""Maximum likelihood: parameters and the start of every recording, fitted together.

The noise of the sensor is white and Gaussian, so that −2 log L is a sum of squares. The first frame
is as noisy as any other, hence each recording's start is unknown, too (a nuisance), and so may be a
offset of its tips. Every start bears on its own recording only: the normal matrix is an
arrow, and its Schur complement is the information about the parameters with the starts unknown.

Levenberg and Marquardt's method (doi:10.1137/0111030) runs for any number of fits side by side, with
differences over steps that change what is seen by a part of the noise: they look across the kinks
where a contact begins to slip.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared
from meso_robust.identification.problem import (
    Arrow,
    Fits as Fits,
    Fitted as Fitted,
    Problem,
    Settings as Settings,
)
from meso_robust.types import Flags, Floats, Ints

_GOOD = 0.3  # share of the expected fall of χ² that shows that derivatives still do
_LADDER = (0.1, 1.0, 10.0)  # dampings that are tried, over the present one
# the least of them with a chord, whose derivatives do for many steps: weaker ones make the same step as none
_LEAST = (0.0, 1e-2, 0.3)
# of the expected fall, with which a step of a chord is taken and no harder damping tried
_ENOUGH = 0.8
_HARDEST = 1e7  # damping at which a fit is given up as converged


def fit(
    prepared: Prepared,
    model: Model,
    values: Floats,
    settings: Settings,
    *,
    starts: Floats | None = None,
    offsets: Floats | None = None,
    held: Flags | None = None,
    jacobian: Floats | None = None,
) -> Fitted:
    """Fit B times, from B vectors of parameters, all in common batches.

    Parameters
    ----------
    prepared, model
        R recordings and a model of n parameters.
    values
        (B, n) valid vectors to start from, SI.
    settings
        Noise and method.
    starts, offsets
        (R, 3) or (B, R, 3), and (R, 2) or (B, R, 2), to start from; by default as seen, and zero.
    held
        (n,) or (B, n) parameters to hold at their first values, besides those no motion can show.
    jacobian
        (1|B, R, 3 T, n + d) derivatives to begin with, of a fit near by; computed by default.

    Returns
    -------
    Fitted
        B fits, each with its derivatives and the information about its parameters.

    Raises
    ------
    ValueError
        If a shape is wrong or a first vector is not valid.
    """
    values = np.atleast_2d(np.asarray(values, dtype=np.float64))
    problem = Problem(prepared, model, settings)
    size = (len(values), len(prepared.files))
    present = problem.at(
        values.copy(),
        np.broadcast_to(prepared.starts if starts is None else starts, (*size, 3)),
        np.broadcast_to(np.zeros(4) if offsets is None else offsets, (*size, 4)).copy(),
    )
    return _Descent(problem, present, _free(model, values, held), jacobian).run()


def fit_part(
    prepared: Prepared,
    model: Model,
    whole: Fitted,
    rows: Ints,
    settings: Settings,
    *,
    held: Flags | None = None,
) -> Fitted:
    """Fit some of the recordings, from fits to all of them and with their derivatives.

    Parameters
    ----------
    prepared, model
        r recordings, and the model of the fits.
    whole
        B fits to R recordings, with the same weights.
    rows
        (r,) which of them these are.
    settings
        Noise and method.
    held
        As in `fit`.

    Returns
    -------
    Fitted
        B fits, as of `fit`.
    """
    problem = Problem(prepared, model, settings)
    present = problem.part(whole.fits, rows)
    free = _free(model, present.values, held)
    return _Descent(problem, present, free, whole.jacobian[:, rows]).run()


def _free(model: Model, values: Floats, held: Flags | None) -> Flags:
    """(B, n) what is fitted."""
    free = model.fitted & ~(np.zeros(values.shape, dtype=bool) if held is None else held)
    return np.broadcast_to(free, values.shape)


class _Descent:
    """B fits on their way down."""

    def __init__(
        self, problem: Problem, present: Fits, free: Flags, jacobian: Floats | None
    ) -> None:
        self.problem, self.present, self.free = problem, present, free
        count = len(present)
        self.spans = np.full(free.shape, 1e-3)
        self.damping = np.full(count, 1e-3)
        self.active = np.ones(count, dtype=bool)
        self.fresh = np.zeros(count, dtype=bool)
        self.stale = np.full(count, jacobian is None)
        self.wary = np.zeros(count, dtype=bool)
        columns = free.shape[1] + len(problem.settings.units)
        shape = (*present.residuals.shape[:2], 3 * present.residuals.shape[2], columns)
        self.jacobian = np.zeros(shape) if jacobian is None else np.broadcast_to(jacobian, shape)

    @np.errstate(over="ignore", invalid="ignore")  # a step far out may overflow; it is not taken
    def run(self) -> Fitted:
        """Go down until χ² stops falling."""
        settings, rounds = self.problem.settings, 0
        while rounds < settings.most and np.any(self.active):
            self._differentiate(np.flatnonzero(self.active & self.stale))
            self._step(np.flatnonzero(self.active))
            rounds += 1
        if settings.closing:
            self._differentiate(np.flatnonzero(~self.fresh))
        arrow = self.problem.arrow(self.present, self.jacobian * self._kept(slice(None)))
        return Fitted(
            fits=self.present,
            information=arrow.information(),
            gradients=arrow.gradients(),
            jacobian=self.jacobian,
            converged=~self.active,
            iterations=rounds,
        )

    def _kept(self, which: Ints | slice) -> Floats:
        """(b, 1, 1, n + d) ones, zero for parameters that are held."""
        free = self.free[which].astype(float)
        wide = np.ones((len(free), self.jacobian.shape[-1]))
        wide[:, : free.shape[1]] = free
        return wide[:, None, None]

    def _differentiate(self, which: Ints) -> None:
        """New derivatives of some fits."""
        if not which.size:
            return
        if not self.jacobian.flags.writeable:
            self.jacobian = self.jacobian.copy()
        own = self.present.of(which)
        found = self.problem.jacobian(own, self.spans[which], self.free[which])
        self.jacobian[which] = found
        self.spans[which] = self.problem.spans(self.problem.arrow(own, found))
        self.fresh[which], self.stale[which] = True, False
        self.wary[which] = False

    def _step(self, which: Ints) -> None:
        """One iteration of some fits."""
        problem, settings = self.problem, self.problem.settings
        own = self.present.of(which)
        arrow = problem.arrow(own, self.jacobian[which] * self._kept(which))
        found, used, hoped, failed = _best_step(
            problem, own, arrow, self.damping[which], self.free[which], self.wary[which]
        )
        # where the boldest step leads too far, so does the one after it
        self.wary[which] = settings.chord & failed
        better = found.chi2 < own.chi2
        gain = np.where(better, own.chi2 - found.chi2, 0.0)
        fresh = self.fresh[which]
        damping = self.damping[which]
        harder = 30.0 * np.maximum(damping, settings.chord * _LEAST[1])
        damping = np.where(better, 0.3 * used, np.where(fresh, harder, damping))
        self.damping[which] = np.clip(damping, 1e-9, 2.0 * _HARDEST)
        _put(self.present, which[better], found.of(better))
        poor = gain < _GOOD * hoped
        still = hoped < settings.flat
        flat = (gain < settings.flat) & (better | still)
        known = fresh | (still & (not settings.closing))
        ended = (flat & known) | (self.damping[which] > _HARDEST)
        self.active[which] = ~ended
        self.stale[which] = (poor | flat | (not settings.chord)) & ~ended & (better | ~fresh)
        self.fresh[which[better]] = False


def _best_step(
    problem: Problem, fits: Fits, arrow: Arrow, damping: Floats, free: Flags, wary: Flags
) -> tuple[Fits, Floats, Floats, Flags]:
    """The best of the steps on the ladder of dampings, its damping, and the fall of χ² hoped for.

    With a chord the first step that does as is hoped for is taken, beginning with the boldest, or of ``wary``
    fits with the next; and whether that first one did not.
    """
    settings = problem.settings
    moving = problem.moving(fits, arrow.pull(), free)
    least = settings.chord * np.array(_LEAST)
    rungs = [np.maximum(damping * rung, end) for rung, end in zip(_LADDER, least, strict=True)]
    steps = [arrow.step(rung, moving) for rung in rungs]
    hopes = np.stack([arrow.fall(*step) for step in steps])
    farthest = np.array([parameter.farthest for parameter in problem.model.parameters])

    def tried(rungs: Ints, rows: Ints) -> Fits:
        shared, own = (np.stack(part)[rungs, rows] for part in zip(*steps, strict=True))
        return problem.tried(fits.of(rows), np.clip(shared, -farthest, farthest), own, free[rows])

    every = np.arange(len(fits))
    rung, best = wary.astype(np.int64), wary.astype(np.int64)
    asked = every
    found = last = tried(rung, every)
    while True:
        hope = hopes[rung[asked], asked]
        told = fits.chi2[asked] - last.chi2 >= _ENOUGH * hope
        enough = settings.chord & (told | (hope < settings.flat))
        asked = asked[~enough & (rung[asked] < len(_LADDER) - 1)]
        if not asked.size:
            return found, np.stack(rungs)[best, every], hopes[best, every], rung > wary
        rung[asked] += 1
        last = tried(rung[asked], asked)
        better = last.chi2 < found.chi2[asked]
        best[asked[better]] = rung[asked[better]]
        _put(found, asked[better], last.of(better))


def _put(present: Fits, rows: Ints, found: Fits) -> None:
    for item in fields(present):
        getattr(present, item.name)[rows] = getattr(found, item.name)
