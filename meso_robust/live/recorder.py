"""A journal as a recording set, one recording a move, ready to identify and diagnose from."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from meso_robust.live.conductor import Phase
from meso_robust.live.journal import Header, Turn
from meso_robust.live.placing import tip_places
from meso_robust.recordings import Polygon, Recording, RecordingSet, Rectangle, SensorInfo
from meso_robust.recordings.rules import DEG, UM
from meso_robust.types import Floats

KEPT = (Phase.CHECKING.value, Phase.PUSHING.value, Phase.RAISING.value)
"""Phases in which tips are in the plane."""
_CLOCK = 9  # decimals of a second


def recordings_of(
    header: Header,
    turns: Sequence[Turn],
    part: Rectangle | Polygon,
    names: Sequence[str] = (),
) -> RecordingSet | None:
    """The pushes of a run.

    Parameters
    ----------
    header, turns
        Of its journal.
    part
        What was pushed.
    names
        Files of the recordings, in their order; left out: ``move_01.csv`` and so on.

    Returns
    -------
    RecordingSet or None
        None if nothing was pushed. Rows have the instants of the frames; places of the tips are interpolated
        between those at which the manipulators were asked.
    """
    recordings = [
        _recording(header, push, names[k] if k < len(names) else f"move_{k + 1:02d}.csv")
        for k, push in enumerate(_pushes(turns))
    ]
    if not recordings:
        return None
    stamps = sorted(turn.reading.seen.time for turn in turns if turn.reading.seen is not None)
    gaps = np.diff(stamps)
    radii = [tip.radius_um for one in header.lab.manipulators for tip in one.tips]
    return RecordingSet(
        part=part,
        tip_radius=radii[0] * UM,
        position_source="controller",
        # the tracker's deviations hold what is the same in all frames: the scatter is left to be estimated
        sensor=SensorInfo(frame_rate=1.0 / float(np.median(gaps)) if len(gaps) else 30.0),
        recordings=tuple(recordings),
    )


def _pushes(turns: Sequence[Turn]) -> Iterator[list[Turn]]:
    """Turns of each push, from when its tips are down until they are lifted again."""
    push: list[Turn] = []
    for turn in turns:
        if turn.phase in KEPT:
            push.append(turn)
        elif push:
            yield push
            push = []
    if push:
        yield push


def _recording(header: Header, push: Sequence[Turn], file: str) -> Recording:
    down = _lowered(header, push[0])
    names = [tip.name for one in header.lab.manipulators if one.name in down for tip in one.tips]
    frames = {
        round(t.reading.seen.time, _CLOCK): t.reading.seen.sight.pose
        for t in push
        if t.reading.seen is not None
    }
    asked: dict[float, Floats] = {}
    for turn in push:
        places = _tips(header, turn, down)
        if places is not None:
            asked[round(turn.reading.time, _CLOCK)] = np.array([places[name] for name in names])
    # a frame is exposed before the manipulators are asked: between two answers they went straight
    first, last = min(asked, default=math.inf), max(asked, default=-math.inf)
    times = np.array([time for time in sorted(frames) if first <= time <= last])
    poses = np.full((len(times), 3), math.nan)
    for k, time in enumerate(times.tolist()):
        pose = frames[time]
        if pose is not None:
            poses[k] = pose[0] * UM, pose[1] * UM, pose[2] * DEG
    instants = np.array(sorted(asked))
    answers = np.array([asked[time] for time in instants.tolist()]).reshape(-1, len(names), 2)
    tips = np.empty((len(times), len(names), 2))
    for k, axis in np.ndindex(len(names), 2):
        tips[:, k, axis] = np.interp(times, instants, answers[:, k, axis]) * UM
    return Recording(
        file=file,
        probe_names=tuple(names),
        times=times - times[:1],
        poses=poses,
        probes=tips,
    )


def _lowered(header: Header, turn: Turn) -> set[str]:
    """Manipulators that are in the plane."""
    return {
        one.name
        for one in header.lab.manipulators
        if abs(turn.reading.places[one.name].height_um - one.lowered_um) <= one.height_error_um
    }


def _tips(header: Header, turn: Turn, down: set[str]) -> dict[str, Floats] | None:
    """Where the tips are; None once they are lifted."""
    if not down <= set(turn.reading.places) or not down <= _lowered(header, turn):
        return None
    found: dict[str, Floats] = {}
    for one in header.lab.manipulators:
        if one.name in down:
            place = turn.reading.places[one.name]
            found |= tip_places(one, (place.x_um, place.y_um))
    return found
