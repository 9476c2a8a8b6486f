"""What is claimed of all that a move passes, held against simulated runs of it.

Some inequalities are proved along a whole motion; their stated box does not say at which states.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.conditions import values
from meso_robust.laboratory.draws import Draws
from meso_robust.laboratory.running import MoveRun
from meso_robust.primitives.names import Inequality
from meso_robust.primitives.setup import Setup
from meso_robust.types import Floats


@dataclass(frozen=True, eq=False)
class Travelled:
    """One move of N runs, its path recorded at K instants."""

    move: MoveRun
    draws: Draws
    setup: Setup

    @property
    def tips(self) -> Floats:
        """(N, K, P, 2) where the tips are, m."""
        share = np.linspace(0.0, 1.0, self.move.path.shape[1])[:, None, None]
        return self.move.tips[:, None] + share * self.move.travel[:, None]

    def along(self) -> Floats:
        """(N, K, P) place of each tip along the part's long axis, m."""
        x, y, theta = (self.move.path[..., None, k] for k in range(3))
        tips = self.tips
        return np.asarray(np.cos(theta) * (tips[..., 0] - x) + np.sin(theta) * (tips[..., 1] - y))


def edge_margin(run: Travelled) -> float:
    """Rotation: how far both tips stay from the ends of their edges, m."""
    lower, passive = run.along()[..., 1], run.along()[..., 2]
    touching = _both_touch(run)
    reach = np.maximum(np.abs(lower), np.abs(passive))[touching]
    return float(run.setup.half_length.mid - reach.max())


def passive_force(run: Travelled) -> float:
    """Rotation: force at the passive tip, whichever way the contacts slip."""
    touching = _both_touch(run)
    lower, passive = run.tips[..., 1, :], run.tips[..., 2, :]
    y, theta = run.move.path[..., 1], run.move.path[..., 2]
    middle = 0.5 * (lower[..., 1] + passive[..., 1])
    shape = touching.shape
    friction = np.broadcast_to(run.draws.friction[:, None], shape)[touching]
    state = {
        "h": (lower - passive)[..., 0][touching],
        "V": (lower - passive)[..., 1][touching],
        "d1": run.setup.half_width.mid,
        "sigma": ((y - middle) / np.sin(theta))[touching],
        "rho": np.broadcast_to(run.draws.film_ratio[:, None], shape)[touching],
    }
    force = values("two_sided_rotation", "passive_force")
    signs = ((one, two) for one in (-1.0, 1.0) for two in (-1.0, 1.0))
    return min(
        float(force(**state, tau_D=one * friction, tau_S=two * friction)[0].min())
        for one, two in signs
    )


def travel_to_spare(run: Travelled) -> float:
    """Straightening: travel that is left when both tips have touched, m.

    Too large by up to the travel between two instants.
    """
    both = (run.move.modes[..., 0] > 0) & (run.move.modes[..., 1] > 0)
    instants = both.shape[1] - 1
    last_before = np.where(both.any(axis=1), both.argmax(axis=1) - 1, instants)
    travel = np.linalg.norm(run.move.travel[:, 0], axis=-1)
    return float((travel * (1.0 - last_before / instants)).min())


def _both_touch(run: Travelled) -> npt.NDArray[np.bool_]:
    """(N, K) when the lower tip and the passive one are both in contact."""
    return np.asarray((run.move.modes[..., 1] > 0) & (run.move.modes[..., 2] > 0))


def largest_force(run: Travelled) -> float:
    """Force of any tip at the largest drag and the fastest travel that the task allows, N."""
    drag, speed, forces = run.setup.drag, run.setup.speed, run.move.forces
    if drag is None or speed is None or forces is None:
        return np.inf
    fastest = speed.hi * (1.0 + run.setup.uncertainty.travel_scale.hi)
    return float(drag.hi * fastest * np.linalg.norm(forces, axis=-1).max())


def part_distance(run: Travelled) -> float:
    """Distance of part and walls along one of their sides, m."""
    path = run.move.path
    a, b = run.setup.half_length.mid, run.setup.half_width.mid
    c, s = np.cos(path[..., 2]), np.sin(path[..., 2])
    along, across = np.abs(c), np.abs(s)

    def gap(middle: Floats, half: Floats) -> Floats:
        x, y = path[..., 0] - middle[0], path[..., 1] - middle[1]
        return np.max(
            [
                np.abs(x) - half[0] - a * along - b * across,
                np.abs(y) - half[1] - a * across - b * along,
                np.abs(x * c + y * s) - a - half[0] * along - half[1] * across,
                np.abs(y * c - x * s) - b - half[0] * across - half[1] * along,
            ],
            axis=0,
        )

    return min(float(gap(*block).min()) for block in _blocks(run.setup))


def tip_distance(run: Travelled) -> float:
    """Distance of tips and walls along x or y, which holds for a whole way; m."""
    tips = run.tips

    def gap(middle: Floats, half: Floats) -> Floats:
        sides = np.stack([tips - middle - half, middle - half - tips])
        return np.asarray(sides.min(axis=2).max(axis=(0, -1)))  # over instants, then directions

    return min(float(gap(*block).min()) for block in _blocks(run.setup))


def _blocks(setup: Setup) -> Iterator[tuple[Floats, Floats]]:
    """Middle and half size of each wall, m."""
    for block in setup.blocks:
        low = np.array([block.x.lo, block.y.lo])
        high = np.array([block.x.hi, block.y.hi])
        yield 0.5 * (low + high), 0.5 * (high - low)


ALONG: Mapping[str, Callable[[Travelled], float]] = {
    Inequality.PASSIVE_FORCE: passive_force,
    Inequality.ENDS_OF_EDGES: edge_margin,
    Inequality.TRAVEL_TO_SPARE: travel_to_spare,
    Inequality.PART_TO_WALL: part_distance,
    Inequality.TIP_TO_WALL: tip_distance,
}
"""The smallest value that runs show of each inequality that is proved along a motion."""
