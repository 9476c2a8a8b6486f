"""Frames of videos and folders, and every way in which they can be bad."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.errors import InputError
from meso_robust.tracking.frames import FirstField, Frames, open_frames

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

    assert (frames.size, frames.rate, frames.promised) == (
        (64, 48),
        25.0,
        None,
    )  # not counted in Matroska
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
    deep = [
        ((image.astype(np.uint32) * 4095 + 127) // 255).astype(np.uint16) for image in IMAGES[:2]
    ]
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


def test_hot_pixels_do_not_say_how_deep_a_camera_is(tmp_path: Path) -> None:
    deep = [
        ((image.astype(np.uint32) * 4095 + 127) // 255).astype(np.uint16) for image in IMAGES[:2]
    ]
    for image in deep:
        image[7, 9] = 65535
    frames = open_frames(folder(tmp_path / "f", list(deep)), rate=10.0)

    images = grey(frames)

    assert "12-bit" in frames.notes[0]
    cold = np.ones((48, 64), bool)
    cold[7, 9] = False
    assert np.abs(images[1].astype(int) - IMAGES[1])[cold].max() <= 1
    assert images[1][7, 9] == 255


@pytest.mark.parametrize(
    ("names", "times"),
    [
        (["a_0ms.png", "a_40.5ms.png", "a_90ms.png"], [0.0, 0.0405, 0.09]),
        (["cam2_t1.5s.png", "cam2_t2s.png", "cam2_t2.25s.png"], [0.0, 0.5, 0.75]),
        (
            ["20260131_235959.500.png", "20260131_235959.750.png", "20260201_000000.png"],
            [0.0, 0.25, 0.5],
        ),
    ],
)
def test_instants_in_the_names_of_images_are_their_clock(
    tmp_path: Path, names: list[str], times: list[float]
) -> None:
    for name, image in zip(names, IMAGES, strict=False):
        assert cv2.imwrite(str(tmp_path / name), image)

    frames = open_frames(tmp_path)

    assert [frame.time for frame in frames] == pytest.approx(times)


def test_an_instant_that_two_names_state_is_refused(tmp_path: Path) -> None:
    for k, name in enumerate(("a1_20ms.png", "a2_20ms.png")):
        assert cv2.imwrite(str(tmp_path / name), IMAGES[k])

    with pytest.raises(InputError, match=r"a2_20ms\.png: its name states the instant of a1_20ms"):
        open_frames(tmp_path)


@pytest.mark.parametrize(
    ("name", "code"), [("v.avi", "MJPG"), ("v.mp4", "mp4v"), ("v.mkv", "MJPG")]
)
def test_usual_codecs_are_read_whole(tmp_path: Path, name: str, code: str) -> None:
    frames = open_frames(video(tmp_path / name, code))

    assert np.abs(grey(frames).astype(float) - np.stack(IMAGES)).mean() < 6.0
    assert frames.promised == (None if name.endswith("mkv") else 12)


def test_uncompressed_avi_is_read_exactly(tmp_path: Path) -> None:
    path = tmp_path / "raw.avi"
    path.write_bytes(uncompressed([np.asarray(image) for image in IMAGES], 20))

    frames = open_frames(path)

    assert np.array_equal(grey(frames), np.stack(IMAGES))
    assert [frame.time for frame in frames] == pytest.approx(np.arange(12) / 20.0)


def uncompressed(images: list[npt.NDArray[np.uint8]], rate: int) -> bytes:
    """An AVI file (RIFF) of 8-bit grey bitmaps, rows from the bottom, written by hand."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return name + len(data).to_bytes(4, "little") + data + b"\0" * (len(data) % 2)

    def words(*values: int) -> bytes:
        return b"".join(value.to_bytes(4, "little") for value in values)

    height, width = images[0].shape
    count, size = len(images), width * height
    main = words(10**6 // rate, size * rate, 0, 0x10, count, 0, 1, size, width, height, 0, 0, 0, 0)
    stream = b"vidsDIB " + words(0, 0, 0, 1, rate, 0, count, size, 2**32 - 1, 0) + bytes(8)
    palette = b"".join(bytes([k, k, k, 0]) for k in range(256))
    shape = words(40, width, height) + b"\x01\x00\x08\x00" + words(0, size, 0, 0, 256, 0) + palette
    header = b"hdrl" + chunk(b"avih", main)
    header += chunk(b"LIST", b"strl" + chunk(b"strh", stream) + chunk(b"strf", shape))
    film = b"movi" + b"".join(chunk(b"00db", image[::-1].tobytes()) for image in images)
    return chunk(b"RIFF", b"AVI " + chunk(b"LIST", header) + chunk(b"LIST", film))


def test_matroska_at_a_varying_rate_is_whole_and_a_torn_one_is_refused(tmp_path: Path) -> None:
    whole = video(tmp_path / "v.mkv")
    data = bytearray(whole.read_bytes())
    # the duration (RFC 9559, section 5.1.2.10, an 8-byte float) as of a film with long gaps
    at = data.index(b"\x44\x89\x88") + 3
    data[at : at + 8] = np.array([9000.0], ">f8").tobytes()
    slow = tmp_path / "slow.mkv"
    slow.write_bytes(data)
    torn = tmp_path / "torn.mkv"
    torn.write_bytes(whole.read_bytes()[: int(0.6 * whole.stat().st_size)])

    assert np.array_equal(grey(open_frames(slow)), np.stack(IMAGES))
    with pytest.raises(InputError, match=r"torn\.mkv: truncated"):
        open_frames(torn)
    kept = list(open_frames(torn, allow_truncated=True))
    assert 3 <= len(kept) < 12


@pytest.mark.parametrize("first", ["top", "bottom"])
def test_fields_keep_their_lines_and_come_half_a_period_apart(
    tmp_path: Path, first: FirstField
) -> None:
    # brightness that says where and when: it grows along v and with time
    v, instants = np.arange(48.0)[:, None], np.arange(6) / 20.0
    fields = [np.rint(40.0 + 2.0 * v + 200.0 * t + np.zeros((1, 64))) for t in instants]
    woven = []
    for early, late in zip(fields[::2], fields[1::2], strict=True):
        frame = np.where(v % 2 == (0 if first == "top" else 1), early, late)
        woven.append(frame.astype(np.uint8))

    frames = open_frames(folder(tmp_path / "f", list(woven)), rate=10.0, interlaced=first)

    assert (frames.rate, frames.promised) == (20.0, 6)
    assert [frame.time for frame in frames] == pytest.approx(instants)
    inside = slice(4, -4)  # beyond the first and the last line nothing is known
    assert np.abs(grey(frames)[:, inside] - np.stack(fields)[:, inside]).max() <= 1.0


def test_an_odd_number_of_lines_is_not_interlaced(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="47 lines; must be an even number"):
        open_frames(folder(tmp_path / "f", [IMAGES[0][:47]]), rate=10.0, interlaced="top")
