"""The start of a two-sided rotation: the active tip alone pushes the part onto the passive one."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

from meso_robust.bounds import Interval, enclose
from meso_robust.bounds.interval import cos, sin
from meso_robust.conditions import condition
from meso_robust.motion import sticking
from meso_robust.primitives.names import Inequality, ObligationId, about
from meso_robust.primitives.obligation import Knot, Obligation, require
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tips import Tip

MODULE = "two_sided_rotation"
# Choices of speed against tightness: a step too long or too many leave a rotation undecided, never wrong.
APPROACH_STEPS = (
    50  # per half width d1: a step turns the part by less than 1/50, as |omega| <= 1/d1
)
MOST_APPROACH_STEPS = 40  # 0.8 half widths of travel; a passive tip farther off is left undecided


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """The two tips that turn the part, world axes."""

    active: Tip
    active_y: Interval
    passive_x: Interval
    passive_y: Interval
    passive_ahead: Interval
    """x of the passive tip minus x of the part before the move, m."""
    passive_rise: Interval
    separation: Interval
    """V, m."""
    middle_y: Interval
    h_end: Interval
    """x of the active tip minus x of the passive one after the move, m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Alone:
    """States of the part while the active tip alone pushes."""

    theta: Interval
    x: Interval
    """Displacement since the start, m."""
    y: Interval
    gap: Interval
    """Distance of the passive tip from its edge, m."""

    def moved(
        self, travel: Interval, v_x: Interval, v_y: Interval, omega: Interval, closing: Interval
    ) -> _Alone:
        """After ``travel`` at these rates."""
        return _Alone(
            theta=self.theta + travel * omega,
            x=self.x + travel * v_x,
            y=self.y + travel * v_y,
            gap=self.gap - travel * closing,
        )

    def hull(self, other: _Alone) -> _Alone:
        """The smallest set of this form that holds both."""
        return _Alone(
            theta=self.theta.hull(other.theta),
            x=self.x.hull(other.x),
            y=self.y.hull(other.y),
            gap=self.gap.hull(other.gap),
        )

    def within(self, other: _Alone) -> bool:
        """Whether all states (the gap aside, which feeds nothing back) lie in ``other``."""
        return self.theta.within(other.theta) and self.x.within(other.x) and self.y.within(other.y)

    def inflated(self) -> _Alone:
        """A little larger, so that a guess has room."""
        return replace(self, theta=_inflated(self.theta), x=_inflated(self.x), y=_inflated(self.y))


def _inflated(range_: Interval) -> Interval:
    # any guess is sound, as it is kept only if the motion stays in it; 5 % is enough for the next try
    reach = 0.05 * (range_.hi - range_.lo)
    return Interval(range_.lo - reach, range_.hi + reach)


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch:
    """Everything the part can be like when it comes to rest on the passive tip."""

    theta: Interval
    path: Interval
    """Angles from the start to the touch."""
    y: Interval
    active_offset: Interval
    obligations: tuple[Obligation, ...]
    tube: tuple[Knot, ...]


def approach(pair: Pair, start: Interval, pre: PoseBox, edge: Edge, setup: Setup) -> Touch | None:
    """Enclose the push by the active tip alone, until the part rests on the passive one.

    The push is cut into steps. The states that can touch the passive tip within a step (those whose
    gap can close) are gathered; the end is reached when every gap is proved to be closed.
    """
    state = _Alone(
        theta=start,
        x=Interval.point(0.0),
        y=Interval.point(0.0),
        gap=enclose(
            condition("sticking_motion", "clearance"),
            {"theta": start, "d1": edge.depth, "dx": -pair.passive_ahead, "dy": -pair.passive_rise},
        )[0],
    )
    touched: list[_Alone] = []
    tube: list[Knot] = []
    visited: dict[str, Interval] = {}
    for _ in range(MOST_APPROACH_STEPS):
        step = _alone_step(state, pair, edge, setup)
        if step is None:
            return None
        state, swept, box = step
        tube.append(Knot(stage="the active tip pushes alone", box=_poses(swept, pre, edge)))
        visited = {key: side.hull(visited.get(key, side)) for key, side in box.items()}
        if swept.gap.lo <= 0.0:
            touched.append(swept)
        if state.gap.hi <= 0.0:
            hull = functools.reduce(_Alone.hull, touched)
            return Touch(
                theta=hull.theta,
                path=visited["theta"],
                y=pre.y + hull.y,
                active_offset=visited["d2"],
                obligations=tuple(
                    require(about(name), inequality, visited)
                    for name, inequality in (
                        (ObligationId.PUSHES_UNTIL_REST, Inequality.NORMAL_FORCE),
                        (ObligationId.UNIQUE_UNTIL_REST, Inequality.ONLY_SOLUTION),
                    )
                ),
                tube=tuple(tube),
            )
    return None


def _poses(states: _Alone, pre: PoseBox, edge: Edge) -> PoseBox:
    return PoseBox(x=pre.x + states.x, y=pre.y + states.y, theta=edge.orientation(states.theta))


def _alone_step(
    state: _Alone, pair: Pair, edge: Edge, setup: Setup
) -> tuple[_Alone, _Alone, dict[str, Interval]] | None:
    """One step of the active tip: the state after it, all states during it, and their box.

    A box of states is guessed and kept if the motion cannot leave it within the step.
    """
    u = setup.uncertainty
    length = edge.depth.lo / APPROACH_STEPS
    during = Interval(0.0, length)
    swept = state
    for _ in range(8):
        offset = sticking.contact_offset(swept.theta, edge.depth, pair.active.rise - swept.y)
        passive = (pair.passive_ahead - swept.x) * cos(swept.theta) + (
            pair.passive_rise - swept.y
        ) * sin(swept.theta)
        box = {
            "theta": swept.theta,
            "d1": edge.depth,
            "d2": offset,
            "rho": u.film_ratio,
            "mu": u.friction,
            "p_S": passive,
        }
        box["tau"] = _friction_ratio(box)
        (closing,) = enclose(condition(MODULE, "closing"), box, boxes=8)
        v_x, v_y = enclose(condition(MODULE, "one_contact_motion"), box, boxes=8)
        (omega,) = enclose(condition(MODULE, "one_contact_turning"), box, boxes=8)
        if not closing.lo > 0.0:
            return None
        moved = state.moved(during, v_x, v_y, omega, closing)
        if moved.within(swept):
            whole = Interval.point(length)
            return state.moved(whole, v_x, v_y, omega, closing), moved, box
        swept = swept.hull(moved).inflated()
    return None


def _friction_ratio(box: dict[str, Interval]) -> Interval:
    """Force along the edge over normal force of one contact: the sticking ratio, clipped to +-mu."""
    (stick,) = enclose(condition("one_point_sticking", "stick_ratio"), box, boxes=8)
    mu = box["mu"]
    low = max(stick.lo, -mu.hi) if stick.lo < 0.0 else min(stick.lo, mu.lo)
    high = min(stick.hi, mu.hi) if stick.hi > 0.0 else max(stick.hi, -mu.lo)
    return Interval(low, high)
