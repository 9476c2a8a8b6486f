"""One run as the kernels see it: what is given, what it carries from step to step, which laws it needs."""

from typing import NamedTuple

import numpy as np

from meso_robust.kernels import maker, sealed
from meso_robust.simulator.actuation import COMPLIANCE, DRIVE_SLOTS, mount_of, screwed
from meso_robust.simulator.environment import FORCE_SLOTS
from meso_robust.simulator.residual import RESIDUAL_SLOTS
from meso_robust.simulator.scene import Scene
from meso_robust.simulator.support import DRY, DRY_SLOTS, FILM_SLOTS
from meso_robust.simulator.tables import OBSTACLES, PART_LENGTH
from meso_robust.simulator.touch import PULL_SLOTS
from meso_robust.types import Floats

FILM, SURFACE, INERTIA, IDLE, UNIQUE, AHEAD, LAY = 0, 6, 12, 17, 18, 19, 20
"""First of six numbers each of film and limit surface, of five of the motion model; the unit of length
of a step in which no tip moves; whether to look for a second motion in every step; by how many turns
of the last step the angle of displacements is ahead; first of four of the stage's lay."""
LAW = 24
"""Length of the vector of the law."""


class Case(NamedTuple):
    """One run as the kernels see it; SI, forces over the film's translational drag."""

    scene: Scene
    obstacles: Floats
    """(O, OBSTACLE) table of `tables`: the probes, then what does not move."""
    waypoints: Floats
    """(T, P, 2) commanded positions of the probes, world frame; a third number is the friction of the
    leg that starts there."""
    legs: Floats
    """(T, 2) times of the waypoints, and steps to the next."""
    law: Floats
    """(LAW,) film, limit surface, motion model and choices."""
    points: Floats
    """(K, 4) x, y, strength and share of the area of the dry points."""
    effects: Floats
    """(S,) table of effects."""


FILM_NOW, TANGENT, OFFSET, TWIST_NOW, TWIST_NEW, WRENCH, TWIST_LAST, BEFORE = (
    0,
    1,
    2,
    3,
    4,
    5,
    6,
    7,
)
"""Rows of the workspace of a run; see `State.space`."""


class State(NamedTuple):
    """What a run carries from step to step."""

    obstacles: Floats
    """(O, OBSTACLE) of this run."""
    body: Floats
    """(PART_LENGTH,) vector of the part."""
    dry: Floats
    """(K, DRY) table of the dry points, see `support.DRY`."""
    space: Floats
    """(8, 6) workspace: film matrix, tangent, offset, twist, new twist (each of the two with what it was
    before, in the last three columns), wrench of the stage, last twist, last pose."""


@sealed
def _any(effects: Floats, slots: tuple[int, ...]) -> bool:
    """Whether one of the columns is not zero."""
    on = False
    for slot in slots:
        on |= effects[slot] != 0.0
    return on


@maker
def new_state(case: Case) -> State:
    """State at the start of a run."""
    state = State(
        case.obstacles.copy(),
        np.zeros(PART_LENGTH),
        np.zeros((case.points.shape[0], DRY)),
        np.zeros((8, 6)),
    )
    driven = _any(case.effects, DRIVE_SLOTS)
    for p in range(case.waypoints.shape[1]):
        mount = mount_of(case.effects, case.waypoints, p) if driven else p
        state.obstacles[p, OBSTACLES.mount] = mount
        for a in range(2):
            place = case.waypoints[0, mount, a]
            state.obstacles[p, OBSTACLES.x + a] = case.waypoints[0, p, a]
            if driven:
                state.obstacles[p, OBSTACLES.x + a] += screwed(case.effects, a, place)
            state.obstacles[p, OBSTACLES.played_x + a] = case.waypoints[0, p, a]
            for k in range(2):
                state.obstacles[p, OBSTACLES.command_x + 2 * a + k] = case.waypoints[0, p, a]
    for k in range(6):
        state.space[FILM_NOW, k] = case.law[FILM + k]
    return state


class Kind(NamedTuple):
    """Which laws a run needs, decided once."""

    plain: bool
    """Film with a constant matrix and stiff probes; nothing but tips and fixture acts."""
    driven: bool
    """Play or drift between command and probe."""
    dry: bool
    """A law that is not linear in the twist."""
    changing: bool
    """A film matrix that depends on pose or time."""
    forced: bool
    """Forces other than those of contacts."""
    pulled: bool
    """Tips that draw the part."""
    unnamed: bool
    """A residual wrench."""


@sealed
def kind_of(case: Case) -> Kind:
    """Tell which laws a run needs."""
    e = case.effects
    dry = _any(e, DRY_SLOTS) or case.law[SURFACE] > 0.0
    for i in range(case.points.shape[0]):
        dry |= case.points[i, 2] > 0.0
    changing = _any(e, FILM_SLOTS) or case.law[LAY] != 0.0 or case.law[LAY + 1] != 0.0
    pulled = _any(e, PULL_SLOTS)
    unnamed = _any(e, RESIDUAL_SLOTS)
    forced = _any(e, FORCE_SLOTS) or pulled or unnamed
    plain = not (dry or changing or forced) and e[COMPLIANCE] == 0.0 and case.law[INERTIA] == 0.0
    return Kind(plain, _any(e, DRIVE_SLOTS), dry, changing, forced, pulled, unnamed)
