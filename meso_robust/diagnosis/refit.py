"""A set of effects, refitted in the simulator together with everything else, and its evidence.

The evidence is the log marginal likelihood, by Laplace's approximation about the fit: by the chain
rule it is the sum of the log densities with which each recording is predicted from those before it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from meso_robust.diagnosis.baseline import Baseline, rows_of
from meso_robust.diagnosis.signatures import Signature, estimate, extended, start_of, within
from meso_robust.diagnosis.store import NOWHERE, Store, fits_ahead, kept_fit
from meso_robust.diagnosis.tangent import Interval, Tangent, intervals, tangent
from meso_robust.diagnosis.trials import Trial
from meso_robust.identification.forward import corrected
from meso_robust.identification.likelihood import fit
from meso_robust.identification.models import Model
from meso_robust.identification.prepared import Prepared, some_of
from meso_robust.identification.problem import Fits, Fitted
from meso_robust.types import Flags, Floats

WIDTH = 10.0
"""Standard deviation of the size of an effect before any recording, in typical changes."""
_FORM = (
    5.0  # likewise of a number that gives it its form, about the value that the search starts from
)
_ROUGH = 4  # iterations that show whether an effect is worth more
# of the way to an end of its range, up to which a size is where a search begins: what a linear estimate puts
# beyond is not known to that end, and a search that begins there may stay there
_HALF_WAY = 0.5
_END = 1e-4  # typical changes from the end of a range that count as at it
_MOST = 10  # iterations of a refit


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Refit:
    """The model with some effects, fitted.

    Attributes
    ----------
    trials
        The effects with the form that the search started from.
    model
        The plain model with their numbers.
    fits, fitted
        The best fit (one), and what the search knows of it.
    tangent
        What it can take of the data.
    rows
        (R, M) white residuals.
    chi2
        Sum of squares of what is left.
    gain
        Log evidence over that of the plain model.
    others
        The same effects with other forms of a law, the best fit of each, the best first.
    """

    trials: tuple[Trial, ...]
    model: Model
    fits: Fits
    fitted: Fitted
    tangent: Tangent
    rows: Floats
    chi2: float
    gain: float
    others: tuple[Refit, ...] = ()

    @property
    def lead(self) -> float | None:
        """By how much it is ahead of other forms of a law, nats; None if no other was tried."""
        return self.gain - max(one.gain for one in self.others) if self.others else None

    @property
    def effects(self) -> tuple[str, ...]:
        """Names, in alphabetical order."""
        return tuple(sorted(trial.effect for trial in self.trials))

    @property
    def numbers(self) -> int:
        """Of all effects together."""
        return sum(len(trial.scales) for trial in self.trials)

    @property
    def evidence(self) -> Floats:
        """(R M,) what is left."""
        return self.tangent.evidence(self.rows)


def refitted(
    baseline: Baseline,
    chosen: tuple[Signature, ...],
    *,
    start: Refit | None = None,
    store: Store = NOWHERE,
) -> Refit:
    """Fit the model with some effects, roughly: `refined` goes on.

    Parameters
    ----------
    baseline
        The plain fit.
    chosen
        One signature for each effect.
    start
        A fit of all but the last of them to start from.
    store
        Where the fit is kept.
    """
    found = kept_fit(store, *_rough(baseline, chosen, start))
    return _scored(baseline, chosen, _model(baseline, chosen), found)


def refined(
    baseline: Baseline, chosen: tuple[Signature, ...], rough: Refit, *, store: Store = NOWHERE
) -> Refit:
    """A rough fit with its search taken to its end, freed of the error of the steps."""
    found = kept_fit(store, *_fine(baseline, chosen, rough))
    return _scored(baseline, chosen, rough.model, found)


def ahead(
    baseline: Baseline,
    store: Store,
    *,
    rough: Iterable[tuple[tuple[Signature, ...], Refit | None]] = (),
    fine: Iterable[tuple[tuple[Signature, ...], Refit]] = (),
) -> None:
    """Make fits that are asked for next all at once (`Store.ahead`).

    Parameters
    ----------
    baseline, store
        As in `refitted`.
    rough
        Signatures, and a fit to start from, of those that `refitted` is asked for.
    fine
        Signatures, and a rough fit, of those that `refined` is asked for.
    """
    makes = [_rough(baseline, *one) for one in rough] + [_fine(baseline, *one) for one in fine]
    fits_ahead(store, dict(makes))


def _model(baseline: Baseline, chosen: tuple[Signature, ...]) -> Model:
    return extended(baseline.model, tuple(one.trial for one in chosen), baseline.prepared)


def _rough(
    baseline: Baseline, chosen: tuple[Signature, ...], start: Refit | None
) -> tuple[str, Callable[[], Fitted]]:
    """Name of a rough fit, and what makes it."""
    before = start.fits if start else baseline.fits

    def make() -> Fitted:
        model = _model(baseline, chosen)
        return fit(
            baseline.prepared,
            model,
            _first(baseline, chosen, model, start)[None],
            baseline.settings.by_chord(_ROUGH, 1.0),
            starts=before.starts[0],
            offsets=before.offsets[0],
        )

    return f"rough {_key(chosen)}", make


def _fine(
    baseline: Baseline, chosen: tuple[Signature, ...], rough: Refit
) -> tuple[str, Callable[[], Fitted]]:
    """Name of a fit whose search is taken to its end, and what makes it."""
    return f"fine {_key(chosen)}", lambda: _sharp(baseline, rough)


def intervals_of(baseline: Baseline, refit: Refit) -> tuple[Interval, ...]:
    """Intervals of all numbers of a fit whose search is at its end.

    Parameters
    ----------
    baseline
        The plain fit.
    refit
        The extended one.
    """
    fits, model = refit.fits, refit.model
    given = lru_cache(1)(lambda: _corrected(baseline, model, fits))

    def without(row: int) -> Floats | None:
        rest = np.delete(np.arange(len(baseline.prepared.files)), row)
        try:
            again = fit(
                some_of(given(), rest),
                model,
                fits.values,
                baseline.settings.by_chord(_MOST, 0.05),
                starts=fits.starts[0, rest],
                offsets=fits.offsets[0, rest],
            )
        except (ValueError, np.linalg.LinAlgError):
            return None  # its search leaves what can be simulated
        return np.asarray(model.coordinates(again.fits.values)[0])

    jacobian = refit.fitted.jacobian[0]
    return intervals(model, fits.values[0], jacobian, refit.tangent, refit.rows, without)


def _corrected(baseline: Baseline, model: Model, fits: Fits) -> Prepared:
    """The recordings with predictions corrected for the length of the steps at a fit."""
    return corrected(
        baseline.prepared,
        baseline.finer,
        model,
        fits.values,
        starts=fits.starts,
        offsets=fits.offsets,
    )


def _key(chosen: tuple[Signature, ...]) -> str:
    """What tells one set of forms from another."""
    return " ".join(f"{one.trial.effect}{sorted(one.trial.shape.items())}" for one in chosen)


def _sharp(baseline: Baseline, rough: Refit) -> Fitted:
    """The fit at the end of the search, with predictions corrected for the length of the steps."""
    model, settings = rough.model, baseline.settings.by_chord(_MOST, 0.05)
    fits = rough.fits
    found = fit(
        baseline.prepared,
        model,
        fits.values,
        settings,
        starts=fits.starts[0],
        offsets=fits.offsets[0],
    )
    fits = found.fits
    return fit(
        _corrected(baseline, model, fits),
        model,
        fits.values,
        settings,
        starts=fits.starts[0],
        offsets=fits.offsets[0],
        jacobian=found.jacobian,
    )


def _first(
    baseline: Baseline, chosen: tuple[Signature, ...], model: Model, start: Refit | None
) -> Floats:
    """(n,) vector to start from: what a linear estimate makes of the last effect."""
    before, last = start or baseline, chosen[-1]
    sizes = np.zeros(0)
    if last.trial.sizes:
        at = before.tangent
        sizes = estimate(at.evidence(before.rows), last.left(at), last.one_sided)[0]
        sizes = np.clip(sizes, -3.0 * WIDTH, 3.0 * WIDTH)
    own = start_of(last.trial, sizes)
    numbers = model.parameters[len(before.fits.values[0]) :]
    own[: len(sizes)] = [
        np.clip(value, _HALF_WAY * one.low, _HALF_WAY * one.high)
        for value, one in zip(own, numbers[: len(sizes)], strict=False)
    ]
    return np.asarray(within(model, np.append(before.fits.values[0], own)[None])[0])


def _scored(
    baseline: Baseline, chosen: tuple[Signature, ...], model: Model, found: Fitted
) -> Refit:
    n = len(model.parameters)
    jacobian = found.jacobian[0].copy()
    jacobian[..., :n][..., ~_loose(model, found.fits.values[0])] = 0.0
    at = tangent(jacobian, n, baseline.seen, baseline.noise.correlation)
    rows = rows_of(at, baseline.settings, found.fits)[0]
    evidence = at.evidence(rows)
    base = baseline.evidence
    chi2 = float(evidence @ evidence)
    gain = 0.5 * (float(base @ base) - chi2) - _occam(baseline, chosen, model, found)
    return Refit(
        trials=tuple(one.trial for one in chosen),
        model=model,
        fits=found.fits,
        fitted=found,
        tangent=at,
        rows=rows,
        chi2=chi2,
        gain=gain,
    )


def _loose(model: Model, values: Floats) -> Flags:
    """(n,) whether a number is away from the ends of its range: only then it takes of the data."""
    low = np.array([parameter.low for parameter in model.parameters])
    high = np.array([parameter.high for parameter in model.parameters])
    scale = np.array([parameter.scale for parameter in model.parameters])
    return np.asarray((values > low + _END * scale) & (values < high - _END * scale))


def _occam(baseline: Baseline, chosen: tuple[Signature, ...], model: Model, found: Fitted) -> float:
    """By how much the numbers of the effects had to be tuned, in nats: ½ log |1 + w² I| + ½ |x/w|²."""
    base = len(baseline.model.parameters)
    jacobian = found.jacobian[0]
    plain = np.delete(jacobian, np.arange(base, len(model.parameters)), axis=2)
    at = tangent(plain, base, baseline.seen, baseline.noise.correlation)
    own = np.moveaxis(jacobian[..., base : len(model.parameters)], -1, 0)
    own = own.reshape(len(own), *baseline.seen.shape)
    left = at.evidence(at.rows(own))
    away, widths = _before(chosen, model, found.fits.values[0], base)
    scaled = widths[:, None] * left
    log_volume = 0.5 * float(np.linalg.slogdet(np.eye(len(left)) + scaled @ scaled.T)[1])
    return log_volume + 0.5 * float(np.sum((away / widths) ** 2))


def _before(
    chosen: tuple[Signature, ...], model: Model, values: Floats, base: int
) -> tuple[Floats, Floats]:
    """(p,) how far the numbers are from what is likely before any recording, and its widths."""
    trials = [one.trial for one in chosen]
    middle = np.concatenate([start_of(one, np.zeros(len(one.sizes))) for one in trials])
    widths = [WIDTH if key in one.sizes else _FORM for one in trials for key in one.scales]
    scales = np.array([parameter.scale for parameter in model.parameters[base:]])
    return (values[base:] - middle) / scales, np.array(widths)
