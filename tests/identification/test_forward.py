"""Predictions against the event-driven engine, and recordings that are not all alike."""

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.identification.forward import corrected, predicted
from meso_robust.identification.models import viscous, with_effects
from meso_robust.identification.prepared import prepare
from meso_robust.recordings import Recording, RecordingSet, SensorInfo
from meso_robust.recordings.contact import OVERLAP
from meso_robust.recordings.problems import problems
from meso_robust.simulator import Film, Outcome
from meso_robust.simulator.observation import Sensor
from tests.identification.conftest import MU, RHO
from tests.identification.sets import PART, UM, first, random_pushes, recorded

MODEL = viscous(PART.outline)
TRUTH = np.array([[RHO, MU]])
QUIET = Sensor(position_sigma=0.0, orientation_sigma=0.0, frame_rate=30.0)


@pytest.fixture(scope="module")
def quiet() -> RecordingSet:
    rng = np.random.default_rng(3)
    return recorded(random_pushes(rng, 4), Film.ratio(np.full(4, RHO)), MU, rng, sensor=QUIET)


def largest(prepared: object, poses: np.ndarray) -> float:
    """Largest error in um, θ at the corner of the part."""
    away = (poses - prepared.seen) * [1.0, 1.0, prepared.length]  # type: ignore[attr-defined]
    return float(1e6 * np.nanmax(np.abs(away)))


def test_predictions_are_those_of_the_event_driven_engine(quiet: RecordingSet) -> None:
    prepared = prepare(quiet, step=MODEL.step)
    found = predicted(prepared, MODEL, TRUTH)
    assert found.completed.all()
    assert largest(prepared, found.poses[0]) < 0.2


def test_the_correction_for_the_steps_takes_the_error_of_the_steps_away(
    quiet: RecordingSet,
) -> None:
    prepared = prepare(quiet, step=2.0 * MODEL.step)
    finer = prepare(quiet, step=0.5 * MODEL.step)
    plain = predicted(prepared, MODEL, TRUTH)
    same = {"starts": prepared.starts, "offsets": np.zeros((4, 4))}
    better = predicted(corrected(prepared, finer, MODEL, TRUTH, **same), MODEL, TRUTH)

    def mean(poses: np.ndarray) -> float:
        away = (poses - prepared.seen) * [1.0, 1.0, prepared.length]
        return float(np.sqrt(np.nanmean(away**2)))

    assert mean(better.poses[0]) < 0.25 * mean(plain.poses[0])


def test_recordings_of_unequal_length_do_not_disturb_each_other(film_set: RecordingSet) -> None:
    one = film_set.recordings[1]
    short = Recording(
        file="short.csv",
        probe_names=one.probe_names,
        times=one.times[:80],
        poses=one.poses[:80],
        probes=one.probes[:80],
    )
    both = prepare(replace(film_set, recordings=(film_set.recordings[0], short)), step=MODEL.step)
    alone = prepare(replace(film_set, recordings=(short,)), step=MODEL.step)
    together = predicted(both, MODEL, np.tile(TRUTH, (2, 1))).poses
    apart = predicted(alone, MODEL, TRUTH).poses
    np.testing.assert_allclose(together[1, 1, :80], apart[0, 0], atol=1e-12)
    assert np.isnan(both.seen[1, 80:]).all()


def test_padding_at_rest_is_no_leg(film_set: RecordingSet) -> None:
    prepared = prepare(film_set, step=MODEL.step)
    alone = [
        prepare(replace(film_set, recordings=(one,)), step=MODEL.step)
        for one in film_set.recordings
    ]
    np.testing.assert_array_equal(prepared.legs, [len(one.times[0]) - 2 for one in alone])
    assert np.ptp(prepared.legs) > 0


def test_a_recording_with_two_probes_beside_one_with_one(film_set: RecordingSet) -> None:
    one = film_set.recordings[0]
    idle = Recording(
        file="idle.csv",
        probe_names=("probe1", "idle"),
        times=one.times,
        poses=one.poses,
        probes=np.concatenate([one.probes, one.probes + 5e-3], axis=1),
    )
    both = prepare(replace(film_set, recordings=(one, idle)), step=MODEL.step)
    poses = predicted(both, MODEL, TRUTH).poses
    np.testing.assert_allclose(poses[0, 1], poses[0, 0], atol=1e-12)


def moved_first_pose(recordings: RecordingSet, way: float) -> RecordingSet:
    """The part seen at its start by `way` nearer to the tip than it is."""
    one = recordings.recordings[0]
    poses = one.poses.copy()
    toward = one.probes[0, 0] - one.probes[-1, 0]
    poses[0, :2] += way * toward / np.hypot(*toward)
    return replace(recordings, recordings=(replace(one, poses=poses),))


def test_a_first_pose_that_noise_put_into_a_tip_is_moved_out_and_noted(
    quiet: RecordingSet,
) -> None:
    known = SensorInfo(frame_rate=30.0, position_sigma=1.2 * UM, orientation_sigma=0.0014)
    near = moved_first_pose(replace(quiet, sensor=known), 17.5 * UM)
    prepared = prepare(near, step=MODEL.step)
    (note,) = prepared.notes
    assert "out of a tip" in note.what
    away = prepared.starts[0] - near.recordings[0].poses[0]
    assert 0.0 < np.hypot(*away[:2]) < 5 * UM
    with pytest.raises(InputError, match=r"push_00.csv.*inside the part"):
        prepare(moved_first_pose(replace(quiet, sensor=known), 250 * UM), step=MODEL.step)


def test_two_tips_that_begin_inside_are_judged_each_by_itself_as_recordings_does(
    film_set: RecordingSet,
) -> None:
    """A late camera puts both a little inside; the way out of both is longer than either is deep."""
    outline = np.array(film_set.part.outline)
    arm, (x, y) = float(np.hypot(*outline.T).max()), outline.max(axis=0)
    deep = 0.11 * arm - film_set.tip_radius
    tips = np.array([[x - deep, 0.0], [0.0, y - deep]])
    one = Recording(
        file="push_00.csv",
        probe_names=("probe1", "probe2"),
        times=np.linspace(0.0, 1.0, 11),
        poses=np.zeros((11, 3)),
        probes=tips + np.linspace(0.0, 2e-5, 11)[:, None, None],
    )
    both = replace(film_set, recordings=(one,))

    assert not [p for p in problems(both) if p.kind == "overlap" and p.severity == "error"]
    start = prepare(both, step=MODEL.step).starts[0]
    assert np.hypot(*start[:2]) > OVERLAP * arm


def test_a_noisy_tip_is_judged_as_it_was_logged_as_recordings_does(film_set: RecordingSet) -> None:
    """By what smoothing makes of the log a set was refused that `recordings` had called usable."""
    outline = np.array(film_set.part.outline)
    arm, x = float(np.hypot(*outline.T).max()), float(outline[:, 0].max())
    noise = 0.01 * arm
    way = x + film_set.tip_radius - 0.13 * arm + np.linspace(0.0, 2e-5, 41)
    way += noise * np.where(
        np.arange(41) % 2, -1.0, 1.0
    )  # 0.12 deep at first as logged, smoothed 0.13
    one = Recording(
        file="push_00.csv",
        probe_names=("probe1",),
        times=np.linspace(0.0, 4.0, 41),
        poses=np.zeros((41, 3)),
        probes=np.stack([way, np.zeros(41)], axis=-1)[:, None],
    )
    noisy = replace(
        film_set,
        recordings=(one,),
        sensor=replace(film_set.sensor, tip_sigma=noise),
        position_source="controller",
    )

    assert not [p for p in problems(noisy) if p.kind == "overlap" and p.severity == "error"]
    assert np.hypot(*prepare(noisy, step=MODEL.step).starts[0, :2]) > 0.125 * arm


def test_what_cannot_be_used_is_refused_with_the_name_of_the_file(film_set: RecordingSet) -> None:
    one = film_set.recordings[0]
    without = replace(one, probe_names=(), probes=np.zeros((len(one.times), 0, 2)))
    with pytest.raises(InputError, match=r"push_00.csv: no probe"):
        prepare(replace(film_set, recordings=(without,)))
    blind = replace(one, poses=np.full_like(one.poses, np.nan))
    with pytest.raises(InputError, match=r"push_00.csv: 0 frames"):
        prepare(replace(film_set, recordings=(blind,)))


def test_frames_before_the_first_whole_one_are_left_out_and_noted(film_set: RecordingSet) -> None:
    one = film_set.recordings[0]
    poses = one.poses.copy()
    poses[:3, 2] = np.nan
    prepared = prepare(replace(film_set, recordings=(replace(one, poses=poses),)))
    assert prepared.instants[0, 0] == one.times[3]
    assert prepared.notes[0].what == "3 frames before the first whole one"


def test_vectors_that_are_not_valid_are_refused(film_set: RecordingSet) -> None:
    prepared = prepare(first(film_set, 1))
    with pytest.raises(ValueError, match="values"):
        predicted(prepared, MODEL, np.array([[-1.0, 0.3]]))
    with pytest.raises(ValueError, match="rho_um2, mu"):
        predicted(prepared, MODEL, np.array([[RHO, 0.3, 0.1]]))


def test_a_start_caught_between_tips_is_an_outcome(film_set: RecordingSet) -> None:
    one = film_set.recordings[0]
    pose = one.poses[0]
    across = np.array([-np.sin(pose[2]), np.cos(pose[2])])
    tips = pose[:2] + np.array([[433 * UM], [-433 * UM]]) * across
    held = replace(one, probe_names=("a", "b"), probes=np.tile(tips, (len(one.times), 1, 1)))
    prepared = prepare(replace(film_set, recordings=(held,)), step=MODEL.step)
    caught = predicted(prepared, MODEL, TRUTH, starts=pose[None] + [0.0, 0.0, 0.3])
    assert caught.outcomes[0, 0] == Outcome.OUT_OF_RANGE


SHOWN = {
    "camera_scale": {"percent": 0.7},
    "camera_rotation": {"angle_deg": 1.3},
    "camera_drift": {"x_um_s": 0.4, "y_um_s": 0.2},
    "lens_distortion": {"k1_per_mm2": 0.01},
    "camera_latency": {"time_ms": 60.0},
}


def shown(z: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The same camera but for its delay, in the complex plane, m."""
    z = z * np.exp(1j * np.deg2rad(1.3))
    return z * (1.0 + 0.01e6 * abs(z) ** 2) * 1.007 + complex(0.4e-6, 0.2e-6) * times


def test_tips_that_the_camera_shows_are_shown_as_the_part_is(quiet: RecordingSet) -> None:
    """Camera errors act on part and tips alike: the same motion, seen through the same camera."""
    prepared = prepare(quiet, step=MODEL.step)
    there = ~np.all(prepared.waypoints == -prepared.parked, axis=-1)
    z = shown(prepared.waypoints @ [1.0, 1j], prepared.times[..., None])
    ways = np.where(there[..., None], np.stack([z.real, z.imag], axis=-1), prepared.waypoints)
    seen = replace(prepared, tips_seen=True, waypoints=ways)
    model = with_effects(MODEL, SHOWN)
    sizes = [value for of in SHOWN.values() for value in of.values()]
    added = model.parameters[TRUTH.shape[1] :]
    si = [size * one.to_si for size, one in zip(sizes, added, strict=True)]
    values = np.append(TRUTH, si)[None]

    true = predicted(prepared, MODEL, TRUTH).poses[0]
    found = predicted(seen, model, values, starts=prepared.starts).poses[0]
    z = shown(true[..., :2] @ [1.0, 1j], prepared.instants)
    expected = np.stack([z.real, z.imag, true[..., 2] + np.deg2rad(1.3)], axis=-1)
    assert np.nanmax(np.abs(expected - true)) > 1e-5
    np.testing.assert_allclose(found, expected, atol=2e-9)


def test_a_part_that_runs_away_from_under_a_lens_is_far_off_and_no_refusal(
    quiet: RecordingSet,
) -> None:
    """So far out that the lens folds the image over nothing is seen; other vectors of the batch are."""
    prepared = prepare(quiet, step=MODEL.step)
    model = with_effects(MODEL, {"lens_distortion": {"k1_per_mm2": 1e-3}})
    (lens,) = [one.key for one in model.parameters if one.key.endswith("k1_per_mm2")]
    values = np.tile(
        [{"rho_um2": RHO, "mu": MU, lens: -1e3}.get(key, 0.0) for key in model.keys], (2, 1)
    )
    starts = np.stack([prepared.starts, prepared.starts])
    starts[1, :, :2] += 1.0
    found = predicted(prepared, model, values, starts=starts)
    alone = predicted(prepared, model, values[:1], starts=starts[:1])
    np.testing.assert_array_equal(found.poses[0], alone.poses[0])
    assert np.nanmin(np.abs(found.poses[1] - prepared.seen)[..., 0]) > 0.5
