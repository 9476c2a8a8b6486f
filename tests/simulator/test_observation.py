"""The observation stage against complex numbers, hand values and statistics."""

from __future__ import annotations

import cmath
import math
from itertools import permutations

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.simulator.effects import Effects
from meso_robust.simulator.observation import (
    ANGLE_ERROR_COSINE,
    ANGLE_ERROR_FORM,
    ANGLE_ERROR_SINE,
    CAMERA_ANISOTROPY_SHEAR,
    CAMERA_ANISOTROPY_TURNED,
    CAMERA_ANISOTROPY_X,
    CAMERA_ANISOTROPY_Y,
    CAMERA_DRIFT_FORM,
    CAMERA_DRIFT_TIME,
    CAMERA_DRIFT_X,
    CAMERA_DRIFT_Y,
    CAMERA_LATENCY_TIME,
    CAMERA_ROTATION_ABOUT_X,
    CAMERA_ROTATION_ABOUT_Y,
    CAMERA_ROTATION_ANGLE,
    CAMERA_SCALE_ABOUT_X,
    CAMERA_SCALE_ABOUT_Y,
    CAMERA_SCALE_PERCENT,
    CLOCK_RATE_PERCENT,
    LENS_DISTORTION_ABOUT_X,
    LENS_DISTORTION_ABOUT_Y,
    LENS_DISTORTION_K1,
    LENS_DISTORTION_TURNED,
    LOG_LATENCY_TIME,
    OBSERVATION,
    PIXEL_LOCKING,
    PIXEL_PITCH,
    REGISTRATION_SHIFT_X,
    REGISTRATION_SHIFT_Y,
    Frames,
    Sensor,
    observe,
    sense,
    unseen,
)
from meso_robust.simulator.stage import SLOTS

Floats = npt.NDArray[np.float64]

TIMES = np.array([-0.5, 0.0, 0.125, 0.5, 2.0])
SLOT_OF = {
    "camera_latency": (CAMERA_LATENCY_TIME,),
    "log_latency": (LOG_LATENCY_TIME,),
    "clock_rate": (CLOCK_RATE_PERCENT,),
    "camera_scale": (CAMERA_SCALE_PERCENT, CAMERA_SCALE_ABOUT_X, CAMERA_SCALE_ABOUT_Y),
    "camera_rotation": (CAMERA_ROTATION_ANGLE, CAMERA_ROTATION_ABOUT_X, CAMERA_ROTATION_ABOUT_Y),
    "camera_drift": (CAMERA_DRIFT_X, CAMERA_DRIFT_Y, CAMERA_DRIFT_TIME, CAMERA_DRIFT_FORM),
    "lens_distortion": (
        LENS_DISTORTION_K1,
        LENS_DISTORTION_TURNED,
        LENS_DISTORTION_ABOUT_X,
        LENS_DISTORTION_ABOUT_Y,
    ),
    "camera_anisotropy": (
        CAMERA_ANISOTROPY_X,
        CAMERA_ANISOTROPY_Y,
        CAMERA_ANISOTROPY_SHEAR,
        CAMERA_ANISOTROPY_TURNED,
    ),
    "angle_error": (ANGLE_ERROR_SINE, ANGLE_ERROR_COSINE, ANGLE_ERROR_FORM),
    "pixel_locking": (*range(PIXEL_LOCKING, PIXEL_LOCKING + 4), PIXEL_PITCH),
    "registration_shift": (REGISTRATION_SHIFT_X, REGISTRATION_SHIFT_Y),
}
ON: dict[str, dict[str, float | Floats]] = {
    "camera_latency": {"time_ms": 60.0},
    "log_latency": {"time_ms": 15.0},
    "clock_rate": {"percent": 4.0},
    "camera_scale": {"percent": 0.7, "about_x_um": 250.0, "about_y_um": -400.0},
    "camera_rotation": {"angle_deg": 1.3, "about_x_um": -600.0, "about_y_um": 150.0},
    "camera_drift": {"x_um_s": 0.4, "y_um_s": -0.2},
    "lens_distortion": {"k1_per_mm2": 0.01, "about_x_um": 120.0, "about_y_um": -350.0},
    "camera_anisotropy": {"x_percent": -0.4, "y_percent": 2.3, "shear_percent": 0.2},
    "angle_error": {"sine_deg": 0.5, "cosine_deg": -0.3},
    "pixel_locking": {"x_sine_um": 2.0, "x_cosine_um": 1.0, "y_sine_um": -1.5, "y_cosine_um": 0.5},
    "registration_shift": {"x_um": 3.0, "y_um": -7.0},
}

CLOCK = ("camera_latency", "log_latency", "clock_rate")


def motion(runs: int = 3, tips: int = 2) -> tuple[Floats, Floats]:
    """Some poses and tips, negative zeros among them."""
    rng = np.random.default_rng(5)
    poses = rng.uniform(-1e-3, 1e-3, (runs, TIMES.size, 3))
    probes = rng.uniform(-1e-3, 1e-3, (runs, TIMES.size, tips, 2))
    poses[0, 1] = -0.0
    probes[0, 1, 0] = -0.0
    poses.flags.writeable = probes.flags.writeable = False  # so that writing into them fails
    return poses, probes


def seen(values: dict[str, dict[str, float | Floats]], camera: bool = True) -> tuple[Floats, ...]:
    poses, probes = motion()
    return observe(TIMES, poses, probes, Effects(values).table, probes_seen_by_camera=camera)


def same_bits(a: Floats, b: Floats) -> bool:
    return a.shape == b.shape and a.tobytes() == b.tobytes()


def test_the_stage_declares_its_effects_in_its_block_of_the_table() -> None:
    assert {effect.name for effect in OBSERVATION.effects} == set(SLOT_OF)
    slots = sorted(slot for group in SLOT_OF.values() for slot in group)
    assert slots == list(range(OBSERVATION.base, OBSERVATION.base + 31))
    table = Effects(ON).table[0]
    expected = [0.06, 0.015, 0.04, 0.007, 250e-6, -400e-6, math.radians(1.3), -600e-6, 150e-6]
    expected += [0.4e-6, -0.2e-6, 1.0, 0.0, 1e4, 0.0, 120e-6, -350e-6]
    expected += [-0.004, 0.023, 0.002, 0.0]
    expected += [math.radians(0.5), math.radians(-0.3), 0.0, 2e-6, 1e-6, -1.5e-6, 0.5e-6, 50e-6]
    expected += [3e-6, -7e-6]
    columns = [slot for group in SLOT_OF.values() for slot in group]
    assert table[columns] == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("camera", [True, False])
def test_a_table_of_zeros_changes_no_bit(camera: bool) -> None:
    poses, probes = motion()
    out = observe(TIMES, poses, probes, np.zeros((3, SLOTS)), probes_seen_by_camera=camera)
    assert same_bits(out[0], poses)
    assert same_bits(out[1], probes)
    assert not np.shares_memory(out[0], poses)


@pytest.mark.parametrize(("on", "off"), list(permutations(ON, 2)))
def test_an_effect_at_zero_leaves_the_others_bit_for_bit(on: str, off: str) -> None:
    alone = seen({on: ON[on]})
    beside = seen({on: ON[on], off: dict.fromkeys(ON[off], 0.0)})
    run_by_run = seen({on: ON[on], off: {key: np.array([0.09, 0.0, 0.0]) for key in ON[off]}})
    for k in range(1 if off == "angle_error" else 2):  # a tip has no angle
        assert same_bits(alone[k], beside[k])
        assert same_bits(alone[k][1:], run_by_run[k][1:])
        assert not same_bits(alone[k][0], run_by_run[k][0])


def test_commanded_tips_are_no_matter_of_the_camera() -> None:
    poses, probes = motion()
    out = seen(ON, camera=False)
    assert same_bits(out[1], probes)
    assert same_bits(out[0], seen(ON)[0])
    assert not np.any(out[0] == poses)


def test_rotation_scale_lens_stretch_drift_and_shift_are_those_of_complex_numbers() -> None:
    poses, probes = motion()
    values = {name: given for name, given in ON.items() if name not in CLOCK}
    out_poses, out_probes = seen(values)
    turn = cmath.rect(1.0, math.radians(1.3))
    lens = complex(120e-6, -350e-6)
    turned_about, scaled_about = complex(-600e-6, 150e-6), complex(250e-6, -400e-6)
    for run, k in np.ndindex(3, TIMES.size):
        points = [poses[run, k, :2], *probes[run, k]]
        found = [out_poses[run, k, :2], *out_probes[run, k]]
        for point, image in zip(points, found, strict=True):
            z = (complex(*point) - turned_about) * turn + turned_about
            z += 0.01e6 * abs(z - lens) ** 2 * (z - lens)
            z = (z - scaled_about) * 1.007 + scaled_about
            z = complex(0.996 * z.real + 0.002 * z.imag, 0.002 * z.real + 1.023 * z.imag)
            x, y = (cmath.exp(2j * math.pi / 50e-6 * part) for part in (z.real, z.imag))
            z += 1e-6 * complex(2.0 * x.imag + x.real, 0.5 * y.real - 1.5 * y.imag)
            z += complex(0.4e-6, -0.2e-6) * float(TIMES[k]) + complex(3e-6, -7e-6)
            assert complex(*image) == pytest.approx(z, abs=1e-17)
        turned = poses[run, k, 2] + math.radians(1.3)
        turned += math.radians(0.5 * math.sin(4.0 * turned) - 0.3 * math.cos(4.0 * turned))
        assert out_poses[run, k, 2] == pytest.approx(turned, abs=1e-16)


@pytest.mark.parametrize(
    "name",
    ["camera_scale", "camera_drift", "lens_distortion", "camera_anisotropy", "registration_shift"],
)
def test_scale_drift_and_lens_turn_nothing(name: str) -> None:
    assert same_bits(seen({name: ON[name]})[0][..., 2], motion()[0][..., 2])


def test_the_best_rotation_of_a_small_disc_seen_through_the_lens_is_none() -> None:
    # by registration of points around the reference point, not by the Jacobian
    centre, k1 = 0.8e-3 + 0.5e-3j, 0.05
    ring = 1e-6 * np.exp(2j * np.pi * np.arange(12) / 12)
    points = np.concatenate(([centre], centre + ring))
    probes = np.stack((points.real, points.imag), axis=-1)[None, None]
    table = Effects({"lens_distortion": {"k1_per_mm2": k1}}).table
    _, out = observe(np.zeros(1), np.zeros((1, 1, 3)), probes, table, probes_seen_by_camera=True)
    image = out[0, 0, :, 0] + 1j * out[0, 0, :, 1]
    turn = np.angle(np.sum(np.conj(ring) * (image[1:] - np.mean(image[1:]))))
    shear = np.angle((image[1] - image[0]) / ring[0])
    assert abs(turn) < 1e-9 < 1e-3 < abs(shear)


def test_a_tracked_axis_is_turned_as_the_image_of_two_points_of_it() -> None:
    r, k1, heading = 0.9e-3 - 0.4e-3j, -0.06, 0.7
    turn = np.deg2rad(2.0)
    ends = r + 1e-8 * np.exp(1j * heading) * np.array([1.0, -1.0])
    image = np.exp(1j * turn) * ends * (1.0 + 1e6 * k1 * abs(ends) ** 2)
    expected = np.angle((image[0] - image[1]) * np.exp(-1j * heading)) + heading
    pose = np.array([[[r.real, r.imag, heading]]])
    for share in (0.0, 0.4, 1.0):
        lens = {"k1_per_mm2": k1, "turned": share}
        table = Effects({"lens_distortion": lens, "camera_rotation": {"angle_deg": 2.0}}).table
        seen, _ = observe(
            np.zeros(1), pose, np.zeros((1, 1, 0, 2)), table, probes_seen_by_camera=False
        )
        shear = expected - heading - turn
        assert abs(shear) > 0.02
        assert seen[0, 0, 2] == pytest.approx(heading + turn + share * shear, abs=1e-9)


@pytest.mark.parametrize(("form", "many"), [(0.0, 4), (1.0, 2), (2.0, 1)])
def test_an_angle_is_off_by_a_wave_of_so_many_a_turn(form: float, many: int) -> None:
    """By the power of a unit number, whose imaginary part is the sine."""
    poses, _ = motion()
    found, _ = seen({"angle_error": {"sine_deg": 2.0, "cosine_deg": -1.0, "form": form}})
    power = np.exp(1j * poses[..., 2]) ** many
    off = np.radians(2.0 * power.imag - power.real)
    np.testing.assert_allclose(found[..., 2] - poses[..., 2], off, atol=1e-15)
    assert same_bits(found[..., :2], poses[..., :2])


def test_points_that_lie_alike_in_their_pixels_are_drawn_alike() -> None:
    """By the power of a unit number again; a pixel further on nothing else happens."""
    sizes = {"x_sine_um": 4.0, "x_cosine_um": -2.0, "y_sine_um": 0.0, "y_cosine_um": 3.0}
    table = Effects({"pixel_locking": {**sizes, "pitch_um": 80.0}}).table
    poses, probes = motion()
    found, _ = observe(TIMES, poses, probes, table, probes_seen_by_camera=False)
    unit = np.exp(2j * np.pi / 80e-6 * poses[..., :2])
    off = np.stack(
        [4.0 * unit[..., 0].imag - 2.0 * unit[..., 0].real, 3.0 * unit[..., 1].real], axis=-1
    )
    np.testing.assert_allclose(found[..., :2] - poses[..., :2], 1e-6 * off, atol=1e-12)
    on, _ = observe(
        TIMES, poses + np.array([80e-6, -160e-6, 0.0]), probes, table, probes_seen_by_camera=False
    )
    np.testing.assert_allclose(
        on - found, np.broadcast_to([80e-6, -160e-6, 0.0], on.shape), atol=1e-12
    )


def test_what_is_shown_tells_where_it_is() -> None:
    effects = {name: of for name, of in ON.items() if name not in CLOCK}
    for sign in (1.0, -1.0):  # pincushion and barrel
        effects["lens_distortion"] = {"k1_per_mm2": 0.02 * sign, "about_x_um": 300.0}
        table = Effects(effects).table
        poses, probes = motion()
        _, tips = observe(TIMES, poses, probes, table, probes_seen_by_camera=True)
        times = np.broadcast_to(TIMES, (len(probes), len(TIMES)))
        np.testing.assert_allclose(unseen(times, tips, table), probes, atol=1e-15)


def test_a_stretched_axis_is_turned_as_the_image_of_two_points_of_it() -> None:
    heading = 0.7
    ends = np.exp(1j * heading) * np.array([1.0, -1.0])
    image = 1.03 * ends.real + 0.01 * ends.imag + 1j * (0.01 * ends.real + 0.98 * ends.imag)
    shear = np.angle((image[0] - image[1]) * np.exp(-1j * heading))
    assert abs(shear) > 0.02
    for share in (0.0, 0.5, 1.0):
        given = {"x_percent": 3.0, "y_percent": -2.0, "shear_percent": 1.0, "turned": share}
        out, _ = observe(
            np.zeros(1),
            np.array([[[0.0, 0.0, heading]]]),
            np.zeros((1, 1, 0, 2)),
            Effects({"camera_anisotropy": given}).table,
            probes_seen_by_camera=False,
        )
        assert out[0, 0, 2] == pytest.approx(heading + share * shear, abs=1e-12)


def test_latency_on_a_linear_path_is_a_shift_by_speed_times_delay() -> None:
    times = np.linspace(0.0, 1.0, 41)
    speed = np.array([75e-6, -20e-6, 0.3])
    poses = np.array([1e-3, 2e-3, 3.0]) + speed * times[None, :, None]
    probes = poses[:, :, None, :2].copy()
    table = Effects({"camera_latency": {"time_ms": 55.0}}).table
    out, tips = observe(times, poses, probes, table, probes_seen_by_camera=True)
    late = times >= 0.055
    assert out[0, late] == pytest.approx(poses[0, late] - speed * 0.055, abs=1e-15)
    assert np.array_equal(out[0, ~late], np.repeat(poses[0, :1], np.sum(~late), axis=0))
    assert np.array_equal(tips[0, :, 0], out[0, :, :2])


def test_a_clock_of_another_rate_shows_a_steady_motion_faster_and_ends_earlier() -> None:
    times = np.linspace(0.0, 10.0, 101)
    speed = np.array([75e-6, -20e-6, 0.3])
    poses = np.array([1e-3, 2e-3, 3.0]) + speed * times[None, :, None]
    late = {"camera_latency": {"time_ms": 70.0}, "log_latency": {"time_ms": 30.0}}
    table = Effects({"clock_rate": {"percent": 2.5}, **late}).table
    out, _ = observe(times, poses, np.zeros((1, 101, 0, 2)), table, probes_seen_by_camera=True)
    there = (times >= 0.1) & (times < 9.7)
    shown = poses[0, 0] + np.outer(1.025 * times[there] - 0.04, speed)
    assert out[0, there] == pytest.approx(shown, abs=1e-14)
    assert np.array_equal(out[0, times > 9.81], np.repeat(poses[0, -1:], 2, axis=0))


def test_runs_with_instants_of_their_own_are_seen_as_each_by_itself() -> None:
    poses, probes = motion()
    times = np.array([TIMES, 1.5 * TIMES + 0.1, TIMES**3])
    late = {"time_ms": np.array([60.0, 0.0, -170.0])}
    values: dict[str, dict[str, float | Floats]] = {**ON, "camera_latency": {**late}}
    table = Effects(values).table
    together = observe(times, poses, probes, table, probes_seen_by_camera=True)
    for k in range(3):
        one = slice(k, k + 1)
        alone = observe(times[k], poses[one], probes[one], table[one], probes_seen_by_camera=True)
        assert same_bits(together[0][one], alone[0])
        assert same_bits(together[1][one], alone[1])


def test_latency_interpolates_between_uneven_samples_run_by_run() -> None:
    times = np.array([0.0, 1.0, 4.0])
    poses = np.zeros((3, 3, 3))
    poses[..., 0] = [0.0, 10.0, 70.0]
    table = Effects({"camera_latency": {"time_ms": np.array([0.0, 500.0, -1000.0])}}).table
    out, _ = observe(times, poses, np.zeros((3, 3, 0, 2)), table, probes_seen_by_camera=True)
    assert out[..., 0].tolist() == [[0.0, 10.0, 70.0], [0.0, 5.0, 60.0], [10.0, 30.0, 70.0]]


def test_a_part_at_rest_looks_at_rest_however_late() -> None:
    times = np.cumsum(np.random.default_rng(1).uniform(0.01, 0.1, 50))
    poses = np.broadcast_to(np.array([0.1, 0.2, 0.3]), (1, 50, 3))
    table = Effects({"camera_latency": {"time_ms": 33.0}}).table
    out, _ = observe(times, poses, np.zeros((1, 50, 0, 2)), table, probes_seen_by_camera=True)
    assert same_bits(out, poses.copy())


def test_one_sample_is_seen_as_it_is() -> None:
    poses, probes = motion()
    table = Effects({"camera_latency": {"time_ms": 33.0}}).table
    out = observe(TIMES[:1], poses[:, :1], probes[:, :1], table, probes_seen_by_camera=True)
    assert same_bits(out[0], poses[:, :1].copy())


def test_a_lens_that_folds_the_image_is_refused() -> None:
    # at 2 mm and k1 = -0.1/mm²: k1 r² = -0.4, and r (1 + k1 r²) falls with r beyond 1.83 mm
    table = Effects({"lens_distortion": {"k1_per_mm2": -0.1}}).table
    poses = np.zeros((1, 1, 3))
    poses[0, 0, 0] = 1.8e-3
    probes = np.zeros((1, 1, 0, 2))
    observe(np.zeros(1), poses, probes, table, probes_seen_by_camera=True)
    poses[0, 0, 0] = 2e-3
    with pytest.raises(ValueError, match=r"^lens_distortion: k1 r² = -0.4; must be above -1/3"):
        observe(np.zeros(1), poses, probes, table, probes_seen_by_camera=True)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("times", np.array([0.0, 1.0, 1.0, 2.0, 3.0]), "times: 0.0 … 3.0 s; must be finite and"),
        ("times", np.array([0.0, 1.0, np.nan, 2.0, 3.0]), "times: 0.0 … 3.0 s; must be finite and"),
        ("times", np.zeros(0), r"times: shape \(0,\); must be \(T,\)"),
        ("poses", np.zeros((3, 4, 3)), r"poses: shape \(3, 4, 3\); must be \(N, 5, 3\)"),
        ("probes", np.zeros((2, 5, 1, 2)), r"probes: shape .*; must be \(3, 5, P, 2\)"),
        (
            "table",
            np.zeros((2, SLOTS)),
            rf"effects_table: shape .*; must be \(1, {SLOTS}\) or \(3, {SLOTS}\)",
        ),
    ],
)
def test_wrong_arrays_are_refused(name: str, value: Floats, message: str) -> None:
    poses, probes = motion()
    given = {"times": TIMES, "poses": poses, "probes": probes, "table": np.zeros((1, SLOTS))}
    given[name] = value
    with pytest.raises(ValueError, match=message):
        observe(*given.values(), probes_seen_by_camera=True)


def still(sensor: Sensor, runs: int = 40, duration: float = 20.0, camera: bool = True) -> Frames:
    """Frames of parts and tips at rest at the origin."""
    times = np.array([0.0, duration])
    rng = np.random.default_rng(7)
    return sense(
        sensor,
        times,
        np.zeros((runs, 2, 3)),
        np.zeros((runs, 2, 2, 2)),
        rng,
        probes_seen_by_camera=camera,
    )


SENSOR = Sensor(position_sigma=1.2e-6, orientation_sigma=1.4e-3, frame_rate=30.0)


def test_frames_come_at_the_rate_of_the_camera_from_first_to_last() -> None:
    frames = still(SENSOR, runs=1, duration=2.0).times
    assert frames.size == 61
    assert frames == pytest.approx(np.arange(61) / 30.0, rel=1e-15)
    assert still(SENSOR, runs=1, duration=1.99).times.size == 60
    fast = Sensor(position_sigma=0.0, orientation_sigma=0.0, frame_rate=100.0)
    assert 0.29 * 100.0 < 29.0  # in doubles, but the frame at the end is there
    assert still(fast, runs=1, duration=0.29).times.size == 30


def test_a_perfect_sensor_shows_the_motion_between_the_samples() -> None:
    perfect = Sensor(position_sigma=0.0, orientation_sigma=0.0, frame_rate=4.0)
    times = np.array([1.0, 2.0, 4.0])
    poses = np.array([[[0.0, 0.0, 0.0], [4.0, 8.0, 1.0], [4.0, 0.0, 5.0]]])
    rng = np.random.default_rng(0)
    frames = sense(perfect, times, poses, poses[:, :, None, :2], rng, probes_seen_by_camera=True)
    assert frames.times.tolist() == [1 + k / 4 for k in range(13)]
    assert frames.poses[0, 2].tolist() == [2.0, 4.0, 0.5]  # halfway through the first second
    assert frames.poses[0, 6].tolist() == [4.0, 6.0, 2.0]  # a quarter of the way from 2 s to 4 s
    assert np.array_equal(frames.probes[:, :, 0], frames.poses[..., :2])


def test_white_noise_has_the_stated_deviation_and_no_memory() -> None:
    frames = still(SENSOR)
    count = frames.poses[..., 0].size  # 24040: five deviations of a deviation are 2.3 %
    for noise, sigma in (
        (frames.poses[..., 0], 1.2e-6),
        (frames.poses[..., 1], 1.2e-6),
        (frames.poses[..., 2], 1.4e-3),
        (frames.probes[..., 1, 0], 1.2e-6),
    ):
        assert np.std(noise) == pytest.approx(sigma, rel=5.0 / math.sqrt(2 * count))
        assert abs(np.mean(noise)) < 5.0 * sigma / math.sqrt(count)
        lag = np.mean(noise[:, 1:] * noise[:, :-1]) / sigma**2
        assert abs(lag) < 5.0 / math.sqrt(count)
    across = np.mean(frames.poses[..., 0] * frames.poses[..., 1]) / 1.2e-6**2
    assert abs(across) < 5.0 / math.sqrt(count)


def test_coloured_noise_is_stationary_and_forgets_at_its_rate() -> None:
    coloured = Sensor(
        position_sigma=1e-6, orientation_sigma=1e-3, frame_rate=30.0, correlation_time=0.2
    )
    noise = still(coloured, runs=4000, duration=1.0).poses[..., 0] / 1e-6
    for frame in (0, 1, 10, 30):  # stationary from the first frame
        assert np.std(noise[:, frame]) == pytest.approx(1.0, rel=5.0 / math.sqrt(8000))
    for lag in (1, 6, 12):
        expected = math.exp(-lag / 30.0 / 0.2)
        assert np.mean(noise[:, 5] * noise[:, 5 + lag]) == pytest.approx(expected, abs=0.08)
    one = np.mean(noise[:, 1:] * noise[:, :-1])
    assert one == pytest.approx(math.exp(-1.0 / 6.0), abs=0.02)


def test_lost_frames_are_nan_throughout_and_as_frequent_as_stated() -> None:
    lossy = Sensor(position_sigma=1e-6, orientation_sigma=1e-3, frame_rate=30.0, dropout=0.1)
    frames = still(lossy)
    lost = np.isnan(frames.poses[..., 0])
    deviation = math.sqrt(0.1 * 0.9 / lost.size)
    assert np.mean(lost) == pytest.approx(0.1, abs=5 * deviation)
    in_a_row = np.mean(lost[:, 1:] & lost[:, :-1])
    assert in_a_row == pytest.approx(0.01, abs=5 * math.sqrt(0.01 / lost.size))
    assert np.array_equal(np.isnan(frames.poses), np.repeat(lost[..., None], 3, axis=-1))
    assert np.array_equal(np.isnan(frames.probes).all(axis=(2, 3)), lost)
    whole = still(Sensor(position_sigma=1e-6, orientation_sigma=1e-3, frame_rate=30.0))
    assert np.array_equal(frames.poses[~lost], whole.poses[~lost])


def test_commanded_tips_have_no_noise() -> None:
    frames = still(SENSOR, camera=False)
    assert not np.any(frames.probes)
    assert np.all(frames.poses)


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("position_sigma", -1e-6, "sensor.position_sigma: -1e-06; must be finite and not negative"),
        ("orientation_sigma", math.nan, "sensor.orientation_sigma: nan; must be finite"),
        ("correlation_time", math.inf, "sensor.correlation_time: inf; must be finite"),
        ("frame_rate", 0.0, "sensor.frame_rate: 0.0 Hz; must be positive"),
        ("frame_rate", math.nan, "sensor.frame_rate: nan Hz; must be positive"),
        ("dropout", 1.5, r"sensor.dropout: 1.5; must be in 0 … 1"),
    ],
)
def test_a_sensor_that_cannot_be_is_refused(field: str, value: float, message: str) -> None:
    given = {"position_sigma": 0.0, "orientation_sigma": 0.0, "frame_rate": 30.0, field: value}
    with pytest.raises(ValueError, match=message):
        Sensor(**given)
