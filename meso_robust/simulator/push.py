"""One move for a batch of runs: what is pushed, how, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from meso_robust.simulator.actuation import true_starts
from meso_robust.simulator.checks import (
    START_DEPTH,
    check_arrays,
    check_effects,
    check_legs,
    check_numbers,
    check_radii,
    check_start,
    check_steps,
    check_tables,
    check_thickness,
)
from meso_robust.simulator.effects import Effects
from meso_robust.simulator.fixture import Fixture
from meso_robust.simulator.geometry import GEOMETRY
from meso_robust.simulator.motion_model import MotionModel, QuasiStatic
from meso_robust.simulator.observation import OBSERVATION
from meso_robust.simulator.outline import check_parts, refuse, thickness
from meso_robust.simulator.stage import REFERENCE_SPEED, SLOTS
from meso_robust.simulator.support_models import Film, Support
from meso_robust.simulator.tips import Point, Tip
from meso_robust.types import Floats, Ints

_ROUNDING = 1e-9  # of a step, so that a travel of 10 steps is not cut into 11
_RATES = tuple(
    column
    for column in range(SLOTS)
    if not any(s.base <= column < s.base + s.slots for s in (GEOMETRY, OBSERVATION))
)  # columns of effects that act in time
_ARRAYS = ("vertices", "poses", "waypoints", "times", "friction", "radii")


def leg_times(legs: Floats, speed: float) -> Floats:
    """Times at which the legs of a move begin and end.

    Parameters
    ----------
    legs
        (N, L, P, 2) displacements of the probes, m.
    speed
        Of the fastest probe, m/s.

    Returns
    -------
    Floats
        (N, L + 1) s; a leg in which no probe moves takes a second.

    Raises
    ------
    ValueError
        If the speed is not positive.
    """
    if not 0.0 < speed < np.inf:
        raise ValueError(f"speed: {speed} m/s; must be positive and finite; try 75e-6 m/s")
    longest = np.hypot(legs[..., 0], legs[..., 1]).max(axis=2, initial=0.0)
    duration = np.where(longest > 0.0, longest / speed, 1.0)
    return np.concatenate([np.zeros((len(legs), 1)), np.cumsum(duration, axis=1)], axis=1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Push:
    """One move for N runs of a part met by P probes.

    Arrays are copied to float64 and made read-only. An array whose leading length is 1 holds for
    all runs. On a film alone only the path of the tips matters, not their speed.

    Attributes
    ----------
    vertices
        (V, 2) corners of the part in m, body frame, counter-clockwise, convex or not, with the
        reference point as origin; or (1|N, V, 2) of parts of one shape that differ a little.
    poses
        (N, 3) x, y in m and θ in rad at the start, world frame.
    waypoints
        (1|N, T, P, 2) commanded positions of the probes in m, world frame, joined by straight lines.
    times
        (1|N, T) of the waypoints in s, increasing.
    friction
        (1|N, P) μ between each probe and the part; (N,) for the same at all probes is taken as well,
        and (1|N, T − 1, P) for others between each two waypoints.
    support
        What the part slides on.
    shapes
        Shapes of the P tips; without any, points.
    radii
        (1|N, P) radii of points and round tips in m, where they are not those of the shapes.
    legs
        (1|N,) legs that a run goes, from the first waypoint; then it is at its end. All, if none are given.
    fixture
        Solids at rest.
    effects
        Physics beyond the plain model.
    motion
        What resists besides the support.
    step
        Longest tip displacement of one step in m.
    time_step
        Longest duration of one step in s; matters only where something goes on without the tips.
    frame
        Where in a step displacements are turned between world and body: about its middle (second
        order), or at its start (first order, eq. 2 of the paper).
    lengths
        (T − 1,) longest displacement of any probe of any run between two waypoints in m; follows from
        these.
    steps_of_legs
        (1|N, T − 1) steps between two waypoints: by length as many for every run, by time as a run takes;
        follows as well.

    Raises
    ------
    ValueError
        If a shape or value is out of its rule, or if the part starts inside a tip or the fixture.
    """

    vertices: Floats
    poses: Floats
    waypoints: Floats
    times: Floats
    friction: Floats
    support: Support
    step: float
    shapes: tuple[Tip, ...] = ()
    radii: Floats = field(default_factory=lambda: np.zeros((0, 0)))
    legs: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    fixture: Fixture = field(default_factory=Fixture)
    effects: Effects = field(default_factory=Effects)
    motion: MotionModel = field(default_factory=QuasiStatic)
    time_step: float = 0.02
    frame: Literal["middle", "start"] = "middle"
    lengths: Floats = field(init=False)
    steps_of_legs: Ints = field(init=False)

    def __post_init__(self) -> None:
        """Copy, freeze and check the fields."""
        arrays = {name: np.array(getattr(self, name), dtype=np.float64) for name in _ARRAYS}
        if arrays["friction"].ndim == 1 and arrays["waypoints"].ndim == 4:
            arrays["friction"] = np.repeat(
                arrays["friction"][:, None], arrays["waypoints"].shape[2], axis=1
            )
        check_arrays(arrays, len(self.shapes))
        for name, array in arrays.items():
            array = np.ascontiguousarray(array)
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        if not self.shapes:
            object.__setattr__(self, "shapes", (Point(),) * self.waypoints.shape[2])
        way = np.diff(self.waypoints, axis=1)
        lengths = np.hypot(way[..., 0], way[..., 1]).max(axis=(0, 2), initial=0.0)
        object.__setattr__(self, "lengths", lengths)
        check_parts(self.outlines)
        check_numbers(self.friction_of_legs, self.times, self.step, self.time_step)
        check_radii(self.radii, self.shapes)
        check_legs(self.legs, len(self.poses), len(self.lengths))
        check_tables(self.support.tables(), self.effects, len(self.poses))
        check_effects(self.effects, self.vertices.shape[-2], self.motion)
        if self.frame not in ("middle", "start"):
            refuse("frame", repr(self.frame), 'must be "middle" or "start"', "leave it out")
        object.__setattr__(self, "steps_of_legs", self._steps())
        check_steps(
            step=self.step,
            longest=float(self.lengths.max(initial=0.0)),
            time_step=self.time_step,
            steps=self.steps,
            times=self.times,
        )
        check_thickness(self.step, self.thickness, self.shapes, self.fixture)
        check_start(
            self.poses,
            self.vertices,
            true_starts(self.effects.table, self.waypoints),
            self.shapes,
            self.radii_of_tips,
            self.fixture,
            self.effects,
            START_DEPTH * self.step,
        )

    @classmethod
    def straight(
        cls,
        *,
        tips: Floats,
        travel: Floats,
        film_ratio: Floats | float | None = None,
        speed: float = REFERENCE_SPEED,
        **rest: object,
    ) -> Push:
        """Push along straight lines, all probes at once, from start to end.

        Parameters
        ----------
        tips
            (N, P, 2) probes at the start in m, world frame.
        travel
            (N, P, 2) their displacements in m; zero for a passive probe.
        film_ratio
            ρ in m², a number or (N,), for the film ``diag(1, 1, ρ)``; or give `support`.
        speed
            Of the fastest probe of each run, m/s.
        rest
            Further fields of a push.

        Raises
        ------
        ValueError
            As `Push`; also if the speed is not positive.
        """
        start, way = np.asarray(tips, dtype=np.float64), np.asarray(travel, dtype=np.float64)
        if start.ndim != 3 or start.shape != way.shape:
            raise ValueError(
                f"travel: shape {way.shape} for tips of {start.shape}; "
                "must be (N, P, 2) both; reshape them"
            )
        if film_ratio is not None:
            rest["support"] = Film.ratio(film_ratio)
        times = leg_times(way[:, None], speed)
        return cls(waypoints=np.stack([start, start + way], axis=1), times=times, **rest)  # type: ignore[arg-type]

    @classmethod
    def along(cls, *, ways: Floats, speed: float = REFERENCE_SPEED, **rest: object) -> Push:
        """Push along straight legs.

        Parameters
        ----------
        ways
            (N, L + 1, P, 2) probes at the ends of the legs in m, world frame.
        speed
            Of the fastest probe of each run, m/s; a leg in which none moves takes a second.
        rest
            Further fields of a push.

        Raises
        ------
        ValueError
            As `Push`; also if the speed is not positive.
        """
        times = leg_times(np.diff(ways, axis=1), speed)
        return cls(waypoints=ways, times=times, **rest)  # type: ignore[arg-type]

    @property
    def outlines(self) -> Floats:
        """(1|N, V, 2) stated corners of the part, m."""
        return self.vertices.reshape(-1, *self.vertices.shape[-2:])

    @property
    def thickness(self) -> float:
        """A bound of the least distance of a corner from an edge that it does not belong to, m."""
        outlines = self.outlines
        if len(outlines) == 1:
            return thickness(outlines[0])
        # no distance between points of an outline shrinks by more than twice its corners' change
        change = np.linalg.norm(outlines - outlines[0], axis=2).max()
        return thickness(outlines[0]) - 2.0 * float(change)

    @property
    def radii_of_tips(self) -> Floats:
        """(1|N, P) m."""
        if self.radii.size:
            return self.radii
        return np.array([[shape.radius for shape in self.shapes]])

    @property
    def friction_of_legs(self) -> Floats:
        """(1|N, 1|T − 1, P) μ between each two waypoints."""
        return self.friction if self.friction.ndim == 3 else self.friction[:, None]

    def _steps(self) -> Ints:
        count = np.ceil(self.lengths / self.step - _ROUNDING)[None]
        if self.effects.is_on(*_RATES) or not isinstance(self.motion, QuasiStatic):
            duration = np.diff(self.times, axis=1)
            count = np.maximum(count, np.ceil(duration / self.time_step - _ROUNDING))
        count = np.maximum(count, 1.0)
        if self.legs.size:
            count = np.where(np.arange(count.shape[1]) < self.legs[:, None], count, 0.0)
        return count.astype(np.int64)

    @property
    def steps(self) -> int:
        """Number of steps of the run that takes most."""
        return int(self.steps_of_legs.sum(axis=1).max(initial=0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
        (N,) deepest penetration in m, from the start of the run to its end.
    times
        (N, R) instants of the record, s.
    path
        (N, R, 3) poses at the instants, the last pose repeated after a run has ended; the other
        records have the same R, zero without a record.
    tips
        (N, R, P, 2) true positions of the probes, m, world frame.
    forces
        (N, R, P, 2) force of each probe on the part, world frame, over the film's drag e_x: m/s.
    modes
        (N, R, P) int8 contact mode of each probe: 0 separate, 1 stick, 2 slip +, 3 slip −. In slip +
        the friction on the part points along the inward normal turned by +90°.
    fixture_modes
        (N, R) int8, the same of the fixture's most loaded contact.
    steps
        Number of steps of the run that takes most.
    """

    poses: Floats
    outcomes: npt.NDArray[np.int8]
    max_penetration: Floats
    times: Floats
    path: Floats
    tips: Floats
    forces: Floats
    modes: npt.NDArray[np.int8]
    fixture_modes: npt.NDArray[np.int8]
    steps: int
