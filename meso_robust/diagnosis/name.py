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
from meso_robust.diagnosis.candidates import (
    Candidate,
    Naming,
    answers_of,
    best_of_each,
    pruned,
    ranked,
    supported,
    with_probabilities,
    without_duplicates,
)
from meso_robust.diagnosis.detect import Span, detector
from meso_robust.diagnosis.refit import Refit, refined, refitted
from meso_robust.diagnosis.signatures import Signature, estimate
from meso_robust.diagnosis.store import NOWHERE, Store

Floats = npt.NDArray[np.float64]
Told = Callable[[str, int, int], None]

_FORMS = 2  # forms of an effect that are refitted
_BEAM = {True: 2, False: 3}  # sets that a further effect is added to, if quick and if not
_ADDED = {True: 3, False: 5}  # effects that are added to each, those that promise most
_FAR = 25.0  # nats behind the best, at which a set is not built on
_LARGEST = {True: 2, False: 3}  # effects of a set
_CLOSE = {
    True: 0.2,
    False: 0.5,
}  # of the gain of the best, behind it, up to which a search is taken to its end
_HOPELESS = 0.5  # of the best gain so far, that a linear estimate must reach in a quick search


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
            if answers_of(field):
                break
            more = self._extended(field)
            if not more:
                break
            field = ranked([*field, *more])
        field = pruned(self._judged(field))
        answers = answers_of(field)
        return Naming(answers=answers, best=field[0] if field else None, candidates=tuple(field))

    def _singles(self) -> list[Candidate]:
        """Every effect by itself."""
        chosen = sorted(self._forms(None, ()), key=lambda pair: -pair[0])
        fits: list[Refit] = []
        for done, (promise, one) in enumerate(chosen):
            self.told("naming", done, len(chosen))
            best = max((fit.gain for fit in fits), default=0.0)
            # a form without sizes is only where a search begins: it promises little
            if self.quick and one.trial.sizes and promise <= _HOPELESS * best - _FAR:
                continue
            fits += self._tried((one,), None)
        return self._refined(best_of_each(fits))

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
        return ranked(
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
        return [pair for own in promised.values() for pair in self._first(own)]

    def _first(self, own: list[tuple[float, Signature]]) -> list[tuple[float, Signature]]:
        """Of the forms of an effect, those that are refitted."""
        most = 1 if self.quick and own[0][1].trial.sizes else _FORMS
        return sorted(own, key=lambda pair: -pair[0])[:most]

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
        field = without_duplicates(with_probabilities(field))
        best = max((one.score for one in field if not one.rejected), default=0.0)
        asked = [
            self._asked(one) if not one.rejected and one.score > best - _FAR else one
            for one in field
        ]
        return [supported(one, asked) for one in asked]

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
