"""Noise of the tips' log and of its stamps, from travel that should be even.

Over a few samples a tip travels evenly: what a cubic in time leaves across the travel is noise of the
position; along it, noise of the stamps adds its time times the speed. Noise is as large about a
parabola; what is larger there is motion that is not even.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.recordings.values import RecordingSet
from meso_robust.types import Floats

_LENGTH = 7
_FAST = 0.3  # of the fastest piece
_MEDIAN_CHI2 = {2: 3.35669, 3: 2.36597}
"""Median of χ² with the degrees of freedom that a polynomial of a degree leaves of seven samples."""
_WHITE = 1.3  # by which noise about a parabola may exceed that about a cubic
_FEWEST = 10  # pieces
_CLEAR = 1.5  # by which the noise along must exceed that across before stamps are blamed


@dataclass(frozen=True, slots=True, kw_only=True)
class StraightTest:
    """Noise of travelling tips.

    Attributes
    ----------
    pieces
        Stretches of seven samples in even travel.
    tip_sigma
        Standard deviation in m of a coordinate of a tip, from what is across the travel.
    along
        The same along the travel.
    stamp_sigma
        Standard deviation in s of a stamp that explains the rest along the travel; 0 where there is
        none.
    even
        Whether the travel is even: otherwise the deviations are those of the motion, not of noise.
    """

    pieces: int
    tip_sigma: float
    along: float
    stamp_sigma: float
    even: bool


def straight_test(recordings: RecordingSet) -> StraightTest | None:
    """Noise of the tips' log from straight travel.

    Parameters
    ----------
    recordings
        The set.

    Returns
    -------
    StraightTest or None
        None where hardly a tip travels.
    """
    across, along, speeds = _all_pieces(recordings, 3)
    if across.size < _FEWEST:
        return None
    position, whole = _sigma(across, 3), _sigma(along, 3)
    about_parabola = _sigma(_all_pieces(recordings, 2)[0], 2)
    stamp = 0.0
    if whole > _CLEAR * position:
        excess = np.median((along - position**2 * _MEDIAN_CHI2[3]) / speeds**2)
        stamp = float(np.sqrt(max(float(excess), 0.0) / _MEDIAN_CHI2[3]))
    return StraightTest(
        pieces=int(across.size),
        tip_sigma=position,
        along=whole,
        stamp_sigma=stamp,
        even=about_parabola <= _WHITE * position,
    )


def _sigma(squares: Floats, degree: int) -> float:
    return float(np.sqrt(np.median(squares) / _MEDIAN_CHI2[degree]))


def tip_sigma(recordings: RecordingSet) -> float | None:
    """Noise of the controller's log: as stated, else from straight travel.

    Parameters
    ----------
    recordings
        The set.

    Returns
    -------
    float or None
        m; None where neither tells it.
    """
    if recordings.sensor.tip_sigma is not None:
        return recordings.sensor.tip_sigma
    found = straight_test(recordings)
    return found.tip_sigma if found and found.even else None


def _all_pieces(recordings: RecordingSet, degree: int) -> tuple[Floats, Floats, Floats]:
    """`_pieces` of all tips of all recordings."""
    none = (np.zeros(0), np.zeros(0), np.zeros(0))
    pieces = [
        _pieces(one.times, tip, degree)
        for one in recordings.recordings
        for tip in one.probes.transpose(1, 0, 2)
    ]
    across, along, speeds = (np.concatenate(each) for each in zip(none, *pieces, strict=True))
    return across, along, speeds


def _pieces(times: Floats, tip: Floats, degree: int) -> tuple[Floats, Floats, Floats]:
    """Squares left across and along the travel, in m², and speeds in m/s, of every fast piece."""
    good = np.all(np.isfinite(tip), axis=1)
    times, tip = times[good], tip[good]
    count = (len(times) - _LENGTH) // 3 + 1
    if count < 1:
        return np.zeros(0), np.zeros(0), np.zeros(0)
    rows = 3 * np.arange(count)[:, None] + np.arange(_LENGTH)
    clock = times[rows] - times[rows].mean(axis=1, keepdims=True)
    scale = np.abs(clock).max(axis=1, keepdims=True)
    basis = np.linalg.qr((clock / scale)[..., None] ** np.arange(degree + 1))[0]
    places = tip[rows] - tip[rows].mean(axis=1, keepdims=True)
    left = places - basis @ (basis.transpose(0, 2, 1) @ places)
    way = tip[rows[:, -1]] - tip[rows[:, 0]]
    speeds = np.hypot(*way.T) / (times[rows[:, -1]] - times[rows[:, 0]])
    fast = speeds > _FAST * speeds.max()
    ahead = way[fast] / np.hypot(*way[fast].T)[:, None]
    aside = np.column_stack((-ahead[:, 1], ahead[:, 0]))
    across = np.sum(np.sum(left[fast] * aside[:, None], axis=2) ** 2, axis=1)
    along = np.sum(np.sum(left[fast] * ahead[:, None], axis=2) ** 2, axis=1)
    return across, along, speeds[fast]


def path_sigma(recordings: RecordingSet) -> float:
    """By how much a sample of the controller's log may be off the way that the tip went.

    Parameters
    ----------
    recordings
        The set.

    Returns
    -------
    float
        m: of position and stamps together, as stated or as even travel shows it; zero where travel is not
        even enough to tell.
    """
    found = straight_test(recordings)
    along = found.along if found and found.even else 0.0
    return max(tip_sigma(recordings) or 0.0, along)
