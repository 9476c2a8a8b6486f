"""Support points and friction from forces: what the pusher feels while the part moves as seen.

A point of the support at p under the load N moves with v = (v_x − ω y, v_y + ω x) and is held back by
μN along v. The pusher's wrench is the sum of these (S. Goyal, A. Ruina, J. Papadopoulos 1991,
https://doi.org/10.1016/0043-1648(91)90104-3). At known points it is linear in the friction μN of each.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from meso_robust.recordings import Recording, RecordingSet, unwrapped

F = npt.NDArray[np.float64]

_PUSHING = 0.5  # of the greatest force: above it the part is taken to be pushed
_TOUCHED = 0.4  # of the greatest force: where the motion is taken to begin
_LEAST = 5  # samples that a push must have
_SCALE = 0.3  # N: residual from which a push counts less than quadratically


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pairs:
    """Wrench and twist of each push, body frame.

    Attributes
    ----------
    files
        R names.
    wrenches
        (R, 3) force in N and torque about the origin in N m that the pusher exerts, mean over the
        second half of the push.
    twists
        (R, 3) displacement in m and turn in rad of the whole push, in the frame half-way.
    length
        By which torques are divided, m.
    """

    files: tuple[str, ...]
    wrenches: F
    twists: F
    length: float

    def of(self, rows: npt.NDArray[np.intp]) -> Pairs:
        """Some of the pushes; a row may stand twice."""
        return Pairs(
            files=tuple(self.files[row] for row in rows),
            wrenches=self.wrenches[rows],
            twists=self.twists[rows],
            length=self.length,
        )


def pairs_of(recordings: RecordingSet, length: float) -> Pairs:
    """Wrench–twist pairs of recordings with one probe, a force, and a pose at either end.

    Between the first touch and the end the pose is taken to change evenly.
    """
    found = [(r.file, *_pair(unwrapped(r))) for r in recordings.recordings]
    kept = [(file, wrench, twist) for file, wrench, twist in found if np.isfinite(wrench).all()]
    return Pairs(
        files=tuple(file for file, _, _ in kept),
        wrenches=np.array([wrench for _, wrench, _ in kept]),
        twists=np.array([twist for _, _, twist in kept]),
        length=length,
    )


def _pair(recording: Recording) -> tuple[F, F]:
    first, last = recording.poses[0], recording.poses[-1]
    middle = 0.5 * (first[2] + last[2])
    twist = np.append(_turned(last[:2] - first[:2], -middle), last[2] - first[2])
    if recording.forces is None:
        return np.full(3, np.nan), twist
    force, tip = recording.forces[:, 0], recording.probes[:, 0]
    size, count = np.hypot(*force.T), len(force)
    touch = int(np.argmax(size > _TOUCHED * np.nanmax(size)))
    share = np.clip((np.arange(count) - touch) / max(count - 1 - touch, 1), 0.0, 1.0)[:, None]
    poses = first + share * (last - first)
    own, arm = _turned(force, -poses[:, 2]), _turned(tip - poses[:, :2], -poses[:, 2])
    wrench = np.column_stack([own, arm[:, 0] * own[:, 1] - arm[:, 1] * own[:, 0]])
    used = (np.arange(count) > count // 2) & (size > _PUSHING * np.nanmax(size))
    return (wrench[used].mean(axis=0) if used.sum() >= _LEAST else np.full(3, np.nan)), twist


def _turned(vector: F, angle: F | float) -> F:
    """Vectors (..., 2) turned by an angle (...)."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def unit_wrenches(points: F, twists: F) -> F:
    """(R, 3, K) wrench on the support's side of unit friction at points (K, 2) for twists (R, 3)."""
    x, y = points.T
    velocity = np.stack(
        [
            twists[:, None, 0] - twists[:, None, 2] * y,
            twists[:, None, 1] + twists[:, None, 2] * x,
        ],
        axis=1,
    )
    along = velocity / np.linalg.norm(velocity, axis=1, keepdims=True)
    return np.stack([along[:, 0], along[:, 1], x * along[:, 1] - y * along[:, 0]], axis=1)


def friction_at(points: F, pairs: Pairs) -> tuple[F, float]:
    """(K,) friction in N at known points by least squares, and the share of variance explained."""
    units = np.array([1.0, 1.0, 1.0 / pairs.length])
    matrix = (unit_wrenches(points, pairs.twists) * units[:, None]).reshape(-1, len(points))
    wanted = (pairs.wrenches * units).reshape(-1)
    friction = np.linalg.lstsq(matrix, wanted, rcond=None)[0]
    rest = wanted - matrix @ friction
    return friction, float(1.0 - np.sum(rest**2) / np.sum(wanted**2))


def loads_of(points: F) -> F:
    """(3,) shares of the weight on three points (3, 2) about the centre of mass, the origin."""
    after, last = np.roll(points, -1, axis=0), np.roll(points, -2, axis=0)
    areas = after[:, 0] * last[:, 1] - after[:, 1] * last[:, 0]
    return np.asarray(areas / areas.sum())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Points:
    """Three support points (3, 2) in m, the whole friction in N, and the cost in N²."""

    points: F
    friction: float
    cost: float


def points_by_forces(pairs: Pairs, starts: F, outline: F) -> Points:
    """Three points, loaded as statics demands, that explain the wrenches best.

    ``starts`` (S, 3, 2) in m; the best of the searches is returned, its points in the order of their
    angle about the centre of mass. They stay in the box about the outline (V, 2), m.
    """
    length = pairs.length
    units = np.array([1.0, 1.0, 1.0 / length])
    low = np.append(np.tile(outline.min(axis=0), 3) / length, 0.0)
    high = np.append(np.tile(outline.max(axis=0), 3) / length, np.inf)

    def residual(point: F) -> F:
        points = point[:6].reshape(3, 2) * length
        wrench = unit_wrenches(points, pairs.twists) @ (point[6] * loads_of(points))
        return np.asarray(((wrench - pairs.wrenches) * units).reshape(-1))

    found = [
        least_squares(
            residual,
            np.append(start.reshape(-1) / length, np.median(np.hypot(*pairs.wrenches.T[:2]))),
            bounds=(low, high),
            loss="soft_l1",
            f_scale=_SCALE,
            max_nfev=60,
        )
        for start in starts
    ]
    # a search that ends with a load below zero has no part that could stand so
    stands = [end for end in found if loads_of(end.x[:6].reshape(3, 2)).min() > 0.0] or found
    best = min(stands, key=lambda end: float(end.cost))
    return Points(
        points=ordered(best.x[:6].reshape(3, 2) * length),
        friction=float(best.x[6]),
        cost=float(best.cost),
    )


def ordered(points: F) -> F:
    """Points (3, 2) in the order of their angle about the origin."""
    return np.asarray(points[np.argsort(np.arctan2(points[:, 1], points[:, 0]))])


def matched(points: F, known: F) -> F:
    """Three points (3, 2) in the order in which they are nearest to known ones."""
    turns = [np.roll(order, k, axis=0) for order in (points, points[::-1]) for k in range(3)]
    return np.asarray(min(turns, key=lambda turn: float(np.sum((turn - known) ** 2))))


def apart(points: F, known: F) -> float:
    """Root mean square distance in m of three points from known ones, best matched."""
    return float(np.sqrt(np.mean(np.sum((matched(points, known) - known) ** 2, axis=1))))
