"""Rotation between a moving and a passive tip: derived rates and event-driven engine agree."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st

from meso_robust.campaigns.property.law import Breach, Cost, Property, Silence, Verdict
from meso_robust.conditions import values
from meso_robust.simulator import Outcome, Push
from meso_robust.simulator.events import EventResult
from meso_robust.simulator.exact import exact
from meso_robust.types import Floats

UM = 1e-6
HALF_LENGTH_UM = 4000.0  # so long that no tip comes to the end of its edge
SAMPLES = 16
SAME_ANGLE = 1e-10
"""Of the cosine and sine of the orientation."""
SAME_SLIDE = 1e-9
"""Of the slide over the distance of the edges; both sides are integrated to about 1e-11."""
MODULE = "two_sided_rotation"


@dataclass(frozen=True, slots=True)
class Grip:
    """The part between the passive tip, at the origin, and one that travels along -x; um."""

    depth_um: float
    """Half the distance of the two edges (d1)."""
    friction: float
    room: float
    """Height of the moving tip over the one at which the grasp may close."""
    ahead: float
    """x of the moving tip, over its height."""
    slide: float
    """Of the part's centre from the middle of the tips, along the edges, over the height."""
    ratio: float
    """rho over the square of the height"""
    travel: float
    """Over the height."""

    @property
    def height(self) -> float:
        """Of the moving tip over the passive one (V), m."""
        return self.room * 2.0 * self.depth_um * UM * math.sqrt(1.0 + self.friction**2)

    @property
    def way(self) -> float:
        """Travel, m."""
        return self.travel * self.height

    def h(self, share: float) -> float:
        """Where the moving tip is along x after a share of the travel, m."""
        return self.ahead * self.height - share * self.way


grips = st.builds(
    Grip,
    depth_um=st.floats(150.0, 600.0),
    friction=st.floats(0.0, 0.8),
    room=st.floats(1.05, 2.0),
    ahead=st.floats(-0.4, 1.0),
    slide=st.floats(-0.25, 0.25),
    ratio=st.floats(0.2, 1.0),
    travel=st.floats(0.01, 1.0),
)


def push_of(grip: Grip) -> Push:
    """The same as a push."""
    h, height = grip.h(0.0), grip.height
    c, s = _orientation(grip, h)
    slide = grip.slide * height
    a, b = HALF_LENGTH_UM * UM, grip.depth_um * UM
    return Push.straight(
        vertices=np.array([[-a, -b], [a, -b], [a, b], [-a, b]]),
        poses=np.array([[0.5 * h + slide * c, 0.5 * height + slide * s, math.atan2(s, c)]]),
        tips=np.array([[[h, height], [0.0, 0.0]]]),
        travel=np.array([[[-grip.way, 0.0], [0.0, 0.0]]]),
        friction=np.array([grip.friction]),
        film_ratio=grip.ratio * grip.height**2,
        step=2.0 * UM,
    )


def _orientation(grip: Grip, h: float) -> tuple[float, float]:
    c, s = values(MODULE, "orientation")(h=h, V=grip.height, d1=grip.depth_um * UM)
    return float(c), float(s)


def check(grip: Grip) -> Verdict:
    """Orientation at every instant and slide at the last, as long as both tips touch."""
    found = exact(push_of(grip), samples=SAMPLES)
    share = _together(found)
    if share == 0.0:
        if _pressed(grip):
            return _breach("keeps the passive tip", "it leaves the tip that it is pressed on")
        return Silence("the part is not pressed on the passive tip")
    instants = np.linspace(0.0, 1.0, SAMPLES + 1)
    last = int(np.flatnonzero(instants <= share)[-1])
    if last == 0:
        return Silence("the part leaves the passive tip at once")
    for k in range(last + 1):
        c, s = _orientation(grip, grip.h(float(instants[k])))
        angle = float(found.path[0, k, 2])
        off = max(abs(math.cos(angle) - c), abs(math.sin(angle) - s))
        if off > SAME_ANGLE:
            return _breach("has the orientation that the tips demand", f"off by {off:.3g}")
    made = _slide_of(grip, found.path[0, last], float(instants[last]))
    derived = _integrated(grip, float(instants[last]))
    off = abs(made - derived) / (2.0 * grip.depth_um * UM)
    if not off <= SAME_SLIDE:
        return _breach("slides as derived", f"slide {made!r} m, derived {derived!r} m")
    return None


def _together(found: EventResult) -> float:
    """Share of the move until a tip no longer touches, or the run ends."""
    line = found.timeline(0)
    end = 1.0 if found.outcomes[0] == Outcome.COMPLETED else float(found.ended_at[0])
    alone = np.flatnonzero((line.modes == 0).any(axis=1))
    return float(line.times[alone[0]]) if alone.size else end


def _pressed(grip: Grip) -> bool:
    """Whether the derived force on the passive tip is positive at all friction ratios."""
    force = values(MODULE, "passive_force")
    forces = [
        float(force(**_at(grip, grip.h(0.0), grip.slide * grip.height), tau_D=one, tau_S=other)[0])
        for one, other in itertools.product((-grip.friction, grip.friction), repeat=2)
    ]
    return min(forces) > 1e-9


def _at(grip: Grip, h: float, sigma: float) -> dict[str, float]:
    return {
        "h": h,
        "V": grip.height,
        "d1": grip.depth_um * UM,
        "sigma": sigma,
        "rho": grip.ratio * grip.height**2,
    }


def _slide_of(grip: Grip, pose: Floats, share: float) -> float:
    """Centre minus middle of the tips, along the edges, m."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return float((pose[0] - 0.5 * grip.h(share)) * c + (pose[1] - 0.5 * grip.height) * s)


def _integrated(grip: Grip, share: float) -> float:
    """The slide by the derived rates, m."""
    from scipy.integrate import solve_ivp

    found = solve_ivp(
        lambda made, sigma: [rate(grip, grip.h(0.0) - float(made), float(sigma[0]))],
        (0.0, share * grip.way),
        [grip.slide * grip.height],
        method="LSODA",
        rtol=1e-13,
        atol=1e-18,
        max_step=grip.way / SAMPLES,  # a change of mode is a kink, which a long step would miss
    )
    return float(found.y[0, -1])


def rate(grip: Grip, h: float, sigma: float) -> float:
    """d(sigma)/d(travel) in the one mode that is possible; see :mod:`meso_robust.motion.two_sided`.

    With v half the rate at which the contacts part: the slide is above |v| if both tips slip down
    the edges, below -|v| if both slip up, between if they slip apart or together, and at one of these
    bounds if one sticks.
    """
    down, down_up, up_down, up, v = (
        float(value)
        for value in values(MODULE, "slide_rates")(**_at(grip, h, sigma), mu=grip.friction)
    )
    most = abs(v)
    if down > most:
        return down
    if up < -most:
        return up
    return min(max(up_down if v > 0.0 else down_up, -most), most)


def _breach(what: str, detail: str) -> Breach:
    return Breach(what=f"two-sided rotation: {what}", detail=detail)


ROTATION = Property(
    name="two-sided-rotation",
    statement=(
        "A part between a moving and a passive tip (too far apart to close on it) turns in the "
        "event-driven engine as the derived orientation demands, and slides by the integral of the "
        "derived rates."
    ),
    agreement=(
        "cosine and sine of the orientation to 1e-10; the slide to 1e-9 of the part's width: both "
        "integrations have errors of some 1e-11"
    ),
    examples=grips,
    check=check,
    cost=Cost.MODERATE,
)
