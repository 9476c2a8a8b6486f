"""A journal as a recording set, one recording a move, ready to identify and diagnose from."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from meso_robust.identification.paths import with_corners
from meso_robust.identification.prepared import CORNER
from meso_robust.live.conductor import Phase
from meso_robust.live.journal import Header, Turn
from meso_robust.live.placing import tip_places
from meso_robust.recordings import Polygon, Recording, RecordingSet, Rectangle, SensorInfo
from meso_robust.recordings.rules import DEG, UM
from meso_robust.types import Floats

KEPT = tuple(
    one.value
    for one in (Phase.CHECKING, Phase.PUSHING, Phase.RESTING, Phase.WITHDRAWING, Phase.RAISING)
)
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
    position, orientation = _seen_sigmas(turns)
    return RecordingSet(
        part=part,
        tip_radius=radii[0] * UM,
        position_source="controller",
        sensor=SensorInfo(
            frame_rate=1.0 / float(np.median(gaps)) if len(gaps) else 30.0,
            position_sigma=position,
            orientation_sigma=orientation,
            tip_offset=max(_offset(header, one) for one in recordings),
        ),
        recordings=tuple(recordings),
    )


def _seen_sigmas(turns: Sequence[Turn]) -> tuple[float | None, float | None]:
    """Root mean squares of the tracker's standard deviations: scatter and what stays, m and rad."""
    sights = [turn.reading.seen.sight for turn in turns if turn.reading.seen is not None]
    told = [one.sigma for one in sights if one.pose is not None and one.sigma is not None]
    if not told:
        return None, None
    squares = np.mean(np.square(told), axis=0)
    return float(np.sqrt(np.mean(squares[:2]))) * UM, float(np.sqrt(squares[2])) * DEG


def _offset(header: Header, recording: Recording) -> float:
    """Standard deviation of where a tip is, by what the laboratory states of its manipulators, m.

    What is stated are largest errors; anything within them is taken to be as likely.
    """
    travel = float(np.hypot(*np.ptp(recording.probes, axis=0).T).max())
    used = [
        one
        for one in header.lab.manipulators
        if {tip.name for tip in one.tips} & set(recording.probe_names)
    ]
    largest = [
        math.hypot(
            one.tip_error_um * UM,
            one.direction_error_deg * DEG * travel,
            0.01 * one.scale_error_percent * travel,
        )
        for one in used
    ]
    return max(largest) / math.sqrt(3.0)


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
    answers = np.array([asked[time] for time in instants.tolist()]).reshape(-1, 2 * len(names)) * UM
    # they turned and stopped between two answers, and were farther out than at either
    instants, answers = with_corners(instants, answers, CORNER)
    tips = np.stack([np.interp(times, instants, column) for column in answers.T], axis=-1)
    return Recording(
        file=file,
        probe_names=tuple(names),
        times=times - times[:1],
        poses=poses,
        probes=tips.reshape(-1, len(names), 2),
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
