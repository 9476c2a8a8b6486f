"""Entry point of the event-driven integrator: batches of runs, and the phases of one run."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, TypeAlias, cast

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.kernels import fingerprint, sealed as inner, threads
from meso_robust.simulator.events.balance import invert
from meso_robust.simulator.events.checks import check_move
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
    walls: Floats
    poses: Floats
    tips: Floats
    travel: Floats
    friction: Floats
    radii: Floats
    corners: Floats
    """(Q, 2) convex corners of the fixture."""
    drag: Floats
    """(N or 1, 3, 3)."""
    wall_friction: float


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
    size: float
    """Its unit of length in m."""

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
        span = _span(self.inputs, which)
        starts = outputs.starts[:count].copy()
        starts[:, 0] /= span if span > 0 else 1.0
        starts[:, 1:3] *= self.size
        return make_timeline(starts, outputs.contacts[:count], self.inputs.tips.shape[1])


def _span(inputs: Inputs, which: int) -> float:
    """Scaled travel of the fastest tip of a run."""
    travel = inputs.travel[which]
    return float(np.hypot(travel[:, 0], travel[:, 1]).max(initial=0.0))


@inner
def _fill_tips(inputs: Inputs, i: int, tips: Floats) -> float:
    """Write the tips and the corners of the fixture of a run; return its span."""
    movers = inputs.tips.shape[1]
    span = 0.0
    for p in range(movers):
        span = max(span, np.hypot(inputs.travel[i, p, 0], inputs.travel[i, p, 1]))
    for p in range(movers):
        for k in range(2):
            tips[p, k] = inputs.tips[i, p, k]
            tips[p, 2 + k] = inputs.travel[i, p, k] / span if span > 0.0 else 0.0
        tips[p, 4] = inputs.radii[p]
        tips[p, 5] = inputs.friction[i, p]
    for q in range(inputs.corners.shape[0]):
        tips[movers + q, 0], tips[movers + q, 1] = inputs.corners[q, 0], inputs.corners[q, 1]
        tips[movers + q, 2:5] = 0.0
        tips[movers + q, 5] = inputs.wall_friction
    return span


@inner
def _one(inputs: Inputs, outputs: Outputs, i: int, scene: Scene, work: Work) -> None:
    """Take one run."""
    span = _fill_tips(inputs, i, scene.tips)
    which = i if inputs.drag.shape[0] > 1 else 0
    for k in range(3):
        work.pose[k] = inputs.poses[i, k]
        for m in range(3):
            work.drag[k, m] = inputs.drag[which, k, m]
    invert(work.drag, work.film)
    work.span = span
    work.reach = 1.0
    work.wall_friction = inputs.wall_friction
    work.movers = inputs.tips.shape[1]
    outcome, clock = run(scene, work, Log(outputs.path[i], outputs.starts, outputs.contacts))
    for k in range(3):
        outputs.poses[i, k] = work.pose[k]
    outputs.outcomes[i] = outcome
    outputs.ended_at[i] = clock / span if span > 0.0 else 1.0
    outputs.events[i] = work.count[EVENTS]
    if outputs.starts.shape[0] > 0:
        outputs.logged[0] = work.count[LOGGED]


def _compiled() -> Kernel:
    """Make the batch kernel, compiled at its first call and kept on disk; see ``fingerprint``."""
    key = fingerprint("simulator/events")

    @njit(cache=True, nogil=True, error_model="numpy")
    def kernel(
        inputs: Inputs, outputs: Outputs, works: npt.NDArray[np.void], first: int, last: int
    ) -> None:
        if key < 0:  # never, but it makes the key part of the function
            return
        tips = inputs.tips.shape[1] + inputs.corners.shape[0]
        bodies = tips + inputs.edges.shape[0]
        widest = max(inputs.edges.shape[0], inputs.walls.shape[0])
        scene = Scene(
            inputs.edges,
            inputs.walls,
            np.zeros((tips, 6)),
            np.zeros(bodies),
            np.zeros((bodies, widest + 1), np.bool_),
        )
        for i in range(first, last):
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
        np.zeros((runs, samples + 1 if samples > 0 else 0, 3)),
        np.zeros((phases, 4)),
        np.zeros((phases, MOST, 4), dtype=np.int64),
        np.zeros(1, dtype=np.int64),
    )


def prepare(move: Mapping[str, Floats], fixture: Sequence[Floats] = ()) -> tuple[Inputs, float]:
    """Scale a move; the arrays of `integrate` under their names there.

    Returns
    -------
    tuple
        What the kernel reads, and the unit of length in m.
    """
    vertices = move["vertices"]
    size = float(np.hypot(vertices[:, 0], vertices[:, 1]).max())
    stretch = np.array([size, size, 1.0])
    scaled = move["drag"].reshape(-1, 3, 3) * stretch[:, None] * stretch
    scaled = np.ascontiguousarray(scaled / scaled[:, :1, :1])
    walls = edge_table([polygon / size for polygon in fixture])
    inputs = Inputs(
        edge_table([vertices / size]),
        walls,
        np.ascontiguousarray(move["poses"] / stretch),
        np.ascontiguousarray(move["tips"] / size),
        np.ascontiguousarray(move["travel"] / size),
        np.ascontiguousarray(move["friction"]),
        np.ascontiguousarray(move["radii"] / size),
        np.ascontiguousarray(walls[walls[:, CONVEX] > 0, :2]),
        scaled,
        float(move["fixture_friction"]),
    )
    return inputs, size


def integrate(
    *,
    vertices: Floats,
    poses: Floats,
    tips: Floats,
    travel: Floats,
    friction: Floats,
    drag: Floats,
    radii: Floats | None = None,
    fixture: Sequence[Floats] = (),
    fixture_friction: float = 0.0,
    samples: int = 0,
) -> EventResult:
    """Push the part of every run through its move, from one event to the next.

    Parameters
    ----------
    vertices
        (V, 2) corners of the part in m, body frame, counter-clockwise; need not be convex.
    poses
        (N, 3) x, y in m and θ in rad of the reference point of the part at the start.
    tips
        (N, P, 2) centres of the tips in m at the start, world frame.
    travel
        (N, P, 2) their displacements in m; zero for a passive tip.
    friction
        (N, P) coefficients of friction at the tips.
    drag
        (3, 3) or (N, 3, 3) drag of the film in body axes about the reference point, symmetric and
        positive definite; only its shape matters: diag(1, 1, ρ) with ρ in m².
    radii
        (P,) radii of the tips in m; points by default.
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
        "fixture_friction": np.array(fixture_friction),
    }
    move = {name: np.asarray(array, dtype=np.float64) for name, array in move.items()}
    polygons = [np.asarray(polygon, dtype=np.float64) for polygon in fixture]
    check_move(move, polygons, samples)
    inputs, size = prepare(move, polygons)
    outputs = _outputs(inputs, samples, 0)
    _take(inputs, outputs)
    for poses in (outputs.poses, outputs.path):
        poses[..., :2] *= size
    return EventResult(
        poses=outputs.poses,
        outcomes=outputs.outcomes,
        path=outputs.path,
        ended_at=outputs.ended_at,
        events=outputs.events,
        inputs=inputs,
        size=size,
    )


def _take(inputs: Inputs, outputs: Outputs) -> None:
    """Take all runs, on all cores if there are enough; each run is on its own."""
    runs = inputs.poses.shape[0]
    count = min(threads(), runs // _CHUNK)
    if count <= 1:
        take(inputs, outputs, 0, runs)
        return
    cuts = [runs * k // count for k in range(count + 1)]
    with ThreadPoolExecutor(count) as pool:
        list(pool.map(lambda span: take(inputs, outputs, *span), pairwise(cuts)))
