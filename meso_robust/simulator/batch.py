"""Batches of runs, one after the other or in parallel, and the entry point of the simulator."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias, cast

import numpy as np
import numpy.typing as npt
from numba import njit, prange

from meso_robust.kernels import fingerprint
from meso_robust.simulator.contact import polygon_faces
from meso_robust.simulator.push import Push, PushResult
from meso_robust.simulator.rows import Case
from meso_robust.simulator.stepping import run
from meso_robust.simulator.support import arm_scale

_F = npt.NDArray[np.float64]


class Inputs(NamedTuple):
    """Fields of a push as the kernels take them; shapes as in `Push`."""

    faces: _F
    """(V, 6) table of `polygon_faces`."""
    tips: _F
    travel: _F
    friction: _F
    film_ratio: _F


class Outputs(NamedTuple):
    """Arrays the kernels fill; shapes as in `PushResult`."""

    poses: _F
    """The poses at the start on entry."""
    outcomes: npt.NDArray[np.int8]
    max_penetration: _F
    path: _F


Kernel: TypeAlias = Callable[[Inputs, int, bool, Outputs], None]
"""A batch kernel; see `run_serial`."""


@njit(error_model="numpy")
def _case(i: int, inputs: Inputs, steps: int) -> Case:
    """Pick one run."""
    move = np.empty((inputs.travel.shape[1], 2))
    unit = 0.0
    for tip in range(move.shape[0]):
        move[tip, 0] = inputs.travel[i, tip, 0] / max(steps, 1)
        move[tip, 1] = inputs.travel[i, tip, 1] / max(steps, 1)
        unit = max(unit, np.hypot(move[tip, 0], move[tip, 1]))
    return Case(
        inputs.faces,
        inputs.tips[i],
        move,
        unit,
        inputs.friction[i],
        arm_scale(inputs.film_ratio[i]),
    )


@njit(error_model="numpy")
def _run_one(i: int, inputs: Inputs, steps: int, warm: bool, outputs: Outputs) -> None:
    """Take one run.

    The results are written here because Numba was seen to lose the outcomes when the parallel
    loop itself wrote them into the named tuple.
    """
    case = _case(i, inputs, steps)
    outcome, depth = run(case, steps, warm, outputs.poses[i], outputs.path[i])
    outputs.outcomes[i] = outcome
    outputs.max_penetration[i] = depth


def _compiled(parallel: bool) -> Kernel:
    """Make the batch kernel, compiled at its first call and kept on disk; see ``fingerprint``."""
    key = 2 * fingerprint("simulator") + parallel

    @njit(cache=True, error_model="numpy", parallel=parallel)
    def kernel(inputs: Inputs, steps: int, warm: bool, outputs: Outputs) -> None:
        if key < 0:  # never, but it makes the key part of the function
            return
        for i in prange(inputs.tips.shape[0]):
            _run_one(np.int64(i), inputs, steps, warm, outputs)

    return cast(Kernel, kernel)


run_serial = _compiled(parallel=False)
"""Take the runs one after the other on one core.

Called with the inputs, the number of steps, whether to try the contact modes of the last step
before Lemke's method, and the outputs, which it fills.
"""

run_parallel = _compiled(parallel=True)
"""Take the runs on all cores; arguments and results as in `run_serial`."""


def prepare(push: Push, record: int = 0) -> tuple[Inputs, Outputs]:
    """Arrange a push for the kernels.

    Parameters
    ----------
    push
        The move.
    record
        Number of intervals of the recorded path; zero for none.

    Returns
    -------
    tuple
        What the kernels read and what they fill.
    """
    runs = push.poses.shape[0]
    inputs = Inputs(
        polygon_faces(push.vertices), push.tips, push.travel, push.friction, push.film_ratio
    )
    outputs = Outputs(
        push.poses.copy(),
        np.zeros(runs, dtype=np.int8),
        np.zeros(runs),
        np.zeros((runs, record + 1 if record > 0 else 0, 3)),
    )
    return inputs, outputs


def simulate(push: Push, *, record: int = 0) -> PushResult:
    """Push the part of every run through the move.

    Parameters
    ----------
    push
        The move and its N runs.
    record
        Number of intervals of the recorded path: ``record + 1`` poses at evenly spaced parts of
        the move. Zero records nothing.

    Returns
    -------
    PushResult
        Poses at the end, outcomes and deepest penetrations. The same push always gives the same
        result, whatever the number of cores.

    Raises
    ------
    ValueError
        If `record` is negative.
    """
    if record < 0:
        raise ValueError(
            f"record: {record}; must not be negative; give the number of path intervals or 0"
        )
    steps = push.steps
    inputs, outputs = prepare(push, record)
    kernel = run_parallel if len(push.poses) > 1 else run_serial
    kernel(inputs, steps, True, outputs)
    for array in outputs:
        array.flags.writeable = False
    return PushResult(
        poses=outputs.poses,
        outcomes=outputs.outcomes,
        max_penetration=outputs.max_penetration,
        path=outputs.path,
        steps=steps,
    )
