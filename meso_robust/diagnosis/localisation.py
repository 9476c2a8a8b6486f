"""Where a mismatch is: spans, stages, broken invariances and what it grows with, side by side.

Three ways that share nothing but the recordings: hidden inputs in windows, pushes that should
coincide, and what the slack of the motion follows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.covariates import Covariate, scanned
from meso_robust.diagnosis.document import Channel, Component
from meso_robust.diagnosis.hidden_inputs import ChannelTotal
from meso_robust.diagnosis.invariances import Pair, compared, pairs
from meso_robust.diagnosis.windows import Window, Windows, windowed
from meso_robust.recordings import RecordingSet
from meso_robust.types import Floats

_COMPONENTS: tuple[Component, ...] = ("x", "y", "theta")
_LISTED = 24  # spans that are listed
_CHANCE = 0.05  # that any of the listed spans is by chance


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A span of a recording in which the plain model fails."""

    recording: str
    start_s: float
    end_s: float
    phase: str
    channel: Channel
    component: Component
    sigma: float
    grows_with: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Located:
    """Where the mismatch is.

    Attributes
    ----------
    places
        The worst first.
    channels
        By stage, the one that explains most first.
    covariates
        What the slack follows.
    pairs
        Invariances, the most broken first.
    """

    places: tuple[Place, ...]
    channels: tuple[ChannelTotal, ...]
    covariates: tuple[Covariate, ...]
    pairs: tuple[Pair, ...]


def located(training: RecordingSet, baseline: Baseline, seed: int) -> Located:
    """Look for the mismatch of a fitted model in its recordings."""
    noise = baseline.noise
    found = windowed(
        training,
        baseline.model,
        baseline.fits.values[0],
        noise.sigma,
        noise.correlation,
        prepared=baseline.prepared,
    )
    follows = scanned(found, baseline.prepared, seed)
    own = pairs(baseline.prepared, noise.sigma, noise.correlation)
    return Located(
        places=_places(found, baseline, follows),
        channels=tuple(sorted(found.totals(), key=lambda one: -one.share)),
        covariates=follows,
        pairs=tuple(sorted(own, key=lambda one: -one.sigma)),
    )


def predicted_pairs(baseline: Baseline, found: tuple[Pair, ...], poses: Floats) -> tuple[Pair, ...]:
    """The same pairs as a model has them, which predicts poses (R, T, 3) of the recordings."""
    noise = baseline.noise
    return compared(baseline.prepared, found, poses, noise.sigma, noise.correlation)


def _places(
    found: Windows, baseline: Baseline, follows: tuple[Covariate, ...]
) -> tuple[Place, ...]:
    """Windows whose misfit is beyond chance, all windows considered."""
    windows = found.windows
    least = _threshold(len(windows))
    files = baseline.prepared.files
    worst = sorted((one for one in windows if one.sigma > least), key=lambda one: -one.sigma)
    return tuple(_place(one, files, follows) for one in worst[:_LISTED])


def _threshold(count: int) -> float:
    """σ that the largest of some normal numbers exceeds by chance in one of twenty sets."""
    from scipy.stats import norm

    return float(norm.isf(_CHANCE / max(count, 1)))


def _place(one: Window, files: tuple[str, ...], follows: tuple[Covariate, ...]) -> Place:
    component = _COMPONENTS[int(np.argmax(np.abs(one.components)))]
    grows = next((c.covariate for c in follows if c.component == component), "")
    return Place(
        recording=files[one.recording],
        start_s=one.start_s,
        end_s=one.end_s,
        phase=one.phase,
        channel=one.channel,
        component=component,
        sigma=one.sigma,
        grows_with=grows,
    )
