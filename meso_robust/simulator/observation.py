"""Observation, the last stage: what the camera and the tracker make of the true motion.

A pose x, θ of the part at time t is seen as

    y(t) = A S(D(R(φ) (x(t') - m) + m)) + d t + c,    D(r) = r (1 + k1 |r|²),    S(r) = r + s (r - m'),
    θ_seen(t) = θ(t') + φ + q ψ,    t' = (1 + r) t - τ + λ,    tan ψ = 2 k1 (r·h) (h×r) / (1 + k1 r² + 2 k1 (r·h)²),

world frame, about the world origin but for rotation, lens and scale, which have middles of their
own, m, m'' and m': delay τ and rate r of the camera's clock, delay λ of the tips' log, rotation φ of the image against the stage, lens D, error s of the scale, stretch A of the
axes, drift d and shift c. The lens shears what is off its axis; ψ is the angle by which the
x axis h of a part at r is turned by that, and q the share of it that the tracker takes for a turn. A tracker
may be off by a wave in the angle of the part, and by one in the place in the image. Then `sense` samples at the frames of the camera, adds noise and
loses frames. NumPy only; the kernels do not come here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from meso_robust.simulator.stage import FORM, SLOTS, Effect, Parameter, Stage, waves
from meso_robust.types import Flags, Floats

_UM, _DEG = 1e-6, np.pi / 180.0


def _middle(of: str) -> tuple[Parameter, ...]:
    """The place of the stage that an error of the image leaves where it is."""
    return tuple(
        Parameter(
            key=f"about_{axis}_um",
            unit="µm",
            to_si=_UM,
            meaning=f"m_{axis} of the place that {of}, such as the middle of the image",
            size=False,
        )
        for axis in "xy"
    )


OBSERVATION = Stage(
    name="observation",
    base=104,
    slots=32,
    effects=(
        Effect(
            name="camera_latency",
            equation="y(t) = x(t - τ)",
            source="definition of a pure delay",
            parameters=(
                Parameter(
                    key="time_ms",
                    unit="ms",
                    to_si=1e-3,
                    meaning="by how much the images lag behind the controller's clock",
                    low=-1.0,
                    high=1.0,
                ),
            ),
        ),
        Effect(
            name="log_latency",
            equation="y(t) = x(t + λ)",
            source="definition of a pure delay",
            parameters=(
                Parameter(
                    key="time_ms",
                    unit="ms",
                    to_si=1e-3,
                    meaning="λ: by how much the logged places of the tips lag behind the images",
                    low=0.0,
                    high=1.0,
                ),
            ),
        ),
        Effect(
            name="clock_rate",
            equation="y(t) = x((1 + r) t)",
            source="frames that are stamped by their number and a rate that is not quite the camera's",
            parameters=(
                Parameter(
                    key="percent",
                    unit="%",
                    to_si=1e-2,
                    meaning="r: by how much faster all is seen than it is, as the camera's clock is slow",
                    low=-0.2,
                    high=0.2,
                ),
            ),
        ),
        Effect(
            name="camera_scale",
            equation="y = x + s (x − m)",
            source="scale of a similarity transform, doi:10.1109/34.88573",
            parameters=(
                Parameter(
                    key="percent",
                    unit="%",
                    to_si=1e-2,
                    meaning="by how much lengths are seen too long",
                    low=-0.2,
                    high=0.2,
                ),
                *_middle("lengths are seen too long from"),
            ),
        ),
        Effect(
            name="camera_rotation",
            equation="y = R(φ) (x − m) + m, θ_seen = θ + φ",
            source="rotation of a similarity transform, doi:10.1109/34.88573",
            parameters=(
                Parameter(
                    key="angle_deg",
                    unit="°",
                    to_si=_DEG,
                    meaning="angle of the image against the stage, counter-clockwise",
                    low=-45.0 * _DEG,
                    high=45.0 * _DEG,
                ),
                *_middle("the image is turned about"),
            ),
        ),
        Effect(
            name="camera_drift",
            equation="y(t) = x(t) + d t",
            source="definition of a constant drift (thermal, of camera or stage)",
            forms=("steady", "slows down as d t₀ ln(1 + t/t₀)"),
            parameters=(
                Parameter(
                    key="x_um_s",
                    unit="µm/s",
                    to_si=_UM,
                    meaning="speed along x of everything seen",
                ),
                Parameter(
                    key="y_um_s",
                    unit="µm/s",
                    to_si=_UM,
                    meaning="speed along y of everything seen",
                ),
                Parameter(
                    key="time_s",
                    unit="s",
                    to_si=1.0,
                    meaning="t₀: of a drift that slows down, time in which it halves its speed",
                    default=1.0,
                    low=1e-2,
                    high=1e3,
                    size=False,
                ),
            ),
        ),
        Effect(
            name="lens_distortion",
            equation="y = m + r (1 + k1 |r|²), r = x − m, θ_seen = θ + q ψ, ψ the angle by "
            "which its shear turns the part's x axis",
            source="first radial term of Weng, Cohen and Herniou 1992, doi:10.1109/34.159901",
            parameters=(
                Parameter(
                    key="k1_per_mm2",
                    unit="1/mm²",
                    to_si=1e6,
                    meaning="radial distortion, positive: pincushion, negative: barrel",
                    low=-0.1e6,
                    high=0.1e6,
                ),
                Parameter(
                    key="turned",
                    unit="",
                    to_si=1.0,
                    meaning="share of the shear that the tracker takes for a turn: 1 if it follows "
                    "the part's x axis, less if it fits the whole outline, 0 if that is round",
                    low=-1.0,
                    high=1.5,
                    size=False,
                ),
                *_middle("the axis of the lens goes through"),
            ),
        ),
        Effect(
            name="camera_anisotropy",
            equation="y = [[1 + a, k], [k, 1 + b]] x about the world origin, θ_seen = θ + q ψ, ψ the "
            "angle by which that turns the part's x axis",
            source="affine camera; R. Hartley, A. Zisserman 2004, doi:10.1017/CBO9780511811685",
            parameters=(
                Parameter(
                    key="x_percent",
                    unit="%",
                    to_si=1e-2,
                    meaning="a: by how much lengths along x are seen too long",
                    low=-0.2,
                    high=0.2,
                ),
                Parameter(
                    key="y_percent",
                    unit="%",
                    to_si=1e-2,
                    meaning="b: by how much lengths along y are seen too long",
                    low=-0.2,
                    high=0.2,
                ),
                Parameter(
                    key="shear_percent",
                    unit="%",
                    to_si=1e-2,
                    meaning="k: half of what the angle between the axes lacks of 90°, in 0.01 rad",
                    low=-0.1,
                    high=0.1,
                ),
                Parameter(
                    key="turned",
                    unit="",
                    to_si=1.0,
                    meaning="share of the shear that the tracker takes for a turn: 1 if it follows "
                    "the part's x axis, 0 if it fits a round outline",
                    low=-1.0,
                    high=1.5,
                    size=False,
                ),
            ),
        ),
        Effect(
            name="registration_shift",
            equation="y = x + s",
            source="translation of a rigid registration, doi:10.1109/34.88573",
            parameters=(
                Parameter(
                    key="x_um",
                    unit="µm",
                    to_si=_UM,
                    meaning="s_x: by how much the camera's frame stands off the tips'",
                ),
                Parameter(
                    key="y_um",
                    unit="µm",
                    to_si=_UM,
                    meaning="s_y: by how much the camera's frame stands off the tips'",
                ),
            ),
        ),
        Effect(
            name="angle_error",
            equation="θ_seen = θ + s sin kθ + c cos kθ, k = 4",
            source="square pixels and interpolation, as seen in turned images",
            forms=("four times a turn", "twice a turn", "once a turn"),
            parameters=(
                Parameter(
                    key="sine_deg",
                    unit="°",
                    to_si=_DEG,
                    meaning="s",
                    low=-10.0 * _DEG,
                    high=10.0 * _DEG,
                ),
                Parameter(
                    key="cosine_deg",
                    unit="°",
                    to_si=_DEG,
                    meaning="c",
                    low=-10.0 * _DEG,
                    high=10.0 * _DEG,
                ),
            ),
        ),
        Effect(
            name="pixel_locking",
            equation="w_seen = w + s sin(2π w/p) + c cos(2π w/p) of each coordinate w",
            source="peak locking; J. Westerweel 1997, doi:10.1088/0957-0233/8/12/002",
            parameters=(
                *waves(),
                Parameter(
                    key="pitch_um",
                    unit="µm",
                    to_si=_UM,
                    meaning="p: side of a pixel, or of what is taken for one",
                    default=50.0 * _UM,
                    low=0.1 * _UM,
                    size=False,
                ),
            ),
        ),
    ),
)
"""The stage of the camera and the tracker."""

CAMERA_LATENCY_TIME = OBSERVATION.slot("camera_latency", "time_ms")
LOG_LATENCY_TIME = OBSERVATION.slot("log_latency", "time_ms")
CLOCK_RATE_PERCENT = OBSERVATION.slot("clock_rate", "percent")
CAMERA_SCALE_PERCENT = OBSERVATION.slot("camera_scale", "percent")
CAMERA_SCALE_ABOUT_X = OBSERVATION.slot("camera_scale", "about_x_um")
CAMERA_SCALE_ABOUT_Y = OBSERVATION.slot("camera_scale", "about_y_um")
CAMERA_ROTATION_ANGLE = OBSERVATION.slot("camera_rotation", "angle_deg")
CAMERA_ROTATION_ABOUT_X = OBSERVATION.slot("camera_rotation", "about_x_um")
CAMERA_ROTATION_ABOUT_Y = OBSERVATION.slot("camera_rotation", "about_y_um")
CAMERA_DRIFT_X = OBSERVATION.slot("camera_drift", "x_um_s")
CAMERA_DRIFT_Y = OBSERVATION.slot("camera_drift", "y_um_s")
CAMERA_DRIFT_TIME = OBSERVATION.slot("camera_drift", "time_s")
CAMERA_DRIFT_FORM = OBSERVATION.slot("camera_drift", FORM)
LENS_DISTORTION_K1 = OBSERVATION.slot("lens_distortion", "k1_per_mm2")
LENS_DISTORTION_ABOUT_X = OBSERVATION.slot("lens_distortion", "about_x_um")
LENS_DISTORTION_ABOUT_Y = OBSERVATION.slot("lens_distortion", "about_y_um")
LENS_DISTORTION_TURNED = OBSERVATION.slot("lens_distortion", "turned")
CAMERA_ANISOTROPY_X = OBSERVATION.slot("camera_anisotropy", "x_percent")
CAMERA_ANISOTROPY_Y = OBSERVATION.slot("camera_anisotropy", "y_percent")
CAMERA_ANISOTROPY_SHEAR = OBSERVATION.slot("camera_anisotropy", "shear_percent")
CAMERA_ANISOTROPY_TURNED = OBSERVATION.slot("camera_anisotropy", "turned")
REGISTRATION_SHIFT_X = OBSERVATION.slot("registration_shift", "x_um")
REGISTRATION_SHIFT_Y = OBSERVATION.slot("registration_shift", "y_um")

ANGLE_ERROR_SINE = OBSERVATION.slot("angle_error", "sine_deg")
ANGLE_ERROR_COSINE = OBSERVATION.slot("angle_error", "cosine_deg")
ANGLE_ERROR_FORM = OBSERVATION.slot("angle_error", FORM)
PIXEL_LOCKING = OBSERVATION.slot("pixel_locking", "x_sine_um")
PIXEL_PITCH = OBSERVATION.slot("pixel_locking", "pitch_um")

_LENS_ABOUT = [LENS_DISTORTION_ABOUT_X, LENS_DISTORTION_ABOUT_Y]
_SCALE_ABOUT = [CAMERA_SCALE_ABOUT_X, CAMERA_SCALE_ABOUT_Y]
_ROTATION_ABOUT = [CAMERA_ROTATION_ABOUT_X, CAMERA_ROTATION_ABOUT_Y]
_TIMES = np.array([4.0, 2.0, 1.0])  # a turn, by the form of an angle's error
_ROUNDS = 50  # of Newton's rule, which converges quadratically but where the lens folds the image
_LEAST = 1e-6  # slope of the lens, below which its inverse is not to be had
_WHOLE_FRAME = 1e-9  # of a frame, so that 1 s at 30 Hz has the frame at its end


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    """Camera and tracker: how often a pose is seen and how well.

    Attributes
    ----------
    position_sigma
        Standard deviation of a seen x or y in m.
    orientation_sigma
        Standard deviation of a seen θ in rad.
    frame_rate
        Frames a second, in Hz.
    correlation_time
        Time after which the correlation of the noise has fallen to 1/e, in s; zero: white noise.
    dropout
        Share of the frames that are lost, each by itself.

    Raises
    ------
    ValueError
        If a value is not finite or breaks its rule.
    """

    position_sigma: float
    orientation_sigma: float
    frame_rate: float
    correlation_time: float = 0.0
    dropout: float = 0.0

    def __post_init__(self) -> None:
        """Check the fields."""
        for name in ("position_sigma", "orientation_sigma", "correlation_time"):
            value = getattr(self, name)
            if not 0.0 <= value < np.inf:
                _refuse(
                    f"sensor.{name}", f"{value}", "must be finite and not negative", "correct it"
                )
        if not 0.0 < self.frame_rate < np.inf:
            rule = "must be positive and finite"
            _refuse("sensor.frame_rate", f"{self.frame_rate} Hz", rule, "try 30 Hz")
        if not 0.0 <= self.dropout <= 1.0:
            _refuse("sensor.dropout", f"{self.dropout}", "must be in 0 … 1", "give a share")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frames:
    """What the tracker hands over for N runs; a lost frame is NaN throughout.

    Attributes
    ----------
    times
        (F,) instants of the frames in s.
    poses
        (N, F, 3) x, y in m and θ in rad, world frame.
    probes
        (N, F, P, 2) centres of the tips in m, world frame.
    """

    times: Floats
    poses: Floats
    probes: Floats


def observe(
    times: Floats,
    poses: Floats,
    probes: Floats,
    effects_table: Floats,
    *,
    probes_seen_by_camera: bool,
) -> tuple[Floats, Floats]:
    """Motion as the camera shows it, without noise; see the head of the file for the law.

    The motion is taken as linear in time between the samples; before the first and after the last
    the part and the tips are at rest. An effect that is off leaves every bit as it is.

    The Jacobian of the lens, (1 + k1 r²) I + 2 k1 r rᵀ, is symmetric: its rotation part (that of
    the polar decomposition) is the identity, so the lens does not turn a round part. One that is
    longer than wide has an axis, and a tracker that follows it takes shear for a turn.

    Parameters
    ----------
    times
        (T,) instants of the samples in s, strictly increasing, or (N, T) those of each run; the drift is
        nought at t = 0.
    poses
        (N, T, 3) x, y in m and θ in rad, unwrapped, world frame.
    probes
        (N, T, P, 2) centres of the tips in m, world frame.
    effects_table
        (1, SLOTS) or (N, SLOTS), see `Effects.table`.
    probes_seen_by_camera
        Whether the positions of the tips come from the camera, too; if not, they are those the
        controller commanded and are returned as they are.

    Returns
    -------
    (N, T, 3), (N, T, P, 2)
        The poses and tips as seen, new arrays.

    Raises
    ------
    ValueError
        If a shape is wrong, the clock does not go on, or a point lies where the lens folds the
        image over (1 + 3 k1 r² <= 0).
    """
    times, poses, probes = _checked(times, poses, probes)
    runs = len(poses)
    if effects_table.shape not in ((1, SLOTS), (runs, SLOTS)):
        rule = f"must be (1, {SLOTS}) or ({runs}, {SLOTS})"
        _refuse("effects_table", f"shape {effects_table.shape}", rule, "use Effects.table")
    table = np.broadcast_to(effects_table, (runs, SLOTS))
    times = np.broadcast_to(times, (runs, times.shape[-1]))
    _delay(times, poses, table)
    _turn(poses[..., 2], table[:, CAMERA_ROTATION_ANGLE])
    _shear(poses, table)
    _lean(poses, table)
    _err(poses[..., 2], table)
    _show(times, poses[:, :, None, :2], table)
    if probes_seen_by_camera:
        _delay(times, probes, table)
        _show(times, probes, table)
    return poses, probes


def unseen(times: Floats, points: Floats, effects_table: Floats) -> Floats:
    """Where points are that the camera shows: the inverse of `observe`, but for the delay.

    Parameters
    ----------
    times
        (N, T) instants at which the points are shown, s.
    points
        (N, T, Q, 2) as shown, m, world frame.
    effects_table
        (1, SLOTS) or (N, SLOTS), see `Effects.table`.

    Returns
    -------
    (N, T, Q, 2)
        A new array; a point that the lens shows nowhere is put where its image turns back.
    """
    table = np.broadcast_to(effects_table, (len(points), SLOTS))
    lasted = _lasted(times, table)[..., None, None]
    shown = points - lasted * table[:, None, None, [CAMERA_DRIFT_X, CAMERA_DRIFT_Y]]
    shown -= table[:, None, None, [REGISTRATION_SHIFT_X, REGISTRATION_SHIFT_Y]]
    _unlock(shown, table)
    on = _stretched(table)
    shown[on] = np.einsum("nij,ntqj->ntqi", np.linalg.inv(_axes(table[on])), shown[on])
    error = table[:, None, None, None, CAMERA_SCALE_PERCENT]
    shown += error * table[:, None, None, _SCALE_ABOUT]
    shown /= 1.0 + error
    _straighten(shown, table[:, LENS_DISTORTION_K1], table[:, _LENS_ABOUT])
    _rotate(shown, -table[:, CAMERA_ROTATION_ANGLE], table[:, _ROTATION_ABOUT])
    return np.asarray(shown)


def sense(
    sensor: Sensor,
    times: Floats,
    poses: Floats,
    probes: Floats,
    rng: np.random.Generator,
    *,
    probes_seen_by_camera: bool,
) -> Frames:
    """Frames of the camera with noise and losses.

    Every coordinate of every run has its own noise: white, or of first order Gauss-Markov with the
    correlation exp(-Δt/correlation_time). The noise of a run does not depend on which frames are
    lost.

    Parameters
    ----------
    sensor
        The camera and the tracker.
    times
        (T,) instants of the samples in s, strictly increasing; the first frame is at the first.
    poses
        (N, T, 3) x, y in m and θ in rad, unwrapped, world frame, as `observe` returns them.
    probes
        (N, T, P, 2) centres of the tips in m, world frame.
    rng
        Source of the noise and the losses.
    probes_seen_by_camera
        Whether the positions of the tips have the noise of the camera; if not, they are exact.

    Returns
    -------
    Frames
        The frames, from the first instant to the last.

    Raises
    ------
    ValueError
        If a shape is wrong or the clock does not go on.
    """
    times, poses, probes = _checked(times, poses, probes)
    if times.ndim != 1:
        _refuse("times", f"shape {times.shape}", "must be (T,)", "sense each run by itself")
    count = int(np.floor((times[-1] - times[0]) * sensor.frame_rate + _WHOLE_FRAME)) + 1
    frames = times[0] + np.arange(count) / sensor.frame_rate
    at = np.broadcast_to(frames, (len(poses), count))
    times = np.broadcast_to(times, (len(poses), times.size))
    seen = _interpolated(times, poses, at)
    tips = _interpolated(times, probes, at)
    sigma = np.array([sensor.position_sigma, sensor.position_sigma, sensor.orientation_sigma])
    seen += sigma * _noise(sensor, seen.shape, rng)
    if probes_seen_by_camera:
        tips += sensor.position_sigma * _noise(sensor, tips.shape, rng)
    lost = rng.random((len(poses), count)) < sensor.dropout
    seen[lost] = np.nan
    tips[lost] = np.nan
    return Frames(times=frames, poses=seen, probes=tips)


def _show(times: Floats, points: Floats, table: Floats) -> None:
    """Take points (N, T, Q, 2) through rotation, lens, scale, pixels and drift."""
    _rotate(points, table[:, CAMERA_ROTATION_ANGLE], table[:, _ROTATION_ABOUT])
    _distort(points, table[:, LENS_DISTORTION_K1], table[:, _LENS_ABOUT])
    _scale(points, table[:, CAMERA_SCALE_PERCENT], table[:, _SCALE_ABOUT])
    _deform(points, table)
    _lock(points, table)
    _drift(times, points, table)
    _shift(points, table[:, [REGISTRATION_SHIFT_X, REGISTRATION_SHIFT_Y]])


# The following write into the copies that `observe` has made, and only for the runs where the
# effect is on: adding a zero would turn -0.0 into 0.0, and interpolating at the samples could
# change the last bit. Where none is on they return at once, as most are off in any fit.


def _delay(times: Floats, values: Floats, table: Floats) -> None:
    delay = table[:, CAMERA_LATENCY_TIME] - table[:, LOG_LATENCY_TIME]
    rate = table[:, CLOCK_RATE_PERCENT]
    on = (delay != 0.0) | (rate != 0.0)
    if not on.any():
        return
    seen = times[on] + rate[on, None] * times[on] - delay[on, None]
    values[on] = _interpolated(times[on], values[on], seen)


def _turn(angles: Floats, turn: Floats) -> None:
    on = turn != 0.0
    angles[on] += turn[on, None]


def _shear(poses: Floats, table: Floats) -> None:
    """Turn poses, already turned with the image, by what the tracker takes of the lens's shear."""
    k1, share = table[:, LENS_DISTORTION_K1], table[:, LENS_DISTORTION_TURNED]
    on = (k1 != 0.0) & (share != 0.0)
    if not on.any():
        return
    points = poses[on, :, None, :2].copy()
    _rotate(points, table[on, CAMERA_ROTATION_ANGLE], table[on][:, _ROTATION_ABOUT])
    points -= table[on][:, None, None, _LENS_ABOUT]
    x, y, angle = points[..., 0, 0], points[..., 0, 1], poses[on, :, 2]
    along, across = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
    k = k1[on, None]
    stretch = 1.0 + k * (x**2 + y**2) + 2.0 * k * along**2
    poses[on, :, 2] += share[on, None] * np.arctan2(2.0 * k * along * across, stretch)


def _err(angles: Floats, table: Floats) -> None:
    """Add what a tracker is off by that depends on how the part is turned."""
    sine, cosine = table[:, ANGLE_ERROR_SINE], table[:, ANGLE_ERROR_COSINE]
    on = (sine != 0.0) | (cosine != 0.0)
    if not on.any():
        return
    many = _TIMES[table[on, ANGLE_ERROR_FORM].astype(int), None] * angles[on]
    angles[on] += sine[on, None] * np.sin(many) + cosine[on, None] * np.cos(many)


def _locked(points: Floats, table: Floats) -> Floats:
    """(N, T, Q, 2) by what points (N, T, Q, 2) are drawn to the middle of pixels, m."""
    waves = table[:, PIXEL_LOCKING : PIXEL_LOCKING + 4].reshape(-1, 1, 1, 2, 2)
    turned = 2.0 * np.pi / table[:, PIXEL_PITCH, None, None, None] * points
    return np.asarray(waves[..., 0] * np.sin(turned) + waves[..., 1] * np.cos(turned))


def _locks(table: Floats) -> Flags:
    """(N,) runs whose points are drawn to the middle of pixels."""
    return np.asarray(np.any(table[:, PIXEL_LOCKING : PIXEL_LOCKING + 4] != 0.0, axis=1))


def _lock(points: Floats, table: Floats) -> None:
    on = _locks(table)
    if on.any():
        points[on] += _locked(points[on], table[on])


def _unlock(points: Floats, table: Floats) -> None:
    """The inverse of `_lock`, by a fixed point: waves that are less steep than 1 keep points in order."""
    on = _locks(table)
    free = points[on].copy()
    for _ in range(_ROUNDS):
        free = points[on] - _locked(free, table[on])
    points[on] = free


def _axes(table: Floats) -> Floats:
    """(N, 2, 2) stretch of the axes."""
    shear = table[:, CAMERA_ANISOTROPY_SHEAR]
    rows = (
        np.stack((1.0 + table[:, CAMERA_ANISOTROPY_X], shear), axis=-1),
        np.stack((shear, 1.0 + table[:, CAMERA_ANISOTROPY_Y]), axis=-1),
    )
    return np.stack(rows, axis=-2)


def _stretched(table: Floats) -> Flags:
    """(N,) runs whose axes are not seen as they are."""
    columns = [CAMERA_ANISOTROPY_X, CAMERA_ANISOTROPY_Y, CAMERA_ANISOTROPY_SHEAR]
    return np.asarray(np.any(table[:, columns] != 0.0, axis=1))


def _deform(points: Floats, table: Floats) -> None:
    on = _stretched(table)
    if on.any():
        points[on] = np.einsum("nij,ntqj->ntqi", _axes(table[on]), points[on])


def _lean(poses: Floats, table: Floats) -> None:
    """Turn poses by what the tracker takes of the stretch of the axes."""
    on = _stretched(table) & (table[:, CAMERA_ANISOTROPY_TURNED] != 0.0)
    if not on.any():
        return
    cos, sin = np.cos(poses[on, :, 2]), np.sin(poses[on, :, 2])
    axis = np.einsum("nij,ntj->nti", _axes(table[on]), np.stack((cos, sin), axis=-1))
    across, along = cos * axis[..., 1] - sin * axis[..., 0], cos * axis[..., 0] + sin * axis[..., 1]
    poses[on, :, 2] += table[on, CAMERA_ANISOTROPY_TURNED, None] * np.arctan2(across, along)


def _shift(points: Floats, shift: Floats) -> None:
    on = np.any(shift != 0.0, axis=1)
    points[on] += shift[on, None, None]


def _rotate(points: Floats, angle: Floats, about: Floats) -> None:
    on = angle != 0.0
    if not on.any():
        return
    cos, sin = np.cos(angle[on])[:, None, None], np.sin(angle[on])[:, None, None]
    middle = about[on, None, None]
    x, y = points[on, ..., 0] - middle[..., 0], points[on, ..., 1] - middle[..., 1]
    points[on] = np.stack((cos * x - sin * y, sin * x + cos * y), axis=-1) + middle


def _distort(points: Floats, k1: Floats, about: Floats) -> None:
    on = k1 != 0.0
    if not on.any():
        return
    away = points[on] - about[on, None, None]
    bulge = k1[on, None, None] * np.sum(away**2, axis=-1)
    if np.any(1.0 + 3.0 * bulge <= 0.0):
        value = f"k1 r² = {np.nanmin(bulge):.3g}"
        rule = "must be above -1/3, where the lens folds the image over"
        _refuse("lens_distortion", value, rule, "lower |k1_per_mm2| or move its middle")
    points[on] += bulge[..., None] * away


def _straighten(points: Floats, k1: Floats, about: Floats) -> None:
    """Solve r (1 + k1 r²) = R for the distance r from the axis, by Newton's rule."""
    on = k1 != 0.0
    away = points[on] - about[on, None, None]
    far = np.hypot(away[..., 0], away[..., 1])
    k = np.broadcast_to(k1[on, None, None], far.shape)
    most = np.where(k < 0.0, 1.0 / np.sqrt(np.maximum(-3.0 * k, 1e-300)), np.inf)
    r = np.minimum(far, most)
    for _ in range(_ROUNDS):
        slope = np.maximum(1.0 + 3.0 * k * r**2, _LEAST)
        r = np.clip(r - (r * (1.0 + k * r**2) - far) / slope, 0.0, most)
    nearer = np.where(far > 0.0, r / np.maximum(far, 1e-300), 1.0) - 1.0
    points[on] += nearer[..., None] * away


def _scale(points: Floats, error: Floats, about: Floats) -> None:
    on = error != 0.0
    points[on] += error[on, None, None, None] * (points[on] - about[on, None, None])


def _lasted(times: Floats, table: Floats) -> Floats:
    """Times (N, T) by which a steady drift gets as far as that of every run does in (1|N, T)."""
    slows = table[:, CAMERA_DRIFT_FORM] != 0.0
    scale = np.where(slows, table[:, CAMERA_DRIFT_TIME], 1.0)[:, None]
    return np.where(
        slows[:, None], scale * np.log1p(np.maximum(times, -0.5 * scale) / scale), times
    )


def _drift(times: Floats, points: Floats, table: Floats) -> None:
    for axis, column in enumerate((CAMERA_DRIFT_X, CAMERA_DRIFT_Y)):
        on = table[:, column] != 0.0
        if on.any():
            lasted = _lasted(times[on], table[on])
            points[on, ..., axis] += table[on, column, None, None] * lasted[..., None]


def _interpolated(times: Floats, values: Floats, at: Floats) -> Floats:
    """Values (N, T, ...) of the times (N, T) at the instants (N, F), linear in time, held before and after."""
    count = times.shape[1]
    passed = [
        np.searchsorted(own, asked, side="right") for own, asked in zip(times, at, strict=True)
    ]
    before = np.clip(np.array(passed, dtype=np.int64).reshape(at.shape) - 1, 0, max(count - 2, 0))
    after = np.minimum(before + 1, count - 1)
    runs = np.arange(len(values))[:, None]
    span = np.where(after > before, times[runs, after] - times[runs, before], 1.0)
    share = np.clip((at - times[runs, before]) / span, 0.0, 1.0)
    share = share.reshape(share.shape + (1,) * (values.ndim - 2))
    start, end = values[runs, before], values[runs, after]
    return np.where(share == 1.0, end, start + share * (end - start))


def _noise(sensor: Sensor, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
    """Noise (N, F, ...) of unit variance along the frames, stationary from the first."""
    noise = rng.standard_normal(shape)
    if sensor.correlation_time > 0.0:
        keep = np.exp(-1.0 / (sensor.frame_rate * sensor.correlation_time))
        fresh = np.sqrt(1.0 - keep**2)
        for frame in range(1, shape[1]):
            noise[:, frame] = keep * noise[:, frame - 1] + fresh * noise[:, frame]
    return noise


def _checked(times: Floats, poses: Floats, probes: Floats) -> tuple[Floats, Floats, Floats]:
    """Copies as float64, after a check of the shapes and the clock."""
    times, poses, probes = (np.array(a, dtype=np.float64) for a in (times, poses, probes))
    if (
        times.ndim not in (1, 2)
        or times.size == 0
        or (times.ndim == 2 and len(times) != len(poses))
    ):
        rule = "must be (T,) with T >= 1, or (N, T) with the instants of each run"
        _refuse("times", f"shape {times.shape}", rule, "reshape it")
    if poses.ndim != 3 or poses.shape[1:] != (times.shape[-1], 3):
        rule = f"must be (N, {times.shape[-1]}, 3), as times has {times.shape[-1]} instants"
        _refuse("poses", f"shape {poses.shape}", rule, "reshape it")
    if probes.ndim != 4 or probes.shape[:2] != poses.shape[:2] or probes.shape[3] != 2:
        rule = f"must be ({len(poses)}, {times.shape[-1]}, P, 2), as poses has that many runs"
        _refuse("probes", f"shape {probes.shape}", rule, "reshape it")
    if not (np.all(np.isfinite(times)) and np.all(np.diff(times) > 0.0)):
        shown = f"{times.flat[0]} … {times.flat[-1]} s"
        _refuse("times", shown, "must be finite and increase", "sort it")
    return times, poses, probes


def _refuse(argument: str, value: str, rule: str, advice: str) -> NoReturn:
    raise ValueError(f"{argument}: {value}; {rule}; {advice}")
