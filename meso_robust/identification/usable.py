"""What to keep in mind about a recording set that is fitted."""

from __future__ import annotations

from meso_robust.identification.models.model import Model
from meso_robust.identification.sensitivity import StartBox, sensitivities_of_set
from meso_robust.recordings import RecordingSet
from meso_robust.types import Floats

NOISE_IS_FITTED = frozenset({"noise_unknown"})
"""Errors that do not keep a fit from being made which estimates the noise along with the model."""


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
