"""Which recording sets may be fitted: what `recordings` finds wrong must be mended first."""

from __future__ import annotations

from meso_robust.errors import InputError
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.problems import problems

_MENDED_FIRST = ("zero_pose", "frozen", "jump")
"""Kinds of warnings about poses that are no measurements; a fit would take them for motion."""


def warnings_of(recordings: RecordingSet) -> tuple[str, ...]:
    """What is to be kept in mind about a set that may be fitted, a line each.

    Raises
    ------
    InputError
        Something about the set makes a fit meaningless.
    """
    found = problems(recordings)
    barring = [p for p in found if p.severity == "error" or p.kind in _MENDED_FIRST]
    if barring:
        more = f" (and {len(barring) - 1} more)" if len(barring) > 1 else ""
        raise InputError(
            f"{barring[0]}{more}; list them with `meso-robust recordings`, which with --repair takes "
            "bad poses as not seen"
        )
    return tuple(str(p) for p in found if p.severity == "warning")
