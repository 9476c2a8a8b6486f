"""How much a push makes of errors of its start: the paper's Test 1 (Figs. 4 and 5), for any push.

A start is *pathological* in a box of starts if an error of the start more than doubles, if the part
turns either way, if it ends in another contact with the tip, or if some runs do not complete. Such a
push is no use for identification: its motion says more of the start than of the part.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.errors import InputError
from meso_robust.identification.experiment import PlannedPush
from meso_robust.identification.forward import predicted
from meso_robust.identification.models import Model, characteristic_length
from meso_robust.identification.prepared import prepare
from meso_robust.identification.rollout import Setting, rollout, start_of
from meso_robust.identification.voting import Arms, arms
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.rules import DEG, UM
from meso_robust.simulator import Outcome
from meso_robust.types import Flags, Floats

MOST_GROWTH = 2.0
"""An error of the start that more than doubles makes a start pathological."""
_STEP = 0.5e-6
"""Of the finite differences, m; of θ divided by the characteristic length."""
_DIFFERENCES = 6
_INTERVALS = 20
_NO_TURN = 1e-6
"""Turning by less than this, rad, is rounding."""
_CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))

EITHER_WAY = "turns either way"
OTHER_CONTACT = "ends in another contact"
GROWS = "an error of the start more than doubles"
FAILS = "does not complete everywhere"


@dataclass(frozen=True, slots=True)
class StartBox:
    """Half widths of the box of starts about the planned one; the paper's by default.

    The part and the tip are both uncertain; only where the part is against the tip matters.

    Attributes
    ----------
    position
        Of x and of y, m.
    orientation
        Of θ, rad.

    Raises
    ------
    InputError
        If a half width is negative or not finite, or both are zero.
    """

    position: float = 5e-6
    orientation: float = 0.005 * DEG

    def __post_init__(self) -> None:
        """Check the half widths."""
        for name in ("position", "orientation"):
            value = getattr(self, name)
            if not 0.0 <= value < np.inf:
                raise InputError(f"{name}: {value}; must be finite and not negative; change it")
        if self.position == self.orientation == 0.0:
            raise InputError("position: 0; a box of one start has no spread; give a half width")

    @property
    def half_widths(self) -> Floats:
        """(3,) m, m and rad."""
        return np.array([self.position, self.position, self.orientation])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sensitivity:
    """Outcome of a box of starts; the first start is the planned one.

    Attributes
    ----------
    name
        Of the push, or the file of the recording.
    starts, ends
        (S, 3) poses, m and rad, world frame.
    paths
        (S, R, 3) poses on the way.
    completed
        (S,) whether the run completed.
    modes
        (S, P) last contact modes of the tips, as in `PushResult`.
    growth
        Largest singular value of the map from start to end at the planned start, by central
        differences; θ times the characteristic length of the part.
    sampled_growth
        Largest error of an end over its own start's error, over the box: the map has kinks.
    arms
        Of all starts, in closed form; None for a recording, whose tip may take any path.
    """

    name: str
    starts: Floats
    ends: Floats
    paths: Floats
    completed: Flags
    modes: npt.NDArray[np.int8]
    growth: float
    sampled_growth: float
    arms: Arms | None = None

    @property
    def spread(self) -> Floats:
        """(3,) widths of the box of ends, m and rad."""
        return np.asarray(np.ptp(self.ends, axis=0))

    @property
    def turned(self) -> Floats:
        """(S,) by how much the part turned, rad."""
        return np.asarray(self.ends[:, 2] - self.starts[:, 2])

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the start is pathological; none if it is not."""
        found = {
            EITHER_WAY: self.turned.min() < -_NO_TURN and self.turned.max() > _NO_TURN,
            OTHER_CONTACT: bool(np.any(self.modes != self.modes[0])),
            GROWS: max(self.growth, self.sampled_growth) > MOST_GROWTH,
            FAILS: not bool(self.completed.all()),
        }
        return tuple(name for name, holds in found.items() if holds)

    @property
    def pathological(self) -> bool:
        """Whether the start is to be avoided."""
        return bool(self.reasons)


def sensitivities(
    setting: Setting,
    pushes: Sequence[PlannedPush],
    values: Floats,
    box: StartBox,
    *,
    samples: int = 16,
    seed: int = 0,
) -> tuple[Sensitivity, ...]:
    """Spread and growth of errors of the start of every push, in one batch of runs.

    Parameters
    ----------
    setting
        Part, bench and model.
    pushes
        P pushes.
    values
        (n,) parameters in SI.
    box
        Of starts.
    samples
        Random starts in the box, beside the planned one and the eight corners.
    seed
        Of the random starts, the same for every push.

    Returns
    -------
    tuple of Sensitivity
        One a push.

    Raises
    ------
    InputError
        If the box reaches the tip, or the values are not valid.
    """
    length = characteristic_length(setting.part.outline)
    _check_reach(setting, box, length)
    offsets = _offsets(box, length, samples, seed)
    each = len(offsets)
    starts = start_of(pushes)[:, None] + offsets
    repeated = [push for push in pushes for _ in range(each)]
    result = rollout(setting, repeated, starts.reshape(-1, 3), values, intervals=_INTERVALS)
    runs = _Runs(
        starts=starts,
        paths=result.path.reshape(len(pushes), each, -1, 3),
        completed=(result.outcomes == Outcome.COMPLETED).reshape(-1, each),
        modes=result.modes[:, -1].reshape(len(pushes), each, -1),
    )
    return tuple(
        replace(
            _judged(push.name, runs, k, length),
            arms=arms(setting, push, starts[k, : each - _DIFFERENCES], values),
        )
        for k, push in enumerate(pushes)
    )


def sensitivities_of_set(
    recordings: RecordingSet,
    model: Model,
    values: Floats,
    box: StartBox,
    *,
    samples: int = 16,
    seed: int = 0,
) -> tuple[Sensitivity, ...]:
    """The same for the starts of a recording set, whose tips move as they were recorded.

    Parameters
    ----------
    recordings
        The set; a start in the box that overlaps a tip is moved out of it by the least shift.
    model, values
        The physics, and its (n,) parameters in SI.
    box
        Of starts about the first pose seen.
    samples, seed
        As in `sensitivities`.

    Returns
    -------
    tuple of Sensitivity
        One a recording.

    Raises
    ------
    InputError
        If a recording cannot be simulated.
    """
    prepared = prepare(recordings, step=model.step, most_frames=_INTERVALS + 1)
    offsets = _offsets(box, prepared.length, samples, seed)
    starts = prepared.starts + offsets[:, None]
    found = predicted(prepared, model, np.tile(values, (len(offsets), 1)), starts=starts)
    moved = starts.copy()
    moved[..., :2] += found.shifts
    runs = _Runs(
        starts=moved.swapaxes(0, 1),
        paths=found.poses.swapaxes(0, 1),
        completed=(found.outcomes == Outcome.COMPLETED).T,
        modes=found.modes[:, :, -1].swapaxes(0, 1),
    )
    return tuple(_judged(file, runs, k, prepared.length) for k, file in enumerate(prepared.files))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Runs:
    """P pushes from S starts each, the last of them for the differences."""

    starts: Floats
    paths: Floats
    completed: Flags
    modes: npt.NDArray[np.int8]


def _judged(name: str, runs: _Runs, k: int, length: float) -> Sensitivity:
    sampled = runs.starts.shape[1] - _DIFFERENCES
    scale = np.array([1.0, 1.0, length])
    starts, ends = runs.starts[k], runs.paths[k, :, -1]
    errors = np.linalg.norm((ends[1:sampled] - ends[0]) * scale, axis=1)
    own = np.linalg.norm((starts[1:sampled] - starts[0]) * scale, axis=1)
    steps = (ends[sampled::2] - ends[sampled + 1 :: 2]) * scale / (2.0 * _STEP)
    return Sensitivity(
        name=name,
        starts=starts[:sampled],
        ends=ends[:sampled],
        paths=runs.paths[k, :sampled],
        completed=runs.completed[k, :sampled],
        modes=runs.modes[k, :sampled],
        growth=float(np.linalg.norm(steps, 2)),
        sampled_growth=float(np.max(errors[own > 0.0] / own[own > 0.0], initial=0.0)),
    )


def _check_reach(setting: Setting, box: StartBox, length: float) -> None:
    reach = float(np.sqrt(2.0)) * box.position + length * box.orientation
    if reach >= setting.bench.gap:
        raise InputError(
            f"box: brings the part {reach / UM:.3g} um nearer to the tip, which starts "
            f"{setting.bench.gap / UM:.3g} um in front of it; must start free of contact; give a "
            "larger gap or a smaller box"
        )


def _offsets(box: StartBox, length: float, samples: int, seed: int) -> Floats:
    """(S, 3) the planned start, the corners of the box, random starts, and six for differences."""
    inside = np.random.default_rng(seed).uniform(-1.0, 1.0, (samples, 3))
    spread = np.concatenate([np.zeros((1, 3)), _CORNERS, inside]) * box.half_widths
    steps = np.repeat(np.eye(3), 2, axis=0) * np.tile([_STEP, -_STEP], 3)[:, None]
    return np.concatenate([spread, steps / np.array([1.0, 1.0, length])])
