"""Batches of runs, on one core or all, and the entry point of the simulator."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import fields
from functools import lru_cache
from typing import TypeAlias, cast

import numpy as np
from numba import njit

from meso_robust.kernels import fingerprint, share_out, threads
from meso_robust.simulator.arrange import Inputs, Outputs, case_of, inputs_of, outputs_of
from meso_robust.simulator.case import new_state
from meso_robust.simulator.geometry import tracked_of_reference
from meso_robust.simulator.outline import refuse
from meso_robust.simulator.push import Push, PushResult
from meso_robust.simulator.record import (
    FIXTURE_MODE,
    FORCE,
    PER_PROBE,
    POSE,
    PROBE_MODE,
    PROBES,
    TIME,
    TIP,
)
from meso_robust.simulator.stepping import run
from meso_robust.simulator.tables import MAX_CONTACTS, workspace
from meso_robust.types import Floats

_CHUNKS = 4  # pieces of a batch for each core
_RESULTS = tuple(item.name for item in fields(PushResult) if item.name != "steps")

Kernel: TypeAlias = Callable[[Inputs, int, int, Outputs], None]
"""A batch kernel: inputs, first run, last run (exclusive) and outputs."""


def _compiled() -> Kernel:
    """Make the batch kernel, compiled at its first call and kept on disk; see ``fingerprint``."""
    key = fingerprint("simulator")

    @njit(cache=True, nogil=True, error_model="numpy")
    def kernel(inputs: Inputs, start: int, stop: int, outputs: Outputs) -> None:
        if key < 0:  # never, but it makes the key part of the function
            return
        work = workspace(MAX_CONTACTS)
        for i in range(start, stop):
            case = case_of(i, inputs)
            state = new_state(case)
            outcome, depth = run(case, state, work, outputs.poses[i], outputs.record[i])
            outputs.outcomes[i] = outcome
            outputs.max_penetration[i] = depth

    return cast(Kernel, kernel)


run_range = _compiled()
"""Take a range of runs one after the other on one core; releases the interpreter."""


def simulate(
    push: Push,
    *,
    record: int = 0,
    instants: Floats | None = None,
    unique: bool = False,
    workers: int | None = None,
) -> PushResult:
    """Push the part of every run through the move.

    Parameters
    ----------
    push
        The move and its N runs.
    record
        Number of intervals of the record: ``record + 1`` instants, evenly spaced from the first
        waypoint to the last. Zero records nothing.
    instants
        (1|N, R) times to record instead, s, increasing.
    unique
        Look for a second motion in every step, and end the run where there is one
        (`Outcome.NON_UNIQUE`). Slow: all contact modes of every step are tried.
    workers
        Threads; all cores by default.

    Returns
    -------
    PushResult
        Poses at the end, outcomes and deepest penetrations. The same push always gives the same
        result, whatever the number of cores.

    Raises
    ------
    ValueError
        If `record` is negative or `instants` do not fit the move.
    """
    if workers is not None and workers < 1:
        refuse("workers", f"{workers}", "must be at least 1", "leave it out to use all cores")
    chosen = _instants(push, record, instants)
    outputs, steps = outputs_of(push, chosen), push.steps_of_legs
    if len(push.poses):
        inputs = inputs_of(push, steps, unique)
        _in_pieces(inputs, outputs, len(push.poses), workers or threads())
    return _result(push, outputs, int(steps.sum(axis=1).max(initial=0)))


def _result(push: Push, outputs: Outputs, steps: int) -> PushResult:
    table, record = push.effects.table, outputs.record
    poses, path = outputs.poses, record[:, :, POSE : POSE + 3]
    if push.effects.values:
        poses, path = (tracked_of_reference(these, table) for these in (poses, path))
    each = record[:, :, PROBES:].reshape(*record.shape[:2], len(push.shapes), PER_PROBE)
    result = PushResult(
        poses=poses,
        outcomes=outputs.outcomes,
        max_penetration=outputs.max_penetration,
        times=record[:, :, TIME],
        path=path,
        tips=each[..., TIP : TIP + 2],
        forces=each[..., FORCE : FORCE + 2],
        modes=each[..., PROBE_MODE].astype(np.int8),
        fixture_modes=record[:, :, FIXTURE_MODE].astype(np.int8),
        steps=steps,
    )
    for name in _RESULTS:
        getattr(result, name).flags.writeable = False
    return result


@lru_cache(maxsize=8)
def _shares(record: int) -> Floats:
    """(R,) evenly spaced shares of a move; only to be read."""
    return np.linspace(0.0, 1.0, record + 1)


def _instants(push: Push, record: int, instants: Floats | None) -> Floats | None:
    if record < 0:
        refuse("record", f"{record}", "must not be negative", "give the number of intervals or 0")
    if instants is None:
        if record == 0:
            return None
        start, end = push.times[:, :1], push.times[:, -1:]
        return np.asarray(start + (end - start) * _shares(record))
    chosen = np.array(instants, dtype=np.float64)
    if chosen.ndim != 2 or len(chosen) not in (1, len(push.poses)):
        refuse("instants", f"shape {chosen.shape}", "must be (1|N, R)", "reshape it")
    if not np.all(np.diff(chosen, axis=1) > 0.0):
        refuse("instants", "times that do not increase", "must increase", "sort them")
    if not np.all((chosen >= push.times[:, :1]) & (chosen <= push.times[:, -1:])):
        refuse("instants", "a time outside the move", "must lie within its times", "leave it out")
    return chosen


def _in_pieces(inputs: Inputs, outputs: Outputs, runs: int, workers: int) -> None:
    """Take the runs in pieces, one after the other or by several threads that share the arrays."""
    if workers == 1 or runs < 2 * workers:
        run_range(inputs, 0, runs, outputs)
        return
    ends = np.unique(np.linspace(0, runs, _CHUNKS * workers + 1).astype(int))
    pieces = itertools.pairwise(ends.tolist())
    share_out(lambda piece: run_range(inputs, *piece, outputs), pieces, workers)
