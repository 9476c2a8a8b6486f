"""The world of one set: the physics, the part as it truly is, and one push in it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from reports.blind.camera import Camera
from reports.blind.kernel import simulate
from reports.blind.laws import Laws

Floats = npt.NDArray[np.float64]

LENGTH, WIDTH = 1616.0, 837.0
"""Stated extent of the part, um."""
TIP_RADIUS = 12.5
"""Stated radius of the tip, um."""
STEP = 8e-5
"""Time step, s: shorter than the time in which tip and part swing, by 2π."""
FINE, COARSE = (10, 6), (2, 2)
"""Nodes along and across the footprint; the coarse ones are exact for a drag linear in speed."""
UNEVEN_LAWS = (
    "dry", "stribeck", "ageing", "uneven", "thinning", "quadratic", "patch",
    "gradient_x", "gradient_y",
)  # fmt: skip
"""Laws by which the drag is not the same linear one all over the footprint."""


@dataclass(frozen=True, slots=True, eq=False)
class Push:
    """One recording's command: corners of the tip's path, the pose that it meets, frame times."""

    times: Floats
    """(K,) times of the corners, s."""
    way: Floats
    """(K, 2) places of the tip, um."""
    start: Floats
    """(3,) true pose of the part at time 0, um and rad."""
    frames: Floats
    """(T,) times of the frames, s."""

    def commands(self) -> Floats:
        """(T, 2) commanded place of the tip at the frames."""
        columns = [np.interp(self.frames, self.times, self.way[:, k]) for k in range(2)]
        return np.stack(columns, axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class World:
    """Physics, camera, and by how much each pair of edges of the true part stands out, um."""

    laws: Laws = field(default_factory=Laws)
    camera: Camera = field(default_factory=Camera)
    excess: tuple[float, float] = (0.0, 0.0)

    def outline(self) -> Floats:
        """(4, 2) corners of the true part, counter-clockwise from (-, -)."""
        half = np.array([0.5 * LENGTH, 0.5 * WIDTH]) + self.excess
        return np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * half


def footprint(laws: Laws) -> Floats:
    """(Q, 3) nodes of equal weight over the wetted footprint, and the relative pressure there.

    The nodes are at ±1/√3 of equal cells, which integrates cubics exactly. The pressure is linear
    with its centre at the place that the laws state for uneven support.
    """
    quadrature = FINE if any(getattr(laws, name) for name in UNEVEN_LAWS) else COARSE
    axes = []
    for side, count in zip((LENGTH, WIDTH), quadrature, strict=True):
        centres = 2.0 * np.arange(count // 2) + 1.0 - count // 2
        offsets = np.array([-1.0, 1.0]) / np.sqrt(3.0)
        unit = (centres[:, None] + offsets).ravel() / (count // 2)
        axes.append(0.5 * laws.footprint * side * unit)
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    centre = np.array([laws.uneven_x, laws.uneven_y])
    pressure = 1.0 + nodes @ (centre / np.mean(nodes**2, axis=0))
    return np.column_stack([nodes + np.array([laws.centre_x, laws.centre_y]), pressure])


def rho(laws: Laws) -> float:
    """Square of the film's radius of gyration about the reference point, by quadrature, um²."""
    return float(np.mean(np.sum(footprint(laws)[:, :2] ** 2, axis=1)))


def run(world: World, push: Push, samples: Floats, step: float = STEP) -> tuple[Floats, Floats]:
    """Poses (S, 3) at the sample times and the tip's contact (S, 7) (see `kernel.simulate`)."""
    path = np.column_stack([push.times, push.way])
    nodes, outline = footprint(world.laws), world.outline()
    return simulate(world.laws, outline, nodes, path, push.start, samples, step)


def filmed(world: World, push: Push) -> Floats:
    """Seen poses (T, 3) at the frames of a push, without noise."""
    exposures = np.maximum.accumulate(world.camera.exposures(push.frames))
    poses, _ = run(world, push, exposures)
    return world.camera.see(poses, push.frames)
