"""The assembly of Figs. 1 and 7 in simulation: peg, fixture, one round tip, plans run open loop.

Frame: x as in Table II, y up, so that its numbers below the top left corner of the fixture are
negative here and θ grows from 89 deg at the start to 180 deg in the slot, as in Section IX-E.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from meso_robust import units
from meso_robust.reproduction import printed
from meso_robust.simulator import Film, Fixture, Outcome, Push, Round, simulate
from meso_robust.simulator.fixture import CHANNEL_WIDTH, slot
from meso_robust.simulator.support_models import Support, Tables
from meso_robust.types import Flags, Floats

Plan: TypeAlias = tuple[Floats, ...]
"""Strokes (T, 2), or (N, T, 2) if every run has its own: waypoints of the tip, m. Between two strokes
the tip is lifted."""

START = np.array([2.33e-3, -1.21e-3, 89.0 * units.DEG])
"""(3,) start of the peg, Table II."""
TIP_START = np.array([3.05e-3, -1.24e-3])
"""(2,) start of the tip, Table II."""
POSITION_TOLERANCE = 76e-6
"""m, off the slot's axis; Section IX-E."""
ORIENTATION_TOLERANCE = 5.0 * units.DEG
"""Section IX-E."""
WALL_FRICTION = 0.3
"""Between part and fixture; not printed."""
DEPTH = 4e-3
"""m; so deep that no run reaches the bottom of the slot, whose place is not printed."""
_TRIFLES = (20e-9, 100e-9, 500e-9)  # m; nothing else here is known so well
STARTS_INSIDE = -1
"""Outcome of a run whose tip would come down on the part."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where the slot is, which the paper does not print.

    Attributes
    ----------
    mouth
        x of the slot's mouth, m.
    axis
        y of the middle of slot and channel, m; negative, as y is up.
    friction
        μ between part and fixture.
    """

    mouth: float = 1.0e-3
    axis: float = -1.21e-3
    friction: float = WALL_FRICTION

    @property
    def fixture(self) -> Fixture:
        """Slot and channel."""
        return slot((self.mouth, self.axis), DEPTH, printed.SLOT_WIDTH, friction=self.friction)

    def holds(self, poses: Floats) -> Flags:
        """(N,) whether the peg of (N, 3) poses is in the slot, either end ahead.

        Its centre is behind the mouth, and within the tolerances of the slot's axis and direction.
        """
        turn = (poses[:, 2] + 0.5 * np.pi) % np.pi - 0.5 * np.pi
        return np.asarray(
            (poses[:, 0] < self.mouth)
            & (np.abs(poses[:, 1] - self.axis) < POSITION_TOLERANCE)
            & (np.abs(turn) < ORIENTATION_TOLERANCE)
        )

    def free(self, poses: Floats) -> Flags:
        """(N,) whether all corners of the peg stand in the channel before the mouth."""
        points = corners(poses)
        half = 0.5 * CHANNEL_WIDTH
        inside = (points[..., 0] > self.mouth) & (np.abs(points[..., 1] - self.axis) < half)
        return np.asarray(inside.all(axis=1))

    def away_from_mouth(self, poses: Floats) -> Floats:
        """(N, 2) unit vectors to the pegs of (N, 3) poses from the nearer corner of the mouth."""
        side = np.where(poses[:, 1] < self.axis, -0.5, 0.5) * printed.SLOT_WIDTH
        apart = poses[:, :2] - np.stack([np.full(len(poses), self.mouth), self.axis + side], axis=1)
        return np.asarray(apart / np.hypot(*apart.T)[:, None])

    def clear(self, tips: Floats) -> Flags:
        """(...,) whether a tip of (..., 2) centres touches no wall."""
        x, y = tips[..., 0], np.abs(tips[..., 1] - self.axis) + printed.TIP_RADIUS
        in_channel = (y < 0.5 * CHANNEL_WIDTH) & (x - printed.TIP_RADIUS > self.mouth)
        return np.asarray(in_channel | (y < 0.5 * printed.SLOT_WIDTH))


def corners(poses: Floats) -> Floats:
    """(N, 4, 2) corners of the peg of (N, 3) poses, m."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    turn = np.stack([np.stack([c, -s], axis=1), np.stack([s, c], axis=1)], axis=1)
    return np.asarray(np.einsum("nij,vj->nvi", turn, printed.PART.outline) + poses[:, None, :2])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Runs:
    """What differs between N runs.

    Attributes
    ----------
    poses
        (N, 3) of the peg at the start.
    tips
        (N, 2) by how much the tip is off its command, the same in all moves, m.
    friction
        (N,) μ between tip and peg.
    share
        (N,) share of the weight on the three points p2*; the rest is on p1*. Without a film only.
    film_ratio
        (N,) ρ of a film in m², in place of the points.
    stretch
        (N, 2) factors on the points' coordinates in the part; negative ones mirror them.
    """

    poses: Floats
    tips: Floats
    friction: Floats
    share: Floats
    film_ratio: Floats | None = None
    stretch: Floats | None = None

    def __len__(self) -> int:
        """Number of runs."""
        return len(self.poses)

    def where(self, which: Flags | npt.NDArray[np.int64]) -> Runs:
        """Runs of the (N,) flags, or of the indices."""
        film = self.film_ratio
        return Runs(
            poses=self.poses[which],
            tips=self.tips[which],
            friction=self.friction[which],
            share=self.share[which],
            film_ratio=None if film is None else film[which],
            stretch=None if self.stretch is None else self.stretch[which],
        )

    @property
    def support(self) -> Support:
        """What the peg slides on."""
        if self.film_ratio is not None:
            return Film.ratio(self.film_ratio)
        return Blend(self.share, self.stretch)


@dataclass(frozen=True, slots=True, eq=False)
class Blend:
    """Dry contact at the points p1* and p2* together, `share` (N,) of the weight on p2*.

    Their coordinates may be multiplied by `stretch` (N, 2), which leaves the loads as they are. Only columns of points that carry weight in some run are kept.
    """

    share: Floats
    stretch: Floats | None = None

    def tables(self) -> Tables:
        """Dry points only."""
        one, two = (printed.three_points(name).tables() for name in ("p1*", "p2*"))
        stretch = np.ones((len(self.share), 2)) if self.stretch is None else self.stretch
        rows = [
            table.points * np.column_stack([stretch, part])[:, None]
            for table, part in ((one, 1.0 - self.share), (two, self.share))
            if part.any()
        ]
        return one._replace(points=np.concatenate(rows, axis=1))


def nominal(name: str, runs: int = 1) -> Runs:
    """Runs without errors.

    Parameters
    ----------
    name
        Of the support: ``p1*``, ``p2*`` or ``film``.
    runs
        How many.
    """
    film = name == "film"
    friction = float(np.mean(printed.FRICTION)) if film else printed.TIP_FRICTION[name]
    return Runs(
        poses=np.repeat(START[None], runs, axis=0),
        tips=np.zeros((runs, 2)),
        friction=np.full(runs, friction),
        share=np.full(runs, float(name == "p2*")),
        film_ratio=np.full(runs, printed.FILM_RATIO) if film else None,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Followed:
    """What a plan did in N runs.

    Attributes
    ----------
    poses
        (N, 3) at the end, or where a run ended.
    outcomes
        (N,) values of `Outcome`, or STARTS_INSIDE.
    paths
        For each stroke the (N, R, 3) poses on the way; empty unless recorded.
    """

    poses: Floats
    outcomes: npt.NDArray[np.int64]
    paths: tuple[Floats, ...]


def follow(
    plan: Plan, runs: Runs, place: Place, *, step: float = 2e-6, record: int = 0
) -> Followed:
    """Run a plan open loop.

    Parameters
    ----------
    plan, runs, place
        The strokes of the tip, what differs between the runs, and the slot.
    step
        Longest displacement of the tip in one step of the simulation, m.
    record
        Intervals of the path to keep of every leg of a stroke.
    """
    poses = runs.poses.copy()
    outcomes = np.full(len(runs), int(Outcome.COMPLETED))
    paths = []
    for stroke in plan:
        way = np.broadcast_to(stroke, (len(runs), *stroke.shape[-2:])) + runs.tips[:, None]
        inside = (outcomes == Outcome.COMPLETED) & _on_part(way[:, 0], poses)
        outcomes[inside] = STARTS_INSIDE
        alive = outcomes == Outcome.COMPLETED
        path = np.repeat(poses[:, None], record * (way.shape[1] - 1) + 1, axis=1)
        if alive.any():
            left = replace(runs.where(alive), poses=poses[alive])
            push = _apart(way[alive], left, place, step)
            result = simulate(push, instants=_instants(push.times, record) if record else None)
            poses[alive], outcomes[alive] = result.poses, result.outcomes
            if record:
                path[alive] = result.path
        paths.append(path)
    return Followed(poses=poses, outcomes=outcomes, paths=tuple(paths) if record else ())


def _clock(way: Floats) -> Floats:
    """(N, T) times of (N, T, 2) waypoints at the speed of Section V, s."""
    length = np.hypot(*np.moveaxis(np.diff(way, axis=1), 2, 0))
    lasts = np.maximum(length, units.UM) / printed.SPEED
    return np.concatenate([np.zeros((len(way), 1)), np.cumsum(lasts, axis=1)], axis=1)


def clock(stroke: Floats) -> Floats:
    """(T,) times of the (T, 2) waypoints of a stroke, s."""
    return _clock(stroke[None])[0]


def _instants(times: Floats, record: int) -> Floats:
    """(N, R) times of a record with so many intervals a leg."""
    share = np.arange(record) / record
    inner = times[:, :-1, None] + share * np.diff(times, axis=1)[..., None]
    return np.concatenate([inner.reshape(len(times), -1), times[:, -1:]], axis=1)


def _apart(way: Floats, runs: Runs, place: Place, step: float) -> Push:
    """The stroke, with pegs that lean on a corner of the slot's mouth moved off it by a trifle.

    Of a peg whose corner and the mouth's have passed each other by a nanometre, in the error of the
    steps, the simulator says that it starts inside the wall.
    """
    for way_off in _TRIFLES:
        try:
            return _stroke(way, runs, place, step)
        except ValueError:
            stuck = [k for k in range(len(runs)) if not _starts(way, runs, k, place, step)]
            poses = runs.poses.copy()
            poses[stuck, :2] += way_off * place.away_from_mouth(poses[stuck])
            runs = replace(runs, poses=poses)
    return _stroke(way, runs, place, step)


def _starts(way: Floats, runs: Runs, k: int, place: Place, step: float) -> bool:
    """Whether the simulator takes a run."""
    one = np.arange(len(runs)) == k
    try:
        _stroke(way[one], runs.where(one), place, step)
    except ValueError:
        return False
    return True


def _stroke(way: Floats, runs: Runs, place: Place, step: float) -> Push:
    return Push(
        vertices=printed.PART.outline,
        poses=runs.poses,
        waypoints=way[:, :, None],
        times=_clock(way),
        friction=runs.friction,
        support=runs.support,
        shapes=(Round(printed.TIP_RADIUS),),
        fixture=place.fixture,
        step=step,
    )


def _on_part(tips: Floats, poses: Floats) -> Flags:
    """(N,) whether a tip at (N, 2) comes down on the peg."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    off = tips - poses[:, :2]
    own = np.stack([c * off[:, 0] + s * off[:, 1], c * off[:, 1] - s * off[:, 0]], axis=1)
    gap = np.maximum(np.abs(own) - 0.5 * np.array([printed.PART.length, printed.PART.width]), 0.0)
    return np.asarray(np.hypot(*gap.T) < printed.TIP_RADIUS)


def succeeded(followed: Followed, place: Place) -> Flags:
    """(N,) whether the plan was completed with the peg in the slot."""
    done = followed.outcomes == Outcome.COMPLETED
    return np.asarray(done & place.holds(followed.poses))
