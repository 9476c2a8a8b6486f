"""From a recording set to a fitted model: search, refine, rank, say how well each parameter is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.stats import chi2 as chi2_law

from meso_robust.errors import InputError
from meso_robust.identification.forward import Prediction, corrected, predicted
from meso_robust.identification.identifiability import (
    NotIdentifiable,
    check_enough,
    found_combined,
    found_open,
    found_scale,
    found_unseen,
)
from meso_robust.identification.likelihood import Fitted, Settings, fit
from meso_robust.identification.models import MODELS
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared, prepare
from meso_robust.identification.profiles import CONFIDENCE, Profile, profiled
from meso_robust.identification.quality import Quality, quality
from meso_robust.identification.search import Ends, Minimum, minima, score, searched
from meso_robust.recordings import RecordingSet
from meso_robust.types import Floats

Objective = Literal["printed", "likelihood"]
Told = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and of how much."""

COARSE = 1.0 / 45.0
"""Step of the first search over the characteristic length: 20 µm for the part of the paper."""
_FRAMES = 30  # of a recording that the first search compares
_ROUNDS = 3  # most rounds of starts
_SEEDS = 1_000_003  # between the seeds of two rounds
_DOUBTFUL = 0.05  # probability of χ² below which a further round is made
_FAR = 4.0  # mean square over that of noise, beyond which all frames need not be asked as well
_REFINED = 4  # minima that are refined with all frames and short steps
_ROUGH = (6, 20)  # most iterations of rough fits, of all ends and then of each minimum
_NEAR = 2.0  # times the least χ² of a rough fit, up to which a minimum is refined
_LISTED = 8  # most minima that are listed
_DRAWS = 20  # rounds of drawing until enough starts complete
_NOISE = 3  # rounds in which an unknown noise is estimated
_FINER = 4.0  # by how much shorter steps tell the error of the steps
_SHARPER = 2  # times that predictions are corrected
_CHORDS = 8  # most iterations after a correction
_FINEST = 100.0  # misfit of the first search over the noise that it is weighed by, at most
_AGAIN = 3  # times that a profile may find a better fit


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Identification:
    """What was found.

    Attributes
    ----------
    model, prepared, objective, confidence, seed, starts
        What was fitted to what, how, and from how many random starts.
    minima
        Distinct local minima, the best first; of "likelihood" by χ², of "printed" by F.
    profiles
        Value and interval of each fitted parameter. Of "printed" the interval is the last simplex, as
        in the paper: the width of a search, without a probability.
    fitted
        The best fit of the likelihood; None of "printed".
    settings
        Noise that was assumed, None of "printed".
    prediction
        What the best vector predicts.
    quality
        Of the best fit of the likelihood, else None.
    not_identifiable
        What the recordings do not determine, and why.
    """

    model: Model
    prepared: Prepared
    objective: Objective
    confidence: float
    seed: int
    starts: int
    minima: tuple[Minimum, ...]
    profiles: tuple[Profile, ...]
    fitted: Fitted | None
    settings: Settings | None
    prediction: Prediction
    quality: Quality | None
    not_identifiable: tuple[NotIdentifiable, ...]

    @property
    def best(self) -> Floats:
        """(n,) best vector, SI."""
        return self.minima[0].values if self.fitted is None else self.fitted.fits.values[0]

    @property
    def determined(self) -> tuple[str, ...]:
        """Names of the parameters with a bound on both sides."""
        return tuple(p.key for p in self.profiles if not (p.open_low or p.open_high))


def identify(
    recordings: RecordingSet,
    *,
    model: str = "viscous",
    starts: int = 20,
    objective: Objective = "likelihood",
    seed: int = 0,
    confidence: float = CONFIDENCE,
    told: Told = lambda *_: None,
) -> Identification:
    """Fit a model to a recording set.

    Parameters
    ----------
    recordings
        As read.
    model
        Name in `MODELS`.
    starts
        Number of random starts.
    objective
        "printed": eqs. (3) and (4) by Nelder and Mead's method alone; "likelihood": refined by maximum
        likelihood with unknown starts, which also gives intervals.
    seed
        Of the random starts.
    confidence
        Probability with which each interval shall cover.
    told
        Told of progress.

    Returns
    -------
    Identification
        The minima with the best first, intervals, and what the recordings do not determine.

    Raises
    ------
    InputError
        If the model is unknown, a recording cannot be used, there are too few, or every start fails
        in the simulator.
    """
    chosen = _model(model, recordings)
    fine = prepare(recordings, step=chosen.step)
    check_enough(fine, chosen)
    rough = prepare(recordings, step=COARSE * fine.length, most_frames=_FRAMES)
    finer = prepare(recordings, step=fine.step / _FINER)
    job = _Job(chosen, rough, fine, finer, seed, starts, confidence, told)
    return (_printed if objective == "printed" else _likelihood)(job, _ends(job, seed))


@dataclass(frozen=True, slots=True, eq=False)
class _Job:
    """What the two objectives go on from."""

    model: Model
    rough: Prepared
    fine: Prepared
    finer: Prepared
    seed: int
    starts: int
    confidence: float
    told: Told


def check_model(name: str) -> None:
    """Refuse a name that no plain model has.

    Parameters
    ----------
    name
        As a user gives it.

    Raises
    ------
    InputError
        Naming those that there are.
    """
    if name not in MODELS:
        raise InputError(f"--model {name}: must be one of {', '.join(MODELS)}; choose one")


def _model(name: str, recordings: RecordingSet) -> Model:
    check_model(name)
    return MODELS[name](np.array(recordings.part.outline))


def _ends(job: _Job, seed: int) -> Ends:
    """Ends of the searches from random starts."""
    first = _drawn(job.rough, job.model, job.starts, seed)
    return searched(
        job.rough,
        job.model,
        first,
        told=lambda done: job.told("searching", done, job.starts),
    )


def _drawn(prepared: Prepared, model: Model, count: int, seed: int) -> Floats:
    """(count, n) random valid vectors with which every recording runs to its end."""
    rng = np.random.default_rng(seed)
    kept = np.zeros((0, len(model.parameters)))
    for _ in range(_DRAWS):
        some = model.draw(rng, count)
        kept = np.concatenate([kept, some[np.isfinite(score(prepared, model, some).values)]])
        if len(kept) >= count:
            return kept[:count]
    if not len(kept):
        raise InputError(
            f"no valid start among {_DRAWS * count} random ones: with each, a push jams or fails in "
            "the simulator; check part, tip radius and units with `meso-robust recordings`"
        )
    return kept


def _printed(job: _Job, ends: Ends) -> Identification:
    """Nelder and Mead's method only, the best minima searched again with short steps."""
    model, fine = job.model, job.fine
    groups = minima(job.rough, model, ends.values, ends.objective)[:_REFINED]
    job.told("refining", 0, 1)
    again = searched(fine, model, np.stack([one.values for one in groups]))
    counts = [one.found for one in groups]
    ranked = minima(fine, model, again.values, again.objective, counts)
    row = ranked[0].members[0]
    values = again.values[row]
    return Identification(
        model=model,
        prepared=fine,
        objective="printed",
        confidence=job.confidence,
        seed=job.seed,
        starts=job.starts,
        minima=ranked,
        profiles=_simplex_profiles(model, values, again.spreads[row]),
        fitted=None,
        settings=None,
        prediction=predicted(fine, model, values),
        quality=None,
        not_identifiable=(*found_unseen(fine, model, values), found_scale()),
    )


def _simplex_profiles(model: Model, values: Floats, spread: Floats) -> tuple[Profile, ...]:
    """Intervals as wide as the last simplex."""
    return tuple(
        Profile(
            key=parameter.key,
            value=float(values[k]),
            low=float(max(values[k] - spread[k], parameter.low)),
            high=float(min(values[k] + spread[k], parameter.high)),
            open_low=False,
            open_high=False,
            curve=np.zeros((0, 2)),
        )
        for k, parameter in enumerate(model.parameters)
        if not parameter.unseen
    )


def _likelihood(job: _Job, ends: Ends) -> Identification:
    """All ends refined, roughly first, the best ones then with all frames and short steps."""
    model, fine = job.model, job.fine
    settings = settings_of(fine, float(ends.objective.min()))
    job.told("refining", 0, 2)
    groups = _searched_again(job, settings, _rough_minima(job, settings, ends.values))
    job.told("refining", 1, 2)
    close = [one for one in groups[:_REFINED] if one.cost <= _NEAR * groups[0].cost]
    settings, fitted = maximised(fine, model, np.stack([one.values for one in close]), settings)
    ranked = _ranked(fine, model, settings, fitted, groups)
    best = fitted.of(ranked[0].members[0])
    for _ in range(_AGAIN):
        plain = best
        fine, best = sharpened(fine, job.finer, model, settings, best)
        shift = _shift(model, plain, best)
        found = quality(fine, model, best.fits, settings.sigma, shift)
        job.told("profiling", 0, 1)
        profiles = profiled(
            fine,
            model,
            settings,
            best,
            confidence=job.confidence,
            inflation=found.widening,
        )
        if profiles.better is None:
            break
        settings, best = maximised(fine, model, profiles.better[None], settings)
    fits = best.fits
    first = minima(fine, model, fits.values, fits.chi2, [ranked[0].found])
    prediction = predicted(fine, model, fits.values, starts=fits.starts, offsets=fits.offsets)
    return Identification(
        model=model,
        prepared=fine,
        objective="likelihood",
        confidence=job.confidence,
        seed=job.seed,
        starts=job.starts,
        minima=(*first, *ranked[1:]),
        profiles=profiles.profiles,
        fitted=best,
        settings=settings,
        prediction=prediction,
        quality=found,
        not_identifiable=(
            *found_unseen(fine, model, fits.values[0]),
            *found_open(fine, model, fits, profiles.profiles),
            *found_combined(model, best.information[0] / found.widening),
            found_scale(),
        ),
    )


def _searched_again(
    job: _Job, settings: Settings, groups: tuple[Minimum, ...]
) -> tuple[Minimum, ...]:
    """The minima, and those of further starts while noise alone hardly explains what the best leaves.

    A search may end in poor minima only; a misfit that remains after all rounds is the model's.
    """
    model = job.model
    known = job.rough.sigmas.position is not None and job.rough.sigmas.orientation is not None
    for again in range(1, _ROUNDS):
        if not known or _explained(job, settings, groups[0]):
            break
        more = _rough_minima(job, settings, _ends(job, job.seed + _SEEDS * again).values)
        both = [*groups, *more]
        groups = minima(
            job.rough,
            model,
            np.stack([one.values for one in both]),
            np.array([one.cost for one in both]),
            [one.found for one in both],
        )
    return groups


def _explained(job: _Job, settings: Settings, best: Minimum) -> bool:
    """Whether noise explains what a minimum leaves of all frames: few of them may hide a wrong one."""
    few, freedom = (
        max(int(counts.sum() - 3 * len(counts) - job.model.fitted.sum()), 1)
        for counts in (job.rough.counts, job.fine.counts)
    )
    if best.cost > _FAR * few:
        return False
    found = fit(job.fine, job.model, best.values[None], settings).fits
    return bool(chi2_law.sf(found.chi2[0], freedom) > _DOUBTFUL)


def _rough_minima(job: _Job, settings: Settings, values: Floats) -> tuple[Minimum, ...]:
    """Minima with few frames and long steps: all ends a few iterations, then one of each group."""
    model, counts = job.model, None
    for most in _ROUGH:
        quick = replace(settings, most=most, central=False, flat=1.0)
        rough = fit(job.rough, model, values, quick).fits
        groups = minima(job.rough, model, rough.values, rough.chi2, counts)
        values, counts = np.stack([one.values for one in groups]), [one.found for one in groups]
    return groups


def _ranked(
    fine: Prepared, model: Model, settings: Settings, fitted: Fitted, groups: tuple[Minimum, ...]
) -> tuple[Minimum, ...]:
    """The refined minima, and after them those too bad to be refined, all with all frames."""
    rest = [one.values for one in groups[len(fitted.fits) : _LISTED]]
    counts = [one.found for one in groups[:_LISTED]]
    values, costs = fitted.fits.values, fitted.fits.chi2
    if rest:
        values = np.concatenate([values, rest])
        bad = fit(fine, model, np.stack(rest), replace(settings, most=1, central=False))
        costs = np.concatenate([costs, bad.fits.chi2])
    return minima(fine, model, values, costs, counts)


def sharpened(
    prepared: Prepared, finer: Prepared, model: Model, settings: Settings, best: Fitted
) -> tuple[Prepared, Fitted]:
    """A fit freed of the error of the steps: predictions are corrected about it, and it moves on.

    Parameters
    ----------
    prepared, finer
        The same recordings with steps as fitted, and with shorter ones.
    model, settings, best
        The fit, one only.
    """
    quick = replace(settings, chord=True, closing=False, most=_CHORDS)
    for _ in range(_SHARPER):
        fits = best.fits
        starts, offsets = fits.starts, fits.offsets
        prepared = corrected(prepared, finer, model, fits.values, starts=starts, offsets=offsets)
        best = fit(
            prepared,
            model,
            fits.values,
            quick,
            starts=starts,
            offsets=offsets,
            jacobian=best.jacobian,
        )
    return prepared, best


def _shift(model: Model, before: Fitted, after: Fitted) -> float:
    """Largest change of a parameter between two fits, in standard deviations."""
    columns = np.flatnonzero(model.fitted)
    inverse = np.linalg.pinv(after.information[0][np.ix_(columns, columns)], hermitian=True)
    away = model.coordinates(after.fits.values) - model.coordinates(before.fits.values)
    widths = np.sqrt(np.maximum(np.diag(inverse), 1e-30))
    return float(np.max(np.abs(away[0, columns]) / widths))


def settings_of(prepared: Prepared, guess: float) -> Settings:
    """Noise as known, or else as large as the misfit of the first search (m), to be estimated.

    Known or not, it counts as no finer than a share of that misfit: differences over steps that change
    what is seen by less would end within the kinks of a contact.
    """
    sigmas, least = prepared.sigmas, guess / _FINEST
    return Settings(
        position=max(sigmas.position or guess, least),
        orientation=max(sigmas.orientation or guess / prepared.length, least / prepared.length),
        offset=prepared.tip_offset,
    )


def maximised(
    prepared: Prepared, model: Model, values: Floats, settings: Settings
) -> tuple[Settings, Fitted]:
    """Fits from vectors (B, n), and the settings with the noise that was estimated along.

    A σ that is not known is taken from the residuals of the best fit, and all is fitted again,
    until it stays.
    """
    fitted = fit(prepared, model, values, settings)
    known = prepared.sigmas
    for _ in range(_NOISE if known.position is None or known.orientation is None else 0):
        best = fitted.fits.of([int(np.argmin(fitted.fits.chi2))])
        position, orientation = _estimated(prepared, model, best.residuals[0], settings)
        settings = replace(
            settings,
            position=known.position or position,
            orientation=known.orientation or orientation,
        )
        fits = fitted.fits
        fitted = fit(
            prepared, model, fits.values, settings, starts=fits.starts, offsets=fits.offsets
        )
    return settings, fitted


def _estimated(
    prepared: Prepared, model: Model, residuals: Floats, settings: Settings
) -> tuple[float, float]:
    """σ of positions (m) and θ (rad) from residuals (R, T, 3), with what the fit took of them."""
    counts = prepared.counts.sum(axis=0).astype(float)
    taken = 3.0 * len(prepared.files) + float(model.fitted.sum())
    share = max(1.0 - taken / counts.sum(), 0.1)
    squares = np.sum(residuals**2, axis=(0, 1))
    position = np.sqrt(squares[:2].sum() / max(share * counts[:2].sum(), 1.0))
    orientation = np.sqrt(squares[2] / max(share * counts[2], 1.0))
    return float(settings.position * position), float(settings.orientation * orientation)
