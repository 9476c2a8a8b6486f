"""What slip of a unit, a sign or a clock would bring tips and part together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from meso_robust.recordings.contact import gaps, size
from meso_robust.recordings.direct.pushing import Moving, moving
from meso_robust.recordings.values import Recording, RecordingSet
from meso_robust.types import Floats

_FEWEST = 6
_OFF = 0.03  # of the part's size: less is no slip
_BETTER = 3.0  # times nearer than as the files stand
_FITS = 0.08  # of the part's size, at most, with the slip undone
_ALIKE = 1.5  # times the least distance
_DELAYS = np.arange(0.02, 0.52, 0.02)

_Change = Callable[[Recording], Recording]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """A slip that explains where the tips are.

    Attributes
    ----------
    words
        What it is.
    advice
        What to do about it.
    before, after
        Median distance in m between tip and face while the part moves, as it stands and with the slip
        undone.
    fitted
        Whether a fit can find it, as it can a delay or a shift.
    """

    words: str
    advice: str
    before: float
    after: float
    fitted: bool


def likely_cause(recordings: RecordingSet) -> Cause | None:
    """The slip that brings the tips to the part while it moves.

    Parameters
    ----------
    recordings
        The set; poses that are no measurement are unseen.

    Returns
    -------
    Cause or None
        None where the tips are near as it is, or nothing brings them much nearer.
    """
    whole = size(recordings.part.outline)
    runs = [(one, moving(recordings, one)) for one in recordings.recordings]
    runs = [(one, run) for one, run in runs if run.frames.size >= _FEWEST and run.tips.shape[1]]
    if not runs:
        return None
    before = _distance(recordings, [run for _, run in runs], 0.0)
    if before < _OFF * whole:
        return None
    tried = [
        (_distance(recordings, [moving(recordings, change(one)) for one, _ in runs], 0.0), words)
        for words, change in _SLIPS.items()
    ]
    if recordings.position_source == "controller":
        tried += [
            (
                _distance(recordings, [run for _, run in runs], late),
                f"{_LATE} by {1e3 * late:.0f} ms",
            )
            for late in _DELAYS.tolist()
        ]
    least = min(distance for distance, _ in tried)
    # of slips that fit alike the simplest, which stands first
    after, words = next(each for each in tried if each[0] <= _ALIKE * least)
    if after > _FITS * whole or _BETTER * after > before:
        return _shifted(recordings, [run for _, run in runs], before, whole)
    advice = _ADVICE.get(words, "correct the delay or let `diagnose` fit it as camera_latency")
    return Cause(words=words, advice=advice, before=before, after=after, fitted=words not in _SLIPS)


def _shifted(
    recordings: RecordingSet, runs: list[Moving], before: float, whole: float
) -> Cause | None:
    """A shift between the frames of camera and tips, from the best of a coarse search."""
    steps = whole * np.linspace(-0.5, 0.5, 11)
    tried = []
    for x in steps.tolist():
        for y in steps.tolist():
            moved = [replace(run, tips=run.tips + np.array([x, y])) for run in runs]
            tried.append((_distance(recordings, moved, 0.0), x, y))
    after, x, y = min(tried)
    if after > _FITS * whole or _BETTER * after > before:
        return None
    return Cause(
        words=f"tips shifted against the camera by about ({-1e6 * x:.3g}, {-1e6 * y:.3g}) µm",
        advice="register camera and robot again, or let `diagnose` fit it as registration_shift",
        before=before,
        after=after,
        fitted=True,
    )


def _distance(recordings: RecordingSet, runs: list[Moving], late: float) -> float:
    """Median distance in m of the nearest tip's surface from the outline while the part moves."""
    outline, radius = recordings.part.outline, recordings.tip_radius
    found = []
    for run in runs:
        if run.frames.size < _FEWEST:
            continue
        frames = run.frames[np.linspace(0, run.frames.size - 1, 12).round().astype(int)]
        flat = run.tips.reshape(len(run.times), -1)
        at = run.times[frames] - late
        tips = np.column_stack([np.interp(at, run.times, column) for column in flat.T])
        tips = tips.reshape(frames.size, -1, 2)
        found.append(np.abs(gaps(outline, run.poses[frames], tips, radius)).min(axis=1))
    return float(np.median(np.concatenate(found))) if found else float("inf")


def _poses(factors: tuple[float, float, float], turn: float = 0.0) -> _Change:
    def change(recording: Recording) -> Recording:
        poses = recording.poses * factors
        poses[:, 2] += turn
        return replace(recording, poses=poses)

    return change


def _tips(matrix: tuple[tuple[float, float], tuple[float, float]]) -> _Change:
    def change(recording: Recording) -> Recording:
        probes: Floats = recording.probes @ np.array(matrix).T
        return replace(recording, probes=probes)

    return change


_LATE = "the camera lags behind the tips"
_SIGN = "turn the axis round in one of the two"
_RAD = np.pi / 180.0
_SLIPS: Mapping[str, _Change] = MappingProxyType(
    {
        "θ in rad, not in deg": _poses((1.0, 1.0, 1.0 / _RAD)),
        "y of the tips has the other sign": _tips(((1.0, 0.0), (0.0, -1.0))),
        "x of the tips has the other sign": _tips(((-1.0, 0.0), (0.0, 1.0))),
        "x and y of the tips are exchanged": _tips(((0.0, 1.0), (1.0, 0.0))),
        "θ has the other sign": _poses((1.0, 1.0, -1.0)),
        "θ is off by 90°": _poses((1.0, 1.0, 1.0), 0.5 * np.pi),
        "y and θ of the part have the other sign": _poses((1.0, -1.0, -1.0)),
        "x and y of the tips are exchanged, one with the other sign": _tips(
            ((0.0, -1.0), (1.0, 0.0))
        ),
    }
)
_ADVICE: Mapping[str, str] = MappingProxyType(
    {
        "θ in rad, not in deg": "multiply part_theta_deg by 57.29578",
        **{words: _SIGN for words in _SLIPS if "sign" in words},
        "x and y of the tips are exchanged": "exchange the columns",
        "θ is off by 90°": "give length and width the other way round, or turn θ",
    }
)
