"""Noise of the sensor as the tests of a diagnosis need it: deviations and colour, model or no model.

Deviations that are not stated come from still frames. Without any, third differences of the poses,
in which smooth motion does not show, tell the white part of the noise: the floor that a model could
reach. The fit then weighs x, y and θ by its own residuals, as no other scale is known.

What a stated deviation has beyond the scatter of still frames stays from frame to frame: it is noise of
neighbours that are alike, not white noise of that size, of which a mean over many frames would tell much.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from meso_robust.errors import InputError
from meso_robust.recordings import RecordingSet, unwrapped
from meso_robust.recordings.noise import Spread, estimated_noise, roughness
from meso_robust.recordings.sway import Sway
from meso_robust.types import Floats

_ROUGHNESS = "roughness of the poses"
_SURE = 3.0  # standard errors of the scatter by which it must be below σ for the rest to stay
_MOST = 0.9  # correlation of neighbours beyond which "noise" is motion


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Noise:
    """Gaussian noise of the sensor, an autoregression of first order.

    Attributes
    ----------
    sigma
        (3,) standard deviations of x and y in m, and of θ in rad.
    correlation
        φ, correlation of neighbouring frames, 0 … 0.9.
    freedom
        Degrees of freedom of the estimates; infinite where σ was stated.
    correlation_error
        Standard error of φ.
    source
        Where σ is from.
    known
        Whether σ is stated or seen in still frames; otherwise it is the floor only.
    floor
        What is left where there is only noise, in σ: repeatability and systematic error together.
    repeatability
        What the scatter from frame to frame leaves, in σ; None where nothing tells it.
    stays
        (3,) of σ, what surely is no scatter from frame to frame: an error of all frames alike, m and rad.
    sway
        How the part is seen to move to and fro at rest, which is no noise; None where it is not.
    """

    sigma: Floats
    correlation: float
    freedom: float
    correlation_error: float
    source: str
    known: bool = True
    floor: float = 1.0
    repeatability: float | None = None
    stays: Floats = field(default_factory=lambda: np.zeros(3))
    sway: Sway | None = None

    @property
    def swaying(self) -> float:
        """Mean square of the sway over the noise, of x, y and θ alike; zero where there is none."""
        if self.sway is None:
            return 0.0
        return float(np.mean((self.sway.size / (self.sigma * self.floor)) ** 2))


def noise_of(recordings: RecordingSet) -> Noise:
    """Noise of a recording set.

    Raises
    ------
    InputError
        If no deviation is stated and the poses show none.
    """
    found = estimated_noise(recordings)
    correlation, error = _correlation((found.x, found.y, found.theta))
    position, orientation = recordings.sensor.position_sigma, recordings.sensor.orientation_sigma
    sources, freedom = ["stated"] * 2, np.inf
    if not position:
        position, sources[0] = _position(recordings, found.x, found.y, correlation)
        freedom = float(found.x.freedom or np.inf)
    if not orientation:
        orientation, sources[1] = _orientation(recordings, found.theta, correlation)
        freedom = min(freedom, float(found.theta.freedom or np.inf))
    if not (position > 0.0 and orientation > 0.0):
        raise InputError(
            "set.toml: sensor: no noise is stated and half of the poses repeat exactly; must be "
            "known to distinguish misfit from noise; state position_sigma_um and orientation_sigma_deg"
        )
    sigma = np.array([position, position, orientation])
    still = (found.x.sigma, found.y.sigma, found.theta.sigma)
    shares = _staying((found.x, found.y, found.theta), sigma)
    share = float(np.mean(shares[np.isfinite(shares)])) if np.any(np.isfinite(shares)) else 0.0
    correlation = min((1.0 - share) * correlation + share, _MOST)
    return Noise(
        sigma=sigma,
        repeatability=_repeatability(still, sigma),
        correlation=correlation,
        freedom=freedom,
        correlation_error=error,
        source=sources[0] if sources[0] == sources[1] else f"{sources[0]}, θ {sources[1]}",
        known=_ROUGHNESS not in sources,
        stays=sigma * np.sqrt(np.nan_to_num(shares)),
        sway=_beyond(found.sway, recordings.sensor.position_sigma),
    )


def _beyond(sway: Sway | None, stated: float | None) -> Sway | None:
    """A sway, unless it is smaller than the stated noise: a tracker errs as much, and slowly."""
    return sway if sway is None or sway.metres > (stated or 0.0) else None


def with_noise(recordings: RecordingSet, noise: Noise) -> RecordingSet:
    """The recordings with the noise stated, if it is known."""
    if not noise.known:
        return recordings
    sensor = replace(
        recordings.sensor,
        position_sigma=float(noise.sigma[0]),
        orientation_sigma=float(noise.sigma[2]),
    )
    return replace(recordings, sensor=sensor)


def weighed(noise: Noise, sigma: Floats) -> Noise:
    """The noise as a fit has weighed it by σ (3,); what was measured stays as the floor."""
    if np.allclose(sigma, noise.sigma, rtol=1e-6):
        return noise
    floor = float(np.sqrt(np.mean((noise.sigma / sigma) ** 2)))
    return replace(
        noise, sigma=sigma, floor=floor, repeatability=floor, source="residuals of the fit"
    )


def _repeatability(still: tuple[float | None, ...], sigma: Floats) -> float | None:
    """Root mean square over the coordinates of what still frames show over σ."""
    known = [value for value in still if value is not None]
    if len(known) < len(still):
        return None
    return float(np.sqrt(np.mean((np.array(known) / sigma) ** 2)))


def _correlation(spreads: tuple[Spread, ...]) -> tuple[float, float]:
    """φ and its standard error; the latter is what white noise would have where nothing is known."""
    known = [(s.correlation, s.freedom) for s in spreads if s.correlation is not None]
    if not known:
        return 0.0, 0.1
    weight = np.array([freedom for _, freedom in known], dtype=float)
    mean = float(np.sum(weight * [value for value, _ in known]) / weight.sum())
    return float(np.clip(mean, 0.0, _MOST)), float(1.0 / np.sqrt(weight.sum()))


def _staying(spreads: tuple[Spread, ...], sigma: Floats) -> Floats:
    """(3,) shares of the variances σ² (3,) that are surely no scatter from frame to frame; NaN where it is unknown."""
    scatter = [
        np.nan if one.sigma is None else one.sigma * (1.0 + _SURE / np.sqrt(2.0 * one.freedom))
        for one, whole in zip(spreads, sigma, strict=True)
    ]
    return np.maximum(1.0 - (np.array(scatter) / sigma) ** 2, 0.0)


def _position(
    recordings: RecordingSet, x: Spread, y: Spread, correlation: float
) -> tuple[float, str]:
    if x.sigma is not None and y.sigma is not None:
        return float(np.hypot(x.sigma, y.sigma) / np.sqrt(2.0)), "still frames"
    return _rough(recordings, slice(0, 2), correlation), _ROUGHNESS


def _orientation(recordings: RecordingSet, theta: Spread, correlation: float) -> tuple[float, str]:
    if theta.sigma is not None:
        return theta.sigma, "still frames"
    return _rough(recordings, slice(2, 3), correlation), _ROUGHNESS


def _rough(recordings: RecordingSet, columns: slice, correlation: float) -> float:
    """σ from third differences, freed of what colour takes out of them."""
    squares = []
    for recording in recordings.recordings:
        poses = unwrapped(recording).poses[:, columns]
        squares.append(roughness(poses[np.all(np.isfinite(poses), axis=1)]) ** 2)
    share = np.polyval([-2.0, 12.0, -30.0, 20.0], correlation) / 20.0
    return float(np.sqrt(np.mean(squares) / share))
