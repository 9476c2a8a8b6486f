"""Recordings of the 300 um part, simulated: what ``small_model.toml`` was fitted to.

``python -m reports.tasks.small_recordings --out DIR`` writes them as a recording set. The pushes are
slow, because a pull shows in what a tip that backs off does to the part, and it does more the slower the
tip is.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import numpy.typing as npt

from meso_robust.recordings import Recording, RecordingSet, Rectangle, SensorInfo
from meso_robust.recordings.writing import write_set
from meso_robust.simulator import Effects, Film, Push, Round, simulate

Floats = npt.NDArray[np.float64]

UM = 1e-6
PART = Rectangle(length=300 * UM, width=155.4 * UM)
RADIUS = 2.3 * UM
RHO, MU = 12990e-12, 0.33
PULL_UM_S, RANGE_UM = 3.0, 2.0
SIGMA = np.array([0.24 * UM, 0.24 * UM, np.radians(0.08)])  # the paper's 1.2 um at 4X, seen at 20X
RATE = 30.0
PUSHES, SEED = 12, 5
GAP, LENGTH, BACK = 5 * UM, 40 * UM, 15 * UM
SPEEDS = (10 * UM, 20 * UM)
WAITS = (0.4, 0.8)  # s, before and after


def recordings(pull_um_s: float = PULL_UM_S) -> RecordingSet:
    """Approach, push, back off and rest, at random places on all four edges."""
    rng = np.random.default_rng(SEED)
    return RecordingSet(
        part=PART,
        tip_radius=RADIUS,
        position_source="controller",
        sensor=SensorInfo(
            frame_rate=RATE, position_sigma=float(SIGMA[0]), orientation_sigma=float(SIGMA[2])
        ),
        recordings=tuple(_recording(k, rng, pull_um_s) for k in range(PUSHES)),
    )


def _recording(number: int, rng: np.random.Generator, pull_um_s: float) -> Recording:
    clock, way, pose = _way(number, rng)
    push = Push(
        vertices=PART.outline,
        poses=pose[None],
        waypoints=way[None, :, None],
        times=clock[None],
        friction=np.array([MU]),
        support=Film.ratio(RHO),
        shapes=(Round(RADIUS),),
        effects=Effects({"tip_adhesion": {"pull_um_s": pull_um_s, "range_um": RANGE_UM}}),
        step=0.1 * UM,
        time_step=0.01,
    )
    times = np.arange(0.0, clock[-1], 1.0 / RATE)
    path = simulate(push, instants=times[None]).path[0]
    tips = np.stack([np.interp(times, clock, column) for column in way.T], axis=1)
    return Recording(
        file=f"push_{number:02d}.csv",
        probe_names=("probe1",),
        times=times,
        poses=path + SIGMA * rng.standard_normal(path.shape),
        probes=tips[:, None],
    )


def _way(number: int, rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Times (5,), tip (5, 2) and the part's pose (3,)."""
    axis, side = number % 2, 1.0 - 2.0 * (number // 2 % 2)
    normal, half = np.eye(2)[axis] * side, 0.5 * np.array([PART.length, PART.width])
    place = np.where(np.arange(2) == axis, side, rng.uniform(-0.8, 0.8, 2)) * half
    pose = np.array([*rng.uniform(-90 * UM, 90 * UM, 2), rng.uniform(-np.pi, np.pi)])
    body = _turned(pose[2])
    ahead = -_turned(rng.uniform(-0.3, 0.3)) @ body @ normal
    start = pose[:2] + body @ (place + (RADIUS + GAP) * normal)
    speed = SPEEDS[number // 4 % 2]
    there, back = (GAP + LENGTH) / speed, BACK / speed
    clock = np.cumsum([0.0, WAITS[0], there, back, WAITS[1]])
    ways = np.array([0.0, 0.0, GAP + LENGTH, GAP + LENGTH - BACK, GAP + LENGTH - BACK])
    return clock, start + ways[:, None] * ahead, pose


def _turned(angle: float) -> Floats:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def main() -> None:
    """Write the set."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of the recording set")
    write_set(parser.parse_args().out, recordings())


if __name__ == "__main__":
    main()
