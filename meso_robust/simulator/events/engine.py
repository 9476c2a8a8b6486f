"""Entry point of the event-driven integrator: batches of runs, and the phases of one run."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, TypeAlias, cast

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.kernels import FUSED, fingerprint, share_out, threads
from meso_robust.simulator.events.balance import invert
from meso_robust.simulator.events.checks import check_move
from meso_robust.simulator.events.fused import sealed
from meso_robust.simulator.events.journey import Log, run
from meso_robust.simulator.events.outline import CONVEX, edge_table
from meso_robust.simulator.events.scene import EVENTS, LOGGED, MOST, WORK, Scene, Work
from meso_robust.simulator.events.timeline import Timeline, make_timeline
from meso_robust.types import Floats, Ints

_LONGEST = 1000  # phases of a timeline
_CHUNK = 64  # runs below which one thread is enough


class Inputs(NamedTuple):
    """A move as the kernel takes it; lengths in units of `size`."""

    edges: Floats
    """(N or 1, V, 9)."""
    walls: Floats
    poses: Floats
    tips: Floats
    travel: Floats
    """(N, L, P, 2)."""
    friction: Floats
    """(N, L, P)."""
    radii: Floats
    """(N or 1, P)."""
    corners: Floats
    """(Q, 2) convex corners of the fixture."""
    drag: Floats
    """(N or 1, 3, 3)."""
    lay: Floats
    """(N or 1, 4): of the stage, and the centre of drag."""
    wall_friction: float
    size: float
    """Unit of length, m."""


class Outputs(NamedTuple):
    """What the kernel fills."""

    poses: Floats
    outcomes: npt.NDArray[np.int8]
    ended_at: Floats
    events: Ints
    path: Floats
    starts: Floats
    contacts: Ints
    logged: Ints


Kernel: TypeAlias = Callable[[Inputs, Outputs, npt.NDArray[np.void], int, int], None]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EventResult:
    """Results of N runs."""

    poses: Floats
    """(N, 3) x, y in m and θ in rad at the end, or where the run stopped."""
    outcomes: npt.NDArray[np.int8]
    """(N,) values of `Outcome`. A run is jammed where no mode holds, and also where the speed of
    the part grows without bound, as between tips that close in on it from three sides."""
    path: Floats
    """(N, samples + 1, 3) poses at evenly spaced parts of the move; (N, 0, 3) if none are asked
    for. After the end of a run that stopped, the pose where it did."""
    ended_at: Floats
    """(N,) part of the move that was made; 1 for a completed one."""
    events: Ints
    """(N,) number of intervals in which the modes of the contacts stayed the same."""
    inputs: Inputs
    """The move as the kernel took it."""

    def timeline(self, which: int) -> Timeline:
        """Phases of one run, which is taken again for it.

        Parameters
        ----------
        which
            Number of the run.

        Returns
        -------
        Timeline
            Starts, poses and contact modes of its phases.
        """
        outputs = _outputs(self.inputs, 0, _LONGEST)
        take(self.inputs, outputs, which, which + 1)
        count = int(outputs.logged[0])
        travel = self.inputs.travel[which]
        span = np.hypot(travel[..., 0], travel[..., 1]).max(axis=1, initial=0.0).sum()
        starts = outputs.starts[:count].copy()
        starts[:, 0] /= span if span > 0 else 1.0
        starts[:, 1:3] *= self.inputs.size
        return make_timeline(starts, outputs.contacts[:count], self.inputs.tips.shape[1])


@sealed
def _of(i: int, length: int) -> int:
    """Row of run i in an array of 1 or N rows."""
    return i if length > 1 else 0


@sealed
def _fill_legs(travel: Floats, friction: Floats, legs: Floats) -> float:
    """Write the legs of a run; return the clock at the end of the last."""
    clock = 0.0
    for leg in range(legs.shape[0]):
        span = 0.0
        for p in range(legs.shape[1]):
            span = max(span, np.hypot(travel[leg, p, 0], travel[leg, p, 1]))
        clock += span
        for p in range(legs.shape[1]):
            for k in range(2):
                legs[leg, p, k] = travel[leg, p, k] / span if span > 0.0 else 0.0
            legs[leg, p, 2], legs[leg, p, 3] = friction[leg, p], clock
    return clock


@sealed
def _fill_tips(inputs: Inputs, i: int, tips: Floats) -> None:
    """Write the tips, which no leg has moved yet, and the corners of the fixture of a run."""
    movers = inputs.tips.shape[1]
    for p in range(movers):
        for k in range(2):
            tips[p, k], tips[p, 2 + k] = inputs.tips[i, p, k], 0.0
        tips[p, 4] = inputs.radii[_of(i, inputs.radii.shape[0]), p]
    for q in range(inputs.corners.shape[0]):
        tips[movers + q, 0], tips[movers + q, 1] = inputs.corners[q, 0], inputs.corners[q, 1]
        tips[movers + q, 2:5] = 0.0
        tips[movers + q, 5] = inputs.wall_friction


@sealed
def _one(inputs: Inputs, outputs: Outputs, i: int, scene: Scene, work: Work) -> None:
    """Take one run."""
    span = _fill_legs(inputs.travel[i], inputs.friction[i], scene.legs)
    _fill_tips(inputs, i, scene.tips)
    drag = inputs.drag[_of(i, inputs.drag.shape[0])]
    lay = inputs.lay[_of(i, inputs.lay.shape[0])]
    for k in range(3):
        work.pose[k] = inputs.poses[i, k]
        for m in range(3):
            work.drag[k, m] = work.even[k, m] = drag[k, m]
    for k in range(2):
        work.lay[k], work.centre[k] = lay[k], lay[2 + k]
    invert(work.drag, work.film)
    work.span = work.whole = span
    work.reach = 1.0
    work.wall_friction = inputs.wall_friction
    work.movers = inputs.tips.shape[1]
    outcome, clock = run(scene, work, Log(outputs.path[i], outputs.starts, outputs.contacts))
    outputs.poses[i, 2] = work.pose[2]
    for k in range(2):
        outputs.poses[i, k] = inputs.size * work.pose[k]
        for sample in range(outputs.path.shape[1]):
            outputs.path[i, sample, k] *= inputs.size
    outputs.outcomes[i] = outcome
    outputs.ended_at[i] = clock / span if span > 0.0 else 1.0
    outputs.events[i] = work.count[EVENTS]
    if outputs.starts.shape[0] > 0:
        outputs.logged[0] = work.count[LOGGED]


def _compiled() -> Kernel:
    """Make the batch kernel, compiled at its first call and kept on disk; see ``fingerprint``."""
    key = fingerprint("simulator/events")

    @njit(cache=True, nogil=True, error_model="numpy", fastmath=set(FUSED))
    def kernel(
        inputs: Inputs, outputs: Outputs, works: npt.NDArray[np.void], first: int, last: int
    ) -> None:
        if key < 0:  # never, but it makes the key part of the function
            return
        tips = inputs.tips.shape[1] + inputs.corners.shape[0]
        sides = inputs.edges.shape[1]
        legs = np.zeros((inputs.travel.shape[1], inputs.tips.shape[1], 4))
        bodies, widest = np.zeros((tips, 6)), max(sides, inputs.walls.shape[0])
        # without a fixture nothing can meet the corners of the part
        clear = np.zeros(tips + (sides if inputs.walls.shape[0] > 0 else 0))
        closing = np.zeros_like(clear)
        left_out = np.zeros((tips + sides, widest + 1), np.bool_)
        for i in range(first, last):
            edges = inputs.edges[i if inputs.edges.shape[0] > 1 else 0]
            scene = Scene(edges, inputs.walls, legs, bodies, clear, closing, left_out)
            _one(inputs, outputs, i, scene, works[0])

    return cast(Kernel, kernel)


_kernel = _compiled()


def take(inputs: Inputs, outputs: Outputs, first: int, last: int) -> None:
    """Take the runs from `first` up to `last` one after the other."""
    _kernel(inputs, outputs, np.zeros(1, WORK), first, last)


def _outputs(inputs: Inputs, samples: int, phases: int) -> Outputs:
    """Arrays for the kernel to fill."""
    runs = inputs.poses.shape[0]
    return Outputs(
        np.zeros((runs, 3)),
        np.zeros(runs, dtype=np.int8),
        np.zeros(runs),
        np.zeros(runs, dtype=np.int64),
        np.empty((runs, samples + 1 if samples > 0 else 0, 3)),
        np.zeros((phases, 4)),
        np.zeros((phases, MOST, 4), dtype=np.int64),
        np.zeros(1, dtype=np.int64),
    )


def prepare(move: Mapping[str, Floats], fixture: Sequence[Floats] = ()) -> Inputs:
    """Scale a move; the arrays of `integrate` under their names there.

    Returns
    -------
    Inputs
        What the kernel reads.
    """
    vertices, tips = move["vertices"], move["tips"]
    vertices = vertices.reshape(-1, *vertices.shape[-2:])
    runs, probes = tips.shape[:2]
    size = float(np.hypot(vertices[..., 0], vertices[..., 1]).max())
    stretch = np.array([size, size, 1.0])
    drag = move["drag"].reshape(-1, 3, 3)
    scaled = drag * stretch[:, None] * stretch
    travel = move["travel"].reshape(runs, -1, probes, 2)
    friction = move["friction"].reshape(runs, -1, probes)
    walls = edge_table([polygon / size for polygon in fixture])
    return Inputs(
        edge_table([vertices / size]),
        walls,
        np.ascontiguousarray(move["poses"] / stretch),
        np.ascontiguousarray(tips / size),
        np.ascontiguousarray(travel / size),
        # a copy: what need not be broadcast would be read-only, and for another type the kernel is made again
        np.array(np.broadcast_to(friction, travel.shape[:3]), order="C"),
        np.ascontiguousarray(move["radii"].reshape(-1, probes) / size),
        np.ascontiguousarray(walls[walls[:, CONVEX] > 0, :2]),
        np.ascontiguousarray(scaled / scaled[:, :1, :1]),
        np.ascontiguousarray(_lay(move["stage_lay"].reshape(-1, 2), drag, size)),
        float(move["fixture_friction"]),
        size,
    )


def _lay(stage: Floats, drag: Floats, size: float) -> Floats:
    """(N or 1, 4) the lay of the stage (N or 1, 2) over the first entry of the drag, and its centre."""
    runs = max(len(stage), len(drag)) if stage.any() else 1
    found = np.zeros((runs, 4))
    if stage.any():
        found[:, :2] = stage / drag[:, 0, 0, None]
        # a force at the centre of drag does not turn the part: there the coupling vanishes
        arm = np.linalg.solve(drag[:, :2, :2], drag[:, :2, 2:])[..., 0]
        found[:, 2], found[:, 3] = arm[:, 1] / size, -arm[:, 0] / size
    return found


def integrate(
    *,
    vertices: Floats,
    poses: Floats,
    tips: Floats,
    travel: Floats,
    friction: Floats,
    drag: Floats,
    radii: Floats | None = None,
    stage_lay: Floats | None = None,
    fixture: Sequence[Floats] = (),
    fixture_friction: float = 0.0,
    samples: int = 0,
) -> EventResult:
    """Push the part of every run through its move, from one event to the next.

    Parameters
    ----------
    vertices
        (V, 2) or (N, V, 2) corners of the part in m, body frame, counter-clockwise; need not be
        convex.
    poses
        (N, 3) x, y in m and θ in rad of the reference point of the part at the start.
    tips
        (N, P, 2) centres of the tips in m at the start, world frame.
    travel
        (N, P, 2) their displacements in m; zero for a passive tip. Or (N, L, P, 2), one after the
        other, of L straight legs.
    friction
        (N, P) or (N, L, P) coefficients of friction at the tips, in each leg.
    drag
        (3, 3) or (N, 3, 3) drag of the film in body axes about the reference point, symmetric and
        positive definite; only its shape matters: diag(1, 1, ρ) with ρ in m².
    radii
        (P,) or (N, P) radii of the tips in m; points by default.
    stage_lay
        (2,) or (N, 2) what the stage adds to the drag of a translation, ``[[p, q], [q, −p]]`` in the
        world's axes, at the centre of drag and in the unit of `drag`; nothing by default.
    fixture
        Polygons (K, 2) in m, world frame, at rest: solid inside if counter-clockwise, outside if
        clockwise.
    fixture_friction
        Coefficient of friction at the fixture.
    samples
        Number of intervals of the path; zero for none.

    Returns
    -------
    EventResult
        Poses at the end, outcomes, paths and numbers of phases.

    Raises
    ------
    ValueError
        If an argument has a wrong shape or value.
    """
    move = {
        "vertices": vertices,
        "poses": poses,
        "tips": tips,
        "travel": travel,
        "friction": friction,
        "drag": drag,
        "radii": np.zeros(np.shape(tips)[1]) if radii is None else radii,
        "stage_lay": np.zeros(2) if stage_lay is None else stage_lay,
        "fixture_friction": np.array(fixture_friction),
    }
    move = {name: np.asarray(array, dtype=np.float64) for name, array in move.items()}
    polygons = [np.asarray(polygon, dtype=np.float64) for polygon in fixture]
    check_move(move, polygons, samples)
    return integrate_checked(move, polygons, samples)


def integrate_checked(
    move: Mapping[str, Floats], fixture: Sequence[Floats], samples: int
) -> EventResult:
    """As `integrate`, of a move that has been checked.

    Parameters
    ----------
    move
        The arrays of `integrate` under their names there.
    fixture
        Polygons (K, 2) of the fixture, m.
    samples
        Number of intervals of the path; zero for none.

    Returns
    -------
    EventResult
        As `integrate`.
    """
    inputs = prepare(move, fixture)
    outputs = _outputs(inputs, samples, 0)
    _take(inputs, outputs)
    return EventResult(
        poses=outputs.poses,
        outcomes=outputs.outcomes,
        path=outputs.path,
        ended_at=outputs.ended_at,
        events=outputs.events,
        inputs=inputs,
    )


def _take(inputs: Inputs, outputs: Outputs) -> None:
    """Take all runs, on all cores if there are enough; each run is on its own."""
    runs = inputs.poses.shape[0]
    count = min(threads(), runs // _CHUNK)
    if count <= 1:
        take(inputs, outputs, 0, runs)
        return
    cuts = [runs * k // count for k in range(count + 1)]
    share_out(lambda span: take(inputs, outputs, *span), pairwise(cuts), count)
