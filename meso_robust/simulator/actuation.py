"""From commanded to true probe positions: drift, lost motion, and bending under the contact force.

A probe is commanded along straight lines between waypoints. The mount drifts by ``d t``; lost motion
of width b is the play operator ``u ← min(max(u, w − b/2), w + b/2)`` on each axis; a compliant probe
stands at ``u + C f``, f the force on its tip. With forces over the film's drag the compliance is a
time, ``C e_x``: the time in which a bent probe that is stopped creeps back.
"""

from meso_robust.kernels import inner
from meso_robust.simulator.stage import Effect, Parameter, Stage
from meso_robust.types import Floats

_UM = 1e-6

ACTUATION = Stage(
    name="actuation",
    base=64,
    effects=(
        Effect(
            name="probe_compliance",
            equation="tip = driven position + C f, f the force on the tip",
            source="bending of a cantilever, C = L³ / (3 E I)",
            parameters=(
                Parameter(
                    key="time_ms", unit="ms", to_si=1e-3, low=0.0,
                    meaning="C e_x: compliance of the tip times drag of the film",
                ),
            ),
        ),
        Effect(
            name="backlash",
            equation="u ← min(max(u, w − b/2), w + b/2) on each axis",
            source="play operator; M. Brokate, J. Sprekels 1996, doi:10.1007/978-1-4612-4048-8",
            parameters=(
                Parameter(key="width_um", unit="µm", to_si=_UM, low=0.0, meaning="b: lost motion"),
            ),
        ),
        Effect(
            name="probe_drift",
            equation="true position = command + d t",
            source="thermal drift of the mount",
            parameters=(
                Parameter(key="x_um_s", unit="µm/s", to_si=_UM, meaning="d_x"),
                Parameter(key="y_um_s", unit="µm/s", to_si=_UM, meaning="d_y"),
            ),
        ),
    ),
)  # fmt: skip

COMPLIANCE = ACTUATION.slot("probe_compliance", "time_ms")
"""Column of the compliance times drag, s."""
_WIDTH = ACTUATION.slot("backlash", "width_um")
_DRIFT_X = ACTUATION.slot("probe_drift", "x_um_s")
_DRIFT_Y = ACTUATION.slot("probe_drift", "y_um_s")
DRIVE_SLOTS = (_WIDTH, _DRIFT_X, _DRIFT_Y)
"""Columns of effects between the command and the driven position of a probe."""


@inner
def drive(effects: Floats, command: float, played: float) -> float:
    """Position behind the play, on one axis and without drift (see `drifted`).

    Parameters
    ----------
    effects
        (S,) values of the effects.
    command
        Commanded coordinate, m.
    played
        The position behind the play so far, m.
    """
    half = 0.5 * effects[_WIDTH]
    return float(min(max(played, command - half), command + half))


@inner
def drifted(effects: Floats, axis: int, time: float) -> float:
    """Displacement of the mount since the start of the run, m."""
    return float(effects[_DRIFT_X if axis == 0 else _DRIFT_Y] * time)
