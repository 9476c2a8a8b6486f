"""Which physics was left out: sets of effects compete by their evidence, and must be adequate.

One effect at first; if none is enough, pairs and triples are built on the best ones, and what turns
out not to be needed is dropped again. A set is an answer only if nothing is left that the detector
sees. Several answers that the recordings do not tell apart are all given; none is "unknown".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from meso_robust.copies import shared
from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.candidates import (
    EXAMINED_NATS,
    Candidate,
    Naming,
    answers_of,
    best_of_each,
    freed,
    pruned,
    ranked,
    supported,
    with_probabilities,
    without_duplicates,
)
from meso_robust.diagnosis.detect import Detection, Span, detector
from meso_robust.diagnosis.refit import Refit, ahead, refined, refitted
from meso_robust.diagnosis.rejection import Ground, Rejection
from meso_robust.diagnosis.signatures import Signature, estimate, lefts
from meso_robust.diagnosis.store import Store
from meso_robust.identification.identify import Told
from meso_robust.recordings.direct.finding import Finding
from meso_robust.types import Floats

_REFITTED_FORMS = 2  # of an effect, those that promise most
_EXTENDED_SETS = {True: 8, False: 12}  # that a further effect may be added to, if quick and if not
_SETS = {True: 6, False: 15}  # with one effect more, that are refitted, those that promise most
_OTHERS = 3  # further ones that are kept, those that gain most in a rough fit
_CROSSED = (
    4  # effects that gain most beside the best one, and best ones that each of them is tried beside
)
_LARGEST_SET = {True: 2, False: 3}  # effects of a set, if quick and if not
# of the best gain, behind it, within which a rough fit is taken to its end
_REFINED_SHARE = {True: 0.2, False: 0.5}
# likewise, of another form of the same law
_FORM_SHARE = 0.02
# times the sizes that a signature was made with, beyond which nothing is linear any more
_LINEAR_SIZES = 10.0
# of the best rough fit, that one behind its own linear estimate has, to be taken to its end
_UNFINISHED_SHARE = 0.3
_DOWN_TO = 2.0  # squared error over the noise, up to which a fit explains all but a little
# of the best gain so far, that a linear estimate must reach in a quick search
_PROMISING_SHARE = 0.5
_AT_ONCE = (
    2  # single effects that are fitted before the next ones are held against the best of them
)
_FURTHER = 6  # effects that are tried beside a set that leaves something


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Form:
    """A form of an effect, and what a linear estimate promises of it.

    Attributes
    ----------
    gain
        In nats.
    signature
        Of the form.
    linear
        Whether the estimate can be relied on. It cannot where the form has no sizes and is only where
        a search begins, and not where it asks for far more than the signature was made with: friction
        that no tip feels until it slips shows in its signature not at all.
    """

    gain: float
    signature: Signature
    linear: bool


def _other_law(form: Form, fits: Sequence[Refit]) -> bool:
    """Whether a form is of the effect that is likeliest so far, with a law that was not fitted: which law it is is asked, too."""
    trial = form.signature.trial
    best = max(fits, key=lambda fit: fit.gain, default=None)
    own = [one.trials[0].law for one in fits if one.effects == (trial.effect,)]
    return best is not None and best.effects == (trial.effect,) and trial.law not in own


@dataclass(frozen=True, slots=True, eq=False)
class Contest:
    """What all sets are judged by."""

    baseline: Baseline
    signatures: list[Signature]
    spans: tuple[Span, ...]
    nulls: Floats
    quick: bool
    told: Told
    store: Store = field(default_factory=lambda: Store(None, ""))
    findings: tuple[Finding, ...] = ()
    beside: tuple[Signature, ...] = ()

    def named(self) -> Naming:
        """Let the sets compete."""
        field = self._singles()
        for _ in range(_LARGEST_SET[self.quick] - 1):
            field = self._judged(field)
            if answers_of(field):
                break
            more = self._extended(field)
            if not more:
                break
            field = ranked([*field, *more])
        field = pruned(self._judged(field))
        answers = answers_of(field)
        return Naming(
            answers=answers,
            best=field[0] if field else None,
            candidates=tuple(field),
            further=partial(self.further, field),
        )

    def _singles(self) -> list[Candidate]:
        """Every effect by itself."""
        chosen = sorted(self._forms(None, ()), key=lambda form: -form.gain)
        most = max((form.gain for form in chosen if form.linear), default=0.0)
        noise = _DOWN_TO * float(np.count_nonzero(self.baseline.seen))
        fits: list[Refit] = []
        short: set[int] = set()
        for done, form in enumerate(chosen):
            self.told("naming", done, len(chosen))
            best = max((fit.gain for fit in fits), default=0.0)
            if all(fit.chi2 > noise for fit in fits):
                # of what nothing explains yet, a linear estimate promises a part only
                best = min(best, most)
            if done % _AT_ONCE == 0:
                near = [one for one in chosen[done : done + _AT_ONCE] if self._promises(one, best)]
                ahead(self.baseline, self.store, rough=[((one.signature,), None) for one in near])
            if not (self._promises(form, best) or _other_law(form, fits)):
                continue
            tried = self._tried((form.signature,), None)
            short |= {id(fit) for fit in tried if fit.gain < form.gain}
            fits += tried
        best = max((fit.gain for fit in fits), default=0.0)
        # a strong effect may need more steps than a rough fit has only to get as far as a linear estimate
        poor = [one for one in fits if id(one) in short and one.gain > _UNFINISHED_SHARE * best]
        ended = self._all_ended(poor)
        return self._refined([ended.get(id(one), one) for one in fits], list(ended.values()))

    def _promises(self, form: Form, best: float) -> bool:
        """Whether a form is worth a fit, beside the best so far."""
        least = _PROMISING_SHARE * best - EXAMINED_NATS
        return not (self.quick and form.linear and form.gain <= least)

    def _choices(self, effect: str) -> float:
        every = (*self.signatures, *self.beside)
        return float(np.log(sum(one.trial.effect == effect for one in every)))

    def _tried(self, chosen: tuple[Signature, ...], start: Refit | None) -> list[Refit]:
        """A rough fit of a set; none where its search leaves what can be simulated."""
        try:
            return [refitted(self.baseline, chosen, start=start, store=self.store)]
        except (ValueError, np.linalg.LinAlgError):
            return []

    def _ended(self, one: Refit) -> Refit:
        """A fit with its search taken to the end; as it was where that fails or is no better.

        Of a search that is not at its end the gain is what one more linear step promises, which may be more than
        there is to be had.
        """
        try:
            more = refined(self.baseline, self._chosen(one), one, store=self.store)
        except (ValueError, np.linalg.LinAlgError):
            return one
        lower = bool(more.fits.chi2[0] < one.fits.chi2[0])
        return replace(more, others=one.others) if lower or more.gain >= one.gain else one

    def _all_ended(self, fits: list[Refit]) -> dict[int, Refit]:
        """By the identity of a rough fit, what `_ended` makes of it."""
        ahead(self.baseline, self.store, fine=[(self._chosen(one), one) for one in fits])
        return {id(one): self._ended(one) for one in fits}

    def _refined(self, fits: list[Refit], done: Sequence[Refit] = ()) -> list[Candidate]:
        """Candidates, the best form of each set; those that may win have their searches taken to the end.

        Searches of those that are ``done`` are at their end.
        """
        best = max((one.gain for one in fits), default=0.0)
        close = best - max(EXAMINED_NATS, _REFINED_SHARE[self.quick] * best)
        led = {one.effects: one.gain for one in sorted(fits, key=lambda one: one.gain)}
        # a form with more numbers may be behind until its search is at its end
        near = [
            one
            for one in fits
            if not any(one is other for other in done)
            and one.gain > max(close, 0.0)
            and one.gain >= led[one.effects] - max(EXAMINED_NATS, _FORM_SHARE * best)
        ]
        more = self._all_ended(near)
        ended = [more.get(id(one), one) for one in fits]
        return ranked(
            [
                Candidate(
                    choices=sum(self._choices(trial.effect) for trial in one.trials), refit=one
                )
                for one in best_of_each(ended)
            ]
        )

    def _forms(
        self, start: Refit | None, without: tuple[str, ...], of: Sequence[Signature] | None = None
    ) -> list[Form]:
        """The most promising forms of every effect."""
        at = start.tangent if start else self.baseline.tangent
        rows = start.rows if start else self.baseline.rows
        evidence = at.evidence(rows)
        promised: dict[str, list[Form]] = {}
        tried = [
            one
            for one in (self.signatures if of is None else of)
            if one.trial.effect not in without
        ]
        for one, left in zip(tried, lefts(at, tried), strict=True):
            if not np.any(left):
                continue
            sizes, fall = estimate(evidence, left, one.one_sided)
            linear = bool(one.trial.sizes) and float(np.abs(sizes).max(initial=0.0)) < _LINEAR_SIZES
            form = Form(gain=0.5 * fall, signature=one, linear=linear)
            promised.setdefault(one.trial.effect, []).append(form)
        return [form for own in promised.values() for form in self._first(own)]

    def _first(self, own: list[Form]) -> list[Form]:
        """Of the forms of an effect, those that are refitted: some of every form of its law.

        So are some with other numbers to fit: what a linear estimate promises does not count those of the form.
        """
        most = 1 if self.quick and own[0].signature.trial.sizes else _REFITTED_FORMS
        laws: dict[tuple[float, frozenset[str]], list[Form]] = {}
        for form in sorted(own, key=lambda form: -form.gain):
            trial = form.signature.trial
            laws.setdefault((trial.law, frozenset(trial.free)), []).append(form)
        return [form for law in laws.values() for form in law[:most]]

    def _extended(self, field: list[Candidate]) -> list[Candidate]:
        """Sets with one effect more, those that promise most of all that the best of the largest ones allow.

        Of two effects at once neither need be the best by itself: what a set promises is what its part
        explains and what a linear estimate makes of the effect that is added.
        """
        size = max(len(one.refit.trials) for one in field)
        bases = [one for one in field if len(one.refit.trials) == size]
        promised: dict[tuple[str, ...], tuple[float, Candidate, Signature]] = {}
        for base in bases[: _EXTENDED_SETS[self.quick]]:
            for form in self._forms(base.refit, base.effects):
                names = tuple(sorted((*base.effects, form.signature.trial.effect)))
                whole = base.refit.gain + form.gain
                if names not in promised or promised[names][0] < whole:
                    promised[names] = (whole, base, form.signature)
        known = {one.effects for one in field}
        first = sorted(promised.items(), key=lambda one: -one[1][0])
        unknown = [one for names, one in first if names not in known]
        chosen, rest = unknown[: _SETS[self.quick]], unknown[_SETS[self.quick] :]
        # beside the best one all are tried: what a linear estimate promises may be a tenth of what there is
        asked, more = (
            [((*self._chosen(base.refit), added), base.refit) for _, base, added in of]
            for of in (chosen, [one for one in rest if one[1] is bases[0]])
        )
        fits = self._all_tried("naming sets", [*asked, *more])
        fits += self._all_tried("naming sets", self._crossed(bases, fits, known))
        promising = {tuple(sorted((*base.effects, one.trial.effect))) for _, base, one in chosen}
        others = sorted(
            (one for one in fits if one.effects not in promising), key=lambda one: -one.gain
        )
        kept = [one for one in fits if one.effects in promising]
        return self._refined([*kept, *others[:_OTHERS]])

    def _crossed(
        self, bases: Sequence[Candidate], fits: Sequence[Refit], known: set[tuple[str, ...]]
    ) -> list[tuple[tuple[Signature, ...], Refit]]:
        """Sets not tried yet, of the next best ones and those effects that gain most beside the best one.

        What friction makes of a tip that slips, say, no linear estimate tells while tip and edge are believed to be
        elsewhere: then it gains nothing by itself either, and next to nothing is promised beside what would put them right.
        """
        best, *others = bases[:_CROSSED]
        done = known | {one.effects for one in fits}
        strong = dict.fromkeys(
            name
            for one in sorted(fits, key=lambda one: -one.gain)
            if set(best.effects) < set(one.effects)
            for name in one.effects
            if name not in best.effects
        )
        own = [one for one in self.signatures if one.trial.effect in list(strong)[:_CROSSED]]
        return [
            ((*self._chosen(base.refit), form.signature), base.refit)
            for base in others
            for form in self._forms(base.refit, base.effects, own)
            if tuple(sorted((*base.effects, form.signature.trial.effect))) not in done
        ]

    def further(self, field: Sequence[Candidate], base: Candidate) -> list[Candidate]:
        """Sets with one effect more than one that leaves something.

        Parameters
        ----------
        field
            Sets of the competition, which are not fitted again.
        base
            The set.

        Returns
        -------
        list[Candidate]
            With those effects that gain most in a rough fit, and those that a test without a simulation sees.
        """
        offered = self._forms(base.refit, base.effects, [*self.signatures, *self.beside])
        best: dict[str, Form] = {}
        for form in sorted(offered, key=lambda form: -form.gain):
            best.setdefault(form.signature.trial.effect, form)
        names = {effect: tuple(sorted((*base.effects, effect))) for effect in best}
        known = {one.effects: one for one in field}
        asked = [
            ((*self._chosen(base.refit), form.signature), base.refit)
            for effect, form in best.items()
            if names[effect] not in known
        ]
        fits = {one.effects: one for one in self._all_tried("naming further effects", asked)}
        gains = {of: one.refit.gain for of, one in known.items()}
        gains |= {of: one.gain for of, one in fits.items()}
        able = {effect: gains[of] - base.refit.gain for effect, of in names.items() if of in gains}
        order = sorted(able, key=lambda effect: -able[effect])
        least = _PROMISING_SHARE * able[order[0]] if order and self.quick else -np.inf
        seen = {one.effect for one in self.findings}
        chosen = [
            names[effect]
            for k, effect in enumerate(order)
            if effect in seen or (k < _FURTHER and able[effect] >= least)
        ]
        found = [known[of] for of in chosen if of in known]
        return [*found, *self._refined([fits[of] for of in chosen if of not in known])]

    def _all_tried(
        self, what: str, asked: list[tuple[tuple[Signature, ...], Refit]]
    ) -> list[Refit]:
        """Rough fits of sets, each from a fit of a part of it."""
        self.told(what, 0, len(asked))
        ahead(self.baseline, self.store, rough=asked)
        return [one for of in asked for one in self._tried(*of)]

    def _chosen(self, base: Refit) -> tuple[Signature, ...]:
        """Signatures of the effects of a set, in its order."""
        return tuple(
            next(one for one in (*self.signatures, *self.beside) if one.trial is trial)
            for trial in base.trials
        )

    def _judged(self, field: list[Candidate]) -> list[Candidate]:
        """Probabilities, duplicates, and whether the likely sets are adequate."""
        field = self._all_asked(without_duplicates(with_probabilities(field)))
        asked = self._all_asked(freed(field))
        return [supported(one, asked) for one in asked]

    def _all_asked(self, field: list[Candidate]) -> list[Candidate]:
        """The sets, the likely ones with what the detector says of them."""
        best = max((one.score for one in field if not one.rejected), default=0.0)
        open_ = [
            k
            for k, one in enumerate(field)
            if one.adequate is None and not one.rejected and one.score > best - EXAMINED_NATS
        ]
        # all that the detector says is by the refit, which need not be sent back from a copy
        said = shared(lambda k: self._detection(field[k]), open_)
        told = {k: self._asked(field[k], found) for k, found in zip(open_, said, strict=True)}
        return [told.get(k, one) for k, one in enumerate(field)]

    def _detection(self, one: Candidate) -> Detection | None:
        """What the detector sees of what a set leaves; None of one that explains nothing."""
        if one.score <= 0.0:
            return None
        files = self.baseline.prepared.files
        tests = detector(one.refit.tangent, self.signatures, self.spans, files)
        return tests.detection(one.refit.rows, self.nulls)

    @staticmethod
    def _asked(one: Candidate, found: Detection | None) -> Candidate:
        """The set with what the detector says of it."""
        if found is None:
            return replace(one, adequate=False, rejected=Rejection(ground=Ground.NO_GAIN))
        adequate = not found.detected
        left = Rejection(ground=Ground.MISMATCH_LEFT, names=(found.tests[0].name,))
        return replace(
            one, adequate=adequate, p_value=found.p_value, rejected=None if adequate else left
        )
