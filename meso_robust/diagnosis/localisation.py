"""Where a mismatch is: spans, stages, broken invariances and what it grows with, side by side.

Three ways that share nothing but the recordings: hidden inputs in windows, pushes that should
coincide, and what the slack of the motion follows.

A slack is the twist by which the part moved beyond the model (`windows`). Each of its components is
correlated with each condition that windows were seen in; the largest of all correlations is judged
against the largest that chance makes when the slacks of whole recordings change their signs (Westfall
and Young's max-T), so that neither the number of pairs nor the likeness of windows of one recording
counts for evidence.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.document import Channel, Component
from meso_robust.diagnosis.hidden_inputs import ChannelTotal, left
from meso_robust.diagnosis.invariances import Pair, compared, pairs
from meso_robust.diagnosis.windows import Cut, Window, Windows, tips_of, windowed
from meso_robust.identification.prepared import Prepared
from meso_robust.identification.touching import distances
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.contact import gaps
from meso_robust.types import Floats, Ints

Frame = Literal["stage", "part"]

MOST = 6
"""Most covariates reported."""
_SIGNIFICANT = 0.05
_FLIPS = 2000
_RESTING = 0.1  # of the fastest motion of the tip: rest
_NEAR = 20e-6  # m: gap of a tip that may push
_SLOWEST = 1e-6  # m/s
_SLACKS: tuple[tuple[Component, Frame], ...] = (
    ("x", "stage"),
    ("y", "stage"),
    ("theta", "stage"),
    ("x", "part"),
    ("y", "part"),
)
_COMPONENTS: tuple[Component, ...] = ("x", "y", "theta")
_LISTED = 24  # spans that are listed
_CHANCE = 0.05  # that any of the listed spans is by chance


@dataclass(frozen=True, slots=True, kw_only=True)
class Covariate:
    """A quantity that a component of the slack follows.

    Attributes
    ----------
    component, frame
        Of the slack.
    covariate
        Name; ``constant`` if the slack has a mean of its own.
    correlation
        Weighted with the accuracy of the slacks, −1 … 1; of a constant, mean over root mean square.
    p_value
        Corrected for all pairs.
    """

    component: Component
    frame: Frame
    covariate: str
    correlation: float
    p_value: float


def scanned(windows: Windows, prepared: Prepared, seed: int = 0) -> tuple[Covariate, ...]:
    """Significant covariates of the slacks, the most significant first.

    Parameters
    ----------
    windows
        Of the recordings.
    prepared
        The recordings as prepared for `windowed`.
    seed
        Of the sign changes.
    """
    slack, sigma = components_of(windows)
    names, table = conditions(prepared, windows.cuts)
    recording = np.array([cut.recording for cut in windows.cuts])
    return followed(slack, sigma, names, table, recording, seed)


def followed(
    slack: Floats,
    sigma: Floats,
    names: tuple[str, ...],
    table: Floats,
    recording: Ints,
    seed: int,
) -> tuple[Covariate, ...]:
    """Max-T over slacks (W, 5), σ likewise, and covariates (W, K) of windows of recordings (W,)."""
    known = np.isfinite(sigma) & (sigma > 0.0)
    weight = np.where(known, 1.0 / np.where(known, sigma, 1.0) ** 2, 0.0)
    data = np.where(known, slack, 0.0)
    sums, correlation = [], []
    groups = (recording == np.unique(recording)[:, None]).astype(float)  # (R, W)
    for k in range(data.shape[1]):
        w, s = weight[:, k], data[:, k]
        total = max(float(w.sum()), 1e-300)
        centred = table - (w @ table) / total
        rest = s - (w @ s) / total
        pulls = groups @ (centred * (w * rest)[:, None])
        spread = groups @ (centred**2 * w[:, None])
        pulls = np.column_stack([groups @ (w * s), pulls])
        sums.append(_bounded(pulls, np.column_stack([groups @ w, spread])))
        size = np.sqrt(np.maximum((w @ centred**2) * (w @ rest**2), 1e-300))
        mean = (w @ s) / np.sqrt(max(w.sum() * (w @ s**2), 1e-300))
        correlation.append([mean, *((w * rest) @ centred / size)])
    return _significant(np.stack(sums), np.array(correlation), ("constant", *names), seed)


def _bounded(pulls: Floats, spread: Floats) -> Floats:
    """Each recording's pull (R, K) in standard deviations of noise, bounded by one.

    No single recording can carry a correlation, and none that says nothing dilutes it. A bounded odd
    score changes sign with the slacks, so that chance is judged as before.
    """
    scaled = pulls / np.sqrt(np.where(spread > 0.0, spread, np.inf))
    return np.asarray(scaled / (1.0 + scaled**2) ** 0.25)


def _significant(
    sums: Floats, correlation: Floats, names: tuple[str, ...], seed: int
) -> tuple[Covariate, ...]:
    """Those of (5, R, K) sums by recording that chance does not reach."""
    scale = np.sqrt(np.sum(sums**2, axis=1))
    told = scale > 0.0
    scaled = sums / np.where(told, scale, 1.0)[:, None]  # (5, R, K)
    found = np.abs(scaled.sum(axis=1))
    rng = np.random.default_rng([seed, 2])
    signs = rng.choice([-1.0, 1.0], size=(_FLIPS, sums.shape[1]))
    flat = np.moveaxis(scaled, 1, 0).reshape(sums.shape[1], -1)
    most = np.abs(signs @ flat).max(axis=1)
    p_values = (1.0 + np.sum(most[:, None, None] >= found - 1e-12, axis=0)) / (1.0 + _FLIPS)
    order = np.argsort(-found, axis=None)
    best = [np.unravel_index(k, found.shape) for k in order[:MOST]]
    return tuple(
        Covariate(
            component=_SLACKS[row][0],
            frame=_SLACKS[row][1],
            covariate=names[column],
            correlation=float(correlation[row, column]),
            p_value=float(p_values[row, column]),
        )
        for row, column in best
        if told[row, column] and p_values[row, column] < _SIGNIFICANT
    )


def components_of(windows: Windows) -> tuple[Floats, Floats]:
    """(W, 5) slacks and their σ: x, y, θ in the stage's frame, x, y in the part's; m/s and rad/s."""
    slack, sigma = windows.found.slack, windows.found.slack_sigma
    cos, sin = np.cos(windows.poses[:, 2]), np.sin(windows.poses[:, 2])
    turned = [cos * slack[:, 0] + sin * slack[:, 1], cos * slack[:, 1] - sin * slack[:, 0]]
    spread = [
        np.hypot(cos * sigma[:, 0], sin * sigma[:, 1]),
        np.hypot(sin * sigma[:, 0], cos * sigma[:, 1]),
    ]
    return np.column_stack([slack, *turned]), np.column_stack([sigma, *spread])


def conditions(prepared: Prepared, cuts: tuple[Cut, ...]) -> tuple[tuple[str, ...], Floats]:
    """Names and values (W, K) of the covariates of windows, without those that never differ."""
    tips = tips_of(prepared)
    rows = [_condition(prepared, tips, cut) for cut in cuts]
    names = tuple(dict.fromkeys(name for row in rows for name in row))
    table = np.array([[row.get(name, 0.0) for name in names] for row in rows])
    differs = np.ptp(table, axis=0) > 1e-9
    return tuple(name for name, does in zip(names, differs, strict=True) if does), table[:, differs]


def _condition(prepared: Prepared, tips: Floats, cut: Cut) -> dict[str, float]:
    """Values by name; of a name that is left out, zero."""
    r, middle = cut.recording, (cut.first + cut.last) // 2
    frames = slice(cut.first, cut.last)
    seen = prepared.seen[r, frames]
    x, y, heading = np.nanmean(seen, axis=0)
    clock, way = prepared.instants[r], tips[r]
    radius = max(shape.radius for shape in prepared.shapes)
    each = gaps(prepared.outline, np.array([[x, y, heading]]), way[[middle]], radius)[0]
    tip = int(np.argmin(each))
    steps = np.diff(way[: cut.last, tip], axis=0)
    pace = np.hypot(*steps.T) / np.diff(clock[: cut.last])
    here = pace[max(cut.first - 1, 0) :]
    velocity = (way[cut.last - 1, tip] - way[cut.first, tip]) / (
        clock[cut.last - 1] - clock[cut.first]
    )
    cos, sin = np.cos(heading), np.sin(heading)
    arm = float(_arm(prepared, way[middle, tip] - [x, y], heading) if each[tip] < _NEAR else 0.0)
    speed = float(np.median(here)) if len(here) else 0.0
    moving = np.flatnonzero(pace > _RESTING * pace.max(initial=0.0))
    turns = 1 + moving[:-1][np.sum(steps[moving[1:]] * steps[moving[:-1]], axis=1) < 0.0]
    since = clock[turns[-1]] if len(turns) else clock[0]
    return {
        "time": float(clock[middle]),
        "rest before": _rest_before(clock, pace, cut.first),
        "x": float(x),
        "y": float(y),
        "sin heading": float(np.sin(heading)),
        "cos heading": float(np.cos(heading)),
        "sin 2 heading": float(np.sin(2.0 * heading)),
        "cos 2 heading": float(np.cos(2.0 * heading)),
        "speed": speed,
        "tip velocity x (stage)": float(velocity[0]),
        "tip velocity y (stage)": float(velocity[1]),
        "tip velocity x (part)": float(cos * velocity[0] + sin * velocity[1]),
        "tip velocity y (part)": float(cos * velocity[1] - sin * velocity[0]),
        "lever arm": arm,
        "lever arm × speed": arm * speed,
        "lever arm / speed": arm / max(speed, _SLOWEST),
        "gap": float(np.clip(each[tip], 0.0, prepared.length)),
        "time since reversal": float(clock[middle] - since),
        f"edge {_edge(prepared, way[middle, tip], np.array([x, y, heading]))}": 1.0,
        f"tip {tip + 1}": 1.0,
        cut.phase: 1.0,
    }


def _rest_before(clock: Floats, pace: Floats, first: int) -> float:
    """Length in s of the last rest of the tip that began before a frame."""
    resting = pace[:first] <= _RESTING * pace.max(initial=0.0)
    if not np.any(resting):
        return 0.0
    last = int(np.flatnonzero(resting)[-1])
    moving = np.flatnonzero(~resting[: last + 1])
    begin = int(moving[-1]) + 1 if len(moving) else 0
    return float(clock[last + 1] - clock[begin])


def _arm(prepared: Prepared, away: Floats, heading: float) -> float:
    """Arm in m of an inward push by a tip (2,) about the reference point, counter-clockwise."""
    cos, sin = np.cos(heading), np.sin(heading)
    own = np.array([[cos * away[0] + sin * away[1], cos * away[1] - sin * away[0]]])
    out = distances(prepared.outline[None], own)[1][0]
    return float(own[0, 1] * out[0] - own[0, 0] * out[1])


def _edge(prepared: Prepared, tip: Floats, pose: Floats) -> int:
    """Index of the side of the outline next to a tip (2,)."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    away = tip - pose[:2]
    own = np.array([cos * away[0] + sin * away[1], cos * away[1] - sin * away[0]])
    sides = np.roll(prepared.outline, -1, axis=0) - prepared.outline
    offset = own - prepared.outline
    share = np.clip(np.sum(offset * sides, axis=1) / np.sum(sides**2, axis=1), 0.0, 1.0)
    return int(np.argmin(np.hypot(*(offset - share[:, None] * sides).T)))


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
    reach
        σ per degree of freedom that free hidden inputs leave of the windows; None of no datum.
    """

    places: tuple[Place, ...]
    channels: tuple[ChannelTotal, ...]
    covariates: tuple[Covariate, ...]
    pairs: tuple[Pair, ...]
    reach: float | None


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
        reach=left(found.found),
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
