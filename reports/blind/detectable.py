"""The just-detectable size of an effect: five standard deviations, nuisance projected out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from reports.blind.camera import Sensor
from reports.blind.world import Push, World, filmed

Floats = npt.NDArray[np.float64]

LIMIT = 5.0
"""Norm of the signature in white noise at which an effect is just detectable."""
CLOSE = (4.0, 6.3)
"""Norms that count as that: it is a scale for sizes, not a measurement."""
TRIALS = 7
NUDGES = (0.5, 0.5, np.radians(0.03))
"""Steps of finite differences in the start pose, um and rad."""
MU_STEP, FOOTPRINT_STEP = 0.004, 0.005


@dataclass(frozen=True, slots=True, eq=False)
class Nuisance:
    """What the data are without an effect, and how they answer to what is not known either."""

    base: list[Floats]
    """(T, 3) seen poses of every push."""
    sigmas: Floats
    """(3,) of the sensor, um and rad."""
    local: list[Floats]
    """Orthonormal (3 T, 3) bases of the answers to the start pose of every push."""
    common: Floats
    """Orthonormal (N, 2) basis of the answers to friction and footprint, clear of the local."""

    def left(self, seen: Sequence[Floats]) -> Floats:
        """(N,) difference from the base in standard deviations, less what nuisance explains."""
        parts = [(a - b) / self.sigmas for a, b in zip(seen, self.base, strict=True)]
        clear = _clear([part.ravel() for part in parts], self.local)
        return clear - self.common @ (self.common.T @ clear)

    def size_of(self, seen: Sequence[Floats]) -> float:
        """Norm of what is left."""
        return float(np.linalg.norm(self.left(seen)))


def _clear(parts: Sequence[Floats], local: Sequence[Floats]) -> Floats:
    pairs = zip(parts, local, strict=True)
    return np.concatenate([part - basis @ (basis.T @ part) for part, basis in pairs])


def nuisance(world: World, pushes: Sequence[Push], sensor: Sensor) -> Nuisance:
    """Base and answers to nuisance of a world, by finite differences."""
    sigmas = sensor.sigmas
    base = [filmed(world, push) for push in pushes]
    local = []
    for push, seen in zip(pushes, base, strict=True):
        columns = []
        for nudge in np.diag(NUDGES):
            other = filmed(world, replace(push, start=push.start + nudge))
            columns.append(((other - seen) / sigmas).ravel())
        local.append(np.linalg.qr(np.stack(columns, axis=1))[0])
    laws = world.laws
    columns = []
    for near in (
        laws._replace(mu=laws.mu + MU_STEP),
        laws._replace(footprint=laws.footprint + FOOTPRINT_STEP),
    ):
        others = [filmed(replace(world, laws=near), push) for push in pushes]
        pairs = zip(others, base, strict=True)
        columns.append(_clear([((a - b) / sigmas).ravel() for a, b in pairs], local))
    common = np.linalg.qr(np.stack(columns, axis=1))[0]
    return Nuisance(base, sigmas, local, common)


def just_detectable(norm: Callable[[float], float], guess: float, most: float) -> float:
    """Size at which `norm(size)` is about `LIMIT`; the limit of sizes if it never is.

    Parameters
    ----------
    norm
        Norm of the signature of a size.
    guess, most
        Size to start from, largest that makes sense.
    """
    size, low, high = min(guess, most), 0.0, np.inf
    for _ in range(TRIALS):
        found = norm(size)
        if CLOSE[0] <= found <= CLOSE[1]:
            return size
        if found < LIMIT:
            low = size
        else:
            high = size
        if low >= most:
            return most
        size *= float(np.clip(LIMIT / max(found, 1e-9), 0.03, 30.0))
        if not low < size < high:
            size = float(np.sqrt(max(low, 0.01 * high) * min(high, 100.0 * low + 1e-12)))
        size = min(size, most)
    return size
