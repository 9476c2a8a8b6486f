"""Sets of effects against each other: what each scores, which are the same, and which may answer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.diagnosis.refit import Refit
from meso_robust.diagnosis.rejection import Ground, Rejection
from meso_robust.simulator.catalogue import CATALOGUE, family_of

_PRIOR_NATS = np.log(len(CATALOGUE))  # of each further effect: one of the catalogue was picked
EXAMINED_NATS = 25.0
"""Behind the best, beyond which a set is neither refined nor asked: e²⁵ times less likely."""
# of the probability may be outside the answers
_UNCLAIMED_SHARE = 0.05
# by which an image must be likelier turned or scaled about the very origin of the stage than about a place: nobody has
# put it there, and what a tracker is off by throughout moves it
_PLACE_NATS = 3.0
SCORE_SHARE = 0.005
"""Of what a set explains: how well a simulator of finite steps knows scores."""
SPECIAL_CASE = {"camera_anisotropy": "camera_scale", "uneven_support": "dry_friction"}
"""Of a law with more parameters: one that explains as much is the answer, and the general one no rival."""
_SUPERSET_NATS = 2.0  # by which a larger set must be better than a part of it
_SAME_MOTION_SIGMA = 4.0  # of all frames together, up to which no recording tells two motions apart
# behind a set that is not enough, at which an adequate one is so by chance
_BY_CHANCE_NATS = 5.0
# that every effect of a set must explain, ½ (9 σ)²: less is what any law could explain
_MEMBER_NATS = 40.0


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
        Why it cannot be the answer; None if it may be.
    """

    refit: Refit
    choices: float = 0.0
    probability: float = 0.0
    adequate: bool | None = None
    p_value: float = np.nan
    rejected: Rejection | None = None

    @property
    def effects(self) -> tuple[str, ...]:
        """Names."""
        return self.refit.effects

    @property
    def duplicate(self) -> bool:
        """Whether it was set aside for making the motion of a simpler set."""
        return self.rejected is not None and self.rejected.ground is Ground.SAME_MOTION

    @property
    def score(self) -> float:
        """Log evidence with the prior of a set of this size."""
        return self.refit.gain - _PRIOR_NATS * len(self.refit.trials) - self.choices


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
    further
        Makes sets with one effect more than a set that leaves something.
    """

    answers: tuple[Candidate, ...]
    best: Candidate | None
    candidates: tuple[Candidate, ...]
    further: Callable[[Candidate], Sequence[Candidate]] = lambda _: ()

    @property
    def chosen(self) -> Candidate | None:
        """The set that the recordings are predicted with: the first answer, or else the best."""
        return self.answers[0] if self.answers else self.best


def other_forms(one: Candidate, naming: Naming) -> tuple[Candidate, ...]:
    """A set with other forms of its laws, those that the fits leave open beside the likeliest set.

    Parameters
    ----------
    one
        Of the competition.
    naming
        Its outcome.

    Returns
    -------
    tuple
        The likeliest first. The detector was not asked of them.
    """
    top = max(each.score for each in naming.candidates)
    least = top - max(EXAMINED_NATS, SCORE_SHARE * top)
    own = one.refit
    made = (
        replace(
            one,
            refit=replace(
                form,
                others=(replace(own, others=()), *(of for of in own.others if of is not form)),
            ),
            adequate=None,
            p_value=np.nan,
            rejected=None,
        )
        for form in own.others
    )
    return tuple(each for each in made if each.score >= least)


def exchanged(naming: Naming, turned: Mapping[tuple[str, ...], Candidate]) -> Naming:
    """An outcome with some sets, by their effects, in another form."""

    def of(one: Candidate) -> Candidate:
        return turned.get(one.effects, one)

    return replace(
        naming,
        answers=tuple(map(of, naming.answers)),
        best=naming.best and of(naming.best),
        candidates=tuple(map(of, naming.candidates)),
    )


def why_not(one: Candidate, naming: Naming) -> Rejection | None:
    """Why a set of the competition is no answer; None if it is one."""
    if one.effects in {answer.effects for answer in naming.answers}:
        return None
    if one.rejected:
        return one.rejected
    if one.adequate:
        return Rejection(ground=Ground.IMPROBABLE, amount=100 * _UNCLAIMED_SHARE)
    ahead = max(naming.candidates, key=lambda other: other.score)
    return Rejection(ground=Ground.FAR_BEHIND, names=ahead.effects, amount=ahead.score - one.score)


def supported(one: Candidate, field: list[Candidate]) -> Candidate:
    """An adequate set, unless another law would do as well.

    A set that is beaten by one that is not enough is adequate by chance. And a further effect that
    explains little is what any law could explain: among so many pairs some always does.
    """
    if not one.adequate or one.rejected:
        return one
    top = max((o for o in field if not o.duplicate), key=lambda o: o.score)
    if one.score < top.score - _BY_CHANCE_NATS * max(1.0, SCORE_SHARE * top.score):
        ahead = top.score - one.score
        return replace(
            one, rejected=Rejection(ground=Ground.OUTSCORED, names=top.effects, amount=ahead)
        )
    parts = [o.score for o in field if set(o.effects) < set(one.effects)]
    explained = one.score - max(parts, default=0.0)
    if len(one.effects) > 1 and explained < max(_MEMBER_NATS, SCORE_SHARE * one.score):
        return replace(one, rejected=Rejection(ground=Ground.SLIGHT_MEMBER, amount=explained))
    return one


def best_of_each(fits: list[Refit]) -> list[Refit]:
    """The best form of every set, with the best of each other form of its laws."""
    sets: dict[tuple[str, ...], list[Refit]] = {}
    for one in sorted(fits, key=lambda one: -one.gain):
        sets.setdefault(one.effects, []).append(one)
    return [_leading(own) for own in sets.values()]


def _leading(own: list[Refit]) -> Refit:
    best, *rest = own
    general = next((one for one in rest if _with_a_place(one, best)), None)
    if general is not None and general.gain > best.gain - _PLACE_NATS:
        best, rest = general, [best, *(one for one in rest if one is not general)]
    others: dict[tuple[float, ...], Refit] = {}
    for one in rest:
        others.setdefault(_laws(one), one)
    others.pop(_laws(best), None)
    return replace(best, others=tuple(others.values()))


def _laws(one: Refit) -> tuple[float, ...]:
    """Numbers of the forms of the laws of a set."""
    return tuple(trial.law for trial in one.trials)


def _with_a_place(one: Refit, best: Refit) -> bool:
    """Whether a form is another one with the place of the image's turn or scale as numbers more."""
    more = {(trial.effect, key) for trial in one.trials for key in trial.scales}
    less = {(trial.effect, key) for trial in best.trials for key in trial.scales}
    return less < more and all(key.startswith("about_") for _, key in more - less)


def ranked(field: list[Candidate]) -> list[Candidate]:
    """By score, the best first."""
    return sorted(field, key=lambda one: -one.score)


def with_probabilities(field: list[Candidate]) -> list[Candidate]:
    """Bayes' rule among the sets and the plain model, whose score is 0.

    Differences that are small against what is explained may be the simulator's and count less.
    """
    scores = np.array([one.score for one in field])
    top = max(0.0, float(scores.max(initial=0.0)))
    doubt = max(1.0, SCORE_SHARE * top)
    weights = np.exp((scores - top) / doubt)
    total = float(weights.sum() + np.exp(-top / doubt))
    return ranked(
        [
            replace(one, probability=float(weight / total))
            for one, weight in zip(field, weights, strict=True)
        ]
    )


def without_duplicates(field: list[Candidate]) -> list[Candidate]:
    """Mark sets that make the motion of a simpler one with more numbers.

    Two single effects leave open which it is unless one is a limit of the other: that it has a number less does not
    tell.
    """
    kept: list[Candidate] = []
    for one in sorted(field, key=lambda one: (one.refit.numbers, -one.score)):
        same = [
            other
            for other in kept
            if not other.rejected
            and other.refit.numbers < one.refit.numbers
            and one.score < other.score
            and (len(one.effects) > 1 or _limit(one.effects[0], other.effects[0]))
            and np.linalg.norm(one.refit.rows - other.refit.rows) < _SAME_MOTION_SIGMA
        ]
        if same and not one.rejected:
            one = replace(one, rejected=Rejection(ground=Ground.SAME_MOTION, names=same[0].effects))
        kept.append(one)
    return ranked(kept)


def _limit(general: str, special: str) -> bool:
    """Whether an effect is a limit of another one: all friction of solids is dry friction at one speed."""
    dry = special == "dry_friction" and family_of(general) == family_of(special)
    return dry or SPECIAL_CASE.get(general) == special


def freed(field: list[Candidate]) -> list[Candidate]:
    """Duplicates of a set that turned out not to be enough may yet answer."""
    short = {one.effects for one in field if one.adequate is False}
    return [
        replace(one, rejected=None)
        if one.duplicate and one.rejected is not None and one.rejected.names in short
        else one
        for one in field
    ]


def answers_of(field: list[Candidate]) -> tuple[Candidate, ...]:
    """The adequate sets that hold all but a little of the probability."""
    able = [one for one in field if one.adequate and not one.rejected]
    total = sum(one.probability for one in able)
    given, sum_of = [], 0.0
    for one in ranked(able):
        given.append(one)
        sum_of += one.probability
        if sum_of >= (1.0 - _UNCLAIMED_SHARE) * total:
            break
    return tuple(given)


def pruned(field: list[Candidate]) -> list[Candidate]:
    """Reject answers that contain a smaller adequate set of about the same evidence."""
    answers = [one for one in field if one.adequate and not one.rejected]
    kept = []
    for one in field:
        smaller = [
            other
            for other in answers
            if set(other.effects) < set(one.effects) and other.score > one.score - _SUPERSET_NATS
        ]
        if smaller and not one.rejected:
            one = replace(
                one, rejected=Rejection(ground=Ground.SUBSET_SUFFICES, names=smaller[0].effects)
            )
        kept.append(one)
    return kept
