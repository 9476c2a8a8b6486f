"""How much more uncertainty the same plan could bear."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import begins, certify
from meso_robust.copies import shared
from meso_robust.primitives.move import Action, MoveRule
from meso_robust.primitives.names import Named
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task
from meso_robust.units import metres

LARGEST = 8.0  # factors beyond it are not tried
RESOLUTION = 0.02
TOGETHER, ALONE = 1.25, 2.0
"""First steps up from what is proved: one uncertainty alone bears about twice as much as all together, and
a factor that is refused is refused early, in a sixth of the time of one that is proved."""
LEAST_ROUND, FIRST_ROUND = 0.01, 0.2
"""Shares of a radius by which it is widened first, and then."""
MOST_OF_SPACING = 0.45
"""Of the distance of the tips: a larger radius leaves no room between them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """What is not proved, and of which move."""

    name: Named
    step: int
    action: Action


@dataclass(frozen=True, slots=True, kw_only=True)
class Margin:
    """Factors by which uncertainties can be scaled about their middle and are still PROVED."""

    factor: float
    """All at once: the plan was certified at this factor (0 if it is not proved even at 1)."""
    refused: float | None
    """The smallest factor tried at which it was not certified; None if ``LARGEST`` was."""
    binding: str | None
    """The uncertainty that bears the least when it is scaled alone."""
    each: dict[str, float]
    """Factor at which the plan was certified when one uncertainty alone was scaled, or all of them."""
    limit: Limit | None
    """What fails first at ``refused``."""
    radii: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Of tips whose radius is stated exactly, so that no factor widens it: um, the range about it for which
    the plan was certified, all else as stated."""


def margin(rules: Sequence[MoveRule], task: Task) -> Margin:
    """Search the margin of a plan that is PROVED for its task, by bisection.

    Parameters
    ----------
    rules, task
        The plan and its task.

    Returns
    -------
    Margin
        Lower bounds of what the plan bears: factors at which it was certified, for one uncertainty with
        that one or all of them scaled.
    """
    names = list(setup_of(task).uncertainty.stated)
    factor, refused = _search(rules, task, None, 1.0, TOGETHER)
    passive = any(rule.single is not None for rule in rules)
    exact = _exact_radii(task, passive) if factor > 0.0 else {}

    def alone(only: str) -> tuple[float, tuple[float, float] | None]:
        # what is proved with all of them scaled is proved with one
        most = _search(rules, task, only, factor, ALONE)[0] if factor > 0.0 else 0.0
        return most, _round(rules, task, only, exact[only]) if only in exact else None

    told = dict(zip(names, shared(alone, names), strict=True))
    each = {name: most for name, (most, _) in told.items()}
    binding = min(each, key=lambda name: each[name]) if factor > 0.0 else None
    return Margin(
        factor=factor,
        refused=refused,
        binding=binding,
        each=each,
        limit=None if refused is None else _limit(rules, task, refused),
        radii={name: ends for name, (_, ends) in told.items() if ends is not None},
    )


def _exact_radii(task: Task, passive: bool) -> dict[str, float]:
    """Radii that the task states as one number above nought, um, by the name of the uncertainty."""
    probe = task.probe
    stated = {"tip_radius": probe.tip_radius_um}
    if passive:
        stated["passive_tip_radius"] = probe.passive_tip_radius_um or probe.tip_radius_um
    return {name: ends[0] for name, ends in stated.items() if ends and ends[0] == ends[1] > 0.0}


def _round(
    rules: Sequence[MoveRule], task: Task, name: str, radius_um: float
) -> tuple[float, float]:
    """The range about a radius, um, in which it may lie alone; that radius only if none was found."""
    most_um = MOST_OF_SPACING * task.probe.tip_spacing_um

    def ends(share: float) -> tuple[float, float]:
        reach = math.floor(10.0 * share * radius_um) / 10.0
        return max(round(radius_um - reach, 3), 0.0), round(radius_um + reach, 3)

    @cache
    def proved(share: float) -> bool:
        low, high = ends(share)
        if high > most_um:
            return False
        setup = setup_of(task)
        wide = metres(low).hull(metres(high))
        setup = replace(setup, uncertainty=replace(setup.uncertainty, **{name: wide}))
        if not begins(rules, setup):
            return False
        return certify(rules, setup, whole=False).verdict is Verdict.PROVED

    least = LEAST_ROUND
    return ends(_bisect(proved, least, FIRST_ROUND / least)[0] if proved(least) else 0.0)


def _search(
    rules: Sequence[MoveRule], task: Task, only: str | None, good: float, first: float
) -> tuple[float, float | None]:
    """Largest factor found at which the plan is proved, at least ``good``; the smallest at which it is not.

    What is refused at a factor is mostly refused by the moves before a rotation, in a fifth of the time of a
    proof. So the bisection goes by these alone first, and the plan is proved where that ends.
    """

    @cache
    def proved(factor: float) -> bool:
        chain = certify(rules, setup_of(task, factor, only), whole=False)
        return chain.verdict is Verdict.PROVED

    @cache
    def hopeful(factor: float) -> bool:
        return begins(rules, setup_of(task, factor, only))

    turns = any(rule.action == "rotate" for rule in rules)
    most, bad = _bisect(hopeful if turns else proved, good, first)
    if most > good and proved(most):
        return most, bad
    if only is None and not proved(good):
        return 0.0, good
    return _bisect(lambda scale: scale < most and hopeful(scale) and proved(scale), good, first)


def _bisect(
    proved: Callable[[float], bool], good: float, first: float
) -> tuple[float, float | None]:
    """Largest factor found at which ``proved`` holds, as at ``good``; the smallest at which it does not."""
    bad = min(first * good, LARGEST)
    while proved(bad):
        if bad >= LARGEST:
            return LARGEST, None
        good, bad = bad, min(bad * 1.6, LARGEST)
    while bad - good > RESOLUTION * good:
        trial = 0.5 * (good + bad)
        if proved(trial):
            good = trial
        else:
            bad = trial
    return good, bad


def _limit(rules: Sequence[MoveRule], task: Task, factor: float) -> Limit:
    step, name, _ = certify(rules, setup_of(task, factor)).first_open
    return Limit(name=name, step=step.rule.step, action=step.rule.action)
