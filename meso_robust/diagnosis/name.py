"""Which physics was left out: sets of effects compete by their evidence, and must be adequate.

One effect at first; if none is enough, pairs and triples are built on the best ones, and what turns
out not to be needed is dropped again. A set is an answer only if nothing is left that the detector
sees. Several answers that the recordings do not tell apart are all given; none is "unknown".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.detect import Span, detector
from meso_robust.diagnosis.refit import Refit, refined, refitted
from meso_robust.diagnosis.show import Errors
from meso_robust.diagnosis.signatures import Signature, estimate
from meso_robust.diagnosis.store import NOWHERE, Store
from meso_robust.simulator.catalogue import CATALOGUE

Floats = npt.NDArray[np.float64]
Told = Callable[[str, int, int], None]

_PRIOR = np.log(len(CATALOGUE))  # nats that each further effect of a set costs
_DOUBT = 0.05  # of the probability may be outside the set that is given
_FORMS = 2  # forms of an effect that are refitted
_TRUST = 0.005  # of what the best set explains: how well scores can be known
_MORE = 2.0  # nats by which another set must be better to count as such
_WORSE = 5.0  # nats by which held-out recordings refute an answer
_SAME = 4.0  # σ, root of the sum of squares: motions that no recording here tells apart
_SAME_MOTION = "the same motion as"
_BEHIND = 5.0  # nats behind a set that is not enough, at which an adequate one is so by chance
_SLIGHT = 40.0  # nats, as of 9 σ, that every effect of a set must explain
_BEAM = {True: 2, False: 3}  # sets that a further effect is added to, if quick and if not
_ADDED = {True: 3, False: 5}  # effects that are added to each, those that promise most
_FAR = 25.0  # nats behind the best, at which a set is not built on
_LARGEST = {True: 2, False: 3}  # effects of a set
_CLOSE = {
    True: 0.2,
    False: 0.5,
}  # of the gain of the best, behind it, up to which a search is taken to its end
_HOPELESS = 0.5  # of the best gain, that a linear estimate must reach in a quick search


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidate:
    """A set of effects in the competition.

    Attributes
    ----------
    refit
        The fit.
    choices
        Logarithm of the number of forms that the effects were tried in: the best of many is better
        by chance.
    probability
        Among the sets that were refitted, the plain model among them.
    adequate
        Whether nothing is left that the detector sees; None if not asked.
    p_value
        Of the largest local test of what is left; NaN if not asked.
    rejected
        Why it is no answer; empty if it may be.
    """

    refit: Refit
    choices: float = 0.0
    probability: float = 0.0
    adequate: bool | None = None
    p_value: float = np.nan
    rejected: str = ""

    @property
    def effects(self) -> tuple[str, ...]:
        """Names."""
        return self.refit.effects

    @property
    def score(self) -> float:
        """Log evidence with the prior of a set of this size."""
        return self.refit.gain - _PRIOR * len(self.refit.trials) - self.choices


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Naming:
    """Outcome of the competition.

    Attributes
    ----------
    answers
        Sets that explain the recordings, the most probable first; several if they cannot be told
        apart, none if nothing is adequate.
    best
        The best set, adequate or not; None if no effect helps.
    candidates
        All, the best first.
    """

    answers: tuple[Candidate, ...]
    best: Candidate | None
    candidates: tuple[Candidate, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Contest:
    """What all sets are judged by."""

    baseline: Baseline
    signatures: list[Signature]
    spans: tuple[Span, ...]
    nulls: Floats
    quick: bool
    told: Told
    store: Store = NOWHERE

    def named(self) -> Naming:
        """Let the sets compete."""
        field = self._singles()
        for _ in range(_LARGEST[self.quick] - 1):
            field = self._judged(field)
            if _answers(field):
                break
            more = self._extended(field)
            if not more:
                break
            field = _ranked([*field, *more])
        field = self._pruned(self._judged(field))
        answers = _answers(field)
        return Naming(answers=answers, best=field[0] if field else None, candidates=tuple(field))

    def _singles(self) -> list[Candidate]:
        """Every effect by itself."""
        chosen = self._forms(None, ())
        if self.quick and chosen:
            most = max(promise for promise, _ in chosen)
            chosen = [one for one in chosen if one[0] > _HOPELESS * most - _FAR]
        fits = []
        for done, (_, one) in enumerate(chosen):
            self.told("naming", done, len(chosen))
            fits += self._tried((one,), None)
        return self._refined(_best_of_each(fits))

    def _choices(self, effect: str) -> float:
        return float(np.log(sum(one.trial.effect == effect for one in self.signatures)))

    def _tried(self, chosen: tuple[Signature, ...], start: Refit | None) -> list[Refit]:
        """A rough fit of a set; none where its search leaves what can be simulated."""
        try:
            return [refitted(self.baseline, chosen, start=start, store=self.store)]
        except (ValueError, np.linalg.LinAlgError):
            return []

    def _ended(self, one: Refit) -> Refit:
        """A fit with its search taken to the end; as it was where that fails or is no better."""
        try:
            more = refined(self.baseline, self._chosen(one), one, store=self.store)
        except (ValueError, np.linalg.LinAlgError):
            return one
        return more if more.gain >= one.gain else one

    def _refined(self, fits: list[Refit]) -> list[Candidate]:
        """Candidates; those that may win have their searches taken to the end."""
        best = max((one.gain for one in fits), default=0.0)
        close = best - max(_FAR, _CLOSE[self.quick] * best)
        return _ranked(
            [
                Candidate(
                    choices=sum(self._choices(trial.effect) for trial in one.trials),
                    refit=self._ended(one) if one.gain > max(close, 0.0) else one,
                )
                for one in fits
            ]
        )

    def _forms(
        self, start: Refit | None, without: tuple[str, ...]
    ) -> list[tuple[float, Signature]]:
        """The most promising forms of every effect, with what a linear estimate promises."""
        at = start.tangent if start else self.baseline.tangent
        rows = start.rows if start else self.baseline.rows
        evidence = at.evidence(rows)
        promised: dict[str, list[tuple[float, Signature]]] = {}
        for one in self.signatures:
            if one.trial.effect in without:
                continue
            left = one.left(at)
            if not np.any(left):
                continue
            gain = 0.5 * estimate(evidence, left, one.one_sided)[1]
            promised.setdefault(one.trial.effect, []).append((gain, one))
        most = 1 if self.quick else _FORMS
        return [
            pair
            for own in promised.values()
            for pair in sorted(own, key=lambda pair: -pair[0])[:most]
        ]

    def _extended(self, field: list[Candidate]) -> list[Candidate]:
        """Sets with one effect more, built on the best of the largest ones."""
        size = max(len(one.refit.trials) for one in field)
        bases = [one for one in field if len(one.refit.trials) == size][: _BEAM[self.quick]]
        known = {one.effects for one in field}
        fits: list[Refit] = []
        for base in bases:
            forms = self._forms(base.refit, base.effects)
            best: dict[str, tuple[float, Signature]] = {}
            for gain, one in sorted(forms, key=lambda pair: pair[0]):
                best[one.trial.effect] = (gain, one)
            for _, one in sorted(best.values(), key=lambda pair: -pair[0])[: _ADDED[self.quick]]:
                names = tuple(sorted((*base.effects, one.trial.effect)))
                if names in known:
                    continue
                known.add(names)
                self.told("naming sets", len(fits), _BEAM[self.quick] * _ADDED[self.quick])
                fits += self._tried((*self._chosen(base.refit), one), base.refit)
        return self._refined(fits)

    def _chosen(self, base: Refit) -> tuple[Signature, ...]:
        """Signatures of the effects of a set, in its order."""
        return tuple(
            next(one for one in self.signatures if one.trial is trial) for trial in base.trials
        )

    def _judged(self, field: list[Candidate]) -> list[Candidate]:
        """Probabilities, duplicates, and whether the likely sets are adequate."""
        field = _without_duplicates(_with_probabilities(field))
        best = max((one.score for one in field if not one.rejected), default=0.0)
        asked = [
            self._asked(one) if not one.rejected and one.score > best - _FAR else one
            for one in field
        ]
        return [_supported(one, asked) for one in asked]

    def _asked(self, one: Candidate) -> Candidate:
        """The set with what the detector says of it."""
        if one.adequate is not None:
            return one
        if one.score <= 0.0:
            return replace(one, adequate=False, rejected="no better than the plain model")
        files = self.baseline.prepared.files
        tests = detector(one.refit.tangent, self.signatures, self.spans, files)
        found = tests.detection(one.refit.rows, self.nulls)
        adequate = not found.detected
        why = "" if adequate else f"leaves a mismatch ({found.tests[0].name})"
        return replace(one, adequate=adequate, p_value=found.p_value, rejected=why)

    def _pruned(self, field: list[Candidate]) -> list[Candidate]:
        """Drop answers that contain a smaller adequate set of about the same evidence."""
        answers = [one for one in field if one.adequate and not one.rejected]
        pruned = []
        for one in field:
            smaller = [
                other
                for other in answers
                if set(other.effects) < set(one.effects) and other.score > one.score - _MORE
            ]
            if smaller and not one.rejected:
                one = replace(one, rejected=f"{' + '.join(smaller[0].effects)} is enough")
            pruned.append(one)
        return pruned


def _supported(one: Candidate, field: list[Candidate]) -> Candidate:
    """An adequate set, unless another law would do as well.

    A set that is beaten by one that is not enough is adequate by chance. And a further effect that
    mends little is what any law could mend: among so many pairs some always does.
    """
    if not one.adequate or one.rejected:
        return one
    top = max((o for o in field if not o.rejected.startswith(_SAME_MOTION)), key=lambda o: o.score)
    if one.score < top.score - _BEHIND * max(1.0, _TRUST * top.score):
        ahead = top.score - one.score
        names = " + ".join(top.effects)
        return replace(one, rejected=f"{names} is {ahead:.0f} nats likelier, and not enough")
    parts = [o.score for o in field if set(o.effects) < set(one.effects)]
    mended = one.score - max(parts, default=0.0)
    if len(one.effects) > 1 and mended < _SLIGHT:
        return replace(
            one, rejected=f"one of them mends {mended:.0f} nats only, as another law might"
        )
    return one


def _best_of_each(fits: list[Refit]) -> list[Refit]:
    """The best form of every set."""
    best: dict[tuple[str, ...], Refit] = {}
    for one in fits:
        if one.effects not in best or one.gain > best[one.effects].gain:
            best[one.effects] = one
    return list(best.values())


def _ranked(field: list[Candidate]) -> list[Candidate]:
    return sorted(field, key=lambda one: -one.score)


def _with_probabilities(field: list[Candidate]) -> list[Candidate]:
    """Bayes' rule among the sets and the plain model, whose score is 0.

    Differences that are small against what is explained may be the simulator's and count less.
    """
    scores = np.array([one.score for one in field])
    top = max(0.0, float(scores.max(initial=0.0)))
    doubt = max(1.0, _TRUST * top)
    weights = np.exp((scores - top) / doubt)
    total = float(weights.sum() + np.exp(-top / doubt))
    return _ranked(
        [
            replace(one, probability=float(weight / total))
            for one, weight in zip(field, weights, strict=True)
        ]
    )


def _without_duplicates(field: list[Candidate]) -> list[Candidate]:
    """Mark sets that make the motion of a simpler one with more numbers."""
    kept: list[Candidate] = []
    for one in sorted(field, key=lambda one: (one.refit.numbers, -one.score)):
        same = [
            other
            for other in kept
            if not other.rejected
            and other.refit.numbers < one.refit.numbers
            and one.score < other.score
            and np.linalg.norm(one.refit.rows - other.refit.rows) < _SAME
        ]
        if same and not one.rejected:
            one = replace(one, rejected=f"{_SAME_MOTION} {' + '.join(same[0].effects)}")
        kept.append(one)
    return _ranked(kept)


def _answers(field: list[Candidate]) -> tuple[Candidate, ...]:
    """The adequate sets that hold all but a little of the probability."""
    able = [one for one in field if one.adequate and not one.rejected]
    total = sum(one.probability for one in able)
    given, sum_of = [], 0.0
    for one in _ranked(able):
        given.append(one)
        sum_of += one.probability
        if sum_of >= (1.0 - _DOUBT) * total:
            break
    return tuple(given)


def judged(naming: Naming, before: Errors, each: tuple[Errors, ...]) -> Naming:
    """The answers that recordings no fit has seen do not refute.

    Parameters
    ----------
    naming
        Outcome of the competition.
    before, each
        Errors on held-out recordings of the plain model, and of every answer.
    """
    if not each:
        return naming
    plain = -0.5 * float(np.sum(before.rows**2))
    scores = np.array([-0.5 * float(np.sum(one.rows**2)) for one in each])
    best = max(float(scores.max()), plain)
    refuted = {
        one.effects: f"held-out recordings are {best - score:.1f} nats likelier without it"
        for one, score in zip(naming.answers, scores, strict=True)
        if score < best - _WORSE
    }
    answers = tuple(one for one in naming.answers if one.effects not in refuted)
    candidates = tuple(
        replace(one, rejected=refuted.get(one.effects, one.rejected)) for one in naming.candidates
    )
    return replace(naming, answers=answers, candidates=candidates)


def partial(naming: Naming, before: Errors, each: tuple[Errors, ...]) -> Naming:
    """Of a mismatch that nothing explains, the part that carries over to held-out recordings.

    Parameters
    ----------
    naming
        Outcome of the competition, without an answer.
    before, each
        Errors on held-out recordings of the plain model, and of the first candidates.
    """
    best = min(range(len(each)), key=lambda k: each[k].whole, default=None)
    if best is None or each[best].whole >= before.whole:
        return replace(naming, best=None)
    return replace(naming, best=naming.candidates[best])
