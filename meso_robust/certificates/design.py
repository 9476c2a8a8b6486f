"""Design: the spacing of the tips, the push offsets and the travels that bear most uncertainty.

Two searches, one inside the other. For every spacing the planner is asked for a plan that is robust
under ever larger uncertainties; around the best one of all, the offsets and travels of its moves are
then varied one by one, and a change is kept if the plan is still PROVED at a larger factor. A search
finds, it does not prove that nothing better exists; every factor that it reports is certified.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.errors import NotApplicableError
from meso_robust.planning.compose import robust_at
from meso_robust.primitives.move import Aim, MoveRule, Point
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task
from meso_robust.wording import down

GROWTH = 1.05  # of the uncertainties, from one plan of a spacing to the next
LARGEST = 8.0  # factors beyond it are not tried
SPACING_STEPS = (0.08, 0.04, 0.02)  # shares of the spacing, coarse to fine
OFFSET_STEPS_UM = (4.0, 24.0)
WORTH = (1.02, 1.005)  # how much more is asked for at a time
RESOLUTION = 0.005

Rules = tuple[MoveRule, ...]
_NONE: tuple[float, Rules] = (0.0, ())


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """The best plan found, and what was tried."""

    task: Task
    """The task with the chosen spacing."""
    rules: Rules
    factor: float
    """All uncertainties can be scaled by it; 0 if no plan was found."""
    tried: tuple[tuple[float, float], ...]
    """(spacing in um, factor of the planner's own plan) in the order of the search."""


def design(task: Task, tell: Callable[[str], None] = lambda _: None) -> Design:
    """Search the design with the widest certified margin.

    Parameters
    ----------
    task
        What to plan for; its ``tip_spacing_um`` is where the search starts.
    tell
        Called with the progress of the search.

    Returns
    -------
    Design
        The task with the spacing found, its plan and the factor that it bears.

    Raises
    ------
    NotApplicableError
        No primitive can handle the task, or no spacing that was tried has a robust plan.
    """
    found: dict[float, tuple[float, Rules]] = {}

    def factor_of(spacing: float) -> float:
        if spacing not in found:
            found[spacing] = _planned(_with(task, spacing))
            tell(f"spacing {spacing:g} um: margin x {down(found[spacing][0], 3)}")
        return found[spacing][0]

    best = task.probe.tip_spacing_um
    factor_of(best)
    for share in SPACING_STEPS:
        step = round(share * task.probe.tip_spacing_um, 1)
        best = _climb(best, step, factor_of)
    factor, rules = found[best]
    if not rules:
        raise NotApplicableError(
            f"no robust plan was found for a tip spacing of {min(found):g} ... {max(found):g} um; "
            "narrow the uncertainties or start from another spacing"
        )
    chosen = _with(task, best)
    rules, factor = _refined(rules, chosen, factor, tell)
    tried = tuple((spacing, value) for spacing, (value, _) in found.items())
    return Design(task=chosen, rules=rules, factor=factor, tried=tried)


def _climb(best: float, step: float, factor_of: Callable[[float], float]) -> float:
    """Go up by steps as long as that helps, one way or the other."""
    for way in (step, -step):
        while best + way > 0.0 and factor_of(round(best + way, 1)) > factor_of(best):
            best = round(best + way, 1)
    return best


def _with(task: Task, spacing: float) -> Task:
    probe = task.probe.model_copy(update={"tip_spacing_um": spacing})
    return task.model_copy(update={"probe": probe})


def _planned(task: Task) -> tuple[float, Rules]:
    """The planner's plan for the largest uncertainties that it still finds one for."""
    scale, best = 1.0, _NONE
    while scale < LARGEST:
        rules = robust_at(task, scale)
        if rules is None:
            break
        best = max(best, (_bears(rules, task, scale), rules), key=lambda one: one[0])
        scale = max(best[0], scale) * GROWTH
    return best


def _proved(rules: Sequence[MoveRule], task: Task, factor: float) -> bool:
    return certify(rules, setup_of(task, factor), whole=False).verdict is Verdict.PROVED


def _bears(rules: Sequence[MoveRule], task: Task, known: float) -> float:
    """Largest factor found at which the plan is PROVED, from ``known`` on; 0 if not even there."""
    if not _proved(rules, task, known):
        return 0.0
    good, bad = known, known * 1.1
    while bad < LARGEST and _proved(rules, task, bad):
        good, bad = bad, bad * 1.1
    while bad - good > RESOLUTION * good:
        trial = 0.5 * (good + bad)
        good, bad = (trial, bad) if _proved(rules, task, trial) else (good, trial)
    return good


def _refined(
    rules: Rules, task: Task, factor: float, tell: Callable[[str], None]
) -> tuple[Rules, float]:
    """Ask for a little more again and again, and repair the moves that do not bear it."""
    for more in WORTH:
        repaired = _repaired(rules, task, factor * more)
        while repaired is not None and factor < LARGEST:
            rules, factor = repaired, _bears(repaired, task, factor * more)
            tell(f"offsets and travels varied: margin x {down(factor, 3)}")
            repaired = _repaired(rules, task, factor * more)
    return rules, factor


def _repaired(rules: Rules, task: Task, factor: float) -> Rules | None:
    """Change moves until all are proved at ``factor``; None if that fails.

    From the first move that is not proved on, one number is changed, of that move or of one before
    it, or two numbers of that move; a change is kept if one move more is proved.
    """
    reach = _reach(rules, task, factor)
    while reach <= len(rules):
        at = min(reach, len(rules) - 1)
        better = next(
            (
                (trial, beyond)
                for trial in itertools.chain(_varied(rules, at), _varied_twice(rules, at))
                if (beyond := _reach(trial, task, factor)) > reach
            ),
            None,
        )
        if better is None:
            return None
        rules, reach = better
    return rules


def _reach(rules: Rules, task: Task, factor: float) -> int:
    """How many moves from the first on are proved; one more if the last one ends in the goal."""
    chain = certify(rules, setup_of(task, factor), whole=False)
    moves = sum(step.verdict is Verdict.PROVED for step in chain.steps)
    return moves + (chain.verdict is Verdict.PROVED)


def _varied(rules: Rules, last: int) -> Iterator[Rules]:
    """Every plan in which one number of one move up to the ``last`` is changed, last move first."""
    for k in range(last, -1, -1):
        for changed in _neighbours(rules[k]):
            yield (*rules[:k], changed, *rules[k + 1 :])


def _varied_twice(rules: Rules, k: int) -> Iterator[Rules]:
    """Every plan in which two numbers of move ``k`` are changed."""
    for once in _neighbours(rules[k]):
        for twice in _neighbours(once):
            yield (*rules[:k], twice, *rules[k + 1 :])


def _neighbours(rule: MoveRule) -> Iterator[MoveRule]:
    for step in OFFSET_STEPS_UM:
        for way in (step, -step):
            yield from _changes(rule, way)


def _changes(rule: MoveRule, by: float) -> Iterator[MoveRule]:
    """A move with its start, its height, its end or its passive tip shifted by ``by`` um."""
    yield replace(rule, dual=replace(rule.dual, x=_shifted(rule.dual.x, by)))
    yield replace(rule, dual=replace(rule.dual, y=_shifted(rule.dual.y, by)))
    yield replace(rule, dual_end=_shifted(rule.dual_end, by))
    if rule.single is not None:
        single: Point = rule.single
        yield replace(rule, single=replace(single, x=_shifted(single.x, by)))
        yield replace(rule, single=replace(single, y=_shifted(single.y, by)))
        both = replace(rule.dual, y=_shifted(rule.dual.y, by))
        yield replace(rule, dual=both, single=replace(single, y=_shifted(single.y, by)))


def _shifted(aim: Aim, by: float) -> Aim:
    return replace(aim, offset_um=round(aim.offset_um + by, 1))
