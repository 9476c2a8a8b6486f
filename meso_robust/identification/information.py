"""What pushes tell of the parameters of a model: Fisher information, starts marginalised.

A frame shows x, y and θ with independent Gaussian errors. The start of every push is unknown and
belongs to that push alone, so that only the Schur complement of its block is left:
``I = Jpᵀ W Jp − Jpᵀ W Jq (Jqᵀ W Jq)⁻¹ Jqᵀ W Jp``. Information is in the model's coordinates, about one
for a typical change, and adds up over pushes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meso_robust.errors import InputError
from meso_robust.identification.experiment import PlannedPush
from meso_robust.identification.models import Model, characteristic_length
from meso_robust.identification.rollout import Setting, rollout, start_of
from meso_robust.recordings import SensorInfo
from meso_robust.simulator import Outcome
from meso_robust.types import Flags, Floats

_INTERVALS = 60
_STEP = 2e-3
"""Of the finite differences in coordinates."""
_START_STEP = 0.5e-6
"""Of the finite differences of the start, m; of θ divided by the characteristic length."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Information:
    """Of P pushes on n parameters.

    Attributes
    ----------
    matrices
        (P, n, n) in the model's coordinates; zero rows and columns for parameters that no motion
        can show.
    completed
        (P,) whether all runs behind a matrix came to their end; if not, it is zero.
    """

    matrices: Floats
    completed: Flags


def information(
    setting: Setting, pushes: Sequence[PlannedPush], values: Floats, sensor: SensorInfo
) -> Information:
    """Information of each push at given parameters.

    Parameters
    ----------
    setting
        Part, bench and model.
    pushes
        P pushes.
    values
        (n,) parameters in SI.
    sensor
        Frame rate and both standard deviations, which must be known.

    Raises
    ------
    InputError
        If a deviation is unknown or zero, or a parameter cannot change within the model.
    """
    sigmas = _sigmas(sensor)
    vectors, spans = _neighbours(setting.model, values)
    length = characteristic_length(setting.part.outline)
    moves = _START_STEP * np.repeat(np.eye(3), 2, axis=0) * np.tile([1.0, -1.0], 3)[:, None]
    moves[:, 2] /= length
    all_values = np.concatenate([vectors, np.tile(values, (len(moves), 1))])
    offsets = np.concatenate([np.zeros((len(vectors), 3)), moves])
    each = len(offsets)
    result = rollout(
        setting,
        [push for push in pushes for _ in range(each)],
        (start_of(pushes)[:, None] + offsets).reshape(-1, 3),
        np.tile(all_values, (len(pushes), 1)),
        intervals=_INTERVALS,
    )
    completed = np.all((result.outcomes == Outcome.COMPLETED).reshape(-1, each), axis=1)
    paths = result.path.reshape(len(pushes), each, -1) / np.tile(sigmas, _INTERVALS + 1)
    slopes = (paths[:, 0::2] - paths[:, 1::2]) / np.append(spans, [1.0, 1.0, 1.0])[:, None]
    found = np.stack([_marginal(rows, len(spans)) for rows in slopes])
    duration = result.times[::each, -1] - result.times[::each, 0]
    frames = duration * sensor.frame_rate + 1.0
    found *= (completed * frames / (_INTERVALS + 1))[:, None, None]
    fitted = np.flatnonzero(setting.model.fitted)
    matrices = np.zeros((len(pushes), len(values), len(values)))
    matrices[:, fitted[:, None], fitted] = found
    return Information(matrices=matrices, completed=completed)


def prior(model: Model) -> Floats:
    """(n, n) information of the ranges: that of an even distribution over each, in coordinates."""
    return np.diag(1.0 / prior_deviations(model) ** 2)


def prior_deviations(model: Model) -> Floats:
    """(n,) standard deviations of an even distribution over each range, in coordinates."""
    low, high = _ends(model)
    return np.asarray((high - low) / np.sqrt(12.0))


def _ends(model: Model) -> tuple[Floats, Floats]:
    ends = np.array([[p.low for p in model.parameters], [p.high for p in model.parameters]])
    if not np.all(np.isfinite(ends)):
        wide = [p.key for p in model.parameters if not np.isfinite([p.low, p.high]).all()]
        raise InputError(
            f"{', '.join(wide)}: no finite range; must have one; state it in the model"
        )
    low, high = model.coordinates(ends)
    return low, high


def _sigmas(sensor: SensorInfo) -> Floats:
    """(3,) standard deviations of x, y and θ."""
    position, orientation = sensor.position_sigma, sensor.orientation_sigma
    if not position or not orientation:
        raise InputError(
            f"sensor: position_sigma {position}, orientation_sigma {orientation}; must be known and "
            "positive to say how informative a push is; state them"
        )
    return np.array([position, position, orientation])


def _neighbours(model: Model, values: Floats) -> tuple[Floats, Floats]:
    """(2m, n) values forth and back along every parameter that shows, and (m,) their distances.

    Next to the edge of what is valid, one of the two is the point itself.
    """
    here = model.coordinates(values[None])
    vectors, spans = [], []
    for k in np.flatnonzero(model.fitted):
        step = _STEP * np.eye(len(values))[k]
        pair = model.values(np.concatenate([here + step, here - step]))
        valid = model.valid(pair)
        if not valid.any():
            key = model.parameters[k].key
            raise InputError(
                f"{key}: {model.shown(values)[k]:g}; cannot change by a hundredth of its scale "
                "within the model; give a value further inside"
            )
        vectors += [pair[i] if valid[i] else values for i in range(2)]
        spans.append(_STEP * float(valid.sum()))
    return np.array(vectors), np.array(spans)


def _marginal(slopes: Floats, parameters: int) -> Floats:
    """(m, m) Schur complement from (m + 3, F) slopes over σ; those of the start come last."""
    of, start = slopes[:parameters], slopes[parameters:]
    scaled = start / np.linalg.norm(start, axis=1)[:, None]
    left = of - np.linalg.lstsq(scaled.T, of.T, rcond=None)[0].T @ scaled
    return np.asarray(left @ left.T)
