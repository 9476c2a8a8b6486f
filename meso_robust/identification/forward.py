"""The forward model: what the camera would have seen of recorded pushes, for any parameters.

`prepare` turns a recording set into moves for the simulator once; `predicted` then runs all
recordings with many vectors of parameters in one batch.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.identification.models.model import Model, Physics
from meso_robust.identification.prepared import Prepared
from meso_robust.identification.touching import freed
from meso_robust.simulator import Outcome, Push, simulate
from meso_robust.simulator.actuation import true_starts
from meso_robust.simulator.geometry import outlines, radii, reference_of_tracked
from meso_robust.simulator.observation import (
    CAMERA_LATENCY_TIME,
    CLOCK_RATE_PERCENT,
    LOG_LATENCY_TIME,
    OBSERVATION,
    observe,
    unseen,
)
from meso_robust.simulator.stage import SLOTS
from meso_robust.types import Flags, Floats

_AT_ONCE = 400_000  # instants recorded in one call of the simulator: about 50 MB
_CAUGHT = 0.04  # steps of overlap that count as touching; the simulator refuses 0.05
_OBSERVED = slice(OBSERVATION.base, OBSERVATION.base + OBSERVATION.slots)
_CLOCK = [CAMERA_LATENCY_TIME, LOG_LATENCY_TIME, CLOCK_RATE_PERCENT]
_AWAY = 1.0  # m: where a part that is caught between tips is put so that nothing meets it


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prediction:
    """What K vectors of parameters predict of R recordings.

    Attributes
    ----------
    poses
        (K, R, T, 3) x, y in m and θ in rad at the instants of the prepared frames; after a run was
        stopped, its last pose.
    outcomes
        (K, R) values of `Outcome`; a start that is caught between tips is `OUT_OF_RANGE`.
    modes
        (K, R, T, P) int8 contact modes: 0 separate, 1 stick, 2 and 3 slip.
    shifts
        (K, R, 2) by how much starts that overlapped a tip were moved out of it, m, world frame.
    """

    poses: Floats
    outcomes: npt.NDArray[np.int8]
    modes: npt.NDArray[np.int8]
    shifts: Floats

    @property
    def completed(self) -> Flags:
        """(K,) whether all runs of a vector came to their end."""
        return np.asarray(np.all(self.outcomes == Outcome.COMPLETED, axis=1))


def predicted(
    prepared: Prepared,
    model: Model,
    values: Floats,
    *,
    starts: Floats | None = None,
    offsets: Floats | None = None,
    workers: int | None = None,
) -> Prediction:
    """Simulate every recording with every vector of parameters.

    Parameters
    ----------
    prepared
        R recordings.
    model
        With n parameters.
    values
        (K, n) in SI; all must be `Model.valid`.
    starts
        (R, 3) or (K, R, 3) poses at the first instant, m and rad; those seen, if none are given. A
        start that overlaps a tip is moved out of it by the least shift.
    offsets
        (R, 4) or (K, R, 4) by how much the tips are elsewhere than recorded, m: in x and y at the first
        instant, in x and y at the last, evenly between; none by default.
    workers
        Threads; all cores by default.

    Returns
    -------
    Prediction
        Poses at the instants of the recordings, and how each run ended.

    Raises
    ------
    ValueError
        If a shape is wrong or a vector is not valid.
    """
    values = np.atleast_2d(np.asarray(values, dtype=np.float64))
    _check(model, values)
    shape = (len(values), len(prepared.files))
    all_starts = np.broadcast_to(prepared.starts if starts is None else starts, (*shape, 3))
    all_offsets = np.broadcast_to(np.zeros(4) if offsets is None else offsets, (*shape, 4))
    each = max(1, _AT_ONCE // prepared.instants.size)
    parts = [
        _predicted(
            prepared,
            model,
            values[k : k + each],
            all_starts[k : k + each],
            all_offsets[k : k + each],
            workers,
        )
        for k in range(0, len(values), each)
    ]
    return parts[0] if len(parts) == 1 else _joined(parts)


def corrected(
    prepared: Prepared,
    finer: Prepared,
    model: Model,
    values: Floats,
    *,
    starts: Floats,
    offsets: Floats,
) -> Prepared:
    """The recordings with predictions corrected for the length of the steps, near given values.

    Where a contact slips the error of the stepper is of first order in the step (measured against the
    event-driven engine), so that two steps tell the limit (Richardson). The error hardly varies with
    the parameters and is taken as constant.

    Parameters
    ----------
    prepared, finer
        The same recordings with the steps to go on with, and with shorter ones.
    model, values, starts, offsets
        As in `predicted`, of one vector.

    Returns
    -------
    Prepared
        The recordings of ``prepared`` with the correction in them.
    """
    plain = replace(prepared, correction=np.zeros_like(prepared.correction))
    coarse = predicted(plain, model, values, starts=starts, offsets=offsets)
    short = predicted(finer, model, values, starts=starts, offsets=offsets)
    share = 1.0 / (1.0 - finer.step / prepared.step)
    ended = (coarse.outcomes[0] == Outcome.COMPLETED) & (short.outcomes[0] == Outcome.COMPLETED)
    error = share * (short.poses[0] - coarse.poses[0])
    return replace(prepared, correction=np.where(ended[:, None, None], error, 0.0))


def _check(model: Model, values: Floats) -> None:
    if values.ndim != 2 or values.shape[1] != len(model.parameters) or not len(values):
        raise ValueError(
            f"values: shape {values.shape}; must be (K, {len(model.parameters)}), K ≥ 1, for model "
            f"{model.name}; give a column for each of {', '.join(model.keys)}"
        )
    for row in np.flatnonzero(~model.valid(values))[:1]:
        raise ValueError(
            f"values[{row}]: {values[row]}; must respect the ranges and the constraint of model "
            f"{model.name}; check with Model.valid first"
        )


def _joined(parts: list[Prediction]) -> Prediction:
    return Prediction(
        poses=np.concatenate([part.poses for part in parts]),
        outcomes=np.concatenate([part.outcomes for part in parts]),
        modes=np.concatenate([part.modes for part in parts]),
        shifts=np.concatenate([part.shifts for part in parts]),
    )


def _predicted(
    prepared: Prepared,
    model: Model,
    values: Floats,
    starts: Floats,
    offsets: Floats,
    workers: int | None,
) -> Prediction:
    count, recordings = starts.shape[:2]
    physics = model.physics(np.repeat(values, recordings, axis=0))
    ways = _true_tips(prepared, physics.effects.table, count)
    if np.any(offsets):
        ways += _drifting(prepared, offsets)
    poses = starts.reshape(-1, 3).copy()
    shifts, caught = _freed(prepared, physics, poses, true_starts(physics.effects.table, ways))
    poses[:, :2] += shifts
    poses[caught, :2] = prepared.parked + _AWAY
    push = Push(
        vertices=prepared.outline,
        poses=poses,
        waypoints=ways,
        times=np.tile(prepared.times, (count, 1)),
        friction=physics.friction,
        support=physics.support,
        shapes=prepared.shapes,
        legs=np.tile(prepared.legs, count),
        effects=physics.effects,
        step=prepared.step,
        time_step=prepared.time_step,
    )
    result = simulate(push, instants=np.tile(prepared.instants, (count, 1)), workers=workers)
    outcomes = result.outcomes.copy()
    outcomes[caught] = Outcome.OUT_OF_RANGE
    path = result.path.reshape(count, recordings, -1, 3)
    return Prediction(
        poses=_observed(prepared, path, push.effects.table) + prepared.correction,
        outcomes=outcomes.reshape(count, recordings),
        modes=result.modes.reshape(*path.shape[:3], -1),
        shifts=shifts.reshape(count, recordings, 2),
    )


def _camera(prepared: Prepared, table: Floats) -> Floats:
    """The table, (1|K R, SLOTS), with what of the camera can show.

    Where the tips are seen by the same camera, all that is seen is late together, and by the same clock.
    """
    if prepared.tips_seen and np.any(table[:, _CLOCK]):
        table = table.copy()
        table[:, _CLOCK] = 0.0
    return table


def _true_tips(prepared: Prepared, table: Floats, count: int) -> Floats:
    """(K R, W, P, 2) where the tips were, of which the recordings tell what the camera showed."""
    ways = np.tile(prepared.waypoints, (count, 1, 1, 1))
    table = _camera(prepared, table)
    if not (prepared.tips_seen and np.any(table[:, _OBSERVED])):
        return ways
    there = np.any(ways != -prepared.parked, axis=-1, keepdims=True)
    return np.where(there, unseen(np.tile(prepared.times, (count, 1)), ways, table), ways)


def _drifting(prepared: Prepared, offsets: Floats) -> Floats:
    """(K R, W, P, 2) offsets of the tips at the waypoints, even in time between the two ends."""
    first, last = prepared.times[:, :1], prepared.instants[:, -1:]
    share = np.clip((prepared.times - first) / (last - first), 0.0, 1.0)[..., None]
    both = offsets[..., None, :2] * (1.0 - share) + offsets[..., None, 2:] * share
    each = np.einsum("rpij,krwj->krwpi", prepared.lean, both)
    return np.asarray(each.reshape(-1, *each.shape[2:]))


def _freed(
    prepared: Prepared, physics: Physics, poses: Floats, tips: Floats
) -> tuple[Floats, Flags]:
    """Shifts that free the starts, and which cannot be freed."""
    table = physics.effects.table
    shift, left = freed(
        reference_of_tracked(poses, table),
        tips,
        outlines(prepared.outline, table),
        radii(np.array([shape.radius for shape in prepared.shapes]), table),
    )
    return shift, left > _CAUGHT * prepared.step


def _observed(prepared: Prepared, path: Floats, table: Floats) -> Floats:
    """Poses (K, R, T, 3) as the camera shows them."""
    table = _camera(prepared, table)
    if not np.any(table[:, _OBSERVED]):
        return path
    count = len(path)
    runs = path.reshape(-1, *path.shape[2:])
    rows = np.broadcast_to(table, (len(runs), SLOTS))
    times = np.tile(prepared.instants, (count, 1))
    seen, none = runs.copy(), np.zeros((len(runs), path.shape[2], 0, 2))

    def shown(which: slice) -> None:
        seen[which], _ = observe(
            times[which], runs[which], none[which], rows[which], probes_seen_by_camera=False
        )

    try:
        shown(slice(None))
    except ValueError:  # a part that ran away, to where the lens folds the image over
        for k in range(len(runs)):
            with suppress(ValueError):  # is shown where it is: as far from what was seen
                shown(slice(k, k + 1))
    return seen.reshape(path.shape)
