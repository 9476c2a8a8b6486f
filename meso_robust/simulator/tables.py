"""The tables that the kernels of a step share, and what stands in their columns.

Few wide tables instead of many named arrays: each array that is passed between kernels costs time
in every call and in compiling. Lengths in m unless the column says otherwise; vectors in the body
frame at the start of the step.
"""

from typing import NamedTuple

import numpy as np

from meso_robust.kernels import maker
from meso_robust.types import Floats, Ints

MAX_CONTACTS = 16
"""Most contacts of one step."""

# Contacts, one a row: what geometry says, ...
GAP, NX, NY, PX, PY = 0, 1, 2, 3, 4
"""Gap, normal outward from the part, point of the part."""
DX, DY = 5, 6
"""Displacement of the obstacle in the step."""
MU, PULL = 7, 8
"""Friction coefficient; attraction over e_x, m/s."""
# ... the rows of the problem (see `rows`), and its solution.
QN, QT, WN, WT = 9, 10, 11, 14
"""q_n, q_t, and the first of three columns each of w_n and w_t."""
LN, LT = 17, 18
"""λ_n and λ_t."""
CONTACT = 19
"""Columns of the table of contacts."""

# Marks of contacts, one a row.
WHO, FEATURE, MODE = 0, 1, 2
"""Obstacle, feature and contact mode."""
OLD_WHO, OLD_FEATURE, OLD_MODE = 3, 4, 5
"""The same of the contacts of the last step."""
ACTIVE = 6
"""Contacts in the complementarity problem."""
MARKS = 7
"""Columns of the table of marks; its last row holds how many old contacts there are."""

# The step.
MOTION, SHIFT = 0, 3
"""First of three numbers: motion Δ' and motion without contact s', in units (see `rows`)."""
FACTOR = 6
"""First of seven: lower triangle of L⁻¹ by rows, and k."""
SOFT = 13
"""Compliance c of the probes, zero for stiff ones."""
COUNT = 14
"""Contacts of the step."""
STEP = 15
"""Length of the vector of the step."""

# Obstacles, one a row.
FIRST, LAST, RADIUS, FRICTION = 0, 1, 2, 3
"""First and last (exclusive) row in the table of edges; radius; friction coefficient."""
X, Y, MOVE_X, MOVE_Y = 4, 5, 6, 7
"""Origin at the start of the step and its displacement, world frame."""
PLAYED_X, PLAYED_Y, WET = 8, 9, 10
"""Of a probe: position behind the play, without drift; whether a meniscus stands at its tip."""
DEPTH = 11
"""Deepest penetration into the obstacle that is taken for one."""
FROM_X, FROM_Y = 12, 13
"""Of a probe: where its tip was at the start of the last step, world frame."""
OBSTACLE = 14
"""Columns of the table of obstacles."""


# The part.
MOVED, VELOCITY = 0, 3
"""First of three numbers each: displacement in the last step (body frame), velocity at its end (world
frame)."""
COS, SIN = 6, 7
"""Of the angle at which displacements are taken; see `stepping`."""
TIME, OLD, NEXT = 8, 9, 10
"""Time since the start of the run, age of the contact, first of three numbers of the displacement in
this step (body frame)."""
BODY = 13
"""Length of the vector of the part."""


class Work(NamedTuple):
    """Workspace of a run, for at most C contacts."""

    contacts: Floats
    """(C, CONTACT)"""
    marks: Ints
    """(C + 1, MARKS)"""
    step: Floats
    """(STEP,)"""
    system: Floats
    """(9, 3), for the guess of the modes."""
    matrix: Floats
    """(4C, 4C), M of the complementarity problem."""
    vector: Floats
    """(2, 4C): q and z."""
    tableau: Floats
    """(4C + 3, 4C), for Lemke's method."""
    labels: Ints
    """(16C + 2,), for Lemke's method."""


@maker
def workspace(contacts: int) -> Work:
    """Allocate the workspace of a run with at most `contacts` contacts."""
    n = 4 * contacts
    work = Work(
        np.zeros((contacts, CONTACT)),
        np.zeros((contacts + 1, MARKS), np.int64),
        np.zeros(STEP),
        np.zeros((9, 3)),
        np.zeros((n, n)),
        np.zeros((2, n)),
        np.zeros((n + 3, n)),
        np.zeros(4 * n + 2, np.int64),
    )
    for k in (0, 2, 5, 6):  # the factor of the unit matrix
        work.step[FACTOR + k] = 1.0
    return work
