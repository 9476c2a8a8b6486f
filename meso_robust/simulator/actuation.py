"""From commanded to true probe positions: delay, creep, drift, lost motion, and bending under the contact force.

A probe is commanded along straight lines between waypoints. A piezoelectric drive goes most of a way at once and creeps
the rest of it, which decays with time. The mount drifts by ``d t``; lost motion
of width b is the play operator ``u ← min(max(u, w − b/2), w + b/2)`` on each axis, or on one; a screw that turns
out of true moves the mount back and forth by a wave in the place of its axis; a compliant probe
stands at ``u + C f``, f the force on its tip. With forces over the film's drag the compliance is a
time, ``C e_x``: the time in which a bent probe that is stopped creeps back. A blade bends across its
flat side only, so that C has one direction, and a wire less along its bend than across.
"""

import numpy as np

from meso_robust.kernels import sealed
from meso_robust.simulator.stage import FORM, Effect, Parameter, Stage, waves
from meso_robust.types import Floats

_UM, _DEG = 1e-6, np.pi / 180.0

ACTUATION = Stage(
    name="actuation",
    base=84,
    slots=20,
    effects=(
        Effect(
            name="probe_compliance",
            equation="tip = driven position + C f, f the force on the tip",
            source="bending of a cantilever, C = L³ / (3 E I)",
            forms=(
                "bends alike in all directions", "bends along one direction of the stage",
                "bends less across one direction of the stage",
            ),
            parameters=(
                Parameter(
                    key="time_ms", unit="ms", to_si=1e-3, low=0.0,
                    meaning="C e_x: compliance of the tip times drag of the film",
                ),
                Parameter(
                    key="direction_deg", unit="deg", to_si=_DEG, size=False,
                    meaning="of a probe that bends along one direction, or most along it: that one, stage frame",
                ),
                Parameter(
                    key="across", unit="", to_si=1.0, low=0.0, high=1.0, size=False,
                    meaning="of a probe that bends less across: its compliance there over that along",
                ),
            ),
        ),
        Effect(
            name="backlash",
            equation="u ← min(max(u, w − b/2), w + b/2) on each axis",
            source="play operator; M. Brokate, J. Sprekels 1996, doi:10.1007/978-1-4612-4048-8",
            forms=(
                "on each axis by itself", "within a circle of the diameter b", "on the x axis alone",
                "on the y axis alone",
            ),
            parameters=(
                Parameter(key="width_um", unit="µm", to_si=_UM, low=0.0, meaning="b: lost motion"),
            ),
        ),
        Effect(
            name="probe_drift",
            equation="true position = command + d t",
            source="thermal drift of the mount; creep of piezoelectric drives",
            forms=("steady", "slows down as d t₀ ln(1 + t/t₀)"),
            parameters=(
                Parameter(key="x_um_s", unit="µm/s", to_si=_UM, meaning="d_x"),
                Parameter(key="y_um_s", unit="µm/s", to_si=_UM, meaning="d_y"),
                Parameter(
                    key="time_s", unit="s", to_si=1.0, default=1.0, low=1e-2, high=1e3, size=False,
                    meaning="t₀: of a drift that slows down, time in which it halves its speed",
                ),
            ),
        ),
        Effect(
            name="tip_latency",
            equation="true w(t) = w(t − τ), of one tip",
            source="a controller of its own for each manipulator",
            forms=("the first tip", "the second tip"),
            parameters=(
                Parameter(
                    key="time_ms", unit="ms", to_si=1e-3, low=0.0, high=1.0,
                    meaning="τ: by how much the tip comes later than its log says",
                ),
            ),
        ),
        Effect(
            name="probe_creep",
            equation="true w = command − c (command − z), z' = (command − z)/τ",
            source="piezoelectric drives without feedback; S. Devasia et al. 2007, doi:10.1109/TCST.2007.903345",
            parameters=(
                Parameter(
                    key="percent", unit="%", to_si=0.01, low=0.0, high=0.9,
                    meaning="c: share of every way that comes later",
                ),
                Parameter(
                    key="fade_s", unit="s", to_si=1.0, default=1.0, low=1e-2, high=1e3, size=False,
                    meaning="τ: time in which what is left of it falls to 1/e",
                ),
            ),
        ),
        Effect(
            name="leadscrew_error",
            equation="true w = w + s sin(2π w/p) + c cos(2π w/p) on each axis w of the mount",
            source="once a turn of a lead screw; A. H. Slocum, Precision Machine Design, 1992",
            forms=("tips that move alike are of one mount", "every tip has a mount of its own"),
            parameters=(
                *waves(),
                Parameter(
                    key="period_um", unit="µm", to_si=_UM, default=500.0 * _UM, low=0.1 * _UM, size=False,
                    meaning="p: travel of one turn of the screw",
                ),
            ),
        ),
    ),
)  # fmt: skip

COMPLIANCE = ACTUATION.slot("probe_compliance", "time_ms")
"""Column of the compliance times drag, s."""
_BENT_WAY = ACTUATION.slot("probe_compliance", "direction_deg")
_ACROSS = ACTUATION.slot("probe_compliance", "across")
_BENT_FORM = ACTUATION.slot("probe_compliance", FORM)
_WIDTH = ACTUATION.slot("backlash", "width_um")
_PLAY_FORM = ACTUATION.slot("backlash", FORM)
_DRIFT_X = ACTUATION.slot("probe_drift", "x_um_s")
_DRIFT_Y = ACTUATION.slot("probe_drift", "y_um_s")
_DRIFT_TIME = ACTUATION.slot("probe_drift", "time_s")
_DRIFT_FORM = ACTUATION.slot("probe_drift", FORM)
_SCREW = ACTUATION.slot("leadscrew_error", "x_sine_um")
_SCREW_PERIOD = ACTUATION.slot("leadscrew_error", "period_um")
_SCREW_FORM = ACTUATION.slot("leadscrew_error", FORM)
_LATE = ACTUATION.slot("tip_latency", "time_ms")
_LATE_FORM = ACTUATION.slot("tip_latency", FORM)
_CREEP = ACTUATION.slot("probe_creep", "percent")
_CREEP_TIME = ACTUATION.slot("probe_creep", "fade_s")
DRIVE_SLOTS = (
    _LATE,
    _CREEP,
    _WIDTH,
    _DRIFT_X,
    _DRIFT_Y,
    _SCREW,
    _SCREW + 1,
    _SCREW + 2,
    _SCREW + 3,
)
"""Columns of effects between the command and the driven position of a probe."""
_APART = 2e-6  # m, up to which tips of one mount are logged as moving otherwise


@sealed
def bending(effects: Floats, cos: float, sin: float) -> tuple[float, float, float]:
    """Compliance of a probe as a symmetric matrix, by rows, in a frame turned by an angle; s."""
    c = effects[COMPLIANCE]
    if effects[_BENT_FORM] == 0.0:
        return c, 0.0, c
    across = effects[_ACROSS] if effects[_BENT_FORM] == 2.0 else 0.0
    wx, wy = np.cos(effects[_BENT_WAY]), np.sin(effects[_BENT_WAY])
    x, y, less = cos * wx + sin * wy, cos * wy - sin * wx, c * (1.0 - across)
    return c * across + less * x * x, less * x * y, c * across + less * y * y


@sealed
def drive(effects: Floats, x: float, y: float, played: Floats) -> None:
    """Follow a command with the play, without drift (see `drifted`).

    Parameters
    ----------
    effects
        (S,) values of the effects.
    x, y
        The command, m.
    played
        (2,) the position behind the play so far, m; receives the new one.
    """
    half, form = 0.5 * effects[_WIDTH], effects[_PLAY_FORM]
    if form != 1.0:
        played[0] = x if form == 3.0 else min(max(played[0], x - half), x + half)
        played[1] = y if form == 2.0 else min(max(played[1], y - half), y + half)
        return
    behind = np.hypot(played[0] - x, played[1] - y)
    if behind > half:
        played[0] = x + half / behind * (played[0] - x)
        played[1] = y + half / behind * (played[1] - y)


@sealed
def lateness(effects: Floats, probe: int) -> float:
    """By how much a tip comes later than commanded, s."""
    return float(effects[_LATE]) if effects[_LATE_FORM] == probe else 0.0


@sealed
def crept(effects: Floats, command: float, before: Floats, dt: float) -> float:
    """Where a drive that creeps is along an axis, m.

    Parameters
    ----------
    effects
        (S,) values of the effects.
    command
        Along the axis at the end of a step, m; it changes evenly during the step.
    before
        (2,) the command, and what creeps after it, at the start of the step, m; receives both at its end.
    dt
        Duration of the step, s.
    """
    share, time = effects[_CREEP], effects[_CREEP_TIME]
    if share == 0.0:
        return command
    # it follows an even motion at a distance, which is reached as the rest decays
    distance = (command - before[0]) / dt * time
    behind = distance + (before[0] - before[1] - distance) * np.exp(-dt / time)
    before[0], before[1] = command, command - behind
    return float(command - share * behind)


@sealed
def drifted(effects: Floats, axis: int, time: float) -> float:
    """Displacement of the mount since the start of the run, m."""
    lasted = time
    if effects[_DRIFT_FORM] != 0.0:
        lasted = effects[_DRIFT_TIME] * np.log1p(time / effects[_DRIFT_TIME])
    return float(effects[_DRIFT_X if axis == 0 else _DRIFT_Y] * lasted)


def _screwed(effects: Floats, axis: int, place: float) -> float:
    """Displacement of a mount by the screw of an axis, whose command is a place in m; m."""
    sine, cosine = effects[_SCREW + 2 * axis], effects[_SCREW + 2 * axis + 1]
    if sine == 0.0 and cosine == 0.0:
        return 0.0
    turned = 2.0 * np.pi * place / effects[_SCREW_PERIOD]
    return float(sine * np.sin(turned) + cosine * np.cos(turned))


def _mount_of(effects: Floats, waypoints: Floats, probe: int) -> int:
    """The first probe that is carried by the mount of a probe: they move alike.

    Parameters
    ----------
    effects
        (S,) values of the effects.
    waypoints
        (W, P, 2) or more commands of the probes at the ends of legs, m.
    probe
        Its number.
    """
    if effects[_SCREW_FORM] != 0.0:
        return probe
    for first in range(probe):
        alike = True
        for leg in range(waypoints.shape[0]):
            for axis in range(2):
                own = waypoints[leg, probe, axis] - waypoints[0, probe, axis]
                other = waypoints[leg, first, axis] - waypoints[0, first, axis]
                alike &= abs(own - other) <= _APART
        if alike:
            return first
    return probe


screwed, mount_of = sealed(_screwed), sealed(_mount_of)


def true_starts(table: Floats, waypoints: Floats) -> Floats:
    """Where the tips are at the start, to which the screws of the mounts take them from the command.

    Parameters
    ----------
    table
        (1|N, SLOTS) values of the effects.
    waypoints
        (1|N, W, P, 2) commands of the probes, m.

    Returns
    -------
    (1|N, P, 2)
        World frame, m.
    """
    on = np.any(table[:, _SCREW : _SCREW + 4] != 0.0, axis=1)
    if not on.any():
        return np.asarray(waypoints[:, 0])
    count = max(len(table), len(waypoints))
    rows = np.broadcast_to(table, (count, table.shape[1]))
    ways = np.broadcast_to(waypoints, (count, *waypoints.shape[1:]))
    starts = ways[:, 0].copy()
    for run in np.flatnonzero(np.broadcast_to(on, count)):
        for probe in range(starts.shape[1]):
            place = ways[run, 0, _mount_of(rows[run], ways[run], probe)]
            for axis in range(2):
                starts[run, probe, axis] += _screwed(rows[run], axis, place[axis])
    return np.asarray(starts)
