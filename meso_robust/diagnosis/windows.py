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

from meso_robust.diagnosis.document import Channel, PhaseName
from meso_robust.diagnosis.hidden_inputs import (
    CHANNELS,
    TIP_OFFSET,
    ChannelTotal,
    Inputs,
    Statistics,
    channel_totals,
    statistics_of,
    surprise,
    with_inputs,
)
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared, prepare
from meso_robust.identification.problem import Fits, Problem, Settings
from meso_robust.recordings import RecordingSet, unwrapped
from meso_robust.recordings.contact import gaps, margin
from meso_robust.recordings.phases import phases
from meso_robust.simulator import Outcome
from meso_robust.types import Flags, Floats, Ints

FEWEST = 5
"""Frames with a whole pose that a window must have: a start and a drift take two of them."""
PIECES = (15, 5)
"""Frames of a piece of a contact, where there are enough, and most pieces."""
_PAD = 1e-3  # s: what a shorter window is lengthened by, at rest
_ROUNDS = 3  # of the fit of the starts
_DAMPING = (1e-3, 1.0, 30.0)  # shares of the diagonal, tried at once
_FLOOR = 1e-6  # information below which a start is not moved


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """A window of a recording.

    Attributes
    ----------
    recording
        Index of the recording in the set.
    first, last
        Index of its first frame among the prepared instants, and of the first frame after it.
    start_s, end_s
        Instants of its first and of its last frame.
    phase
        What the tips did.
    """

    recording: int
    first: int
    last: int
    start_s: float
    end_s: float
    phase: PhaseName


def cuts_of(
    recordings: RecordingSet, prepared: Prepared, pieces: tuple[int, int] = PIECES
) -> tuple[Cut, ...]:
    """Cut every recording by its phases, and contacts into pieces.

    Windows with fewer than `FEWEST` whole frames are left out.

    Parameters
    ----------
    recordings, prepared
        The same recordings as read and as prepared.
    pieces
        As `PIECES`.
    """
    count = len(prepared.files)
    return tuple(cut for r in range(count) for cut in _cut(recordings, prepared, r, pieces))


def _cut(
    recordings: RecordingSet, prepared: Prepared, r: int, pieces: tuple[int, int]
) -> list[Cut]:
    recording = unwrapped(recordings.recordings[r])
    instants = prepared.instants[r, : frames_of(prepared)[r]]
    gap = gaps(recordings.part.outline, recording.poses, recording.probes, recordings.tip_radius)
    with np.errstate(invalid="ignore"):
        touching = np.sum(gap <= margin(recordings, recording), axis=1)
    two = np.interp(instants, recording.times, touching > 1) > 0.5
    found: list[Cut] = []
    for phase in phases(recordings, recording):
        end = np.inf if phase.end == recording.times[-1] else phase.end
        inside = np.flatnonzero((instants >= phase.start) & (instants < end))
        for piece in _pieces(inside, two, pieces) if phase.name == "contact" else [inside]:
            name: PhaseName = "approach"
            if phase.name == "contact":
                name = "two_point" if two[piece[0]] else "one_point"
            elif phase.name != "unknown":
                name = phase.name
            found += _whole(prepared, r, piece, name)
    return found


def _pieces(inside: Ints, two: Flags, pieces: tuple[int, int]) -> list[Ints]:
    """Frames of a contact cut where a second tip comes or goes, and into equal pieces."""
    changes = 1 + np.flatnonzero(np.diff(two[inside]))
    parts = [part for part in np.split(inside, changes) if len(part)]
    frames, most = pieces
    return [
        piece
        for part in parts
        for piece in np.array_split(part, int(np.clip(len(part) // frames, 1, most)))
    ]


def _whole(prepared: Prepared, r: int, piece: Ints, phase: PhaseName) -> list[Cut]:
    """The window from its first whole frame, if enough of them are left."""
    whole = piece[np.all(np.isfinite(prepared.seen[r, piece]), axis=1)]
    if len(whole) < FEWEST:
        return []
    times = prepared.instants[r]
    return [
        Cut(
            recording=r,
            first=int(whole[0]),
            last=int(piece[-1]) + 1,
            start_s=float(times[whole[0]]),
            end_s=float(times[piece[-1]]),
            phase=phase,
        )
    ]


def frames_of(prepared: Prepared) -> Ints:
    """(R,) number of frames of each recording, without the padding."""
    seen = np.any(np.isfinite(prepared.seen), axis=2)
    return np.asarray(seen.shape[1] - np.argmax(seen[:, ::-1], axis=1))


def tips_of(prepared: Prepared) -> Floats:
    """(R, T, P, 2) positions of the probes at the prepared instants, m."""
    flat = prepared.waypoints.reshape(*prepared.waypoints.shape[:2], -1)
    tips = [
        np.stack([np.interp(t, clock, column) for column in path.T], axis=1)
        for t, clock, path in zip(prepared.instants, prepared.times, flat, strict=True)
    ]
    return np.stack(tips).reshape(*prepared.instants.shape, -1, 2)


def sliced(prepared: Prepared, cuts: tuple[Cut, ...]) -> Prepared:
    """W windows as recordings of their own, on the clock of the recording, starts as first seen.

    A start may overlap a tip: a misfit does that, and the simulator shifts it.
    """
    legs = [_legs(prepared, cut) for cut in cuts]
    wide = 1 + max(len(times) for times, _ in legs)
    frames = max(cut.last - cut.first for cut in cuts)
    clocks = [prepared.instants[cut.recording, cut.first : cut.last] for cut in cuts]
    paths = [np.concatenate([path, np.repeat(path[-1:], wide - len(path), 0)]) for _, path in legs]
    return replace(
        prepared,
        files=tuple(prepared.files[cut.recording] for cut in cuts),
        waypoints=np.stack(paths),
        times=np.stack([_padded(times, wide) for times, _ in legs]),
        instants=np.stack([_padded(clock, frames) for clock in clocks]),
        seen=_sliced_poses(prepared.seen, cuts),
        starts=np.stack([prepared.seen[cut.recording, cut.first] for cut in cuts]),
        correction=np.zeros((len(cuts), frames, 3)),
        lean=prepared.lean[[cut.recording for cut in cuts]],
        notes=(),
    )


def _sliced_poses(poses: Floats, cuts: tuple[Cut, ...]) -> Floats:
    """(W, T', 3) poses (R, T, 3) of the windows, padded with NaN."""
    frames = max(cut.last - cut.first for cut in cuts)
    pieces = np.full((len(cuts), frames, 3), np.nan)
    for row, cut in zip(pieces, cuts, strict=True):
        row[: cut.last - cut.first] = poses[cut.recording, cut.first : cut.last]
    return pieces


def _legs(prepared: Prepared, cut: Cut) -> tuple[Floats, Floats]:
    """(L,) s and (L, P, 2) m: the path of the probes from the first to the last frame."""
    clock, path = prepared.times[cut.recording], prepared.waypoints[cut.recording]
    inside = (clock > cut.start_s) & (clock < cut.end_s)
    times = np.array([cut.start_s, *clock[inside], cut.end_s])
    flat = path.reshape(len(path), -1)
    way = np.stack([np.interp(times, clock, column) for column in flat.T], axis=1)
    return times, way.reshape(len(times), -1, 2)


def _padded(times: Floats, count: int) -> Floats:
    more = count - len(times)
    return np.append(times, times[-1] + _PAD * np.arange(1, more + 1) / max(more, 1))


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
    inputs
        The model with hidden inputs.
    cuts
        The W windows.
    prepared
        The windows as recordings.
    poses
        (W, 3) predicted in the middle of each window, m and rad.
    offsets
        (W, 4) of the tips at the beginning and the end of each window, x and y, as fitted, m.
    found
        What the recordings say.
    """

    inputs: Inputs
    cuts: tuple[Cut, ...]
    prepared: Prepared
    poses: Floats
    offsets: Floats
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
    pieces: tuple[int, int] = PIECES,
    apart: float = 0.0,
) -> Windows:
    """Look at every window of a recording set.

    Parameters
    ----------
    recordings
        As read.
    model, values
        The plain model, or one with effects, and its fitted parameters (n,), SI.
    sigma
        (3,) standard deviations of x and y (m) and θ (rad).
    correlation
        φ of the noise of neighbouring frames.
    prepared
        The recordings as prepared for the model; prepared here by default.
    pieces
        As `PIECES`.
    apart
        m: by about how much tips may be off in a window where they are not known to be, fitted with its start.

    Raises
    ------
    InputError
        As `prepare`.
    ValueError
        If no recording has a window with enough frames.
    """
    whole = prepare(recordings, step=model.step) if prepared is None else prepared
    cuts = cuts_of(recordings, whole, pieces)
    if not cuts:
        raise ValueError(
            "recordings: no window with enough frames; record longer or with all poses"
        )
    settings = Settings(
        position=sigma[0], orientation=sigma[2], offset=whole.tip_offset or TIP_OFFSET
    )
    inputs = with_inputs(model, whole.tip_radius)
    extended = np.append(values, np.zeros(len(inputs.model.parameters) - inputs.base))[None]
    problem = Problem(sliced(whole, cuts), inputs.model, settings)
    # commanded tips are where they are said to be; only derivatives ask what if not
    known = whole.tip_offset or apart
    fits = _settled(replace(problem, settings=replace(settings, offset=known)), extended)
    ran = fits.outcomes[0] == Outcome.COMPLETED
    jacobian = problem.jacobian(fits, inputs.spans, inputs.model.fitted[None])[0]
    jacobian[~ran] = 0.0
    found = statistics_of(inputs, problem.prepared, fits, jacobian, settings, correlation)
    return Windows(
        inputs=inputs,
        cuts=cuts,
        prepared=problem.prepared,
        poses=_middle(problem.prepared, fits, settings.sigma),
        offsets=fits.offsets[0],
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
        known = 7 if problem.settings.offset else 3
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
