"""What a model is worth where it was not fitted: roll-outs from the pose at rest, fold by fold.

Each recording is predicted by a fit of the others. A prediction starts from the pose that was seen
while the part rested, as well as the camera's noise allows, and runs to the end without looking at
the recording again: a start that is free to take up misfit is no prediction. Where a tip is known within a
stated error only, it is taken to be where the recording itself says, for no other recording tells it; but not
beyond what the error makes likely, and the prediction pays for it.

A number of the plain model that the other recordings tell next to nothing of, as friction where only
the one left out slips, is taken from the fit to all: what nobody measured is no missing physics. Numbers of
effects are not lent in this way, but a fit to recordings that do not tell one leaves it where it began, at the fit to all. So
effects that one fold alone tells of are listed: that fold is not truly predicted.

In the fits a misfit is not noise. Frames at rest count by the noise of the camera, all others by what
the model leaves of them, so that the many pushed frames of a model that is a little wrong do not drag
the starts away from where they were seen.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import t as student

from meso_robust.copies import shared
from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.runs import longer
from meso_robust.diagnosis.tangent import CONFIDENCE, Interval
from meso_robust.diagnosis.windows import tips_of
from meso_robust.identification.forward import corrected, predicted
from meso_robust.identification.likelihood import fit, fit_part
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared, prepare, some_of
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.still import still
from meso_robust.simulator import Outcome
from meso_robust.types import Flags, Floats, Ints

FOLDS = 6
"""Parts that the recordings are cut into; fewer recordings are left out one by one."""
_SEARCH = 8  # most iterations of a search from anywhere
# of a fit to all recordings, which begins at one to most of them, and without a fold, which begins at that
_MOST = 8
_FLAT = 1.0  # fall of χ² at which they end: all numbers are then within a standard deviation of their best
# of the frames before the part moves: a model that is late or early moves it in the last of them
_RESTING = 2.0 / 3.0
# of all that recordings tell of a number: others that tell less do not tell it. Its own error then adds
# fifty times the square of the noise to a recording's sum, a tenth of what a few hundred frames have
_UNTOLD = 0.02
# places that a search begins at again from where it has come to the end of a range: friction without a
# tip that slips has no way back
_AGAIN = 12
_FINER = 4.0  # by how much shorter steps tell the error of the steps
_ROUNDS = 2  # corrections of a start by what still frames leave
# of a start that still frames hardly tell, as where a tip seems to be inside the part and moves it out
# before the first of them: without it a start was moved by metres; it holds back others by a hundredth
_DAMPED = 1e-2
_FARTHEST = 2.0  # deviations that a tip is off by at most; of largest errors, evenly spread, all are within 1.74


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bench:
    """All recordings of a set, ready to be predicted fold by fold.

    Attributes
    ----------
    prepared
        R recordings, with the correction for the length of the steps.
    baseline
        The plain model, and the noise.
    still
        (R, T) frames that tell where the part rests; at least the first whole one of each.
    fold
        (R,) which fold predicts a recording.
    plain
        (n,) numbers of the plain model at which fits to all recordings begin as well; None where those of
        the baseline are within their ranges.
    """

    prepared: Prepared
    baseline: Baseline
    still: Flags
    fold: Ints
    plain: Floats | None = None

    @property
    def seen(self) -> Flags:
        """(R, T, 3) whether there is a datum."""
        return np.isfinite(self.prepared.seen)

    @property
    def held_out(self) -> Flags:
        """(R,) recordings that no set of effects was chosen by."""
        fitted = set(self.baseline.prepared.files)
        return np.array([file not in fitted for file in self.prepared.files])

    @property
    def count(self) -> int:
        """Number of folds."""
        return int(self.fold.max()) + 1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RollOut:
    """Predictions of a model, each by a fit that has not seen the recording.

    Attributes
    ----------
    model
        With n parameters.
    values
        (n,) of the fit to all recordings.
    by_fold
        (K, n) of the fits without a fold.
    poses
        (R, T, 3) predicted; NaN where nothing was seen.
    squares
        (R, T, 3) squared errors over the variance of the camera's noise; zero where not seen.
    start_squares
        (R,) mean of what the uncertain start alone adds to them.
    outcomes
        (R,) values of `Outcome`, of the predicted runs.
    weighed
        Whether the model leaves more than noise, so that its fits held starts where they were seen.
    alone
        Effects that one fold alone tells of, and the file of it that tells most.
    """

    model: Model
    values: Floats
    by_fold: Floats
    poses: Floats
    squares: Floats
    start_squares: Floats
    outcomes: Ints
    weighed: bool
    alone: tuple[tuple[str, str], ...] = ()


def bench_of(recordings: RecordingSet, baseline: Baseline, seed: int) -> Bench:
    """Arrange all recordings of a set for roll-outs.

    Parameters
    ----------
    recordings
        All of them, those of the baseline's fit and others.
    baseline
        The plain model, fitted to some of them.
    seed
        Of the folds.
    """
    prepared = prepare(recordings, step=baseline.prepared.step)
    finer = prepare(recordings, step=baseline.prepared.step / _FINER)
    prepared = replace(prepared, time_step=baseline.prepared.time_step)
    finer = replace(finer, time_step=baseline.prepared.time_step / _FINER)
    none = np.zeros((len(prepared.files), 4))
    prepared = corrected(
        prepared,
        finer,
        baseline.model,
        baseline.fits.values,
        starts=prepared.starts,
        offsets=none,
    )
    return Bench(
        prepared=prepared,
        baseline=baseline,
        still=_still(recordings, prepared),
        fold=_folds(prepared, seed),
        plain=_again(prepared, baseline, seed),
    )


def _again(prepared: Prepared, baseline: Baseline, seed: int) -> Floats | None:
    """(n,) fitted to all recordings by more searches, where a number is at an end of its range.

    Some of the recordings are held out of the baseline, perhaps the only one in which a tip slips.
    """
    values = baseline.fits.values[0]
    if not _at_end(baseline.model, values, len(values)):
        return None
    drawn = baseline.model.draw(np.random.default_rng([seed, 6]), _AGAIN)
    settings = replace(baseline.settings, central=False, most=_SEARCH, flat=0.05)
    found = fit(prepared, baseline.model, np.vstack([values, drawn]), settings).fits
    return np.asarray(found.values[np.nanargmin(found.chi2)])


def _at_end(model: Model, values: Floats, count: int) -> bool:
    """Whether one of the first numbers is at an end of its range."""
    pairs = zip(model.parameters[:count], values[:count], strict=True)
    return any(value <= one.low or value >= one.high for one, value in pairs)


def _still(recordings: RecordingSet, prepared: Prepared) -> Flags:
    whole = np.all(np.isfinite(prepared.seen), axis=2)
    found = np.zeros(whole.shape, dtype=bool)
    for row, recording in enumerate(recordings.recordings):
        quiet = recording.times[still(recordings, recording)]
        last = quiet[int(_RESTING * (len(quiet) - 1))] if len(quiet) else -np.inf
        found[row] = whole[row] & (prepared.instants[row] <= last)
        if not np.any(found[row]):
            found[row, int(np.argmax(whole[row]))] = True
    return found


def _folds(prepared: Prepared, seed: int) -> Ints:
    """(R,) folds that have pushes of every kind: of each side of the part, slow and fast."""
    tips = tips_of(prepared)
    away = tips[:, -1, 0] - tips[:, 0, 0]
    heading = np.arctan2(away[:, 1], away[:, 0]) - prepared.starts[:, 2]
    side = np.round(heading / (0.5 * np.pi)).astype(int) % 4
    speed = np.hypot(*away.T) / (prepared.instants[:, -1] - prepared.instants[:, 0])
    order = np.lexsort((speed, side))
    count = min(FOLDS, len(order))
    fold = np.empty(len(order), dtype=np.int64)
    rng = np.random.default_rng([seed, 4])
    for first in range(0, len(order), count):
        block = order[first : first + count]
        fold[block] = rng.permutation(count)[: len(block)]
    return fold


@np.errstate(over="ignore", invalid="ignore")  # as for a fit
def rolled_out(bench: Bench, model: Model, values: Floats, plain: Floats | None = None) -> RollOut:
    """Predict every recording by a fit of the model to the other folds.

    Parameters
    ----------
    bench
        The recordings.
    model, values
        The model, and values (n,) from which fits begin.
    plain
        (m,) of the plain model as fitted to all recordings, if known. Fits begin there as well where a
        number of it is at an end of its range in ``values``, which are of some of the recordings only.
    """
    settings = bench.baseline.settings.by_chord(_MOST, _FLAT)
    whole = replace(bench.prepared, weights=weights_of(bench, model, values))
    # its own derivatives: a fit without the recordings held out may start where no tip slips
    begun = values[None]
    also = bench.plain if plain is None else plain
    if also is not None and (bench.plain is not None or _at_end(model, values, len(also))):
        begun = np.vstack([values, [*also, *values[len(also) :]]])
    found = fit(whole, model, begun, replace(settings, closing=True))
    every = found.of(int(np.nanargmin(found.fits.chi2)))
    values, starts = every.fits.values[0], every.fits.starts[0]
    offsets = _likely(bench, every.fits.offsets[0])
    jacobian = every.jacobian[0]
    slopes = jacobian[..., len(values) : len(values) + 3] / _or_one(whole.weights)
    told = _told(jacobian, len(values))
    own = np.arange(len(values)) < len(bench.baseline.model.parameters)
    left = [np.flatnonzero(bench.fold == k) for k in range(bench.count)]

    def of_fold(k: int) -> tuple[Floats, Floats, Ints]:
        rows, out, by = np.flatnonzero(bench.fold != k), left[k], values
        if len(rows):
            by = fit_part(
                some_of(whole, rows),
                model,
                every,
                rows,
                settings,
                held=own & (told[rows].sum(axis=0) < _UNTOLD * told.sum(axis=0)),
            ).fits.values[0]
        return by, *_from_rest(bench, model, by, out, starts[out], slopes[out], offsets[out])

    poses = np.full(whole.seen.shape, np.nan)
    outcomes = np.zeros(len(whole.files), dtype=np.int64)
    found_by = shared(of_fold, range(bench.count))
    for out, (_, ways, ends) in zip(left, found_by, strict=True):
        poses[out], outcomes[out] = ways, ends
    away = (bench.prepared.seen - poses) / _sigma(bench)
    squares = np.nan_to_num(away) ** 2 + _paid(bench, offsets)[:, None, None]
    return RollOut(
        model=model,
        values=values,
        by_fold=np.stack([by for by, _, _ in found_by]),
        poses=poses,
        squares=np.where(bench.seen, squares, 0.0),
        start_squares=_start_squares(bench, slopes),
        outcomes=outcomes,
        weighed=whole.weights is not None,
        alone=_alone(bench, model, told),
    )


def intervals_by_fold(found: RollOut) -> tuple[Interval, ...]:
    """Intervals of all fitted numbers, by leaving out a fold at a time.

    Parameters
    ----------
    found
        Roll-outs of at least two folds.
    """
    model, count = found.model, len(found.by_fold)
    middle = model.coordinates(found.values[None])[0]
    by_fold = model.coordinates(found.by_fold)
    spread = by_fold - by_fold.mean(axis=0)
    error = np.sqrt((count - 1) / count * np.sum(spread**2, axis=0))
    reach = student.isf(0.5 * (1.0 - CONFIDENCE), count - 1) * error
    low, high = (model.values((middle + sign * reach)[None])[0] for sign in (-1.0, 1.0))
    return tuple(
        Interval(
            parameter=one,
            value=float(found.values[k]),
            low=float(max(min(low[k], found.values[k]), one.low)),
            high=float(min(max(high[k], found.values[k]), one.high)),
            open_low=bool(low[k] <= one.low),
            open_high=bool(high[k] >= one.high),
        )
        for k, one in enumerate(model.parameters)
        if model.fitted[k]
    )


def _likely(bench: Bench, offsets: Floats) -> Floats:
    """Offsets of tips (R, 4) in m, none beyond what is likely: what a fit takes more of is misfit."""
    most = _FARTHEST * bench.baseline.settings.offset
    return np.clip(offsets, -most, most)


def _paid(bench: Bench, offsets: Floats) -> Floats:
    """(R,) squares of offsets (R, 4) over their variance, spread over the data of a recording."""
    scale = bench.baseline.settings.offset
    if not scale:
        return np.zeros(len(offsets))
    counts = np.maximum(bench.seen.sum(axis=(1, 2)), 1)
    return np.asarray(np.sum((offsets / scale) ** 2, axis=1) / counts)


def _alone(bench: Bench, model: Model, told: Floats) -> tuple[tuple[str, str], ...]:
    """Effects whose sizes a fold alone tells of, by what recordings tell of each number (R, n)."""
    sizes: dict[str, list[int]] = {}
    for column in range(len(bench.baseline.model.parameters), len(model.parameters)):
        one = model.parameters[column]
        if one.size and np.any(told[:, column] > 0.0):
            sizes.setdefault(one.key.partition(".")[0], []).append(column)
    found = []
    for effect, columns in sizes.items():
        shares = told[:, columns] / told[:, columns].sum(axis=0)
        for k in range(bench.count):
            if bench.count > 1 and np.all(shares[bench.fold != k].sum(axis=0) < _UNTOLD):
                found.append((effect, bench.prepared.files[int(np.argmax(shares[:, 0]))]))
    return tuple(found)


def _told(jacobian: Floats, count: int) -> Floats:
    """(R, n) information of each recording on each number alone, its start and offset being free.

    Parameters
    ----------
    jacobian
        (R, 3 T, n + d) white derivatives, those of the start and the offset last.
    count
        n.
    """
    numbers, own = jacobian[..., :count], jacobian[..., count:]
    cross, normal = (np.swapaxes(own, 1, 2) @ one for one in (numbers, own))
    taken = np.einsum("rdn,rdn->rn", cross, np.linalg.pinv(normal, hermitian=True) @ cross)
    return np.asarray(np.maximum(np.sum(numbers**2, axis=1) - taken, 0.0))


def _sigma(bench: Bench) -> Floats:
    """(3,) noise of the camera, whatever the fit has weighed by."""
    noise = bench.baseline.noise
    return np.asarray(noise.sigma * noise.floor)


def _or_one(weights: Floats | None) -> Floats | float:
    """Weights as they apply to the rows of derivatives (R, 3 T, d)."""
    return 1.0 if weights is None else np.repeat(weights, 3, axis=1)[..., None]


def weights_of(bench: Bench, model: Model, values: Floats) -> Floats | None:
    """Weights of the frames in a fit, in which a misfit is not noise.

    Parameters
    ----------
    bench
        R recordings.
    model, values
        The model, and values (n,) near the fit.

    Returns
    -------
    Floats or None
        (R, T) over the noise of the fit's settings: of frames at rest by the camera's noise, less for
        others by what the model leaves of them; None where that is no more than noise.
    """
    settings = bench.baseline.settings.by_chord(_MOST, _FLAT)
    held = np.ones(len(values), dtype=bool)
    residuals = fit(bench.prepared, model, values[None], settings, held=held).fits.residuals[0]
    moving = bench.seen & ~bench.still[..., None]
    left = float(np.sqrt(np.mean(residuals[moving] ** 2))) if np.any(moving) else 1.0
    noise = bench.baseline.noise.floor
    if left <= 1.5 * noise:  # as good as the noise: nothing needs to be held apart from it
        return None
    return np.where(bench.still, 1.0 / noise, 1.0 / left)


def _from_rest(
    bench: Bench,
    model: Model,
    values: Floats,
    rows: Ints,
    starts: Floats,
    slopes: Floats,
    offsets: Floats | None = None,
) -> tuple[Floats, Ints]:
    """(r, T, 3) predicted from starts that agree with the frames at rest on the whole, and outcomes."""
    prepared, sigma = some_of(bench.prepared, rows), bench.baseline.settings.sigma
    quiet = bench.still[rows]

    def run(starts: Floats) -> tuple[Floats, Ints, Floats]:
        found = predicted(prepared, model, values[None], starts=starts, offsets=offsets)
        poses = found.poses[0]
        return (
            poses,
            found.outcomes[0],
            np.where(quiet[..., None], (prepared.seen - poses) / sigma, 0.0),
        )

    poses, outcomes, away = run(starts)
    for _ in range(_ROUNDS):
        steps = [
            _step(slope, of.ravel(), kept) * sigma
            for slope, of, kept in zip(slopes, away, quiet, strict=True)
        ]
        tried = run(starts + np.stack(steps))
        # of a part that touches a tip at first the slope may be that of another contact, which sends the
        # start away from where the part was seen
        better = np.sum(tried[2] ** 2, axis=(1, 2)) < np.sum(away**2, axis=(1, 2))
        each = better[:, None, None]
        starts = np.where(better[:, None], starts + np.stack(steps), starts)
        poses, away = np.where(each, tried[0], poses), np.where(each, tried[2], away)
        outcomes = np.where(better, tried[1], outcomes)
    # a push that a model cannot carry out has no record from where it ends: it is predicted to move
    # nothing, which is an error of the size of the push
    ran = outcomes == Outcome.COMPLETED
    poses = np.where(ran[:, None, None], poses, starts[:, None])
    return np.where(bench.seen[rows], poses, np.nan), outcomes


def _step(slope: Floats, away: Floats, quiet: Flags) -> Floats:
    """(3,) by how much a start moves, in σ, for frames at rest to agree."""
    rows = slope[np.repeat(quiet, 3)]
    normal = rows.T @ rows + _DAMPED * np.eye(3)
    return np.asarray(np.linalg.solve(normal, rows.T @ away[np.repeat(quiet, 3)]))


def _start_squares(bench: Bench, slopes: Floats) -> Floats:
    """(R,) mean square error over the noise that the noise of frames at rest makes by itself."""
    wider = longer(bench.baseline.noise.correlation)
    each = []
    for slope, quiet, seen in zip(slopes, bench.still, bench.seen, strict=True):
        rows, kept = slope[np.repeat(quiet, 3)], slope[seen.ravel()]
        normal = rows.T @ rows + _DAMPED * np.eye(3)
        share = np.sum(np.linalg.solve(normal, kept.T).T * kept) / max(len(kept), 1)
        few = min(wider, float(quiet.sum()))  # the mean of one frame is as uncertain as the frame
        each.append(few * float(share))
    return np.array(each)
