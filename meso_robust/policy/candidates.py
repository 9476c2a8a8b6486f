"""Moves that a policy may be made of, each for as many poses as one certification can bear.

A part stands near one of four orientations (the goal's, and a quarter or half a turn from it). Near
each of them it can be straightened from all four sides, pushed to a station, or turned by a quarter.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval, Verdict
from meso_robust.policy.cells import true_poses
from meso_robust.policy.repertoire import (
    NARROW_DEG,
    WIDE_DEG,
    Push,
    Turn,
    pushes,
    shifted,
    straight_lean,
    turns,
)
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.frame import Frame, Heading
from meso_robust.primitives.move import MoveRule, in_world
from meso_robust.primitives.setup import PoseBox, Setup

QUARTERS = (0, -1, 1, -2)
"""Orientations of the part in quarter turns from the goal's; two turns clockwise are two
counter-clockwise ones."""
STATION = 0.75  # of the reach: where a part is brought to before it is turned
SPARE = 2e-6  # m of travel beyond what the errors can take


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A move that is proved on all of ``sensed``."""

    rule: MoveRule
    sensed: PoseBox
    post: PoseBox
    """All true poses after it."""
    follows_x: bool
    """Whether x after the move follows x before it; else it lies in ``post`` wherever it was."""
    follows_y: bool


@dataclass(frozen=True, kw_only=True)
class Kit:
    """Everything that candidates are made of."""

    setup: Setup
    reach: float
    """Half the side of the square around the goal in which poses are looked at, m."""
    headings: tuple[Heading, ...]
    """Directions in which the active probe can push."""

    @cached_property
    def pushes(self) -> dict[tuple[str, bool], list[Push]]:
        """By the edge that is pushed on, and whether the goal's orientation is meant."""
        near = self.setup.goal.theta.mid
        return {
            (self.setup.edge(angle).name, fine): pushes(
                self.setup, angle, NARROW_DEG if fine else WIDE_DEG
            )
            for angle in (near, near + HALF_PI.mid)
            for fine in (True, False)
        }

    @cached_property
    def turns(self) -> list[Turn]:
        """Rotations by a quarter to the goal's orientation."""
        frame = next(
            Frame(heading=h) for h in ("-x", "-y") if self._edge(Frame(heading=h), -1) == "long"
        )
        return turns(frame.setup(self.setup), self._own(frame, -1))

    def _own(self, frame: Frame, quarters: int) -> float:
        """Orientation ``quarters`` turns from the goal's, in a frame, rad."""
        turn = (quarters - frame.quarters) * HALF_PI.mid
        own = self.setup.goal.theta.mid + turn
        return -own if frame.mirrored else own

    def _edge(self, frame: Frame, quarters: int) -> str:
        return self.setup.edge(self._own(frame, quarters)).name

    def near(self, quarters: int) -> Iterator[Candidate]:
        """Candidates for parts that stand ``quarters`` from the goal's orientation."""
        turning = self._turning_frame(quarters)
        if quarters and turning is None:
            return
        for heading in self.headings:
            yield from self._straight(Frame(heading=heading), quarters, turning)
        if turning is not None:
            yield from self._turning(turning, quarters)

    def _turning_frame(self, quarters: int) -> Frame | None:
        """The frame in which a part is turned towards the goal, if it has to be and can be."""
        frames = (Frame(heading=heading, mirrored=quarters > 0) for heading in self.headings)
        able = (f for f in frames if quarters and self._edge(f, quarters) == "long")
        return next(able, None)

    def _straight(self, frame: Frame, quarters: int, turning: Frame | None) -> Iterator[Candidate]:
        for push in self._leans(frame, quarters, turning):
            for end in (*self._stations(frame, turning), None):
                found = self._pushed(push, end, frame, quarters)
                if found is not None:
                    yield found

    def _leans(self, frame: Frame, quarters: int, turning: Frame | None) -> list[Push]:
        """Before a rotation, leaning parts are straightened on the edge that bears more lean."""
        every = self.pushes[self._edge(frame, quarters), quarters == 0]
        along = turning is not None and (frame.quarters - turning.quarters) % 2 == 0
        across = any((Frame(heading=h).quarters - frame.quarters) % 2 for h in self.headings)
        return every[:1] if along and across else every

    def _pushed(
        self, push: Push, end: float | None, frame: Frame, quarters: int
    ) -> Candidate | None:
        """One push, to x = ``end`` in the frame's axes or just until the part is straight."""
        upright = self._own(frame, quarters)
        rule, (x, y) = push.rule, self._span(frame)
        if end is not None:
            depth = frame.setup(self.setup).edge(upright).depth.mid
            stop = in_world(units.to_um(end + depth))
            needed = (stop.offset - rule.dual_end.offset).hi + self._slack()
            if not needed < x.hi:
                return None
            rule, x = replace(rule, dual_end=stop), Interval(max(needed, x.lo), x.hi)
        box = PoseBox(x=x, y=y, theta=Interval.point(upright) + push.lean)
        return self._proved(rule, box, frame, follows=(end is None, True))

    def _turning(self, frame: Frame, quarters: int) -> Iterator[Candidate]:
        lean = Interval(-straight_lean(self.setup), straight_lean(self.setup))
        theta = Interval.point(self._own(frame, quarters)) + lean
        own = frame.setup(self.setup).goal.y.mid
        for turn in self.turns if abs(quarters) == 1 else self._middle_turn:
            # a part that has to be turned again is turned anywhere; its height does not matter
            rule = shifted(turn.rule, own - turn.origin)
            # the heights are rounded with the rule
            y = Interval.point(own) + Interval(turn.height.lo + 1e-7, turn.height.hi - 1e-7)
            box = PoseBox(x=self._span(frame)[0], y=y, theta=theta)
            found = self._proved(rule, box, frame, follows=(True, False))
            if found is not None:
                yield found

    @property
    def _middle_turn(self) -> list[Turn]:
        return self.turns[len(self.turns) // 2 :][:1]

    def _stations(self, frame: Frame, turning: Frame | None) -> tuple[float, ...]:
        """x, in the frame's axes, to which a part is pushed: the goal, or where it is turned."""
        if turning is None:
            return (frame.setup(self.setup).goal.x.mid,)
        if not self._middle_turn:
            return ()
        span_x = self._span(turning)[0]
        height = turning.setup(self.setup).goal.y.mid + self._middle_turn[0].height.mid
        at = PoseBox(
            x=Interval.point(span_x.mid + STATION * 0.5 * (span_x.hi - span_x.lo)),
            y=Interval.point(height),
            theta=Interval.point(0.0),
        )
        return (frame.from_world(turning.box_to_world(at)).x.mid,)

    def _span(self, frame: Frame) -> tuple[Interval, Interval]:
        """Ranges of sensed x and y in a frame's axes."""
        goal, reach = frame.setup(self.setup).goal, Interval(-self.reach, self.reach)
        return Interval.point(goal.x.mid) + reach, Interval.point(goal.y.mid) + reach

    def _slack(self) -> float:
        """What errors can take of a travel that ends at a station, m."""
        u = self.setup.uncertainty
        return u.sensed_position.width + u.probe_position.width + SPARE

    def _proved(
        self, rule: MoveRule, own: PoseBox, frame: Frame, follows: tuple[bool, bool]
    ) -> Candidate | None:
        sensed, there = frame.box_to_world(own), replace(rule, frame=frame)
        step = certify_move(there, true_poses(sensed, self.setup), self.setup)
        if step.verdict is not Verdict.PROVED or step.post is None:
            return None
        along, across = follows
        across_x = frame.quarters % 2 == 1
        return Candidate(
            rule=there,
            sensed=sensed,
            post=step.post,
            follows_x=across if across_x else along,
            follows_y=along if across_x else across,
        )
