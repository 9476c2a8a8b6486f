"""Units that do not fit together: while the part moves, a tip should be at its outline."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meso_robust.recordings.checks.view import View
from meso_robust.recordings.contact import gaps, scatter, size
from meso_robust.recordings.direct.causes import Cause
from meso_robust.recordings.document import SET_FILE
from meso_robust.recordings.problem import Problem
from meso_robust.types import Indices as Integers
from meso_robust.wording import counted

_OFF, _FITS = 0.10, 0.02  # median distance of the tip over the part's size: wrong, right
_BETTER = 10.0  # times nearer with the right factor; with a wrong one a tip may be near by chance
_TURNED, _CLEARLY = 0.004, 3.0  # the same of a whole set: mean distance, times nearer in rad
_WINDOW = 5  # frames on either side for the speed of the part
_CLEAR = 6.0  # standard deviations of a motion that is no noise; noise itself makes 4
_FAST = 0.6  # of the fastest: the part moves on both sides of the frame
_FEWEST = 5


@dataclass(frozen=True, slots=True)
class _Guess:
    """Factors that would bring the numbers of the files to um and deg."""

    words: str
    part: float = 1.0
    probes: float = 1.0
    theta: float = 1.0
    outline: float = 1.0


_RAD = 180.0 / math.pi
_GUESSES = (
    _Guess("θ in rad: factor 57.29578", theta=_RAD),
    *(
        guess
        for unit, factor in (("mm", 1e3), ("m", 1e6))
        for guess in (
            _Guess(f"part and probes in {unit}: factor {factor:g}", factor, factor),
            _Guess(
                f"part and probes in {unit}: factor {factor:g}, and θ in rad: factor 57.29578",
                factor,
                factor,
                _RAD,
            ),
            _Guess(f"part_x_um and part_y_um in {unit}: factor {factor:g}", part=factor),
            _Guess(f"positions of the probes in {unit}: factor {factor:g}", probes=factor),
            _Guess(f"outline in set.toml in {unit}: factor {factor:g}", outline=factor),
        )
    ),
)


def unit_problems(view: View) -> list[Problem]:
    """Say which factor would bring the tips to the part, if the numbers as they stand do not."""
    frames = _moving(view)
    if frames.size < _FEWEST or not view.recording.probes.shape[1]:
        return []
    now = _distance(view, frames, _Guess("as they stand"))
    if now < _OFF:
        return []
    fits = [
        (distance, guess.words)
        for distance, guess in ((_distance(view, frames, guess), guess) for guess in _GUESSES)
        # a huge outline is near everything over its size: the distance itself must shrink as well
        if distance <= _FITS and _BETTER * distance * max(guess.outline, 1.0) <= now
    ]
    if not fits:
        return []
    distance, words = min(fits)
    return [
        view.problem(
            "units",
            "error",
            np.zeros(0, dtype=np.intp),
            f"while the part moves, the nearest tip is {now:.3g} part sizes from its outline",
            "must be in um and deg throughout, as the names of columns and keys say",
            f"it would fit ({distance:.2g} part sizes) with {words}; convert the files",
        )
    ]


def turn_unit_problems(views: Sequence[View], slip: Cause | None) -> list[Problem]:
    """Say that θ is in rad if all recordings together fit far better so.

    A small turn taken for 57 times less leaves a tip near the outline, and each recording by itself
    within what a bad outline or a late camera does; all at once nothing else brings so much nearer. Where a delay or a
    shift does, which a fit can find, it is that.

    Parameters
    ----------
    views
        All recordings of a set, without poses that are no measurement.
    slip
        From `slips.slip_of`.

    Returns
    -------
    list of Problem
        One or none.
    """
    guess = _GUESSES[0]
    pairs = [
        (_distance(view, frames, _Guess("as they stand")), _distance(view, frames, guess))
        for view in views
        if view.recording.probes.shape[1] and (frames := _turned(view)).size >= _FEWEST
    ]
    if not pairs:
        return []
    now, then = np.mean(pairs, axis=0).tolist()
    if now < _TURNED or _CLEARLY * then > now:
        return []
    whole = size(views[0].recordings.part.outline)
    if slip is not None and slip.fitted and slip.after <= then * whole:
        return []
    return [
        Problem(
            file=SET_FILE,
            kind="units",
            severity="error",
            value=f"while the part moves, the nearest tip is {now:.3g} part sizes from its outline, "
            f"mean of {counted(len(pairs), 'recording')}",
            rule="must be in um and deg throughout, as the names of columns and keys say",
            advice=f"it would fit ({then:.2g} part sizes) with {guess.words}; convert the files",
        )
    ]


def _turned(view: View) -> Integers:
    """The half of the frames in motion in which θ is largest, where its unit matters most."""
    frames = _moving(view)
    if not frames.size:
        return frames
    angle = np.abs(view.poses[frames, 2])
    return frames[angle >= np.median(angle)]


def _moving(view: View) -> Integers:
    """Frames in which the part moves clearly, whatever the unit."""
    places = view.poses[view.seen]
    if len(places) < 2 * _WINDOW + _FEWEST:
        return np.zeros(0, dtype=np.intp)
    clear = np.zeros(len(places) - 2 * _WINDOW, dtype=bool)
    for columns in (places[:, :2], places[:, 2:]):
        way = np.linalg.norm(columns[2 * _WINDOW :] - columns[: -2 * _WINDOW], axis=1)
        fastest = float(np.quantile(way, 0.98))
        if fastest > _CLEAR * scatter(columns):
            clear |= way > _FAST * fastest
    return np.asarray(view.seen[_WINDOW:-_WINDOW][clear])


def _distance(view: View, frames: Integers, guess: _Guess) -> float:
    """Median distance of the nearest tip from the outline, over the part's size."""
    outline = guess.outline * view.recordings.part.outline
    poses = view.poses[frames] * [guess.part, guess.part, guess.theta]
    tips = guess.probes * view.recording.probes[frames]
    # a guess for the outline, which stands in the same file, holds for the tip's radius too
    radius = guess.outline * view.recordings.tip_radius
    each = np.abs(gaps(outline, poses, tips, radius))
    nearest = np.where(np.isnan(each), np.inf, each).min(axis=1)
    nearest = nearest[np.isfinite(nearest)]
    return float(np.median(nearest)) / size(outline) if nearest.size >= _FEWEST else 0.0
