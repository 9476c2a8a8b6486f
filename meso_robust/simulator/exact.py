"""A push by the event-driven integrator, the second engine of the simulator."""

from __future__ import annotations

import numpy as np

from meso_robust.simulator.events import EventResult, integrate_checked
from meso_robust.simulator.motion_model import QuasiStatic
from meso_robust.simulator.outline import refuse
from meso_robust.simulator.push import Push
from meso_robust.simulator.support_models import Film
from meso_robust.simulator.tips import Flat


def exact(push: Push, *, samples: int = 0) -> EventResult:
    """Push the part of every run through the move without steps: from one event to the next.

    Translation, one sticking contact, and a sticking with a sliding one are in closed form. Other
    sliding is integrated to about 1e-12 of the travel. The instants at which a contact mode changes
    are roots.

    Parameters
    ----------
    push
        A move along straight legs, on a film, by points or round tips, without effects. Its steps
        are of no meaning here.
    samples
        Number of intervals of the path; zero for none.

    Returns
    -------
    EventResult
        Poses at the end, outcomes, paths, and the contact modes between events.

    Raises
    ------
    ValueError
        If the push has something that this engine does not know.
    """
    advice = "use simulate, which takes it in steps"
    if not isinstance(push.support, Film):
        refuse("support", type(push.support).__name__, "must be a Film", advice)
    if push.effects.table.any():
        refuse("effects", ", ".join(push.effects.values), "must be none", advice)
    if not isinstance(push.motion, QuasiStatic):
        refuse("motion", type(push.motion).__name__, "must be QuasiStatic", advice)
    if any(isinstance(shape, Flat) for shape in push.shapes):
        refuse("shapes", "a flat tip", "must be points or round", advice)
    runs, legs, probes = len(push.poses), push.waypoints.shape[1] - 1, push.waypoints.shape[2]
    ways = np.broadcast_to(push.waypoints, (runs, legs + 1, probes, 2))
    if samples < 0:
        refuse("samples", f"{samples}", "must not be negative", "give 0 for no path")
    move = {
        "vertices": push.vertices,
        "poses": push.poses,
        "tips": ways[:, 0],
        "travel": np.diff(ways, axis=1),
        "friction": np.broadcast_to(push.friction_of_legs, (runs, legs, probes)),
        "drag": push.support.drag,
        "radii": np.broadcast_to(push.radii_of_tips, (runs, probes)),
        "stage_lay": push.support.stage_lay,
        "fixture_friction": np.array(push.fixture.friction),
    }
    return integrate_checked(move, push.fixture.outlines, samples)
