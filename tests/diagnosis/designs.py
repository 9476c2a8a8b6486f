"""Recording sets for locating: rest, approach, push, retract, rest, at planned places and speeds.

Without effects the motion is from the event-driven engine, which shares no code with the stepper.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.recordings import Recording, RecordingSet, SensorInfo
from meso_robust.simulator import Effects, Film, Push, Round, exact, simulate
from meso_robust.simulator.observation import observe
from tests.identification.sets import PART, RADIUS, UM, turned

Floats = npt.NDArray[np.float64]
Given = Mapping[str, Mapping[str, float]]

RHO, MU = 0.276e-6, 0.3
VALUES = np.array([RHO, MU])
SIGMA = np.array([1.2 * UM, 1.2 * UM, np.radians(0.08)])
RATE = 30.0
RETRACT = 60 * UM
REST = 0.7
_HALF = 0.5 * np.array([PART.length, PART.width])
_SAMPLES = 500


@dataclass(frozen=True, slots=True)
class Plan:
    """A push: pose of the part, place and outward normal about it, slant, and the tip's motion."""

    pose: tuple[float, float, float]
    place: tuple[float, float]
    normal: tuple[float, float]
    slant: float = 0.1
    speed: float = 75 * UM
    gap: float = 20 * UM
    length: float = 300 * UM
    wait: float = 0.4

    @property
    def corners(self) -> tuple[Floats, Floats]:
        """Times (5,) and places (5, 2) of the tip's path."""
        body = turned(self.pose[2])
        normal, place = np.array(self.normal), np.array(self.place)
        tip = np.array(self.pose[:2]) + body @ (place + (RADIUS + self.gap) * normal)
        ahead = -turned(self.slant) @ body @ normal
        ways = np.array([0.0, 0.0, self.gap + self.length, self.gap + self.length - RETRACT])
        spans = np.array([self.wait, (self.gap + self.length) / self.speed, RETRACT / self.speed])
        times = np.cumsum([0.0, *spans, REST])
        return times, tip + np.append(ways, ways[-1])[:, None] * ahead


def random_plans(
    rng: np.random.Generator, count: int, speeds: Sequence[float] = (25 * UM, 75 * UM, 225 * UM)
) -> list[Plan]:
    """Pushes on all four edges at random places and poses; speeds take turns."""
    plans = []
    for k in range(count):
        axis, side = k % 2, float(1 - 2 * (k // 2 % 2))
        normal = np.eye(2)[axis] * side
        place = np.where(np.arange(2) == axis, side, rng.uniform(-0.8, 0.8, 2)) * _HALF
        speed = float(speeds[k % len(speeds)])
        plans.append(
            Plan(
                pose=(*rng.uniform(-500 * UM, 500 * UM, 2), rng.uniform(-np.pi, np.pi)),
                place=(place[0], place[1]),
                normal=(normal[0], normal[1]),
                slant=rng.uniform(-0.3, 0.3),
                speed=speed,
                gap=rng.uniform(15 * UM, 25 * UM),
                length=120 * UM if speed < 30 * UM else 300 * UM,
            )
        )
    return plans


def recorded_plans(
    plans: Sequence[Plan],
    rng: np.random.Generator,
    effects: Given | None = None,
    *,
    noise: float = 1.0,
    colour: float = 0.0,
) -> RecordingSet:
    """What a camera sees of the pushes.

    Parameters
    ----------
    plans
        R pushes.
    rng
        Of the noise.
    effects
        Physics beyond the plain model, all pushes alike.
    noise
        Standard deviations over `SIGMA`.
    colour
        Correlation of the noise of neighbouring frames.
    """
    recordings = []
    for k, plan in enumerate(plans):
        clock, way = plan.corners
        times = np.arange(0.0, clock[-1], 1.0 / RATE)
        path = _moved(plan, times, effects) if effects else _exact(plan, times)
        shaken = rng.standard_normal(path.shape)
        for t in range(1, len(shaken)):
            shaken[t] = colour * shaken[t - 1] + np.sqrt(1.0 - colour**2) * shaken[t]
        tips = np.stack([np.interp(times, clock, column) for column in way.T], axis=1)
        recordings.append(
            Recording(
                file=f"push_{k:02d}.csv",
                probe_names=("probe1",),
                times=times,
                poses=path + noise * SIGMA * shaken,
                probes=tips[:, None],
            )
        )
    return RecordingSet(
        part=PART,
        tip_radius=RADIUS,
        position_source="controller",
        sensor=SensorInfo(
            frame_rate=RATE, position_sigma=float(SIGMA[0]), orientation_sigma=float(SIGMA[2])
        ),
        recordings=tuple(recordings),
    )


def _push(plan: Plan, corners: slice, effects: Given | None) -> Push:
    clock, way = plan.corners
    return Push(
        vertices=PART.outline,
        poses=np.array([plan.pose]),
        waypoints=way[None, corners, None],
        times=clock[None, corners],
        friction=np.array([MU]),
        support=Film.ratio(np.array([RHO])),
        shapes=(Round(RADIUS),),
        effects=Effects(effects or {}),
        step=1.5 * UM,
    )


def _exact(plan: Plan, times: Floats) -> Floats:
    """(T, 3) poses from event to event; the part rests before and after the push."""
    clock = plan.corners[0]
    path = exact(_push(plan, slice(1, 3), None), samples=_SAMPLES).path[0]
    at = np.linspace(clock[1], clock[2], len(path))
    return np.stack([np.interp(times, at, column) for column in path.T], axis=1)


def _moved(plan: Plan, times: Floats, effects: Given) -> Floats:
    """(T, 3) poses as the camera shows them."""
    push = _push(plan, slice(None), effects)
    path = simulate(push, instants=times[None]).path
    none = np.zeros((1, len(times), 0, 2))
    seen, _ = observe(times, path, none, push.effects.table, probes_seen_by_camera=False)
    return np.asarray(seen[0])
