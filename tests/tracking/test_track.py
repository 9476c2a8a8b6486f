"""The whole chain on rendered pushes: truth, turned and bent images, lost and repeated frames."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.errors import InputError
from meso_robust.microscope import Optics
from meso_robust.recordings import Rectangle, read_set, write_set
from meso_robust.tracking.calibration import Calibration
from meso_robust.tracking.commands import read_commands
from meso_robust.tracking.frames import open_frames
from meso_robust.tracking.overlay import drawn_overlay
from meso_robust.tracking.track import Scene, Start, Track, track
from meso_robust.tracking.tracked_set import covariance_text, set_of
from tests.tracking.pushes import PART, PIXEL, RADIUS, Filmed, push, rms

Floats = npt.NDArray[np.float64]

TURNED = Optics(rotation=0.12, k1=-0.02, centre=(3e-4, -2e-4), distortion_centre=(330.0, 230.0))
PART_SHAPE = Rectangle(length=1616e-6, width=837e-6)


def scene_of(filmed: Filmed, **changes: object) -> Scene:
    optics = filmed.optics
    scene = Scene(
        outline=PART,
        tip_radius=RADIUS,
        calibration=Calibration(
            pixel_size=optics.pixel_size,
            size=(640, 480),
            centre=optics.centre,
            rotation=optics.rotation,
            k1=optics.k1,
            k1_centre=optics.distortion_centre,
        ),
        pose=np.array([np.nan, np.nan, 0.0]),
    )
    return replace(scene, **changes)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> tuple[Filmed, Track]:
    filmed = push(tmp_path_factory.mktemp("plain") / "push.avi", 60)
    return filmed, track(open_frames(filmed.path), scene_of(filmed))


def assert_true(filmed: Filmed, seen: Track) -> None:
    part = seen.poses - filmed.poses
    tips = (seen.tips - filmed.tips)[:, 0] / PIXEL

    assert seen.found.all()
    moved = part[:, :2] - part[:, :2].mean(axis=0)
    assert np.all(rms(moved / PIXEL) < 0.1)
    assert np.all(rms(part[:, :2] / PIXEL) < 0.3)  # the place of the edge in its rim is constant
    assert np.degrees(rms(part[:, 2])) < 0.05
    assert np.all(rms(tips - tips.mean(axis=0)) < [0.06, 0.16])
    assert np.all(rms(tips) < [0.1, 0.35])  # the needle's axis is nearly y
    sigma = np.sqrt(np.diagonal(seen.covariances, axis1=1, axis2=2))
    assert np.all(rms(part / sigma) < 3.0)  # one draw: its larger part is constant
    assert np.all(sigma[:, :2] < 0.5 * PIXEL)
    spread = np.sqrt(np.diagonal(seen.tip_covariances[:, 0], axis1=1, axis2=2)) / PIXEL
    assert np.all(rms(tips / spread) < 2.0)


def test_motion_is_tracked_to_a_tenth_of_a_pixel(plain: tuple[Filmed, Track]) -> None:
    filmed, seen = plain

    assert seen.names == ("probe1",)  # found by its motion
    assert_true(filmed, seen)
    assert seen.times == pytest.approx(filmed.times)


def test_turned_camera_and_bent_image_are_undone(tmp_path: Path) -> None:
    filmed = push(tmp_path / "push.avi", 40, TURNED)
    tip = filmed.tips[0, 0] + [8e-6, -8e-6]
    probes = (Start(name="left", tip=(float(tip[0]), float(tip[1]))),)

    seen = track(open_frames(filmed.path), scene_of(filmed, probes=probes))

    assert seen.names == ("left",)
    assert_true(filmed, seen)


def test_recording_set_holds_what_was_seen(plain: tuple[Filmed, Track], tmp_path: Path) -> None:
    _, seen = plain
    made = set_of([seen], ["push.csv"], PART_SHAPE, RADIUS)
    write_set(tmp_path, made)
    back = read_set(tmp_path)

    assert back.position_source == "camera"
    assert back.recordings[0].poses == pytest.approx(seen.poses, abs=2e-8)
    assert back.recordings[0].probes == pytest.approx(seen.tips, abs=1e-12)
    place = np.mean([np.trace(one[:2, :2]) / 2.0 for one in seen.covariances])
    assert back.sensor.position_sigma == pytest.approx(np.sqrt(place), rel=1e-6)
    assert back.sensor.frame_rate == 30.0
    # the part is seen better than the tip along its needle, here nearly y; 60 frames with one σ each
    ways = np.array([[np.cos(a), np.sin(a)] for a in np.linspace(0.0, np.pi, 721)])
    each = np.einsum("wi,tij,wj->tw", ways, seen.tip_covariances[:, 0], ways).max(axis=1)
    assert back.sensor.tip_offset == pytest.approx(np.sqrt(np.median(each)), rel=1e-4)
    assert np.median(each) > 1.5 * place
    least = np.einsum("wi,tij,wj->tw", ways, seen.tip_covariances[:, 0], ways).min(axis=1)
    assert back.sensor.tip_offset_across == pytest.approx(np.sqrt(np.median(least)), rel=1e-4)
    assert back.recordings[0].tip_directions is not None
    (angle,) = back.recordings[0].tip_directions
    assert abs(np.sin(angle)) > 0.95
    rows = list(csv.DictReader(covariance_text(seen).splitlines()))
    assert len(rows) == 60
    assert float(rows[7]["part_tt_deg2"]) == pytest.approx(
        np.degrees(np.degrees(seen.covariances[7, 2, 2])), rel=1e-5
    )
    assert float(rows[7]["probe1_xy_um2"]) == pytest.approx(
        seen.tip_covariances[7, 0, 0, 1] * 1e12, rel=1e-5
    )


def test_commands_keep_their_clock(plain: tuple[Filmed, Track], tmp_path: Path) -> None:
    path = tmp_path / "commands.csv"
    path.write_text("time_s,tip_x_um,tip_y_um\n0,1,2\n0.5,3,4\n0.51,,\n9,5,6\n")
    _, seen = plain
    made = set_of([seen], ["push.csv"], PART_SHAPE, RADIUS, [read_commands(path)])
    one = made.recordings[0]

    assert made.position_source == "controller"
    assert made.sensor.tip_offset is None
    assert one.probe_names == ("tip",)
    assert len(one.times) == 60 + 2  # 0 and 0.5 s are instants of frames as well
    assert np.isnan(one.poses[-1]).all()
    assert one.probes[-1, 0] == pytest.approx([5e-6, 6e-6])
    assert one.poses[0] == pytest.approx(seen.poses[0])
    assert one.probes[0, 0] == pytest.approx([1e-6, 2e-6])
    assert np.isnan(one.probes[1]).all()


def test_instants_that_differ_by_their_spelling_are_one(
    plain: tuple[Filmed, Track], tmp_path: Path
) -> None:
    path = tmp_path / "commands.csv"
    path.write_text("time_s,tip_x_um,tip_y_um\n0,1,2\n0.3333333,3,4\n0.33334,5,6\n")
    made = set_of([plain[1]], ["push.csv"], PART_SHAPE, RADIUS, [read_commands(path)])
    one = made.recordings[0]

    assert len(one.times) == 60 + 1  # 10 us after frame 10 is another instant
    assert one.probes[10, 0] == pytest.approx([3e-6, 4e-6])
    assert one.poses[10] == pytest.approx(plain[1].poses[10])
    assert np.isnan(one.poses[11]).all()


@pytest.mark.parametrize(
    "text",
    ["", "time_s,a_x_um\n0,1\n", "time_s,a_x_um,a_y_um\n", "time_s,a_x_um,a_y_um\n0,x,1\n",
     "time_s,a_x_um,a_y_um\n0,1\n", "time_s,a_x_um,a_y_um\n1,1,1\n1,2,2\n"],
)  # fmt: skip
def test_bad_commands_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "commands.csv"
    path.write_text(text)
    with pytest.raises(InputError, match="--commands"):
        read_commands(path)


def images_of(filmed: Filmed) -> list[npt.NDArray[np.uint8]]:
    return [frame.image for frame in open_frames(filmed.path)]


def stored(folder: Path, images: list[npt.NDArray[np.uint8]]) -> Path:
    folder.mkdir()
    for k, image in enumerate(images):
        cv2.imwrite(str(folder / f"{k:03d}.png"), image)
    return folder


def test_lost_and_repeated_frames_are_empty_and_named(
    plain: tuple[Filmed, Track], tmp_path: Path
) -> None:
    filmed, whole = plain
    images = images_of(filmed)[25:45]
    images[8] = np.full_like(images[8], 70)  # the lamp is covered
    images[14] = images[13].copy()  # the camera dropped a frame and gave the last one again
    tip = filmed.tips[25, 0]
    scene = scene_of(filmed, probes=(Start(name="p", tip=(float(tip[0]), float(tip[1]))),))

    seen = track(open_frames(stored(tmp_path / "f", images), rate=30.0), scene)

    lost = np.flatnonzero(~seen.found).tolist()
    assert lost == [8, 14]
    assert seen.states[14] == "repeated"
    assert seen.reasons[8]
    assert np.isnan(seen.covariances[lost]).all()
    assert np.isnan(seen.tips[lost]).all()
    again = seen.poses[9] - whole.poses[34]  # the part is found again where it is
    assert np.abs(again[:2]).max() < 0.3 * PIXEL
    assert abs(again[2]) < np.radians(0.05)


def test_part_at_rest_in_identical_frames_keeps_its_pose(
    plain: tuple[Filmed, Track], tmp_path: Path
) -> None:
    filmed, _ = plain
    images = [images_of(filmed)[0]] * 5

    seen = track(
        open_frames(stored(tmp_path / "f", images), rate=30.0), scene_of(filmed, probes=())
    )

    assert seen.found.all()


def test_overlay_marks_the_part_where_it_is(plain: tuple[Filmed, Track], tmp_path: Path) -> None:
    filmed, seen = plain
    path = tmp_path / "overlay.avi"
    with drawn_overlay(tmp_path, seen, PART, RADIUS, scene_of(filmed).calibration) as film:
        assert not list(tmp_path.iterdir())  # it has no name
        path.write_bytes(film.read())

    capture = cv2.VideoCapture(str(path))
    assert capture.get(cv2.CAP_PROP_FRAME_COUNT) == 60
    good, picture = capture.read()
    assert good
    colour = np.ptp(np.asarray(picture).astype(int), axis=2)
    corners = scene_of(filmed).calibration.to_pixels(PART + filmed.poses[0, :2])
    for u, v in np.rint(corners).astype(int):
        assert colour[v - 3 : v + 4, u - 3 : u + 4].max() > 60  # a coloured line
    assert colour[20:60, 400:600].max() < 40  # and none in the film
