"""A cap on contact forces: that no tip presses harder on the part than the task allows."""

from __future__ import annotations

from meso_robust.bounds import Interval, enclose
from meso_robust.conditions import condition
from meso_robust.primitives.base import bend_of
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import Inequality, ObligationId, about
from meso_robust.primitives.obligation import Obligation, require_order
from meso_robust.primitives.setup import Setup

ONE, ZERO = Interval.point(1.0), Interval.point(0.0)
EVEN = 1e-9
"""Anisotropy that an even film is taken to have; it adds 1.4e-9 of a force."""
ALONE, TOGETHER = ("tilt",), ("straighten",)
"""Moves in which one tip pushes, and in which two on one edge do at the end."""


def force_below_cap(rule: MoveRule, setup: Setup) -> tuple[Obligation, ...]:
    """Bound every contact force of a move; nothing if the task sets no cap.

    Parameters
    ----------
    rule, setup
        The move and the task.

    Returns
    -------
    tuple[Obligation, ...]
        One obligation about the force, N. Of a regrasp, which touches nothing, none; none of a rotation,
        which has `squeeze_below_cap`.
    """
    if rule.action not in (*ALONE, *TOGETHER):
        return ()
    u = setup.uncertainty
    friction = u.friction if rule.action in TOGETHER else ZERO
    # the bound grows with the size of each of them, and the root of a sum of squares has none at nought
    uneven = Interval.point(max(_largest(u.drag_anisotropy).hi, EVEN))
    box = {
        "stretch": uneven,
        "shear": uneven,
        "mu": _largest(friction),
        "bend": _largest(bend_of(u)),
    }
    (over_drag,) = enclose(condition("contact_forces", "carrying_force"), box)
    return _below_cap(over_drag, setup)


def squeeze_below_cap(normal: float, setup: Setup) -> tuple[Obligation, ...]:
    """Bound the contact forces of two tips that press a part from both sides.

    Parameters
    ----------
    normal
        Bound of the normal force at either tip, over the drag and the rate of travel.
    setup
        The task.

    Returns
    -------
    tuple[Obligation, ...]
        One obligation about the force, N; nothing if the task sets no cap.
    """
    mu = setup.uncertainty.friction
    # no smaller than the root of 1 + mu^2, which friction makes of a normal force
    return _below_cap(Interval.point(normal) * (ONE + mu * mu * Interval.point(0.5)), setup)


def _below_cap(over_drag: Interval, setup: Setup) -> tuple[Obligation, ...]:
    cap, drag, speed = setup.largest_force, setup.drag, setup.speed
    if cap is None or drag is None or speed is None:
        return ()
    # the travel takes as long as commanded, so that a longer one is faster, and so is one that strays along its line
    u = setup.uncertainty
    force = over_drag * drag * speed * (ONE + u.travel_scale) * (ONE + _largest(bend_of(u)))
    most = Interval(0.0, force.hi)
    name = about(ObligationId.FORCE_BELOW_CAP)
    return (require_order(name, Inequality.FORCE, cap - most, {"force": most}),)


def _largest(side: Interval) -> Interval:
    return Interval.point(max(abs(side.lo), abs(side.hi)))
