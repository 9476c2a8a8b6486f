"""Quasi-static pushing by force balance alone, for many samples at once.

Every contact either sticks (the part's point moves with the tip, the force lies in the cone) or
slips (the force lies on the edge of the cone, against the slip); all combinations are tried. Forces
are in units of the film's drag, travel is that of the active tip along -x.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

STICK = 0
SLIPS = (-1, 1)
TOLERANCE = 1e-9
PAIRS = tuple(p for p in itertools.product((STICK, *SLIPS), repeat=2) if p != (STICK, STICK))


@dataclass(frozen=True)
class State:
    """Pose of the part and positions of the tips, one entry a sample, m and rad."""

    x: Floats
    y: Floats
    theta: Floats
    active_x: Floats
    active_y: Floats
    passive_x: Floats
    passive_y: Floats

    def moved(self, twist: Floats, step: float | Floats) -> State:
        return replace(
            self,
            x=self.x + step * twist[:, 0],
            y=self.y + step * twist[:, 1],
            theta=self.theta + step * twist[:, 2],
            active_x=self.active_x - step,
        )

    @property
    def along(self) -> Floats:
        return np.stack([np.cos(self.theta), np.sin(self.theta)], axis=1)

    @property
    def out(self) -> Floats:
        return np.stack([np.sin(self.theta), -np.cos(self.theta)], axis=1)

    @property
    def active_arm(self) -> Floats:
        return np.stack([self.active_x - self.x, self.active_y - self.y], axis=1)

    @property
    def passive_arm(self) -> Floats:
        return np.stack([self.passive_x - self.x, self.passive_y - self.y], axis=1)

    @property
    def slide(self) -> Floats:
        """Centre minus middle of the tips, along the edge."""
        return -0.5 * dots(self.active_arm + self.passive_arm, self.along)

    def passive_gap(self, depth: Floats) -> Floats:
        """Distance of the passive tip from its edge."""
        return dots(self.passive_arm, -self.out) - depth


def dots(p: Floats, q: Floats) -> Floats:
    return np.einsum("ij,ij->i", p, q)


def _velocity(arm: Floats, direction: Floats) -> Floats:
    """Row of (v_x, v_y, omega) for the velocity of the point at ``arm`` along ``direction``."""
    turn = arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]
    return np.column_stack([direction, turn])


def _solve(
    state: State, rho: Floats, mu: Floats, modes: tuple[int, ...]
) -> tuple[Floats, npt.NDArray[np.bool_]]:
    """Twist and forces in one combination of modes, and whether it is a solution."""
    count, size = rho.size, 3 + 2 * len(modes)
    matrix, right = np.zeros((count, size, size)), np.zeros((count, size))
    matrix[:, 0, 0] = matrix[:, 1, 1] = 1.0
    matrix[:, 2, 2] = rho
    along, out = state.along, state.out
    tips = ((state.active_arm, -out, -1.0), (state.passive_arm, out, 0.0))
    for k, mode in enumerate(modes):
        arm, inward, speed = tips[k]
        normal, shear = 3 + 2 * k, 4 + 2 * k
        matrix[:, :3, normal] = -_velocity(arm, inward)  # the wrench of a unit force is the same
        matrix[:, :3, shear] = -_velocity(arm, along)
        matrix[:, normal, :3], right[:, normal] = _velocity(arm, inward), speed * inward[:, 0]
        if mode == STICK:
            matrix[:, shear, :3], right[:, shear] = _velocity(arm, along), speed * along[:, 0]
        else:
            matrix[:, shear, shear], matrix[:, shear, normal] = 1.0, -mode * mu
    found: Floats = np.asarray(np.linalg.solve(matrix, right[:, :, None]), np.float64)[:, :, 0]
    valid = np.ones(count, dtype=bool)
    for k, mode in enumerate(modes):
        arm, _, speed = tips[k]
        pressing, rubbing = found[:, 3 + 2 * k], found[:, 4 + 2 * k]
        scale = TOLERANCE * np.abs(found[:, 3:]).max(axis=1)
        valid &= pressing >= -scale
        if mode == STICK:
            valid &= np.abs(rubbing) <= mu * pressing + scale
        else:
            slip = dots(_velocity(arm, along), found[:, :3]) - speed * along[:, 0]
            valid &= mode * slip <= TOLERANCE
    return found, valid


def solutions(
    state: State, rho: Floats, mu: Floats, contacts: int
) -> tuple[Floats, npt.NDArray[np.bool_]]:
    """All candidate motions (modes, samples, unknowns), and which of them are solutions."""
    modes: tuple[tuple[int, ...], ...] = (
        PAIRS if contacts == 2 else tuple((mode,) for mode in (STICK, *SLIPS))
    )
    both = [_solve(state, rho, mu, mode) for mode in modes]
    return np.stack([found for found, _ in both]), np.stack([valid for _, valid in both])


def twists(
    state: State, rho: Floats, mu: Floats, contacts: int, rng: np.random.Generator
) -> Floats:
    """The twist of one solution a sample, drawn among all that there are.

    Raises
    ------
    ValueError
        Some sample has no solution.
    """
    found, valid = solutions(state, rho, mu, contacts)
    if not valid.any(axis=0).all():
        raise ValueError("no contact mode has a solution")
    chosen = np.argmax(np.where(valid, rng.random(valid.shape), -1.0), axis=0)
    twist: Floats = found[chosen, np.arange(rho.size), :3]
    return twist


def push(
    state: State,
    rho: Floats,
    mu: Floats,
    contacts: int,
    step: float | Floats,
    rng: np.random.Generator,
) -> State:
    """One step of the active tip, by the midpoint rule."""
    half = state.moved(twists(state, rho, mu, contacts, rng), 0.5 * step)
    return state.moved(twists(half, rho, mu, contacts, rng), step)
