"""Frames of videos and folders, and every way in which they can be bad."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.errors import InputError
from meso_robust.tracking.frames import Frames, open_frames

RNG = np.random.default_rng(0)
IMAGES = [
    np.asarray(cv2.GaussianBlur(RNG.integers(0, 256, (48, 64), np.uint8), (0, 0), 2.0))
    for _ in range(12)
]


def video(path: Path, code: str = "FFV1", rate: float = 25.0) -> Path:
    writer = cv2.VideoWriter(
        str(path), cv2.CAP_FFMPEG, cv2.VideoWriter.fourcc(*code), rate, (64, 48), isColor=False
    )
    for image in IMAGES:
        writer.write(image)
    writer.release()
    return path


def folder(path: Path, images: list[npt.NDArray[Any]], ending: str = "png") -> Path:
    path.mkdir()
    for k, image in enumerate(images):
        assert cv2.imwrite(str(path / f"frame_{k}.{ending}"), image)
    return path


def grey(frames: Frames) -> npt.NDArray[np.uint8]:
    return np.stack([frame.image for frame in frames])


def refused(frames: Frames) -> str:
    with pytest.raises(InputError) as error:
        list(frames)
    return str(error.value)


def test_lossless_video_is_read_back_exactly_with_its_clock(tmp_path: Path) -> None:
    frames = open_frames(video(tmp_path / "push_07.mkv"))  # digits: not a numbered sequence

    assert (frames.size, frames.rate, frames.promised) == ((64, 48), 25.0, 12)
    assert np.array_equal(grey(frames), np.stack(IMAGES))
    assert [frame.time for frame in frames] == pytest.approx(np.arange(12) / 25.0, abs=6e-4)


def test_given_rate_stretches_the_clock_and_is_noted(tmp_path: Path) -> None:
    frames = open_frames(video(tmp_path / "v.avi"), rate=50.0)

    assert [frame.time for frame in frames] == pytest.approx(np.arange(12) / 50.0)
    assert "50 Hz" in frames.notes[0]


def test_folder_is_read_in_natural_order(tmp_path: Path) -> None:
    frames = open_frames(folder(tmp_path / "f", list(IMAGES)), rate=10.0)

    assert np.array_equal(grey(frames), np.stack(IMAGES))  # frame_2 before frame_10
    assert [frame.time for frame in frames] == pytest.approx(np.arange(12) / 10.0)


def test_times_beside_the_images_are_their_clock(tmp_path: Path) -> None:
    path = folder(tmp_path / "f", list(IMAGES[:3]))
    (path / "times.csv").write_text(
        "file,time_s\nframe_1.png,0.5\nframe_0.png,0.25\nframe_2.png,1\n"
    )

    frames = open_frames(path)

    assert [frame.time for frame in frames] == [0.25, 0.5, 1.0]
    assert frames.rate == pytest.approx(1.0 / 0.375)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("file,time\n", "must begin with"),
        ("file,time_s\nframe_0.png,0\n", "no line for frame_1.png"),
        ("file,time_s\nframe_0.png,1\nframe_1.png,1\n", "is not after"),
        ("file,time_s\nframe_0.png,x\n", "line 2"),
        ("file,time_s\nframe_0.png,0\nframe_0.png,1\n", "once"),
    ],
)
def test_bad_clock_is_refused(tmp_path: Path, text: str, words: str) -> None:
    path = folder(tmp_path / "f", list(IMAGES[:2]))
    (path / "times.csv").write_text(text)

    with pytest.raises(InputError, match=words):
        open_frames(path)


def test_folder_without_a_clock_asks_for_the_rate(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--frame-rate-hz"):
        open_frames(folder(tmp_path / "f", list(IMAGES[:2])))


def test_sixteen_bits_are_scaled_by_their_depth_with_a_note(tmp_path: Path) -> None:
    deep = [(image.astype(np.uint16) * 4095 + 127) // 255 for image in IMAGES[:2]]
    deep[0][0, 0] = 4095
    frames = open_frames(folder(tmp_path / "f", list(deep)), rate=10.0)

    expected = np.round(deep[1] / 4095.0 * 255.0)
    assert np.abs(grey(frames)[1] - expected).max() <= 0.5
    assert "12-bit" in frames.notes[0]


def test_brighter_than_the_first_images_depth_is_refused(tmp_path: Path) -> None:
    deep = [np.full((48, 64), 900, np.uint16), np.full((48, 64), 1024, np.uint16)]
    frames = open_frames(folder(tmp_path / "f", list(deep)), rate=10.0)

    assert "10-bit" in refused(frames)


def test_colour_becomes_grey(tmp_path: Path) -> None:
    colour = np.full((48, 64, 3), (200, 100, 50), np.uint8)
    frames = open_frames(folder(tmp_path / "f", [colour]), rate=10.0)

    luma = 0.114 * 200 + 0.587 * 100 + 0.299 * 50
    assert grey(frames)[0, 5, 5] == pytest.approx(luma, abs=0.6)


def test_transparency_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="4 channel"):
        open_frames(folder(tmp_path / "f", [np.zeros((48, 64, 4), np.uint8)]), rate=10.0)


def test_floating_point_pixels_are_refused(tmp_path: Path) -> None:
    image = np.zeros((48, 64), np.float32)
    with pytest.raises(InputError, match="float32"):
        open_frames(folder(tmp_path / "f", [image], "tiff"), rate=10.0)


def test_images_of_different_size_are_refused(tmp_path: Path) -> None:
    frames = open_frames(folder(tmp_path / "f", [IMAGES[0], IMAGES[1][:40]]), rate=10.0)

    assert "64 x 40" in refused(frames)


@pytest.mark.parametrize("ending", ["png", "jpg"])
def test_torn_image_is_refused(tmp_path: Path, ending: str) -> None:
    path = folder(tmp_path / "f", list(IMAGES[:2]), ending)
    torn = path / f"frame_1.{ending}"
    torn.write_bytes(torn.read_bytes()[:-200])

    assert "truncated" in refused(open_frames(path, rate=10.0))


def test_truncated_video_says_how_much_could_be_read(tmp_path: Path) -> None:
    whole = video(tmp_path / "v.avi")
    torn = tmp_path / "torn.avi"
    torn.write_bytes(whole.read_bytes()[: int(0.6 * whole.stat().st_size)])

    words = refused(open_frames(torn))
    kept = list(open_frames(torn, allow_truncated=True))

    assert "of 12 declared frames" in words
    assert "--allow-truncated" in words
    assert 3 <= len(kept) < 12
    # the last frame before the break may be damaged: it is not handed out
    assert f"truncated, {len(kept) + 1} of 12" in words
    assert all(np.array_equal(f.image, IMAGES[f.index]) for f in kept)


def test_video_without_its_index_is_refused(tmp_path: Path) -> None:
    whole = video(tmp_path / "v.mp4", "mp4v")
    torn = tmp_path / "torn.mp4"
    torn.write_bytes(whole.read_bytes()[:-400])

    with pytest.raises(InputError, match="cannot be decoded as a video"):
        open_frames(torn)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("notes.txt", b"some text, long enough to be shown\n" * 50, "cannot be decoded as a video"),
        ("noise.avi", bytes(range(256)) * 40, "cannot be decoded as a video"),
        ("empty.avi", b"", "zero frames"),
        ("one.png", b"", "single image"),
    ],
)
def test_what_is_no_video_is_refused(tmp_path: Path, name: str, content: bytes, words: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=words):
        open_frames(tmp_path / name)


def test_missing_file_empty_folder_and_no_rate_are_refused(tmp_path: Path) -> None:
    for path, words in ((tmp_path / "none.avi", "no such file"), (tmp_path, "zero frames")):
        with pytest.raises(InputError, match=words):
            open_frames(path)
    with pytest.raises(InputError, match="must be positive"):
        open_frames(tmp_path, rate=-1.0)
