"""Event-driven integration of planar quasi-static pushing.

The second engine of the simulator: between events the contact modes are constant and the motion is
smooth, so it is followed in closed form or with high order; nothing is shared with the time
stepper, so that the two judge each other.
"""

from meso_robust.simulator.events.engine import (
    EventResult as EventResult,
    integrate as integrate,
    integrate_checked as integrate_checked,
)
from meso_robust.simulator.events.timeline import Timeline as Timeline
