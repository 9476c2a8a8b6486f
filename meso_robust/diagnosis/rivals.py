"""Which sets of effects explain as much as the one that was chosen, and what that leaves open."""

from __future__ import annotations

import numpy as np

from meso_robust.diagnosis.candidates import SCORE_SHARE, SPECIAL_CASE, Candidate
from meso_robust.diagnosis.judge import MEMBER_SHARE, Judge
from meso_robust.simulator.catalogue import family_of

_EQUAL_SHARE = 0.9  # of the best set's share, from which on a rival may explain as much
EQUAL_NATS = 5.0  # tempered, up to which recordings do not tell two sets apart
_TEMPERED = 1.5  # squared error over the floor, from which on a likelihood is overconfident
NEARLY_ALL = 0.8  # likewise, of one whose size need not be as sure


def only_law(judge: Judge, chosen: Candidate, rival: Candidate, seed: int) -> bool:
    """Whether a set that explains as much leaves open what law it is, not what it is a law of.

    So do laws of the same physics, alone or beside others. And of several hundred sets of two effects some do by chance
    what one does: of what needs more effects and surely leaves no less, the one effect is told.
    """
    if physics(chosen) <= physics(rival):
        return True
    more = len(rival.effects) > len(chosen.effects)
    return more and not judge.surely_worse(rival.effects, chosen.effects, seed)


def another_law(chosen: Candidate, other: Candidate) -> bool:
    """Whether another set differs only in the laws that it takes for the same physics, and is nearly as likely.

    No law is quite the true one: which of two is nearer on these pushes does not tell which it is.
    """
    near = other.score >= (1.0 - MEMBER_SHARE) * chosen.score
    return near and not other.duplicate and one_physics(chosen, other)


def one_physics(chosen: Candidate, other: Candidate) -> bool:
    """Whether another set differs only in the laws that it takes for the same physics."""
    if other.effects == chosen.effects or len(other.effects) != len(chosen.effects):
        return False
    return physics(other) == physics(chosen)


def law_open(judge: Judge, chosen: Candidate, other: Candidate) -> bool:
    """Whether a set with other laws of the same physics explains as much, up to what one law takes up of another's form."""
    least = judge.share(chosen.effects) - MEMBER_SHARE
    return another_law(chosen, other) and judge.share(other.effects) > least


def physics(one: Candidate) -> set[str]:
    """Pieces of physics that a set holds laws of."""
    return {family_of(name) for name in one.effects}


def holds(general: Candidate, special: Candidate) -> bool:
    """Whether a set holds all laws of another one, each by itself or as a special case of its own."""
    each = {SPECIAL_CASE.get(name, name) for name in general.effects}
    return set(special.effects) <= each.union(general.effects)


def equal(judge: Judge, chosen: Candidate, rival: Candidate, seed: int) -> bool:
    """Whether another set, neither part nor whole of the chosen one, explains as much, and carries over."""
    if holds(rival, chosen) or set(rival.effects) <= set(chosen.effects):
        return False
    if not judge.carries(rival.effects):
        return False
    if law_open(judge, chosen, rival):
        return True
    if behind(judge, chosen, rival, seed):
        return False
    if judge.share(rival.effects) < _EQUAL_SHARE * judge.share(chosen.effects):
        return False
    excess = float(judge.sums(chosen.effects).sum() / judge.floor.sum())
    if chosen.score - rival.score <= EQUAL_NATS * max(excess, 1.0):
        return True
    return excess > _TEMPERED and not judge.surely_worse(chosen.effects, rival.effects, seed)


def behind(judge: Judge, chosen: Candidate, rival: Candidate, seed: int) -> bool:
    """Whether another set is no likelier where both were fitted, and surely leaves much more where neither was.

    Of two laws that are alike where a fit may bend them, other recordings tell; but they are no witness against a law
    that was the likelier one, as one recording may be far off for a number that no other tells. For the same reason
    the chosen one must leave next to nothing beside what the other leaves, and that more than noise makes; but of a
    law of other physics that is no likelier anywhere, what noise makes in both alike is no excuse.
    """
    if rival.score - chosen.score > SCORE_SHARE * chosen.score:
        return False
    own, other = (judge.sums(one.effects) for one in (chosen, rival))
    left, more = (max(float(np.sum(of - judge.floor)), 0.0) for of in (own, other))
    excess = max(float(own.sum() / judge.floor.sum()), 1.0)
    if 0.5 * float(np.sum(other - own)) <= EQUAL_NATS * excess:
        return False
    within = more <= judge.chance and left <= judge.chance
    if within and chosen.score >= rival.score and physics(chosen) != physics(rival):
        return judge.surely_worse(chosen.effects, rival.effects, seed)
    if more <= judge.chance or left > (1.0 - NEARLY_ALL) * more:
        return False
    return judge.surely_worse(chosen.effects, rival.effects, seed)
