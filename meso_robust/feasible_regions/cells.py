"""A cell of choices as one move, and single points of the uncertainties."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

from meso_robust.bounds import Interval
from meso_robust.primitives.move import Aim, MoveRule, Point
from meso_robust.primitives.setup import Setup

INSIDE = 1e-9  # how far from the end of a range, as a share of it, its extreme point is taken


@dataclass(frozen=True, slots=True, kw_only=True)
class Span(Aim):
    """All commanded coordinates of a range at once; ``offset_um`` is only for display."""

    reach: Interval
    """m"""

    @property
    def offset(self) -> Interval:
        """The range, m."""
        return self.reach


def span(aim: Aim, reach: Interval) -> Span:
    """The commands of a range (m) with the anchor of ``aim``."""
    return Span(anchor=aim.anchor, offset_um=1e6 * reach.mid, reach=reach)


def at_height(rule: MoveRule, middle: Interval, ahead: Interval | None = None) -> MoveRule:
    """The rule with the middle of its pair commanded at these heights (m).

    ``ahead``: where the pair starts in x (m), if not as in the rule.
    """
    x = rule.dual.x if ahead is None else span(rule.dual.x, ahead)
    return replace(rule, dual=Point(x=x, y=span(rule.dual.y, middle)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Corner:
    """One admissible value of everything that is uncertain during a move."""

    setup: Setup
    """The task with this value as its only one; errors of x and y are those of y."""
    shift_x: Interval
    """Error of a commanded x beyond that of ``setup``, m."""

    def rule(self, rule: MoveRule) -> MoveRule:
        """The rule with the end of its push shifted."""
        end = span(rule.dual_end, rule.dual_end.offset + self.shift_x)
        return replace(rule, dual_end=end)


def extreme(range_: Interval, upper: bool) -> Interval:
    """A point of a range near one end: inside it also before its ends were rounded outward."""
    if range_.lo == range_.hi:
        return range_
    reach = (range_.hi - range_.lo) * INSIDE
    return Interval.point(range_.hi - reach if upper else range_.lo + reach)


def corners(setup: Setup) -> Iterator[Corner]:
    """Sixteen extreme values of the uncertainties of one move that can break a sticking push.

    First all ways to be off in position (up or down, then right or left of the command), then the
    same for the next pair of film ratio and misalignment.

    Friction is at its least, where sticking ends first; every other range is at either end. They
    need not hold the worst case: whatever one of them breaks is broken.
    """
    u = setup.uncertainty
    for rough, ahead, up, right in itertools.product((True, False), repeat=4):
        sensed, probe = extreme(u.sensed_position, up), extreme(u.probe_position, up)
        shift = extreme(u.sensed_position, right) + extreme(u.probe_position, right)
        point = replace(
            u,
            sensed_position=sensed,
            sensed_orientation=extreme(u.sensed_orientation, True),
            probe_position=probe,
            friction=extreme(u.friction, False),
            film_ratio=extreme(u.film_ratio, rough),
            misalignment=extreme(u.misalignment, ahead),
        )
        yield Corner(setup=replace(setup, uncertainty=point), shift_x=shift - sensed - probe)


def same_run(one: Corner, other: Corner) -> bool:
    """Whether both can hold in two moves of one run: only errors of position may change."""
    u, v = one.setup.uncertainty, other.setup.uncertainty
    return (u.friction, u.film_ratio, u.misalignment) == (v.friction, v.film_ratio, v.misalignment)
