"""Known wrongs that are put into recordings, and what a diagnosis should then say.

Each changes the numbers of a recording as a laboratory would have got them wrong, by its own formula: neither the
simulator nor the catalogue is used. Poses are never interpolated, so that the camera's noise stays what it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from meso_robust.recordings import Recording, RecordingSet
from meso_robust.types import Floats

LATE, LONGER, TURN, DRIFT = 0.060, 1.02, np.radians(0.5), 0.2e-3
"""s; factor; rad; m in the time of the longest recording."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wrong:
    """A wrong, and the numbers of the catalogue that it adds to those of the set.

    Attributes
    ----------
    words
        What was done.
    change
        Of a set.
    sizes
        ``{effect: {key: value}}`` that tell of it, any of them; a function of the set.
    cause
        Words of the refusal that is right instead of an answer; empty where the set can be used.
    """

    words: str
    change: Callable[[RecordingSet], RecordingSet]
    sizes: Callable[[RecordingSet], Mapping[str, Mapping[str, float]]] = field(default=lambda _: {})
    cause: str = ""


def each(change: Callable[[Recording], Recording]) -> Callable[[RecordingSet], RecordingSet]:
    """The same change of every recording."""
    return lambda found: replace(found, recordings=tuple(map(change, found.recordings)))


def late(by: float) -> Callable[[RecordingSet], RecordingSet]:
    """Frames that come ``by`` s late: beside each stand the tips of that much later.

    Frames whose tips were not logged are left out.
    """

    def change(one: Recording) -> Recording:
        at = one.times + by
        kept = at <= one.times[-1]
        tips = _at(one.times, one.probes, at[kept])
        forces = None if one.forces is None else _at(one.times, one.forces, at[kept])
        return replace(
            one, times=one.times[kept], poses=one.poses[kept], probes=tips, forces=forces
        )

    return each(change)


def _at(times: Floats, values: Floats, at: Floats) -> Floats:
    """Values (T, P, 2) at other times, linear; not seen beside what was not seen."""
    flat = values.reshape(len(times), -1)
    columns = [np.interp(at, times, column) for column in flat.T]
    return np.column_stack(columns).reshape(len(at), *values.shape[1:])


def longer_x(factor: float) -> Callable[[RecordingSet], RecordingSet]:
    """A robot that takes x for longer than it is, about its origin; two fingers stand as far apart as before."""

    def change(one: Recording) -> Recording:
        hand = one.probes.mean(axis=1, keepdims=True)
        return replace(one, probes=one.probes + (factor - 1.0) * hand * (1.0, 0.0))

    return each(change)


def turned(angle: float) -> Callable[[RecordingSet], RecordingSet]:
    """A camera turned about the middle of the places that it shows."""

    def change(found: RecordingSet) -> RecordingSet:
        middle = _middle(found)
        c, s = np.cos(angle), np.sin(angle)

        def one(recording: Recording) -> Recording:
            poses = recording.poses.copy()
            poses[:, :2] = middle + (poses[:, :2] - middle) @ np.array([[c, s], [-s, c]])
            poses[:, 2] += angle
            return replace(recording, poses=poses)

        return each(one)(found)

    return change


def _middle(found: RecordingSet) -> Floats:
    """(2,) m."""
    places = np.concatenate([one.poses[:, :2] for one in found.recordings])
    return np.asarray(0.5 * (np.nanmin(places, axis=0) + np.nanmax(places, axis=0)))


def drifting(by: float) -> Callable[[RecordingSet], RecordingSet]:
    """A camera that drifts along x, evenly, by ``by`` m in the time of the longest recording."""

    def change(found: RecordingSet) -> RecordingSet:
        speed = by / _longest(found)

        def one(recording: Recording) -> Recording:
            poses = recording.poses.copy()
            poses[:, 0] += speed * (recording.times - recording.times[0])
            return replace(recording, poses=poses)

        return each(one)(found)

    return change


def _longest(found: RecordingSet) -> float:
    return max(float(one.times[-1] - one.times[0]) for one in found.recordings)


def mirrored(found: RecordingSet) -> RecordingSet:
    """Tips whose y has the other sign."""
    return each(lambda one: replace(one, probes=one.probes * (1.0, -1.0)))(found)


def mixed(other: RecordingSet) -> Callable[[RecordingSet], RecordingSet]:
    """Every second recording from the same part on another surface, in turns; as many as before."""

    def change(found: RecordingSet) -> RecordingSet:
        foreign = [replace(one, file=f"other_{one.file}") for one in other.recordings]
        mine = list(found.recordings)
        count = min(len(mine), len(foreign)) // 2 * 2
        taken = [(foreign if k % 2 else mine)[k] for k in range(count)]
        return replace(found, recordings=tuple(taken))

    return change


WRONGS: Mapping[str, Wrong] = {
    "nothing": Wrong(words="nothing", change=lambda found: found),
    "late": Wrong(
        words="camera 60 ms later",
        change=late(LATE),
        sizes=lambda _: {"camera_latency": {"time_ms": 1e3 * LATE}},
    ),
    "longer": Wrong(
        words="x of the tips × 1.02",
        change=longer_x(LONGER),
        sizes=lambda _: {"camera_anisotropy": {"x_percent": 100.0 * (1.0 / LONGER - 1.0)}},
    ),
    "turned": Wrong(
        words="camera turned by 0.5°",
        change=turned(TURN),
        sizes=lambda _: {"camera_rotation": {"angle_deg": float(np.degrees(TURN))}},
    ),
    "drift": Wrong(
        words="camera drifts by 0.2 mm along x",
        change=drifting(DRIFT),
        sizes=lambda found: {
            "camera_drift": {"x_um_s": 1e6 * DRIFT / _longest(found)},
            "probe_drift": {"x_um_s": -1e6 * DRIFT / _longest(found)},
        },
    ),
    "mirrored": Wrong(
        words="y of the tips with the other sign",
        change=mirrored,
        cause="y of the tips has the other sign",
    ),
}
"""By a short name; "nothing" is the set as it is."""
