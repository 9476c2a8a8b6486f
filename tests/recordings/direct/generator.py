"""Pushed rectangles by hand-written mechanics, and a camera with concealed wrongs.

Shares no code with the package: NumPy only, units of um, deg and s as the files have them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HALF_LONG, HALF_SHORT = 800.0, 400.0
RATIO = 360_000.0  # um²
RADIUS = 0.0


@dataclass(frozen=True)
class Camera:
    """What is wrong with what is seen; all of it nothing by default."""

    noise_um: float = 0.5
    noise_deg: float = 0.02
    late_s: float = 0.0
    shift_um: tuple[float, float] = (0.0, 0.0)
    offset_um: tuple[float, float] = (0.0, 0.0)
    yaw_deg: float = 0.0
    turn_deg: float = 0.0
    stretch_percent: tuple[float, float] = (0.0, 0.0)
    rate_hz: float = 30.0


@dataclass(frozen=True)
class Support:
    """How the drag differs from an even, isotropic film's."""

    lay: float = 0.0
    lay_deg: float = 0.0
    centre_um: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Seen:
    """Columns of one file: s; um, um, deg; (T, P, 2) um."""

    times: Array
    poses: Array
    tips: Array


@dataclass
class Stage:
    """Makes pushes; the same seed makes the same."""

    seed: int
    camera: Camera = field(default_factory=Camera)
    support: Support = field(default_factory=Support)

    def __post_init__(self) -> None:
        """Start the random numbers."""
        self.rng = np.random.default_rng(self.seed)

    def push(self, side: int, speed: float = 75.0, heading_deg: float | None = None) -> Seen:
        """One push of 600 um by a tip that sticks, from a rest of 1 s and 60 um away."""
        rng = self.rng
        theta = np.radians(rng.uniform(-180, 180) if heading_deg is None else heading_deg)
        start = np.array([*rng.uniform(-1500, 1500, 2), theta])
        normal = np.array([(0, -1), (1, 0), (0, 1), (-1, 0)][side], dtype=float)
        half = HALF_SHORT if side in (0, 2) else HALF_LONG
        long = HALF_LONG if side in (0, 2) else HALF_SHORT
        tangent = np.array([-normal[1], normal[0]])
        place = normal * half + tangent * rng.uniform(-0.5, 0.5) * long
        slant = np.radians(rng.uniform(-20, 20))
        way = _turned(_turned(-normal, slant), theta)
        touch = start[:2] + _turned(place, theta)
        fine, whole = 0.25 / self.camera.rate_hz, 660.0 / speed
        clock = np.arange(0.0, 1.0 + whole + 0.7, fine)
        travel = np.clip((clock - 1.0) * speed - 60.0, -60.0, 600.0)
        tips = touch + travel[:, None] * way
        poses = np.tile(start, (len(clock), 1))
        for k in range(1, len(clock)):
            step = tips[k] - tips[k - 1]
            pose = poses[k - 1].copy()
            if travel[k] > 0.0 and np.any(step):
                half_way = pose + 0.5 * self._rate(pose, place, step)
                pose = pose + self._rate(half_way, place, step)
            poses[k] = pose
        return self._shown(clock, poses, tips[:, None])

    def carried(self, speed: float = 2000.0) -> Seen:
        """A part that two tips carry along a bent way, with changing speed, from rest to rest."""
        rng = self.rng
        clock = np.arange(0.0, 4.0, 1.0 / 360.0)
        phase = np.clip(clock / 4.0, 0.0, 1.0)
        run = speed * 4.0 * (phase - 0.12 * np.sin(2.0 * np.pi * 2.0 * phase))
        bend = rng.uniform(0.5, 1.0) * np.sign(rng.uniform(-1, 1)) * 2e-4
        turn = rng.uniform(-np.pi, np.pi) + bend * run
        step = np.diff(run, prepend=run[0])
        hand = np.cumsum(step[:, None] * np.column_stack((np.cos(turn), np.sin(turn))), axis=0)
        across = np.column_stack((-np.sin(turn), np.cos(turn)))
        tips = np.stack((hand + 300.0 * across, hand - 300.0 * across), axis=1)
        ahead = np.column_stack((np.cos(turn), np.sin(turn)))
        aside = rng.uniform(-100, 100)
        # pushed on its lower long side: the part's y axis points along the travel
        place = hand + HALF_SHORT * ahead + aside * across
        poses = np.column_stack((place, turn - 0.5 * np.pi))
        return self._shown(clock, poses, tips)

    def _rate(self, pose: Array, place: Array, step: Array) -> Array:
        """Motion of the part for a step of a tip that sticks at a place of it."""
        centre = np.array(self.support.centre_um)
        arm = _turned(place - centre, pose[2])
        angle = 2.0 * np.radians(self.support.lay_deg)
        drag = np.eye(2) + self.support.lay * np.array(
            [[np.cos(angle), np.sin(angle)], [np.sin(angle), -np.cos(angle)]]
        )
        across = np.array([-arm[1], arm[0]])
        # f = drag v; rho w = arm x f; v + w across = step
        easy = np.linalg.inv(drag)
        force = np.linalg.solve(easy + np.outer(across, across) / RATIO, step)
        turn = (across @ force) / RATIO
        drift = easy @ force
        back = _turned(-centre, pose[2])
        return np.array([*(drift + turn * np.array([-back[1], back[0]])), turn])

    def _shown(self, clock: Array, poses: Array, tips: Array) -> Seen:
        camera, rng = self.camera, self.rng
        frames = np.arange(clock[0], clock[-1], 1.0 / camera.rate_hz)
        seen = np.column_stack([np.interp(frames - camera.late_s, clock, c) for c in poses.T])
        flat = tips.reshape(len(clock), -1)
        held = np.column_stack([np.interp(frames, clock, c) for c in flat.T])
        held = held.reshape(len(frames), -1, 2)
        seen[:, :2] += np.array(
            [_turned(np.array(camera.offset_um), angle) for angle in seen[:, 2]]
        )
        seen[:, :2] *= 1.0 + np.array(camera.stretch_percent) / 100.0
        seen[:, :2] = _turned(seen[:, :2], np.radians(camera.turn_deg))
        seen[:, :2] += camera.shift_um
        seen[:, 2] = np.degrees(seen[:, 2]) + camera.turn_deg + camera.yaw_deg
        sizes = (camera.noise_um, camera.noise_um, camera.noise_deg)
        seen += rng.normal(size=seen.shape) * sizes
        return Seen(times=frames, poses=seen, tips=held)


def _turned(vectors: Array, angle: float) -> Array:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.asarray(vectors @ np.array([[cos, sin], [-sin, cos]]))
