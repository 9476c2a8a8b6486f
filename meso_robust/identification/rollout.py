"""Planned pushes in the simulator: what a model says that they would do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meso_robust.errors import InputError
from meso_robust.identification.experiment import Bench, Part, PlannedPush
from meso_robust.identification.models import Model
from meso_robust.simulator import Point, Push, PushResult, Round, simulate
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Setting:
    """What all runs of a rollout share.

    Attributes
    ----------
    part, bench
        What is pushed, and with what.
    model
        The physics.
    """

    part: Part
    bench: Bench
    model: Model


def rollout(
    setting: Setting,
    pushes: Sequence[PlannedPush],
    starts: Floats,
    values: Floats,
    *,
    intervals: int = 0,
) -> PushResult:
    """Make N pushes, each from its own start and with its own values of the parameters.

    Parameters
    ----------
    setting
        Part, bench and model.
    pushes
        N pushes.
    starts
        (N, 3) poses of the part at the start, m and rad; `start_of` has the planned ones.
    values
        (N, n) or (n,) parameters in SI.
    intervals
        Of the record, evenly spaced over each push; 0 for none.

    Returns
    -------
    PushResult
        Of the N runs.

    Raises
    ------
    InputError
        If values are beyond the model, or a part starts inside the tip.
    """
    values = np.broadcast_to(values, (len(pushes), values.shape[-1]))
    bad = np.flatnonzero(~setting.model.valid(values))
    if bad.size:
        shown = setting.model.shown(values[bad[0]])
        raise InputError(
            f"values: {dict(zip(setting.model.keys, shown, strict=True))}; must be valid "
            f"in the model {setting.model.name}; give other values"
        )
    physics = setting.model.physics(values)
    radius = setting.bench.tip_radius
    try:
        push = Push.straight(
            vertices=setting.part.outline,
            poses=starts,
            tips=np.array([push.tip for push in pushes])[:, None],
            travel=np.array([push.travel for push in pushes])[:, None],
            friction=physics.friction,
            support=physics.support,
            effects=physics.effects,
            speed=setting.bench.speed,
            shapes=(Round(radius) if radius > 0.0 else Point(),),
            step=setting.model.step,
        )
    except ValueError as error:
        raise InputError(f"planned push: {error}") from error
    return simulate(push, record=intervals)


def start_of(pushes: Sequence[PlannedPush]) -> Floats:
    """(N, 3) planned poses of the part at the start, m and rad."""
    return np.array([push.start for push in pushes], dtype=np.float64).reshape(-1, 3)
