"""The laboratory's side: one sensed pose in, one move (or an end) out.

A line reports the pose sensed after the last answered move was carried out. The very same line again,
because the move was not carried out, gets the same move again. ``done`` and ``refused`` end the part:
the next line is judged as the first of the next part, by nothing but its own pose. (After a refusal
too: a pose that the last move cannot have led to is of another part, or an error broke its bound, and
either way what was certified after that move says nothing of the part that lies there.)
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Thread
from typing import Protocol

import numpy as np

from meso_robust import units
from meso_robust.bounds import Interval, Verdict
from meso_robust.certificates.chain import certify
from meso_robust.errors import NotApplicableError
from meso_robust.planning.document import MoveDocument, plan_document
from meso_robust.planning.reading import read_plan, read_text
from meso_robust.planning.rules import rules_of
from meso_robust.policy.cells import (
    Cell,
    Policy,
    common,
    reads,
    sensed_poses,
    true_poses,
    widened,
)
from meso_robust.policy.cover import ends_of, meet
from meso_robust.policy.document import read_policy
from meso_robust.policy.follow import expected
from meso_robust.policy.policy_file import SCHEMA
from meso_robust.policy.pose import Sensed, beyond
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.task import Task

WIDEST = 4096.0  # times the start's own box, that the starts of a plan are widened to at most
HALVINGS = 5  # of the last widening


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """Carry out ``rule`` as commanded from the sensed pose."""

    rule: MoveRule
    sensed: PoseBox
    expect: PoseBox
    """All true poses after it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """The part is in the goal."""

    within: PoseBox
    """All true poses that are possible."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Refused:
    """Nothing is proved from the sensed pose."""

    why: str


Reply = Move | Done | Refused


class Controller(Protocol):
    """What answers sensed poses."""

    @property
    def likely(self) -> Sensed:
        """A pose that gets a move."""

    def answer(self, sensed: Sensed) -> Reply:
        """The next move, the end, or why there is none."""

    def settle(self, seconds: float | None = None) -> None:
        """Wait for what is still worked out beside the answers, for so long at most: for a loop with a deadline."""


def controller_of(path: Path, task: Task) -> Controller:
    """The controller for a plan or policy file, proved again.

    Parameters
    ----------
    path
        The file.
    task
        What it must have been made for.

    Returns
    -------
    Controller
        What answers sensed poses.

    Raises
    ------
    InputError
        The file cannot be read, breaks a rule, or was made for another task; a policy is not proved.
    NotApplicableError
        The plan is not proved, or holds no policy (open loop).
    """
    values = json.loads(read_text(path))
    if isinstance(values, dict) and values.get("schema") == SCHEMA:
        return PolicyController(read_policy(path, task))
    rules = rules_of(read_plan(path, task))
    if not rules:
        raise NotApplicableError(
            f"{path}: an open-loop plan cannot respond to sensed poses; give one with a policy"
        )
    return PlanController(rules, task)


def commanded(move: Move, task: Task) -> MoveDocument:
    """A move as the hardware carries it out.

    Parameters
    ----------
    move, task
        What was answered, and the task.

    Returns
    -------
    MoveDocument
        Places of the tips and their travel, um, world frame.
    """
    box = move.sensed
    pose = np.array([box.x.mid, box.y.mid, box.theta.mid])
    return plan_document(task, [move.rule], [pose], [move.expect]).moves[0]


def rehearsed(controller: Controller) -> list[Reply]:
    """Answers to a likely pose, so that the first real one is as quick as the rest.

    Parameters
    ----------
    controller
        It is left as before.

    Returns
    -------
    list
        The answers.
    """
    rehearsal = copy.copy(controller)
    pose = rehearsal.likely
    return [rehearsal.answer(pose), rehearsal.answer(pose)]


class PolicyController:
    """Answers from the cells of a policy.

    Between two lines nothing but the answered move may act on the part. What is answered rests on
    the sensed pose alone, but for one thing: after a move that ends in the goal from all of its
    cell, a pose that the move can have led to is in the goal.
    """

    def __init__(self, policy: Policy) -> None:
        """Take a policy whose cells are proved."""
        self._policy, self._setup = policy, setup_of(policy.task)
        self._low, self._high = ends_of([cell.sensed for cell in policy.cells])
        self._last: tuple[Cell, PoseBox] | None = None

    @property
    def likely(self) -> Sensed:
        """A pose that gets a move."""
        return _middle(self._policy.cells[-1].sensed)

    def settle(self, seconds: float | None = None) -> None:
        """Nothing is worked out beside the answers."""

    @property
    def to_go(self) -> int:
        """Bound of the moves to the goal, the last one answered included."""
        return 0 if self._last is None else self._last[0].moves

    def answer(self, sensed: Sensed) -> Reply:
        """The next move, the end, or why there is none."""
        boxes = list(sensed.around(*self._angles()))
        done = next((found for box in boxes if (found := self._done(box)) is not None), None)
        if done is not None:
            self._last = None
            return done
        for box in boxes:
            cell = self._cell(box)
            if cell is not None:
                return self._move(cell, box)
        self._last = None
        return Refused(why=self._why(boxes))

    def _angles(self) -> tuple[float, float]:
        return float(self._low[:, 2].min()), float(self._high[:, 2].max())

    def _done(self, box: PoseBox) -> Done | None:
        possible = true_poses(box, self._setup)
        if self._last is not None:
            cell, expect = self._last
            if cell.ends and meet(expect, possible):
                return Done(within=common(expect, possible))
        if self._policy.rest is not None and reads(self._policy.rest, box):
            return Done(within=common(possible, self._setup.goal))
        return None

    def _cell(self, box: PoseBox) -> Cell | None:
        low, high = box.ends
        slack = 1e-9  # wider than what `reads` allows for
        near = ((self._low <= high + slack) & (low - slack <= self._high)).all(axis=1)
        cells = (self._policy.cells[int(k)] for k in np.flatnonzero(near))
        return next((cell for cell in cells if reads(cell.sensed, box)), None)

    def _move(self, cell: Cell, box: PoseBox) -> Move:
        before = true_poses(box, self._setup)
        expect = expected(cell.rule, before, true_poses(cell.sensed, self._setup), cell.post)
        self._last = cell, expect
        return Move(rule=cell.rule, sensed=box, expect=expect)

    def _why(self, boxes: Iterable[PoseBox]) -> str:
        return "the sensed pose lies outside the certified starts: " + beyond(
            boxes, [cell.sensed for cell in self._policy.cells]
        )


class PlanController:
    """Answers from a plan of one move after the other, certified from a box of starts.

    The task states a box of starts; the plan is mostly proved from many more, which takes seconds to
    find, or half a minute. That is done beside the first answers; a part outside the stated ones is refused until
    then, since no answer may be waited for.
    """

    def __init__(self, rules: tuple[MoveRule, ...], task: Task) -> None:
        """Certify the plan from the stated starts, and begin to look for more.

        Raises
        ------
        NotApplicableError
            The plan is not proved for the task.
        """
        self._rules, self._setup = rules, setup_of(task)
        stated = _stages(rules, self._setup)
        if stated is None:
            raise NotApplicableError(
                "the plan is not proved for this task, so no pose can be answered; make one with "
                "`meso-robust plan`, which also reports what prevents a proof"
            )
        start = task.start
        self._likely = Sensed(x_um=start.x_um, y_um=start.y_um, theta_deg=start.theta_deg)
        self._stated = self._boxes = stated
        self._widest = _beside(lambda: _widest(rules, self._setup, stated))
        self._made = 0
        self._last: tuple[tuple[float, float, float], Move] | None = None

    @property
    def likely(self) -> Sensed:
        """A pose that gets a move."""
        return self._likely

    def settle(self, seconds: float | None = None) -> None:
        """Wait until all starts are found, for so long at most."""
        with suppress(TimeoutError):
            self._widest.result(seconds)

    @property
    def starts(self) -> PoseBox:
        """Certified true poses before the first move."""
        return self._widest.result()[0]

    def answer(self, sensed: Sensed) -> Reply:
        """The next move, the end, or why there is none."""
        if self._last is not None and self._last[0] == sensed.numbers and not self._regrasped:
            return self._last[1]
        angle = self._boxes[self._made].theta
        boxes = list(sensed.around(angle.mid - np.pi, angle.mid + np.pi))
        settled = self._widest.done()
        reply = self._next(boxes, settled)
        if isinstance(reply, Move):
            self._last = sensed.numbers, reply
            return reply
        ended = reply or Refused(why=self._why(boxes, settled))
        self._made, self._last = 0, None
        return ended

    @property
    def _regrasped(self) -> bool:
        """Whether the last move leaves the part where it is, so that the next pose may be the same."""
        return self._made > 0 and self._rules[self._made - 1].action == "regrasp"

    def _next(self, boxes: list[PoseBox], settled: bool) -> Reply | None:
        """What follows from a pose, of which the boxes are the same but for full turns."""
        for box in boxes:
            possible, last = true_poses(box, self._setup), len(self._rules)
            if self._made and meet(self._boxes[self._made], possible):
                now = common(self._boxes[self._made], possible)
                return Done(within=now) if self._made == last else self._move(self._made, box, now)
        for stages in self._from(settled):
            for box in boxes:
                exactly = _exactly(box, self._setup)
                if exactly.within(stages[0]):
                    self._boxes = stages
                    return self._move(0, box, exactly)
        return None

    def _from(self, settled: bool) -> Iterator[Stages]:
        yield self._stated
        if settled:
            yield self._widest.result()

    def _move(self, number: int, box: PoseBox, now: PoseBox) -> Move:
        rule, pre, post = self._rules[number], self._boxes[number], self._boxes[number + 1]
        # after a tilt, what is certified of y hangs on the pose before the tilt
        free = number == 0 or self._rules[number - 1].action != "tilt"
        self._made = number + 1
        return Move(rule=rule, sensed=box, expect=expected(rule, now, pre, post) if free else post)

    def _why(self, boxes: Iterable[PoseBox], settled: bool) -> str:
        u = self._setup.uncertainty
        first = self.starts if settled else self._stated[0]
        narrow = [side.width for side in (u.sensed_position, u.sensed_orientation)]
        inner = PoseBox(
            x=_inner(first.x, 0.5 * narrow[0]),
            y=_inner(first.y, 0.5 * narrow[0]),
            theta=_inner(first.theta, 0.5 * narrow[1]),
        )
        if not self._made and not settled:
            return (
                "the sensed pose lies outside the starts that the task states: "
                + beyond(boxes, [inner])
                + "; whether the plan is proved from there as well is being worked out: ask again"
            )
        if not self._made:
            return "the sensed pose lies outside the certified starts: " + beyond(boxes, [inner])
        now = sensed_poses(self._boxes[self._made], self._setup)
        return (
            f"the sensed pose lies outside what was certified after move {self._made}: "
            + beyond(boxes, [now])
            + "; an error is larger than the task states, or the move was not carried out"
        )


def _middle(box: PoseBox) -> Sensed:
    x, y, theta = box.mid
    return Sensed(x_um=units.to_um(x), y_um=units.to_um(y), theta_deg=units.to_deg(theta))


def _exactly(sensed: PoseBox, setup: Setup) -> PoseBox:
    """All true poses behind a sensed one, without room for rounding: the start's own box is one."""
    u = setup.uncertainty
    return widened(sensed, -u.sensed_position, -u.sensed_orientation)


def _inner(side: Interval, by: float) -> Interval:
    low, high = side.lo + by, side.hi - by
    return Interval(low, high) if low <= high else Interval.point(side.mid)


Stages = tuple[PoseBox, ...]
"""Certified true poses before each move and at the end."""


def _stages(rules: tuple[MoveRule, ...], setup: Setup) -> Stages | None:
    """What is certified of a plan; None if it is not proved."""
    chain = certify(rules, setup, whole=False)
    if chain.verdict is not Verdict.PROVED or chain.end is None:
        return None
    return (*(step.pre for step in chain.steps), chain.end)


def _widest(rules: tuple[MoveRule, ...], setup: Setup, stated: Stages) -> Stages:
    """The stages with the start widened about its middle, as far as the plan is proved."""
    for sides in (("y", "theta"), ("y",), ("theta",), ("x",)):
        good, bad = 1.0, 2.0
        while bad <= WIDEST and (found := _stages(rules, _wider(setup, sides, bad))) is not None:
            stated, good, bad = found, bad, 2.0 * bad
        for _ in range(HALVINGS):
            trial = 0.5 * (good + bad)
            found = _stages(rules, _wider(setup, sides, trial))
            if found is not None:
                stated, good = found, trial
            else:
                bad = trial
        setup = _wider(setup, sides, good)
    return stated


def _beside(work: Callable[[], Stages]) -> Future[Stages]:
    """Begin some work in a thread that nobody waits for at the end of the process."""
    done: Future[Stages] = Future()

    def carry_out() -> None:
        try:
            done.set_result(work())
        except BaseException as error:  # told to whoever asks
            done.set_exception(error)

    Thread(target=carry_out, daemon=True).start()
    return done


def _wider(setup: Setup, sides: tuple[str, ...], factor: float) -> Setup:
    if factor == 1.0:
        return setup
    start = setup.start
    wide = {side: _about_middle(getattr(start, side), factor) for side in sides}
    return replace(setup, start=replace(start, **wide))


def _about_middle(side: Interval, factor: float) -> Interval:
    middle = Interval.point(side.mid)
    return (middle + (side - middle) * Interval.point(factor)).hull(side)
