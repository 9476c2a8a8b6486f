"""Where the plain model fails: every window by itself, and what hidden input would explain it.

Recordings are cut into windows by contact phase. With the parameters held, only the pose at the start
of each window is fitted; what is left is the misfit that arises within the window. To it hidden
inputs are fitted, constant within a window and free from window to window, one stage of the chain at
a time, through the derivatives of the complementarity simulator: contacts stay unilateral and keep
their friction. A *slack* is the twist by which the part moved beyond the model, whatever the cause.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meso_robust.diagnosis.cuts import Cut, cuts_of, sliced
from meso_robust.diagnosis.document import Channel, PhaseName
from meso_robust.diagnosis.hidden_inputs import (
    CHANNELS,
    TIP_OFFSET,
    ChannelTotal,
    Statistics,
    channel_totals,
    statistics_of,
    surprise,
    with_inputs,
)
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared, prepare
from meso_robust.identification.problem import Fits, Problem, Settings
from meso_robust.recordings import RecordingSet
from meso_robust.simulator import Outcome
from meso_robust.types import Floats

_ROUNDS = 3  # of the fit of the starts
_DAMPING = (1e-3, 1.0, 30.0)  # shares of the diagonal, tried at once
_FLOOR = 1e-6  # information below which a start is not moved


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Window:
    """One window: where it is, how badly the model does, and what would help.

    Attributes
    ----------
    recording, start_s, end_s, phase
        As in `Cut`.
    components
        (3,) misfit along x, y and θ, see `Statistics`.
    sigma
        The misfit in standard deviations of chance.
    channel
        Stage whose hidden input explains it best, for the inputs that it takes.
    """

    recording: int
    start_s: float
    end_s: float
    phase: PhaseName
    components: Floats
    sigma: float
    channel: Channel


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Windows:
    """All windows of a set, and what they say.

    Attributes
    ----------
    cuts
        The W windows.
    prepared
        The windows as recordings.
    poses
        (W, 3) predicted in the middle of each window, m and rad.
    found
        What the recordings say.
    """

    cuts: tuple[Cut, ...]
    prepared: Prepared
    poses: Floats
    found: Statistics

    def __len__(self) -> int:
        """Number of windows."""
        return len(self.cuts)

    @property
    def windows(self) -> tuple[Window, ...]:
        """One by one."""
        return tuple(self._window(w) for w in range(len(self)))

    def totals(self) -> tuple[ChannelTotal, ...]:
        """By channel, in the order of `CHANNELS`."""
        return channel_totals(self.found)

    def _window(self, w: int) -> Window:
        cut, found = self.cuts[w], self.found
        cost = np.log(max(found.freedom[w], np.e))
        paid = (found.gains[w] - cost * found.ranks[w])[: len(CHANNELS)]
        return Window(
            recording=cut.recording,
            start_s=cut.start_s,
            end_s=cut.end_s,
            phase=cut.phase,
            components=found.components[w],
            sigma=float(np.maximum(surprise(found.chi2[w], found.freedom[w]), 0.0)),
            channel=CHANNELS[int(np.argmax(paid))],
        )


def windowed(
    recordings: RecordingSet,
    model: Model,
    values: Floats,
    sigma: Floats,
    correlation: float = 0.0,
    *,
    prepared: Prepared | None = None,
) -> Windows:
    """Look at every window of a recording set.

    Parameters
    ----------
    recordings
        As read.
    model, values
        The plain model and its fitted parameters (n,), SI.
    sigma
        (3,) standard deviations of x and y (m) and θ (rad).
    correlation
        φ of the noise of neighbouring frames.
    prepared
        The recordings as prepared for the model; prepared here by default.

    Raises
    ------
    InputError
        As `prepare`.
    ValueError
        If no recording has a window with enough frames.
    """
    whole = prepare(recordings, step=model.step) if prepared is None else prepared
    cuts = cuts_of(recordings, whole)
    if not cuts:
        raise ValueError(
            "recordings: no window with enough frames; record longer or with all poses"
        )
    settings = Settings(
        position=sigma[0], orientation=sigma[2], offset=whole.tip_offset or TIP_OFFSET
    )
    inputs = with_inputs(model)
    extended = np.append(values, np.zeros(len(inputs.model.parameters) - inputs.base))[None]
    problem = Problem(sliced(whole, cuts), inputs.model, settings)
    # commanded tips are where they are said to be; only derivatives ask what if not
    fits = _settled(replace(problem, settings=replace(settings, offset=whole.tip_offset)), extended)
    ran = fits.outcomes[0] == Outcome.COMPLETED
    jacobian = problem.jacobian(fits, inputs.spans, inputs.model.fitted[None])[0]
    jacobian[~ran] = 0.0
    found = statistics_of(inputs, problem.prepared, fits, jacobian, settings, correlation)
    return Windows(
        cuts=cuts,
        prepared=problem.prepared,
        poses=_middle(problem.prepared, fits, settings.sigma),
        found=found,
    )


def _middle(prepared: Prepared, fits: Fits, sigma: Floats) -> Floats:
    """(W, 3) predicted poses in the middle frames that were seen."""
    poses = prepared.seen - fits.residuals[0] * sigma
    rows = []
    for pose in poses:
        kept = np.flatnonzero(np.all(np.isfinite(pose), axis=1))
        rows.append(pose[kept[len(kept) // 2]])
    return np.stack(rows)


def _settled(problem: Problem, values: Floats) -> Fits:
    """The starts of all windows fitted, each window going down by itself."""
    shape, n = (1, len(problem.prepared.files)), len(problem.model.parameters)
    starts = np.broadcast_to(problem.prepared.starts, (*shape, 3))
    fits = problem.at(values, starts, np.zeros((*shape, 4)))
    none = np.zeros((1, n), dtype=bool)
    for _ in range(_ROUNDS):
        slopes = problem.jacobian(fits, np.ones((1, n)), none)[0]
        # commanded tips are where they are said to be
        known = 7 if problem.prepared.tip_offset else 3
        fits = _lower(problem, fits, slopes[..., n : n + known])
    return fits


def _lower(problem: Problem, fits: Fits, own: Floats) -> Fits:
    """One damped step of every window where it lowers the window's χ²."""
    settings, d = problem.settings, own.shape[-1]
    normal = np.swapaxes(own, 1, 2) @ own
    slope = np.einsum("wmd,wm->wd", own, fits.residuals[0].reshape(len(own), -1))
    if settings.offset:
        normal[:, range(3, d), range(3, d)] += 1.0
        slope[:, 3:] -= fits.offsets[0] / settings.offset
    diagonal = np.einsum("wdd->wd", normal)[:, None] * np.eye(d) + _FLOOR * np.eye(d)
    steps = np.stack(
        [np.linalg.solve(normal + share * diagonal, slope[..., None])[..., 0] for share in _DAMPING]
    )
    moves = np.zeros((len(steps), *fits.offsets.shape[1:]))
    moves[..., : d - 3] = steps[..., 3:] * settings.offset
    tried = problem.at(
        np.repeat(fits.values, len(_DAMPING), axis=0),
        fits.starts + steps[..., :3] * settings.sigma,
        fits.offsets + moves,
    )
    costs = np.concatenate([_costs(problem, fits), _costs(problem, tried)])
    best = np.argmin(costs, axis=0)
    rows = np.arange(costs.shape[1])

    def chosen(old: Floats, new: Floats) -> Floats:
        return np.concatenate([old, new])[best, rows][None]

    return Fits(
        values=fits.values,
        starts=chosen(fits.starts, tried.starts),
        offsets=chosen(fits.offsets, tried.offsets),
        chi2=np.array([costs[best, rows].sum()]),
        residuals=chosen(fits.residuals, tried.residuals),
        outcomes=np.concatenate([fits.outcomes, tried.outcomes])[best, rows][None],
    )


def _costs(problem: Problem, fits: Fits) -> Floats:
    """(B, W) χ² by window, offsets included."""
    costs = np.sum(fits.residuals**2, axis=(2, 3))
    if problem.settings.offset:
        costs = costs + np.sum((fits.offsets / problem.settings.offset) ** 2, axis=2)
    return np.where(fits.outcomes == Outcome.COMPLETED, costs, np.inf)
