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


class _Contacts(NamedTuple):
    """Columns of the table of contacts: geometry, the rows of the problem (see `rows`), its solution."""

    gap: int = 0
    nx: int = 1
    """Of the normal, outward from the part."""
    ny: int = 2
    px: int = 3
    """Of the point of the part."""
    py: int = 4
    dx: int = 5
    """Of the displacement of the obstacle in the step."""
    dy: int = 6
    mu: int = 7
    pull: int = 8
    """Attraction over e_x, m/s."""
    qn: int = 9
    qt: int = 10
    wn: int = 11
    """First of three, of w_n."""
    wt: int = 14
    """First of three, of w_t."""
    ln: int = 17
    """λ_n."""
    lt: int = 18
    """λ_t."""


CONTACTS, CONTACT_COLUMNS = _Contacts(), 19


class _Marks(NamedTuple):
    """Columns of the table of marks, one contact a row; its last row holds how many old ones there are."""

    who: int = 0
    """Obstacle."""
    feature: int = 1
    mode: int = 2
    old_who: int = 3
    """The same of the contacts of the last step."""
    old_feature: int = 4
    old_mode: int = 5
    active: int = 6
    """Contacts in the complementarity problem."""


MARKS, MARK_COLUMNS = _Marks(), 7


class _Step(NamedTuple):
    """Entries of the vector of the step."""

    motion: int = 0
    """First of three: motion Δ', in units (see `rows`)."""
    shift: int = 3
    """First of three: motion without contact s', in units."""
    factor: int = 6
    """First of seven: lower triangle of L⁻¹ by rows, and k."""
    soft: int = 13
    """First of three: compliance of the probes, a symmetric matrix by rows; zero for stiff ones."""
    contacts: int = 16
    """How many there are."""


STEP, STEP_LENGTH = _Step(), 17


class _Obstacles(NamedTuple):
    """Columns of the table of obstacles, one a row; world frame."""

    first: int = 0
    """First row in the table of edges."""
    last: int = 1
    """Row after the last in the table of edges."""
    radius: int = 2
    friction: int = 3
    x: int = 4
    """Of the origin at the start of the step."""
    y: int = 5
    move_x: int = 6
    """Of its displacement in the step."""
    move_y: int = 7
    played_x: int = 8
    """Of a probe, with y after it: position behind the play, without drift."""
    wet: int = 10
    """Of a probe: whether a meniscus stands at its tip."""
    depth: int = 11
    """Deepest penetration into the obstacle that is taken for one."""
    from_x: int = 12
    """Of a probe: where its tip was at the start of the last step."""
    from_y: int = 13
    mount: int = 14
    """Of a probe: the first one that moves as it does, as both are carried by one mount."""
    slip: int = 15
    """Of a probe: speed in m/s at which its tip slipped along the part in the last step."""
    command_x: int = 16
    """Of a probe whose drive creeps: command at the start of the step, and what creeps after it; then both along y."""
    command_y: int = 18


OBSTACLES, OBSTACLE_COLUMNS = _Obstacles(), 20


class _Part(NamedTuple):
    """Entries of the vector of the part."""

    moved: int = 0
    """First of three: displacement in the last step, body frame."""
    velocity: int = 3
    """First of three: velocity at the end of the last step, world frame."""
    cos: int = 6
    """Of the angle at which displacements are taken; see `stepping`."""
    sin: int = 7
    time: int = 8
    """Since the start of the run."""
    old: int = 9
    """Age of the contact."""
    next: int = 10
    """First of three: displacement in this step, body frame."""
    place: int = 13
    """First of two: x and y at the start of the step, world frame."""


PART, PART_LENGTH = _Part(), 15


class Work(NamedTuple):
    """Workspace of a run, for at most C contacts."""

    contacts: Floats
    """(C, CONTACT_COLUMNS)"""
    marks: Ints
    """(C + 1, MARK_COLUMNS)"""
    step: Floats
    """(STEP_LENGTH,)"""
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
        np.zeros((contacts, CONTACT_COLUMNS)),
        np.zeros((contacts + 1, MARK_COLUMNS), np.int64),
        np.zeros(STEP_LENGTH),
        np.zeros((9, 3)),
        np.zeros((n, n)),
        np.zeros((2, n)),
        np.zeros((n + 3, n)),
        np.zeros(4 * n + 2, np.int64),
    )
    for k in (0, 2, 5, 6):  # the factor of the unit matrix
        work.step[STEP.factor + k] = 1.0
    return work
