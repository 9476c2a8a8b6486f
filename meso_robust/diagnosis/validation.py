"""What a model is worth on recordings that its fit has not seen: only their starts are fitted."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meso_robust.diagnosis.baseline import Baseline, rows_of
from meso_robust.diagnosis.refit import Refit
from meso_robust.diagnosis.tangent import Tangent, tangent
from meso_robust.identification.forward import corrected
from meso_robust.identification.likelihood import fit
from meso_robust.identification.models import Model
from meso_robust.identification.prepared import Prepared, prepare
from meso_robust.identification.problem import Fits, Settings
from meso_robust.recordings import RecordingSet
from meso_robust.simulator import Outcome
from meso_robust.types import Floats

_HELD_OUT = 0.2  # of the recordings is held out
_FEWEST = 6  # recordings of which any can be spared
_FINER = 4.0  # by how much shorter steps tell the error of the steps
_MOST = 12  # iterations of a fit
_FLAT = 1.0  # fall of χ² at which a fit of starts ends
_APART = 0.05  # of the range of a quantity, that a kind of push must stand apart


@dataclass(frozen=True, slots=True, kw_only=True)
class Split:
    """Recordings by what they are for.

    Attributes
    ----------
    training
        All fits and all choices see these only.
    held_out
        No fit sees these, and no search; they may refute an answer that it gave, and of what is
        not explained they choose the part that carries over. None if there are too few recordings.
    """

    training: RecordingSet
    held_out: RecordingSet | None


def split(recordings: RecordingSet, seed: int, fitted: frozenset[str] = frozenset()) -> Split:
    """Hold out a fifth of the recordings, whole ones, at random; the order in which a set lists them is of no account.

    Parameters
    ----------
    recordings
        All.
    seed
        Of the choice.
    fitted
        Files of those that are not to be held out.
    """
    count = len(recordings.recordings)
    spared = max(2, round(_HELD_OUT * count)) if count >= _FEWEST else 0
    by_name = sorted(range(count), key=lambda k: recordings.recordings[k].file)
    order = [by_name[k] for k in np.random.default_rng([seed, count]).permutation(count)]
    able = [k for k in order if recordings.recordings[k].file not in fitted]
    chosen = set(able[:spared])
    return Split(
        training=_of(recordings, [k for k in range(count) if k not in chosen]),
        held_out=_of(recordings, sorted(chosen)) if spared else None,
    )


def without(recordings: RecordingSet, left_out: set[str]) -> RecordingSet:
    """The recordings but those of some files."""
    kept = [k for k, one in enumerate(recordings.recordings) if one.file not in left_out]
    return _of(recordings, kept)


def _of(recordings: RecordingSet, rows: list[int]) -> RecordingSet:
    return replace(recordings, recordings=tuple(recordings.recordings[k] for k in rows))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Errors:
    """Errors of a model on R recordings.

    Attributes
    ----------
    sigma
        (R,) root mean squares of the white residuals, per degree of freedom.
    metres
        (R,) root mean squares of the distance between the seen and the predicted place, m.
    rows, at
        (R, M) white residuals, and what the starts can take.
    poses
        (R, T, 3) predicted; NaN where nothing was seen.
    prepared
        The recordings.
    outcomes
        How each simulated push ended: completed, jam …
    """

    sigma: Floats
    metres: Floats
    rows: Floats
    at: Tangent
    poses: Floats
    prepared: Prepared
    outcomes: tuple[str, ...] = ()

    @property
    def whole(self) -> float:
        """Root mean square over all recordings, in σ."""
        freedom = self.freedom
        return float(np.sqrt(np.sum(self.sigma**2 * freedom) / freedom.sum()))

    @property
    def freedom(self) -> Floats:
        """(R,) numbers beyond those that the starts take."""
        return _freedom(self.at)

    @property
    def whole_metres(self) -> float:
        """Likewise of the place, m."""
        counts = self.prepared.counts[:, 0]
        return float(np.sqrt(np.sum(self.metres**2 * counts) / counts.sum()))


def errors(recordings: RecordingSet, model: Model, values: Floats, baseline: Baseline) -> Errors:
    """Errors on recordings of a model whose values (n,) are held.

    Parameters
    ----------
    recordings
        With the noise stated.
    model, values
        What is tried.
    baseline
        Tells step and noise.
    """
    prepared = prepare(recordings, step=baseline.prepared.step)
    finer = prepare(recordings, step=baseline.prepared.step / _FINER)
    settings = baseline.settings.by_chord(_MOST, _FLAT)
    held = np.ones(len(model.parameters), dtype=bool)
    found = fit(prepared, model, values[None], settings, held=held)
    prepared = corrected(
        prepared,
        finer,
        model,
        values[None],
        starts=found.fits.starts,
        offsets=found.fits.offsets,
    )
    found = fit(
        prepared,
        model,
        values[None],
        settings,
        starts=found.fits.starts[0],
        offsets=found.fits.offsets[0],
        held=held,
        jacobian=found.jacobian,
    )
    return _errors(prepared, model, settings, found.fits, found.jacobian[0], baseline)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Worth:
    """Errors of one model, the plain or an extended one.

    Attributes
    ----------
    training, held_out
        On the recordings of the fit, and on those that no fit has seen; None where none are.
    """

    training: Errors
    held_out: Errors | None

    @property
    def judged(self) -> Errors:
        """Those that count: on held-out recordings where there are any."""
        return self.held_out or self.training


def worth(baseline: Baseline, refit: Refit | None, held_out: RecordingSet | None) -> Worth:
    """Errors of the plain model (no refit) or of one with effects."""
    model, fits = (baseline.model, baseline.fits) if refit is None else (refit.model, refit.fits)
    return Worth(
        training=trained(baseline, refit),
        held_out=errors(held_out, model, fits.values[0], baseline) if held_out else None,
    )


def trained(baseline: Baseline, refit: Refit | None) -> Errors:
    """Errors on the recordings of the fit, of the plain model or of one with effects."""
    if refit is None:
        model, fits, jacobian = baseline.model, baseline.fits, baseline.jacobian
    else:
        model, fits, jacobian = refit.model, refit.fits, refit.fitted.jacobian[0]
    return _errors(baseline.prepared, model, baseline.settings, fits, jacobian, baseline)


def _errors(
    prepared: Prepared,
    model: Model,
    settings: Settings,
    fits: Fits,
    jacobian: Floats,
    baseline: Baseline,
) -> Errors:
    n = len(model.parameters)
    starts_only = jacobian.copy()
    starts_only[..., :n] = 0.0
    at = tangent(starts_only, n, np.isfinite(prepared.seen), baseline.noise.correlation)
    rows = rows_of(at, settings, fits)[0]
    left = at.cleaned(rows)
    poses = np.where(at.seen, prepared.seen - fits.residuals[0] * settings.sigma, np.nan)
    away = prepared.seen[..., :2] - poses[..., :2]
    return Errors(
        sigma=np.sqrt(np.sum(left**2, axis=1) / _freedom(at)),
        metres=np.sqrt(np.nanmean(np.sum(away**2, axis=2), axis=1)),
        rows=left,
        at=at,
        poses=poses,
        prepared=prepared,
        outcomes=tuple(Outcome(int(code)).word for code in fits.outcomes[0]),
    )


def _freedom(at: Tangent) -> Floats:
    """(R,) numbers beyond those that the starts take."""
    taken = np.sum(np.any(at.own != 0.0, axis=1), axis=1)
    return np.maximum(at.seen.sum(axis=(1, 2)) - np.minimum(taken, 3), 1).astype(float)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Extrapolation:
    """Errors on a kind of push that the fits have not seen.

    Attributes
    ----------
    what
        In words.
    files
        Recordings.
    before, after
        Of the plain and of the extended model, both fitted without them.
    """

    what: str
    files: tuple[str, ...]
    before: Errors
    after: Errors


def extrapolated(training: RecordingSet, baseline: Baseline, refit: Refit) -> Extrapolation | None:
    """Fit both models without the fastest, or else the farthest, pushes, and predict these.

    Parameters
    ----------
    training
        Recordings of the baseline.
    baseline
        The plain fit.
    refit
        The extended one.
    """
    what, files = _kind(baseline.prepared)
    if not files:
        return None
    rest = without(training, set(files))
    theirs = without(training, {one.file for one in rest.recordings})
    prepared = prepare(rest, step=baseline.prepared.step)
    settings = replace(baseline.settings, most=_MOST, chord=True, closing=False)
    plain = fit(prepared, baseline.model, baseline.fits.values, settings).fits.values[0]
    before = errors(theirs, baseline.model, plain, baseline)
    named = fit(prepared, refit.model, refit.fits.values, settings).fits.values[0]
    after = errors(theirs, refit.model, named, baseline)
    return Extrapolation(what=what, files=files, before=before, after=after)


def _kind(prepared: Prepared) -> tuple[str, tuple[str, ...]]:
    """Between a sixth and two fifths of the recordings that go farther than all others."""
    way = np.linalg.norm(np.diff(prepared.waypoints, axis=1), axis=-1).max(axis=-1)
    clock = np.diff(prepared.times, axis=1)
    speed = np.max(np.where(clock > 0.0, way / clock, 0.0), axis=1)
    place = np.hypot(*prepared.starts[:, :2].T)
    for values, what in ((speed, "the fastest pushes"), (place, "the pushes farthest out")):
        order = np.argsort(-values)
        gaps = -np.diff(values[order]) / max(float(np.ptp(values)), 1e-30)
        few, many = max(2, len(order) // 6), int(0.4 * len(order))
        if many >= few:
            cut = few + int(np.argmax(gaps[few - 1 : many]))
            if gaps[cut - 1] > _APART:
                return what, tuple(prepared.files[k] for k in sorted(order[:cut].tolist()))
    return "", ()
