"""A part between two round tips by balance, contact and Coulomb's law alone, for many samples at once.

World axes: the active tip moves along -x, the passive one rests. Any drag about any centre, edges of any
depth that need not be parallel. Each contact sticks or slips either way; all combinations are tried.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
STICK = 0
MODES = tuple(itertools.product((STICK, -1, 1), repeat=2))
TOLERANCE = 1e-9


@dataclass(frozen=True)
class Part:
    """What is constant; one entry a sample, SI."""

    depth: Floats
    depth_far: Floats
    radius: Floats
    radius_far: Floats
    kappa: Floats
    drag_a: Floats
    drag_n: Floats
    rho: Floats
    stretch: Floats
    shear: Floats
    mu: Floats
    mu_far: Floats


@dataclass(frozen=True)
class State:
    """Reference point, direction of the active tip's edge, both tips' centres."""

    x: Floats
    y: Floats
    theta: Floats
    active: Floats
    passive: Floats

    def moved(self, twist: Floats, step: float) -> State:
        return replace(
            self,
            x=self.x + step * twist[:, 0],
            y=self.y + step * twist[:, 1],
            theta=self.theta + step * twist[:, 2],
            active=self.active - step * np.array([1.0, 0.0]),
        )

    @property
    def h(self) -> Floats:
        return self.active[:, 0] - self.passive[:, 0]

    def slide(self, part: Part) -> Floats:
        """The reference point ahead of the passive tip along that tip's edge."""
        off = np.stack([self.x, self.y], axis=1) - self.passive
        return np.einsum("ij,ij->i", off, unit(self.theta + part.kappa))


def unit(angle: Floats) -> Floats:
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def gripped(part: Part, h: Floats, V: Floats, q: Floats) -> State:
    """The part between both tips, the passive one at the origin; the orientation by bisection."""
    active = np.stack([h, V], axis=1)
    low, high = np.full(h.size, 0.3), np.full(h.size, 3.1)

    def gap(theta: Floats) -> Floats:
        far = unit(theta + part.kappa)
        out = np.stack([far[:, 1], -far[:, 0]], axis=1)
        point = q[:, None] * far + (part.depth_far + part.radius_far)[:, None] * out
        normal = np.stack([np.sin(theta), -np.cos(theta)], axis=1)
        return np.einsum("ij,ij->i", active - point, normal) - part.depth - part.radius

    for _ in range(80):
        middle = 0.5 * (low + high)
        positive = gap(middle) > 0.0
        high, low = np.where(positive, middle, high), np.where(positive, low, middle)
    theta = 0.5 * (low + high)
    far = unit(theta + part.kappa)
    out = np.stack([far[:, 1], -far[:, 0]], axis=1)
    point = q[:, None] * far + (part.depth_far + part.radius_far)[:, None] * out
    return State(
        x=point[:, 0], y=point[:, 1], theta=theta, active=active, passive=np.zeros_like(active)
    )


def _row(arm: Floats, direction: Floats) -> Floats:
    turn = arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]
    return np.column_stack([direction, turn])


def _film(state: State, part: Part) -> Floats:
    """(N, 3, 3) drag about the reference point in world axes, over e_x."""
    along = unit(state.theta)
    out = np.stack([along[:, 1], -along[:, 0]], axis=1)
    frame = np.stack([along, out], axis=1)
    own = np.zeros((part.rho.size, 2, 2))
    own[:, 0, 0], own[:, 1, 1] = 1 + part.stretch, 1 - part.stretch
    own[:, 0, 1] = own[:, 1, 0] = part.shear
    plane = np.einsum("nki,nkl,nlj->nij", frame, own, frame)
    centre = part.drag_a[:, None] * along + part.drag_n[:, None] * out
    to_centre = np.zeros((part.rho.size, 2, 3))
    to_centre[:, 0, 0] = to_centre[:, 1, 1] = 1.0
    to_centre[:, 0, 2], to_centre[:, 1, 2] = -centre[:, 1], centre[:, 0]
    whole = np.einsum("nki,nkl,nlj->nij", to_centre, plane, to_centre)
    whole[:, 2, 2] += part.rho
    return whole


def solutions(state: State, part: Part) -> tuple[Floats, npt.NDArray[np.bool_]]:
    """(modes, N, 7) twist and (normal, along) at D and S; and which are solutions."""
    count = part.rho.size
    film, place = _film(state, part), np.stack([state.x, state.y], axis=1)
    tips = []
    for centre, angle, round_, side, mu in (
        (state.active, state.theta, part.radius, 1.0, part.mu),
        (state.passive, state.theta + part.kappa, part.radius_far, -1.0, part.mu_far),
    ):
        along = unit(angle)
        out = side * np.stack([along[:, 1], -along[:, 0]], axis=1)
        tips.append((centre - round_[:, None] * out - place, along, -out, mu))
    speeds = np.array([[-1.0, 0.0], [0.0, 0.0]])
    found, valid = [], []
    for modes in MODES:
        matrix, right = np.zeros((count, 7, 7)), np.zeros((count, 7))
        matrix[:, :3, :3] = film
        for k, mode in enumerate(modes):
            arm, along, inward, mu = tips[k]
            normal, rub = 3 + 2 * k, 4 + 2 * k
            matrix[:, :3, normal], matrix[:, :3, rub] = -_row(arm, inward), -_row(arm, along)
            matrix[:, normal, :3], right[:, normal] = _row(arm, inward), inward @ speeds[k]
            if mode == STICK:
                matrix[:, rub, :3], right[:, rub] = _row(arm, along), along @ speeds[k]
            else:
                matrix[:, rub, rub], matrix[:, rub, normal] = 1.0, -mode * mu
        if modes == (STICK, STICK):
            continue  # four conditions on three speeds
        solved = np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
        good = np.ones(count, dtype=bool)
        for k, mode in enumerate(modes):
            arm, along, _, mu = tips[k]
            press, shear = solved[:, 3 + 2 * k], solved[:, 4 + 2 * k]
            scale = TOLERANCE * np.abs(solved[:, 3:]).max(axis=1)
            good &= press >= -scale
            if mode == STICK:
                good &= np.abs(shear) <= mu * press + scale
            else:
                slip = np.einsum("ij,ij->i", _row(arm, along), solved[:, :3]) - along @ speeds[k]
                good &= mode * slip <= TOLERANCE
        found.append(solved)
        valid.append(good)
    return np.stack(found), np.stack(valid)


def push(state: State, part: Part, step: float, rng: np.random.Generator) -> State:
    """One step by the midpoint rule, in one of the motions that are possible.

    Raises
    ------
    ValueError
        Some sample has none.
    """
    half = state.moved(_twist(state, part, rng), 0.5 * step)
    return state.moved(_twist(half, part, rng), step)


def _twist(state: State, part: Part, rng: np.random.Generator) -> Floats:
    found, valid = solutions(state, part)
    if not valid.any(axis=0).all():
        raise ValueError("no contact mode has a solution")
    chosen = np.argmax(np.where(valid, rng.random(valid.shape), -1.0), axis=0)
    return np.asarray(found[chosen, np.arange(part.rho.size), :3])
