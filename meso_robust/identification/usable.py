"""What to keep in mind about a recording set that is fitted, and what must be fixed first."""

from __future__ import annotations

from meso_robust.errors import InputError
from meso_robust.identification.models.model import Model
from meso_robust.identification.sensitivity import StartBox, sensitivities_of_set
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.problems import problems
from meso_robust.types import Floats

NOISE_IS_FITTED = frozenset({"noise_unknown"})
"""Errors that do not keep a fit from being made which estimates the noise along with the model."""


def warnings_of(recordings: RecordingSet, allowed: frozenset[str] = frozenset()) -> tuple[str, ...]:
    """What is to be kept in mind about a set that may be fitted, a line each.

    The judgement is that of `problems`: what ``recordings`` calls usable is not refused here.

    Parameters
    ----------
    recordings
        That are to be fitted.
    allowed
        Kinds of errors that the fit can do with.

    Returns
    -------
    tuple of str
        Warnings; mere information is left out.

    Raises
    ------
    InputError
        Something about the set makes a fit meaningless.
    """
    found = problems(recordings)
    barring = [p for p in found if p.severity == "error" and p.kind not in allowed]
    if barring:
        more = f" (and {len(barring) - 1} more)" if len(barring) > 1 else ""
        raise InputError(
            f"{barring[0]}{more}; list them with `meso-robust recordings`, which with --repair marks "
            "bad poses as not seen"
        )
    return tuple(str(p) for p in found if p.severity != "information")


def pathological_of(recordings: RecordingSet, model: Model, values: Floats) -> tuple[str, ...]:
    """Recordings whose start is pathological within the paper's 5 µm and 0.005°, a line each.

    Parameters
    ----------
    recordings
        That were fitted.
    model, values
        The fitted model, and its (n,) parameters in SI.

    Returns
    -------
    tuple of str
        None of a set without such a start.
    """
    return tuple(
        f"{one.name}: pathological start ({', '.join(one.reasons)}): its motion says more of the "
        "start than of the part"
        for one in sensitivities_of_set(recordings, model, values, StartBox())
        if one.pathological
    )
