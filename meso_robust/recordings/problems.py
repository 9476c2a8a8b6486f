"""Everything that is wrong with the content of a recording set."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from meso_robust.recordings.checks.contacts import contact_problems
from meso_robust.recordings.checks.copies import alike_problems, copy_problems
from meso_robust.recordings.checks.fitting import fitting_problems, noise_known_problems
from meso_robust.recordings.checks.frames import FEW, frame_problems, wraps
from meso_robust.recordings.checks.frozen import (
    frozen_frames,
    frozen_problem,
    zero_frames,
    zero_problem,
)
from meso_robust.recordings.checks.jumps import breaks, outlying_frames, outlying_problem
from meso_robust.recordings.checks.scales import turn_unit_problems, unit_problems
from meso_robust.recordings.checks.sensors import force_problems, noise_problems
from meso_robust.recordings.checks.slips import slip_of, slip_problems
from meso_robust.recordings.checks.view import View, unseen
from meso_robust.recordings.noise import estimated_sensor
from meso_robust.recordings.problem import Problem
from meso_robust.recordings.values import Recording, RecordingSet

FIRST_LINE = 2
"""Line of a file on which the first row of a recording stands as `write_set` lays it out."""


def problems(
    recordings: RecordingSet, lines: Mapping[str, Sequence[int]] | None = None
) -> tuple[Problem, ...]:
    """List what is wrong with a set.

    Each check sees a recording without the poses that the checks before it found to be no
    measurement (zeros, repeats, outliers). Contact is not judged where poses are few,
    units wrong, or the part jumps for good.

    Parameters
    ----------
    recordings
        The set; its form is in order, see `read_loosely` for what is not.
    lines
        Line of each row of each file, as `read_loosely` gives them; as `write_set` lays them out
        if None.

    Returns
    -------
    tuple of Problem
        By file in the order of the set; what concerns all of them, at the end.
    """
    zeros = {one.file: zero_frames(recordings, one) for one in recordings.recordings}
    cleared = replace(
        recordings,
        recordings=tuple(unseen(one, zeros[one.file]) for one in recordings.recordings),
    )
    sensor = estimated_sensor(cleared)
    noise = sensor.noise
    found: list[Problem] = []
    views: list[View] = []
    for original, recording in zip(recordings.recordings, cleared.recordings, strict=True):
        rows = line_numbers(recording, lines)
        found += frame_problems(View(recordings, original, rows, noise))
        view = View(cleared, recording, rows, noise)
        found += zero_problem(view, zeros[recording.file])
        found += _content(view)
        if not any(p.severity == "error" and p.file == recording.file for p in found):
            found += fitting_problems(view, sensor)
        views.append(view)
    if not any(problem.kind == "units" for problem in found):
        slip = slip_of(views)
        found += (
            turn_unit_problems(views, slip)
            or slip_problems(slip)
            or noise_problems(recordings, noise)
        )
    found += noise_known_problems(cleared, sensor)
    found += copy_problems(cleared.recordings)
    found += alike_problems(cleared.recordings)
    return tuple(found)


def line_numbers(recording: Recording, lines: Mapping[str, Sequence[int]] | None) -> Sequence[int]:
    """The line of the file that each row of a recording stands on.

    Parameters
    ----------
    recording
        Its rows count.
    lines
        Lines by file, where a table has told them; None where nobody has.

    Returns
    -------
    sequence of int
        One a row; line 1 holds the names of the columns.
    """
    if lines is None:
        return range(FIRST_LINE, FIRST_LINE + recording.times.size)
    return lines[recording.file]


def _content(view: View) -> list[Problem]:
    """Problems of the poses that are left."""
    frozen = frozen_frames(view)
    found = frozen_problem(view, frozen)
    view = view.without(frozen)
    if view.seen.size < FEW:
        return [*found, *wraps(view)]
    units = unit_problems(view)
    if units:
        return [*found, *wraps(view), *units]
    outliers = outlying_frames(view)
    found += outlying_problem(view, outliers)
    view = view.without(outliers)
    broken = breaks(view)
    found += [*broken, *wraps(view)]
    lost = any(one.severity == "error" for one in broken)
    return found if lost else [*found, *contact_problems(view), *force_problems(view)]
