"""How far from the part the probes must start, so that they are free of contact at every pose.

Lengths of the planner suit a part of a millimetre; for a smaller part they are smaller, see `fine`.
"""

from __future__ import annotations

import math

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.bounds.interval import cos, sin
from meso_robust.motion import sticking
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tips import HALF

FULL_UM = 800.0  # the paper's part is 837 um wide, and such lengths were chosen for it
AIR_UM = 6.0  # on top of what the bounds demand
FARTHEST_UM = 1e6  # that a probe starts ahead of a part


def fine(setup: Setup) -> float:
    """Factor on such a length: 1 for a part that is at least ``FULL_UM`` wide, less in proportion."""
    return min(1.0, units.to_um(setup.outline.width) / FULL_UM)


def start_ahead_um(rises: tuple[tuple[int, Interval], ...], pre: PoseBox, setup: Setup) -> float:
    """Smallest commanded x of the tip pair ahead of the sensed part, um, rounded up to 0.1 um.

    Parameters
    ----------
    rises
        (side, height above the part's centre) of each tip; side as in ``Tip``.
    pre, setup
        All poses before the move, and the task.
    """
    edge, u = setup.edge(pre.theta.mid), setup.uncertainty
    angle, off = edge.angle(pre.theta) + u.squareness, u.probe_position + u.probe_wander
    needed = []
    for side, rise in rises:
        up = Interval.point(float(side)) * HALF * setup.spacing
        lag = up * sin(u.misalignment) / cos(u.misalignment)
        reach = sticking.contact_reach(angle, edge.depth + u.tip_radius, rise)
        needed.append((reach + lag - u.sensed_position - off).hi)
    return _rounded_up(max(needed), setup)


def passive_behind_um(rise: Interval, pre: PoseBox, setup: Setup) -> float:
    """Smallest distance of the passive tip behind the sensed part, um, rounded up to 0.1 um."""
    edge, u = setup.edge(pre.theta.mid), setup.uncertainty
    far, lean = setup.opposite(edge)
    angle, off = edge.angle(pre.theta) + u.squareness + lean, u.probe_position + u.probe_wander
    reach = sticking.contact_reach(angle, far.depth + u.passive_tip_radius, -rise)
    return _rounded_up((reach + u.sensed_position + off).hi, setup)


def _rounded_up(length: float, setup: Setup) -> float:
    # of poses so wide that no distance is enough nothing is proved, whatever is tried
    length_um = min(units.to_um(length), FARTHEST_UM)
    return math.ceil(10.0 * (length_um + fine(setup) * AIR_UM)) / 10.0


def errors_across(setup: Setup) -> Interval:
    """By how much a commanded height above the sensed part can be wrong, m."""
    u = setup.uncertainty
    return u.sensed_position + u.probe_position + u.probe_wander


def rise_of(offset: Interval, side: int, setup: Setup) -> Interval:
    """Height above the centre of the tip on ``side`` when the pair's middle is ``offset`` above.

    ``offset`` holds the errors of sensing and actuation already.
    """
    return offset + Interval.point(float(side)) * HALF * setup.spacing
