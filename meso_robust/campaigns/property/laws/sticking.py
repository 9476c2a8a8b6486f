"""Turning about a sticking contact: closed form and event-driven engine give the same motion."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import strategies as st

from meso_robust.campaigns.property.law import Breach, Cost, Property, Silence, Verdict
from meso_robust.conditions import balls, values
from meso_robust.simulator import Outcome, Push
from meso_robust.simulator.exact import exact

if TYPE_CHECKING:
    from flint import arb

    from meso_robust.simulator.events.timeline import Timeline

UM = 1e-6
SAME = 1e-12
"""Of an angle in rad, of a length over the half length of the edge: some thousand roundings."""
AT_THE_CONE = 1e-9
"""Share of the friction margin's terms within which either mode is right."""
STICK = 1


@dataclass(frozen=True, slots=True)
class Turn:
    """One tip pushes along -x on the upper edge of a rectangle; um, rad, um^2."""

    angle: float
    """Of the edge, pi/2 upright."""
    depth_um: float
    """Of the edge from the centre (d1)."""
    offset_um: float
    """Of the tip along the edge from its middle (d2)."""
    ratio_um2: float
    """rho"""
    friction: float
    travel_um: float


HALF_LENGTH_UM = 800.0

turns = st.builds(
    Turn,
    angle=st.floats(1.1, 2.0),
    depth_um=st.floats(100.0, 600.0),
    offset_um=st.floats(-700.0, 700.0),
    ratio_um2=st.floats(5e4, 8e5),
    friction=st.floats(0.0, 1.5),
    travel_um=st.floats(1.0, 600.0),
)


def push_of(turn: Turn) -> Push:
    """The same as a push; the part's centre is at the origin, its x axis along the edge."""
    a, b = HALF_LENGTH_UM * UM, turn.depth_um * UM
    x, y = values("sticking_motion", "arm")(**_arm_of(turn, turn.angle))
    return Push.straight(
        vertices=np.array([[-a, -b], [a, -b], [a, b], [-a, b]]),
        poses=np.array([[0.0, 0.0, turn.angle]]),
        tips=np.array([[[float(x), float(y)]]]),
        travel=np.array([[[-turn.travel_um * UM, 0.0]]]),
        friction=np.array([turn.friction]),
        film_ratio=turn.ratio_um2 * UM**2,
        step=2.0 * UM,
    )


def _arm_of(turn: Turn, angle: float) -> dict[str, float]:
    return {"theta": angle, "d1": turn.depth_um * UM, "d2": turn.offset_um * UM}


def _ratio_of(turn: Turn, angle: float) -> dict[str, float]:
    return {**_arm_of(turn, angle), "rho": turn.ratio_um2 * UM**2}


def spare(turn: Turn, angle: float) -> float:
    """Friction that is left at ``angle``, over the normal force's scale; negative: it slips."""
    above, below = values("one_point_sticking", "friction_margin")(
        **_ratio_of(turn, angle), mu=turn.friction
    )
    size = (turn.depth_um**2 + turn.offset_um**2 + turn.ratio_um2) * UM**2
    return min(float(above), float(below)) / size


def check(turn: Turn) -> Verdict:
    """The first phase of the event-driven engine against the closed forms."""
    (normal,) = values("one_point_sticking", "normal_force")(**_ratio_of(turn, turn.angle))
    left = spare(turn, turn.angle)
    if not float(normal) > 0.0 or abs(left) <= AT_THE_CONE:
        return Silence("the tip is at the border of pushing or sticking")
    found = exact(push_of(turn))
    if found.outcomes[0] != Outcome.COMPLETED:
        return _breach("is completed", f"outcome {Outcome(int(found.outcomes[0])).name}")
    line = found.timeline(0)
    if (line.modes[0, 0] == STICK) != (left > 0.0):
        return _breach(
            "sticks exactly where the friction margin is positive",
            f"mode {line.modes[0, 0]} at a margin of {left:.3g}",
        )
    if left < 0.0:
        return None
    last = len(line.times) == 1
    share = 1.0 if last else float(line.times[1])
    pose = found.poses[0] if last else line.poses[1]
    return _ends(turn, share, pose) or (None if last else _leaves(turn, line))


def _ends(turn: Turn, share: float, pose: np.ndarray) -> Verdict:
    """Travel and displacement by the closed forms at the angle that the engine reached."""
    x, y, angle = (float(value) for value in pose)
    made = share * turn.travel_um * UM
    low, high = _travel(turn, angle)
    size = HALF_LENGTH_UM * UM
    if not low - SAME * size <= made <= high + SAME * size:
        return _breach(
            "turns as far as the closed form", f"travel {made!r} m; closed form [{low!r}, {high!r}]"
        )
    arm = values("sticking_motion", "arm")
    start, end = arm(**_arm_of(turn, turn.angle)), arm(**_arm_of(turn, angle))
    off = math.hypot(x - float(start[0] - end[0]) + made, y - float(start[1] - end[1]))
    if off > SAME * size:
        return _breach("keeps the contact where it is", f"the contact is off by {off:.3g} m")
    return None


def _travel(turn: Turn, angle: float) -> tuple[float, float]:
    """Least and largest travel that the closed form needs to ``angle`` +- SAME, m."""
    from flint import arb

    if not balls("sticking_motion", "travel")(
        theta_start=turn.angle, theta_end=angle, **_rest(turn)
    )[0].is_finite():
        return -math.inf, math.inf  # pushed through the centre: no turn, no closed form
    end = arb(angle, SAME)
    (needed,) = balls("sticking_motion", "travel")(
        theta_start=turn.angle, theta_end=end, **_rest(turn)
    )
    return _ends_of(needed)


def _ends_of(ball: arb) -> tuple[float, float]:
    if not ball.is_finite():
        return -math.inf, math.inf
    return float(ball.lower()), float(ball.upper())


def _rest(turn: Turn) -> dict[str, float]:
    return {"d1": turn.depth_um * UM, "d2": turn.offset_um * UM, "rho": turn.ratio_um2 * UM**2}


def _leaves(turn: Turn, line: Timeline) -> Verdict:
    """A contact that stops to stick and slips does so where no friction is left."""
    if line.modes[1, 0] in (0, STICK):
        return None
    left = spare(turn, float(line.poses[1, 2]))
    if abs(left) > AT_THE_CONE:
        return _breach("slips where the margin vanishes", f"margin {left:.3g} at the event")
    return None


def _breach(what: str, detail: str) -> Breach:
    return Breach(what=f"sticking: {what}", detail=detail)


STICKING = Property(
    name="sticking-turn",
    statement=(
        "A tip that pushes a part in the event-driven engine sticks exactly where the derived friction "
        "margin is positive, turns it as the derived closed form says, and slips where the margin "
        "vanishes."
    ),
    agreement=(
        "angle to 1e-12 rad, lengths to 1e-12 of the edge's half length; the cone to 1e-9 of the "
        "margin's scale: both sides are closed forms, apart from roundings and a root"
    ),
    examples=turns,
    check=check,
    cost=Cost.CHEAP,
)
