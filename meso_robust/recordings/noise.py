"""Noise of the sensor, estimated from the frames before the part begins to move.

Still frames show the *repeatability*: the scatter from frame to frame. A *systematic error* (of the
outline, the lens, the place in the image) stays from frame to frame and does not show. σ, as a set
states it and a tracker computes it, is both together.

In each recording a straight line (slow drift) is fitted to each coordinate of the still frames.
Where the frames sway beyond what noise of any colour does (`sway`), that is motion and is fitted as well.
What is left of all recordings is pooled: frames beyond four robust standard deviations (1.4826
times the median absolute deviation) are set aside, then σ² is the sum of squares over its degrees
of freedom. Where that is smooth from frame to frame, it is motion, and there is no estimate. Frames
that repeat the one before bit by bit count once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from meso_robust.recordings.still import still
from meso_robust.recordings.sway import Sway, pieces, sway_of, swing
from meso_robust.recordings.values import Recording, RecordingSet, SensorInfo, unwrapped
from meso_robust.types import Flags, Floats

Source = Literal["stated", "estimated", "unknown"]
"""From ``set.toml``, from still frames, or neither."""

FEWEST = 5
"""Still frames that a recording must have to count; a line takes two of them."""
FEWEST_FREE = 10
"""Degrees of freedom that an estimate must have: then it is good to about a quarter."""
_CLIP = 4.0  # robust deviations; of Gaussian noise one frame in 16000 is beyond
_NORMAL = 1.4826  # standard deviations in the median absolute deviation of a Gaussian
_PASSES = 3
_MEDIAN_CHI2 = 0.4549364  # median of χ² with one degree of freedom
_THIRD = 20.0  # variance of a third difference of white noise of variance 1
_MOTION = 0.9  # correlation from frame to frame beyond which it is no noise but motion


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Noise of one coordinate.

    Attributes
    ----------
    sigma
        Standard deviation in m or rad; None where it cannot be estimated.
    correlation
        Correlation of the noise from one frame to the next, -1 … 1; near 0 for white noise; None
        where it cannot be estimated.
    freedom
        Degrees of freedom n: σ has a relative standard error of about 1/√(2 n) if noise is white.
    reason
        Why σ is None, else None.
    """

    sigma: float | None
    correlation: float | None
    freedom: int
    reason: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Noise:
    """Noise of x and y in m and of θ in rad, each by itself.

    Attributes
    ----------
    x, y, theta
        What scatters.
    sway
        How frames at rest move to and fro, which is no part of the scatter; None where they do not.
    """

    x: Spread
    y: Spread
    theta: Spread
    sway: Sway | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimatedSensor:
    """The sensor of a set with what was stated, completed by what still frames show.

    Attributes
    ----------
    info
        The sensor; a deviation that is neither stated nor can be estimated stays None.
    position_source, orientation_source
        Where the deviations are from.
    noise
        The estimates, also where the set states its own.
    """

    info: SensorInfo
    position_source: Source
    orientation_source: Source
    noise: Noise


def estimated_sensor(recordings: RecordingSet) -> EstimatedSensor:
    """Complete the sensor of a set: stated deviations stay, absent ones are estimated.

    The deviation of a position is the root mean square of those of x and y.

    Parameters
    ----------
    recordings
        The set.

    Returns
    -------
    EstimatedSensor
        The sensor in SI, and where each deviation is from.
    """
    noise, stated = estimated_noise(recordings), recordings.sensor
    position, position_source = _chosen(stated.position_sigma, _position(noise))
    orientation, orientation_source = _chosen(stated.orientation_sigma, noise.theta.sigma)
    return EstimatedSensor(
        info=replace(stated, position_sigma=position, orientation_sigma=orientation),
        position_source=position_source,
        orientation_source=orientation_source,
        noise=noise,
    )


@lru_cache(maxsize=4)  # a diagnosis prepares the same few sets a dozen times, and they never change
def estimated_noise(recordings: RecordingSet) -> Noise:
    """Noise of x, y and θ from the still frames of all recordings, whatever the set states.

    Parameters
    ----------
    recordings
        The set.

    Returns
    -------
    Noise
        Scatter from frame to frame in m and rad, with its degrees of freedom and the correlation of
        neighbours; no deviation where too few frames are still.
    """
    each = [_runs(recordings, recording) for recording in recordings.recordings]
    runs = [run for run in each if len(run.times) >= FEWEST]
    most = max(len(run.times) for run in each)
    frame_rate = recordings.sensor.frame_rate
    fits = [[_fit(run, axis, None) for run in runs] for axis in range(3)]
    rests = [(run.times, run.poses) for run in runs]
    sway = sway_of(rests, frame_rate)
    if sway is not None:
        parts = [_Run(times, poses) for times, poses in pieces(rests)]
        fits = [[_fit(part, axis, sway.rate) for part in parts] for axis in range(3)]
    x, y, theta = (_spread(each, most, frame_rate) for each in fits)
    return Noise(x=x, y=y, theta=theta, sway=sway)


def systematic(sigma: float | None, repeatability: float | None) -> float | None:
    """What of σ stays from frame to frame: the error that still frames do not show.

    Parameters
    ----------
    sigma
        Standard deviation of one value, whatever its error is from; None where it is unknown.
    repeatability
        Scatter from frame to frame of a part at rest; None where it is unknown.

    Returns
    -------
    float or None
        In the unit of the arguments; 0 where the scatter is all of σ, None where one is unknown.
    """
    if sigma is None or repeatability is None:
        return None
    return float(np.sqrt(max(sigma**2 - repeatability**2, 0.0)))


def in_words(sigma: float, repeatability: float | None, unit: float, letter: str) -> str:
    """σ split into repeatability and systematic error, as every report says it.

    Parameters
    ----------
    sigma, repeatability
        In one unit; the latter None where it is unknown.
    unit
        Size of the unit that is shown, in theirs.
    letter
        Name of that unit.

    Returns
    -------
    str
        A clause without a full stop.
    """
    whole = f"σ = {sigma / unit:.3g} {letter}"
    rest = systematic(sigma, repeatability)
    if repeatability is None or rest is None:
        return f"{whole}; repeatability cannot be estimated, too few still frames"
    if repeatability > sigma:
        return f"{whole}, less than the repeatability of {repeatability / unit:.3g} {letter}"
    return (
        f"{whole}: repeatability {repeatability / unit:.3g} {letter}, systematic error "
        f"{rest / unit:.3g} {letter}"
    )


def position_repeatability(noise: Noise) -> float | None:
    """Root mean square of those of x and y in m; None where one is unknown.

    Parameters
    ----------
    noise
        Of still frames.

    Returns
    -------
    float or None
        m.
    """
    return _position(noise)


def roughness(path: Floats) -> float:
    """Standard deviation in m of what is not smooth from one sample (S, C) to the next.

    By the median of squared third differences, in which even motion and its few corners do not show;
    0 of less than five samples.

    Parameters
    ----------
    path
        (S, C) coordinates in m, evenly sampled.

    Returns
    -------
    float
        m; θ in rad counts likewise.
    """
    if len(path) < 5:
        return 0.0
    rough = np.diff(path, n=3, axis=0)
    return float(np.sqrt(np.median(rough**2) / (_MEDIAN_CHI2 * _THIRD)))


def scatter(path: Floats, least: float = 0.0) -> Floats:
    """What is not smooth from one sample to the next, apart along the two directions that it differs most in.

    A tip is seen much better across its needle than along it. By medians, as `roughness`: the covariance of two
    coordinates is a quarter of the difference between the variances of their sum and difference (Gnanadesikan and
    Kettenring, doi:10.2307/2528963), which gives the directions, and the variances are taken along these.

    Parameters
    ----------
    path
        (S, 2) coordinates in m, evenly sampled.
    least
        Standard deviation in m that is told at least, so that a direction in which nothing scatters stays one.

    Returns
    -------
    Floats
        (2, 2) m; a row is a direction of unit length, times the standard deviation along it.
    """
    x, y = path.T
    spread = [roughness(one[:, None]) ** 2 for one in (x, y, x + y, x - y)]
    turn = 0.5 * math.atan2(0.5 * (spread[2] - spread[3]), spread[0] - spread[1])
    axes = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    size = np.array([[max(roughness(path @ axis[:, None]), least)] for axis in axes])
    return np.asarray(axes * size)


def _chosen(stated: float | None, estimated: float | None) -> tuple[float | None, Source]:
    if stated is not None:
        return stated, "stated"
    return estimated, "unknown" if estimated is None else "estimated"


def _position(noise: Noise) -> float | None:
    if noise.x.sigma is None or noise.y.sigma is None:
        return None
    return float(np.hypot(noise.x.sigma, noise.y.sigma) / np.sqrt(2.0))


@dataclass(frozen=True, slots=True)
class _Run:
    """Still frames of one recording that differ from the one before: (n,) s, (n, 3) m and rad."""

    times: Floats
    poses: Floats


def _runs(recordings: RecordingSet, recording: Recording) -> _Run:
    kept = still(recordings, recording)
    poses = unwrapped(recording).poses
    seen = np.flatnonzero(kept & ~np.any(np.isnan(poses), axis=1))
    new = np.ones(len(seen), dtype=bool)
    new[1:] = np.any(np.diff(poses[seen], axis=0) != 0.0, axis=1)
    return _Run(recording.times[seen[new]], poses[seen[new]])


def _spread(fits: list[_Line], most: int, rate: float) -> Spread:
    """Pool the residuals of one coordinate."""
    freedom = sum(_freedom(fit) for fit in fits)
    if freedom < FEWEST_FREE:
        reason = (
            f"{freedom} degrees of freedom in still frames before the part moves (at most "
            f"{most} in a recording); must be at least {FEWEST_FREE}; let the camera run for a "
            "second before the tip moves"
        )
        return Spread(sigma=None, correlation=None, freedom=max(freedom, 0), reason=reason)
    squares = _squares(fits)
    if squares == 0.0:
        reason = "half of the still frames or more show one value; noise must show; state it"
        return Spread(sigma=None, correlation=None, freedom=freedom, reason=reason)
    correlation = _colour(fits, rate)
    if correlation is not None and correlation > _MOTION:
        reason = (
            f"frames that should be still follow each other (correlation {correlation:.2f}): the "
            "part moves without a tip; let it come to rest, or state the noise in set.toml"
        )
        # motion tells no more of the colour of the noise than of its size
        return Spread(sigma=None, correlation=None, freedom=freedom, reason=reason)
    sigma = float(np.sqrt(squares / freedom))
    return Spread(sigma=sigma, correlation=correlation, freedom=freedom, reason=None)


@dataclass(frozen=True, slots=True)
class _Line:
    """Residuals (n,) about a line and a sway, which of them are kept, and (n, 2 or 4) the basis."""

    times: Floats
    residuals: Floats
    kept: Flags
    basis: Floats


def _fit(run: _Run, axis: int, rate: float | None) -> _Line:
    """Fit a line, and a sway of a rate, by least squares, setting outliers aside."""
    values = run.poses[:, axis] - np.median(run.poses[:, axis])
    columns = swing(run.times, rate)
    residuals = values
    for _ in range(_PASSES):
        scale = _NORMAL * float(np.median(np.abs(residuals)))
        kept = np.abs(residuals) <= max(_CLIP * scale, np.finfo(float).tiny)
        factors, *_ = np.linalg.lstsq(columns[kept], values[kept], rcond=None)
        residuals = values - columns @ factors
    basis = np.zeros(columns.shape)
    basis[kept] = np.linalg.qr(columns[kept])[0]
    return _Line(run.times, residuals, kept, basis)


def _freedom(fit: _Line) -> int:
    return int(np.count_nonzero(fit.kept)) - fit.basis.shape[1]


def _squares(fits: list[_Line]) -> float:
    return sum(float(np.sum(fit.residuals[fit.kept] ** 2)) for fit in fits)


def _colour(fits: list[_Line], rate: float) -> float | None:
    """Correlation of neighbours, less what the fit of a line puts into white noise."""
    squares, products, expected, variance = _squares(fits), 0.0, 0.0, 0.0
    pairs = 0
    for fit in fits:
        near = fit.kept[1:] & fit.kept[:-1] & (np.diff(fit.times) < 1.5 / rate)
        products += float(np.sum((fit.residuals[1:] * fit.residuals[:-1])[near]))
        expected -= float(np.sum(np.sum(fit.basis[1:] * fit.basis[:-1], axis=1)[near]))
        variance += float(_freedom(fit))
        pairs += int(near.sum())
    if pairs < FEWEST_FREE or squares == 0.0:
        return None
    # scaled as if no pair were missing
    return float((products / squares - expected / variance) * variance / pairs)
