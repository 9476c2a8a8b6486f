"""Certifying a sequence of moves: every step from all poses that the step before can leave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from meso_robust.bounds import Verdict
from meso_robust.primitives.certify import certify_move, may_rotate
from meso_robust.primitives.grid import roomy
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import Named, Reason, about
from meso_robust.primitives.obligation import Obligation, Step
from meso_robust.primitives.setup import PoseBox, Setup


@dataclass(frozen=True, slots=True, kw_only=True)
class Chain:
    """Certified steps of one plan, and what they prove together."""

    steps: tuple[Step, ...]
    """As far as the motion could be enclosed; the last one may be undecided."""
    complete: bool
    """Whether every move of the plan was reached."""
    setup: Setup
    guided: bool = False
    """Whether the part may touch the slot's walls in one of the plan's moves."""

    @property
    def end(self) -> PoseBox | None:
        """All poses after the last move."""
        return self.steps[-1].post if self.complete else None

    @property
    def reaches_goal(self) -> bool:
        """Whether every final pose lies in the goal."""
        return self.end is not None and self.end.within(self.setup.goal)

    @property
    def verdict(self) -> Verdict:
        """PROVED if every step is and the end lies in the goal; else UNKNOWN."""
        proved = all(step.verdict is Verdict.PROVED for step in self.steps)
        return Verdict.PROVED if proved and self.reaches_goal else Verdict.UNKNOWN

    @property
    def first_open(self) -> tuple[Step, Named, Obligation | None]:
        """What is not proved first, with its step: an obligation, or that the plan ends in the goal."""
        found = self.open_obligation
        if found is None:
            return self.steps[-1], about(Reason.ENDS_IN_GOAL), None
        return found[0], found[1].name, found[1]

    @property
    def open_obligation(self) -> tuple[Step, Obligation] | None:
        """The first inequality that is not proved, with its step."""
        for step in self.steps:
            for obligation in step.obligations:
                if obligation.proof.verdict is not Verdict.PROVED:
                    return step, obligation
        return None


def certify(rules: Sequence[MoveRule], setup: Setup, *, whole: bool = True) -> Chain:
    """Certify ``rules`` from every start in ``setup.start``.

    Parameters
    ----------
    rules, setup
        The moves in order, the task.
    whole
        False: stop at the first step that is not proved, and leave out the poses on the way, for a
        search that asks no more.

    Returns
    -------
    Chain
        The steps as far as the motion could be enclosed.

    Notes
    -----
    What a move can leave is widened by a hundredth of its width on either side and to a decimal grid
    before the next one starts from it, so that a checker whose enclosures differ a little meets it.
    """
    state: PoseBox | None = setup.start
    steps: list[Step] = []
    before: Step | None = None
    for rule in rules:
        if state is None or not (whole or all(s.verdict is Verdict.PROVED for s in steps[-1:])):
            break
        before = step = certify_move(rule, state, setup, before, whole=whole)
        if step.post is not None:
            step = replace(step, post=roomy(step.post))
        steps.append(step)
        state = step.post
    complete = 0 < len(steps) == len(rules) and state is not None
    guided = any(rule.action == "guide" for rule in rules)
    return Chain(steps=tuple(steps), complete=complete, setup=setup, guided=guided)


def begins(rules: Sequence[MoveRule], setup: Setup) -> bool:
    """Whether ``rules`` are proved as far as that takes little time: up to where a rotation begins.

    Parameters
    ----------
    rules, setup
        The moves in order, the task. Without a rotation all of them take little time.

    Returns
    -------
    bool
        False: `certify` does not prove them either.
    """
    first = next((k for k, rule in enumerate(rules) if rule.action == "rotate"), len(rules))
    chain = certify(rules[:first], setup, whole=False)
    if first == len(rules):
        return chain.verdict is Verdict.PROVED
    if not all(step.verdict is Verdict.PROVED for step in chain.steps):
        return False
    state = chain.steps[-1].post if chain.steps else setup.start
    return state is not None and may_rotate(rules[first], state, setup)
