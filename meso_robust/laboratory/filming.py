"""Recordings of simulated motion, as the laboratory's camera and controller would make them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meso_robust.laboratory.running import MoveRun, PlanRun
from meso_robust.laboratory.simulation import Simulated
from meso_robust.recordings import (
    Polygon,
    PositionSource,
    Recording,
    RecordingSet,
    Rectangle,
    SensorInfo,
    from_simulation,
)
from meso_robust.simulator import Effects, Push, PushResult, simulate
from meso_robust.simulator.observation import Sensor, observe, sense
from meso_robust.task import Part, PolygonPart
from meso_robust.types import Floats

_FINER = 4  # instants of the simulation for each frame of the camera


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """How motion is recorded."""

    sensor: Sensor
    """Noise, frame rate and lost frames."""
    effects: Effects
    """Effects of the observation stage, such as latency."""
    source: PositionSource = "controller"
    """Whether positions of the probes are the commanded ones or those seen."""

    @property
    def info(self) -> SensorInfo:
        """What a recording set says of the sensor."""
        return SensorInfo(
            frame_rate=self.sensor.frame_rate,
            position_sigma=self.sensor.position_sigma,
            orientation_sigma=self.sensor.orientation_sigma,
        )


def film(push: Push, camera: Camera, rng: np.random.Generator) -> tuple[PushResult, RecordingSet]:
    """Simulate a push and record every run.

    Parameters
    ----------
    push
        The move; all runs must share its times. Effects of the observation stage are taken from the
        push, those of the camera are not used.
    camera
        How the motion is recorded.
    rng
        Source of noise and lost frames.

    Returns
    -------
    tuple
        The true motion, and one recording a run. A run that was stopped rests at its last pose.

    Raises
    ------
    ValueError
        If the times differ from run to run.
    """
    if not np.all(push.times == push.times[:1]):
        raise ValueError(
            f"times: {len(push.times)} rows that differ; must be the same for all runs that are "
            "filmed together; film them separately"
        )
    start, end = push.times[0, 0], push.times[0, -1]
    count = int(np.ceil((end - start) * camera.sensor.frame_rate * _FINER)) + 1
    times = np.linspace(start, end, max(count, 2))
    result = simulate(push, instants=times[None])
    tips = result.tips if camera.source == "camera" else _commanded(push, times)
    observed = replace(camera, effects=push.effects)
    radius = push.shapes[0].radius
    part = Polygon(corners=push.vertices)
    return result, _recorded(observed, times, result.path, tips, part, radius, rng)


def film_plan(
    found: Simulated, camera: Camera, rng: np.random.Generator, most: int
) -> RecordingSet:
    """Record the moves of a plan: of the nominal run, then of sampled ones.

    Parameters
    ----------
    found
        What ``simulate`` found out.
    camera
        How the motion is recorded. The probes are taken to be where they are, errors included.
    rng
        Source of noise and lost frames.
    most
        Number of runs.

    Returns
    -------
    RecordingSet
        One recording a run and move, ``run_00_move_1.csv`` and so on; moves that were not made are
        left out.
    """
    speed = 1e-6 * found.task.probe.speed_um_s
    part, radius = recorded_part(found.task.part), found.player.setup.uncertainty.tip_radius.mid
    sampled = [(found.sampled, row) for row in range(len(found.sampled.outcomes))]
    recordings: list[Recording] = []
    for run, (runs, row) in enumerate([(found.nominal.runs, 0), *sampled][:most]):
        for k in range(_made(runs, row)):
            names = found.player.probes[k]
            one = _move(runs.moves[k], row, camera, speed, part, radius, names, rng)
            recordings.append(replace(one, file=f"run_{run:02d}_move_{k + 1}.csv"))
    return RecordingSet(
        part=part,
        tip_radius=radius,
        position_source=camera.source,
        sensor=camera.info,
        recordings=tuple(recordings),
    )


def recorded_part(part: Part | PolygonPart) -> Rectangle | Polygon:
    """The part of a task as a recording set states it.

    Parameters
    ----------
    part
        The task's, um.

    Returns
    -------
    Rectangle or Polygon
        The same, m.
    """
    if isinstance(part, PolygonPart):
        return Polygon(corners=1e-6 * np.array(part.polygon_um))
    return Rectangle(length=1e-6 * part.length_um, width=1e-6 * part.width_um)


def _made(runs: PlanRun, row: int) -> int:
    """Moves that a run has made, one that was stopped included."""
    return min(int(runs.failed_in[row]) + 1, len(runs.moves))


def _move(
    move: MoveRun,
    row: int,
    camera: Camera,
    speed: float,
    part: Rectangle | Polygon,
    radius: float,
    names: tuple[str, ...],
    rng: np.random.Generator,
) -> Recording:
    path = move.path[row : row + 1]
    legs = np.diff(move.ways[row], axis=0)
    length = float(np.hypot(legs[..., 0], legs[..., 1]).max(axis=1).sum())
    times = np.linspace(0.0, max(length / speed, 1e-3), path.shape[1])
    tips = move.tips_at(row, np.linspace(0.0, 1.0, path.shape[1]))[None]
    return _recorded(camera, times, path, tips, part, radius, rng, names).recordings[0]


def _recorded(
    camera: Camera,
    times: Floats,
    poses: Floats,
    tips: Floats,
    part: Rectangle | Polygon,
    radius: float,
    rng: np.random.Generator,
    names: tuple[str, ...] = (),
) -> RecordingSet:
    seen_tips = camera.source == "camera"
    seen, probes = observe(
        times, poses, tips, camera.effects.table, probes_seen_by_camera=seen_tips
    )
    frames = sense(camera.sensor, times, seen, probes, rng, probes_seen_by_camera=seen_tips)
    return from_simulation(
        frames.times,
        frames.poses,
        frames.probes,
        part=part,
        tip_radius=radius,
        position_source=camera.source,
        sensor=camera.info,
        probe_names=names,
    )


def _commanded(push: Push, times: Floats) -> Floats:
    """(N, T, P, 2) commanded positions of the probes."""
    runs, probes = len(push.poses), push.waypoints.shape[2]
    ways = np.broadcast_to(push.waypoints, (runs, *push.waypoints.shape[1:]))
    tips = np.empty((runs, len(times), probes, 2))
    for run in range(runs):
        for p in range(probes):
            for a in range(2):
                tips[run, :, p, a] = np.interp(times, push.times[0], ways[run, :, p, a])
    return tips
