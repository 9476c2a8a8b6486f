"""What to keep in mind about a recording set that is fitted, and what must be mended first."""

from __future__ import annotations

from meso_robust.errors import InputError
from meso_robust.identification.models.model import Floats, Model
from meso_robust.identification.sensitivity import StartBox, sensitivities_of_set
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


def pathological_of(recordings: RecordingSet, model: Model, values: Floats) -> tuple[str, ...]:
    """Recordings whose start is pathological within the paper's 5 µm and 0.005°, a line each.

    Parameters
    ----------
    recordings
        That were fitted.
    model, values
        The fitted model, and its (n,) parameters in SI.
    """
    return tuple(
        f"{one.name}: pathological start ({', '.join(one.reasons)}): its motion says more of the "
        "start than of the part"
        for one in sensitivities_of_set(recordings, model, values, StartBox())
        if one.pathological
    )
