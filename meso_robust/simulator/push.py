"""One move for a batch of runs: what is pushed, how, and what came of it."""

from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from meso_robust.simulator.checks import (
    check_arrays,
    check_numbers,
    check_polygon,
    check_steps,
    check_tips_outside,
)

_F = npt.NDArray[np.float64]

_ROUNDING = 1e-9  # of a step, so that a travel of 10 steps is not cut into 11


@dataclass(frozen=True, slots=True, kw_only=True)
class Push:
    """One move for N runs of a part pushed by P point tips.

    Arrays are copied to float64 and made read-only. During the move all tips go along straight
    lines, each in the same proportion of its travel; only their path matters, not their speed.

    Attributes
    ----------
    vertices
        (V, 2) corners of the part in m, body frame, counter-clockwise, strictly convex, with the
        reference point (the centre of the film drag) as origin.
    poses
        (N, 3) x, y in m and θ in rad at the start, world frame.
    tips
        (N, P, 2) tips at the start in m, world frame.
    travel
        (N, P, 2) displacement of the tips during the move in m, world frame; zero for a passive
        tip, which stays where it is.
    friction
        (N,) μ between tip and part.
    film_ratio
        (N,) ρ = e_θ/e_x in m².
    step
        Longest tip displacement of one step in m.

    Raises
    ------
    ValueError
        If a shape or value is out of its rule, or if a tip starts inside the part.
    """

    vertices: _F
    poses: _F
    tips: _F
    travel: _F
    friction: _F
    film_ratio: _F
    step: float

    def __post_init__(self) -> None:
        """Copy, freeze and check the fields."""
        names = [field.name for field in fields(self) if field.name != "step"]
        arrays = {name: np.array(getattr(self, name), dtype=np.float64) for name in names}
        check_arrays(arrays)
        for name, array in arrays.items():
            array = np.ascontiguousarray(array)
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        check_polygon(self.vertices)
        check_numbers(self.friction, self.film_ratio, self.step)
        check_steps(self._longest(), self.step)
        check_tips_outside(self.vertices, self.poses, self.tips, self.step)

    def _longest(self) -> float:
        length = np.hypot(self.travel[..., 0], self.travel[..., 1])
        return float(np.max(length, initial=0.0))

    @property
    def steps(self) -> int:
        """Number of steps of every run: the longest travel over `step`, rounded up."""
        return int(np.ceil(self._longest() / self.step - _ROUNDING))


@dataclass(frozen=True, slots=True, kw_only=True)
class PushResult:
    """What a move did to the part in each of N runs.

    Attributes
    ----------
    poses
        (N, 3) x, y in m and θ in rad at the end, world frame, angles unwrapped; for a run that
        did not complete, the pose after the last step taken.
    outcomes
        (N,) values of `Outcome`, int8.
    max_penetration
        (N,) deepest penetration of a tip in m, from the start of the run to its end.
    path
        (N, record + 1, 3) poses at evenly spaced parts of the move, the start and the end
        included, the last pose repeated after a run has ended; (N, 0, 3) without a record.
    steps
        Number of steps of the move.
    """

    poses: _F
    outcomes: npt.NDArray[np.int8]
    max_penetration: _F
    path: _F
    steps: int
