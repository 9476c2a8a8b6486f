"""Is there a mismatch at all? Many local tests, one calibrated p-value.

Three kinds of tests look at what a fit leaves: along the signature of every effect, by the mean over
every phase of every recording, and by the sum of squares of every recording. Each is standardised by
recordings simulated without a mismatch, and so is the largest of all: its distribution there, refit,
coloured noise, lost frames and errors of the solver included, gives the p-value. No table is used.
The idea of many local tests and one global, calibrated one: N. Anau Montel, J. Alvey, C. Weniger
2025, doi:10.1103/PhysRevD.111.083013.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2, norm

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.nulls import null_rows
from meso_robust.diagnosis.signatures import (
    Signature,
    Visibility,
    lefts,
    signatures,
    visibilities,
)
from meso_robust.diagnosis.store import Store
from meso_robust.diagnosis.tangent import Tangent
from meso_robust.diagnosis.trials import trials
from meso_robust.identification.identify import Told
from meso_robust.identification.prepared import Prepared
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.phases import phases
from meso_robust.types import Floats

ALARM = 0.005
"""p-value up to which a mismatch is stated."""
_SMALL = 1e-3  # of a signature: less is left of it by the refit, and it is no test
_DEEP = 1e-300  # probability below which quantiles are not taken
_PIECES = 3  # of a contact
_FEWEST = 3  # frames of a span


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalTest:
    """One test: an effect, or a span of a recording."""

    name: str
    kind: str
    recording: int = -1
    start: float = np.nan
    end: float = np.nan
    component: str = ""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Span:
    """Frames of one recording that belong together."""

    recording: int
    phase: str
    first: int
    last: int
    start: float
    end: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Detection:
    """What the tests found.

    Attributes
    ----------
    p_value, statistic
        Of the largest test.
    null_statistics
        (B,) its values without a mismatch.
    tests, sigmas
        All tests, the largest first, and by how many standard deviations each stands out.
    """

    p_value: float
    statistic: float
    null_statistics: Floats
    tests: tuple[LocalTest, ...]
    sigmas: Floats

    @property
    def detected(self) -> bool:
        """Whether there is a mismatch; with few nulls, one beyond all of them."""
        return self.p_value <= max(ALARM, 1.0 / (1 + len(self.null_statistics)))


@dataclass(frozen=True, slots=True, eq=False)
class Detector:
    """The tests about one fit.

    Attributes
    ----------
    names
        The N tests.
    blocks
        Orthonormal directions (k, R M) of the signatures, the first tests.
    spans
        Frames of the other tests.
    at
        What the fit can take.
    """

    names: tuple[LocalTest, ...]
    blocks: tuple[Floats, ...]
    spans: tuple[Span, ...]
    at: Tangent

    def detection(self, rows: Floats, null_rows: Floats) -> Detection:
        """Compare the recordings, rows (R, M), with nulls (B, R, M)."""
        nulls = self.statistics(self.at.evidence(null_rows))
        own = self.statistics(self.at.evidence(rows[None]))[0]
        middle, spread = nulls.mean(axis=0), np.maximum(nulls.std(axis=0, ddof=1), 1e-9)
        sigmas = (own - middle) / spread
        largest = np.max(_left_one_out(nulls), axis=1)
        order = np.argsort(-sigmas)
        statistic = float(sigmas.max())
        return Detection(
            p_value=float((1 + np.sum(largest >= statistic)) / (1 + len(nulls))),
            statistic=statistic,
            null_statistics=largest,
            tests=tuple(self.names[k] for k in order),
            sigmas=sigmas[order],
        )

    def statistics(self, evidence: Floats) -> Floats:
        """(B, N) of evidence (B, R M), each about normal if there is no mismatch."""
        count = len(evidence)
        # one product: the nulls are larger than a cache, and are read once
        whole = evidence @ np.concatenate([np.zeros((0, evidence.shape[1])), *self.blocks]).T
        ends = np.cumsum([len(block) for block in self.blocks])[:-1]
        signed = [_deviations(of) for of in np.split(whole, ends, axis=1)] if self.blocks else []
        rows = evidence.reshape(count, len(self.at.own), -1)
        frames = rows[..., : 3 * self.at.seen.shape[1]].reshape(count, *self.at.seen.shape)
        means = []
        for span in self.spans:
            own = frames[:, span.recording, span.first : span.last]
            number = np.maximum(self.at.seen[span.recording, span.first : span.last].sum(axis=0), 1)
            means.append(np.abs(own.sum(axis=1)) / np.sqrt(number))
        energy = np.cbrt(np.sum(rows**2, axis=2))
        return np.concatenate(
            [
                np.stack(signed, axis=1) if signed else np.zeros((count, 0)),
                np.concatenate(means, axis=1) if means else np.zeros((count, 0)),
                energy,
            ],
            axis=1,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Detected:
    """The fitted plain model, what its recordings can show, and whether they contradict it.

    Attributes
    ----------
    baseline
        The fit.
    nulls
        (B, R, M) white residuals of sets simulated without a mismatch.
    signatures
        What each effect would change.
    spans
        Frames that the tests look at.
    detection
        Whether there is a mismatch.
    visible
        What these recordings could show.
    """

    baseline: Baseline
    nulls: Floats
    signatures: list[Signature]
    spans: tuple[Span, ...]
    detection: Detection
    visible: tuple[Visibility, ...]


def detected(
    training: RecordingSet, baseline: Baseline, count: int, seed: int, told: Told, store: Store
) -> Detected:
    """Ask whether recordings contradict the plain model that was fitted to them.

    Parameters
    ----------
    training, baseline
        The recordings and the fit.
    count, seed
        Simulated sets without a mismatch, and their seed.
    told, store
        A callback for progress, and where the simulated sets are kept.
    """
    told("simulating recordings without a mismatch", 0, 1)
    nulls = store.kept("nulls", lambda: {"rows": null_rows(baseline, count, seed)})["rows"]
    told("simulating every effect", 0, 1)
    marks = signatures(baseline, trials(baseline.prepared))
    spans = spans_of(training, baseline.prepared)
    tests = detector(baseline.tangent, marks, spans, baseline.prepared.files)
    return Detected(
        baseline=baseline,
        nulls=nulls,
        signatures=marks,
        spans=spans,
        detection=tests.detection(baseline.rows, nulls),
        visible=visibilities(baseline.tangent, marks),
    )


def detector(
    at: Tangent, signatures: list[Signature], spans: tuple[Span, ...], files: tuple[str, ...]
) -> Detector:
    """The tests about a fit whose tangent is ``at``."""
    names, blocks = [], []
    for one, left in zip(signatures, lefts(at, signatures), strict=True):
        whole = np.linalg.norm(one.columns)
        if not np.linalg.norm(left) > _SMALL * whole:
            continue
        # of few rows the square is as exact as needed and far cheaper than the rows themselves
        squares, ways = np.linalg.eigh(left @ left.T)
        told = squares > _SMALL**2 * squares[-1]
        blocks.append((ways[:, told] / np.sqrt(squares[told])).T @ left)
        names.append(LocalTest(name=one.trial.effect, kind="signature"))
    for span in spans:
        for component in ("x", "y", "theta"):
            names.append(
                LocalTest(
                    name=f"{files[span.recording]} {span.phase} {component}",
                    kind="phase",
                    recording=span.recording,
                    start=span.start,
                    end=span.end,
                    component=component,
                )
            )
    for r, file in enumerate(files):
        names.append(LocalTest(name=file, kind="recording", recording=r))
    return Detector(tuple(names), tuple(blocks), spans, at)


def _deviations(scores: Floats) -> Floats:
    """(B,) size of scores (B, k) as that of one normal number."""
    k = scores.shape[1]
    squares = np.sum(scores**2, axis=1)
    if k == 1:
        return np.sqrt(squares)
    tail = chi2.sf(squares, k)
    deep = np.sqrt(np.maximum(squares - k, 0.0))
    return np.where(tail > _DEEP, norm.isf(np.maximum(tail, _DEEP) / 2.0), deep)


def _left_one_out(nulls: Floats) -> Floats:
    """Nulls (B, N), each standardised by the others."""
    count = len(nulls)
    total, squares = nulls.sum(axis=0), np.sum(nulls**2, axis=0)
    middle = (total - nulls) / (count - 1)
    variance = (squares - nulls**2) / (count - 1) - middle**2
    spread = np.sqrt(np.maximum(variance * (count - 1) / (count - 2), 1e-18))
    return np.asarray((nulls - middle) / spread)


def spans_of(recordings: RecordingSet, prepared: Prepared) -> tuple[Span, ...]:
    """Spans of all recordings, in order; the contact is cut into three.

    Parameters
    ----------
    recordings, prepared
        The same recordings.
    """
    found = []
    for row, recording in enumerate(recordings.recordings):
        frames = int(np.max(np.flatnonzero(np.isfinite(prepared.seen[row]).any(axis=1)))) + 1
        clock = prepared.instants[row, :frames]
        for phase in phases(recordings, recording):
            pieces = _PIECES if phase.name == "contact" else 1
            ends = np.linspace(phase.start, phase.end, pieces + 1)
            cuts = np.searchsorted(clock, ends - 1e-9)
            if phase.end >= clock[-1]:
                cuts[-1] = frames
            found += [
                Span(
                    recording=row,
                    phase=phase.name,
                    first=int(first),
                    last=int(last),
                    start=float(clock[first]),
                    end=float(clock[last - 1]),
                )
                for first, last in itertools.pairwise(cuts)
                if last - first >= _FEWEST
            ]
    return tuple(found)
