"""Numbers of ``set.toml`` that the tests without a simulation contradict so clearly that they are mistakes."""

from __future__ import annotations

from meso_robust.recordings.direct.run import DirectTests
from meso_robust.recordings.document import SET_FILE
from meso_robust.recordings.problem import Problem
from meso_robust.recordings.rules import UM
from meso_robust.recordings.values import RecordingSet

_OFF = 0.3  # of the stated radius, beyond which it is a mistake rather than a tip that is worn
_NEAR = 0.15  # within which a radius is the half or the double of another one
_SEEN = 3.0  # times what is left of a gap between tip and face, that the error must be


def misstated(recordings: RecordingSet, direct: DirectTests) -> tuple[Problem, ...]:
    """A radius of the tips that is not that at which they touch, where nothing else would look nearly as well.

    Parameters
    ----------
    recordings
        The set.
    direct
        What the tests say of it.

    Returns
    -------
    tuple of Problem
        At most one, a warning.
    """
    stated = recordings.tip_radius / UM
    for one in direct.findings:
        if one.effect != "tip_radius" or one.alike or stated == 0.0:
            continue
        (excess,) = (of for of in one.estimates if of.key == "excess_um")
        nearest = min(abs(excess.low), abs(excess.high))
        same = excess.low * excess.high > 0.0
        if not same or nearest < max(_OFF * stated, _SEEN * one.after / UM):
            continue
        radius = stated + excess.value
        if radius > 0.0:
            return (_warning(stated, radius),)
    return ()


def _warning(stated: float, radius: float) -> Problem:
    """The warning of radii in um; a half or a double has a reason that comes to mind."""
    advice = f"measure the tip; tip_radius_um = {radius:.3g} would do"
    for factor, given in ((0.5, "the diameter"), (2.0, "half of it")):
        if abs(radius / (factor * stated) - 1.0) < _NEAR:
            advice = f"was {given} given? {advice}"
    return Problem(
        file=SET_FILE,
        kind="tip_radius",
        severity="warning",
        value=f"tips touch the part as if they had a radius of {radius:.3g} um",
        rule=f"{SET_FILE} states a tip radius of {stated:.3g} um",
        advice=advice,
    )
