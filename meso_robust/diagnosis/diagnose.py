"""The whole diagnosis: refit, detect, locate, name, show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meso_robust import __version__
from meso_robust.diagnosis.acceptance import Witnesses, judged, partial
from meso_robust.diagnosis.baseline import Baseline, fitted_baseline
from meso_robust.diagnosis.black_box import black_box
from meso_robust.diagnosis.candidates import Candidate, Naming
from meso_robust.diagnosis.control import Control, control
from meso_robust.diagnosis.detect import Detection, Detector, Span, detector
from meso_robust.diagnosis.error_floor import catch_all
from meso_robust.diagnosis.identifiable import Visibility, visibilities
from meso_robust.diagnosis.invariances import Pair
from meso_robust.diagnosis.localisation import Located, located, predicted_pairs
from meso_robust.diagnosis.model_selection import Contest
from meso_robust.diagnosis.noise import Noise, noise_of, with_noise
from meso_robust.diagnosis.nulls import null_rows
from meso_robust.diagnosis.placebo_tests import Decoys, decoys
from meso_robust.diagnosis.refit import Refit
from meso_robust.diagnosis.signatures import Signature, signatures
from meso_robust.diagnosis.spans import spans_of
from meso_robust.diagnosis.split import Split, split
from meso_robust.diagnosis.store import Store
from meso_robust.diagnosis.trials import trials
from meso_robust.diagnosis.validation import Errors, Extrapolation, errors, extrapolated, trained
from meso_robust.identification.answer import set_hash
from meso_robust.identification.plausible import doubts
from meso_robust.recordings import RecordingSet

Told = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and of how much."""

NULLS = {True: 199, False: 399}
"""Simulated sets without a mismatch of a quick and of a full diagnosis."""
_PARTS = 3  # sets that may explain a part of a mismatch that none explains


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Diagnosis:
    """What recordings say of a model.

    Attributes
    ----------
    recordings
        All, with the noise stated.
    sha256
        Of the recordings as given.
    split, noise, baseline, spans, signatures
        What the tests stand on.
    detection
        Whether there is a mismatch.
    visible
        What these recordings could show.
    located
        Where the mismatch is; None where there is none.
    predicted_pairs
        The same pairs as the best extended model has them.
    naming
        Outcome of the competition; None where nothing is to be explained.
    before, after
        Errors on the held-out recordings of the plain and of the best extended model.
    trained, retrained
        Likewise on the recordings of the fit.
    extrapolation
        Errors on a kind of push that was left out of the fits; None of a quick diagnosis.
    quick, seed
        As asked.
    black_box, catch_all
        Errors in σ on held-out recordings of a regression of equal size, and with free hidden inputs.
    control
        Errors where both models predict the same.
    decoys
        How signatures that do not belong where they are put did.
    """

    recordings: RecordingSet
    sha256: str
    split: Split
    noise: Noise
    baseline: Baseline
    spans: tuple[Span, ...]
    signatures: list[Signature]
    detection: Detection
    visible: tuple[Visibility, ...]
    located: Located | None
    predicted_pairs: tuple[Pair, ...]
    naming: Naming | None
    before: Errors | None
    after: Errors | None
    trained: Errors
    retrained: Errors | None
    extrapolation: Extrapolation | None
    quick: bool
    seed: int
    black_box: float | None = None
    catch_all: float | None = None
    control: Control | None = None
    decoys: Decoys | None = None

    @property
    def best(self) -> Candidate | None:
        """The set of effects of the extended model."""
        if self.naming is None:
            return None
        return self.naming.answers[0] if self.naming.answers else self.naming.best

    @property
    def doubts(self) -> tuple[str, ...]:
        """What makes the refitted plain model unlikely to be the part's, a line each."""
        return doubts(self.baseline.model, self.baseline.fits.values[0])

    @property
    def verdict(self) -> str:
        """As in `diagnosis.json`."""
        if self.naming is None:
            return "consistent"
        return {0: "unknown", 1: "named"}.get(len(self.naming.answers), "ambiguous")


def diagnose(
    recordings: RecordingSet,
    *,
    model: str = "viscous",
    quick: bool = False,
    seed: int = 0,
    store: Path | None = None,
    told: Told = lambda *_: None,
) -> Diagnosis:
    """Locate a mismatch between recordings and a model, and say what physics was left out.

    Parameters
    ----------
    recordings
        As read.
    model
        The plain model, a name in `identification.models.MODELS`.
    quick
        Fewer simulated nulls and forms of effects.
    seed
        The same seed gives the same result.
    store
        Folder for intermediate results, from which an interrupted diagnosis resumes.
    told
        Told of progress.

    Raises
    ------
    InputError
        If the recordings cannot be used.
    """
    sha256 = set_hash(recordings)
    kept = Store(store, f"{__version__} {sha256} {model} {quick} {seed}")
    noise = noise_of(recordings)
    recordings = with_noise(recordings, noise)
    parts = split(recordings, seed)
    baseline = fitted_baseline(parts.training, noise, model, quick=quick, seed=seed, told=told)
    told("simulating recordings without a mismatch", 0, 1)
    nulls = kept.kept("nulls", lambda: {"rows": null_rows(baseline, NULLS[quick], seed)})["rows"]
    told("simulating every effect", 0, 1)
    marks = signatures(baseline, trials(baseline.prepared))
    spans = spans_of(parts.training, baseline.prepared)
    tests: Detector = detector(baseline.tangent, marks, spans, baseline.prepared.files)
    detection = tests.detection(baseline.rows, nulls)
    where, naming = None, None
    if detection.detected:
        told("looking where it is", 0, 1)
        where = located(parts.training, baseline, seed)
        naming = Contest(baseline, marks, spans, nulls, quick, told, kept).named()
    told("comparing with recordings that were held out", 0, 1)
    return _shown(
        Diagnosis(
            recordings=recordings,
            sha256=sha256,
            split=parts,
            noise=baseline.noise,
            baseline=baseline,
            spans=spans,
            signatures=marks,
            detection=detection,
            visible=visibilities(baseline.tangent, marks),
            located=where,
            predicted_pairs=(),
            naming=naming,
            before=None,
            after=None,
            trained=trained(baseline, None),
            retrained=None,
            extrapolation=None,
            quick=quick,
            seed=seed,
        )
    )


def _shown(found: Diagnosis) -> Diagnosis:
    """The diagnosis with what the models are worth on recordings that were held out."""
    held_out, baseline = found.split.held_out, found.baseline
    before = _on(held_out, baseline, None) if held_out else None
    if found.naming is not None:
        found = _judged(replace(found, catch_all=_catch_all(found, before)), before)
    best = found.best
    if best is None:
        return replace(found, before=before)
    after = _on(held_out, baseline, best) if held_out else None
    retrained = trained(baseline, best.refit)
    refit = best.refit
    found = _checked(found, best.refit, before, after, retrained)
    return replace(
        found,
        before=before,
        after=after,
        retrained=retrained,
        predicted_pairs=_pairs(found, retrained),
        extrapolation=None
        if found.quick
        else extrapolated(found.split.training, baseline, refit.model, refit.fits.values[0]),
    )


def _judged(found: Diagnosis, before: Errors | None) -> Diagnosis:
    """The diagnosis with the answers that are left, or else the part that is explained."""
    naming, baseline, held_out = found.naming, found.baseline, found.split.held_out
    if naming is None:
        return found
    refits = [trained(baseline, one.refit) for one in naming.answers]
    errors: dict[tuple[str, ...], Errors] = {(): before or found.trained}
    if held_out is None:
        errors |= {one.effects: own for one, own in zip(naming.answers, refits, strict=True)}
    else:
        errors |= {one.effects: _on(held_out, baseline, one) for one in _asked_of(naming)}
    told = Witnesses(
        errors=errors,
        unseen=held_out is not None,
        reach=max(found.noise.floor, found.catch_all or 0.0),
        seen=found.located.pairs if found.located else (),
        pairs={
            one.effects: _pairs(found, own) for one, own in zip(naming.answers, refits, strict=True)
        },
    )
    naming = judged(naming, told)
    if not naming.answers and held_out is not None and before is not None:
        some = naming.candidates[:_PARTS]
        naming = partial(naming, before, tuple(_on(held_out, baseline, one) for one in some))
    return replace(found, naming=naming)


def _asked_of(naming: Naming) -> tuple[Candidate, ...]:
    """The answers, and the sets they contain."""
    return tuple(
        one
        for one in naming.candidates
        if any(set(one.effects) <= set(answer.effects) for answer in naming.answers)
    )


def _pairs(found: Diagnosis, model: Errors) -> tuple[Pair, ...]:
    """The invariances as a model has them, of the recordings of the fit."""
    if found.located is None:
        return ()
    return predicted_pairs(found.baseline, found.located.pairs, model.poses)


def _catch_all(found: Diagnosis, before: Errors | None) -> float | None:
    """What any law could reach on held-out recordings; on those of the fit where none are."""
    held_out, parts = found.split.held_out, found.split
    if held_out is None or before is None:
        return catch_all(parts.training, found.baseline.prepared, found.baseline)
    return catch_all(held_out, before.prepared, found.baseline)


def _checked(
    found: Diagnosis, refit: Refit, before: Errors | None, after: Errors | None, retrained: Errors
) -> Diagnosis:
    """The diagnosis with what would speak against the name of the best set."""
    baseline, held_out = found.baseline, found.split.held_out
    pairs = [(found.spans, found.trained, retrained)]
    if held_out and before is not None and after is not None:
        pairs.append((spans_of(held_out, before.prepared), before, after))
    columns = [one.columns for one in found.signatures if one.trial in refit.trials]
    return replace(
        found,
        black_box=None if before is None else black_box(found.trained, before, refit.numbers),
        control=control(pairs, baseline.settings.sigma),
        decoys=decoys(baseline.tangent, baseline.rows, np.concatenate(columns), found.seed),
    )


def _on(recordings: RecordingSet, baseline: Baseline, best: Candidate | None) -> Errors:
    if best is None:
        return errors(recordings, baseline.model, baseline.fits.values[0], baseline)
    return errors(recordings, best.refit.model, best.refit.fits.values[0], baseline)
