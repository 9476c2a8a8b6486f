"""The whole diagnosis: refit, detect, locate, select, accept, grade, check.

Each step makes one part from the parts before it: `Baseline` → `Detected` → `Located` → `Naming` →
`Accepted` → `Grade` → `Checked`; a `Diagnosis` is all of them.

Which recordings are held out of the fits decides what these can tell: of three pushes on the edge that is wrong, two may be
held out. Where nothing explains a mismatch, or most of what an answer leaves is in those, it is asked once more with others held out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meso_robust import __version__
from meso_robust.diagnosis.acceptance import Accepted, accepted
from meso_robust.diagnosis.baseline import Baseline, fitted_baseline
from meso_robust.diagnosis.candidates import Candidate, Naming
from meso_robust.diagnosis.common_error import roomier, widened
from meso_robust.diagnosis.controls import Control, Decoys, black_box, control, decoys
from meso_robust.diagnosis.detect import Detected, detected, spans_of
from meso_robust.diagnosis.document import Verdict
from meso_robust.diagnosis.each_push import EachPush, each_push
from meso_robust.diagnosis.flat import opened
from meso_robust.diagnosis.folds import RollOut, bench_of, intervals_by_fold
from meso_robust.diagnosis.grading import Grade, graded, sized
from meso_robust.diagnosis.invariances import Pair
from meso_robust.diagnosis.judge import NAMED
from meso_robust.diagnosis.localisation import Located, located, predicted_pairs
from meso_robust.diagnosis.model_selection import Contest
from meso_robust.diagnosis.noise import Noise, noise_of, with_noise
from meso_robust.diagnosis.refit import Refit, intervals_of
from meso_robust.diagnosis.residual import ResidualLaw, residual_law
from meso_robust.diagnosis.signatures import signatures
from meso_robust.diagnosis.store import Store
from meso_robust.diagnosis.tangent import Interval
from meso_robust.diagnosis.trials import trials
from meso_robust.diagnosis.validation import (
    Extrapolation,
    Split,
    Worth,
    extrapolated,
    split,
    worth,
)
from meso_robust.identification.identify import Told
from meso_robust.identification.verdict import doubts
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.direct.finding import Finding
from meso_robust.recordings.direct.run import direct_tests
from meso_robust.recordings.fingerprint import set_hash

NULLS = {True: 199, False: 399}
"""Simulated sets without a mismatch of a quick and of a full diagnosis: they bound the p-value from
below, by 0.005 and 0.0025."""


MOST = 0.5
"""Lower end of what friction of every push's own explains, from which on it is the answer; and share of what is left
that is in recordings held out of the fits, above which others are held out."""
_AMISS = 1.5  # σ, that a recording held out leaves of a model that fits all others


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Checked:
    """What would speak against the best extended model; all empty where nothing was added.

    Attributes
    ----------
    pairs
        The invariances of `Located` as the model has them, of the recordings of the fit.
    extrapolation
        Errors on a kind of push that was left out of the fits; None of a quick diagnosis.
    black_box
        Error in σ on held-out recordings of a regression of equal size.
    control
        Errors where both models predict the same.
    decoys
        How signatures that do not belong where they are put did.
    """

    pairs: tuple[Pair, ...] = ()
    extrapolation: Extrapolation | None = None
    black_box: float | None = None
    control: Control | None = None
    decoys: Decoys | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Diagnosis:
    """What recordings say of a model.

    Attributes
    ----------
    recordings
        All, with the noise stated.
    sha256
        Of the recordings as given.
    split
        Which are fitted, and which are held out.
    quick, seed
        As asked.
    detected
        The fitted plain model, and whether there is a mismatch.
    located, accepted
        Where the mismatch is, and what survived the competition; None where none was detected.
    grade
        What is explained of recordings that were left out of the fit, and the verdict.
    plain, extended
        Errors of the plain model, and of the best extended one; None where nothing was added.
    checked
        What would speak against the extended model.
    known
        Intervals of the numbers of the extended model; none where nothing was added.
    residual
        A law of what has no name, where the verdict is partial or unknown; None where none was found.
    each_push
        Friction of its own in every push, where that is the answer; None where it is not.
    """

    recordings: RecordingSet
    sha256: str
    split: Split
    quick: bool
    seed: int
    detected: Detected
    located: Located | None
    accepted: Accepted | None
    grade: Grade
    plain: Worth
    extended: Worth | None
    checked: Checked
    known: tuple[Interval, ...] = ()
    residual: ResidualLaw | None = None
    each_push: EachPush | None = None

    @property
    def baseline(self) -> Baseline:
        """The fitted plain model."""
        return self.detected.baseline

    @property
    def naming(self) -> Naming | None:
        """Outcome of the competition; None where nothing is to be explained."""
        return self.accepted.naming if self.accepted else None

    @property
    def best(self) -> Candidate | None:
        """The set of effects of the extended model."""
        return self.grade.chosen

    @property
    def answers(self) -> tuple[Candidate, ...]:
        """The chosen set and those that explain as much, if they explain enough."""
        grade = self.grade
        if grade.chosen is None or grade.verdict == "unknown":
            return ()
        return (grade.chosen, *grade.rivals, *grade.alike)

    @property
    def doubts(self) -> tuple[str, ...]:
        """What makes the refitted plain model unlikely to be the part's, a line each."""
        return doubts(self.baseline.model, self.baseline.fits.values[0])

    @property
    def verdict(self) -> Verdict:
        """As in `diagnosis.json`."""
        return self.grade.verdict


def diagnose(
    recordings: RecordingSet,
    *,
    model: str = "viscous",
    quick: bool = False,
    seed: int = 0,
    relevant: float | None = None,
    store: Path | None = None,
    told: Told = lambda *_: None,
    findings: tuple[Finding, ...] | None = None,
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
    relevant
        m: an error of prediction below this does not matter; None for what `graded` takes.
    store
        Folder for intermediate results, from which an interrupted diagnosis resumes.
    told
        Told of progress.
    findings
        Of the tests without a simulation; they are made where none are given.

    Returns
    -------
    Diagnosis
        Whole; its documents are made by `answer`.

    Raises
    ------
    InputError
        If the recordings cannot be used.
    """
    asked = _Asked(model, quick, seed, relevant, store, told, findings, set_hash(recordings))
    noise = noise_of(recordings)
    recordings = with_noise(_in_order(recordings), noise)
    found = _answered(recordings, noise, frozenset(), asked)
    held_out = found.split.held_out
    if held_out is not None and (found.verdict == "unknown" or _left_there(found)):
        told("what is left is looked for with other recordings held out", 0, 1)
        before = frozenset(one.file for one in held_out.recordings)
        other = _answered(recordings, noise, before, replace(asked, quick=True))
        if not quick and _explains(other):
            other = _answered(recordings, noise, before, asked)
        found = other if _explains(other) else found
    return _by_push(found) if found.verdict in ("unknown", "partial") else found


def _by_push(found: Diagnosis) -> Diagnosis:
    """A diagnosis without a name, partial if friction of its own in every push explains most of the error.

    So is one in which that surely explains more than the effects that were found.
    """
    grade = found.grade
    least = MOST if grade.explained is None else max(MOST, grade.explained.high)
    if least >= 1.0:
        return found
    own = each_push(grade.bench, grade.plain, grade.floor, found.seed)
    if own is None or not (own.explained.tells and own.explained.low >= least):
        return found
    partial = replace(
        grade,
        verdict="partial",
        chosen=None,
        extended=None,
        rivals=(),
        alike=(),
        beside=(),
        explained=own.explained,
        shares={},
    )
    return replace(found, grade=partial, extended=None, checked=Checked(), known=(), each_push=own)


def _left_there(found: Diagnosis) -> bool:
    """Whether much is left, most of it in recordings that no fit of the competition has seen: it may be of another effect."""
    grade, held_out = found.grade, found.split.held_out
    explained, rolled = grade.explained, grade.extended
    if explained is None or explained.share >= NAMED or rolled is None or held_out is None:
        return False
    counts = grade.bench.seen.sum(axis=(1, 2))
    left = np.maximum(rolled.squares.sum(axis=(1, 2)) - grade.floor * counts, 0.0)
    files = {one.file for one in held_out.recordings}
    there = np.array([file in files for file in grade.bench.prepared.files])
    return bool(left[there].sum() > MOST * left.sum())


def _explains(found: Diagnosis) -> bool:
    """Whether a second try explains as much as what is named: less may be by the luck of two tries."""
    explained = found.grade.explained
    return explained is not None and explained.share >= NAMED


@dataclass(frozen=True, slots=True)
class _Asked:
    """What was asked of a diagnosis, as in `diagnose`, and the hash of the recordings as given."""

    model: str
    quick: bool
    seed: int
    relevant: float | None
    store: Path | None
    told: Told
    findings: tuple[Finding, ...] | None
    sha256: str


def _answered(
    recordings: RecordingSet, noise: Noise, fitted: frozenset[str], asked: _Asked
) -> Diagnosis:
    """A diagnosis with a fifth of the recordings held out, none of those that are to be ``fitted``."""
    quick, seed, told, findings = asked.quick, asked.seed, asked.told, asked.findings
    while True:
        kept = Store(
            asked.store,
            f"{__version__} {asked.sha256} {asked.model} {quick} {seed} {sorted(fitted)}",
        )
        parts = split(recordings, seed, fitted)
        baseline = fitted_baseline(
            parts.training, noise, asked.model, quick=quick, seed=seed, told=told
        )
        tests = detected(parts.training, baseline, NULLS[quick], seed, told, kept)
        plain = worth(baseline, None, parts.held_out)
        amiss = frozenset() if fitted or tests.detection.detected else _amiss(plain, baseline)
        if not amiss:
            break
        fitted = amiss
    where, naming = None, None
    if tests.detection.detected:
        told("looking where it is", 0, 1)
        where = located(parts.training, baseline, seed)
        contest = Contest(
            baseline,
            tests.signatures,
            tests.spans,
            tests.nulls,
            quick,
            told,
            kept,
            findings=direct_tests(recordings).findings if findings is None else findings,
            beside=tuple(signatures(baseline, trials(baseline.prepared, beside=True))),
        )
        naming = contest.named()
    told("comparing with recordings that were held out", 0, 1)
    answer, extended, checks = None, None, Checked()
    if where is not None and naming is not None:
        answer = accepted(naming, where, baseline, plain, parts)
    told("predicting recordings left out of the fit", 0, 1)
    grade = graded(
        recordings,
        bench_of(recordings, baseline, seed),
        answer.naming if answer else None,
        where,
        _reach(parts, where, answer),
        quick=quick,
        seed=seed,
        relevant=asked.relevant,
    )
    best = grade.chosen
    known = () if best is None else _numbers(baseline, best.refit, grade.extended)
    grade = sized(grade, known)
    if answer is not None and where is not None and best is not None:
        extended = answer.worth_of(best) or worth(baseline, best.refit, parts.held_out)
        pairs = predicted_pairs(baseline, where.pairs, extended.training.poses)
        beyond = None if quick else extrapolated(parts.training, baseline, best.refit)
        checks = _checked(tests, parts, plain, extended, best.refit, pairs, beyond, seed)
    law = None
    if grade.verdict in ("partial", "unknown"):
        told("looking for a residual law", 0, 1)
        law = residual_law(grade.bench, grade.extended or grade.plain, seed)
    return Diagnosis(
        recordings=recordings,
        sha256=asked.sha256,
        split=parts,
        quick=quick,
        seed=seed,
        detected=tests,
        located=where,
        accepted=answer,
        grade=grade,
        plain=plain,
        extended=extended,
        checked=checks,
        known=known,
        residual=law,
    )


def _in_order(recordings: RecordingSet) -> RecordingSet:
    """The recordings by the names of their files: an answer does not depend on the order of a list."""
    by_name = sorted(recordings.recordings, key=lambda one: one.file)
    return replace(recordings, recordings=tuple(by_name))


def _amiss(plain: Worth, baseline: Baseline) -> frozenset[str]:
    """Recordings held out that the plain model clearly does not predict.

    Where those of the fit show no mismatch, it may be in the two that were held out, as the only ones on an edge:
    then they are fitted, and others held out.
    """
    if plain.held_out is None:
        return frozenset()
    files, sigmas = plain.held_out.prepared.files, plain.held_out.sigma
    most = _AMISS * baseline.noise.floor
    return frozenset(file for file, sigma in zip(files, sigmas, strict=True) if sigma > most)


def _numbers(baseline: Baseline, refit: Refit, rolled: RollOut | None) -> tuple[Interval, ...]:
    """Intervals of the numbers of a set.

    Where it leaves more than noise, those of all recordings with starts held where the parts were seen: starts
    that are free take up what is wrong.
    """
    held = rolled is not None and rolled.weighed
    known = intervals_by_fold(rolled) if rolled and held else intervals_of(baseline, refit)
    return opened(baseline, refit, widened(baseline, refit, roomier(refit, known)))


def _reach(parts: Split, where: Located | None, answer: Accepted | None) -> float | None:
    """σ that free hidden inputs leave of all recordings, those of the fit and those held out."""
    known = [(len(parts.training.recordings), where.reach if where else None)]
    if parts.held_out is not None:
        known.append((len(parts.held_out.recordings), answer.catch_all if answer else None))
    told = [(count, value) for count, value in known if value is not None]
    if not told:
        return None
    counts, values = np.array(told).T
    return float(np.sqrt(counts @ values**2 / counts.sum()))


def _checked(
    tests: Detected,
    parts: Split,
    plain: Worth,
    extended: Worth,
    refit: Refit,
    pairs: tuple[Pair, ...],
    beyond: Extrapolation | None,
    seed: int,
) -> Checked:
    """What would speak against an extended model."""
    baseline, before, after = tests.baseline, plain.held_out, extended.held_out
    groups = [(tests.spans, plain.training, extended.training)]
    if parts.held_out and before and after:
        groups.append((spans_of(parts.held_out, before.prepared), before, after))
    columns = [one.columns for one in tests.signatures if one.trial in refit.trials]
    return Checked(
        pairs=pairs,
        extrapolation=beyond,
        black_box=black_box(plain.training, before, refit.numbers) if before else None,
        control=control(groups, baseline.settings.sigma),
        decoys=decoys(baseline.tangent, baseline.rows, np.concatenate(columns), seed),
    )
