r"""What a run reads and the working space it writes, in scaled units.

Lengths are in units of the largest distance of a corner of the part from its reference point, and
the clock ``ξ`` is the path of the fastest tip in that unit, so that the fastest tip has speed one.
The drag is scaled to a first entry of one. A run then has quantities of order one.

A move is made of legs; within one the tips have constant velocities and friction.
"""

from typing import Any, NamedTuple, TypeAlias

import numpy as np

from meso_robust.types import Flags, Floats

MOST = 12
"""Largest number of places that touch at the same time."""
ROOM = 64
"""Largest number of combinations of modes that are noted."""

SEPARATE, STICK, SLIP_PLUS, SLIP_MINUS = range(4)
"""Modes of a contact."""

EDGE, CORNER, WALL, POINT = range(4)
"""Kinds of contact: tip on an edge of the part, disc on a corner, corner of the part on a wall,
point tip on a corner (where it can only stick)."""

KIND, FIRST, SECOND, GROUP = range(4)
"""Columns of `Work.contact`."""

TOUCHING, CLOSED, EVENTS, SAMPLE, LOGGED, BANNED, STUCK, HELD = range(8)
"""Entries of `Work.count`; HELD is the number of basis forces."""

BUSY = -1
"""Column of `Scene.left_out`."""


class Scene(NamedTuple):
    """One run, and what is noted for each body: first the tips, then the corners of the part."""

    edges: Floats
    """(V, 9) `edge_table` of the part, body frame."""
    walls: Floats
    """(F, 9) `edge_table` of the fixture, world frame."""
    legs: Floats
    """(L, movers, 4) velocity and friction of the tips in each leg, and the clock at its end."""
    tips: Floats
    """(T, 6) rows x, y at clock zero (if the present leg had begun then), velocity, radius, friction;
    world frame; written. The first `movers` are the tips, the others the convex corners of the
    fixture."""
    clear: Floats
    """(T + V,) distances that tips and corners of the part are known to keep; written. (T,) where
    there is no fixture."""
    closing: Floats
    """As many bounds of the speed at which each comes closer on the present curve; written."""
    left_out: Flags
    """(T + V, max(V, F) + 1) edges or walls that a touching body is not measured from, and in the
    last column whether there are any; written."""


WORK = np.dtype(
    [
        # Read: drag (from twist to wrench, body frame) and its inverse, the drag without the lay of
        # the stage, that lay, the centre of drag, the clock at the end of the leg and of the move,
        # the friction at the fixture, the largest distance of a corner from the reference point,
        # and the number of tips that are not corners of the fixture.
        ("drag", np.float64, (3, 3)),
        ("film", np.float64, (3, 3)),
        ("even", np.float64, (3, 3)),
        ("lay", np.float64, (2,)),
        ("centre", np.float64, (2,)),
        ("span", np.float64),
        ("whole", np.float64),
        ("wall_friction", np.float64),
        ("reach", np.float64),
        ("movers", np.int64),
        # Pose x, y, θ and twist in the body frame.
        ("pose", np.float64, (3,)),
        ("twist", np.float64, (3,)),
        # Contacts (kind, tip or corner, edge or corner, group of those at one corner), their
        # modes, constraints w · v = u (normal and tangent of each) each with one of the two lengths
        # of `frame`, and the wrenches of the two edges of the friction cone of each.
        ("contact", np.int64, (MOST, 4)),
        ("mode", np.int64, (MOST,)),
        ("row", np.float64, (2 * MOST, 5)),
        ("push", np.float64, (2 * MOST, 3)),
        # Constraints and wrenches that determine motion and forces, and shares of the wrenches.
        ("basis", np.int64, (6,)),
        ("force", np.float64, (3,)),
        # See TOUCHING and the names after it.
        ("count", np.int64, (8,)),
        # What must not become negative in the present mode.
        ("slack", np.float64, (4 * MOST,)),
        # The same at the start of a step, after whether they are known.
        ("before", np.float64, (1 + 4 * MOST,)),
        # Slopes and result of a Runge-Kutta step, and the curve through it (see `curve`).
        ("slope", np.float64, (12, 3)),
        ("trial", np.float64, (3,)),
        ("curve", np.float64, (18,)),
        # The guided curve of a part in a channel, 0 in the first entry if it is in none, the two
        # contacts that make it, the slopes of the way along it in a Runge-Kutta step, and that way
        # inside the step.
        ("channel", np.float64, (18,)),
        ("pair", np.int64, (2,)),
        ("slide", np.float64, (16,)),
        ("inside", np.float64, (7,)),
        # Modes and basis of the combinations that hold, with twist and merit; modes not to choose.
        ("found", np.int64, (ROOM, MOST + 7)),
        ("merit", np.float64, (ROOM, 4)),
        ("ban", np.int64, (16,)),
        # Scratch of the choice of a basis: `apart` has what each constraint adds to those before
        # it, and one over the square of its length.
        ("pushes", np.int64, (2 * MOST,)),
        ("picked", np.int64, (4,)),
        ("apart", np.float64, (3, 4)),
    ]
)
"""Working space of a run, one record: a single pointer for the compiled functions to hand on."""

Work: TypeAlias = Any
"""A record of type `WORK`; its fields are arrays and numbers."""
